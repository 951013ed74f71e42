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

    /// The rate of an integral of `error` that feeds `asked`: the error, but none that would lead further beyond a limit.
    constexpr S integral_rate(const S& asked, const S& error) const {
        const S within = select(asked > high, min(error, S(0.0)), error);
        return select(asked < low, max(within, S(0.0)), within);
    }
};

}  // namespace strainwave
