#pragma once
#include <strainwave/compensation/compensator.hpp>

namespace strainwave::compensation {

template <class S>
struct Dither {
    S amplitude{0.0};
    S frequency{50.0};

    static constexpr auto name = "dither";
    static constexpr auto source =
        "ArmstrongHelouvry1994; mean of Coulomb friction, by the dual-input describing function: GelbVanderVelde1968";
    static constexpr auto doc = R"(
        Torque that swings around zero. The input does not rest, so its mean friction becomes smooth over the speed.

        .. math:: \tau_d = A \sin(2 \pi \varphi)\, \operatorname{sgn}(\dot r), \qquad \dot\varphi = f \;\text{ where } \dot r \ne 0

        with r the commanded output angle, A = amplitude, f = frequency. The phase stands still while the command rests. An inertia
        J with Coulomb friction F_c swings with the speed a = sqrt(A^2 - (4 F_c / pi)^2) / (2 pi f J). At a mean speed v its
        mean friction is (2 / pi) F_c asin(v / a) if v < a: about that of a viscous friction, in place of a jump. Choose A so
        that a exceeds the speeds at which the drive sticks.

        If A is at most 4 F_c / pi the input rests during a part of each period, and the formula does not hold.

        Keep f above the bandwidth of the speed loop and away from the vibrations of the drive. It must be below half of the sample
        rate.
        Dither heats the motor, wears the gear, and can be heard. It swings the input; the output follows with the share that gear
        and load let through.

        >>> from strainwave.compensation import Dither
        >>> Dither(amplitude=0.05, frequency=80.0).frequency
        80.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, amplitude, "N.m", "Amplitude A, of the motor", 0));
        visit(SW_FIELD(m, frequency, "Hz", "Frequency f", smallest));
    }

    static constexpr double share_of_sample_rate = 0.49;  ///< that the frequency may reach
    constexpr S max_period() const { return S(share_of_sample_rate) / frequency; }

    struct State {
        S phase{0.0};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, phase, "1", "Turns of the phase, in [-1/2, 1/2]"));
        }
    };

    constexpr RequestAndState<S, State> step(const State& x, const control::Command<S>& command, const S& period) const {
        const S sense = sign(command.ratio * command.rate), turned = x.phase + abs(sense) * frequency * period;
        const S torque = sense * amplitude * sin(S(2.0 * pi) * x.phase);
        return {{S(0.0), S(0.0), S(0.0), torque, S(0.0)}, {turned - rint(turned)}};
    }
};

}  // namespace strainwave::compensation
