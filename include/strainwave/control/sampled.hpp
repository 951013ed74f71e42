#pragma once
#include <strainwave/compensation/compensation.hpp>
#include <strainwave/control/pid.hpp>

namespace strainwave::control {

template <class S, class Law_ = PID<S>, class Compensation_ = Compensation<S>>
struct Sampled {
    using Law = Law_;
    using Compensation = Compensation_;

    Law law{};
    Compensation compensation{};
    S period{1e-3};
    S delay{0.0};

    static constexpr auto name = "sampled";
    static constexpr auto source =
        "AstromWittenmark1997, chapters 2 and 8: zero-order hold, integrals by forward differences, lags exactly for a constant "
        "input";
    static constexpr auto doc = R"(
        Controller that runs in a computer: it acts at instants and holds its output between them.

        .. math:: u(t) = u_k, \quad t_k + d \le t < t_{k+1} + d, \qquad u_k = \text{law}(x_k, r_k, y_k), \qquad
                  x_{k+1} = x_k + \frac{1 - e^{-\lambda T}}{\lambda}\, \dot x_k

        with t_k = k T, T = period, d = delay (the computing time, at most a period), r_k and y_k command and measurement at
        t_k, x_k the numbers of the law. An integral has lambda = 0, thus x_{k+1} = x_k + T dx_k/dt. A section of a LeadLag has
        lambda = 1 / b, which is exact under a constant input. The input of its second section is not constant, so that this
        section is of first order in T, as an integral is. Before the first output the actuation is 0. ``compensation`` adds a
        lead and a feed-forward at each instant. Steps end at each t_k and each t_k + d, so that events of the controller are
        exact. The law is any that is not sampled itself.

        In an ensemble, period and delay are the same for all members. They have no derivatives.

        >>> from strainwave.control import PID, Sampled
        >>> law = PID(proportional=2.0, derivative=0.05)
        >>> Sampled(law=law, period=1e-3, delay=2e-4).law.proportional
        2.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, law, "Law of control, evaluated at each instant"));
        visit(SW_PART(m, compensation, "Lead and feed-forward that are added to the command"));
        visit(SW_FIELD(m, period, "s", "Time from one sample to the next", smallest));
        visit(SW_FIELD(m, delay, "s", "Time from a sample to the output that follows from it", 0));
    }

    constexpr const char* problem() const {
        if (!all(delay <= period)) return "delay must not exceed period";
        if (!all(period <= control::max_period<S>(law)))
            return "period must not exceed reference_time of the law: the lags of its command would grow";
        if (!all(period <= control::max_period<S>(compensation.dither)))
            return "frequency of the dither must be below half of the sample rate";
        const S of_law = control::model_ratio<S>(law), of_model = compensation.model_ratio();
        if (!all(of_law == S(0.0)) && !all(of_model == S(0.0)) && !all(abs(of_law - of_model) <= S(max_ratio_error) * abs(of_law)))
            return "law and compensation contain models of different ratios: give both the kinematics of the drive";
        return !compensation.active() || follows_angle(law)
                   ? nullptr
                   : "compensation is that of a motion: law must follow an angle, as PositionSpeed, Cascade, PID, LeadLag, "
                     "StateSpace, StateFeedback, FeedbackLinearisation and KinematicErrorTracking do";
    }

    /// Ratio of the model of the law, or of the compensation if the law has no model; 0 without a model.
    constexpr S model_ratio() const {
        const S of_law = control::model_ratio<S>(law);
        return select(of_law == S(0.0), compensation.model_ratio(), of_law);
    }

    using State = Stateless<S>;
    constexpr State initial_state() const { return {}; }

    /// Zero before the first sample, which is then taken at once.
    struct Discrete {
        typename Law::State law{};
        typename Compensation::State compensation{};
        S actuation{0.0};
        S pending{0.0};
        S until_sample{0.0};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_PART(m, law, "State of the law"));
            visit(SW_PART(m, compensation, "State of the compensation"));
            visit(SW_FIELD(m, actuation, "1", "Actuation of the motor, in its unit"));
            visit(SW_FIELD(m, pending, "1", "Actuation after the delay, in the unit of the motor"));
            visit(SW_FIELD(m, until_sample, "s", "Time until the next sample"));
        }
    };

    constexpr Discrete initial_discrete() const {
        return {strainwave::initial_state(law), compensation.initial_state(), S(0.0), S(0.0), S(0.0)};
    }
    constexpr auto compile() const {
        return Sampled<S, decltype(compiled(law)), decltype(compensation.compile())>{compiled(law), compensation.compile(), period,
                                                                                     delay};
    }
    constexpr S held(const Discrete& x) const { return x.actuation; }
    constexpr State rate(const State&, const Command<S>&, const Measurement<S>&) const { return {}; }
    constexpr State relaxation_rate() const { return {}; }
    constexpr Discrete elapsed(const Discrete& x, const S& dt) const {
        Discrete later = x;
        later.until_sample = x.until_sample - dt;
        return later;
    }
    constexpr bool due(const Discrete& x, const S& within) const {
        return any(sample_is_due(x, within)) || any(output_is_due(x, within) & !(x.actuation == x.pending));
    }
    constexpr Discrete sampled(const Discrete& before, const S& within, const Command<S>& command,
                               const Measurement<S>& measured) const {
        const Discrete x = with_output(before, within);  // a delay of a whole period ends where the next sample begins
        const auto now = sample_is_due(x, within);
        const auto instant = compensation.instant(x.compensation, command, measured, period);
        const Command<S> asked = instant.command(compensation);
        const auto rate = flattened<S>(law.rate(x.law, asked, measured)), relaxation = flattened<S>(law.relaxation_rate());
        auto numbers = flattened<S>(x.law);
        for (int i = 0; i < numbers.size(); ++i) numbers[i] = select(now, numbers[i] + reach(relaxation[i]) * rate[i], numbers[i]);
        const S actuation = law.act(x.law, asked, measured), pending = select(now, actuation, x.pending);
        const auto compensated = compensation.advance(x.compensation, instant, actuation, period);
        const S until_sample = select(now, x.until_sample + period, x.until_sample);
        return with_output(
            {refilled(x.law, numbers), chosen<S>(now, compensated, x.compensation), x.actuation, pending, until_sample}, within);
    }
    constexpr Schedule<S> schedule(const Discrete& x) const { return {x.until_sample, period, delay}; }

private:
    /// Change of a number over a period, per rate at its begin [s].
    constexpr S reach(const S& relaxation) const {
        const auto relaxes = relaxation > S(0.0);
        if (!any(relaxes)) return period;
        const S rate = select(relaxes, relaxation, S(1.0));
        return select(relaxes, (S(1.0) - exp(-min(rate * period, S(beyond_digits)))) / rate, period);
    }
    constexpr auto sample_is_due(const Discrete& x, const S& within) const { return within >= x.until_sample; }
    constexpr auto output_is_due(const Discrete& x, const S& within) const { return within >= x.until_sample - (period - delay); }
    constexpr Discrete with_output(const Discrete& x, const S& within) const {
        Discrete after = x;
        after.actuation = select(output_is_due(x, within), x.pending, x.actuation);
        return after;
    }
};

}  // namespace strainwave::control
