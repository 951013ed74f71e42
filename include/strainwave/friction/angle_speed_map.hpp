#pragma once
#include <strainwave/friction/contact.hpp>

namespace strainwave::friction {

template <class S>
struct AngleSpeedMap {
    static constexpr int speeds = 8, capacity = 128;

    Sequence<S, speeds> speed{};
    Sequence<S, capacity> level{};
    S static_ratio{1.0};

    static constexpr auto name = "angle_speed_map";
    static constexpr auto source = "definition: bilinear interpolation in a table";
    static constexpr auto doc = R"(
        Friction as a table over the speed and the angle within a turn, set-valued at rest.

        .. math:: F = F(\theta, |v|) \operatorname{sgn} v \quad (v \ne 0), \qquad |F| \le c_s\, F(\theta, 0) \quad (v = 0)

        with v the speed of the place it acts on and theta its angle, c_s = static_ratio. F is bilinear between the entries of
        level. For each speed in turn, level lists the torques at equally spaced angles of one turn, beginning at theta = 0: n
        = len(level) / len(speed) of them, at 2 pi j / n. Periodic in the angle. Below the first and beyond the last speed the
        torque is constant. Up to 8 speeds and 128 torques; an empty table is no friction.

        Another law that modulates this one treats all of it as dry friction. Asymmetric around it separates the directions.
        Use the table for friction that no formula describes. A formula, as Cyclic around Stribeck, needs fewer numbers and
        less data.

        >>> from strainwave.friction import AngleSpeedMap
        >>> law = AngleSpeedMap(speed=[1.0, 11.0], level=[0.1, 0.2, 0.3, 0.4])  # at 0 and at pi
        >>> law.steady([1.0, 6.0, 50.0]), round(float(law.steady(1.0, angle=3.141592653589793)), 12)
        (array([0.1, 0.2, 0.3]), 0.2))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, speed, "rad/s", "Speeds of the table, increasing", 0));
        visit(SW_FIELD(m, level, "N.m", "Torques at equally spaced angles of one turn, for each speed in turn", 0));
        visit(SW_FIELD(m, static_ratio, "1", "Static friction over the friction at the lowest speed", 1));
    }

    constexpr const char* problem() const {
        if (speed.count == 0 ? level.count > 0 : level.count == 0 || level.count % speed.count != 0)
            return "level must have equally many elements for each speed";
        for (int k = 1; k < speed.count; ++k)
            if (!all(speed[k] > speed[k - 1])) return "speed must increase";
        return nullptr;
    }

    using State = Stateless<S>;

    /// Torque that opposes sliding, in N.m.
    constexpr S torque(const State&, const Contact<S>& contact) const {
        return contact.sliding * contact.dry * at(contact.angle.within, abs(contact.speed));
    }

    /// The largest torque it balances at rest, in N.m.
    constexpr S hold(const Contact<S>& contact) const { return contact.dry * static_ratio * at(contact.angle.within, S(0.0)); }

private:
    constexpr S at(const S& angle, const S& magnitude) const {
        S sum{0.0};
        if (speed.count == 0) return sum;
        const int angles = level.count / speed.count;
        S n{0.0}, place{0.0};  // counted in S: to convert an integer takes double precision, which a microcontroller lacks
        for (int j = 0; j < angles; ++j) n = n + S(1.0);
        for (int j = 0; j < angles; ++j, place = place + S(1.0)) {
            S along_speed = level[j];
            for (int k = 0; k + 1 < speed.count; ++k) {
                const S share = clip((magnitude - speed[k]) / (speed[k + 1] - speed[k]), S(0.0), S(1.0));
                along_speed = along_speed + share * (level[(k + 1) * angles + j] - level[k * angles + j]);
            }
            sum = sum + (angles == 1 ? S(1.0) : weight(angle, place, n)) * along_speed;
        }
        return max(sum, S(0.0));
    }

    /// Weight of the angle at `place` of n: 1 there, falling to 0 at its neighbours.
    static constexpr S weight(const S& angle, const S& place, const S& n) {
        const S apart = angle * S(0.5 / pi) * n - place, turns = rint(apart / n);
        return max(S(1.0) - abs(apart - n * turns), S(0.0));
    }
};

}  // namespace strainwave::friction
