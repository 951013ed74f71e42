#pragma once
#include <strainwave/math.hpp>

namespace strainwave {

/// A number with its derivatives with respect to n parameters: forward-mode differentiation, exact to rounding.
template <int n>
struct Dual {
    /// Whether a comparison holds. Not a bool, for which `&` looks like a slip of the pen to a compiler.
    struct Mask {
        bool holds;
        constexpr operator bool() const { return holds; }
        friend constexpr Mask operator&(Mask a, Mask b) { return {a.holds && b.holds}; }
        friend constexpr Mask operator!(Mask a) { return {!a.holds}; }
    };

    double value{0.0};
    double slope[n]{};

    constexpr Dual() = default;
    constexpr Dual(double x) : value(x) {}

    /// A function of `x` with this value and derivative.
    static constexpr Dual chain(const Dual& x, double value, double derivative) {
        Dual y(value);
        for (int i = 0; i < n; ++i) y.slope[i] = derivative * x.slope[i];
        return y;
    }

    friend constexpr Dual operator+(const Dual& a, const Dual& b) {
        Dual y(a.value + b.value);
        for (int i = 0; i < n; ++i) y.slope[i] = a.slope[i] + b.slope[i];
        return y;
    }
    friend constexpr Dual operator-(const Dual& a, const Dual& b) {
        Dual y(a.value - b.value);
        for (int i = 0; i < n; ++i) y.slope[i] = a.slope[i] - b.slope[i];
        return y;
    }
    friend constexpr Dual operator-(const Dual& a) {
        Dual y(-a.value);
        for (int i = 0; i < n; ++i) y.slope[i] = -a.slope[i];
        return y;
    }
    friend constexpr Dual operator*(const Dual& a, const Dual& b) {
        Dual y(a.value * b.value);
        for (int i = 0; i < n; ++i) y.slope[i] = a.slope[i] * b.value + a.value * b.slope[i];
        return y;
    }
    friend constexpr Dual operator/(const Dual& a, const Dual& b) {
        const double quotient = a.value / b.value, inverse = 1.0 / b.value;
        Dual y(quotient);
        for (int i = 0; i < n; ++i) y.slope[i] = (a.slope[i] - quotient * b.slope[i]) * inverse;
        return y;
    }
    friend constexpr Mask operator<(const Dual& a, const Dual& b) { return {a.value < b.value}; }
    friend constexpr Mask operator>(const Dual& a, const Dual& b) { return {a.value > b.value}; }
    friend constexpr Mask operator>=(const Dual& a, const Dual& b) { return {a.value >= b.value}; }
    friend constexpr Mask operator==(const Dual& a, const Dual& b) { return {a.value == b.value}; }

    friend constexpr Dual select(bool mask, const Dual& a, const Dual& b) { return mask ? a : b; }
    friend constexpr Dual abs(const Dual& x) { return x.value < 0.0 ? -x : x; }
    friend constexpr Dual detached(const Dual& x) { return Dual(x.value); }
    friend Dual rint(const Dual& x) { return Dual(strainwave::rint(x.value)); }
    friend Dual exp(const Dual& x) {
        const double y = strainwave::exp(x.value);
        return chain(x, y, y);
    }
    friend Dual log(const Dual& x) { return chain(x, strainwave::log(x.value), 1.0 / x.value); }
    friend Dual atan(const Dual& x) { return chain(x, strainwave::atan(x.value), 1.0 / (1.0 + x.value * x.value)); }
    friend Dual sqrt(const Dual& x) {
        const double y = strainwave::sqrt(x.value);
        return chain(x, y, 0.5 / y);
    }
    friend Dual sin(const Dual& x) { return chain(x, strainwave::sin(x.value), strainwave::cos(x.value)); }
    friend Dual cos(const Dual& x) { return chain(x, strainwave::cos(x.value), -strainwave::sin(x.value)); }
    friend SinCos<Dual> sincos(const Dual& x) {
        const double s = strainwave::sin(x.value), c = strainwave::cos(x.value);
        return {chain(x, s, c), chain(x, c, -s)};
    }
    /// A number that a derivative is sought for is treated as any other, whole or not.
    friend constexpr int whole(const Dual& x, int highest) {
        for (double d : x.slope)
            if (d != 0.0) return 0;
        return strainwave::whole(x.value, highest);
    }
};

template <int n>
inline constexpr bool differentiates<Dual<n>> = true;

}  // namespace strainwave
