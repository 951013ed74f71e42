// What the headers need of the C++ library, for compilers that come without one, as Warp's for the CPU. NVRTC takes what it needs
// from strainwave/kernel/standard.hpp.
#pragma once
#if !defined(__CUDACC_RTC__)

namespace std {

template <class A, class B>
inline constexpr bool is_same_v = false;
template <class A>
inline constexpr bool is_same_v<A, A> = true;

#include "mathematics.hpp"

}  // namespace std
#endif
