#pragma once
#include <strainwave/fault/fault.hpp>

namespace strainwave::fault {

template <class S>
struct ToothWear {
    S severity{1.0};
    S play{3e-4};
    S amplitude{1.5e-4};
    S phase{0.0};
    S friction_rise{0.0};
    S softening{0.0};
    Spline spline{Spline::flexspline};

    static constexpr auto name = "tooth_wear";
    static constexpr auto mode = "Wear of the teeth of a spline";
    static constexpr auto effect = "play, kinematic error that repeats with the worn teeth, friction of the mesh, lower stiffness";
    static constexpr auto signal =
        "lost motion; order 2 or 2 z_c / z_f of the input (2 z_f / z_c with the flexspline fixed) in output position and current";
    static constexpr auto source = "order: kinematics of the three members; play and amplitude are assumed (1 and 0.5 arc minutes)";
    static constexpr auto doc = R"(
        Wear of the teeth of one spline, uneven around it.

        .. math:: c \leftarrow c + s\, \Delta c, \qquad e(\theta) \leftarrow e(\theta) + s A \sin(2 \rho \theta + \varphi), \qquad
                  F_{mesh} \leftarrow (1 + s\, r)\, F_{mesh}, \qquad k \leftarrow (1 - s\, f)\, k

        with s = severity, Delta c = play, A = amplitude, phi = phase, r = friction_rise of dry friction at the mesh, losses per
        load included, f = softening of every stiffness of the spring, theta the input angle, rho revolutions of the wave generator
        against the worn spline per revolution of the input. With the circular spline fixed rho is 1 for teeth of the circular
        spline and z_c / z_f for those of the flexspline; with the flexspline fixed it is z_f / z_c and 1. Two lobes pass the worn
        teeth per such revolution. At severity 1 the play at the output has grown by ``play``, and the wave has its amplitude.
        The order of a spline that turns differs from 2 by some 1 %: a record that separates them spans half a revolution of the
        output. Leaves out the particles in the lubricant: see LubricationLoss. Wear grows with the work that the gear has
        transmitted: see the onset Growing, and ``sw.diagnose.wear_life``, which fits all four amounts to tests of one gear.

        >>> from strainwave.fault import Facts, ToothWear
        >>> facts = Facts(flexspline_teeth=200, circular_spline_teeth=202, ratio=-100.0)
        >>> changes = ToothWear(softening=0.1).changes(facts)
        >>> changes[0][:4], changes[1][:4], changes[-1][-1]
        (('gear.stiffness', 'clearance', 'add', 0.0003), ('gear.stiffness', 'k', 'scale', 0.9), 2.02))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, severity, "1", "Share s of play and amplitude", 0, 1));
        visit(SW_FIELD(m, play, "rad", "Play Delta c at the output, from flank to flank, at severity 1", 0));
        visit(SW_FIELD(m, amplitude, "rad", "Amplitude A of the wave of kinematic error at the output, at severity 1", 0));
        visit(SW_FIELD(m, phase, "rad", "Phase phi of that wave"));
        visit(
            SW_FIELD(m, friction_rise, "1", "Rise r of dry friction at the mesh at severity 1, relative to the healthy drive", 0));
        visit(SW_FIELD(m, softening, "1", "Share f of the stiffness that is lost at severity 1", 0, 0.95));
        visit(SW_FIELD(m, spline, "1", "The spline whose teeth are worn"));
    }

    constexpr const char* missing(const Facts<S>& facts) const { return facts.has_teeth() ? nullptr : needs_teeth; }

    template <class Visit>
    constexpr void changes(const Facts<S>& facts, Visit&& visit) const {
        visit(add(spring_place, "clearance", severity * play, "backlash"));
        for (const char* quantity : stiffness_quantities.item) visit(scale(spring_place, quantity, S(1.0) - severity * softening));
        for (const char* quantity : dry_quantities.item) visit(scale(mesh_place, quantity, S(1.0) + severity * friction_rise));
        visit(add_wave(error_place, "fourier", S(2.0) * facts.passes(spline), severity * amplitude, phase));
    }
};

}  // namespace strainwave::fault
