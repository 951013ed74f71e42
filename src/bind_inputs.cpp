#include <algorithm>

#include "arrays.hpp"
#include "kernel/table.hpp"
#include "signal.hpp"
#include "time_grid.hpp"

namespace strainwave::host {

namespace {

std::vector<double> copied(const Numbers& values) { return {values.data(), values.data() + values.size()}; }

Signal signal_of(const Numbers& start, const Numbers& level, const Numbers& slope, const Numbers& waves) {
    if (start.size() == 0 || level.size() != start.size() || slope.size() != start.size() || waves.size() % 4 != 0)
        throw nb::value_error("a signal of n pieces and m waves has n starts, levels and slopes, and waves of shape (m, 4)");
    Signal signal{copied(start), copied(level), copied(slope), {}};
    for (const double* w = waves.data(); w != waves.data() + waves.size(); w += 4) signal.waves.push_back({w[0], w[1], w[2], w[3]});
    return signal;
}

/// The values of a signal and its rates, shape (2, …).
Values evaluated(const Signal& signal, const Numbers& instants, bool before) {
    std::vector<std::size_t> shape{2};
    for (std::size_t axis = 0; axis < instants.ndim(); ++axis) shape.push_back(instants.shape(axis));
    Values out = array(shape);
    evaluate(signal, instants.data(), instants.size(), before ? Side::before : Side::after, out.data(),
             out.data() + instants.size());
    return out;
}

Values inputs_of(const Signal& command, const Signal& load, const Signal& temperature, const Numbers& instants) {
    if (instants.size() < 2) throw nb::value_error("a time grid has at least two instants");
    const std::size_t steps = instants.size() - 1;
    Values out = array({steps, 3, std::size_t(kernel::input_count)});
    lay_out({{&command, &load, &temperature}}, instants.data(), steps, out.data());
    return out;
}

/// 0, step, 2 step, … and `duration`, which is always the last.
Values grid(double step, double duration, double tolerance) {
    const auto instants = room(std::size_t(duration / step) + 3);
    std::size_t count = 0;
    instants[count++] = 0.0;
    for (double next = step; next < duration - tolerance; next = double(count) * step) instants[count++] = next;
    instants[count++] = duration;
    Values out = array({count});
    std::copy_n(instants.get(), count, out.data());
    return out;
}

/// Instants from three series, flags of the samples, their instants, and the longest step.
nb::tuple time_grid_of(const Numbers& steps, const Numbers& samples, const Numbers& breaks, double tolerance) {
    const std::size_t capacity = steps.size() + samples.size() + breaks.size();
    const auto instants = room(capacity);
    const auto sampled = room<std::uint8_t>(capacity);
    const Instants all[] = {{steps.data(), steps.size()}, {samples.data(), samples.size()}, {breaks.data(), breaks.size()}};
    const Merged merged = merge(all[0], all[1], all[2], tolerance, instants.get(), sampled.get());
    Values out = array({merged.count}), times = array({merged.samples});
    auto flags = array<std::uint8_t>({merged.count});
    std::copy_n(instants.get(), merged.count, out.data());
    std::copy_n(sampled.get(), merged.count, flags.data());
    copy_samples(instants.get(), sampled.get(), merged.samples, times.data());
    return nb::make_tuple(out, flags, times, merged.longest);
}

}  // namespace

void bind_inputs(nb::module_& core) {
    nb::class_<Signal>(core, "Signal", "Command or other input over time for the compiled loops: a piecewise line, and waves.")
        .def(
            "__init__",
            [](Signal* self, const Numbers& start, const Numbers& level, const Numbers& slope, const Numbers& waves) {
                new (self) Signal(signal_of(start, level, slope, waves));
            },
            nb::arg("start"), nb::arg("level"), nb::arg("slope"), nb::arg("waves"),
            nb::sig("def __init__(self, start: " SW_ARRAY ", level: " SW_ARRAY ", slope: " SW_ARRAY ", waves: " SW_ARRAY
                    ") -> None"),
            "Pieces of a line, shape (n,) each, and amplitude, frequency, sweep and phase of each wave, shape (m, 4).")
        .def("at", &evaluated, nb::arg("instants"), nb::arg("before"),
             nb::sig("def at(self, instants: " SW_ARRAY ", before: bool) -> " SW_ARRAY),
             "Values and rates at `instants` [s], or just before them: shape (2, …).");
    core.def(
        "inputs", &inputs_of, nb::arg("command"), nb::arg("load"), nb::arg("temperature"), nb::arg("instants"),
        nb::sig("def inputs(command: Signal, load: Signal, temperature: Signal, instants: " SW_ARRAY ") -> " SW_ARRAY),
        "Command, input of the load and temperature, each with its rate, at start, middle and end of each step: shape (n, 3, 6).");
    core.def("grid", &grid, nb::arg("step"), nb::arg("duration"), nb::arg("tolerance"),
             nb::sig("def grid(step: float, duration: float, tolerance: float) -> " SW_ARRAY),
             "0, step, 2 step, … and `duration`, from which the one before is further than `tolerance`.");
    core.def("time_grid", &time_grid_of, nb::arg("steps"), nb::arg("samples"), nb::arg("breaks"), nb::arg("tolerance"),
             nb::sig("def time_grid(steps: " SW_ARRAY ", samples: " SW_ARRAY ", breaks: " SW_ARRAY
                     ", tolerance: float) -> tuple[" SW_ARRAY ", numpy.typing.NDArray[numpy.uint8], " SW_ARRAY ", float]"),
             "All instants in order (those within `tolerance` of each other are one), flags of those that are samples, the "
             "samples, and the longest step.");
}

}  // namespace strainwave::host
