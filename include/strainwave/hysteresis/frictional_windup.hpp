#pragma once
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>
#include <strainwave/stiffness/multi_compliance.hpp>

namespace strainwave::hysteresis {

template <class S>
struct FrictionalWindup {
    stiffness::MultiCompliance<S> springs{};
    S friction{1.0};

    static constexpr auto name = "frictional_windup";
    static constexpr auto source = SW_REVIEW ", section 4c, with T_fr, corrected as the text states; play: Visintin1994";
    static constexpr auto doc = R"(
        Spring of flexspline and wave generator in series, with dry friction at the wind-up of the wave generator.

        .. math:: \delta = \delta_f(T) + x(T_w), \qquad |T - T_w| \le F, \qquad T = T_w + F \; (dx > 0), \quad
                  T = T_w - F \; (dx < 0)

        with delta the twist, delta_f and x the shares of flexspline and wave generator in it, each a spring of MultiCompliance
        = springs, T the torque, T_w that of the wave generator's spring, F = friction, all at the output. While the wave
        generator sticks, the stiffness is that of the flexspline. While it slips, the stiffness is that of both in series. A
        cycle loses the integral of F |dx|, which is 4 F x(T_m - F) between +-T_m; the twist x(F) remains without torque. Exact
        over any monotone step; minor loops close. It begins without twist and torque.

        The review has the friction at the input's scale, or divides it by N, and makes it a function of the input
        speed. A torsion test, whose input is held, would then show no hysteresis.

        It is a complete spring: the ``stiffness`` of a gear acts in parallel to it (use Linear with a negligible stiffness if
        there is no other spring). A gear refuses springs whose reduction is not its ratio. If both springs harden, there is no
        torque beyond a certain twist. The law is valid within the limits of MultiCompliance, and keeps its greatest
        torque beyond them.

        >>> from strainwave.hysteresis import FrictionalWindup
        >>> from strainwave.stiffness import MultiCompliance
        >>> springs = MultiCompliance(flexspline_stiffness=8000.0, flexspline_hardening=0.02, wave_generator_stiffness=2.0,
        ...                           wave_generator_hardening=1.5, reduction=100.0)
        >>> law = FrictionalWindup(springs=springs, friction=5.0)
        >>> law.trace([0.0, 0.003, 0.002, -0.003, 0.003]).round(6)
        array([  0.      ,  19.663744,  10.902808, -19.663744,  19.663744]))";

    static constexpr bool odd = true;
    static constexpr bool return_point_memory = true;
    static constexpr bool congruent = false;
    static constexpr bool masing = false;

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, springs, "Flexspline and wave generator"));
        visit(SW_REQUIRED(m, friction, "N.m", "Friction F against the wind-up, at the output's scale", 0));
    }

    /// Range of its springs: no torque beyond a finite twist.
    constexpr Domain<S> domain(const S& twist) const { return springs.domain(twist); }

    struct State {
        S twist{0.0};
        S torque{0.0};
        S windup_torque{0.0};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, twist, "rad", "Twist, from the virgin state"));
            visit(SW_FIELD(m, torque, "N.m", "Torque T"));
            visit(SW_FIELD(m, windup_torque, "N.m", "Torque T_w of the wave generator's spring, at the output"));
        }
    };

    /// The springs after the twist has moved by `increment` [rad], monotonically: a trial with the wave generator stuck, and where
    /// friction does not hold that, its slip.
    constexpr State advance(const State& x, const S& increment) const {
        const Springs both = springs.in_series();
        const S twist = x.twist + increment, held = x.windup_torque;
        const S trial = flexed(both, twist - wound(both, held));
        const S over = trial - held;
        State next{twist, trial, held};
        const auto slips = abs(over) > friction;
        if (any(slips)) {
            const S slipped = slid(both, along(over, twist), along(over, held), along(over, trial) - friction);
            next.windup_torque = select(slips, along(over, slipped), held);
            next.torque = select(slips, along(over, slipped + friction), trial);
        }
        // No rounding moves it at rest; its derivatives are those of the trial.
        const auto rests = increment == S(0.0);
        next.torque = select(rests, value_only(x.torque) + (trial - value_only(trial)), next.torque);
        next.windup_torque = select(rests, held, next.windup_torque);
        return next;
    }

    /// Torque [N.m] once the twist has moved by `increment` [rad]; the state stays as it is.
    constexpr S torque(const State& x, const S& increment) const { return advance(x, increment).torque; }

    /// Work [J] done on the law while the twist moves by `increment` [rad], monotonically: into the springs, and against friction.
    constexpr S work(const State& x, const S& increment) const {
        const Springs both = springs.in_series();
        const State next = advance(x, increment);
        const S slip = abs(wound(both, next.windup_torque) - wound(both, x.windup_torque));
        return stored(next) - stored(x) + friction * slip;
    }

    /// Elastic energy [J] of both springs; beyond the bound, where the torque is constant, with its work there.
    constexpr S stored(const State& x) const {
        const Springs both = springs.in_series();
        const S flexspline = abs(x.torque), wave_generator = abs(x.windup_torque);
        const S beyond = x.twist - along(x.torque, both.flexspline.at(flexspline).twist) - wound(both, x.windup_torque);
        return both.flexspline.energy(flexspline) + both.wave_generator.energy(wave_generator) + x.torque * beyond;
    }

