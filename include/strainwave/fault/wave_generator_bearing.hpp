#pragma once
#include <strainwave/ball_bearing.hpp>
#include <strainwave/fault/fault.hpp>

namespace strainwave::fault {

/// Part of a ball bearing that is damaged.
enum class Element { outer_ring, inner_ring, ball, cage };
constexpr Array<const char*, 4> choices(Element) { return {{"outer_ring", "inner_ring", "ball", "cage"}}; }

template <class S>
struct WaveGeneratorBearing {
    S severity{1.0};
    Element element{Element::outer_ring};
    S friction_depth{0.2};
    S stiffness_depth{0.0};
    int balls{23};
    S ball_diameter{4.763e-3};
    S pitch_diameter{46e-3};
    S contact_angle{0.0};
    S phase{0.0};
    int waves{2};

    static constexpr auto name = "wave_generator_bearing";
    static constexpr auto mode = "Defect in the ball bearing of the wave generator";
    static constexpr auto effect = "friction at the input, and stiffness if given, vary with the order of the damaged element";
    static constexpr auto signal = "that order and its multiples in the motor current, without load as well";
    static constexpr auto source =
        "RandallAntoni2011, eqs. (1) to (4), for the orders; the depths, and waves that fall with their number, are assumed; so "
        "are the default balls, no data sheet states them";
    static constexpr auto doc = R"(
        Damaged ring, ball or cage of the thin ball bearing between wave generator and flexspline.

        .. math:: f \leftarrow f + s\, d \sum_{h=1}^{n} \tfrac{1}{h} \sin(h B \theta + h \varphi)

        .. math:: B_{outer} = \tfrac{z}{2} (1 - \gamma) |1 - r|, \quad B_{inner} = \tfrac{z}{2} (1 + \gamma) |1 - r|, \quad
                  B_{ball} = \frac{D (1 - \gamma^2)}{2 d_b} |1 - r|, \quad
                  B_{cage} = \tfrac{1}{2} [1 - \gamma + r (1 + \gamma)]

        with s = severity, f the factor of the friction at the input, and of the stiffness, d = friction_depth and
        stiffness_depth, n = waves, phi = phase, z = balls, d_b = ball_diameter, D = pitch_diameter, gamma = d_b cos(alpha) / D,
        alpha = contact_angle, r = speed of the outer ring over that of the input: it turns with the flexspline, so r = 1 / i if
        the circular spline is fixed, else 0. These are the orders of ``sw.orders.bearing_orders``. At severity 1 the first wave has the
        depth d, relative to the healthy friction or stiffness.

        Leaves out the ellipse of the inner ring, which loads each ball twice a turn and adds lines 2 orders away. A damaged
        ball meets both rings, so that twice its order is the stronger line.

        >>> from strainwave.fault import Facts, WaveGeneratorBearing
        >>> facts = Facts(flexspline_teeth=200, circular_spline_teeth=202, fixed="flexspline", ratio=101.0)
        >>> bearing = WaveGeneratorBearing(balls=9, ball_diameter=7.94e-3, pitch_diameter=39.04e-3, waves=1)
        >>> [(place, round(order, 4)) for place, *_, order in bearing.changes(facts)]
        [('gear.friction_input', 3.5848)])";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, severity, "1", "Share s of the depths", 0, 1));
        visit(SW_FIELD(m, element, "1", "The damaged element"));
        visit(SW_FIELD(m, friction_depth, "1", "Depth of the first wave of friction at the input at severity 1, relative", 0, 1));
        visit(SW_FIELD(m, stiffness_depth, "1", "Depth of the first wave of stiffness at severity 1, relative", 0, 0.5));
        visit(SW_FIELD(m, balls, "1", "Balls z", 3, 1000));
        visit(SW_FIELD(m, ball_diameter, "m", "Diameter d_b of a ball", smallest));
        visit(SW_FIELD(m, pitch_diameter, "m", "Diameter D of the circle of the centres of the balls", smallest));
        visit(SW_FIELD(m, contact_angle, "rad", "Contact angle alpha, 0 of a deep groove bearing", 0, 1.5));
        visit(SW_FIELD(m, phase, "rad", "Phase phi of the first wave"));
        visit(SW_FIELD(m, waves, "1", "Waves n: the order and its multiples", 1, 8));
    }

    constexpr const char* problem() const { return geometry(S(0.0)).fits() ? nullptr : BallBearingGeometry<S>::too_large; }
    constexpr const char* missing(const Facts<S>& facts) const { return facts.has_teeth() ? nullptr : needs_teeth; }

    /// Order of the damaged element, over the input.
    constexpr S order(const Facts<S>& facts) const {
        const S outer_speed = facts.fixed == kinematics::Fixed::circular_spline ? S(1.0) / facts.ratio : S(0.0);
        const BallBearingGeometry<S> bearing = geometry(outer_speed);
        if (element == Element::outer_ring) return bearing.outer_ring();
        if (element == Element::inner_ring) return bearing.inner_ring();
        return element == Element::ball ? bearing.ball() : bearing.cage();
    }

    template <class Visit>
    constexpr void changes(const Facts<S>& facts, Visit&& visit) const {
        add_waves(facts, "gear.friction_input", "cyclic", friction_depth, visit);
        add_waves(facts, variation_place, "periodic", stiffness_depth, visit);
    }

private:
    constexpr BallBearingGeometry<S> geometry(const S& outer_speed) const {
        return {balls, ball_diameter, pitch_diameter, contact_angle, outer_speed};
    }
    template <class Visit>
    constexpr void add_waves(const Facts<S>& facts, const char* place, const char* law, const S& depth, Visit&& visit) const {
        if (!any(depth > S(0.0))) return;
        for (int h = 1; h <= waves; ++h) visit(add_wave(place, law, S(h) * order(facts), severity * depth / S(h), S(h) * phase));
    }
};

}  // namespace strainwave::fault
