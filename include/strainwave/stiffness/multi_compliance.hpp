#pragma once
#include <strainwave/condition.hpp>
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>

namespace strainwave::stiffness {

namespace detail {

/// 1/n + u/m + ... with whole n, m, ...
template <long long n, long long... more, class S>
constexpr S reciprocals(const S& u) {
    if constexpr (sizeof...(more) == 0)
        return S(1.0 / n);
    else
        return S(1.0 / n) + u * reciprocals<more...>(u);
}

/// A spring under a torque: how far it has given way, how far it still can, and its first two derivatives by the torque.
template <class S>
struct Given {
    S twist, rest, compliance, curvature;

    friend constexpr Given operator+(const Given& a, const Given& b) {
        return {a.twist + b.twist, a.rest + b.rest, a.compliance + b.compliance, a.curvature + b.curvature};
    }
};

/// A divisor that is never zero; the quotient is used for hardenings above zero only.
template <class S>
constexpr S or_one(const S& hardening) {
    return select(hardening > S(0.0), hardening, S(1.0));
}
/// Largest twist of a spring of this softness, if `share` over its hardening limits it.
template <class S>
constexpr S reach(const S& softness, const S& hardening, const S& share) {
    return select(hardening > S(0.0), share * softness / or_one(hardening), S(unbounded));
}

/// twist = softness arctan(c T) / c, for T >= 0, c = hardening.
template <class S>
struct ArctanSpring {
    S softness, hardening;

    constexpr Given<S> at(const S& torque) const {
        const S x = hardening * torque, square = x * x, inverse = S(1.0) / max(x, S(smallest));
        // The smaller of an angle and its complement to a right angle is exact to its own last digits.
        const S acute = atan(min(x, inverse)), angle = select(inverse < x, S(0.5 * pi) - acute, acute);
        const S rest = select(inverse < x, acute, S(0.5 * pi) - acute), scale = softness / or_one(hardening);
        const S compliance = softness / (S(1.0) + square);
        return {select(square < S(1.0 / 81.0), softness * torque * reciprocals<1, -3, 5, -7, 9, -11, 13, -15, 17>(square),
                       scale * angle),
                scale * rest, compliance, S(-2.0) * hardening * x * compliance / (S(1.0) + square)};
    }
    /// log(1 + x^2) / (2 c^2), near zero by log((1 + v) / (1 - v)) = 2 artanh v.
    constexpr S energy(const S& torque) const {
        const S x = hardening * torque, u = x * x, v = u / (S(2.0) + u), c = or_one(hardening);
        const S near = torque * torque / (S(2.0) + u) * reciprocals<1, 3, 5, 7, 9, 11, 13, 15, 17>(v * v);
        return softness * select(u < S(0.25), near, S(0.5) * log(S(1.0) + u) / c / c);
    }
    /// tan(c twist / softness) / c, for twist >= 0; beyond the bound a torque that is too large for any use.
    constexpr S torque(const S& twist) const {
        const S linear = min(twist / softness, S(unbounded)), angle = min(hardening * linear, S(0.5 * pi));
        const auto [sine, cosine] = sincos(angle);
        return select(angle < S(1e-8), linear, sine / max(cosine, S(1e-17)) / or_one(hardening));
    }
    constexpr S bound() const { return reach(softness, hardening, S(0.5 * pi)); }
};

/// twist = softness (1 - exp(-c T)) / c, for T >= 0, c = hardening.
template <class S>
struct ExponentialSpring {
    S softness, hardening;

    constexpr Given<S> at(const S& torque) const {
        const S y = exponent(torque), half = S(0.5) * y, root = exp(-half), left = root * root;
        const S scale = softness / or_one(hardening), compliance = softness * left;
        return {select(y < S(1.0), softness * torque * root * sinh_quotient(half * half), scale * (S(1.0) - left)), scale * left,
                compliance, -hardening * compliance};
    }
    /// (1 - (1 + y) exp(-y)) / c^2, near zero by s = sinh(h) / h and its slope, h = y / 2.
    constexpr S energy(const S& torque) const {
        const S y = exponent(torque), half = S(0.5) * y, square = half * half, root = exp(-half), c = or_one(hardening);
        const S slope = half * reciprocals<3, 30, 840, 45360, 3991680, 518918400, 93405312000>(square);
        const S near = S(0.5) * torque * torque * root * (sinh_quotient(square) - slope);
        return softness * select(y < S(1.0), near, (S(1.0) - (S(1.0) + y) * root * root) / c / c);
    }
    constexpr S bound() const { return reach(softness, hardening, S(1.0)); }

private:
    /// Beyond, the exponential is below the rounding of 1, and only underflows.
    constexpr S exponent(const S& torque) const { return min(hardening * torque, S(160.0)); }
    static constexpr S sinh_quotient(const S& square) {
        return reciprocals<1, 6, 120, 5040, 362880, 39916800, 6227020800, 1307674368000>(square);
    }
};

/// Both springs under one torque, which is solved for a twist d >= 0.
template <class S>
struct InSeries {
    ArctanSpring<S> flexspline;
    ExponentialSpring<S> wave_generator;

