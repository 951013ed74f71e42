#pragma once
#include <strainwave/compensation/compensator.hpp>
#include <strainwave/compensation/wave.hpp>

namespace strainwave::compensation {

/// One quantity for each number of a TwistIdentification.
template <class S>
struct TwistParameters {
    static constexpr int orders = 4;
    static constexpr int capacity = 2 + 2 * orders;

    S compliance{0.0};
    S offset{0.0};
    Array<S, orders> sine{}, cosine{};

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, compliance, "1", "Value for the relative change of the compliance"));
        visit(SW_FIELD(m, offset, "rad", "Value for the offset of the encoders"));
        visit(SW_FIELD(m, sine, "rad", "Value for the sine of each order"));
        visit(SW_FIELD(m, cosine, "rad", "Value for the cosine of each order"));
    }

    constexpr S& operator[](int j) { return at(*this, j); }
    constexpr const S& operator[](int j) const { return at(*this, j); }

private:
    template <class Self>
    static constexpr auto& at(Self& m, int j) {
        if (j < 2) return j == 0 ? m.compliance : m.offset;
        return j % 2 == 0 ? m.sine[j / 2 - 1] : m.cosine[j / 2 - 1];
    }
};

template <class S>
struct TwistIdentification {
    using Parameters = TwistParameters<S>;

    Sequence<S, Parameters::orders> order{};
    S compliance_prior{0.3};
    S amplitude_prior{3e-4};
    S offset_prior{1e-3};
    S noise{2e-5};
    S noise_time{0.1};
    S memory{600.0};
    S window{10.0};
    S min_excitation{1.0};
    S min_speed{1.0};
    S limit{3.0};

    static constexpr auto name = "twist_identification";
    static constexpr auto source =
        "recursive least squares as a Kalman filter: Ljung1999, chapter 11; forgetting towards the prior: KulhavyKraus1996; update "
        "of the covariance: BucyJoseph1968; numbers without excitation: Schmidt1966";
    static constexpr auto doc = R"(
        Identification while the joint works: compliance of the gear and orders of its kinematic error, from both encoders.

        .. math:: z = \frac{\theta - \theta_f}{i} - \theta_{out} = \varphi^T x + \text{noise}, \qquad
                  \varphi = \big(\delta,\; 1,\; \sin n\theta,\; \cos n\theta\big), \qquad
                  x = \big(c,\; z_0,\; a_n,\; b_n\big)

        .. math:: K_j = \frac{(P\varphi)_j}{\varphi^T P \varphi + R}, \qquad x \leftarrow x + K\,(z - \varphi^T x), \qquad
                  P \leftarrow (I - K\varphi^T)\,P\,(I - K\varphi^T)^T + R\,K K^T, \qquad R = \sigma^2\, t_n / t_s

        .. math:: \dot x = -x / t_m, \qquad \dot P = \frac{2}{t_m}\,(P_0 - P)

        with theta and theta_out the measured angles, i the ratio, theta_f the lead and delta the twist that the feed-forward
        asks for, c the compliance over that of the model minus 1, z_0 the offset of the encoders, a_n, b_n the orders of the
        kinematic error that the model lacks, P their covariance, P_0 that of the priors, sigma = noise, t_n = noise_time, t_s the
        period, t_m = memory. The input leads by i (c delta + a_n sin n theta + b_n cos n theta); the offset is estimated only.

        A number is adapted while its excitation, var(phi_j) P_0jj / (sigma^2 t_n) over ``window``, is at least
        ``min_excitation``. The inverse of the excitation is the time in which the motion determines the number as well as its
        prior does. Otherwise the number and its standard deviation are kept, and the gain of the others accounts for its
        uncertainty. A constant torque does not determine the compliance. At an input speed below ``min_speed`` nothing
        changes. No number exceeds ``limit`` standard deviations of its prior. Keep |i| n times the largest amplitude below 1:
        beyond that the input has several angles for one command. Its own lead changes theta and i theta_out alike, so it does
        not change z.

        The state contains estimates (``value``), standard deviations (``deviation``), excitations, and ``residual``, the root
        mean square of the residual. The deviations are right while the model errs by ``noise``, for no longer than
        ``noise_time`` in one sense. It needs both encoders and a feed-forward with a twist. A load that the feed-forward does
        not know is taken for compliance.

