#pragma once
/// Names of the standard library that kernels use, for compilers that come without it: NVRTC, and those that a text for another
/// program sets SW_NO_STANDARD_LIBRARY for.
#if defined(__CUDACC_RTC__) || defined(SW_NO_STANDARD_LIBRARY)
namespace std {

using size_t = decltype(sizeof 0);
using uint8_t = unsigned char;

template <class A, class B>
inline constexpr bool is_same_v = false;
template <class A>
inline constexpr bool is_same_v<A, A> = true;

template <class T>
void swap(T& a, T& b) {
    T before = a;
    a = b;
    b = before;
}
inline bool equal(const double* first, const double* last, const double* other) {
    for (; first != last; ++first, ++other)
        if (!(*first == *other)) return false;
    return true;
}

}  // namespace std
#else
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <new>
#include <type_traits>
#include <utility>
#endif
