#pragma once
#include <strainwave/math.hpp>

namespace strainwave {

/// How fast a part is by itself, which steps of a fixed length must follow [rad/s]; 0 if any step is stable.
template <class S, class Part>
constexpr S fastest(const Part& part) {
    if constexpr (requires { part.fastest(); })
        return part.fastest();
    else
        return S(0.0);
}

}  // namespace strainwave
