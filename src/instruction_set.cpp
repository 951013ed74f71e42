#include "instruction_set.hpp"

#include <nanobind/nanobind.h>

#include <cstdlib>

#include "supported.hpp"

namespace strainwave::host {

namespace {

/// Whether the loops over time were compiled for an instruction set.
bool built(std::string_view name) {
    return std::string_view(SW_INSTRUCTION_SETS).find("," + std::string(name) + ",") != std::string_view::npos;
}

std::string choose() {
    const char* wanted = std::getenv("STRAINWAVE_INSTRUCTION_SET");
    std::string known;
    for (const std::string_view name : instruction_sets) {
        if (!built(name) || !supported(name)) continue;
        if (!wanted || !*wanted || name == wanted) return std::string(name);
        known += (known.empty() ? "" : ", ") + std::string(name);
    }
    if (known.empty())
        throw nanobind::value_error("this build has no instruction set that this machine runs; build it anew on this machine");
    throw nanobind::value_error(
        ("STRAINWAVE_INSTRUCTION_SET = " + std::string(wanted) + " is not one that this build and this machine have: " + known)
            .c_str());
}

}  // namespace

const std::string& instruction_set() {
    static const std::string chosen = choose();
    return chosen;
}

const Kernels& kernels() {
    static const Kernels* loaded = nullptr;
    if (!loaded) {
        const std::string module = "strainwave._time_" + instruction_set();
        PyObject* imported = PyImport_ImportModule(module.c_str());
        if (!imported) throw nanobind::python_error();
        Py_DECREF(imported);  // sys.modules keeps it
        loaded = static_cast<const Kernels*>(PyCapsule_Import((module + ".kernels").c_str(), 0));
        if (!loaded) throw nanobind::python_error();
    }
    return *loaded;
}

}  // namespace strainwave::host
