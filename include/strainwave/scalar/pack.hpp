#pragma once
#include <strainwave/math.hpp>

namespace strainwave {

namespace detail {

template <class T, int bytes>
struct Vector {
    typedef T type [[gnu::vector_size(bytes)]];
};

}  // namespace detail

/// `n` numbers that take every step together: one vector register, or several, of whatever the machine has.
template <int n>
struct Pack {
    using Lanes = typename detail::Vector<double, n * sizeof(double)>::type;
    using Bits = typename detail::Vector<long long, n * sizeof(double)>::type;

    /// Which lanes a comparison holds in: all bits of a lane, or none.
    struct Mask {
        Bits bits;
        friend constexpr Mask operator&(const Mask& a, const Mask& b) { return {a.bits & b.bits}; }
        friend constexpr Mask operator!(const Mask& a) { return {~a.bits}; }
        friend bool any(const Mask& mask) {
            long long either = 0;
            for (int i = 0; i < n; ++i) either |= mask.bits[i];
            return either != 0;
        }
        friend bool all(const Mask& mask) { return !any(!mask); }
    };

    Lanes lanes;

    constexpr Pack() : lanes{} {}
    constexpr Pack(double x) : lanes(Lanes{} + x) {}
    constexpr explicit Pack(Lanes x) : lanes(x) {}

    double operator[](int i) const { return lanes[i]; }
    void set(int i, double x) { lanes[i] = x; }

    friend constexpr Pack operator+(const Pack& a, const Pack& b) { return Pack(a.lanes + b.lanes); }
    friend constexpr Pack operator-(const Pack& a, const Pack& b) { return Pack(a.lanes - b.lanes); }
    friend constexpr Pack operator*(const Pack& a, const Pack& b) { return Pack(a.lanes * b.lanes); }
    friend constexpr Pack operator/(const Pack& a, const Pack& b) { return Pack(a.lanes / b.lanes); }
    friend constexpr Pack operator-(const Pack& a) { return Pack(-a.lanes); }
    friend constexpr Mask operator<(const Pack& a, const Pack& b) { return {a.lanes < b.lanes}; }
    friend constexpr Mask operator>(const Pack& a, const Pack& b) { return {a.lanes > b.lanes}; }
    friend constexpr Mask operator>=(const Pack& a, const Pack& b) { return {a.lanes >= b.lanes}; }
    friend constexpr Mask operator==(const Pack& a, const Pack& b) { return {a.lanes == b.lanes}; }

    friend Pack select(const Mask& mask, const Pack& a, const Pack& b) {
        return Pack((Lanes)(((Bits)a.lanes & mask.bits) | ((Bits)b.lanes & ~mask.bits)));
    }
    friend Pack abs(const Pack& x) { return Pack((Lanes)((Bits)x.lanes & 0x7fffffffffffffffLL)); }
    /// Nearest whole number, ties to even; exact for |x| < 2^51.
    friend Pack rint(const Pack& x) {
        const Pack magic(6755399441055744.0);
        return (x + magic) - magic;
    }
    friend Pack sqrt(const Pack& x) {
        return each(x, [](double lane) { return strainwave::sqrt(lane); });
    }
    friend Pack exp(const Pack& x) {
        return each(x, [](double lane) { return strainwave::exp(lane); });
    }
    friend Pack log(const Pack& x) {
        return each(x, [](double lane) { return strainwave::log(lane); });
    }
    friend Pack atan(const Pack& x) {
        return each(x, [](double lane) { return strainwave::atan(lane); });
    }
    friend SinCos<Pack> sincos(const Pack& x) {
        SinCos<Pack> y{};
        for (int i = 0; i < n; ++i) {
            const auto one = strainwave::sincos(x[i]);
            y.sin.set(i, one.sin);
            y.cos.set(i, one.cos);
        }
        return y;
    }
    friend Pack sin(const Pack& x) { return sincos(x).sin; }
    friend Pack cos(const Pack& x) { return sincos(x).cos; }
    /// Whole in every lane, and the same.
    friend int whole(const Pack& x, int highest) { return all(x == Pack(x[0])) ? strainwave::whole(x[0], highest) : 0; }

private:
    template <class F>
    static Pack each(const Pack& x, F&& f) {
        Pack y;
        for (int i = 0; i < n; ++i) y.set(i, f(x[i]));
        return y;
    }
};

}  // namespace strainwave
