#include <strainwave/scalar/dual.hpp>

#include "describe.hpp"
#include "simulate.hpp"

namespace strainwave::host {

namespace {

constexpr int width = 4;
using Slope = Dual<width>;

/// The drive with its parameters number `first` and following as the numbers that derivatives are taken by.
AnyPositionDrive<Slope> seeded(const Parts& parts, const std::vector<int>& parameters, std::size_t first) {
    return assembled<AnyPositionDrive<Slope>, Slope>(parts.shape, [&](int number) {
        Slope x(parts.numbers[number]);
        for (std::size_t p = first; p < first + width && p < parameters.size(); ++p)
            if (parameters[p] == number) x.slope[p - first] = 1.0;
        return x;
    });
}

/// Writes sample k of `kept`: values, and derivatives by the parameters number `first` and following.
void write(const Output<Slope>& output, std::size_t first, std::size_t count, std::size_t k, std::size_t kept, double* out, double* slopes) {
    const auto values = flattened<Slope>(output);
    for (int c = 0; c < channels; ++c) {
        out[c * kept + k] = values[c].value;
        for (std::size_t p = first; p < first + width && p < count; ++p)
            slopes[(p * channels + c) * kept + k] = values[c].slope[p - first];
    }
}

}  // namespace

void differentiate(const Drive& drive, const Course& course, const std::vector<int>& parameters, double* out, double* slopes,
                   std::size_t kept, const Pause& pause) {
    const Parts parts = parts_of(drive);
    for (std::size_t first = 0; first < parameters.size(); first += width) {
        const auto dual = seeded(parts, parameters, first);
        std::size_t k = 0;
        const auto record = [&](const Output<Slope>& output) { write(output, first, parameters.size(), k++, kept, out, slopes); };
        const auto paused = [&](std::size_t i) { pause(first * course.steps + width * i); };
        run<Slope>(dual, dual.rest(), course, record, paused);
    }
}

void observe_derivatives(const Drive& drive, const Input<double>& u, const std::vector<int>& parameters, double* out, double* slopes) {
    const Parts parts = parts_of(drive);
    for (std::size_t first = 0; first < parameters.size(); first += width) {
        const auto dual = seeded(parts, parameters, first);
        write(dual.output(dual.rest(), {Slope(u.command), Slope(u.command_rate), Slope(u.load_torque)}), first, parameters.size(), 0, 1, out, slopes);
    }
}

}  // namespace strainwave::host
