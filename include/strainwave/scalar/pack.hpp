#pragma once
#include <strainwave/math.hpp>
#include <strainwave/scalar/elementary.hpp>

namespace strainwave {

/// `n` numbers that take every step together, in as many vector registers as they need. Every lane holds the same numbers whatever
/// the registers.
template <int n, int register_width = detail::register_width>
struct Pack {
    static constexpr int width = register_width < n ? register_width : n, count = n / width;
    using Lanes = typename detail::Vector<double, width * sizeof(double)>::type;
    using Bits = elementary::WordOf<Lanes>;

    /// Lanes in which a comparison is true: all bits of a lane, or none.
    struct Mask {
        Bits part[count];
        friend constexpr Mask operator&(const Mask& a, const Mask& b) {
            Mask y;
            for (int i = 0; i < count; ++i) y.part[i] = a.part[i] & b.part[i];
            return y;
        }
        friend constexpr Mask operator!(const Mask& a) {
            Mask y;
            for (int i = 0; i < count; ++i) y.part[i] = ~a.part[i];
            return y;
        }
        friend bool any(const Mask& mask) {
            Bits either = mask.part[0];
            for (int i = 1; i < count; ++i) either |= mask.part[i];
            long long found = 0;
            for (int i = 0; i < width; ++i) found |= either[i];
            return found != 0;
        }
        friend bool all(const Mask& mask) { return !any(!mask); }
    };

    Lanes part[count];

    Pack() = default;
    constexpr Pack(double x) {
        for (Lanes& lanes : part) lanes = Lanes{} + x;
    }
    // Written out, so that states are copied register by register: of types it may copy as bytes, GCC copies bytes.
    constexpr Pack(const Pack& x) {
        for (int i = 0; i < count; ++i) part[i] = x.part[i];
    }
    constexpr Pack& operator=(const Pack& x) {
        for (int i = 0; i < count; ++i) part[i] = x.part[i];
        return *this;
    }

    /// Lane after lane from memory, and back: many at once, where `set` takes them one by one.
    static Pack read(const double* from) {
        Pack y;
        for (int i = 0; i < count; ++i) __builtin_memcpy(&y.part[i], from + i * width, sizeof y.part[i]);
        return y;
    }
    void write(double* to) const {
        for (int i = 0; i < count; ++i) __builtin_memcpy(to + i * width, &part[i], sizeof part[i]);
    }

    double operator[](int i) const { return part[i / width][i % width]; }
    void set(int i, double x) { part[i / width][i % width] = x; }

    friend constexpr Pack operator+(const Pack& a, const Pack& b) {
        return each([](const Lanes& x, const Lanes& y) { return x + y; }, a, b);
    }
    friend constexpr Pack operator-(const Pack& a, const Pack& b) {
        return each([](const Lanes& x, const Lanes& y) { return x - y; }, a, b);
    }
    friend constexpr Pack operator*(const Pack& a, const Pack& b) {
        return each([](const Lanes& x, const Lanes& y) { return x * y; }, a, b);
    }
    friend constexpr Pack operator/(const Pack& a, const Pack& b) {
        return each([](const Lanes& x, const Lanes& y) { return x / y; }, a, b);
    }
    friend constexpr Pack operator-(const Pack& a) {
        return each([](const Lanes& x) { return -x; }, a);
    }
    friend constexpr Mask operator<(const Pack& a, const Pack& b) {
        return where([](const Lanes& x, const Lanes& y) { return x < y; }, a, b);
    }
    friend constexpr Mask operator>(const Pack& a, const Pack& b) {
        return where([](const Lanes& x, const Lanes& y) { return x > y; }, a, b);
    }
    friend constexpr Mask operator>=(const Pack& a, const Pack& b) {
        return where([](const Lanes& x, const Lanes& y) { return x >= y; }, a, b);
    }
    friend constexpr Mask operator==(const Pack& a, const Pack& b) {
        return where([](const Lanes& x, const Lanes& y) { return x == y; }, a, b);
    }

    friend constexpr Pack select(const Mask& mask, const Pack& a, const Pack& b) {
        Pack y;
        for (int i = 0; i < count; ++i) y.part[i] = elementary::blend(mask.part[i], a.part[i], b.part[i]);
        return y;
    }
    friend constexpr Pack abs(const Pack& x) {
        return each([](const Lanes& lanes) { return (Lanes)((Bits)lanes & 0x7fffffffffffffffLL); }, x);
    }
    /// Nearest whole number, ties to even, with the sign of x.
    friend constexpr Pack rint(const Pack& x) {
        constexpr double whole_from = 4503599627370496.0;  // 2^52: no halves from there on
        return each(
            [](const Lanes& lanes) {
                const Bits sign = (Bits)lanes & (-0x7fffffffffffffffLL - 1);
                const Lanes size = (Lanes)((Bits)lanes & 0x7fffffffffffffffLL), whole = (size + whole_from) - whole_from;
                return (Lanes)((Bits)elementary::blend<Lanes>(size < whole_from, whole, size) | sign);
            },
            x);
    }
    friend Pack exp(const Pack& x) {
        return each([](const Lanes& lanes) { return elementary::exp(lanes); }, x);
    }
    friend SinCos<Pack> sincos(const Pack& x) {
        SinCos<Pack> y;
        if (any(!(abs(x) < Pack(elementary::farthest)))) {
            for (int i = 0; i < n; ++i) {
                const auto one = strainwave::sincos(x[i]);
                y.sin.set(i, one.sin);
                y.cos.set(i, one.cos);
            }
            return y;
        }
        for (int i = 0; i < count; ++i) {
            const auto found = elementary::sincos(x.part[i]);
            y.sin.part[i] = found.sine;
            y.cos.part[i] = found.cosine;
        }
        return y;
    }
    friend Pack sin(const Pack& x) { return sincos(x).sin; }
    friend Pack cos(const Pack& x) { return sincos(x).cos; }
    friend Pack sqrt(const Pack& x) {
        return one_by_one(x, [](double lane) { return strainwave::sqrt(lane); });
    }
    friend Pack log(const Pack& x) {
        return one_by_one(x, [](double lane) { return strainwave::log(lane); });
    }
    friend Pack atan(const Pack& x) {
        return one_by_one(x, [](double lane) { return strainwave::atan(lane); });
    }
    /// Whole in every lane, and the same.
    friend int whole(const Pack& x, int highest) { return all(x == Pack(x[0])) ? strainwave::whole(x[0], highest) : 0; }

private:
    template <class F, class... Packs>
    static constexpr Pack each(F&& f, const Packs&... x) {
        Pack y;
        for (int i = 0; i < count; ++i) y.part[i] = f(x.part[i]...);
        return y;
    }
    template <class F>
    static constexpr Mask where(F&& f, const Pack& a, const Pack& b) {
        Mask mask;
        for (int i = 0; i < count; ++i) mask.part[i] = f(a.part[i], b.part[i]);
        return mask;
    }
    template <class F>
    static Pack one_by_one(const Pack& x, F&& f) {
        Pack y;
        for (int i = 0; i < n; ++i) y.set(i, f(x[i]));
        return y;
    }
};

}  // namespace strainwave
