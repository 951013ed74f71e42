#include "laws.hpp"

namespace nb = nanobind;
using namespace strainwave;

namespace strainwave::host {

void bind_gear_laws(nb::module_& core);
void bind_gear(nb::module_& core);
void bind_drive_parts(nb::module_& core);
void bind_faults(nb::module_& core);
void bind_inputs(nb::module_& core);
void bind_drives(nb::module_& core);
void bind_runs(nb::module_& core);

nb::module_ family_module(nb::module_& core, const char* name, const char* doc) {
    nb::module_ family = nb::borrow<nb::module_>(PyImport_AddModule((std::string("strainwave.") + name).c_str()));
    family.attr("__doc__") = doc;
    core.attr(name) = family;
    return family;
}

}  // namespace strainwave::host

NB_MODULE(_core, core) {
    nb::set_leak_warnings(false);  // models in default arguments and module tables live until the interpreter ends
    core.attr("__doc__") = "The physics, compiled.";
    core.attr("families") = nb::dict();
    core.attr("PassivityWarning") = nb::steal(PyErr_NewExceptionWithDoc(
        "strainwave._core.PassivityWarning", "The parameters of a model allow it to create energy.", PyExc_UserWarning, nullptr));
    strainwave::host::bind_gear_laws(core);
    strainwave::host::bind_gear(core);
    strainwave::host::bind_drive_parts(core);
    strainwave::host::bind_faults(core);
    strainwave::host::bind_inputs(core);
    strainwave::host::bind_drives(core);
    strainwave::host::bind_runs(core);
}
