#pragma once
#include <strainwave/kinematic_error/error.hpp>
#include <strainwave/random.hpp>

namespace strainwave::kinematic_error {

template <class S>
struct Stochastic {
    static constexpr int waves = Spectrum<S>::waves;

    S amplitude{0.0};
    S lowest_order{8.0};
    S highest_order{40.0};
    S seed{0.0};
    S load_sensitivity{0.0};
    S speed_sensitivity{0.0};
    S insertion_depth{0.0};
    S depth_sensitivity{0.0};

    static constexpr auto name = "stochastic";
    static constexpr auto source = SW_REVIEW
        ", section on the kinematic error, which states directions only: the laws of load, speed and depth and the "
        "default band are assumed; spectral representation: ShinozukaDeodatis1991; random numbers: WichmannHill1982";
    static constexpr auto doc = R"(
        Random kinematic error in a band of orders: smooth, and the same for the same seed.

        .. math:: n(\theta) = a \sqrt{\frac{2}{N}} \sum_{k=1}^{N} \cos(B_k \theta + \varphi_k), \qquad
                  a = A \, \frac{1 + s_\omega |\omega|}{1 + s_T |T|} \, e^{-s_d d}

        with theta the input angle, omega the input speed, T the elastic torque at the reference temperature, A = amplitude,
        s_omega = speed_sensitivity, s_T = load_sensitivity, s_d = depth_sensitivity, d = insertion_depth of the wave generator
        in the flexspline. a is the root mean square over many turns. The band from lowest_order to highest_order has N = 32
        equal cells. Each cell contains one order B_k; ``seed`` draws its place in the cell and its phase phi_k. The error is a
        function of the angle alone: reproducible, differentiable, and independent of the time step, which must resolve the
        highest order. If the ends of the band are whole numbers, the error repeats after 16384 input turns at most, 512 in the
        default band. Every scalar type draws the same orders and phases.

        The review states that the stochastic part falls with load, rises with speed and falls with the insertion depth,
        without equations: the forms are assumed, and all three are off by default. MicroSlip has the mechanism that the review
        names, in which speed and load act through the slip of a contact. The stochastic part of the review also
        contains the deterministic resonance of the elastic gear, which is not part of this law. The spectrum is flat,
        the values are close to Gaussian. ``slope`` is the derivative by theta at constant a. Over few turns the root mean
        square differs from a: a record must span several times the inverse of a cell's width, in turns.

