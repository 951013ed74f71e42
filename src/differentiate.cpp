#include <strainwave/scalar/dual.hpp>

#include "describe.hpp"
#include "simulate.hpp"

namespace strainwave::host {

namespace {

constexpr int width = 8;
using Slope = Dual<width>;

/// The same set with its parameters number `first` and following as the numbers that derivatives are taken by.
template <class M>
M seeded(const Parts& parts, const std::vector<int>& parameters, std::size_t first) {
    return assembled<M, Slope>(parts.shape, [&](int number) {
        Slope x(parts.numbers[number]);
        for (std::size_t p = first; p < first + width && p < parameters.size(); ++p)
            if (parameters[p] == number) x.slope[p - first] = 1.0;
        return x;
    });
}

/// Writes sample k of `kept`: values, and derivatives by the parameters number `first` and following.
void write(const Output<Slope>& output, std::size_t first, std::size_t count, std::size_t k, std::size_t kept, double* out,
           double* slopes) {
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
    for (std::size_t first = 0; first == 0 || first < parameters.size(); first += width) {
        const auto dual = seeded<AnyPositionDrive<Slope>>(parts, parameters, first);
        std::size_t k = 0;
        const auto record = [&](const Output<Slope>& output) { write(output, first, parameters.size(), k++, kept, out, slopes); };
        const auto paused = [&](std::size_t i) { pause(first * course.steps + width * i); };
        run<Slope>(dual, dual.rest(), course, record, paused);
    }
}

void observe_derivatives(const Drive& drive, const Input<double>& u, const std::vector<int>& parameters, double* out,
                         double* slopes) {
    const Parts parts = parts_of(drive);
    for (std::size_t first = 0; first == 0 || first < parameters.size(); first += width) {
        const auto dual = seeded<AnyPositionDrive<Slope>>(parts, parameters, first);
        write(dual.output(dual.rest(), {Slope(u.command), Slope(u.command_rate), Slope(u.load_torque), Slope(u.temperature)}),
              first, parameters.size(), 0, 1, out, slopes);
    }
}

void differentiate_loop(const AnyGear<double>& gear, const double* twist, std::size_t n, const std::vector<int>& parameters,
                        double* out, double* slopes) {
    const Parts parts = parts_of(gear);
    const std::size_t shift = parameters.size();
    for (std::size_t first = 0; first <= shift; first += width) {
        const auto dual = seeded<AnyGear<Slope>>(parts, parameters, first);
        const auto point = [&](std::size_t i) {
            Slope x(twist[i]);
            if (i > 0 && shift < first + width) x.slope[shift - first] = 1.0;
            return x;
        };
        auto held = typename decltype(dual.hysteresis)::State{};
        for (std::size_t i = 0; i < n; ++i) {
            if (i > 0) held = dual.hysteresis.advance(held, point(i) - point(i - 1));
            const Slope torque = dual.stiffness.torque(point(i)) + dual.hysteresis.torque(held, Slope(0.0));
            out[i] = torque.value;
            for (std::size_t p = first; p < first + width && p <= shift; ++p) slopes[p * n + i] = torque.slope[p - first];
        }
    }
}

void differentiate_steady(const AnyGear<double>& gear, const double* speed, std::size_t n, const std::vector<int>& parameters,
                          double* out, double* slopes) {
    const Parts parts = parts_of(gear);
    for (std::size_t first = 0; first == 0 || first < parameters.size(); first += width) {
        const auto law = compiled(seeded<AnyGear<Slope>>(parts, parameters, first).friction_input);
        for (std::size_t i = 0; i < n; ++i) {
            const Slope torque = friction::steady(law, friction::Contact<Slope>{Slope(speed[i])});
            out[i] = torque.value;
            for (std::size_t p = first; p < first + width && p < parameters.size(); ++p)
                slopes[p * n + i] = torque.slope[p - first];
        }
    }
}

}  // namespace strainwave::host
