// Mathematics of the C library under the names of <cmath>, for compilers that come without the C++ library, such as Warp's for the CPU.
#pragma once
#define SW_NO_STANDARD_LIBRARY
#if !defined(__CUDACC_RTC__)

namespace std {

#include "mathematics.hpp"

}  // namespace std
#endif