        >>> from strainwave.kinematic_error import Stochastic
        >>> noise = Stochastic(amplitude=2e-5, seed=7, load_sensitivity=0.1)
        >>> noise.error(0.3) == 2.0 * noise.error(0.3, torque=-10.0)
        True)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, amplitude, "rad", "Root mean square A at the output, without load and at rest; 0 is no noise", 0, 1));
        visit(SW_FIELD(m, lowest_order, "1", "Lower end of the band: periods per input revolution", 0, 1e4));
        visit(SW_FIELD(m, highest_order, "1", "Upper end of the band: periods per input revolution", smallest, 1e4));
        visit(SW_FIELD(m, seed, "1", "Seed of the random numbers, a whole number", 0, 16777215, true));
        visit(SW_FIELD(m, load_sensitivity, "1/(N.m)", "Relative fall s_T of the amplitude with the torque transmitted", 0));
        visit(SW_FIELD(m, speed_sensitivity, "s/rad", "Relative rise s_omega of the amplitude with the input speed", 0));
        visit(SW_FIELD(m, insertion_depth, "m", "Depth d to which the wave generator is inserted into the flexspline", 0));
        visit(SW_FIELD(m, depth_sensitivity, "1/m", "Relative fall s_d of the amplitude with the insertion depth", 0));
    }

    constexpr const char* problem() const {
        return all(highest_order > lowest_order) ? nullptr : "highest_order must exceed lowest_order";
    }

    /// Largest slopes of the error, at rest and without load.
    struct MaxChange {
        S slope;       ///< over the input angle, rad/rad
        S per_torque;  ///< over the torque transmitted, rad/(N.m)
        S per_speed;   ///< over the input speed, rad.s/rad
    };

    struct Compiled {
        bool engaged = false;
        S amplitude{0.0}, load_sensitivity{0.0}, speed_sensitivity{0.0};
        Array<S, waves> order{}, fraction{}, phase{};

        constexpr bool active() const { return engaged; }

        /// Root mean square [rad] under `torque` [N.m], at `speed` [rad/s]. Far beyond any gear it levels off: never infinite.
        constexpr S rms(const S& torque, const S& speed) const {
            const S rise = min(speed_sensitivity * abs(speed), S(1e30)), fall = min(load_sensitivity * abs(torque), S(1e30));
            return amplitude * (S(1.0) + rise) / (S(1.0) + fall);
        }
        /// Rate of the error [rad/s] at a constant angle, where the torque changes at `torque_rate` [N.m/s], the speed at
        /// `acceleration` [rad/s2].
        constexpr S drift(const Angle<S>& angle, const S& torque, const S& torque_rate, const S& speed,
                          const S& acceleration) const {
            const S rise = speed_sensitivity * abs(speed), fall = load_sensitivity * abs(torque);
            const S growth = speed_sensitivity * sign(speed) * acceleration / (S(1.0) + rise) -
                             load_sensitivity * sign(torque) * torque_rate / (S(1.0) + fall);
            return at(angle, torque, speed).value * growth;
        }

        /// Four standard deviations of a nearly Gaussian value: one place in 16000 exceeds them.
        constexpr MaxChange max_change() const {
            S squares{0.0};
            for (int k = 0; k < waves; ++k) squares = squares + order[k] * order[k];
            const S largest = S(4.0) * rms(S(0.0), S(0.0));
            return {largest * sqrt(squares / S(waves)), largest * load_sensitivity, largest * speed_sensitivity};
        }

        constexpr Error<S> at(const Angle<S>& angle, const S& torque, const S& speed) const {
            Error<S> sum{};
            if (!engaged) return sum;
            for (int k = 0; k < waves; ++k) {
                const S turned = fraction[k] * angle.turns;
                const SinCos<S> p = sincos(order[k] * angle.within + phase[k] + S(2.0 * pi) * (turned - rint(turned)));
                sum.value = sum.value + p.cos;
                sum.slope = sum.slope - order[k] * p.sin;
            }
            const S each = S(Spectrum<S>::weight) * rms(torque, speed);
            return {each * sum.value, each * sum.slope};
        }
    };

    /// True if the law has an effect, or a derivative by its parameters.
    constexpr bool active() const { return is_differentiated(amplitude) || any(amplitude > S(0.0)); }

    constexpr S rms(const S& torque, const S& speed) const { return scaled().rms(torque, speed); }

    constexpr S drift(const Angle<S>& angle, const S& torque, const S& torque_rate, const S& speed, const S& acceleration) const {
        return compile().drift(angle, torque, torque_rate, speed, acceleration);
    }

    constexpr MaxChange max_change() const { return compile().max_change(); }

    constexpr Error<S> at(const Angle<S>& angle, const S& torque, const S& speed) const {
        return compile().at(angle, torque, speed);
    }

    /// The sum, with its orders and phases drawn once.
    constexpr Compiled compile() const {
        Compiled sum = scaled();
        sum.engaged = active();
        if (!sum.engaged) return sum;
        const auto spectrum = Spectrum<S>::drawn(lowest_order, highest_order, seed);
        for (int k = 0; k < waves; ++k) {
            sum.order[k] = spectrum.order[k];
            sum.fraction[k] = sum.order[k] - rint(sum.order[k]);
            sum.phase[k] = spectrum.phase[k];
        }
        return sum;
    }

private:
    constexpr Compiled scaled() const {
        Compiled sum{};
        sum.amplitude = amplitude * exp(-min(depth_sensitivity * insertion_depth, S(beyond_digits)));
        sum.load_sensitivity = load_sensitivity;
        sum.speed_sensitivity = speed_sensitivity;
        return sum;
    }
};

}  // namespace strainwave::kinematic_error
