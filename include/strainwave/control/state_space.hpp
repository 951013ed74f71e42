#pragma once
#include <strainwave/condition.hpp>
#include <strainwave/control/law.hpp>

namespace strainwave::control {

template <class S>
struct StateSpace {
    static constexpr int max_states = 8, max_inputs = 8;

    Sequence<S, max_states * max_states> A{};
    Sequence<S, max_states * max_inputs> B{};
    Sequence<S, max_states> C{};
    Sequence<S, max_inputs> D{};
    Sequence<S, max_states> tracking{};
    S limit{48.0};

    static constexpr auto name = "state_space";
    static constexpr auto command_unit = "rad";
    static constexpr auto source =
        "FranklinPowellEmamiNaeini2002, chapter 7; anti-windup by tracking of the limited output: AstromWittenmark1997, section "
        "9.4";
    static constexpr auto doc = R"(
        Linear controller of up to eight states and eight inputs, designed in another tool.

        .. math:: \dot x = A x + B y + l\,(u - v), \qquad v = C x + D y + u_f, \qquad u = \operatorname{clip}(v, \pm u_{max})

        .. math:: y = \big(i r - \theta_{in},\; i \dot r - \omega_{in},\; r - \theta_{out},\; \dot r - \omega_{out},\;
                  i_m,\; T,\; r,\; \dot r\big)

        with r the commanded output angle, i the signed ratio, i_m the current, T the torque transmitted, u_f the feed-forward
        of a compensation, l = tracking, u_max = limit or the limit of the motor. C has one element for each state. D has one
        element for each input: the controller takes the first inputs of y, and D determines how many. A and B are written row
        by row, one row for each state. The states begin at 0. An angle error counts from the input lead of the compensation,
        as in StateFeedback.

        In ``control.Sampled`` the states go forward by Euler, x + T (A x + B y). A controller of discrete time, x + = A_d x +
        B_d y, has A = (A_d - 1)/T and B = B_d/T, and the same C and D. It is then exact.

        Where the output is limited, ``tracking`` leads the states. An observer that contains C takes the actuation limited
        with l = the input matrix of its model. A PI controller takes l = 1/(C t), with t its tracking time. Without tracking
        an integral winds up.

        The units below are those of a motor that takes a voltage u. For a motor that takes a current or a torque read A or N.m
        in place of V.

        >>> from strainwave.control import StateSpace
        >>> pi = StateSpace(A=[0.0], B=[1.0], C=[3.0], D=[0.5], tracking=[10.0], limit=10.0)
        >>> pi.C
        (3.0,))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, A, "1/s", "Rates of the states per state, row by row"));
        visit(SW_FIELD(m, B, "1", "Rates of the states per input, row by row"));
        visit(SW_FIELD(m, C, "1", "Output per state"));
        visit(SW_FIELD(m, D, "1", "Output per input; its length is the number of inputs"));
        visit(SW_FIELD(m, tracking, "1", "Rates l of the states per output beyond its limit; none if empty"));
        visit(SW_FIELD(m, limit, "V", "Largest voltage, of either sign", smallest));
    }

    constexpr Contradiction<S> problem() const {
        const int states = C.count, inputs = D.count;
        if (A.count != states * states)
            return {"A has {} elements; with {} states, one for each element of C, it must have their square", S(A.count),
                    S(states)};
        if (B.count != states * inputs)
            return {"B has {} elements and must have one for each state, as C, and each input, as D: {}", S(B.count),
                    S(states * inputs)};
        if (tracking.count != 0 && tracking.count != states)
            return {"tracking has {} elements and must have none or one for each of the {} states", S(tracking.count), S(states)};
        return {};
    }

    struct State {
        Array<S, max_states> value{};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, value, "1", "States x; those that the law lacks stay 0"));
        }
    };

    constexpr bool needs_current() const {
        constexpr int current = 4;
        return D.count > current && (is_differentiated(D[current]) || any(!(D[current] == S(0.0))));
    }
    constexpr S act(const State& x, const Command<S>& command, const Measurement<S>& measured) const {
        return measured.limits.within(limit).limited(unlimited(x, inputs(command, measured), command));
    }
    constexpr State rate(const State& x, const Command<S>& command, const Measurement<S>& measured) const {
        const auto y = inputs(command, measured);
        const S wanted = unlimited(x, y, command), beyond = measured.limits.within(limit).limited(wanted) - wanted;
        State rate{};
        for (int i = 0; i < C.count; ++i) {
            S sum = tracking.count > 0 ? tracking[i] * beyond : S(0.0);
            for (int k = 0; k < C.count; ++k) sum = sum + A[i * C.count + k] * x.value[k];
            for (int k = 0; k < D.count; ++k) sum = sum + B[i * D.count + k] * y[k];
            rate.value[i] = sum;
        }
        return rate;
    }
    constexpr State relaxation_rate() const { return {}; }
    /// Rate of the fastest state over 2.5: a Runge-Kutta step of fourth order is stable up to 2.78 of its time.
    constexpr S fastest() const { return S(1.0 / 2.5) * spectral_radius(); }

private:
    constexpr Array<S, max_inputs> inputs(const Command<S>& command, const Measurement<S>& measured) const {
        return {{command.input_angle() - measured.input_angle, command.input_speed() - measured.input_speed,
                 command.value - measured.output_angle, command.rate - measured.output_speed, measured.current, measured.torque,
                 command.value, command.rate}};
    }
    constexpr S unlimited(const State& x, const Array<S, max_inputs>& y, const Command<S>& command) const {
        S sum = command.feedforward;
        for (int k = 0; k < C.count; ++k) sum = sum + C[k] * x.value[k];
        for (int k = 0; k < D.count; ++k) sum = sum + D[k] * y[k];
        return sum;
    }

    /// Upper bound of the magnitude of the eigenvalues of A [1/s] by Gelfand's formula: the 64th root of the norm of its 64th
    /// power.
    constexpr S spectral_radius() const {
        constexpr int squarings = 6;
        auto power = A;
        S bound = taken_out_norm(power);
        for (int k = 1; k <= squarings; ++k) {
            power = squared(power);
            S root = taken_out_norm(power);
            for (int i = 0; i < k; ++i) root = sqrt(root);
            bound = bound * root;
        }
        return bound;
    }
    /// The largest sum of magnitudes in a row, by which the matrix is then divided.
    constexpr S taken_out_norm(Sequence<S, max_states * max_states>& matrix) const {
        S norm(smallest);
        for (int i = 0; i < C.count; ++i) {
            S row(0.0);
            for (int k = 0; k < C.count; ++k) row = row + abs(matrix[i * C.count + k]);
            norm = max(norm, row);
        }
        for (int i = 0; i < matrix.count; ++i) matrix[i] = matrix[i] / norm;
        return norm;
    }
    constexpr Sequence<S, max_states * max_states> squared(const Sequence<S, max_states * max_states>& matrix) const {
        Sequence<S, max_states * max_states> product{};
        product.count = matrix.count;
        for (int i = 0; i < C.count; ++i)
            for (int j = 0; j < C.count; ++j)
                for (int k = 0; k < C.count; ++k)
                    product[i * C.count + j] = product[i * C.count + j] + matrix[i * C.count + k] * matrix[k * C.count + j];
        return product;
    }
};

}  // namespace strainwave::control
