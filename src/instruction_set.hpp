#pragma once
#include <string>
#include <vector>

namespace strainwave::host {

/// The instruction sets of this machine that kernels can be compiled for, the widest first: some of avx512, avx2 and baseline.
std::vector<std::string> instruction_sets();

/// The widest instruction set that this machine has, or the one that STRAINWAVE_INSTRUCTION_SET names. Kernels
/// are compiled for it. All give the same numbers to the last bit.
std::string instruction_set();

}  // namespace strainwave::host
