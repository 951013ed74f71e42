#include "simulate.hpp"

namespace strainwave::host {

Drive::State simulate(const Drive& drive, const Drive::State& start, const Course& course, double* out, std::size_t kept,
                      const Pause& pause) {
    std::size_t k = 0;
    const auto record = [&](const Output<double>& output) {
        const auto values = flattened<double>(output);
        for (int c = 0; c < channels; ++c) out[c * kept + k] = values[c];
        ++k;
    };
    return run<double>(drive, start, course, record, pause);
}

void observe(const Drive& drive, const Drive::State& x, const Input<double>& u, double* out) {
    const auto values = flattened<double>(drive.output(x, u));
    for (int c = 0; c < channels; ++c) out[c] = values[c];
}

}  // namespace strainwave::host
