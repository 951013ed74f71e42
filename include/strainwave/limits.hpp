#pragma once
#include <strainwave/field.hpp>

namespace strainwave {

/// The least and the largest actuation that a motor can follow. It hands them to its controller, so that no integral winds up.
template <class S>
struct Limits {
    S low{S(-unbounded)}, high{S(unbounded)};

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, low, "1", "Least actuation, in the unit of the motor"));
        visit(SW_FIELD(m, high, "1", "Largest actuation"));
    }

    constexpr S limited(const S& asked) const { return clip(asked, low, high); }
    constexpr Limits within(const S& most) const { return {clip(low, -most, most), clip(high, -most, most)}; }

    /// The rate of an integral of `error` that feeds `asked`: the error, which falls to zero at 5 % of the range beyond a limit. If
    /// it ended at once, the actuation would slide along the limit, to and fro at every step, and no step would be short enough for
    /// a tolerance.
    constexpr S integral_rate(const S& asked, const S& error) const {
        const S faded = max(S(integral_fading_range) * (high - low), S(smallest));
        const S above = min(max(asked - high, S(0.0)) / faded, S(1.0)), below = min(max(low - asked, S(0.0)) / faded, S(1.0));
        return select(error > S(0.0), error * (S(1.0) - above), error * (S(1.0) - below));  // no sum: at 0 it has one slope
    }

private:
    static constexpr double integral_fading_range = 0.05;  ///< share of the range between the limits
};

}  // namespace strainwave