        >>> from strainwave.compensation import TwistIdentification
        >>> TwistIdentification(order=[2]).memory
        600.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, order, "1", "Orders n: periods per revolution of the input", smallest));
        visit(SW_FIELD(m, compliance_prior, "1", "Standard deviation of the compliance over that of the model, a priori", 0, 10));
        visit(SW_FIELD(m, amplitude_prior, "rad", "Standard deviation of each sine and cosine at the output, a priori", 0, 1));
        visit(SW_FIELD(m, offset_prior, "rad", "Standard deviation of the offset of the encoders at the output, a priori", 0, 100));
        visit(SW_FIELD(m, noise, "rad", "Standard deviation sigma of the measured twist about the model", 1e-9, 1));
        visit(SW_FIELD(m, noise_time, "s", "Time t_n over which the error of the model repeats itself", 1e-6, 1e6));
        visit(SW_FIELD(m, memory, "s", "Time t_m of motion over which the numbers change by their priors", 1e-6));
        visit(SW_FIELD(m, window, "s", "Time of motion over which the excitation is measured", smallest));
        visit(SW_FIELD(m, min_excitation, "1/s", "Excitation below which a number is kept", 0));
        visit(SW_FIELD(m, min_speed, "rad/s", "Input speed below which nothing is adapted", 0));
        visit(SW_FIELD(m, limit, "1", "Largest change of a number, over its prior", 0, 1e6));
    }

    struct State {
        Parameters value{}, deviation{}, excitation{}, mean{};
        Array<S, Parameters::capacity*(Parameters::capacity - 1) / 2> correlation{};
        S residual{0.0};
        S time{0.0};
        S torsion{0.0};
        S torsion_rate{0.0};
        S begun{0.0};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_PART(m, value, "Estimates"));
            visit(SW_PART(m, deviation, "Standard deviations"));
            visit(SW_PART(m, excitation, "Excitations [1/s]"));
            visit(SW_PART(m, mean, "Means of the regressors"));
            visit(SW_FIELD(m, correlation, "1", "Correlations of the estimates, row by row below the diagonal"));
            visit(SW_FIELD(m, residual, "rad", "Root mean square of the residual at the output"));
            visit(SW_FIELD(m, time, "s", "Time of motion, up to the window"));
            visit(SW_FIELD(m, torsion, "rad", "Twist of the model, at the input"));
            visit(SW_FIELD(m, torsion_rate, "rad/s", "Rate of the twist of the model, at the input"));
            visit(SW_FIELD(m, begun, "1", "1 after the first instant"));
        }
    };
    constexpr State initial_state() const {
        State x{};
        for (int j = 0; j < count(); ++j) x.deviation[j] = prior(j);
        x.excitation.offset = offset_prior * offset_prior / density();
        return x;
    }

    constexpr Request<S> request(const State& x, const Inputs<S>& inputs) const {
        const S torsion = x.value.compliance * inputs.request.torsion;
        S lead(0.0), rate(0.0);
        for (int n = 0; n < order.count; ++n) {
            const SinCos<S> at = wave(order[n], inputs.measured.input_angle, S(0.0));
            lead = lead + x.value.sine[n] * at.sin + x.value.cosine[n] * at.cos;
            rate = rate + order[n] * inputs.input_speed() * (x.value.sine[n] * at.cos - x.value.cosine[n] * at.sin);
        }
        const S ratio = inputs.command.ratio;
        return {torsion + ratio * lead, x.value.compliance * x.torsion_rate + ratio * rate, torsion, S(0.0), S(0.0)};
    }
    constexpr State advance(const State& x, const Inputs<S>& inputs, const Request<S>&, const S&, const S& period) const {
        State next = x;
        next.torsion = inputs.request.torsion;
        next.torsion_rate = x.begun * (next.torsion - x.torsion) / period;
        next.begun = S(1.0);
        const S moves = select(abs(inputs.input_speed()) < min_speed, S(0.0), S(1.0));
        const S lead = (inputs.measured.input_angle - inputs.request.input_lead) / inputs.command.ratio;
        const Vector regressor = regressors(inputs);
        observe(next, regressor, moves * period);
        adapt(next, regressor, lead - inputs.measured.output_angle, moves, period);
        return next;
    }

