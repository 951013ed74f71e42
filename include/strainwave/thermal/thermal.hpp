#pragma once

/// Interface of a thermal model of a drive. It has
///
///     State, Output                    what changes continuously, and what it shows in recordings
///     active()                         whether it takes heat: else nobody works out how much there is
///     at(state, ambient)               -> Temperatures
///     rate(state, heat, ambient)       -> State
///     gear_rate(rate, ambient_rate)    -> K/s, how fast the gear warms up
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
