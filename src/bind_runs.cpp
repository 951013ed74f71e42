#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/vector.h>

#include <chrono>
#include <functional>
#include <new>
#include <numeric>

#include "drive_arrays.hpp"
#include "ensemble.hpp"
#include "instruction_set.hpp"
#include "kernels.hpp"
#include "signal.hpp"
#include "text.hpp"

namespace strainwave::host {

namespace {

struct Request {
    kernel::Schedule schedule;
    std::size_t kept = 0;

    Request(const Numbers& instants, const Numbers& inputs, const Flags& keep)
        : schedule{instants.data(), inputs.data(), keep.data(), keep.size()} {
        if (schedule.steps == 0 || instants.size() != schedule.steps + 1 ||
            inputs.size() != 3 * kernel::input_count * schedule.steps)
            throw nb::value_error("a schedule of n > 0 steps has n + 1 instants, inputs of shape (n, 3, 6) and n flags");
        for (std::size_t i = 0; i < schedule.steps; ++i) kept += keep.data()[i] != 0;
    }
};

/// Lets Ctrl-C through and reports how many steps are done, some twenty times a second.
class Pausing {
    using Clock = std::chrono::steady_clock;
    const nb::object& report;
    Clock::time_point due{};

public:
    explicit Pausing(const nb::object& report_) : report(report_) {}

    kernel::Progress progress() {
        return {[](void* self, std::size_t done) { return static_cast<Pausing*>(self)->stops(done); }, this};
    }
    void operator()(std::size_t done) const {
        nb::gil_scoped_acquire python;
        if (PyErr_CheckSignals() != 0) throw nb::python_error();
        if (!report.is_none()) report(done);
    }
    /// Throws the error of Python if that ended the work, or an error if the drive did.
    void check(const kernel::Outcome& outcome) const {
        if (failure) std::rethrow_exception(failure);
        if (outcome.ending != kernel::Ending::done) throw outcome;
    }

private:
    std::exception_ptr failure;

    bool stops(std::size_t done) {
        const auto now = Clock::now();
        if (now < due) return false;
        due = now + std::chrono::milliseconds(50);
        try {
            (*this)(done);
        } catch (...) {
            failure = std::current_exception();
        }
        return bool(failure);
    }
};

using Outputs = nb::ndarray<double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using Series = nb::ndarray<double, nb::ndim<3>, nb::c_contig, nb::device::cpu>;

void check_recorded(const ParameterDrive& drive, const std::vector<int>& recorded) {
    const int count = int(layout_of(drive).outputs.size());
    for (const int channel : recorded)
        if (channel < 0 || channel >= count) throw nb::value_error("the drive has no channel of this index");
}
/// Rows for the outputs recorded, from sample `first` on, `count` of them.
kernel::Rows rows_in(const ParameterDrive& drive, const Outputs& out, const std::vector<int>& recorded, std::size_t first,
                     std::size_t count) {
    if (out.shape(0) != recorded.size() || first > out.shape(1) || count > out.shape(1) - first)
        throw nb::value_error("outputs of n samples have shape (recorded, n), and samples are written within");
    check_recorded(drive, recorded);
    return {recorded.data(), recorded.size(), out.data() + first, out.shape(1)};
}

Values run_one(const ParameterDrive& drive, const Numbers& start, const Numbers& instants, const Numbers& inputs, const Flags& keep,
               kernel::Method method, const std::vector<int>& recorded, const Outputs& out, std::size_t first,
               const nb::object& progress) {
    const Request request(instants, inputs, keep);
    const kernel::Rows rows = rows_in(drive, out, recorded, first, request.kept);
    const Parts parts = parts_of(drive);
    const auto simulate = kernel_with(&kernel::Table::simulate, parts.laws).simulate;
    general::State state = state_from(drive, start);
    Pausing pausing(progress);
    pausing.check([&] {
        nb::gil_scoped_release free;
        return simulate(parts.set(), state.data(), request.schedule, method, rows, pausing.progress());
    }());
    return array_of(state);
}

/// Signals as a kernel asks for them: the piece that holds is looked up once a stretch without a jump.
struct SignalSource {
    const Signals signals;
    std::optional<Unbroken> here;
    double begin = 0.0;

