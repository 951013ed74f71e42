#pragma once
#include <strainwave/hysteresis/preisach_density.hpp>

namespace strainwave::hysteresis {

template <class S, class Density = PowerDensity<S>>
struct Preisach {
    static constexpr int capacity = 16;

    Density density{};

    static constexpr auto name = "preisach";
    static constexpr auto source = "Preisach1935; Everett1955; Mayergoyz1986 (what wiping-out and congruency imply)";
    static constexpr auto doc = R"(
        Preisach hysteresis, symmetric or not: minor loops close and are equal between equal twists.

        .. math:: \Delta T = \pm 2 E(a, b), \quad \mu(a, b) = \frac{\partial^2 E}{\partial a \, \partial b} \ge 0

        with E the Everett function of the density mu, and b <= a the ends of the branch: the last turning point in memory, and
        the twist. A twist that passes a turning point erases it, together with its partner. Exact for any monotone step of the
        twist. Rate-independent; obeys wiping-out and congruency, and Masing's rules if E depends on a - b alone. The virgin
        state is demagnetised, as after an oscillation of decreasing amplitude around the first twist.

        mu is the density of hysterons over the ends of their windows [b, a]. Each pushes forward from the moment its window is
        entered from below, back from the moment it is entered from above; the rest of E is a spring. A loop loses twice the
        width of every window within it. Preisach's own relays switch when they leave their window, which is right for a
        magnet, whose field is the input. As torque over twist they would create energy in every loop: this law is an elastic
        curve less Preisach's operator of the same density.

        Sixteen maxima and minima are stored. More reversals within them move along the innermost branch without loss.

        Uniform density, from negative saturation. The torque of Preisach's relays is the elastic line, here 2 N.m/rad, less
        the torque of the law:

        >>> import numpy as np
        >>> from strainwave.hysteresis import PowerDensity, Preisach
        >>> gear = Preisach(density=PowerDensity(limit=1.0, saturation=1.0, exponent=2.0))
        >>> path = np.array([0.0, -1.0, 0.5, -0.2, 0.3, 0.5, 0.8])
        >>> (2.0 * path - gear.trace(path)).round(12)
        array([ 0.   , -1.   ,  0.125, -0.12 ,  0.005,  0.125,  0.62 ]))";

    static constexpr bool odd = false, return_point_memory = true, congruent = true, masing = false;

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, density, "Density of hysterons over the ends of their windows"));
    }

    struct State {
        Array<S, capacity> maximum{};
        Array<S, capacity - 1> minimum{};
        S twist{0.0};

        static constexpr auto name = "preisach.state";

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, maximum, "rad", "Maxima in memory, outermost first; unused places contain the twist"));
            visit(SW_FIELD(m, minimum, "rad", "Minima in memory, each after the maximum of its place"));
            visit(SW_FIELD(m, twist, "rad", "Twist, from the virgin state"));
        }

        constexpr const char* problem() const {
            bool nested = all(maximum[0] >= -low(0));
            for (int k = 0; k < capacity; ++k) nested = nested && all(maximum[k] >= twist) && all(twist >= low(k));
            for (int k = 1; k < capacity; ++k) nested = nested && all(maximum[k - 1] >= maximum[k]) && all(low(k) >= low(k - 1));
            return nested ? nullptr : "maximum must not rise, minimum must not fall, and all must enclose the twist";
        }

        /// The last minimum is the twist: further reversals are not stored.
        constexpr const S& low(int k) const { return k < capacity - 1 ? minimum[k] : twist; }
    };

    /// The turning points after the twist has moved by `increment` [rad], monotonically.
    ///
    /// A turning point that is passed becomes the twist, and so does its partner. The outermost maximum is at least as far out as
    /// any minimum: the demagnetised state has turned there.
    constexpr State advance(const State& x, const S& increment) const {
        State next{};
        next.twist = x.twist + increment;
        next.maximum[0] = max(x.maximum[0], abs(next.twist));
        for (int k = 0; k + 1 < capacity; ++k) {
            next.minimum[k] = select(next.twist >= x.maximum[k], next.twist, min(x.minimum[k], next.twist));
            next.maximum[k + 1] = select(x.minimum[k] >= next.twist, next.twist, max(x.maximum[k + 1], next.twist));
        }
        return next;
    }

    /// Torque [N.m] once the twist has moved by `increment` [rad]; the state stays as it is.
    constexpr S torque(const State& x, const S& increment) const { return held(advance(x, increment)); }

    /// Work [J] done on the law while the twist moves by `increment` [rad], monotonically: branch by branch, as turning points are
    /// passed.
    constexpr S work(const State& x, const S& increment) const {
        const S to = x.twist + increment;
        S torque = density.virgin(x.maximum[0]), sum = initial(x, to);
        for (int k = 0;; ++k) {
            sum = sum + descent(x, k, to, torque);
            if (k + 1 == capacity) return sum;
            torque = torque - S(2.0) * density.everett(x.maximum[k], x.low(k));
            sum = sum + ascent(x, k, to, torque);
            if (!any(x.low(k) < x.twist)) return sum;
            torque = torque + S(2.0) * density.everett(x.maximum[k + 1], x.low(k));
        }
    }

private:
    /// Search from the outermost turning point inwards, until the twist is reached.
    constexpr S held(const State& x) const {
        S torque = density.virgin(x.maximum[0]) - S(2.0) * density.everett(x.maximum[0], x.low(0));
        auto inside = x.low(0) < x.twist;  // a lane that has reached its twist waits for the others
        for (int k = 1; k < capacity && any(inside); ++k) {
            const S risen = torque + S(2.0) * density.everett(x.maximum[k], x.low(k - 1));
            torque = select(inside, risen - S(2.0) * density.everett(x.maximum[k], x.low(k)), torque);
            inside = inside & (x.low(k) < x.twist);
        }
        return torque;
    }

    /// Work on the initial curve, beyond all turning points.
    constexpr S initial(const State& x, const S& to) const {
        const S reach = x.maximum[0];
        return density.virgin_work(max(to, reach)) - density.virgin_work(reach) + density.virgin_work(min(to, -reach)) -
               density.virgin_work(-reach);
    }
    /// Work on the branch that falls from maximum k with its `torque`. The innermost leads upwards as well.
    constexpr S descent(const State& x, int k, const S& to, const S& torque) const {
        const S start = x.low(k), top = k + 1 < capacity ? start : x.maximum[k];
        const S end = clip(to, k > 0 ? x.low(k - 1) : -x.maximum[0], top);
        return torque * (end - start) + S(2.0) * (density.falling(x.maximum[k], end) - density.falling(x.maximum[k], start));
    }
    /// Work on the branch that rises from minimum k with its `torque`.
    constexpr S ascent(const State& x, int k, const S& to, const S& torque) const {
        const S start = x.maximum[k + 1], end = clip(to, start, x.maximum[k]);
        return torque * (end - start) + S(2.0) * (density.rising(end, x.low(k)) - density.rising(start, x.low(k)));
    }
};

}  // namespace strainwave::hysteresis
