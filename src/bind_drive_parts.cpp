#include "laws.hpp"

namespace strainwave::host {

void bind_drive_parts(nb::module_& core) {
    bind_family<NoVerbs>(core, "motor", "Motors on the input shaft.", motor::Models{});
    bind_family<NoVerbs>(core, "loads", "Loads on the output shaft.", load::Models{});
    nb::module_ compensation =
        family_module(core, "compensation", "Compensation of the errors of a gear: feed-forward, learning, observers, dither.");
    bind_list<FeedforwardVerbs>(core, compensation, "feedforward", strainwave::compensation::Feedforwards{});
    bind_list<NoVerbs>(core, compensation, "learning", strainwave::compensation::Learners{});
    bind_list<NoVerbs>(core, compensation, "observer", strainwave::compensation::Observers{});
    bind_list<NoVerbs>(core, compensation, "dither", strainwave::compensation::Dithers{});
    const Bound<ParameterCompensation> whole{bind<ParameterCompensation>(core, "Compensation", "compensation"),
                                             description_of<ParameterCompensation>()};
    property(whole, "active", "bool", "True if the compensation has an effect.",
             [](const ParameterCompensation& m) { return m.active(); });
    bind_family<NoVerbs>(core, "control", "Controllers: from the command to voltage, current or torque of the motor.",
                         control::Models{});
    bind_family<NoVerbs>(core, "sensor", "Sensors of a controller.", sensor::Models{});
    bind_family<NoVerbs>(core, "thermal", "Temperatures of a drive.", thermal::Models{});
    bind_family<NoVerbs>(core, "meter", "Powers and energies of a drive.", meter::Models{});
}

}  // namespace strainwave::host