    constexpr Given<S> at(const S& torque) const { return flexspline.at(torque) + wave_generator.at(torque); }
    constexpr S energy(const S& torque) const { return flexspline.energy(torque) + wave_generator.energy(torque); }
    constexpr S bound() const { return min(flexspline.bound() + wave_generator.bound(), S(unbounded)); }

    /// Torque at which less than 1e-6 of the bound is left, and whose square every scalar can hold.
    constexpr S largest() const {
        const S flexed = S(1e6) / max(flexspline.hardening, S(1e-30)), waved = S(40.0) / max(wave_generator.hardening, S(1e-30));
        return min(max(flexed, waved), S(1e18));
    }
    /// The remaining twist. The rest up to the bound is more exact than the twist itself, if it is smaller; its
    /// derivatives are not.
    constexpr S missing(const S& d, const Given<S>& given) const {
        const S end = bound(), mismatch = d - given.twist, left = value_only(given.rest - (end - d));
        return select((end < S(unbounded)) & (d > S(0.5) * end), left + (mismatch - value_only(mismatch)), mismatch);
    }
    constexpr S torque(const S& d) const {
        const S level = constant().solved(value_only(d));
        if constexpr (differentiates<S>) {  // implicit function theorem
            const Given<S> given = at(level);
            const S top = largest(), step = missing(d, given) / value_only(given.compliance);
            return select(level < top, level + (step - value_only(step)), top);
        }
        return level;
    }

    /// Copy of the springs without derivatives.
    constexpr InSeries constant() const {
        return {{value_only(flexspline.softness), value_only(flexspline.hardening)},
                {value_only(wave_generator.softness), value_only(wave_generator.hardening)}};
    }

private:
    /// Lower bound close to the torque: no part yields more than its linear spring, nor beyond its bound; and with that as x and
    /// y, arctan x <= x (1 + 4 x^2 / 15) / (1 + 3 x^2 / 5) and 1 - exp(-y) <= y / (1 + y / 2).
    constexpr S start(const S& d) const {
        const S at_least = max(linear(d), max(flexed(d), waved(d)));
        const S x = flexspline.hardening * at_least, square = x * x, y = wave_generator.hardening * at_least;
        const S flexspline_gives = flexspline.softness * (S(1.0) + S(4.0 / 15.0) * square) / (S(1.0) + S(0.6) * square);
        return max(at_least, d / (flexspline_gives + wave_generator.softness / (S(1.0) + S(0.5) * y)));
    }
    constexpr S linear(const S& d) const { return d / (flexspline.softness + wave_generator.softness); }
    /// Torque with the wave generator at its bound; tan(pi p / 2) within 0.3 %.
    constexpr S flexed(const S& d) const {
        const S far = max(d - wave_generator.bound(), S(0.0)) / flexspline.softness;
        const S p = min(S(2.0 / pi) * flexspline.hardening * far, S(0.9999995)), square = p * p;
        return far * (S(1.0) - S(0.1894) * square) / (S(1.0) - square);
    }
    /// Torque with the flexspline at its bound; -log(1 - u) >= 2 u / (2 - u).
    constexpr S waved(const S& d) const {
        const S far = max(d - flexspline.bound(), S(0.0)) / wave_generator.softness;
        return S(2.0) * far / (S(2.0) - min(wave_generator.hardening * far, S(1.0)));
    }

    /// The torque itself: one step of Newton's method after the search.
    constexpr S solved(const S& d) const {
        const S top = largest(), level = search(d);
        const Given<S> given = at(level);
        return select(level < top, min(level + missing(d, given) / given.compliance, top), top);
    }

