#pragma once
#include <strainwave/array.hpp>

#include <cstddef>
#include <vector>

/// Inputs of a drive over time.
namespace strainwave::host {

/// A sine whose frequency may rise linearly.
struct Wave {
    double amplitude, frequency, sweep, phase;  ///< unit of the signal, Hz, Hz/s, rad
};

/// A line in pieces, which may jump, and waves.
struct Signal {
    std::vector<double> start, level, slope;
    std::vector<Wave> waves;
};

/// Limit of a signal at its jumps.
enum class Side { before, after };

/// The signal, and its rate, at each of some instants [s], in any order.
void evaluate(const Signal& signal, const double* instants, std::size_t count, Side side, double* values, double* rates);

/// Count of the signals of a drive: the command, the input of its load, the temperature.
inline constexpr int signal_count = 3;
using Signals = Array<const Signal*, signal_count>;

/// The inputs from one instant until before the next at which one of them jumps: exactly, at any fraction of the way.
class Unbroken {
    const Signals signals;
    const double begin;
    Array<std::size_t, signal_count> piece;  ///< which of each holds

public:
    Unbroken(const Signals& signals_, double begin_);

    /// Writes the inputs at a fraction of `dt` [s].
    void at(double fraction, double dt, double* inputs) const;
};

/// The inputs through instants[0..steps], as a `kernel::Schedule` has them: the right limits at the start of a step, the left at
/// its end.
void lay_out(const Signals& signals, const double* instants, std::size_t steps, double* inputs);

}  // namespace strainwave::host
