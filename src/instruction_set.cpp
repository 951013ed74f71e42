#include "instruction_set.hpp"

#include <nanobind/nanobind.h>

#include <cstdlib>
#include <string_view>

namespace strainwave::host {

namespace {

/// Ordered from the widest to the one of every machine.
constexpr std::string_view all[] = {"avx512", "avx2", "baseline"};

bool supported(std::string_view name) {
#if defined(__x86_64__)
    __builtin_cpu_init();
    if (name == "avx512")
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
               __builtin_cpu_supports("avx512bw");
    if (name == "avx2") return __builtin_cpu_supports("avx2");
#endif
    return name == "baseline";
}

}  // namespace

std::vector<std::string> instruction_sets() {
    std::vector<std::string> known;
    for (const std::string_view name : all)
        if (supported(name)) known.emplace_back(name);
    return known;
}

std::string instruction_set() {
    const char* const wanted = std::getenv("STRAINWAVE_INSTRUCTION_SET");
    std::string known;
    for (const std::string& name : instruction_sets()) {
        if (!wanted || !*wanted || name == wanted) return name;
        known += (known.empty() ? "" : ", ") + name;
    }
    throw nanobind::value_error(
        ("STRAINWAVE_INSTRUCTION_SET = " + std::string(wanted) + " is not one that this machine has: " + known).c_str());
}

}  // namespace strainwave::host