    static void at(const void* self, double begin, double fraction, double dt, double* inputs) {
        SignalSource& source = *const_cast<SignalSource*>(static_cast<const SignalSource*>(self));
        if (!source.here || source.begin != begin) {
            source.here.emplace(source.signals, begin);
            source.begin = begin;
        }
        source.here->at(fraction, dt, inputs);
    }
};

nb::tuple run_adaptively(const ParameterDrive& drive, const Numbers& start, const Signal& command, const Signal& load,
                         const Signal& temperature, const Numbers& ends, double relative, double absolute, long max_steps,
                         const Numbers& samples, const std::vector<int>& recorded, const Outputs& out, std::size_t first,
                         const nb::object& progress) {
    if (ends.size() < 2) throw nb::value_error("steps lead from one instant to another");
    const kernel::Rows rows = rows_in(drive, out, recorded, first, samples.size());
    const Parts parts = parts_of(drive);
    const auto simulate = kernel_with(&kernel::Table::simulate_adaptively, parts.laws).simulate_adaptively;
    SignalSource source{{{&command, &load, &temperature}}, {}};
    const kernel::AdaptiveCourse course{
        {&SignalSource::at, &source}, ends.data(), ends.size(), {relative, absolute}, max_steps, samples.data(), samples.size()};
    general::State state = state_from(drive, start);
    Pausing pausing(progress);
    const kernel::Outcome outcome = [&] {
        nb::gil_scoped_release free;
        return simulate(parts.set(), state.data(), course, rows, pausing.progress());
    }();
    pausing.check(outcome);
    return nb::make_tuple(array_of(state), outcome.accepted, outcome.rejected);
}

/// Error message of an outcome.
std::string text_of(const kernel::Outcome& outcome) {
    using kernel::Ending;
    if (outcome.ending == Ending::out_of_bounds)
        return std::string(outcome.part) + ": " + outside(outcome.domain) + "; first at t = " + with_unit(outcome.from, "s");
    if (outcome.ending == Ending::tolerance_missed)
        return "the tolerance is not reached with the shortest step between t = " + shortest(outcome.from) + " s and " +
               with_unit(outcome.to, "s") + "; increase rtol, or check the parameters";
    char text[320];
    std::snprintf(
        text, sizeof text,
        "the largest count of steps, max_steps, was reached at t = %.6g s; increase rtol or max_steps of simulate_adaptively, or "
        "check the parameters: the gear vibrates at %.4g rad/s at rest, a shaft on its bristles at %.4g rad/s",
        outcome.from, outcome.natural_frequency, outcome.bristle_frequency);
    return text;
}

/// Error message of a run that cannot begin, from the quantities known at the start or the motion that the load prescribes.
std::string no_beginning(bool known) {
    if (known)
        return "no state has the quantities of initial: motor, spring and load are not in equilibrium there; give another angle, "
               "or the torque";
    return "a run cannot begin with the motion that the load prescribes at t = 0: a number of its state is not finite there; let "
           "output_angle begin at a smaller angle and speed";
}

/// Quantities known at the start, and their values, if any are; the arguments of a call, which outlive its run.
using Known = std::optional<std::pair<std::vector<int>, Numbers>>;

Start start_from(const Known& known, std::size_t members) {
    return known ? start_of(known->first, known->second, members) : Start{};
}

/// Index of the transmission error among the numbers of a state.
std::size_t place_of_error(const Layout& layout) {
    const auto named = [](const Name& each) { return each.name == "transmission_error"; };
    return std::size_t(std::find_if(layout.state.begin(), layout.state.end(), named) - layout.state.begin());
}

nb::tuple run_many(const ParameterDrive& drive, const std::vector<int>& numbers, const Numbers& values, const Known& known,
                   const Numbers& instants, const Numbers& inputs, const Flags& keep, const std::vector<int>& recorded,
                   double max_rate, int threads, const Series& out, const nb::object& progress) {
    const Request request(instants, inputs, keep);
    if (values.ndim() != 2 || values.shape(0) != numbers.size())
        throw nb::value_error("values of n numbers and m members have shape (n, m)");
    const Parts parts = parts_of(drive);
    check_numbers(parts, numbers);
    check_recorded(drive, recorded);
    const Start start = start_from(known, values.shape(1));
    const Members members{drive, description_of<ParameterDrive>(), {numbers.data(), numbers.size(), values.data(), values.shape(1)},
                          start, request.schedule.inputs,          place_of_error(layout_of(drive, parts.laws))};
    const std::size_t count = values.shape(1);
    if (out.shape(0) != recorded.size() || out.shape(1) != count || out.shape(2) != request.kept + 1)
        throw nb::value_error("outputs of m members have shape (recorded, m, 1 + kept)");
    const Ensemble ensemble{members, request.schedule, recorded, max_rate, out.data(), request.kept + 1};
    const kernel::Table kernel = kernel_with(&kernel::Table::run_members, parts.laws);
    const Pausing pausing(progress);
    const std::vector<MemberResult> results = [&] {
        nb::gil_scoped_release free;
        return run_ensemble(kernel, ensemble, threads, std::cref(pausing));
    }();
    auto sound = array<bool>({count});
    Values twists = array({count}), rates = array({count}), on_bristles = array({count});
    nb::dict refusals;
    for (std::size_t m = 0; m < results.size(); ++m) {
        const MemberResult& result = results[m];
        sound.data()[m] = result.tally.sound;
        twists.data()[m] = result.tally.twist;
        rates.data()[m] = result.tally.max_rate;
        on_bristles.data()[m] = result.tally.bristle_frequency;
        if (result.refusal) refusals[nb::int_(m)] = text_of(*result.refusal);
        if (!result.problem.empty()) refusals[nb::int_(m)] = result.problem;
        if (!result.has_beginning) refusals[nb::int_(m)] = no_beginning(!start.quantities.empty());
    }
    return nb::make_tuple(sound, twists, rates, on_bristles, refusals);
}

nb::tuple starts_of_members(const ParameterDrive& drive, const std::vector<int>& numbers, const Numbers& values, const Known& known,
                            const Numbers& inputs, int threads) {
    if (values.ndim() != 2 || values.shape(0) != numbers.size())
        throw nb::value_error("values of n numbers and m members have shape (n, m)");
    if (inputs.size() < std::size_t(kernel::input_count)) throw nb::value_error("the first inputs are 6 numbers");
    const Parts parts = parts_of(drive);
    check_numbers(parts, numbers);
    const std::size_t count = values.shape(1), size = general::rest(parts.set()).size();
    const Start start = start_from(known, count);
    const Members members{drive,
                          description_of<ParameterDrive>(),
                          {numbers.data(), numbers.size(), values.data(), count},
                          start,
                          inputs.data(),
                          place_of_error(layout_of(drive, parts.laws))};
    const std::vector<MemberStart> starts = [&] {
        nb::gil_scoped_release free;
        return starts_of(members, threads);
    }();
    Values sets = array({count, parts.numbers.size()}), states = array({count, size});
    std::fill_n(states.data(), count * size, std::numeric_limits<double>::quiet_NaN());
    nb::dict refusals;
    for (std::size_t m = 0; m < count; ++m) {
        const MemberStart& found = starts[m];
        std::copy(found.numbers.begin(), found.numbers.end(), sets.data() + m * parts.numbers.size());
        std::copy(found.state.begin(), found.state.end(), states.data() + m * size);
        if (!found.problem.empty()) refusals[nb::int_(m)] = found.problem;
        if (found.problem.empty() && found.state.empty()) refusals[nb::int_(m)] = no_beginning(!start.quantities.empty());
    }
    return nb::make_tuple(sets, states, refusals);
}

nb::tuple run_derivatives(const ParameterDrive& drive, const Known& known, const Numbers& instants, const Numbers& inputs,
                          const Flags& keep, const std::vector<int>& parameters, const nb::object& progress) {
    const Request request(instants, inputs, keep);
    const Parts parts = parts_of(drive);
    check_numbers(parts, parameters);
    std::vector<int> all(layout_of(drive, parts.laws).outputs.size());
    std::iota(all.begin(), all.end(), 0);
    Values out = array({all.size(), request.kept + 1}), slopes = array({parameters.size(), all.size(), request.kept + 1});
    const kernel::Rows rows{all.data(), all.size(), out.data(), request.kept + 1};
    const Start start = start_from(known, 1);
    const auto differentiate = kernel_with(&kernel::Table::differentiate, parts.laws).differentiate;
    Pausing pausing(progress);
    pausing.check([&] {
        nb::gil_scoped_release free;
        return differentiate(parts.set(), {start.at_rest, start.of(0)}, request.schedule, parameters.data(), parameters.size(),
                             rows, slopes.data(), pausing.progress());
    }());
    return nb::make_tuple(out, slopes);
}

nb::tuple needed_torque(const ParameterDrive& drive, const Numbers& motion, const Numbers& inputs,
                        const std::vector<int>& parameters) {
    if (motion.ndim() != 2 || motion.shape(1) != 4 || inputs.ndim() != 2 || inputs.shape(0) != motion.shape(0) ||
        inputs.shape(1) != std::size_t(kernel::input_count))
        throw nb::value_error("n motions have shape (n, 4), and inputs of shape (n, 6)");
    const Parts parts = parts_of(drive);
    check_numbers(parts, parameters);
    const std::size_t n = motion.shape(0);
    Values torque = array({n}), slopes = array({parameters.size(), n});
    const auto inverse_dynamics = kernel_with(&kernel::Table::inverse_dynamics, parts.laws).inverse_dynamics;
    {
        nb::gil_scoped_release free;
        inverse_dynamics(parts.set(), motion.data(), inputs.data(), n, parameters.data(), parameters.size(), torque.data(),
                         slopes.data());
    }
    return nb::make_tuple(torque, slopes);
}

/// Adds a kernel that is loaded, its table at an address, for drives as one.
void add_kernel_at(const ParameterDrive& drive, std::size_t address) {
    add_kernel(parts_of(drive).laws, *reinterpret_cast<const kernel::Table*>(address));
}

/// Names of the jobs that a kernel is loaded for.
nb::list loaded_jobs(const ParameterDrive& drive) {
    const kernel::Table table = loaded_kernel(parts_of(drive).laws);
    nb::list jobs;
    const auto add = [&](bool can, const char* name) {
        if (can) jobs.append(name);
    };
    add(table.simulate, "simulate");
    add(table.simulate_adaptively, "simulate_adaptively");
    add(table.run_members, "simulate_many");
    add(table.differentiate, "differentiate");
    add(table.inverse_dynamics, "inverse_dynamics");
    return jobs;
}

}  // namespace

void bind_runs(nb::module_& core) {
    nb::register_exception_translator([](const std::exception_ptr& thrown, void*) {
        try {
            std::rethrow_exception(thrown);
        } catch (const kernel::Outcome& outcome) {
            const bool refused = outcome.ending == kernel::Ending::out_of_bounds;
            PyErr_SetString(refused ? PyExc_ValueError : PyExc_FloatingPointError, text_of(outcome).c_str());
        } catch (const std::bad_alloc&) {
            PyErr_SetString(PyExc_MemoryError, "there is not enough memory; use fewer samples at a time");
        }
    });
    core.attr("max_lanes") = kernel::max_lanes;
    core.attr("slopes") = kernel::slopes;
    core.attr("largest") = kernel::largest;
    nb::enum_<kernel::Method>(core, "Method", "Method of the steps.")
        .value("exponential", kernel::Method::exponential)
        .value("moreau_jean", kernel::Method::moreau_jean)
        .value("rosenbrock", kernel::Method::rosenbrock);

#define SW_COURSE "instants: " SW_ARRAY ", inputs: " SW_ARRAY ", keep: numpy.typing.NDArray[numpy.uint8]"
#define SW_OUTPUTS "recorded: collections.abc.Sequence[int], out: " SW_ARRAY ", first: int"
#define SW_PROGRESS ", progress: collections.abc.Callable[[int], None] | None = None"
    core.def("simulate", &run_one, nb::arg("drive"), nb::arg("start"), nb::arg("instants"), nb::arg("inputs"), nb::arg("keep"),
             nb::arg("method"), nb::arg("recorded"), nb::arg("out").noconvert(), nb::arg("first"),
             nb::arg("progress").none() = nb::none(),
             nb::sig("def simulate(drive: Drive, start: " SW_ARRAY ", " SW_COURSE ", method: Method, " SW_OUTPUTS SW_PROGRESS
                     ") -> " SW_ARRAY),
             "The state at the end; the outputs go to `out`, shape (recorded, samples), from sample `first` on.");
    core.def(
        "simulate_adaptively", &run_adaptively, nb::arg("drive"), nb::arg("start"), nb::arg("command"), nb::arg("load"),
        nb::arg("temperature"), nb::arg("ends"), nb::arg("relative"), nb::arg("absolute"), nb::arg("max_steps"), nb::arg("samples"),
        nb::arg("recorded"), nb::arg("out").noconvert(), nb::arg("first"), nb::arg("progress").none() = nb::none(),
        nb::sig("def simulate_adaptively(drive: Drive, start: " SW_ARRAY ", command: Signal, "
                "load: Signal, temperature: Signal, ends: " SW_ARRAY
                ", relative: float, absolute: float, max_steps: int, samples: " SW_ARRAY ", " SW_OUTPUTS SW_PROGRESS
                ") -> tuple[" SW_ARRAY ", int, int]"),
        "State at the end, counts of accepted and rejected steps. Steps end at all of `ends` [s], between which no signal jumps; "
        "the outputs at `samples` [s] go to `out`, shape (recorded, samples), from sample `first` on.");
    core.def("simulate_many", &run_many, nb::arg("drive"), nb::arg("numbers"), nb::arg("values"), nb::arg("initial").none(),
             nb::arg("instants"), nb::arg("inputs"), nb::arg("keep"), nb::arg("recorded"), nb::arg("max_rate"), nb::arg("threads"),
             nb::arg("out").noconvert(), nb::arg("progress").none() = nb::none(),
             nb::sig("def simulate_many(drive: Drive, numbers: collections.abc.Sequence[int], values: " SW_ARRAY
                     ", initial: tuple[collections.abc.Sequence[int], " SW_ARRAY "] | None, " SW_COURSE
                     ", recorded: collections.abc.Sequence[int], max_rate: float, threads: int, out: " SW_ARRAY SW_PROGRESS
                     ") -> tuple[numpy.typing.NDArray[numpy.bool_], " SW_ARRAY ", " SW_ARRAY ", " SW_ARRAY ", dict[int, str]]"),
             "Run members; their outputs go to `out`, shape (recorded, members, 1 + kept). Return for each member: True if it ran "
             "and no output, recorded or not, is beyond `largest`; its largest twist [rad]; the highest rate up to there that "
             "steps had to resolve, and the vibration of a shaft on its bristles [rad/s]; and the messages of members that ended "
             "early. `values`, shape (numbers, members), replaces the numbered parameters. Members with a higher rate than "
             "`max_rate` at rest are not run. `initial` has quantities known at the start, and their values, shape (quantities, "
             "members); without it all begin at rest.");
    core.def("member_starts", &starts_of_members, nb::arg("drive"), nb::arg("numbers"), nb::arg("values"),
             nb::arg("initial").none(), nb::arg("inputs"), nb::arg("threads"),
             nb::sig("def member_starts(drive: Drive, numbers: collections.abc.Sequence[int], values: " SW_ARRAY
                     ", initial: tuple[collections.abc.Sequence[int], " SW_ARRAY "] | None, inputs: " SW_ARRAY
                     ", threads: int) -> tuple[" SW_ARRAY ", " SW_ARRAY ", dict[int, str]]"),
             "Parameters and initial state of each member, not-a-number if it cannot begin, and the messages of these members; the "
             "arguments are those of `simulate_many`.");
    core.def(
        "no_beginning", &no_beginning, nb::arg("known"),
        "Error message of a run that cannot begin, from the quantities known at the start or the motion that the load prescribes.");
    core.def("instruction_set", &instruction_set, "The instruction set that kernels are compiled for.");
    core.def(
        "inverse_dynamics", &needed_torque, nb::arg("drive"), nb::arg("motion"), nb::arg("inputs"), nb::arg("parameters"),
        nb::sig("def inverse_dynamics(drive: Drive, motion: " SW_ARRAY ", inputs: " SW_ARRAY
                ", parameters: collections.abc.Sequence[int]) -> tuple[" SW_ARRAY ", " SW_ARRAY "]"),
        "Torque [N.m] that the motor must give for each motion of the input, shape (n,), and derivatives, shape (parameters, n). "
        "A motion is angle [rad], speed [rad/s], acceleration [rad/s2] and the time since the motion before [s], 0 if friction has "
        "been sliding for long; the gear is rigid, and the inputs are `inputs`, shape (n, 6).");
    core.def("instruction_sets", &instruction_sets, nb::sig("def instruction_sets() -> list[str]"),
             "Instruction sets of this machine that kernels can be compiled for, the widest first.");
    core.def("add_kernel", &add_kernel_at, nb::arg("drive"), nb::arg("address"),
             nb::sig("def add_kernel(drive: Drive, address: int) -> None"),
             "Use a loaded kernel, by the address of its table, for all drives with the laws of this drive.");
    core.def(
        "forget_kernels", [](const ParameterDrive& drive) { forget_kernels(parts_of(drive).laws); }, nb::arg("drive"),
        nb::sig("def forget_kernels(drive: Drive) -> None"),
        "Use the general drive again for all drives with the laws of this drive.");
    core.def("loaded_jobs", &loaded_jobs, nb::arg("drive"), nb::sig("def loaded_jobs(drive: Drive) -> list[str]"),
             "Names of the jobs that have a loaded kernel, for drives with the laws of this drive.");
    core.def(
        "differentiate", &run_derivatives, nb::arg("drive"), nb::arg("initial").none(), nb::arg("instants"), nb::arg("inputs"),
        nb::arg("keep"), nb::arg("parameters"), nb::arg("progress").none() = nb::none(),
        nb::sig("def differentiate(drive: Drive, initial: tuple[collections.abc.Sequence[int], " SW_ARRAY "] | None, " SW_COURSE
                ", parameters: collections.abc.Sequence[int]" SW_PROGRESS ") -> tuple[" SW_ARRAY ", " SW_ARRAY "]"),
        "Outputs, from rest or with quantities known at the start, shape (channels, 1 + kept), and derivatives, shape (parameters, "
        "channels, 1 + kept).");
}

}  // namespace strainwave::host
