#include <strainwave/ball_bearing.hpp>

#include "laws.hpp"

namespace strainwave::host {

void bind_gear_laws(nb::module_& core) {
    bind_family<NoVerbs>(core, "kinematics", "Rigid motion: the signed ratio from the teeth and the fixed member.",
                         kinematics::Models{});
    nb::module_ error = family_module(core, "kinematic_error", "Pure kinematic error at the output, over the input angle.");
    bind_list<ErrorVerbs>(core, error, "kinematic_error", kinematic_error::Models{});
    bind_list<NoiseVerbs>(core, error, "kinematic_noise", kinematic_error::Noises{});
    bind_family<FrictionVerbs>(core, "friction", "Friction torque of one side, over its speed.", friction::Models{});
    bind_family<StiffnessVerbs>(core, "stiffness", "Elastic torque over the twist.", stiffness::Models{});
    nb::module_ hysteresis = family_module(core, "hysteresis", "Torque that depends on the history of the twist.");
    bind_model<NoVerbs, strainwave::hysteresis::PrandtlIshlinskii<double>>(hysteresis, "PrandtlIshlinskii", 0);
    bind_list<NoVerbs>(core, hysteresis, "density", strainwave::hysteresis::Densities{});
    bind_list<HysteresisVerbs>(core, hysteresis, "hysteresis", strainwave::hysteresis::Models{});
    bind_family<VariationVerbs>(core, "variation", "Variation of a stiffness with the angle of the wave generator.",
                                variation::Models{});
    bind_family<NoVerbs>(core, "ring", "Vibration of the flexspline's ring, which the mesh drives.", ring::Models{});
    core.def(
        "bearing_orders",
        [](int balls, double ball_diameter, double pitch_diameter, double contact_angle, double outer_speed) {
            const BallBearingGeometry<double> of{balls, ball_diameter, pitch_diameter, contact_angle, outer_speed};
            return nb::make_tuple(of.cage(), of.outer_ring(), of.inner_ring(), of.ball());
        },
        nb::sig("def bearing_orders(balls: int, ball_diameter: float, pitch_diameter: float, contact_angle: float, "
                "outer_speed: float) -> tuple[float, float, float, float]"),
        "Orders of cage, outer ring, inner ring and ball of a bearing, over its inner ring.");
    bind_family<NoVerbs>(core, "structure", "Bodies within a gear that have their own motion.", structure::Models{});
    bind_family<MaterialVerbs>(core, "material", "Torque of a gear that relaxes over time.", material::Models{});
    bind_family<NoVerbs>(core, "softening", "Fall of stiffness and hysteresis with the temperature.", softening::Models{});
}

}  // namespace strainwave::host
