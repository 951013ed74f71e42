#pragma once
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>

namespace strainwave::hysteresis {

namespace detail {

/// Weights of s^k that make a sum of 30 terms 1 / (1 - s), to 1e-16 on [-1, 1/e]: (1 - T(s) / T(1)) / (1 - s) with T the
/// Chebyshev polynomial of that interval.
template <class R>
inline constexpr R geometric[30] = {
    R(1.0),
    R(0.9999999999999974),
    R(1.000000000000014),
    R(1.0000000000010638),
    R(0.9999999999988224),
    R(0.9999999998690092),
    R(0.9999999998812497),
    R(1.0000000072492063),
    R(1.0000000170222836),
    R(0.9999997942943744),
    R(0.9999992222230315),
    R(1.000002881041303),
    R(1.0000178066144727),
    R(0.9999908290207963),
    R(0.9997809110403464),
    R(0.9997115502601486),
    R(1.0012773497582523),
    R(1.004198328385764),
    R(0.9998414672340598),
    R(0.978760895061342),
    R(0.9632069705411641),
    R(1.0119287147382903),
    R(1.1356959003422498),
    R(1.2143554799604408),
    R(1.087522815569376),
    R(0.7504532520190768),
    R(0.37654005878268587),
    R(0.1286754753735213),
    R(0.0267463838174804),
    R(0.0025516955511543167),
};

/// Bernoulli numbers B_j / j! with j = 0, 2, 4, ..., 18
template <class R>
inline constexpr R bernoulli[10] = {
    R(1.0),
    R(0.08333333333333333),
    R(-0.001388888888888889),
    R(3.306878306878307e-05),
    R(-8.267195767195768e-07),
    R(2.08767569878681e-08),
    R(-5.284190138687493e-10),
    R(1.3382536530684679e-11),
    R(-3.3896802963225827e-13),
    R(8.586062056277845e-15),
};

}  // namespace detail

/// Bouc-Wen's law without units: v the torque along the motion, in [-1, 1], and dv/dp = 1 - s over the path p, where s = v^n while
/// v > 0 and s = -reversal |v|^n while v < 0. Solved by its integrals: no step is too large, none is divided. These are series in
/// s up to the knee, and beyond it in the depth L = -n ln v, which falls to 0 at the asymptote.
template <class S>
struct BoucWenFlow {
    using Moments = Array<S, 30>;
    using Depths = Array<S, 19>;

    S n{2.0};
    S reversal{0.0};
    Moments path_terms{};

    static constexpr BoucWenFlow of(const S& n, const S& reversal) { return {n, reversal, moments(n, 1)}; }

    /// Torque after the path `p`, from torque `v`.
    constexpr S after(const S& v, const S& p) const {
        const S start = path(v), beyond = p - select(v < knee(), path(knee()) - start, S(0.0));
        const auto low = beyond < S(0.0);
        return select(low, before_knee(v, p, start + p, low), after_knee(max(v, knee()), max(beyond, S(0.0)), !low));
    }

    /// The integral of the torque over the path that leads from torque `v` to torque `end`, both before the knee.
    constexpr S area(const S& v, const S& end) const {
        const Moments terms = moments(n, 2);
        return end * end * polynomial(terms, loss(end)) - v * v * polynomial(terms, loss(v));
    }

    /// Difference of the path and that integral, whatever the torques.
    constexpr S shortfall(const S& v, const S& end) const {
        const S a = min(v, knee()), b = min(end, knee()), share = S(1.0) / n;
        const Depths once = bernoulli(S(1.0) - share), twice = bernoulli(S(1.0) - share - share);
        Depths terms{};
        for (int k = 0; k < terms.size(); ++k) terms[k] = once[k] - twice[k];
        return path(b) - path(a) - area(a, b) +
               share * (polynomial(terms, min(depth(v), S(knee_depth))) - polynomial(terms, min(depth(end), S(knee_depth))));
    }

    constexpr S knee() const { return exp(S(-knee_depth) / n); }

private:
    static constexpr double knee_depth = 1.0;
    static constexpr double min_torque = 1e-30;  ///< its powers vanish, its logarithm does not overflow
    /// A Newton step whose square is below this leaves an error below rounding.
    static constexpr double last_step_squared = sizeof(S) == sizeof(float) ? 1e-8 : 1e-17;

