#include "verbs.hpp"

namespace nb = nanobind;
using namespace strainwave;

namespace strainwave::host {

void bind_inputs(nb::module_& core);
void bind_drives(nb::module_& core);
void bind_runs(nb::module_& core);

namespace {

/// The law's name in C++ is its name in Python: LuGre of `strainwave::friction::LuGre<double>`.
template <class M>
const char* python_name() {
    const std::string text = __PRETTY_FUNCTION__;
    const std::size_t end = text.find("<double"), start = text.rfind("::", end) + 2;
    return kept(text.substr(start, end - start));
}

/// A family of models as a module of the package, and its list by file name.
nb::module_ family_module(nb::module_& core, const char* name, const char* doc) {
    nb::module_ family = nb::borrow<nb::module_>(PyImport_AddModule((std::string("strainwave.") + name).c_str()));
    family.attr("__doc__") = doc;
    core.attr(name) = family;
    return family;
}

/// The models of a list, and the list by their names in files.
template <template <class...> class... Law>
void bind_list(nb::module_& core, nb::module_ family, const char* name, List<Law...>) {
    nb::dict models;
    (bind_model<AtRunTime<Law, double>>(family, python_name<Law<double>>()), ...);
    ((models[Law<double>::name] = nb::type<AtRunTime<Law, double>>()), ...);
    core.attr("families")[name] = models;
}

template <class L>
void bind_family(nb::module_& core, const char* name, const char* doc, L list) {
    bind_list(core, family_module(core, name, doc), name, list);
}

}  // namespace
}  // namespace strainwave::host

NB_MODULE(_core, core) {
    nb::set_leak_warnings(false);  // models in default arguments and module tables live until the interpreter ends
    core.attr("__doc__") = "The physics, compiled.";
    core.attr("families") = nb::dict();
    core.attr("PassivityWarning") = nb::steal(PyErr_NewExceptionWithDoc(
        "strainwave._core.PassivityWarning", "A set of parameters lets its model create energy.", PyExc_UserWarning, nullptr));
    using namespace strainwave::host;
    bind_family(core, "kinematics", "Rigid motion: the signed ratio from the teeth and the fixed member.", kinematics::Models{});
    nb::module_ error = family_module(core, "kinematic_error", "Pure kinematic error at the output, over the input angle.");
    bind_list(core, error, "kinematic_error", kinematic_error::Models{});
    bind_list(core, error, "kinematic_noise", kinematic_error::Noises{});
    bind_family(core, "friction", "Friction torque of one side, over its speed.", friction::Models{});
    bind_family(core, "stiffness", "Elastic torque over the twist.", stiffness::Models{});
    nb::module_ hysteresis = family_module(core, "hysteresis", "Torque that depends on the history of the twist.");
    bind_model<strainwave::hysteresis::PrandtlIshlinskii<double>>(hysteresis, "PrandtlIshlinskii");
    bind_list(core, hysteresis, "density", strainwave::hysteresis::Densities{});
    bind_list(core, hysteresis, "hysteresis", strainwave::hysteresis::Models{});
    bind_family(core, "motor", "Motors on the input shaft.", motor::Models{});
    bind_family(core, "control", "What turns the command into the motor's voltage, current or torque.", control::Models{});
    bind_family(core, "loads", "What the output shaft carries.", load::Models{});
    bind_family(core, "sensor", "What a controller sees a quantity by.", sensor::Models{});
    bind_family(core, "variation", "How a stiffness varies as the wave generator turns.", variation::Models{});
    bind_family(core, "structure", "What moves within a gear by itself.", structure::Models{});
    bind_family(core, "softening", "How a gear gives way as it warms up.", softening::Models{});
    bind_family(core, "thermal", "Temperatures of a drive.", thermal::Models{});
    bind_family(core, "meter", "Powers and energies of a drive.", meter::Models{});
    bind_inputs(core);
    bind_drives(core);
    bind_runs(core);
}
