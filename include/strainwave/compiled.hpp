#pragma once

namespace strainwave {

/// The law as the integrator wants it: rearranged for speed where the law knows how.
template <class Law>
constexpr auto compiled(const Law& law) {
    if constexpr (requires { law.compile(); })
        return law.compile();
    else
        return law;
}

}  // namespace strainwave
