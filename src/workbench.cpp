#include <array>
#include <string>

#include "describe.hpp"
#include "general/drives.hpp"
#include "general/verbs.hpp"
#include "parameter_drive.hpp"

/// Entry of the workbench, the page that shows a gear in a browser: functions of the general drive over buffers of fixed size.
/// `src/workbench.py` compiles it for WebAssembly. No input ends in a trap: a set of parameters is read within its bounds first.
#ifdef __wasm__
#define EXPORT(name) extern "C" __attribute__((export_name(#name)))
#else  // compiled for its warnings alone
#define EXPORT(name) extern "C"
#endif

using namespace strainwave;

namespace {

constexpr int max_whole = 4096, max_numbers = 65536, max_points = 32768, max_rows = 16, max_parameters = 256;
constexpr std::size_t max_slopes = 1 << 20;

// Inputs that the page writes, then outputs that it reads.
int laws[max_whole], shape[max_whole], parameters[max_parameters], recorded[max_rows];
double numbers[max_numbers], points[4 * max_points], instants[max_points + 1], inputs[3 * kernel::input_count * max_points];
std::uint8_t keep[max_points];
double values[max_rows * max_points], slopes[max_slopes];
std::string problem;

/// Result of a call: done, or why not; a message of `problem_text` explains all but `done`.
enum Code { done = 0, refused = 1, not_finite = 2, stopped = 3 };

Code refuse(const std::string& text) {
    problem = text;
    return refused;
}

/// A number in the words of a message.
std::string text_of(double number) {
    char digits[32];
    const auto end = std::to_chars(digits, digits + sizeof digits, number);
    return {digits, end.ptr};
}

/// Fills in a model from the buffers, each read within its count and each value within the limits of its field.
struct Filler {
    int law_count, shape_count, number_count;
    int law = 0, whole = 0, number = 0;

    template <class T>
    void operator()(T& member, const Field& field) {
        if (!problem.empty()) return;
        if constexpr (host::is_choice<T>)
            choose(member, field);
        else if constexpr (Described<T>)
            T::fields(member, *this);
        else if constexpr (host::is_sequence<T>)
            read_sequence(member, field);
        else if constexpr (std::is_enum_v<T>)
            member = T(next_whole(0, choices(T{}).size() - 1, field));
        else if constexpr (std::is_same_v<T, int>)
            member = next_whole(field.min, field.max, field);
        else
            member = next_number(field);
    }

private:
    template <class S, class... Law>
    void choose(Choice<S, Law...>& choice, const Field& field) {
        if (law >= law_count) return void(refuse(std::string(field.name) + ": too few laws"));
        const int chosen = laws[law++];
        if (chosen < 0 || chosen >= int(sizeof...(Law))) return void(refuse(std::string(field.name) + ": no such law"));
        int i = 0;
        ((i++ == chosen ? Law::fields(choice.model.template emplace<Law>(), *this) : void()), ...);
    }
    template <class T>
    void read_sequence(T& sequence, const Field& field) {
        sequence.count = next_whole(0, T::capacity, field);
        for (int i = 0; i < sequence.count && problem.empty(); ++i) sequence[i] = next_number(field);
    }
    int next_whole(double low, double high, const Field& field) {
        if (whole >= shape_count) return refuse(std::string(field.name) + ": too few whole numbers"), 0;
        const int value = shape[whole++];
        if (value >= low && value <= high) return value;
        return refuse(std::string(field.name) + ": " + text_of(value) + " of at most " + text_of(high)), 0;
    }
    double next_number(const Field& field) {
        if (number >= number_count) return refuse(std::string(field.name) + ": too few numbers"), 0.0;
        const double value = numbers[number++];
        if (value >= field.min && value <= field.max && value - value == 0.0 && !(field.whole && value != floor(value)))
            return value;
        return refuse(std::string(field.name) + " = " + text_of(value) + " lies outside of its limits"), 0.0;
    }
};

/// The first contradiction between the numbers of a model or of a part of it.
template <class M>
void find_problem(const M& model) {
    if (problem.empty()) problem = host::own_problem_of(model);
    M::fields(model, []<class T>(const T& member, const Field&) {
        if constexpr (host::is_choice<T>)
            member.visit([](const auto& law) { find_problem(law); });
        else if constexpr (Described<T>)
            find_problem(member);
    });
}

/// True if the buffers contain the parameters of a model; else `problem` has the reason.
template <class M>
bool holds(int law_count, int shape_count, int number_count) {
    static M model;
    model = M{};
    problem.clear();
    if (law_count < 0 || law_count > max_whole || shape_count < 0 || shape_count > max_whole || number_count < 0 ||
        number_count > max_numbers)
        return refuse("the set is larger than the buffers"), false;
    Filler fill{law_count, shape_count, number_count};
    M::fields(model, fill);
    if (problem.empty() && (fill.law != law_count || fill.whole != shape_count || fill.number != number_count))
        refuse("more numbers than the model has");
    if (problem.empty()) find_problem(model);
    return problem.empty();
}

/// Code of a call that filled in `count` values.
Code finite(int count) {
    for (int i = 0; i < count; ++i)
        if (!(values[i] - values[i] == 0.0)) {
            problem = "value " + std::to_string(i) + " is no finite number";
            return not_finite;
        }
    return done;
}

void go_on(std::size_t) {}

/// f(set) of the gear in the buffers, whose `count` values per point it fills in.
template <class F>
int of_gear(int law_count, int shape_count, int number_count, int n, int count, const F& f) {
    if (!holds<ParameterGear>(law_count, shape_count, number_count)) return refused;
    if (n < 1 || n > max_points) return refuse("1 to " + std::to_string(max_points) + " points");
    for (int i = 0; i < n; ++i)
        if (!(points[i] - points[i] == 0.0)) return refuse("point " + std::to_string(i) + " is no finite number");
    f(kernel::Set{laws, shape, numbers, number_count});
    return problem.empty() ? finite(count * n) : refused;
}

/// True if `parameters` has `count` of the numbers of the set, and there is room for derivatives by them and one more.
bool are_parameters(int count, int number_count, int n) {
    bool all = count >= 0 && count < max_parameters && std::size_t(count + 1) * std::size_t(n) <= max_slopes;
    for (int p = 0; all && p < count; ++p) all = parameters[p] >= 0 && parameters[p] < number_count;
    return all || (refuse("no such parameters"), false);
}

}  // namespace

