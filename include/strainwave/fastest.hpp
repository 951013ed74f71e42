#pragma once
#include <strainwave/math.hpp>

namespace strainwave {

/// Highest rate of a part that fixed steps must resolve [rad/s]; 0 if any step is stable.
template <class S, class Part>
constexpr S fastest(const Part& part) {
    if constexpr (requires { part.fastest(); })
        return part.fastest();
    else
        return S(0.0);
}

}  // namespace strainwave
