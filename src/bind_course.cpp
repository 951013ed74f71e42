#include <algorithm>

#include "bind.hpp"
#include "instruction_set.hpp"

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
    kernels().evaluate(signal, instants.data(), instants.size(), before ? Side::before : Side::after, out.data(),
                       out.data() + instants.size());
    return out;
}

Values inputs_of(const Signal& command, const Signal& load_torque, const Signal& temperature, const Numbers& instants) {
    if (instants.size() < 2) throw nb::value_error("a course has at least two instants");
    const std::size_t steps = instants.size() - 1;
    Values out = array({steps, 3, std::size_t(driving)});
    kernels().lay_out({command, load_torque, temperature}, instants.data(), steps, out.data());
    return out;
}

/// 0, step, 2 step, … and `duration`, which is always the last.
Values grid(double step, double duration, double tolerance) {
    std::vector<double> instants;
    for (std::size_t k = 0; double(k) * step < duration - tolerance; ++k) instants.push_back(double(k) * step);
    instants.push_back(duration);
    Values out = array({instants.size()});
    std::copy(instants.begin(), instants.end(), out.data());
    return out;
}

/// Instants from three series, each in order: whatever is within `tolerance` of its neighbour is one.
nb::tuple course_of(const Numbers& steps, const Numbers& samples, const Numbers& breaks, double tolerance) {
    const std::size_t most = steps.size() + samples.size() + breaks.size();
    std::vector<double> instants;
    std::vector<std::uint8_t> sampled;
    instants.reserve(most);
    sampled.reserve(most);
    const Numbers* series[] = {&steps, &samples, &breaks};
    std::size_t next[3] = {};
    double before = -unbounded;
    for (;;) {
        int earliest = -1;
        for (int i = 0; i < 3; ++i)
            if (next[i] < series[i]->size() &&
                (earliest < 0 || series[i]->data()[next[i]] < series[earliest]->data()[next[earliest]]))
                earliest = i;
        if (earliest < 0) break;
        const double instant = series[earliest]->data()[next[earliest]++];
        if (instant - before > tolerance) {
            instants.push_back(instant);
            sampled.push_back(0);
        }
        before = instant;
        if (earliest == 1) sampled.back() = 1;
        if (earliest == 2) instants.back() = instant;  // a step that ends at a break does so exactly: the inputs jump
    }
    Values out = array({instants.size()});
    auto flags = array<std::uint8_t>({sampled.size()});
    std::copy(instants.begin(), instants.end(), out.data());
    std::copy(sampled.begin(), sampled.end(), flags.data());
    return nb::make_tuple(out, flags);
}

}  // namespace

void bind_course(nb::module_& core) {
    nb::class_<Signal>(core, "Signal",
                       "A command or another input over time, as the compiled loops know it: a line in pieces, and waves.")
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
    core.def("inputs", &inputs_of, nb::arg("command"), nb::arg("load_torque"), nb::arg("temperature"), nb::arg("instants"),
             nb::sig("def inputs(command: Signal, load_torque: Signal, temperature: Signal, instants: " SW_ARRAY ") -> " SW_ARRAY),
             "Command, its rate, load torque and temperature at start, middle and end of each step: shape (n, 3, 4).");
    core.def("grid", &grid, nb::arg("step"), nb::arg("duration"), nb::arg("tolerance"),
             nb::sig("def grid(step: float, duration: float, tolerance: float) -> " SW_ARRAY),
             "0, step, 2 step, … and `duration`, from which the one before is further than `tolerance`.");
    core.def("course", &course_of, nb::arg("steps"), nb::arg("samples"), nb::arg("breaks"), nb::arg("tolerance"),
             nb::sig("def course(steps: " SW_ARRAY ", samples: " SW_ARRAY ", breaks: " SW_ARRAY
                     ", tolerance: float) -> tuple[" SW_ARRAY ", numpy.typing.NDArray[numpy.uint8]]"),
             "All instants in order, whatever is within `tolerance` of its neighbour being one, and which of them are samples.");
}

}  // namespace strainwave::host
