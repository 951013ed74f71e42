#pragma once

namespace strainwave::detail {

/// True for a scalar that two evaluations together take little longer with than one: the numbers of each fill a register.
template <class S>
inline constexpr bool takes_pairs = false;

}  // namespace strainwave::detail

// Vectors are for packs, which NVRTC has no place for.
#if !defined(__CUDACC_RTC__)
namespace strainwave::detail {

template <class T, int bytes>
struct Vector {
    typedef T type [[gnu::vector_size(bytes)]];
};

/// Doubles in a register of the instruction set compiled for.
#if defined(__AVX512F__)
inline constexpr int register_width = 8;
#elif defined(__AVX__)
inline constexpr int register_width = 4;
#else
inline constexpr int register_width = 2;
#endif
template <>
inline constexpr bool takes_pairs<double> = register_width >= 4;

}  // namespace strainwave::detail
#endif

/// exp, sin and cos out of sums, products and a few bits: the same numbers in a double and in every lane of a pack, on every
/// instruction set and with every library. Within 3 units in the last place.
namespace strainwave::elementary {

/// Integers as wide as the lanes.
template <class L>
struct Word {
    using type = decltype(L{} < L{});
};
template <>
struct Word<double> {
    using type = long long;
};
template <class L>
using WordOf = typename Word<L>::type;

template <class L>
constexpr WordOf<L> bits(const L& x) {
    return __builtin_bit_cast(WordOf<L>, x);
}
template <class L>
constexpr L lanes(const WordOf<L>& word) {
    return __builtin_bit_cast(L, word);
}
template <class L>
constexpr L everywhere(double x) {
    return L{} + x;
}
/// `a` where the mask is all bits, `b` where it is none.
template <class L>
constexpr L blend(const WordOf<L>& mask, const L& a, const L& b) {
    return mask ? a : b;
}
/// x within [low, high]; not-a-number stays so.
template <class L>
constexpr L clipped(const L& x, double low, double high) {
    const L above = blend(x < low, everywhere<L>(low), x);
    return blend(above > high, everywhere<L>(high), above);
}
constexpr double clipped(double x, double low, double high) { return x < low ? low : x > high ? high : x; }

/// 3/2 2^52: added to a number, it leaves the nearest whole one in the last bits.
inline constexpr double rounder = 6755399441055744.0;
inline constexpr long long rounder_bits = 0x4338000000000000;

/// The sum of c[k] x^k over k < n, in four chains, so that fewer products wait for each other.
template <class L, int n>
constexpr L polynomial(const double (&c)[n], const L& x) {
    const L x2 = x * x, x4 = x2 * x2;
    constexpr int top = (n - 1) / 4 * 4;
    L sum[4];
    for (int j = 0; j < 4; ++j) sum[j] = everywhere<L>(top + j < n ? c[top + j] : 0.0);
    for (int k = top - 4; k >= 0; k -= 4)
        for (int j = 0; j < 4; ++j) sum[j] = sum[j] * x4 + c[k + j];
    return (sum[0] + sum[1] * x) + (sum[2] + sum[3] * x) * x2;
}

/// 2^(j/32)
inline constexpr double roots_of_two[32] = {
    1.0,
    1.0218971486541166,
    1.0442737824274138,
    1.0671404006768237,
    1.0905077326652577,
    1.1143867425958924,
    1.1387886347566916,
    1.1637248587775775,
    1.189207115002721,
    1.215247359980469,
    1.241857812073484,
    1.2690509571917332,
    1.2968395546510096,
    1.3252366431597413,
    1.3542555469368927,
    1.383909881963832,
    1.4142135623730951,
    1.4451808069770467,
    1.4768261459394993,
    1.5091644275934228,
    1.5422108254079407,
    1.5759808451078865,
    1.6104903319492543,
    1.645755478153965,
    1.681792830507429,
    1.718619298122478,
    1.7562521603732995,
    1.7947090750031072,
    1.8340080864093424,
    1.8741676341103,
    1.9152065613971474,
    1.9571441241754002,
};
template <class L>
constexpr L root_of_two(const WordOf<L>& j) {
    L root{};
    for (unsigned i = 0; i < sizeof(L) / sizeof(double); ++i) root[i] = roots_of_two[j[i]];
    return root;
}
template <>
constexpr double root_of_two<double>(const long long& j) {
    return roots_of_two[j];
}

/// 2^n for whole n in [-1022, 1023].
template <class L>
constexpr L power_of_two(const WordOf<L>& n) {
    return lanes<L>((n + 1023) << 52);
}

/// e^x = 2^n 2^(j/32) e^r, |r| <= ln 2 / 64; 0 below -746, infinite beyond 709.8.
template <class L>
constexpr L exp(const L& x) {
    // ln 2 / 32 in two parts, the first short enough that its product with n is exact.
    constexpr double per_root = 46.166241308446829, ln = 0.693147180369123816490 / 32, ln_rest = 1.90821492927058770002e-10 / 32;
    const L within = clipped(x, -746.0, 710.0), shifted = within * per_root + rounder, n = shifted - rounder;
    const L r = (within - n * ln) - n * ln_rest, square = r * r;
    const L rest = r + square * ((0.5 + r * (1.0 / 6)) + square * ((1.0 / 24 + r * (1.0 / 120)) + square * (1.0 / 720)));
    const WordOf<L> whole = bits(shifted) - rounder_bits, power = whole >> 5, half = power >> 1;
    const L root = root_of_two<L>(whole & 31);
    return ((root + root * rest) * power_of_two<L>(half)) * power_of_two<L>(power - half);
}

template <class L>
struct SineCosine {
    L sine, cosine;
};

// Not within the function: at -O2, GCC would copy them at each call.
inline constexpr double sine_series[] = {-1.0 / 6,
                                         1.0 / 120,
                                         -1.0 / 5040,
                                         1.0 / 362880,
                                         -1.0 / 39916800,
                                         1.0 / 6227020800.0,
                                         -1.0 / 1307674368000.0,
                                         1.0 / 355687428096000.0};
inline constexpr double cosine_series[] = {1.0 / 24,
                                           -1.0 / 720,
                                           1.0 / 40320,
                                           -1.0 / 3628800,
                                           1.0 / 479001600,
                                           -1.0 / 87178291200.0,
                                           1.0 / 20922789888000.0,
                                           -1.0 / 6402373705728000.0};

/// Sine and cosine of |x| < `farthest`: x = n pi/2 + r, |r| <= pi/4.
inline constexpr double farthest = 1e6;
template <class L>
constexpr SineCosine<L> sincos(const L& x) {
    // pi/2 in parts of 33 bits, whose products with n are exact.
    constexpr double per_quarter = 0.63661977236758134, quarter = 1.57079632673412561417, quarter2 = 6.07710050630396597660e-11,
                     quarter3 = 2.02226624879595063154e-21;
    const L shifted = x * per_quarter + rounder, n = shifted - rounder;
    const L r = ((x - n * quarter) - n * quarter2) - n * quarter3, square = r * r;
    const L s = r + r * square * polynomial(sine_series, square);
    const L c = 1.0 - square * (0.5 - square * polynomial(cosine_series, square));
    const WordOf<L> turned = bits(shifted), odd = -(turned & 1), flip_sine = (turned & 2) << 62,
                    flip_cosine = ((turned + 1) & 2) << 62;
    return {lanes<L>(bits(blend<L>(odd, c, s)) ^ flip_sine), lanes<L>(bits(blend<L>(odd, s, c)) ^ flip_cosine)};
}

#if !defined(__CUDACC_RTC__)
/// Each of `n` angles below `farthest` becomes its cosine, a register full at a time.
inline void to_cosines(double* x, int n) {
    constexpr int width = detail::register_width;
    using Lanes = detail::Vector<double, width* int(sizeof(double))>::type;
    int i = 0;
    for (; i + width <= n; i += width) {
        Lanes some;
        __builtin_memcpy(&some, x + i, sizeof some);
        some = sincos(some).cosine;
        __builtin_memcpy(x + i, &some, sizeof some);
    }
    for (; i < n; ++i) x[i] = sincos(x[i]).cosine;
}
#endif

}  // namespace strainwave::elementary