    /// Halley's method, bracketed by values that are too low and too high.
    constexpr S search(const S& d) const {
        const S top = largest(), scale = S(1.0) / max(wave_generator.hardening, S(1e-30));
        S level = min(start(d), top), low = S(0.5) * min(linear(d), top), high = top + top;
        auto searching = top > S(0.0);  // everywhere
        for (int i = 0; i < max_steps; ++i) {
            const Given<S> given = at(level);
            const S off = missing(d, given), step = off / given.compliance;
            low = select(off > S(0.0), level, low);
            high = select(off < S(0.0), level, high);
            const S bend = S(1.0) + S(0.5) * step * given.curvature / given.compliance;
            const S bent = level + step / max(bend, S(0.5));
            const S next = select((bent >= low) & (high >= bent), bent, sqrt(low * high));
            const S moved = abs(min(next, top) - min(level, top));
            level = select(searching, next, level);
            searching = searching & (moved > S(last_step) * min(level, scale));
            if (!any(searching)) break;
        }
        return min(level, top);
    }
    static constexpr int max_steps = 64;
    static constexpr double last_step = 2e-3;  // relative; the error after a step e is e^3, and e^6 after Newton's
};

}  // namespace detail

template <class S>
struct MultiCompliance {
    S flexspline_stiffness{8e3};
    S flexspline_hardening{0.02};
    S wave_generator_stiffness{2.0};
    S wave_generator_hardening{1.5};
    S reduction{100.0};

    static constexpr auto name = "multi_compliance";
    static constexpr auto source = SW_REVIEW ", section 4c, without its friction";
    static constexpr auto doc = R"(
        Spring of flexspline and wave generator in series, each with a bounded twist.

        .. math:: \delta = \frac{\arctan(C_f T)}{C_f K_{f0}}
                  + \operatorname{sgn}(T) \frac{1 - e^{-C_w |T| / N}}{N C_w K_{w0}}, \qquad
                  \frac{d\delta}{dT} = \frac{1}{K_{f0} (1 + (C_f T)^2)} + \frac{e^{-C_w |T| / N}}{N^2 K_{w0}}

        with delta the twist, K_f0 = flexspline_stiffness and C_f = flexspline_hardening at the output, K_w0 =
        wave_generator_stiffness and C_w = wave_generator_hardening at the input, where the torque is T / N, N = reduction: the
        ratio of the gear, without its sign. A hardening of 0 is a linear spring. If neither is 0 the twist has the bound pi /
        (2 C_f K_f0) + 1 / (N C_w K_w0), beyond which there is no torque: the law is then not valid. It hardens without limit,
        and well before the bound more steeply than any gear.

        In a compiled model torque rises up to max(1e6 / C_f, 40 N / C_w), at most 1e18 N.m, and stays there, from within 1e-6
        of the bound on. The law is elastic: the friction torque that the review includes belongs to a law of friction or
        hysteresis, which is passive. A gear refuses a reduction that is not its own ratio.

        >>> from strainwave.stiffness import MultiCompliance
        >>> spring = MultiCompliance(flexspline_stiffness=8000.0, flexspline_hardening=0.02, wave_generator_stiffness=2.0,
        ...                          wave_generator_hardening=1.5, reduction=100.0)
        >>> round(spring.torque(0.003), 10)
        18.3471285987)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_REQUIRED(m, flexspline_stiffness, "N.m/rad", "Stiffness K_f0 of the flexspline at zero torque", smallest));
        visit(SW_REQUIRED(m, flexspline_hardening, "1/(N.m)", "Hardening C_f of the flexspline per torque at the output", 0));
        visit(SW_REQUIRED(m, wave_generator_stiffness, "N.m/rad",
                          "Stiffness K_w0 of the wave generator at zero torque, at the input", smallest));
        visit(
            SW_REQUIRED(m, wave_generator_hardening, "1/(N.m)", "Hardening C_w of the wave generator per torque at the input", 0));
        visit(SW_REQUIRED(m, reduction, "1", "Ratio N of the gear, without its sign", 1));
    }

    constexpr S torque(const S& twist) const { return along(twist, in_series().torque(abs(twist))); }
    constexpr S twist(const S& torque) const { return along(torque, in_series().at(abs(torque)).twist); }
    constexpr S tangent(const S& twist) const {
        const auto both = in_series();
        const S level = both.torque(abs(twist));
        return select(level < both.largest(), S(1.0) / both.at(level).compliance, S(0.0));
    }
    constexpr S energy(const S& twist) const {
        const auto both = in_series();
        const S d = abs(twist), level = both.torque(d);
        return both.energy(level) + level * both.missing(d, both.at(level));
    }

    constexpr Domain<S> domain(const S& twist) const {
        const S bound = in_series().bound();
        return {"twist", twist, -bound, bound, "rad", "a hardening of 0 leaves the twist unbounded"};
    }

    /// Both, as the output sees them.
    constexpr detail::InSeries<S> in_series() const {
        return {{S(1.0) / flexspline_stiffness, flexspline_hardening},
                {S(1.0) / (reduction * reduction * wave_generator_stiffness), wave_generator_hardening / reduction}};
    }
};

}  // namespace strainwave::stiffness
