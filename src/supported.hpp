#pragma once
#include <string_view>

namespace strainwave::host {

/// From the widest to what every machine has.
inline constexpr std::string_view instruction_sets[] = {"avx512", "avx2", "baseline"};

/// Whether this machine has an instruction set.
inline bool supported(std::string_view name) {
#if defined(__x86_64__)
    __builtin_cpu_init();
    if (name == "avx512")
        return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl") &&
               __builtin_cpu_supports("avx512bw");
    if (name == "avx2") return __builtin_cpu_supports("avx2");
#endif
    return name == "baseline";
}

}  // namespace strainwave::host
