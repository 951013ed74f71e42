#pragma once
/// What kernels take of the standard library. NVRTC brings none.
#if defined(__CUDACC_RTC__)
namespace std {

using ::size_t;
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
