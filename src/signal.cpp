#include "signal.hpp"

#include <strainwave/scalar/pack.hpp>

#include <algorithm>

#include "instruction_set.hpp"
#include "kernel/table.hpp"

namespace strainwave::host {

namespace {

constexpr int lanes = 4;
using Times = Pack<lanes, lanes>;  // one register of AVX2

/// Adds a wave, A sin(2 pi (f t + g t^2 / 2) + phi), and its rate.
template <class S>
void add(const Wave& wave, const S& t, S& value, S& rate) {
    const S turned = (S(0.5 * wave.sweep) * t + S(wave.frequency)) * t;
    const SinCos<S> at = sincos(S(2.0 * pi) * (turned - rint(turned)) + S(wave.phase));
    value = value + S(wave.amplitude) * at.sin;
    rate = rate + S(2.0 * pi * wave.amplitude) * (S(wave.sweep) * t + S(wave.frequency)) * at.cos;
}

/// The piece that holds at an instant, or just before it.
std::size_t piece_at(const Signal& signal, double instant, Side side) {
    const auto second = signal.start.begin() + 1, end = signal.start.end();
    const auto next = side == Side::before ? std::lower_bound(second, end, instant) : std::upper_bound(second, end, instant);
    return std::size_t(next - second);
}

/// A signal, and its rate, by one of its pieces.
struct Value {
    double value, rate;
};
Value along(const Signal& signal, std::size_t piece, double instant) {
    Value at{(instant - signal.start[piece]) * signal.slope[piece] + signal.level[piece], signal.slope[piece]};
    for (const Wave& wave : signal.waves) add(wave, instant, at.value, at.rate);
    return at;
}

/// A piece, and the instants between which it holds.
struct Line {
    std::size_t piece;
    double from, until;

