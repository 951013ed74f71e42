#pragma once
#include <strainwave/integrate.hpp>

/// Two bodies and a spring between them. Coulomb friction holds the first: a system that is no drive.
template <class S>
struct TwoMasses {
    S inertia{0.5}, stiffness{200.0}, friction{0.8};

    struct Input {
        S torque{0.0};
        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, torque, "N.m", "Torque on the second body"));
        }
    };
    struct Continuous {
        strainwave::Array<S, 2> angle{}, speed{};
        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, angle, "rad", "Of each body"));
            visit(SW_FIELD(m, speed, "rad/s", "Of each body"));
        }
    };
    struct State {
        Continuous continuous{};
        S slip_direction{0.0};
        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_PART(m, continuous, "Motion"));
            visit(SW_FIELD(m, slip_direction, "1", "Of the first body"));
        }
    };
    struct Derivatives {
        Continuous rate;
        S spring_torque;
    };
    struct Evaluation {
        State state;
        Derivatives derivatives;
    };

    Evaluation evaluate(const State& x, const Input& u) const { return {x, derivatives(x, x.continuous, u)}; }
    Derivatives derivatives(const State& x, const Continuous& y, const Input& u) const {
        const S spring = stiffness * (y.angle[1] - y.angle[0]), moving = abs(x.slip_direction);
        const S net = moving * (spring - x.slip_direction * friction);
        return {{y.speed, {{net / inertia, (u.torque - spring) / inertia}}}, spring};
    }
    strainwave::Array<strainwave::Shaft<S>, 1> shafts(const State& x, const Derivatives& now) const {
        return {{{true, inertia, x.continuous.speed[0], x.slip_direction, now.spring_torque, friction}}};
    }
    void set_shaft(State& x, int, const S& speed, const S& slip_direction) const {
        x.continuous.speed[0] = speed;
        x.slip_direction = slip_direction;
    }
    S slip_friction(int, const State&, const Derivatives&, const S& direction) const { return direction * friction; }
    void move_positions(State& x, const State& before, const S& dt) const {
        x.continuous.angle[0] = before.continuous.angle[0] + S(0.5) * dt * (before.continuous.speed[0] + x.continuous.speed[0]);
    }
};
