#pragma once
#include <strainwave/field.hpp>

namespace strainwave::motor {

/// The shares of a winding of several equal sets: those that drive, and those that are short-circuited and brake. Sets in parallel
/// are one winding: its current is the sum of theirs, its resistance and inductance are those of a set over their number.
template <class S>
struct WindingSets {
    S driving{1.0}, shorted{0.0};
    bool acts = false, brakes = false;

    static constexpr WindingSets of(const S& open, const S& shorted) {
        const bool brakes = is_differentiated(shorted) || any(shorted > S(0.0));
        return {S(1.0) - open - shorted, shorted, brakes || is_differentiated(open) || any(open > S(0.0)), brakes};
    }
    /// Resistance or inductance of the sets that drive, of that of all sets.
    constexpr S impedance(const S& of_all) const { return acts ? of_all / driving : of_all; }
    /// Current of the sets that drive, of that of all sets.
    constexpr S current(const S& of_all) const { return acts ? driving * of_all : of_all; }
    /// Torque or heat of a motor whose other sets give `electric`; that of all sets, short-circuited, would be `braking()`.
    template <class F>
    constexpr S braked(const S& electric, const F& braking) const {
        return brakes ? electric + shorted * braking() : electric;
    }

    /// Less than the whole winding may fail.
    static constexpr const char* problem(const S& open, const S& shorted) {
        return all(open + shorted < S(0.999)) ? nullptr : "open_share + shorted_share must be below 0.999: some sets must drive";
    }
};

}  // namespace strainwave::motor
