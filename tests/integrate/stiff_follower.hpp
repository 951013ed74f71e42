#pragma once
#include <strainwave/integrate.hpp>

namespace strainwave {

/// A light body on a stiff spring whose other end a slow swing moves, by the angle of the swing: by its sine, or, with a
/// kink, by the size of its sine, with or without `has_side`. A system that is no drive, with a coupled block.
template <class S>
struct StiffFollower {
    S frequency{2e4}, damping{0.01}, pull{0.3}, kinked{0.0}, has_side{1.0};

    struct Input {
        S drive{40.0};
        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, drive, "rad/s", "Speed of the swing where the body does not pull it"));
        }
    };
    struct Continuous {
        S angle{0.0}, place{0.0}, speed{0.0};
        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, angle, "rad", "Of the swing"));
            visit(SW_FIELD(m, place, "m", "Of the body"));
            visit(SW_FIELD(m, speed, "m/s", "Of the body"));
        }
    };
    struct State {
        Continuous continuous{};
        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_PART(m, continuous, "Motion"));
        }
    };
    struct Derivatives {
        Continuous rate;
    };
    struct Evaluation {
        State state;
        Derivatives derivatives;
    };

    Evaluation evaluate(const State& x, const Input& u) const { return {x, derivatives(x, x.continuous, u)}; }
    Derivatives derivatives(const State&, const Continuous& y, const Input& u) const {
        const S wave = sin(y.angle), end = select(kinked > S(0.0), abs(wave), wave);
        return {
            {u.drive * (S(1.0) + pull * y.place), y.speed, frequency * (frequency * (end - y.place) - S(2.0) * damping * y.speed)}};
    }

    static constexpr int coupled_count = 2;
    static constexpr bool couples() { return true; }
    Array<S, 2> coupled(const Continuous& y) const { return {{y.place, y.speed}}; }
    void set_coupled(Continuous& y, const Array<S, 2>& z) const {
        y.place = z[0];
        y.speed = z[1];
    }
    Array<S, 1> coupled_mode(const State&) const { return {{S(1.0)}}; }
    Array<S, 2> coupled_rate(const Array<S, 1>&, const Array<S, 2>& z) const {
        return {{z[1], -frequency * (frequency * z[0] + S(2.0) * damping * z[1])}};
    }
    S side(const State& x) const { return select(kinked * has_side > S(0.0), sin(x.continuous.angle), S(1.0)); }
    S side(const State& x, const State& after, const S&, const S& fraction) const {
        return sin(x.continuous.angle + fraction * (after.continuous.angle - x.continuous.angle));
    }
};

}  // namespace strainwave
