#pragma once
#include <strainwave/fault/fault.hpp>

namespace strainwave::fault {

template <class S>
struct FlexsplineCrack {
    S severity{1.0};
    S depth{0.3};
    S width{0.6};
    S angle{0.0};
    int waves{4};

    static constexpr auto name = "flexspline_crack";
    static constexpr auto mode = "Crack in the flexspline";
    static constexpr auto effect = "torsional stiffness drops while a lobe of the wave generator stands over the crack";
    static constexpr auto signal =
        "orders 2 k z_c / z_f (circular spline fixed) or 2 k (flexspline fixed) of the input, in twist and motor current, under "
        "load";
    static constexpr auto source =
        "order: kinematics of the three members; the pulse is a raised cosine, and its Fourier series follows from its "
        "definition; depth and width are assumed";
    static constexpr auto doc = R"(
        Crack at one place of the flexspline: the gear is softer while one of the two lobes passes it.

        .. math:: k \leftarrow k \left(1 - s\, d\, p(\psi)\right), \qquad
                  p(\psi) = \tfrac{1}{2} \left(1 + \cos\frac{2 \pi \psi}{w}\right) \text{ for } |\psi| < \tfrac{w}{2}, \qquad
                  \psi = \rho \theta - \psi_0

        with s = severity, d = depth, w = width, psi_0 = angle, theta the input angle, rho revolutions of the wave generator
        against the flexspline per revolution of the input: z_c / z_f if the circular spline is fixed, 1 if the flexspline is.
        There are two lobes, so that p repeats after pi. At severity 1 the stiffness falls by the share d at the middle of the
        pulse. The pulse is stored as its mean and ``waves`` harmonics,

        .. math:: p = \frac{w}{2 \pi} + \sum_k a_k \cos(2 k \psi), \qquad
                  a_k = \frac{w}{\pi} \frac{\operatorname{sinc} x}{1 - x^2}, \qquad x = \frac{k w}{\pi}

        with sinc x = sin(pi x) / (pi x). A narrow pulse needs more harmonics; a gear holds 8 waves in all, the mean is one of
        them. Leaves out the kinematic error that the crack causes without load, and its opening and closing.

        >>> from strainwave.fault import Facts, FlexsplineCrack
        >>> facts = Facts(flexspline_teeth=200, circular_spline_teeth=202, ratio=-100.0)
        >>> [round(order, 9) for *_, order in FlexsplineCrack().changes(facts)]
        [0.0, 2.02, 4.04, 6.06, 8.08])";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, severity, "1", "Share s of the depth", 0, 1));
        visit(SW_FIELD(m, depth, "1", "Share d of the stiffness that is lost at the middle of the pulse at severity 1", 0, 0.9));
        visit(
            SW_FIELD(m, width, "rad", "Width w of the pulse, as an angle of the wave generator against the flexspline", 1e-3, pi));
        visit(SW_FIELD(m, angle, "rad", "Place psi_0 of the crack: that angle at the middle of the pulse"));
        visit(SW_FIELD(m, waves, "1", "Number of harmonics of the pulse", 1, 7));
    }

    constexpr const char* missing(const Facts<S>& facts) const { return facts.has_teeth() ? nullptr : needs_teeth; }

    /// Share of the pulse in cos(2 k psi).
    constexpr S harmonic(int k) const {
        const S x = S(k) * width / S(pi), beyond = S(1.0) - x;
        // sin(pi x) = sin(pi (1 - x)) beyond the half, which avoids the zero of 1 - x^2.
        return width / S(pi) *
               select(x < S(0.5), sinc(x) / ((S(1.0) - min(x, S(0.5))) * (S(1.0) + x)), sinc(beyond) / (x * (S(1.0) + x)));
    }

    template <class Visit>
    constexpr void changes(const Facts<S>& facts, Visit&& visit) const {
        const S lost = severity * depth;
        visit(add_wave(variation_place, "periodic", S(0.0), lost * width / S(2.0 * pi), S(-0.5 * pi)));
        for (int k = 1; k <= waves; ++k) {
            const S order = S(2 * k) * facts.passes(Spline::flexspline);
            visit(add_wave(variation_place, "periodic", order, lost * harmonic(k), S(-0.5 * pi) - S(2 * k) * angle));
        }
    }

private:
    /// sin(pi x) / (pi x), 1 at 0.
    static constexpr S sinc(const S& x) {
        const S angle = S(pi) * x, small = S(1e-4);
        const S away = select(abs(angle) < small, small, angle);
        return select(abs(angle) < small, S(1.0) - angle * angle / S(6.0), sin(away) / away);
    }
};

}  // namespace strainwave::fault
