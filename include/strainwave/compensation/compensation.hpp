#pragma once
#include <strainwave/compensation/compensator.hpp>
#include <strainwave/compensation/none.hpp>
#include <strainwave/compiled.hpp>

namespace strainwave {

/// States of the feed-forward, the learner, the observer and the dither.
template <class S, class Feedforward, class Learning, class Observer, class Dither_>
struct CompensationStates {
    Feedforward feedforward{};
    Learning learning{};
    Observer observer{};
    Dither_ dither{};

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, feedforward, "State of the feed-forward"));
        visit(SW_PART(m, learning, "State of the learner"));
        visit(SW_PART(m, observer, "State of the observer"));
        visit(SW_PART(m, dither, "State of the dither"));
    }
};

template <class S, class Feedforward = compensation::NoFeedforward<S>, class Learning = compensation::NoLearning<S>,
          class Observer = compensation::NoObserver<S>, class Dither_ = compensation::NoDither<S>>
struct Compensation {
    Feedforward feedforward{};
    Learning learning{};
    Observer observer{};
    Dither_ dither{};
    S actuation_per_torque{1.0};
    S actuation_per_speed{0.0};

    static constexpr auto name = "compensation";
    static constexpr auto source = "definition";
    static constexpr auto doc = R"(
        Lead of the input and torque that a sampled controller adds: those of a model, a dither, a learner and an observer.

        .. math:: \theta_r = i r + \theta_f + \theta_l, \qquad u_f = p\,(\tau_f + \tau_d + \tau_l + \tau_o) + q\,\dot\theta_r

        with r the commanded output angle, theta_f, theta_l the leads of the input by feed-forward and learner, tau_f, tau_d, tau_l,
        tau_o the torques of feed-forward, dither, learner and observer; p = actuation_per_torque, q = actuation_per_speed. The
        controller follows theta_r with the input and r with the output. It adds u_f to its actuation before any limit.

        p is 1 if the motor takes a torque, and 1 over the torque constant if it takes a current, and for a Cascade. For a
        motor that takes a voltage p is resistance over torque constant, and q the back-EMF constant.

        >>> import strainwave as sw
        >>> part = sw.Compensation(observer=sw.compensation.DisturbanceObserver(inertia=2e-4, limit=0.3))
        >>> sw.control.Sampled(law=sw.control.PositionSpeed(), compensation=part).compensation.observer.limit
        0.3)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, feedforward, "Feed-forward of a model of the drive"));
        visit(SW_PART(m, learning, "Learning of errors that repeat"));
        visit(SW_PART(m, observer, "Observer of disturbances that the model lacks"));
        visit(SW_PART(m, dither, "Torque that swings around zero"));
        visit(SW_FIELD(m, actuation_per_torque, "1/(N.m)", "Actuation of the motor per torque, p", smallest));
        visit(SW_FIELD(m, actuation_per_speed, "s/rad", "Actuation of the motor per input speed, q: its back-EMF"));
    }

    constexpr auto compile() const {
        return Compensation<S, decltype(compiled(feedforward)), decltype(compiled(learning)), decltype(compiled(observer)),
                            decltype(compiled(dither))>{compiled(feedforward), compiled(learning),   compiled(observer),
                                                        compiled(dither),      actuation_per_torque, actuation_per_speed};
    }

    /// True if any of its compensators changes the command.
    constexpr bool active() const {
        return compensation::active(feedforward) || compensation::active(learning) || compensation::active(observer) ||
               compensation::active(dither);
    }

    /// Ratio of the gear of the feed-forward's model; 0 without one.
    constexpr S model_ratio() const { return control::model_ratio<S>(feedforward); }

    using State = CompensationStates<S, typename Feedforward::State, typename Learning::State, typename Observer::State,
                                     typename Dither_::State>;
    constexpr State initial_state() const {
        return {strainwave::initial_state(feedforward), strainwave::initial_state(learning), strainwave::initial_state(observer),
                strainwave::initial_state(dither)};
    }

    /// Requests of the compensators at one sampling instant.
    struct Instant {
        typename Feedforward::State next_feedforward;  ///< state after the period
        typename Dither_::State next_dither;           ///< likewise
        compensation::Inputs<S> learning_inputs, observer_inputs;
        compensation::Request<S> learning_request, observer_request;

        /// Command of the controller, with the leads and the feed-forward of all compensators.
        constexpr control::Command<S> command(const Compensation& with) const {
            const compensation::Request<S> request = observer_inputs.request + observer_request;
            control::Command<S> command = observer_inputs.command;
            command.input_lead = request.input_lead;
            command.input_lead_rate = request.input_lead_rate;
            command.feedforward = with.actuation_per_torque * request.torque + with.actuation_per_speed * command.input_speed();
            return command;
        }
    };
    constexpr Instant instant(const State& x, const control::Command<S>& command, const control::Measurement<S>& measured,
                              const S& period) const {
        const auto model = feedforward.step(x.feedforward, command, period);
        const auto dithered = dither.step(x.dither, command, period);
        const compensation::Inputs<S> learning_inputs{command, measured, model.request + dithered.request};
        const compensation::Request<S> learning_request = learning.request(x.learning, learning_inputs);
        const compensation::Inputs<S> observer_inputs{command, measured, learning_inputs.request + learning_request};
        return {model.next,      dithered.next,    learning_inputs,
                observer_inputs, learning_request, observer.request(x.observer, observer_inputs)};
    }
    /// State after a period in which the motor received `actuation`.
    constexpr State advance(const State& x, const Instant& now, const S& actuation, const S& period) const {
        const S motor_torque = (actuation - actuation_per_speed * now.observer_inputs.measured.input_speed) / actuation_per_torque;
        return {now.next_feedforward, learning.advance(x.learning, now.learning_inputs, now.learning_request, motor_torque, period),
                observer.advance(x.observer, now.observer_inputs, now.observer_request, motor_torque, period), now.next_dither};
    }
};

}  // namespace strainwave