    template <int size>
    static constexpr S polynomial(const Array<S, size>& c, const S& x) {
        const S square = x * x;
        S even{0.0}, odd{0.0};  // two chains: half as many steps wait for each other
        for (int k = (size - 1) / 2 * 2; k >= 0; k -= 2) even = even * square + c[k];
        for (int k = size / 2 * 2 - 1; k > 0; k -= 2) odd = odd * square + c[k];
        return even + x * odd;
    }

    /// The integral of t^(m - 1) / (1 - s(t)) over [0, v], divided by v^m, as a series in s.
    static constexpr Moments moments(const S& n, int m) {
        Moments c{};
        for (int k = 0; k < c.size(); ++k) c[k] = S(detail::geometric<Real<S>>[k]) / (S(k) * n + S(m));
        return c;
    }

    /// B_k(x) / (k k!): the integral of e^(x L) / (e^L - 1) is ln L plus their series in L.
    static constexpr Depths bernoulli(const S& x) {
        Depths powers{}, c{};
        powers[0] = S(1.0);
        for (int k = 1; k < c.size(); ++k) {
            powers[k] = powers[k - 1] * x / S(k);
            c[k] = powers[k] - S(0.5) * powers[k - 1];
            for (int j = 1; 2 * j <= k; ++j) c[k] = c[k] + S(detail::bernoulli<Real<S>>[j]) * powers[k - 2 * j];
            c[k] = c[k] / S(k);
        }
        return c;
    }

    /// -n ln v where v > 0, cut where v^n vanishes.
    constexpr S depth(const S& v) const { return min(n * -log(max(v, S(min_torque))), S(beyond_digits)); }
    constexpr S loss(const S& v) const { return select(v < S(0.0), -reversal, S(1.0)) * exp(-depth(abs(v))); }
    constexpr S path(const S& v) const { return v * polynomial(path_terms, loss(v)); }
    constexpr BoucWenFlow plain() const {
        if constexpr (differentiates<S>)
            return of(value_only(n), value_only(reversal));
        else
            return *this;
    }

    /// The torque at which path(v) = `target`, where wanted. That function is convex: Newton's iteration comes down from above.
    constexpr S before_knee(const S& from, const S& p, const S& target, auto wanted) const {
        const S low = value_only(from), way = value_only(p);
        if (!any(wanted)) return low;
        const BoucWenFlow flow = plain();
        const S high = flow.knee(), gone = flow.loss(low), bend = flow.n * gone / along(low, max(abs(low), S(min_torque)));
        S v = clip(low + way * (S(1.0) - gone) * (S(1.0) - S(0.5) * way * bend), low, high);
        for (int i = 0; (i < 16) && any(wanted); ++i) {
            const S step = flow.newton(v, value_only(target));
            v = select(wanted, clip(v + step, low, high), v);
            wanted = wanted & (flow.n * step * step > S(last_step_squared));
        }
        if constexpr (differentiates<S>) v = v + slope_of(newton(v, target));
        return v;
    }
    /// The loss at the knee is 1/e, which rounding of a torque close to 1 may hide.
    constexpr S newton(const S& v, const S& target) const { return (target - path(v)) * (S(1.0) - min(loss(v), S(0.5))); }

    /// The torque after the path `p`, where wanted: the logarithm of the depth falls nearly in proportion to the path.
    constexpr S after_knee(const S& from, const S& p, auto wanted) const {
        const S start = depth(from), fall = min(n * p, S(beyond_digits)), origin = value_only(start), goal = value_only(fall);
        if (!any(wanted)) return origin;
        const Depths terms = bernoulli(S(1.0) - S(1.0) / n), plain_terms = detached_all(terms);
        S y = log_step(plain_terms, S(0.0), origin, goal);
        for (int i = 0; (i < 8) && any(wanted); ++i) {
            const S step = log_step(plain_terms, y, origin, goal);
            y = select(wanted, y + step, y);
            wanted = wanted & (step * step > S(last_step_squared));
        }
        if constexpr (differentiates<S>) y = y + slope_of(log_step(terms, y, start, fall));
        return from * exp(start * (S(1.0) - exp(y)) / n);
    }
    /// Newton's step of y = ln(L / start), where y + sum(L) - sum(start) = -fall.
    static constexpr S log_step(const Depths& terms, const S& y, const S& start, const S& fall) {
        const S depth = start * exp(y);
        Depths slopes{};
        for (int k = 1; k < terms.size(); ++k) slopes[k] = S(k) * terms[k];
        return (polynomial(terms, start) - polynomial(terms, depth) - y - fall) / (S(1.0) + polynomial(slopes, depth));
    }
    /// Derivatives from a last step of Newton's method; the value does not change, as in scalars without derivatives.
    static constexpr S slope_of(const S& step) { return step - value_only(step); }
    static constexpr Depths detached_all(Depths terms) {
        if constexpr (differentiates<S>)
            for (S& term : terms.item) term = value_only(term);
        return terms;
    }
};

template <class S>
struct BoucWen {
    S stiffness{1e3};
    S saturation{0.5};
    S sharpness{2.0};
    S shape{0.5};

