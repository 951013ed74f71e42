#pragma once
#include <strainwave/field.hpp>
#include <strainwave/room_temperature.hpp>

namespace strainwave::motor {

/// The resistance of a winding, which rises with its temperature.
template <class S>
struct Winding {
    S resistance{1.0}, conductance{1.0};  ///< Ohm, 1/Ohm, at the reference temperature
    S rise{0.0};                          ///< 1/K
    bool rises = false;

    static constexpr Winding of(const S& resistance, const S& rise) {
        return {resistance, S(1.0) / resistance, rise, is_differentiated(rise) || any(rise > S(0.0))};
    }
    constexpr S resistance_at(const S& temperature) const { return rises ? resistance * factor(temperature) : resistance; }
    constexpr S conductance_at(const S& temperature) const { return rises ? conductance / factor(temperature) : conductance; }

private:
    /// Far below any cold at which a motor works, where the line would cross zero, it levels off.
    constexpr S factor(const S& temperature) const { return max(S(1.0) + rise * (temperature - S(room_temperature)), S(0.01)); }
};

}  // namespace strainwave::motor
