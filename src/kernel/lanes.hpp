#pragma once
#include "standard.hpp"
#if !defined(__CUDACC_RTC__)
#include <strainwave/scalar/dual.hpp>
#include <strainwave/scalar/pack.hpp>
#endif

/// The lanes of scalars: how many members run in one, and the number of each.
namespace strainwave::kernel {

template <class S>
inline constexpr std::size_t lanes = sizeof(S) <= sizeof(double) ? 1 : sizeof(S) / sizeof(double);

inline double lane_of(double x, std::size_t) { return x; }
inline void set_lane(double& x, std::size_t, double value) { x = value; }

// Calls f with the value of each lane of some scalars.
template <class F>
void each_lane(double a, double b, double c, F&& f) {
    f(a, b, c);
}
#if !defined(__CUDACC_RTC__)
template <int n>
double lane_of(const Pack<n>& x, std::size_t i) {
    return x[int(i)];
}
template <int n>
void set_lane(Pack<n>& x, std::size_t i, double value) {
    x.set(int(i), value);
}
template <int n, class F>
void each_lane(const Pack<n>& a, const Pack<n>& b, const Pack<n>& c, F&& f) {
    for (int i = 0; i < n; ++i) f(a[i], b[i], c[i]);
}
template <int n, class F>
void each_lane(const Dual<n>& a, const Dual<n>& b, const Dual<n>& c, F&& f) {
    f(a.value, b.value, c.value);
}
#endif

}  // namespace strainwave::kernel