private:
    static constexpr double least_variance = 1e-30;  ///< of a number: it keeps correlations finite
    using Vector = Array<S, Parameters::capacity>;
    struct Covariance {
        S item[Parameters::capacity][Parameters::capacity];
    };

    /// Density of the noise [rad2.s]: its variance over a time t is density / t.
    constexpr S density() const { return noise * noise * noise_time; }
    constexpr int count() const { return 2 + 2 * order.count; }
    constexpr S prior(int j) const { return j == 0 ? compliance_prior : j == 1 ? offset_prior : amplitude_prior; }
    static constexpr int place(int row, int column) { return row * (row - 1) / 2 + column; }

    constexpr Vector regressors(const Inputs<S>& inputs) const {
        Vector regressor{};
        regressor[0] = inputs.request.torsion / inputs.command.ratio;
        regressor[1] = S(1.0);
        for (int n = 0; n < order.count; ++n) {
            const SinCos<S> at = wave(order[n], inputs.measured.input_angle, S(0.0));
            regressor[2 + 2 * n] = at.sin;
            regressor[3 + 2 * n] = at.cos;
        }
        return regressor;
    }
    /// Moves means and excitations on; the excitation of the offset is constant.
    constexpr void observe(State& x, const Vector& regressor, const S& step) const {
        const S share = step / max(x.time + step, S(smallest));
        for (int j = 0; j < count(); ++j) {
            const S apart = regressor[j] - x.mean[j], change = apart * prior(j);
            const S excited = (S(1.0) - share) * (x.excitation[j] + share * change * change / density());
            x.mean[j] = x.mean[j] + share * apart;
            x.excitation[j] = j == 1 ? x.excitation[j] : excited;
        }
        x.time = min(x.time + step, window);
    }
    /// Kalman filter of the numbers that the motion excites, after they have relaxed towards their priors.
    constexpr void adapt(State& x, const Vector& regressor, const S& measured, const S& moves, const S& period) const {
        const S twice = S(2.0) * period / memory, renewed = twice / (S(1.0) + twice);
        const S faded = renewed / (S(1.0) + sqrt(S(1.0) - renewed)), variance = density() / period;
        Vector active{}, product{}, gain{}, left{};
        S innovation = measured, expected = variance;
        for (int j = 0; j < count(); ++j) {
            active[j] = select(x.excitation[j] < min_excitation, S(0.0), moves);
            x.value[j] = x.value[j] - active[j] * faded * x.value[j];
            innovation = innovation - regressor[j] * x.value[j];
        }
        Covariance p = relaxed(x, active, renewed, faded);
        for (int i = 0; i < count(); ++i) {
            for (int j = 0; j < count(); ++j) product[i] = product[i] + p.item[i][j] * regressor[j];
            expected = expected + regressor[i] * product[i];
        }
        for (int i = 0; i < count(); ++i) {
            gain[i] = active[i] * product[i] / expected;
            x.value[i] = clip(x.value[i] + gain[i] * innovation, -limit * prior(i), limit * prior(i));
            for (int j = 0; j < count(); ++j) {
                p.item[i][j] = p.item[i][j] - gain[i] * product[j];
                left[i] = left[i] + p.item[i][j] * regressor[j];
            }
        }
        for (int i = 0; i < count(); ++i)
            for (int j = 0; j <= i; ++j) p.item[i][j] = p.item[i][j] - left[i] * gain[j] + variance * gain[i] * gain[j];
        keep(x, p, moves);
        const S share = min(moves * period / max(x.time, S(smallest)), S(1.0)), before = x.residual * x.residual;
        const S after = sqrt(max(before + share * (innovation * innovation - before), S(least_variance)));
        x.residual = select(moves > S(0.0), after, x.residual);
    }
    constexpr void keep(State& x, const Covariance& p, const S& moves) const {
        Vector inverse{};
        for (int i = 0; i < count(); ++i) {
            x.deviation[i] = sqrt(max(p.item[i][i], S(least_variance)));
            inverse[i] = S(1.0) / x.deviation[i];
            for (int j = 0; j < i; ++j) {
                const S coefficient = clip(p.item[i][j] * inverse[i] * inverse[j], S(-1.0), S(1.0));
                S& correlation = x.correlation[place(i, j)];
                correlation = select(moves > S(0.0), coefficient, correlation);
            }
        }
    }
    constexpr Covariance relaxed(const State& x, const Vector& active, const S& renewed, const S& faded) const {
        Covariance p{};
        Vector deviation{};
        for (int i = 0; i < count(); ++i) {
            const S variance = x.deviation[i] * x.deviation[i];
            p.item[i][i] = variance + active[i] * renewed * (prior(i) * prior(i) - variance);
            deviation[i] = x.deviation[i] * (S(1.0) - active[i] * faded);
            for (int j = 0; j < i; ++j) p.item[i][j] = p.item[j][i] = x.correlation[place(i, j)] * deviation[i] * deviation[j];
        }
        return p;
    }
};

}  // namespace strainwave::compensation
