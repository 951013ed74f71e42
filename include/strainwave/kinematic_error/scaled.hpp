#pragma once
#include <strainwave/compiled.hpp>
#include <strainwave/kinematic_error/fourier.hpp>

namespace strainwave::kinematic_error {

template <class S, class Law = Fourier<S>>
struct Scaled {
    Law law{};
    S load_sensitivity{0.0};
    S insertion_depth{0.0};
    S depth_sensitivity{0.0};

    static constexpr auto name = "scaled";
    static constexpr auto source = SW_REVIEW
        ", section 1b, which scales its random part so: here the deterministic error, with a reaction that keeps "
        "the energy";
    static constexpr auto doc = R"(
        Kinematic error that decreases with load and with the insertion depth of the wave generator.

        .. math:: e(\theta, T) = e_0(\theta)\, \frac{e^{-\kappa_d d}}{1 + \kappa_T |T|}

        with theta the input angle, e_0 the error of ``law``, kappa_T = load_sensitivity, d = insertion_depth, kappa_d =
        depth_sensitivity, and T the torque that the ``stiffness`` of the gear has at the twist delta. The twist solves delta +
        e(theta, T(delta)) = theta_in / i - theta_out. The torque acts on both shafts by the derivatives of the twist with
        respect to their angles, so that the change of the error under load conserves energy. No catalogue gives the
        sensitivities: measure them, or assume them. The product of load_sensitivity, error and stiffness must stay below 0.8,
        so that each pair of angles has one twist: a run that exceeds it is refused. ``error`` and ``slope`` are those without
        load, at the insertion depth.

        >>> from strainwave.kinematic_error import Fourier, Scaled
        >>> law = Scaled(law=Fourier(order=[2], amplitude=[3e-4], phase=[0.0]), load_sensitivity=0.01)
        >>> law.slope(0.0), round(law.replace(insertion_depth=5e-4, depth_sensitivity=200.0).slope(0.0), 9)
        (0.0006, 0.000542902))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, law, "The error without load, at insertion depth 0"));
        visit(SW_FIELD(m, load_sensitivity, "1/(N.m)", "Relative fall kappa_T of the error with the torque transmitted", 0));
        visit(SW_FIELD(m, insertion_depth, "m", "Depth d to which the wave generator is inserted into the flexspline", 0));
        visit(SW_FIELD(m, depth_sensitivity, "1/m", "Relative fall kappa_d of the error with the insertion depth", 0));
    }

    template <class Inner>
    struct Compiled {
        Inner law;
        S scale, load_sensitivity;
        bool eased;

        constexpr bool follows_load() const { return eased; }
        constexpr Relief<S> relief(const S& torque) const {
            const S factor = S(1.0) / (S(1.0) + min(load_sensitivity * abs(torque), S(1e30)));
            return {factor, -load_sensitivity * sign(torque) * factor * factor};
        }
        constexpr S side(const Angle<S>& angle) const { return kinematic_error::side<S>(law, angle); }
        constexpr Error<S> at(const Angle<S>& angle) const {
            const Error<S> full = law.at(angle);
            return {scale * full.value, scale * full.slope};
        }
        constexpr bool follows_temperature() const { return kinematic_error::follows_temperature(law); }
        constexpr Error<S> warmed(const Angle<S>& angle, const S& temperature) const {
            const Error<S> full = kinematic_error::warmed<S>(law, angle, temperature);
            return {scale * full.value, scale * full.slope};
        }
        constexpr S per_kelvin(const Angle<S>& angle) const { return scale * kinematic_error::per_kelvin<S>(law, angle); }
    };

    constexpr auto compile() const {
        return Compiled<decltype(compiled(law))>{compiled(law), exp(-min(depth_sensitivity * insertion_depth, S(beyond_digits))),
                                                 load_sensitivity, follows_load()};
    }

    constexpr bool follows_load() const { return is_differentiated(load_sensitivity) || any(load_sensitivity > S(0.0)); }
    constexpr Relief<S> relief(const S& torque) const { return compile().relief(torque); }
    constexpr S side(const Angle<S>& angle) const { return compile().side(angle); }
    constexpr Error<S> at(const Angle<S>& angle) const { return compile().at(angle); }
    constexpr bool follows_temperature() const { return kinematic_error::follows_temperature(law); }
    constexpr Error<S> warmed(const Angle<S>& angle, const S& temperature) const { return compile().warmed(angle, temperature); }
    constexpr S per_kelvin(const Angle<S>& angle) const { return compile().per_kelvin(angle); }
};

}  // namespace strainwave::kinematic_error