private:
    using Springs = stiffness::detail::InSeries<S>;

    /// Wind-up of the wave generator [rad] under the torque of its spring.
    static constexpr S wound(const Springs& both, const S& torque) {
        return along(torque, both.wave_generator.at(abs(torque)).twist);
    }
    /// Torque of the flexspline at its share of the twist [rad].
    static constexpr S flexed(const Springs& both, const S& twist) {
        return along(twist, min(both.flexspline.torque(abs(twist)), both.largest()));
    }

    /// Both under a torque of the wave generator's spring, the flexspline's being larger by the friction.
    static constexpr stiffness::detail::Given<S> under(const Springs& both, const S& wave_generator, const S& flexspline) {
        const auto flexed = both.flexspline.at(abs(flexspline)), wound = both.wave_generator.at(abs(wave_generator));
        return {along(flexspline, flexed.twist) + along(wave_generator, wound.twist), S(0.0), flexed.compliance + wound.compliance,
                along(flexspline, flexed.curvature) + along(wave_generator, wound.curvature)};
    }

    /// Torque of the wave generator's spring once it has slid forwards to `twist`, from `held`: at most to `most`, where the
    /// flexspline alone would bear the rest. What the search leaves, one step of Newton's does.
    constexpr S slid(const Springs& both, const S& twist, const S& held, const S& most) const {
        const S from = value_only(held), loss = value_only(friction), end = max(value_only(most), from);
        const S found = searched(both.constant(), value_only(twist), from, loss, end - from);
        const auto near = under(both, found, found + loss);
        const S level = clip(found + value_only((twist - near.twist) / near.compliance), from, end);
        if constexpr (differentiates<S>) {  // implicit function theorem
            const auto given = under(both, level, level + friction);
            const S step = (twist - given.twist) / value_only(given.compliance);
            return select(level + loss < both.largest(), level + (step - value_only(step)), level);
        }
        return level;
    }

    /// Approximation of that torque: Halley's method, bracketed by torques that are too small and too large.
    static constexpr S searched(const Springs& both, const S& twist, const S& held, const S& friction, const S& farthest) {
        const S softest = both.flexspline.softness + both.wave_generator.softness;
        auto given = under(both, held, held + friction);
        S low = clip((twist - given.twist) / softest, S(0.0), farthest), high = farthest, mismatch = S(unbounded);
        S gone = clip((twist - given.twist) / given.compliance, low, high);
        auto searching = gone > S(0.0);
        for (int i = 0; i < max_steps && any(searching); ++i) {
            const S flexspline = held + gone + friction;
            given = under(both, held + gone, flexspline);
            const S off = twist - given.twist, step = off / given.compliance;
            low = select(off > S(0.0), gone, low);
            high = select(off < S(0.0), gone, high);
            const S bend = S(1.0) + S(0.5) * step * given.curvature / given.compliance;
            const S bent = gone + step / max(bend, S(0.5));
            // Between two bends it may go to and fro.
            const auto trusted = (bent >= low) & (high >= bent) & (mismatch > S(2.0) * abs(off));
            const S next = select(trusted, bent, sqrt(low * high));
            const S moved = select(trusted, abs(next - gone), S(unbounded));
            mismatch = abs(off);
            gone = select(searching, next, gone);
            searching = searching & (moved > S(last_step) * scale(both, flexspline));
        }
        return held + gone;
    }
    /// Over which torques the compliances change.
    static constexpr S scale(const Springs& both, const S& flexspline) {
        const S flexed = S(1.0) / max(both.flexspline.hardening, S(1e-30));
        return min(max(flexed, abs(flexspline)), S(1.0) / max(both.wave_generator.hardening, S(1e-30)));
    }
    static constexpr int max_steps = 64;
    static constexpr double last_step = 1e-4;  // relative; the error after a step e is e^2 at least, and e^4 after Newton's
};

}  // namespace strainwave::hysteresis
