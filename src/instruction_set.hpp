#pragma once
#include <string>

namespace strainwave::host {

/// The widest instruction set that this machine has, or the one that STRAINWAVE_INSTRUCTION_SET names: baseline, avx2 or avx512. Kernels
/// are compiled for it. All give the same numbers to the last bit.
std::string instruction_set();

}  // namespace strainwave::host
