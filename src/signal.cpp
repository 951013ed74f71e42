#include "signal.hpp"

#include <strainwave/scalar/pack.hpp>

#include <algorithm>

#include "simulate.hpp"

namespace strainwave::host {

namespace {

using Times = Pack<lanes>;

/// Adds a wave, A sin(2 pi (f t + g t^2 / 2) + phi), and its rate.
void add(const Wave& wave, const Times& t, Times& value, Times& rate) {
    const Times turned = (Times(0.5 * wave.sweep) * t + Times(wave.frequency)) * t;
    const SinCos<Times> at = sincos(Times(2.0 * pi) * (turned - rint(turned)) + Times(wave.phase));
    value = value + Times(wave.amplitude) * at.sin;
    rate = rate + Times(2.0 * pi * wave.amplitude) * (Times(wave.sweep) * t + Times(wave.frequency)) * at.cos;
}

/// The piece that holds at an instant, or just before it.
std::size_t piece_at(const Signal& signal, double instant, Side side) {
    const auto second = signal.start.begin() + 1, end = signal.start.end();
    const auto next = side == Side::before ? std::lower_bound(second, end, instant) : std::upper_bound(second, end, instant);
    return std::size_t(next - second);
}

/// As many as a pack holds.
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

/// Lays out one signal; its values go to every `driving`th number from `values` on, its rates likewise.
void lay_out(const Signal& signal, const double* instants, std::size_t steps, double* values, double* rates) {
    if (steps == 0) return;
    constexpr std::size_t most = 256;  // steps at a time, so that what is between stays in the nearest memory
    double t[2 * most + 1], value[2 * most + 1], rate[2 * most + 1];
    const auto put = [&](std::size_t place, std::size_t from) {
        values[place * driving] = value[from];
        if (rates) rates[place * driving] = rate[from];
    };
    for (std::size_t first = 0; first < steps; first += most) {
        const std::size_t count = std::min(most, steps - first);
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
    for (auto piece = within; piece != starts.end() && *piece <= *(last - 1); ++piece) {
        const auto end = std::lower_bound(ends, last, *piece);
        // A jump of another signal just beside this one may have taken the end of the step.
        if (*end - *piece > 1e-6 * (*end - *(end - 1))) continue;
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

void lay_out(const Signals& signals, const double* instants, std::size_t steps, double* inputs) {
    lay_out(signals.command, instants, steps, inputs, inputs + 1);
    lay_out(signals.load_torque, instants, steps, inputs + 2, nullptr);
    lay_out(signals.temperature, instants, steps, inputs + 3, nullptr);
}

}  // namespace strainwave::host
