#pragma once
#include <strainwave/scalar/pack.hpp>

namespace strainwave {

namespace detail {

/// A vector that lies anywhere: a number and its derivatives without a gap between them.
template <class T, int bytes>
struct Slope {
    typedef T type [[gnu::vector_size(bytes), gnu::aligned(alignof(T))]];
};

}  // namespace detail

/// A number with its derivatives with respect to n parameters, n a power of two: forward-mode differentiation, exact to rounding.
/// The derivatives are the lanes of a vector.
template <int n>
struct Dual {
    /// Result of a comparison. Not a bool, for which `&` looks like a slip of the pen to a compiler.
    struct Mask {
        bool holds;
        constexpr operator bool() const { return holds; }
        friend constexpr Mask operator&(Mask a, Mask b) { return {a.holds && b.holds}; }
        friend constexpr Mask operator!(Mask a) { return {!a.holds}; }
    };

    double value{0.0};
    typename detail::Slope<double, n * sizeof(double)>::type slope{};

    constexpr Dual() = default;
    // Written out, so that the derivatives are copied as a vector: of types it may copy as bytes, GCC copies bytes.
    constexpr Dual(const Dual& x) : value(x.value), slope(x.slope) {}
    constexpr Dual& operator=(const Dual& x) {
        value = x.value;
        slope = x.slope;
        return *this;
    }
    constexpr Dual(double x) : value(x) {}

    /// A function of `x` with this value and derivative.
    static constexpr Dual chain(const Dual& x, double value, double derivative) {
        Dual y(value);
        y.slope = x.slope * derivative;
        return y;
    }

    friend constexpr Dual operator+(const Dual& a, const Dual& b) {
        Dual y(a.value + b.value);
        y.slope = a.slope + b.slope;
        return y;
    }
    friend constexpr Dual operator-(const Dual& a, const Dual& b) {
        Dual y(a.value - b.value);
        y.slope = a.slope - b.slope;
        return y;
    }
    friend constexpr Dual operator-(const Dual& a) {
        Dual y(-a.value);
        y.slope = -a.slope;
        return y;
    }
    friend constexpr Dual operator*(const Dual& a, const Dual& b) {
        Dual y(a.value * b.value);
        y.slope = a.slope * b.value + b.slope * a.value;
        return y;
    }
    friend constexpr Dual operator/(const Dual& a, const Dual& b) {
        const double quotient = a.value / b.value, inverse = 1.0 / b.value;
        Dual y(quotient);
        y.slope = (a.slope - b.slope * quotient) * inverse;
        return y;
    }
    friend constexpr Mask operator<(const Dual& a, const Dual& b) { return {a.value < b.value}; }
    friend constexpr Mask operator>(const Dual& a, const Dual& b) { return {a.value > b.value}; }
    friend constexpr Mask operator>=(const Dual& a, const Dual& b) { return {a.value >= b.value}; }
    friend constexpr Mask operator==(const Dual& a, const Dual& b) { return {a.value == b.value}; }

    friend constexpr Dual select(bool mask, const Dual& a, const Dual& b) {
        Dual y(mask ? a.value : b.value);
        y.slope = mask ? a.slope : b.slope;
        return y;
    }
    friend constexpr Dual abs(const Dual& x) { return x.value < 0.0 ? -x : x; }
    friend constexpr Dual value_only(const Dual& x) { return Dual(x.value); }
    /// A root of f with its derivatives by the parameters of f (implicit function theorem). The derivative of f by its argument
    /// follows from an argument whose slope is larger by 2^100, so that the slopes of the parameters round nothing. Each lane uses
    /// its own: a derivative is the same whichever others are taken with it.
    template <class F>
    friend constexpr Dual moving_root(const F& f, const Dual& root) {
        constexpr double steep = 0x1p100, flat = 1e-30;
        Dual steeper = root;
        steeper.slope += steep;
        const Dual at_root = f(root), perturbed = f(steeper);
        Dual moving = root;
        for (int i = 0; i < n; ++i) {
            const double by_argument = (perturbed.slope[i] - at_root.slope[i]) * (1.0 / steep);
            if (strainwave::abs(by_argument) > flat) moving.slope[i] -= at_root.slope[i] / by_argument;
        }
        return moving;
    }
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
    friend Dual sin(const Dual& x) { return sincos(x).sin; }
    friend Dual cos(const Dual& x) { return sincos(x).cos; }
    friend SinCos<Dual> sincos(const Dual& x) {
        const auto [s, c] = strainwave::sincos(x.value);
        return {chain(x, s, c), chain(x, c, -s)};
    }
    friend constexpr bool is_differentiated(const Dual& x) {
        for (int i = 0; i < n; ++i)
            if (x.slope[i] != 0.0) return true;
        return false;
    }
    /// A number with a derivative never counts as whole.
    friend constexpr int whole(const Dual& x, int highest) {
        return is_differentiated(x) ? 0 : strainwave::whole(x.value, highest);
    }
};

template <int n>
inline constexpr bool differentiates<Dual<n>> = true;

}  // namespace strainwave
