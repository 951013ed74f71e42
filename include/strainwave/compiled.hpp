#pragma once

namespace strainwave {

/// A limit on the state of a law that leaves none out.
inline constexpr int any_size = 1 << 30;

/// The law as the integrator wants it: rearranged for speed where the law knows how; a choice, among plain laws whose state is no
/// larger than `most` scalars.
template <int most = any_size, class Law>
constexpr auto compiled(const Law& law) {
    if constexpr (requires { law.template compile<most>(); })
        return law.template compile<most>();
    else if constexpr (requires { law.compile(); })
        return law.compile();
    else
        return law;
}

}  // namespace strainwave