    static constexpr auto name = "bouc_wen";
    static constexpr auto source = "Bouc1967; Wen1976; passivity: ErlicherPoint2004; IkhouaneRodellar2007";
    static constexpr auto doc = R"(
        Bouc-Wen hysteresis: a torque that bends smoothly towards its saturation.

        .. math:: dT = A\, d\delta - \beta\, |d\delta|\, |T|^{n-1} T - \gamma\, d\delta\, |T|^n, \qquad
                  \beta = \sigma A / T_s^n, \quad \gamma = (1 - \sigma) A / T_s^n

        with delta the twist, A = stiffness, T_s = saturation, n = sharpness, sigma = shape; that is T_s = (A / (beta +
        gamma))^(1/n) and sigma = beta / (beta + gamma), in units that do not depend on n. Exact over any monotone step: solved
        by its integrals. The elastic energy is T^2 / (2 A); the energy lost grows along every path, because gamma lies in [0,
        beta]. From saturation it unloads with the slope 2 sigma A at first: shape 1/2 unloads straight, shape 1 twice as
        steeply.

        Sharpness 1 with shape 1 is FadingMemory, a large sharpness one element of MaxwellSlip. Rate-independent. Minor loops do
        not close. Leaves out -beta < gamma < 0, which is passive as well.

        >>> from strainwave.hysteresis import BoucWen
        >>> BoucWen(stiffness=1000.0, saturation=0.5, sharpness=2.0, shape=0.5).trace([0.0, 0.0005, -0.0005]).round(6)
        array([ 0.      ,  0.380797, -0.4225  ]))";

    static constexpr bool odd = true;
    static constexpr bool return_point_memory = false;
    static constexpr bool congruent = false;
    static constexpr bool masing = false;

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_REQUIRED(m, stiffness, "N.m/rad", "Stiffness A at zero torque", smallest));
        visit(SW_REQUIRED(m, saturation, "N.m", "Torque T_s approached by a long motion", smallest));
        visit(SW_FIELD(m, sharpness, "1", "Exponent n: sharpness of the bend towards the saturation", 1));
        visit(SW_FIELD(m, shape, "1", "Share sigma = beta / (beta + gamma): 1/2 unloads straight, 1 most curved", 0.5, 1));
    }

    struct State {
        S held{0.0};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, held, "N.m", "Torque T held"));
        }
    };

    /// The memory after the twist has moved by `increment` [rad], monotonically.
    constexpr State advance(const State& x, const S& increment) const {
        const S held = confined(x), v = along(increment, held / saturation);
        const S gained = flow().after(v, path(increment)) - v;
        return {clip(held + along(increment, saturation * gained), -saturation, saturation)};
    }

    /// Torque [N.m] once the twist has moved by `increment` [rad]; the state stays as it is.
    constexpr S torque(const State& x, const S& increment) const { return advance(x, increment).held; }

    /// Work [J] done on the law while the twist moves by `increment` [rad], monotonically.
    constexpr S work(const State& x, const S& increment) const {
        const BoucWenFlow<S> flow = this->flow();
        const S v = along(increment, confined(x) / saturation), end = flow.after(v, path(increment));
        const S reach = saturation / stiffness, knee = flow.knee();
        return saturation *
               select(end < knee, reach * flow.area(v, min(end, knee)), abs(increment) - reach * flow.shortfall(v, end));
    }

    /// Elastic energy [J].
    constexpr S stored(const State& x) const { return x.held * x.held / (S(2.0) * stiffness); }

private:
    static constexpr double saturated_path = 100.0;  ///< A path that saturates from any torque, to the last digit
    constexpr BoucWenFlow<S> flow() const { return BoucWenFlow<S>::of(sharpness, S(2.0) * shape - S(1.0)); }
    constexpr S path(const S& increment) const { return min(stiffness * abs(increment) / saturation, S(saturated_path)); }
    /// No motion leads beyond the saturation.
    constexpr S confined(const State& x) const { return clip(x.held, -saturation, saturation); }
};

}  // namespace strainwave::hysteresis
