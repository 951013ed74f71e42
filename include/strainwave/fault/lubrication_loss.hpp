#pragma once
#include <strainwave/fault/fault.hpp>

namespace strainwave::fault {

template <class S>
struct LubricationLoss {
    S severity{1.0};
    S dry_rise{1.0};
    S stribeck_rise{1.0};
    S viscous_fall{0.5};

    static constexpr auto name = "lubrication_loss";
    static constexpr auto mode = "Loss of lubricant";
    static constexpr auto effect = "dry friction rises, the Stribeck speed rises, viscous friction falls";
    static constexpr auto signal = "mean motor current, most at low speed; hysteresis of position at reversals; temperature";
    static constexpr auto source =
        "Stribeck1902 for the sense: a thinner film carries later, so the Stribeck speed rises; the amounts are assumed";
    static constexpr auto doc = R"(
        Lack of lubricant: surfaces touch up to higher speeds, and less oil is sheared.

        .. math:: F_{dry} \leftarrow (1 + s\, r_d)\, F_{dry}, \qquad v_s \leftarrow (1 + s\, r_s)\, v_s, \qquad
                  b \leftarrow (1 - s\, f_v)\, b

        with s = severity, r_d = dry_rise, r_s = stribeck_rise, f_v = viscous_fall; F_dry every dry level of the friction at
        input, mesh and output, losses per load included, v_s the Stribeck speed, b viscous friction. At severity 1 dry friction
        is 1 + r_d times that of the healthy drive. Leaves out the rise of wear and temperature that follows.

        >>> from strainwave.fault import Facts, LubricationLoss
        >>> LubricationLoss(severity=0.5).changes(Facts())[0][:4]
        ('gear.friction_input', 'coulomb', 'scale', 1.5))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, severity, "1", "Share s of the changes below", 0, 1));
        visit(SW_FIELD(m, dry_rise, "1", "Rise r_d of dry friction at severity 1, relative to the healthy drive", 0));
        visit(SW_FIELD(m, stribeck_rise, "1", "Rise r_s of the Stribeck speed at severity 1, relative to the healthy drive", 0));
        visit(SW_FIELD(m, viscous_fall, "1", "Fall f_v of viscous friction at severity 1, relative to the healthy drive", 0, 1));
    }

    template <class Visit>
    constexpr void changes(const Facts<S>&, Visit&& visit) const {
        constexpr Array<const char*, 3> places{{"gear.friction_input", mesh_place, "gear.friction_output"}};
        for (const char* place : places.item) {
            for (const char* quantity : dry_quantities.item) visit(scale(place, quantity, S(1.0) + severity * dry_rise));
            visit(scale(place, "stribeck_speed", S(1.0) + severity * stribeck_rise));
            visit(scale(place, "viscous", S(1.0) - severity * viscous_fall));
            visit(scale(place, "viscous_torque", S(1.0) - severity * viscous_fall));
        }
    }
};

}  // namespace strainwave::fault
