#pragma once
#include <strainwave/meter/meter.hpp>

namespace strainwave::meter {

template <class S>
struct EnergyMeter {
    static constexpr auto name = "energy";
    static constexpr auto source = "definition; the balance is that of GoldsteinPooleSafko2002, section 1.3";
    static constexpr auto doc = R"(
        Meter of powers and energies of a drive, as outputs of its runs.

        .. math:: E_{supplied} = \sum_{places} E_{lost} + E_{load} + \Delta E_{stored}

        Each energy is the integral of its power since the start of the run. E_lost are the losses of the motor, of friction at
        the three places, of damping, the relaxation of a material included, and of hysteresis. E_stored are the energies of both
        shafts, of the spring with its material, and of the motor, which need not be 0 at the start. Hysteresis and bristles of friction store a part of the energy that they take,
        and give it back later; over a cycle all of it is lost. A spring that softens as it warms up turns some of its energy
        to heat. A random kinematic error whose amplitude follows load or speed, and an error over the temperature, do work on
        the shafts, of either sign, as they change. The energy of a brake counts to the load.

        The balance is as exact as the steps, which integrate the powers with the motion. The work of a jump of an input takes
        no time and is not part of any power. This concerns jumps of the angle of a held output shaft and of the temperature of
        a spring that softens. With a random kinematic error whose amplitude follows load or speed, the balance of fixed steps
        is of first order where load or speed cross zero, because the amplitude has a kink there: use simulate_adaptively.

        >>> import strainwave as sw
        >>> drive = sw.Drive(load=sw.loads.Inertia(inertia=0.01), meter=sw.meter.EnergyMeter())
        >>> run = sw.simulate(drive, sw.scenario.step(amplitude=5.0, duration=0.1))
        >>> float(run["energy_supplied"][-1]) > float(run["energy_motor"][-1]) > 0.0
        True)";

    template <class Self, class Visit>
    static constexpr void fields(Self&, Visit&&) {}

    struct State {
        S supplied{0.0}, motor{0.0}, friction_input{0.0}, friction_mesh{0.0}, friction_output{0.0}, damping{0.0}, hysteresis{0.0},
            softening{0.0}, kinematic_noise{0.0}, load{0.0};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, supplied, "J", "Energy that the motor has taken from its supply"));
            visit(SW_FIELD(m, motor, "J", "Energy that the motor has lost"));
            visit(SW_FIELD(m, friction_input, "J", "Energy that friction at the input has taken"));
            visit(SW_FIELD(m, friction_mesh, "J", "Energy that friction of the mesh has taken"));
            visit(SW_FIELD(m, friction_output, "J", "Energy that friction at the output has taken"));
            visit(SW_FIELD(m, damping, "J", "Energy that damping and relaxation of the gear have taken"));
            visit(SW_FIELD(m, hysteresis, "J", "Energy that the hysteresis has taken, and not given back"));
            visit(SW_FIELD(m, softening, "J", "Elastic energy that has turned to heat as the gear warmed up"));
            visit(SW_FIELD(m, kinematic_noise, "J", "Energy that the kinematic error has taken as its amplitude changed"));
            visit(SW_FIELD(m, load, "J", "Energy that the load has taken"));
        }
    };

    struct Output {
        Powers<S> power;
        State energy;
        Stored<S> stored;

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_PART(m, power, "Powers"));
            visit(SW_PART(m, energy, "Energies since the start"));
            visit(SW_PART(m, stored, "Energies stored"));
        }
    };
    static constexpr bool active() { return true; }

    constexpr State rate(const Powers<S>& power) const {
        static_assert(members_alike<State, Powers<S>>, "each energy is the integral of the power of its name");
        return shaped<State>(flattened<S>(power));
    }
    constexpr Output output(const State& x, const Powers<S>& power, const Stored<S>& stored) const { return {power, x, stored}; }
};

}  // namespace strainwave::meter
