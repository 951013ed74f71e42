#pragma once
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>
#include <strainwave/shaft.hpp>

/// Interface of a system for the integrators: differential equations with memory and events.
///
/// A system over scalars S has these described structs,
///
///     Input         inputs at one instant; Input::between interpolates them within a step
///     Continuous    continuous numbers, on which the stages of a step work
///     State         `continuous`, and numbers that change at the end of a step, at an event or at instants of sampling only
///
/// these two, which are not described,
///
///     Derivatives   `rate` of Continuous, and the quantities that it follows from
///     Evaluation    `state`, its memory brought up to date, and the `derivatives` there: where steps begin and end
///
/// and two functions,
///
///     evaluate(state, input)                  -> Evaluation
///     derivatives(state, continuous, input)   -> Derivatives; the memory is that of the state
///
/// Everything else is optional, with the defaults of the functions below.
namespace strainwave::system {

/// The relaxation rate of each number [1/s]. Numbers that have one are stepped exactly, however fast they decay. Default: zero.
template <class S, class System>
constexpr typename System::Continuous relaxation_rate(const System& system, const typename System::Continuous& y,
                                                      const typename System::Derivatives& now) {
    if constexpr (requires { system.relaxation_rate(y, now); })
        return system.relaxation_rate(y, now);
    else
        return zeroed<S>(y);
}

/// Numbers that are coupled by a matrix, constant until a mode changes: a block z, whose rates are A z and a rest. Steps are exact
/// in A, however stiff it is. Such a system has
///
///     coupled_count                        largest count of them
///     couples()                            true if its models have them
///     coupled(continuous)                  -> Array, or Counted, of the numbers, in order; of rates, too
///     set_coupled(continuous, numbers)     in place
///     coupled_mode(state)                  -> Array<S, any>: further numbers that A depends on
///     coupled_rate(mode, numbers)          -> as many: A z
///     side(state)                          turns its sign where the rates jump as the numbers change
///     side(state, after, dt, fraction)     on the way from one state to another, `dt` [s] later
///
/// Default: none.
template <class System>
inline constexpr int coupled_count = [] {
    if constexpr (requires { System::coupled_count; })
        return System::coupled_count;
    else
        return 0;
}();

/// The numbers within their bounds, which a stage of a step may exceed. `now` is an instant close by.
template <class System>
constexpr typename System::Continuous clamped(const System& system, const typename System::Continuous& y,
                                              const typename System::Derivatives& now) {
    if constexpr (requires { system.clamped(y, now); })
        return system.clamped(y, now);
    else
        return y;
}

/// The discrete modes among the numbers, which a step holds constant, re-evaluated at its end.
template <class System>
constexpr typename System::Continuous update_mode(const System& system, const typename System::Continuous& y,
                                                  const typename System::Derivatives& now) {
    if constexpr (requires { system.update_mode(y, now); })
        return system.update_mode(y, now);
    else
        return y;
}

// Changes at instants. Steps end at each, so that the change is at the begin of a step.

/// True if a number changes at this instant, in any lane: as the output of a controller that samples. Rounding is forgiven as far
/// as `within` [s], less than the coming step.
template <class System, class S>
constexpr bool due(const System& system, const typename System::State& x, const S& within) {
    if constexpr (requires { system.due(x, within); })
        return system.due(x, within);
    else
        return false;
}

/// The evaluation after that.
template <class System, class S>
constexpr typename System::Evaluation sampled(const System& system, const typename System::Evaluation& at,
                                              const typename System::Input& u, const S& within) {
    if constexpr (requires { system.sampled(at, u, within); })
        return system.evaluate(system.sampled(at, u, within), u);
    else
        return at;
}

/// The state after all changes that are due at the beginning of a step.
template <class System, class S>
constexpr typename System::Evaluation up_to_date(const System& system, const typename System::Evaluation& at,
                                                 const typename System::Input& u, const S& within) {
    return system::due(system, at.state, within) ? system::sampled(system, at, u, within) : at;
}

/// The state at the end of a step of `dt` [s]: angles within a turn, the time since the last evaluation kept.
template <class System, class S>
constexpr void finish_step(const System& system, typename System::State& x, const S& dt) {
    if constexpr (requires { system.finish_step(x, dt); }) system.finish_step(x, dt);
}

// Events: moments at which the derivatives jump, as a shaft stops or breaks away.

/// A system whose events are those of shafts, as most are. It has
///
///     shafts(state, derivatives)                      -> Array<Shaft<S>, n>
///     set_shaft(state, i, speed, slip_direction)      in place
///     slip_friction(i, state, derivatives, direction) -> N.m, torque of set-valued friction against slip in this direction
///     move_positions(state, before, dt)               in place: the positions after `dt` [s], from the speeds at both ends
///
/// and perhaps sticks(state), which spares the work where no shaft sticks.
template <class System>
concept HasShafts = requires(const System& system, const typename System::State& x, const typename System::Derivatives& now) {
    system.shafts(x, now);
};

/// True if these models have events.
template <class System>
constexpr bool has_events(const System& system) {
    if constexpr (requires { system.has_events(); })
        return system.has_events();
    else
        return HasShafts<System>;
}

/// True if a shaft may stick, in any lane.
template <class System>
constexpr bool sticks(const System& system, const typename System::State& x) {
    if constexpr (requires { system.sticks(x); })
        return system.sticks(x);
    else
        return HasShafts<System>;
}

/// Positive until the next event.
template <class S, class System>
constexpr S event_function(const System& system, const typename System::Evaluation& at) {
    if constexpr (requires { system.event_function(at); }) {
        return system.event_function(at);
    } else if constexpr (HasShafts<System>) {
        const auto shafts = system.shafts(at.state, at.derivatives);
        S least = shafts[0].event_function();
        for (int i = 1; i < shafts.size(); ++i) least = min(least, shafts[i].event_function());
        return least;
    } else {
        return S(unbounded);
    }
}

/// The state after the event whose function is zero, in these lanes: the shaft stops, breaks away or turns round.
template <class System, class Mask>
constexpr typename System::State apply_event(const System& system, const typename System::Evaluation& at,
                                             const typename System::Input& u, const Mask& lanes) {
    if constexpr (requires { system.apply_event(at, u, lanes); }) {
        return system.apply_event(at, u, lanes);
    } else if constexpr (HasShafts<System>) {
        const auto before = system.shafts(at.state, at.derivatives);
        const auto none = lanes & !lanes;
        auto x = at.state;
        Array<decltype(none & before[0].sticks()), before.size()> has_event{}, stops{};
        auto least = before[0].event_function();
        has_event[0] = lanes & !(least < least);
        for (int i = 1; i < before.size(); ++i) {
            const auto earlier = before[i].event_function() < least;
            for (int j = 0; j < i; ++j) has_event[j] = has_event[j] & !earlier;
            has_event[i] = lanes & earlier;
            least = min(least, before[i].event_function());
        }
        for (int i = 0; i < before.size(); ++i) {
            const auto slips = !before[i].sticks();
            stops[i] = has_event[i] & slips;
            system.set_shaft(x, i, select(stops[i], decltype(least)(0.0), before[i].speed), before[i].slip_direction);
        }
        const auto now = system.evaluate(x, u).derivatives;
        const auto after = system.shafts(x, now);
        for (int i = 0; i < before.size(); ++i)
            system.set_shaft(x, i, after[i].speed,
                             select(has_event[i], after[i].direction_after(stops[i]), after[i].slip_direction));
        return x;
    } else {
        return at.state;
    }
}

/// The event that led to the state `after`, applied where it was located, close by: there the event function may not determine
/// which event it is.
template <class System>
constexpr typename System::Evaluation with_event_applied(const System& system, const typename System::Evaluation& at,
                                                         const typename System::State& after, const typename System::Input& u) {
    if constexpr (requires { system.shafts(after, at.derivatives); }) {
        const auto here = system.shafts(at.state, at.derivatives), there = system.shafts(after, at.derivatives);
        auto x = at.state;
        for (int i = 0; i < here.size(); ++i) {
            using S = decltype(there[i].speed);
            system.set_shaft(x, i, select(there[i].speed == S(0.0), S(0.0), here[i].speed), there[i].slip_direction);
        }
        return system.evaluate(x, u);
    } else {
        return at;
    }
}

/// True if a shaft that sticks is no longer held, as after a jump of an input.
template <class System>
constexpr bool breaks_away(const System& system, const typename System::Evaluation& at) {
    if constexpr (HasShafts<System>) {
        if (!sticks(system, at.state)) return false;
        const auto shafts = system.shafts(at.state, at.derivatives);
        for (int i = 0; i < shafts.size(); ++i)
            if (any(shafts[i].breaks_away())) return true;
    }
    return false;
}

/// The state with that shaft slipping.
template <class System>
constexpr typename System::Evaluation break_away(const System& system, const typename System::Evaluation& at,
                                                 const typename System::Input& u) {
    if constexpr (HasShafts<System>) {
        auto x = at.state;
        const auto shafts = system.shafts(x, at.derivatives);
        for (int i = 0; i < shafts.size(); ++i) system.set_shaft(x, i, shafts[i].speed, shafts[i].break_away_direction());
        return system.evaluate(x, u);
    } else {
        return at;
    }
}

/// The state `dt` [s] after `x` under the torques of `now`, those of set-valued friction as impulses. `end` holds the numbers that
/// friction does not move.
template <class System, class S>
constexpr typename System::State impulse_step(const System& system, const typename System::State& x,
                                              const typename System::Continuous& end, const typename System::Derivatives& now,
                                              const S& dt) {
    if constexpr (requires { system.impulse_step(x, end, now, dt); }) {
        return system.impulse_step(x, end, now, dt);
    } else {
        typename System::State y = x;
        y.continuous = end;
        if constexpr (HasShafts<System>) {
            const auto shafts = system.shafts(x, now);
            for (int i = 0; i < shafts.size(); ++i) {
                const auto friction = [&](const S& direction) { return system.slip_friction(i, x, now, direction); };
                const auto after = shafts[i].impelled(dt, friction);
                system.set_shaft(y, i, after.speed, after.slip_direction);
            }
            system.move_positions(y, x, dt);
        }
        return y;
    }
}

// Error control.

/// The same state with its angles counted from the turn of another state, so that the numbers of both can be compared.
template <class System>
constexpr typename System::State aligned(const System& system, const typename System::State& x, const typename System::State& to) {
    if constexpr (requires { system.aligned(x, to); })
        return system.aligned(x, to);
    else
        return x;
}

/// A number that must keep the tolerance as the continuous ones do, because it depends on the memory. It turns its sign where an
/// event of a shaft that sticks may be hidden between two evaluations. Without: 0.
template <class S, class System>
constexpr S watched(const System& system, const typename System::Evaluation& at) {
    if constexpr (requires { system.watched(at); })
        return system.watched(at);
    else
        return S(0.0);
}

/// The numbers whose rate jumps where a force does, the others zero: their rates must agree with the way they took.
template <class S, class System>
constexpr typename System::Continuous speeds(const System& system, const typename System::Continuous& y) {
    if constexpr (requires { system.speeds(y); })
        return system.speeds(y);
    else
        return zeroed<S>(y);
}

}  // namespace strainwave::system
