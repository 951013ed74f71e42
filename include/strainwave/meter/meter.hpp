#pragma once
#include <strainwave/field.hpp>

/// Interface of a meter of the energy of a drive. It has
///
///     State, Output                        continuous numbers, and channels in recordings
///     active()                             true if it measures; otherwise powers are not calculated
///     rate(powers)                         -> State
///     output(state, powers, stored)        -> Output
namespace strainwave::meter {

/// Powers of a drive at one instant. Supplied power is lost, goes to the load, or is stored.
template <class S>
struct Powers {
    S supplied{0.0}, motor{0.0}, friction_input{0.0}, friction_mesh{0.0}, friction_output{0.0}, damping{0.0}, hysteresis{0.0},
        softening{0.0}, kinematic_noise{0.0}, load{0.0};

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, supplied, "W", "Power that the motor takes from its supply"));
        visit(SW_FIELD(m, motor, "W", "Power that the motor loses"));
        visit(SW_FIELD(m, friction_input, "W", "Power that friction at the input takes"));
        visit(SW_FIELD(m, friction_mesh, "W", "Power that friction of the mesh takes"));
        visit(SW_FIELD(m, friction_output, "W", "Power that friction at the output takes"));
        visit(SW_FIELD(m, damping, "W", "Power that damping and relaxation of the gear take"));
        visit(SW_FIELD(m, hysteresis, "W", "Power that the hysteresis takes; it gives part of it back"));
        visit(SW_FIELD(m, softening, "W", "Elastic power that turns to heat as the gear warms up"));
        visit(SW_FIELD(m, kinematic_noise, "W", "Power that the kinematic error takes as its amplitude changes"));
        visit(SW_FIELD(m, load, "W", "Power that the load takes"));
    }
};

/// Kinetic and potential energies of a drive, J.
template <class S>
struct Stored {
    S input{0.0}, output{0.0}, spring{0.0}, gear{0.0}, motor{0.0};

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, input, "J", "Kinetic energy of the input"));
        visit(SW_FIELD(m, output, "J", "Kinetic energy of the output"));
        visit(SW_FIELD(m, spring, "J", "Elastic energy of the gear"));
        visit(SW_FIELD(m, gear, "J", "Kinetic energy of the bodies within the gear that move by themselves"));
        visit(SW_FIELD(m, motor, "J", "Energy that the motor holds, magnetic and of cogging"));
    }
};

}  // namespace strainwave::meter
