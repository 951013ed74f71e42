#include <strainwave/quasi_static.hpp>
#include <strainwave/scalar/dual.hpp>

#include "describe.hpp"
#include "simulate.hpp"
#include "state.hpp"

namespace strainwave::host {

namespace {

constexpr int width = lanes;
using Slope = Dual<width>;

/// The same set with its parameters number `first` and following as the numbers that derivatives are taken by.
template <template <class> class Model, int n>
Model<Dual<n>> seeded(const Parts& parts, const std::vector<int>& parameters, std::size_t first) {
    return assembled<Model<Dual<n>>, Dual<n>>(parts.shape, [&](int number) {
        Dual<n> x(parts.numbers[number]);
        for (std::size_t p = first; p < first + n && p < parameters.size(); ++p)
            if (parameters[p] == number) x.slope[p - first] = 1.0;
        return x;
    });
}

/// The number of this value, the one that derivatives are taken by in lane `lane`; if there is no such lane, in none.
Slope sought(double value, int lane) {
    Slope x(value);
    if (lane >= 0 && lane < width) x.slope[lane] = 1.0;
    return x;
}

/// Writes samples one after the other: values, and derivatives by the parameters number `first` and following. Rows lie far apart,
/// so a stretch of samples is gathered before it is written.
template <int n>
class Writer {
    static constexpr std::size_t stretch = 16;
    const std::size_t first, last, channels, samples;
    double *const out, *const slopes;
    Array<Dual<n>, output_count> held[stretch];
    std::size_t written = 0, gathered = 0;

public:
    Writer(std::size_t first_, std::size_t parameters, std::size_t channels_, std::size_t samples_, double* out_, double* slopes_)
        : first(first_),
          last(std::min(parameters, first_ + n)),
          channels(channels_),
          samples(samples_),
          out(out_),
          slopes(slopes_) {}

    void operator()(const Outputs<Dual<n>>& values) {
        for (std::size_t c = 0; c < channels; ++c) held[gathered][int(c)] = values[int(c)];
        if (++gathered == stretch) flush();
    }
    void flush() {
        for (std::size_t c = 0; c < channels; ++c) {
            for (std::size_t k = 0; k < gathered; ++k) out[c * samples + written + k] = held[k][int(c)].value;
            for (std::size_t p = first; p < last; ++p) {
                double* const row = slopes + (p * channels + c) * samples + written;
                for (std::size_t k = 0; k < gathered; ++k) row[k] = held[k][int(c)].slope[p - first];
            }
        }
        written += gathered;
        gathered = 0;
    }
};

template <class S>
initial::Known<S> known_of(const Start& start) {
    const initial::Known<double> known = start.of(0);
    initial::Known<S> found{};
    for (int q = 0; q < initial::quantities; ++q)
        if (known.given[q]) found.set(initial::Quantity(q), S(known.value[q]));
    return found;
}

/// One run that gives the derivatives by `n` parameters, number `first` and following.
template <int n>
void differentiate_by(const Parts& parts, const Start& start, const InputSchedule& schedule, const std::vector<int>& parameters,
                      std::size_t first, std::size_t channels, double* out, double* slopes, std::size_t kept, const Pause& pause) {
    using Scalar = Dual<n>;
    const auto dual = seeded<AnyDrive, n>(parts, parameters, first).compile();
    Writer<n> record(first, parameters.size(), channels, kept + 1, out, slopes);
    const Input<Scalar> at_start = interval<Scalar>(schedule.inputs).start;
    const auto from = start.at_rest ? dual.rest() : initial::state(dual, known_of<Scalar>(start), at_start);
    record(shown<Scalar>(dual, begun(dual, from, at_start, Scalar(missed(schedule.first_step()))), at_start));
    run<Scalar>(dual, from, schedule, record, [&](std::size_t i) { pause(first * schedule.steps + n * i); });
    record.flush();
}

}  // namespace

void differentiate(const Drive& drive, const Start& start, const InputSchedule& schedule, const std::vector<int>& parameters,
                   double* out, double* slopes, std::size_t kept, const Pause& pause) {
    const Parts parts = parts_of(drive);
    for (std::size_t first = 0; first == 0 || first < parameters.size(); first += width)
        differentiate_by<width>(parts, start, schedule, parameters, first, std::size_t(channels_of(drive)), out, slopes, kept,
                                pause);
}

void differentiate_rates(const Drive& drive, const Drive::State& x, const Input<double>& u, double* out, double* slopes) {
    const auto values = numbers_of(drive, x);
    const auto inputs = flattened<double>(u);
    const int count = int(numbers_of(drive, x.continuous).size()), rows = count + output_count, columns = count + input_count;
    const auto dual = seeded<AnyDrive, width>(parts_of(drive), {}, 0);
    for (int first = 0; first < columns; first += width) {
        const auto state = state_of(dual, [&](int i) { return sought(values[i], i < count ? i - first : -1); });
        Array<Slope, input_count> given;
        for (int i = 0; i < input_count; ++i) given[i] = sought(inputs[i], count + i - first);
        const auto input = shaped<Input<Slope>>(given);
        const auto write = [&](const auto& found, int row) {
            for (int i = 0; i < int(found.size()); ++i) {
                out[row + i] = found[i].value;
                for (int p = first; p < first + width && p < columns; ++p) slopes[p * rows + row + i] = found[i].slope[p - first];
            }
        };
        write(numbers_of(dual, dual.derivatives(state, state.continuous, input).rate), 0);
        write(shown<Slope>(dual, dual.evaluate(state, input), input), count);
    }
}

void differentiate_loop(const AnyGear<double>& gear, const double* twist, std::size_t n, const std::vector<int>& parameters,
                        double* out, double* slopes, const Pause& pause) {
    const Parts parts = parts_of(gear);
    const std::size_t shift = parameters.size();
    Pauses pauses(pause);
    for (std::size_t first = 0; first <= shift; first += width) {
        const auto dual = seeded<AnyGear, width>(parts, parameters, first);
        const auto point = [&](std::size_t i) {
            Slope x(twist[i]);
            if (i > 0 && shift < first + width) x.slope[shift - first] = 1.0;
            return x;
        };
        QuasiStatic<Slope, AnyGear<Slope>> moved(dual, Slope(room_temperature), point(0));
        for (std::size_t i = 0; i < n; ++i) {
            pauses(i, i);
            if (i > 0) moved.move(point(i));
            const Slope torque = moved.torque(point(i));
            out[i] = torque.value;
            for (std::size_t p = first; p < first + width && p <= shift; ++p) slopes[p * n + i] = torque.slope[p - first];
        }
    }
}

void differentiate_steady(const AnyGear<double>& gear, const Sliding& sliding, std::size_t n, const std::vector<int>& parameters,
                          double* out, double* slopes, const Pause& pause) {
    const Parts parts = parts_of(gear);
    Pauses pauses(pause);
    for (std::size_t first = 0; first == 0 || first < parameters.size(); first += width) {
        const auto law = compiled(seeded<AnyGear, width>(parts, parameters, first).friction_input);
        for (std::size_t i = 0; i < n; ++i) {
            pauses(i, i);
            const Slope torque = friction::steady(law, sliding.contact<Slope>(i));
            out[i] = torque.value;
            for (std::size_t p = first; p < first + width && p < parameters.size(); ++p)
                slopes[p * n + i] = torque.slope[p - first];
        }
    }
}

}  // namespace strainwave::host
