#pragma once
#include <strainwave/math.hpp>

/// Zones of load under the two lobes of the wave generator, of teeth and of balls of its bearing. The weight in a zone falls
/// as 1 + cos from its middle to zero at its ends.
namespace strainwave::lobes {

/// sin(x) / x.
template <class S>
constexpr S sine_quotient(const S& x) {
    const auto near = abs(x) < S(1e-3);
    return select(near, S(1.0) - x * x * S(1.0 / 6.0), sincos(x).sin / select(near, S(1.0), x));
}

/// The share of a wave that the weighted mean over a zone leaves: `x` is the phase [rad] from the middle to an end.
template <class S>
constexpr S zone_share(const S& x) {
    return sine_quotient(x) + S(0.5) * (sine_quotient(x + S(pi)) + sine_quotient(x - S(pi)));
}

/// The same at both lobes, for a wave of n periods around the circumference; the first lobe has the share p of the weight.
template <class S>
constexpr S of_both(int n, const S& first_lobe, const S& zone) {
    return n % 2 == 0 ? zone : (first_lobe + first_lobe - S(1.0)) * zone;
}

}  // namespace strainwave::lobes
