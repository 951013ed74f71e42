#pragma once

/// Interface of a thermal model of a drive. It has
///
///     State, Output                    continuous numbers, and channels in recordings
///     active()                         true if it takes heat; otherwise heat flows are not calculated
///     at(state, ambient)               -> Temperatures
///     rate(state, heat, ambient)       -> State
///     gear_rate(rate, ambient_rate)    -> K/s, rate of the temperature of the gear
///     output(state, ambient)           -> Output
///
/// The temperature that a run gives is the ambient one.
namespace strainwave::thermal {

template <class S>
struct Temperatures {
    S winding, gear;  ///< K
};

/// Heat flows into the bodies, W.
template <class S>
struct Heat {
    S winding, gear;
};

}  // namespace strainwave::thermal
