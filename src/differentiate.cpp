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

/// A described struct of these numbers, of which the first `count` are, from number `from` on, those that derivatives may be taken
/// by: here by number `first` and following.
template <class X, int n>
X sought(const Array<double, n>& numbers, int from, int count, int first) {
    Array<Slope, n> scalars{};
    for (int i = 0; i < n; ++i) {
        scalars[i] = Slope(numbers[i]);
        const int lane = from + i - first;
        if (i < count && lane >= 0 && lane < width) scalars[i].slope[lane] = 1.0;
    }
    return shaped<X>(scalars);
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
        const Input<Slope> input{Slope(u.command), Slope(u.command_rate), Slope(u.load_torque), Slope(u.temperature)};
        write(dual.output(dual.standing(dual.rest(), input), input), first, parameters.size(), 0, 1, out, slopes);
    }
}

void differentiate_flow(const Drive& drive, const Drive::State& x, const Input<double>& u, double* out, double* slopes) {
    constexpr int rows = motions + channels;
    const auto dual = seeded<AnyPositionDrive<Slope>>(parts_of(drive), {}, 0);
    for (int first = 0; first < motions + driving; first += width) {
        const auto state = sought<AnyPositionDrive<Slope>::State>(flattened<double>(x), 0, motions, first);
        const auto input = sought<Input<Slope>>(flattened<double>(u), motions, driving, first);
        const auto write = [&](const auto& values, int row) {
            for (int i = 0; i < values.size(); ++i) {
                out[row + i] = values[i].value;
                for (int p = first; p < first + width && p < motions + driving; ++p)
                    slopes[p * rows + row + i] = values[i].slope[p - first];
            }
        };
        write(flattened<Slope>(dual.flow(state, state.motion, input).rate), 0);
        write(flattened<Slope>(dual.output(dual.standing(state, input), input)), motions);
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
