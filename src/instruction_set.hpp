#pragma once
#include <string>

#include "simulate.hpp"

namespace strainwave::host {

/// The loops over time for the widest instruction set that this machine has, or for the one that STRAINWAVE_INSTRUCTION_SET names:
/// baseline, avx2 or avx512. All give the same numbers to the last bit. Loaded when first needed; needs Python's lock.
const Kernels& kernels();

/// The name of that instruction set.
const std::string& instruction_set();

}  // namespace strainwave::host
