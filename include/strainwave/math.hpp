#pragma once
/// The one place that knows where a scalar's mathematics comes from. Physics calls these names unqualified; packs and
/// dual numbers bring their own through argument-dependent lookup. No `if` on a scalar: `select` serves every lane.
#include <strainwave/scalar/elementary.hpp>
#if !defined(__CUDACC_RTC__)
#include <cmath>
#endif

namespace strainwave {

// NVRTC has the functions of the C library, and no namespace of its own for them.
#if defined(__CUDACC_RTC__)
namespace library {
using ::atan;
using ::cos;
using ::exp;
using ::fabs;
using ::log;
using ::rint;
using ::sin;
using ::sqrt;
}  // namespace library
#else
namespace library = std;
#endif
using library::atan;
using library::fabs;
using library::log;
using library::sqrt;
constexpr double abs(double x) { return !__builtin_is_constant_evaluated() ? fabs(x) : x > 0.0 ? x : 0.0 - x; }
constexpr float abs(float x) { return !__builtin_is_constant_evaluated() ? fabs(x) : x > 0.0f ? x : 0.0f - x; }
// Constants that the compiler evaluates, such as the numbers of firmware, use `elementary` in every scalar.
constexpr double rint(double x) {
    if (!__builtin_is_constant_evaluated()) return library::rint(x);
    return abs(x) < 0x1p51 ? (x + elementary::rounder) - elementary::rounder : x;
}
constexpr float rint(float x) { return __builtin_is_constant_evaluated() ? float(rint(double(x))) : library::rint(x); }
constexpr float exp(float x) { return __builtin_is_constant_evaluated() ? float(elementary::exp(double(x))) : library::exp(x); }
constexpr float sin(float x) {
    return __builtin_is_constant_evaluated() ? float(elementary::sincos(double(x)).sine) : library::sin(x);
}
constexpr float cos(float x) {
    return __builtin_is_constant_evaluated() ? float(elementary::sincos(double(x)).cosine) : library::cos(x);
}
constexpr double exp(double x) { return elementary::exp(x); }
constexpr double sin(double x) { return abs(x) < elementary::farthest ? elementary::sincos(x).sine : library::sin(x); }
constexpr double cos(double x) { return abs(x) < elementary::farthest ? elementary::sincos(x).cosine : library::cos(x); }
inline constexpr double pi = 3.14159265358979323846;
/// exp(-80) is below the rounding of 1 in every scalar; further out exp only underflows, slowly.
inline constexpr double beyond_digits = 80.0;

constexpr double select(bool mask, double a, double b) { return mask ? a : b; }
constexpr float select(bool mask, float a, float b) { return mask ? a : b; }
constexpr bool any(bool mask) { return mask; }
constexpr bool all(bool mask) { return mask; }

/// True if a scalar has derivatives; `value_only` drops them.
template <class S>
inline constexpr bool differentiates = false;
template <class S>
constexpr S value_only(const S& x) {
    return x;
}
/// True if a derivative of `x` is not zero.
template <class S>
constexpr bool is_differentiated(const S&) {
    return false;
}

/// The numbers that tables of constants for a scalar are made of: its own kind, so that none is converted at run time.
template <class S>
struct RealOf {
    using type = double;
};
template <>
struct RealOf<float> {
    using type = float;
};
template <class S>
using Real = typename RealOf<S>::type;

/// The whole number that `x` is, if it lies in [1, highest]; else 0.
template <class S>
constexpr int whole(const S& x, int highest) {
    for (int n = 1; n <= highest; ++n)
        if (x == S(n)) return n;
    return 0;
}

template <class S>
struct SinCos {
    S sin, cos;
};

constexpr SinCos<double> sincos(double x) {
    if (!(abs(x) < elementary::farthest)) return {library::sin(x), library::cos(x)};
    const auto found = elementary::sincos(x);
    return {found.sine, found.cosine};
}
constexpr SinCos<float> sincos(float x) { return {sin(x), cos(x)}; }

/// Each of `n` angles within some turns of zero becomes its cosine.
template <class S>
constexpr void to_cosines(S* x, int n) {
    for (int i = 0; i < n; ++i) x[i] = cos(x[i]);
}
#if !defined(__CUDACC_RTC__)
inline void to_cosines(double* x, int n) { elementary::to_cosines(x, n); }
#endif

template <class S>
constexpr S min(const S& a, const S& b) {
    return select(b < a, b, a);
}
template <class S>
constexpr S max(const S& a, const S& b) {
    return select(a < b, b, a);
}
template <class S>
constexpr S clip(const S& x, const S& low, const S& high) {
    return min(max(x, low), high);
}
/// -1, 0 or 1.
template <class S>
constexpr S sign(const S& x) {
    return select(x > S(0.0), S(1.0), select(x < S(0.0), S(-1.0), S(0.0)));
}
/// `magnitude` with the sign of `x`, odd in x.
template <class S>
constexpr S along(const S& x, const S& magnitude) {
    return select(x < S(0.0), -magnitude, magnitude);
}

}  // namespace strainwave
