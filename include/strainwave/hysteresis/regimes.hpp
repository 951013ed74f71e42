#pragma once
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>

namespace strainwave::hysteresis {

template <class S>
struct Regimes {
    S positive_unloading{4.51};
    S negative_loading{0.31};
    S negative_unloading{4.85};
    S positive_loading{0.30};
    S onset{0.03};
    S lost_motion{0.8813912722571364};

    static constexpr auto name = "regimes";
    static constexpr auto source =
        SW_TORSION_ARTICLE ", Table 2, row 0 degrees (at the input), read as a closed loop; generalised play: Visintin1994";
    static constexpr auto doc = R"(
        Spring with memory: one stiffness for each of the four regimes of a torsion test.

        .. math:: \delta = \varepsilon + s, \quad T = K \varepsilon, \quad -w/2 \le s \le w/2, \qquad
                  T = T_0 + H_+ (s + w/2) \; (ds > 0), \quad T = -T_0 - H_- (w/2 - s) \; (ds < 0)

        with delta the twist, epsilon its elastic and s its plastic share, K = positive_unloading for T > 0 and
        negative_unloading for T < 0, T_0 = onset, w = lost_motion, H = K K_l / (K - K_l), so that the slope is K_l =
        positive_loading or negative_loading while s moves. At its stops s = +-w/2 only the elastic share moves. The closed
        loop has its greatest width w at zero torque; the work on s is lost. Exact over any monotone step; minor loops close,
        no cycle creeps. The virgin state is s = 0.

        The loop does not close if the stiffnesses of the table are secants from 0 to +-0.36 N.m. It closes if they are
        slopes between the stops, of a loop 50.5 degrees wide. They were measured at the input, and are those of the example.
        In a gear the law acts on the output: with a ratio N, multiply torques by N and divide twists by N.

        It is a complete spring: the ``stiffness`` of a gear acts in parallel to it (use Linear with a negligible stiffness if
        there is no other spring).

        >>> from strainwave.hysteresis import Regimes
        >>> law = Regimes(positive_unloading=4.51, negative_loading=0.31, negative_unloading=4.85, positive_loading=0.30,
        ...               onset=0.03, lost_motion=0.8813912722571364)
        >>> law.trace([0.0, 0.6, 0.5, -0.6, 0.6]).round(6)
        array([ 0.      ,  0.718463,  0.267463, -0.772626,  0.718463]))";

    static constexpr bool odd = false;
    static constexpr bool return_point_memory = true;
    static constexpr bool congruent = false;
    static constexpr bool masing = false;

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_REQUIRED(m, positive_unloading, "N.m/rad", "Stiffness while a positive torque falls, and beyond the stop",
                          smallest));
        visit(SW_REQUIRED(m, negative_loading, "N.m/rad", "Stiffness while a negative torque builds up", 0));
        visit(SW_REQUIRED(m, negative_unloading, "N.m/rad", "Stiffness while a negative torque falls, and beyond the stop",
                          smallest));
        visit(SW_REQUIRED(m, positive_loading, "N.m/rad", "Stiffness while a positive torque builds up", 0));
        visit(SW_REQUIRED(m, onset, "N.m", "Torque T_0 at which the soft regimes begin", 0));
        visit(SW_REQUIRED(m, lost_motion, "rad", "Plastic twist w between the stops: width of the loop at zero torque", 0));
    }

    constexpr const char* problem() const {
        return all(positive_unloading > positive_loading) && all(negative_unloading > negative_loading)
                   ? nullptr
                   : "the loading stiffness of each sign must be below its unloading stiffness";
    }

    struct State {
        S twist{0.0};
        S plastic{0.0};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, twist, "rad", "Twist, from the virgin state"));
            visit(SW_FIELD(m, plastic, "rad", "Plastic share s of the twist"));
        }
    };

    /// The spring after the twist has moved by `increment` [rad], monotonically.
    constexpr State advance(const State& x, const S& increment) const {
        const S twist = x.twist + increment, half = S(0.5) * lost_motion;
        const S least = yielded(twist, positive_unloading, positive_loading);
        const S most = -yielded(-twist, negative_unloading, negative_loading);
        return {twist, clip(clip(x.plastic, least, most), -half, half)};
    }

    /// Torque [N.m] once the twist has moved by `increment` [rad]; the state stays as it is.
    constexpr S torque(const State& x, const S& increment) const {
        const State next = advance(x, increment);
        const S elastic = next.twist - next.plastic;
        return select(elastic < S(0.0), negative_unloading, positive_unloading) * elastic;
    }

    /// Work [J] done on the law while the twist moves by `increment` [rad], monotonically: elastic, and lost to the plastic share.
    constexpr S work(const State& x, const S& increment) const {
        const State next = advance(x, increment);
        const S before = x.twist - x.plastic, after = next.twist - next.plastic, half = S(0.5) * lost_motion;
        const S taken = next.plastic - x.plastic, middle = S(0.5) * (next.plastic + x.plastic);
        const S up = onset + hardening(positive_unloading, positive_loading) * (half + middle);
        const S down = onset + hardening(negative_unloading, negative_loading) * (half - middle);
        return energy(max(before, S(0.0)), max(after, S(0.0)), positive_unloading) +
               energy(min(before, S(0.0)), min(after, S(0.0)), negative_unloading) + abs(taken) * select(taken < S(0.0), down, up);
    }

    /// Elastic energy [J].
    constexpr S stored(const State& x) const {
        const S elastic = x.twist - x.plastic;
        return S(0.5) * select(elastic < S(0.0), negative_unloading, positive_unloading) * elastic * elastic;
    }

private:
    /// Plastic share at `twist` if it grows: the elastic torque equals the torque at which it grows.
    constexpr S yielded(const S& twist, const S& unloading, const S& loading) const {
        const S soft = loading / unloading;
        return max(S(1.0) - soft, S(0.0)) * (twist - onset / unloading) - S(0.5) * soft * lost_motion;
    }
    /// A fit may move the two stiffnesses onto each other on its way.
    static constexpr S hardening(const S& unloading, const S& loading) {
        return loading / max(S(1.0) - loading / unloading, S(1e-9));
    }
    static constexpr S energy(const S& from, const S& to, const S& stiffness) {
        return S(0.5) * stiffness * (to - from) * (to + from);
    }
};

}  // namespace strainwave::hysteresis