    Line(const Signal& signal, double instant, Side side) : piece(piece_at(signal, instant, side)) {
        from = piece > 0 ? signal.start[piece] : -unbounded;
        until = piece + 1 < signal.start.size() ? signal.start[piece + 1] : unbounded;
    }
    bool always_holds() const { return from == -unbounded && until == unbounded; }
    bool holds(double instant, Side side) const {
        return side == Side::before ? from < instant && instant <= until : from <= instant && instant < until;
    }
    template <class S>
    void at(const Signal& signal, const S& t, S& value, S& rate) const {
        value = (t - S(signal.start[piece])) * S(signal.slope[piece]) + S(signal.level[piece]);
        rate = S(signal.slope[piece]);
    }
};

/// Instants of one pack; `line` is likely to hold.
inline void evaluate_together(const Signal& signal, const double* instants, Side side, Line& line, double* values, double* rates) {
    const Times t = Times::read(instants);
    Times value, rate;
    if (line.always_holds() || std::all_of(instants, instants + lanes, [&](double instant) { return line.holds(instant, side); })) {
        line.at(signal, t, value, rate);
    } else {
        for (int i = 0; i < lanes; ++i) {
            line = Line(signal, instants[i], side);
            line.at(signal, instants[i], values[i], rates[i]);
        }
        value = Times::read(values), rate = Times::read(rates);
    }
    for (const Wave& wave : signal.waves) add(wave, t, value, rate);
    value.write(values);
    rate.write(rates);
}

using Evaluate = void(const Signal& signal, const double* instants, std::size_t count, Side side, double* values, double* rates);
inline void evaluate_packs(const Signal& signal, const double* instants, std::size_t count, Side side, double* values,
                           double* rates) {
    if (count == 0) return;
    const std::size_t whole = count / lanes * lanes, rest = count - whole;
    Line line(signal, *instants, side);
    for (std::size_t i = 0; i < whole; i += lanes) evaluate_together(signal, instants + i, side, line, values + i, rates + i);
    if (rest == 0) return;
    double last[lanes] = {}, last_values[lanes], last_rates[lanes];
    std::copy(instants + whole, instants + count, last);
    evaluate_together(signal, last, side, line, last_values, last_rates);
    std::copy(last_values, last_values + rest, values + whole);
    std::copy(last_rates, last_rates + rest, rates + whole);
}
// GCC inlines all calls, Clang those of the first level alone: a vector of AVX2 must pass no call to a function compiled without.
#if defined(__x86_64__) && defined(__OPTIMIZE__) && !defined(__clang__)
[[gnu::target("avx2"), gnu::flatten]] void evaluate_by_avx2(const Signal& signal, const double* instants, std::size_t count,
                                                            Side side, double* values, double* rates) {
    evaluate_packs(signal, instants, count, side, values, rates);
}
Evaluate& evaluation() { return instruction_set() == "baseline" ? evaluate_packs : evaluate_by_avx2; }
#else
Evaluate& evaluation() { return evaluate_packs; }
#endif

/// Writes the left limits of a signal, and of its rate, at the ends of steps at which a piece begins.
void lay_out_left_limits(const Signal& signal, const double* instants, std::size_t steps, double* values, double* rates) {
    const auto ends = instants + 1, last = ends + steps;
    const auto& starts = signal.start;  // of pieces, at which the left limits are others
    const auto within = std::upper_bound(starts.begin(), starts.end(), *instants);
    auto taken = instants;  // the end of the step before it is of the first piece that begins there, if several do but for rounding
    for (auto piece = within; piece != starts.end() && *piece <= *(last - 1); ++piece) {
        const auto end = std::lower_bound(ends, last, *piece);
        // A jump of another signal close to this one may have taken the end of the step.
        if (end == taken || *end - *piece > 1e-6 * (*end - *(end - 1))) continue;
        taken = end;
        const std::size_t place = (3 * std::size_t(end - ends) + 2) * kernel::input_count;
        evaluate(signal, &*piece, 1, Side::before, values + place, rates + place);
    }
}

}  // namespace

void evaluate(const Signal& signal, const double* instants, std::size_t count, Side side, double* values, double* rates) {
    evaluation()(signal, instants, count, side, values, rates);
}

Unbroken::Unbroken(const Signals& signals_, double begin_) : signals(signals_), begin(begin_) {
    for (int i = 0; i < signal_count; ++i) piece[i] = piece_at(*signals[i], begin, Side::after);
}

void Unbroken::at(double fraction, double dt, double* inputs) const {
    static_assert(kernel::input_count == 2 * signal_count);
    for (int i = 0; i < signal_count; ++i) {
        const Value found = along(*signals[i], piece[i], begin + fraction * dt);
        inputs[2 * i] = found.value;
        inputs[2 * i + 1] = found.rate;
    }
}

void lay_out(const Signals& signals, const double* instants, std::size_t steps, double* inputs) {
    if (steps == 0) return;
    constexpr std::size_t chunk = 128;  // steps at a time, so that their inputs stay in the nearest memory
    double t[2 * chunk + 1], value[2 * chunk + 1], rate[2 * chunk + 1];
    Evaluate& evaluate_all = evaluation();
    for (std::size_t first = 0; first < steps; first += chunk) {
        const std::size_t count = std::min(chunk, steps - first);
        for (std::size_t i = 0; i < count; ++i) {
            t[2 * i] = instants[first + i];
            t[2 * i + 1] = 0.5 * (instants[first + i] + instants[first + i + 1]);
        }
        t[2 * count] = instants[first + count];
        for (int s = 0; s < signal_count; ++s) {
            evaluate_all(*signals[s], t, 2 * count + 1, Side::after, value, rate);
            double* place = inputs + 3 * kernel::input_count * first + 2 * s;
            const auto put = [&](std::size_t from) {
                place[0] = value[from];
                place[1] = rate[from];
                place += kernel::input_count;
            };
            for (std::size_t i = 0; i < count; ++i) {
                put(2 * i);
                put(2 * i + 1);
                put(2 * i + 2);
            }
        }
    }
    for (int s = 0; s < signal_count; ++s) lay_out_left_limits(*signals[s], instants, steps, inputs + 2 * s, inputs + 2 * s + 1);
}

}  // namespace strainwave::host
