#pragma once
#include <strainwave/compiled.hpp>
#include <strainwave/kinematic_error/error.hpp>
#include <strainwave/math.hpp>

namespace strainwave::kinematic_error {

/// The steepest slope of an error over all turns of the wave generator, without its sign [rad/rad]; asked of a choice, of the error
/// chosen. One that varies another and has no bound of its own is at most as steep. An error that a turn does not repeat is
/// looked at in a turn of its own at each angle.
template <class S, class Law>
constexpr S steepest(const Law& law) {
    if constexpr (requires { law.model; }) {
        return law.visit([](const auto& chosen) { return steepest<S>(chosen); });
    } else if constexpr (requires { law.steepest(); }) {
        return law.steepest();
    } else if constexpr (requires { law.law; }) {
        return steepest<S>(law.law);
    } else {
        constexpr int parts = 4096;
        const auto ready = compiled(law);
        S largest(0.0);
        for (int i = 0; i < parts; ++i) largest = max(largest, S(abs(ready.at({S((2.0 * i / parts - 1.0) * pi), S(i)}).slope)));
        return largest;
    }
}

}  // namespace strainwave::kinematic_error
