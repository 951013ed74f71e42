#pragma once
#include <strainwave/math.hpp>

namespace strainwave {

namespace detail {

/// 1 / (k + 2)!, alternating: the series of (x - 1 + e^-x) / x^2, cut where x <= 1/2 needs no more.
template <class R>
inline constexpr R decay_series[13] = {
    R(1.0 / 2),
    R(-1.0 / 6),
    R(1.0 / 24),
    R(-1.0 / 120),
    R(1.0 / 720),
    R(-1.0 / 5040),
    R(1.0 / 40320),
    R(-1.0 / 362880),
    R(1.0 / 3628800),
    R(-1.0 / 39916800),
    R(1.0 / 479001600.0),
    R(-1.0 / 6227020800.0),
    R(1.0 / 87178291200.0),
};

}  // namespace detail

/// e^(-rate p) integrated over a path of length p, once and twice; without loss of digits on short paths.
template <class S>
struct Decayed {
    S once;
    S twice;

    static constexpr Decayed along_path(const S& rate, const S& path) {
        constexpr double series_below = 0.5;
        const S x = rate * path, small = min(x, S(series_below));
        S series{0.0};
        for (int k = 12; k >= 0; --k) series = series * small + S(detail::decay_series<Real<S>>[k]);
        const S exact = (S(1.0) - exp(-min(x, S(beyond_digits)))) / rate;
        return {select(x < S(series_below), path * (S(1.0) - small * series), exact),
                select(x < S(series_below), path * path * series, (path - exact) / rate)};
    }
};

}  // namespace strainwave
