#pragma once
#include <strainwave/angle.hpp>
#include <strainwave/compensation/compensator.hpp>
#include <strainwave/compensation/wave.hpp>

namespace strainwave::compensation {

template <class S>
struct AdaptiveFourier {
    static constexpr int capacity = 4;

    Sequence<S, capacity> order{};
    S gain{5.0};
    S lag{0.0};
    S min_speed{1.0};
    S max_frequency{100.0};
    S limit{1e-3};

    static constexpr auto name = "adaptive_fourier";
    static constexpr auto source =
        "BodsonSacksKhosla1994, adaptive feedforward cancellation, over the input angle in place of time; its rate by averaging "
        "(SandersVerhulstMurdock2007)";
    static constexpr auto doc = R"(
        Learning of errors that repeat with the input angle: one sine and one cosine for each order.

        .. math:: \hat e = \sum_n a_n \sin n\theta + b_n \cos n\theta, \qquad
                  \dot a_n = \gamma\, (r - \theta_{out}) \sin(n\theta - \varphi_n), \quad
                  \dot b_n = \gamma\, (r - \theta_{out}) \cos(n\theta - \varphi_n), \qquad \varphi_n = n\, \omega\, t_{lag}

        with theta the input angle, r the commanded and theta_out the measured output angle, gamma = gain, t_lag = lag of the
        position loop. The input leads by i e^. Let P(j n omega) be the response of the output to the lead. The amplitude of a
        constant error of order n decays as exp(-gamma/2 |P| cos(Delta) t), with Delta the angle between P and exp(-j phi_n).
        It grows if Delta exceeds 90 degrees. Therefore learning stops if n |omega| exceeds ``max_frequency``, and if |omega|
        is below ``min_speed``. No sine and no cosine exceeds ``limit``. Keep |i| n times the largest amplitude below 1: beyond
        that the input has several angles for one command. An error of the output encoder itself is learnt as well. An order of
        0 learns a constant: with min_speed = 0 it is a slow integral of the error of the output.

        >>> from strainwave.compensation import AdaptiveFourier
        >>> AdaptiveFourier(order=[1, 2]).gain
        5.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, order, "1", "Orders n: periods per revolution of the input; 0 for a constant", 0));
        visit(SW_FIELD(m, gain, "1/s", "Rate gamma at which the amplitudes follow the error", 0));
        visit(SW_FIELD(m, lag, "s", "Lag t_lag of the position loop", 0));
        visit(SW_FIELD(m, min_speed, "rad/s", "Least input speed of learning", 0));
        visit(SW_FIELD(m, max_frequency, "rad/s", "Largest frequency n |omega| of learning", smallest));
        visit(SW_FIELD(m, limit, "rad", "Largest sine and cosine at the output", 0));
    }

    struct State {
        Array<S, capacity> sine{}, cosine{};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, sine, "rad", "Amplitude of the sine of each order"));
            visit(SW_FIELD(m, cosine, "rad", "Amplitude of the cosine of each order"));
        }
    };

    constexpr Request<S> request(const State& x, const Inputs<S>& inputs) const {
        Request<S> request{};
        for (int n = 0; n < order.count; ++n) {
            const SinCos<S> at = wave(order[n], inputs.measured.input_angle, S(0.0));
            const S pace = order[n] * inputs.input_speed();
            request.input_lead = request.input_lead + x.sine[n] * at.sin + x.cosine[n] * at.cos;
            request.input_lead_rate = request.input_lead_rate + pace * (x.sine[n] * at.cos - x.cosine[n] * at.sin);
        }
        request.input_lead = inputs.command.ratio * request.input_lead;
        request.input_lead_rate = inputs.command.ratio * request.input_lead_rate;
        return request;
    }
    constexpr State advance(const State& x, const Inputs<S>& inputs, const Request<S>&, const S&, const S& period) const {
        const S speed = inputs.input_speed(), error = inputs.command.value - inputs.measured.output_angle;
        State next = x;
        for (int n = 0; n < order.count; ++n) {
            const S pace = order[n] * speed;
            const S below = select(abs(pace) < max_frequency, gain * period * error, S(0.0));
            const S step = select(abs(speed) < min_speed, S(0.0), below);
            const SinCos<S> at = wave(order[n], inputs.measured.input_angle, pace * lag);
            next.sine[n] = clip(x.sine[n] + step * at.sin, -limit, limit);
            next.cosine[n] = clip(x.cosine[n] + step * at.cos, -limit, limit);
        }
        return next;
    }
};

}  // namespace strainwave::compensation
