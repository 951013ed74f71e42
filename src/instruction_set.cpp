#include "instruction_set.hpp"

#include <nanobind/nanobind.h>

#include <cstdlib>

namespace strainwave::host {

namespace {

struct Choice {
    const char* name;
    bool runs;
};

/// From the widest to what every machine has.
std::vector<Choice> choices() {
#if defined(__x86_64__)
    __builtin_cpu_init();
    // Of those that were compiled.
    const auto built = [](const char* name) {
        return std::string(SW_INSTRUCTION_SETS).find(std::string(",") + name + ",") != std::string::npos;
    };
    const bool wide = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                      __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
    return {{"avx512", wide && built("avx512")},
            {"avx2", __builtin_cpu_supports("avx2") && built("avx2")},
            {"baseline", built("baseline")}};
#else
    return {{"baseline", true}};
#endif
}

std::string choose() {
    const char* wanted = std::getenv("STRAINWAVE_INSTRUCTION_SET");
    std::string known;
    for (const Choice& choice : choices()) {
        if (!choice.runs) continue;
        if (!wanted || !*wanted || std::string(wanted) == choice.name) return choice.name;
        known += known.empty() ? choice.name : std::string(", ") + choice.name;
    }
    throw nanobind::value_error(
        ("STRAINWAVE_INSTRUCTION_SET = " + std::string(wanted) + " is not one that this machine runs: " + known).c_str());
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
