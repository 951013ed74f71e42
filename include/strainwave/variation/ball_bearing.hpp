#pragma once
#include <strainwave/ball_bearing.hpp>
#include <strainwave/condition.hpp>
#include <strainwave/harmonics.hpp>
#include <strainwave/lobes.hpp>
#include <strainwave/variation/variation.hpp>

namespace strainwave::variation {

template <class S>
struct BallBearing {
    static constexpr int multiples = 8;

    int balls{23};
    S ball_diameter{4.763e-3};
    S pitch_diameter{46e-3};
    S contact_angle{0.0};
    S outer_speed{0.0};
    S loaded_share{0.3};
    S first_lobe{0.5};
    S phase{0.0};

    static constexpr auto name = "ball_bearing";
    static constexpr auto source =
        "RandallAntoni2011, eq. (2), for the order; the amplitudes are derived here by Poisson's summation; which balls are "
        "loaded, and how their stiffness falls, is assumed";
    static constexpr auto doc = R"(
        Stiffness of the wave generator's bearing, which varies as its balls pass under the lobes.

        .. math:: k(\theta) = k_0 \left(1 + \sum_{h=1}^{8} a_h \cos(h (B \theta - z \varphi))\right), \qquad
                  B = \tfrac{z}{2} (1 + \gamma) |1 - r|, \qquad a_h = 2 s_{hz} \, W\!\left(\tfrac{\pi}{2} h z \lambda\right)

        .. math:: \gamma = \tfrac{d_b}{D} \cos \alpha, \qquad W(x) = \frac{\sin x}{x \, (1 - x^2 / \pi^2)}

        with theta the angle of the wave generator, k_0 the mean stiffness, z = balls, d_b = ball_diameter, D = pitch_diameter,
        alpha = contact_angle, r = outer_speed, lambda = loaded_share, phi = phase. B is the order with which balls pass a place
        of the inner ring, z (1 - cage), and the lobes are places of the inner ring. The outer ring turns with the flexspline: r
        is 1 / i if the circular spline is fixed, with i the signed ratio, and 0 if the flexspline is fixed.

        The share lambda of the balls carries load, half of it under each lobe. The stiffness of a ball is assumed to fall as 1
        + cos from the major axis to zero at the ends of a zone. Poisson's formula turns the sum over the z balls into the mean
        and the multiples of z around the circumference; W is the share of such a wave in the zone. The first lobe has the share
        p = first_lobe of the stiffness: s_n = 1 for even n, 2 p - 1 for odd n. With an odd number of balls and equal lobes,
        a ball comes under one lobe as one leaves the other, so that the odd multiples cancel. A bearing without a fault has
        these orders. Those of a fault are in ``sw.orders.bearing_orders`` and fault.WaveGeneratorBearing.

        Assumed are balls that are equal and roll without slip, and a stiffness that does not depend on the load (Hertzian
        contacts stiffen, and more balls carry a larger load). Leaves out the ellipse in the kinematics of the balls, and
        differences between balls, which have the order of the cage. The amplitudes must add up to less than 1: more than
        about one ball must carry the load of a lobe.

        >>> from strainwave.variation import BallBearing
        >>> bearing = BallBearing(balls=22, ball_diameter=4.8e-3, pitch_diameter=46e-3, loaded_share=0.3, outer_speed=-0.01)
        >>> round(bearing.factor(0.0), 4)
        1.0139)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_REQUIRED(m, balls, "1", "Balls z", 3, 100));
        visit(SW_REQUIRED(m, ball_diameter, "m", "Diameter d_b of a ball", smallest));
        visit(SW_REQUIRED(m, pitch_diameter, "m", "Diameter D of the circle of the centres of the balls", smallest));
        visit(SW_FIELD(m, contact_angle, "rad", "Contact angle alpha, 0 of a deep groove bearing", 0, 1.5));
        visit(SW_REQUIRED(m, outer_speed, "1",
                          "Speed r of the outer ring over that of the input: 1 / i if the circular spline is fixed, else 0", -1,
                          1));
        visit(SW_REQUIRED(m, loaded_share, "1", "Share lambda of the balls that carries load, at both lobes together", 0, 1));
        visit(SW_FIELD(m, first_lobe, "1", "Share p of the first lobe in the stiffness of all loaded balls", 0, 1));
        visit(SW_FIELD(m, phase, "rad", "Angle phi of a ball from the first lobe at input angle 0"));
    }

    constexpr Contradiction<S> problem() const {
        if (!geometry().fits()) return {BallBearingGeometry<S>::too_large};
        if (!all(largest() < S(2.0)))
            return {"loaded_share = {} is too small for balls = {}: between two balls no stiffness would be left", loaded_share,
                    S(balls)};
        return {};
    }

    constexpr BallBearingGeometry<S> geometry() const { return {balls, ball_diameter, pitch_diameter, contact_angle, outer_speed}; }

    struct Compiled {
        Harmonics<S, 1, multiples> sum;
        S order;
        S most;

        constexpr bool active() const { return true; }
        constexpr S largest() const { return most; }
        constexpr Factor<S> at(const Angle<S>& angle) const {
            const S passed = clip(order * angle.turns, S(-1e18), S(1e18));
            const auto [value, slope] = sum.at({order * angle.within + S(2.0 * pi) * (passed - rint(passed)), S(0.0)});
            return {S(1.0) + value, order * slope};
        }
    };

    constexpr bool active() const { return true; }
    constexpr S largest() const {
        S most{1.0};
        for (int h = 1; h <= multiples; ++h) most = most + abs(amplitude(h));
        return most;
    }
    constexpr Factor<S> at(const Angle<S>& angle) const { return compile().at(angle); }

    /// The sum, arranged for speed.
    constexpr Compiled compile() const {
        Sequence<S, multiples> order{}, size{}, start{};
        order.count = size.count = start.count = multiples;
        for (int h = 1; h <= multiples; ++h) {
            order[h - 1] = S(h);
            size[h - 1] = amplitude(h);
            start[h - 1] = S(0.5 * pi) - S(h * balls) * phase;
        }
        return {Harmonics<S, 1, multiples>::of(order, size, start), geometry().inner_ring(), largest()};
    }

private:
    constexpr S amplitude(int h) const {
        const int n = h * balls;
        return S(2.0) * lobes::of_both(n, first_lobe, lobes::zone_share(S(0.5 * pi) * S(n) * loaded_share));
    }
};

}  // namespace strainwave::variation
