#pragma once
#include <strainwave/system.hpp>

namespace strainwave {

/// The inputs of a system over one step: at its start, middle and end.
template <class Input>
struct Interval {
    Input start{}, middle{}, end{};

    /// The stretch between two fractions of the step.
    template <class S>
    constexpr Interval part(const S& from, const S& to, const S& dt) const {
        return {at(from, dt), at(S(0.5) * (from + to), dt), at(to, dt)};
    }
    /// Input at a fraction of the step of `dt` [s]: from the input itself if it has `between`, else on the parabola through the
    /// three instants.
    template <class S>
    constexpr Input at(const S& fraction, const S& dt) const {
        if constexpr (requires { Input::between(start, middle, end, fraction, dt); })
            return Input::between(start, middle, end, fraction, dt);
        else
            return parabola(fraction);
    }

private:
    template <class S>
    constexpr Input parabola(const S& fraction) const {
        auto x = flattened<S>(start);
        const auto y = flattened<S>(middle), z = flattened<S>(end);
        for (int i = 0; i < x.size(); ++i) {
            const S bow = S(2.0) * (x[i] - S(2.0) * y[i] + z[i]);
            x[i] = x[i] + fraction * ((z[i] - x[i] - bow) + fraction * bow);
        }
        return shaped<Input>(x);
    }
};

}  // namespace strainwave