// Addresses of the buffers.
EXPORT(laws_at) void* laws_at() { return laws; }
EXPORT(shape_at) void* shape_at() { return shape; }
EXPORT(numbers_at) void* numbers_at() { return numbers; }
EXPORT(parameters_at) void* parameters_at() { return parameters; }
EXPORT(points_at) void* points_at() { return points; }
EXPORT(instants_at) void* instants_at() { return instants; }
EXPORT(inputs_at) void* inputs_at() { return inputs; }
EXPORT(keep_at) void* keep_at() { return keep; }
EXPORT(recorded_at) void* recorded_at() { return recorded; }
EXPORT(values_at) void* values_at() { return values; }
EXPORT(slopes_at) void* slopes_at() { return slopes; }
EXPORT(capacity) int capacity() { return max_points; }
EXPORT(problem_text) const char* problem_text() { return problem.c_str(); }

// Arguments of each: the counts of laws, whole numbers and numbers of the set in the buffers, and of points.

/// Torque [N.m] along a path of twist [rad], without history at twist 0.
EXPORT(loop) int loop(int l, int s, int c, int n) {
    return of_gear(l, s, c, n, 1, [&](const kernel::Set& gear) { general::trace(gear, points, n, values, go_on); });
}
/// Twist [rad] along a path of torque [N.m]; values after the first that no twist gives are not finite.
EXPORT(twist) int twist(int l, int s, int c, int n) {
    return of_gear(l, s, c, n, 1, [&](const kernel::Set& gear) {
        for (int i = int(general::twist(gear, points, n, values, go_on)); i < n; ++i) values[i] = __builtin_nan("");
    });
}
/// Torque [N.m] along a path of twist [rad] that begins without history; derivatives by `count` parameters, then by a shift of
/// all points but the first, in slopes[p * n + i].
EXPORT(loop_slopes) int loop_slopes(int l, int s, int c, int n, int count) {
    return of_gear(l, s, c, n, 1, [&](const kernel::Set& gear) {
        if (are_parameters(count, c, n))
            general::differentiate_loop(gear, points, n, {parameters, parameters + count}, values, slopes, go_on);
    });
}
/// Steady friction torque at the input [N.m] over speed [rad/s], angle [rad], load [N.m] and temperature [K], one after the other
/// in `points`; derivatives by `count` parameters in slopes[p * n + i].
EXPORT(friction) int friction(int l, int s, int c, int n, int count) {
    return of_gear(l, s, c, n, 1, [&](const kernel::Set& gear) {
        if (are_parameters(count, c, n))
            general::differentiate_steady(gear, {points, points + n, points + 2 * n, points + 3 * n}, n,
                                          {parameters, parameters + count}, values, slopes, go_on);
    });
}
/// Kinematic error [rad] over the input angle [rad], then its derivative by the angle.
EXPORT(error) int error(int l, int s, int c, int n) {
    return of_gear(l, s, c, n, 2, [&](const kernel::Set& set) {
        general::with_model<general::GeneralGear>(set, set.numbers, [&](const auto& gear) {
            for (int i = 0; i < n; ++i) {
                const double turns = strainwave::rint(points[i] / (2.0 * pi));
                const auto at = gear.kinematic_error.at(Angle<double>{points[i] - 2.0 * pi * turns, turns});
                values[i] = at.value;
                values[n + i] = at.slope;
            }
        });
    });
}
/// Random kinematic error [rad] over the input angle [rad], at rest and without load.
EXPORT(noise) int noise(int l, int s, int c, int n) {
    return of_gear(l, s, c, n, 1, [&](const kernel::Set& set) {
        general::with_model<general::GeneralGear>(set, set.numbers, [&](const auto& gear) {
            for (int i = 0; i < n; ++i) {
                const double turns = strainwave::rint(points[i] / (2.0 * pi));
                values[i] = gear.kinematic_noise.at(Angle<double>{points[i] - 2.0 * pi * turns, turns}, 0.0, 0.0).value;
            }
        });
    });
}
/// Signed ratio of the input angle to the output angle, whatever the point.
EXPORT(ratio) int ratio(int l, int s, int c, int n) {
    return of_gear(l, s, c, n, 1, [&](const kernel::Set& set) {
        general::with_model<general::GeneralGear>(set, set.numbers, [&](const auto& gear) {
            for (int i = 0; i < n; ++i) values[i] = gear.kinematics.ratio();
        });
    });
}
/// Torque [N.m] of the spring alone over its twist [rad], then its slope [N.m/rad].
EXPORT(spring) int spring(int l, int s, int c, int n) {
    return of_gear(l, s, c, n, 2, [&](const kernel::Set& set) {
        general::with_model<general::GeneralGear>(set, set.numbers, [&](const auto& gear) {
            for (int i = 0; i < n; ++i) {
                values[i] = gear.stiffness.torque(points[i]);
                values[n + i] = gear.stiffness.tangent(points[i]);
            }
        });
    });
}
/// The fastest rate of a drive without twist [rad/s], which steps must follow, at a temperature [K]; then the first instant at
/// which its controller acts, its period and its delay [s].
EXPORT(rates) int rates(int l, int s, int c, double temperature) {
    if (!holds<ParameterDrive>(l, s, c)) return refused;
    if (!(temperature > 0.0 && temperature < 1e4)) return refuse("temperature must lie in (0, 10000) K");
    const kernel::Set drive{laws, shape, numbers, c};
    const auto schedule = general::schedule(drive, general::rest(drive));
    values[0] = general::max_rate(drive, 0.0, temperature);
    values[1] = schedule.first;
    values[2] = schedule.period;
    values[3] = schedule.delay;
    return finite(4);
}
/// A run of a drive from rest through `steps` steps: outputs `recorded` of the start and of the end of each step to `keep`, row
/// after row in `values`, of `samples` each. Code `stopped` if the drive leaves the validity of a part.
EXPORT(run) int run(int l, int s, int c, int steps, int rows, int samples) {
    if (!holds<ParameterDrive>(l, s, c)) return refused;
    if (steps < 1 || steps > max_points || rows < 1 || rows > max_rows || samples < 1 || samples > max_points)
        return refuse("too many steps, rows or samples");
    int kept = 1;
    for (int i = 0; i < steps; ++i) {
        kept += keep[i] != 0;
        if (!(instants[i + 1] > instants[i] && instants[i + 1] - instants[i] < 1.0)) return refuse("instants must rise");
    }
    if (kept != samples) return refuse("as many samples as steps that are kept");
    for (int i = 0; i < 3 * kernel::input_count * steps; ++i)
        if (!(inputs[i] - inputs[i] == 0.0)) return refuse("input " + std::to_string(i) + " is no finite number");
    const kernel::Set drive{laws, shape, numbers, c};
    Array<double, kernel::input_count> at_start;
    for (int i = 0; i < kernel::input_count; ++i) at_start[i] = inputs[i];
    const auto first = shaped<Input<double>>(at_start);
    general::State state = general::begin(drive, general::rest(drive), first);
    const auto outputs = general::observe(drive, state, first);
    for (int r = 0; r < rows; ++r) {
        if (recorded[r] < 0 || recorded[r] >= int(outputs.size())) return refuse("no such output");
        for (int k = 0; k < samples; ++k) values[r * samples + k] = k ? __builtin_nan("") : outputs[std::size_t(recorded[r])];
    }
    const kernel::Rows rest_of_rows{recorded, std::size_t(rows), values + 1, std::size_t(samples)};  // after the first sample
    const kernel::Outcome outcome =
        general::table.simulate(drive, state.data(), {instants, inputs, keep, std::size_t(steps)}, kernel::Method::exponential,
                                rest_of_rows, {[](void*, std::size_t) { return false; }, nullptr});
    if (outcome.ending != kernel::Ending::done) {
        problem = std::string(outcome.part) + " leaves the range in which it is valid";
        return stopped;
    }
    return finite(rows * samples);
}
