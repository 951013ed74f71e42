#include "signal.hpp"

#include <strainwave/scalar/pack.hpp>

#include <algorithm>

#include "kernel/table.hpp"

namespace strainwave::host {

namespace {

constexpr int lanes = 4;
using Times = Pack<lanes>;

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

/// Instants of one pack.
void evaluate_together(const Signal& signal, const double* instants, Side side, double* values, double* rates) {
    for (int i = 0; i < lanes; ++i) {
        const std::size_t k = piece_at(signal, instants[i], side);
        values[i] = (instants[i] - signal.start[k]) * signal.slope[k] + signal.level[k];
        rates[i] = signal.slope[k];
    }
    if (signal.waves.empty()) return;
    const Times t = Times::read(instants);
    Times value = Times::read(values), rate = Times::read(rates);
    for (const Wave& wave : signal.waves) add(wave, t, value, rate);
    value.write(values);
    rate.write(rates);
}

/// Lays out one signal; its values go to every `input_count`th number from `values` on, its rates likewise.
void lay_out(const Signal& signal, const double* instants, std::size_t steps, double* values, double* rates) {
    if (steps == 0) return;
    constexpr std::size_t chunk = 256;  // steps at a time, so that what is between stays in the nearest memory
    double t[2 * chunk + 1], value[2 * chunk + 1], rate[2 * chunk + 1];
    const auto put = [&](std::size_t place, std::size_t from) {
        values[place * kernel::input_count] = value[from];
        rates[place * kernel::input_count] = rate[from];
    };
    for (std::size_t first = 0; first < steps; first += chunk) {
        const std::size_t count = std::min(chunk, steps - first);
        for (std::size_t i = 0; i < count; ++i) {
            t[2 * i] = instants[first + i];
            t[2 * i + 1] = 0.5 * (instants[first + i] + instants[first + i + 1]);
        }
        t[2 * count] = instants[first + count];
        evaluate(signal, t, 2 * count + 1, Side::after, value, rate);
        for (std::size_t i = 0; i < count; ++i)
            for (std::size_t k = 0; k < 3; ++k) put(3 * (first + i) + k, 2 * i + k);
    }
    const auto ends = instants + 1, last = ends + steps;
    const auto& starts = signal.start;  // of pieces, at which the left limits are others
    const auto within = std::upper_bound(starts.begin(), starts.end(), *instants);
    auto taken = instants;  // the end of the step before it is of the first piece that begins there, if several do but for rounding
    for (auto piece = within; piece != starts.end() && *piece <= *(last - 1); ++piece) {
        const auto end = std::lower_bound(ends, last, *piece);
        // A jump of another signal close to this one may have taken the end of the step.
        if (end == taken || *end - *piece > 1e-6 * (*end - *(end - 1))) continue;
        taken = end;
        evaluate(signal, &*piece, 1, Side::before, value, rate);
        put(3 * std::size_t(end - ends) + 2, 0);
    }
}

}  // namespace

void evaluate(const Signal& signal, const double* instants, std::size_t count, Side side, double* values, double* rates) {
    const std::size_t whole = count / lanes * lanes, rest = count - whole;
    for (std::size_t i = 0; i < whole; i += lanes) evaluate_together(signal, instants + i, side, values + i, rates + i);
    if (rest == 0) return;
    double last[lanes] = {}, last_values[lanes], last_rates[lanes];
    std::copy(instants + whole, instants + count, last);
    evaluate_together(signal, last, side, last_values, last_rates);
    std::copy(last_values, last_values + rest, values + whole);
    std::copy(last_rates, last_rates + rest, rates + whole);
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
    for (int i = 0; i < signal_count; ++i) lay_out(*signals[i], instants, steps, inputs + 2 * i, inputs + 2 * i + 1);
}

}  // namespace strainwave::host
