#include <nanobind/stl/function.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/vector.h>

#include <new>

#include "state_arrays.hpp"
#include "text.hpp"

namespace strainwave::host {

namespace {

struct Request {
    InputSchedule schedule;
    std::size_t kept = 0;

    Request(const Numbers& instants, const Numbers& inputs, const Flags& keep)
        : schedule{instants.data(), inputs.data(), keep.data(), keep.size()} {
        if (schedule.steps == 0 || instants.size() != schedule.steps + 1 || inputs.size() != 3 * input_count * schedule.steps)
            throw nb::value_error("a schedule of n > 0 steps has n + 1 instants, inputs of shape (n, 3, 6) and n flags");
        for (std::size_t i = 0; i < schedule.steps; ++i) kept += keep.data()[i] != 0;
    }
};

/// Lets Ctrl-C through and tells how many steps are done, now and then.
Pause pausing(const nb::object& progress) {
    return [progress](std::size_t done) {
        nb::gil_scoped_acquire python;
        if (PyErr_CheckSignals() != 0) throw nb::python_error();
        if (!progress.is_none()) progress(done);
    };
}

using Outputs = nb::ndarray<double, nb::ndim<2>, nb::c_contig, nb::device::cpu>;
using Series = nb::ndarray<double, nb::ndim<3>, nb::c_contig, nb::device::cpu>;

/// Where the sample `first` of the outputs goes, and `count` from there on.
double* place_in(const Outputs& out, const std::vector<int>& recorded, std::size_t first, std::size_t count) {
    if (out.shape(0) != recorded.size() || first > out.shape(1) || count > out.shape(1) - first)
        throw nb::value_error("outputs of n samples have shape (recorded, n), and samples are written within");
    for (const int channel : recorded)
        if (channel < 0 || channel >= output_count) throw nb::value_error("a drive has no such channel");
    return out.data() + first;
}

Values run_one(const Drive& drive, const Numbers& start, const Numbers& instants, const Numbers& inputs, const Flags& keep,
               Method method, const std::vector<int>& recorded, const Outputs& out, std::size_t first, const nb::object& progress) {
    const Request request(instants, inputs, keep);
    const Rows rows{recorded, place_in(out, recorded, first, request.kept), out.shape(1)};
    const Pause pause = pausing(progress);
    const auto simulate = kernels().simulate;
    Drive::State state = state_from(drive, start);
    {
        nb::gil_scoped_release free;
        state = simulate(drive, state, request.schedule, method, rows, pause);
    }
    return array_of(drive, state);
}

nb::tuple run_adaptively(const Drive& drive, const Numbers& start, const Signal& command, const Signal& load,
                         const Signal& temperature, const Numbers& ends, double relative, double absolute, long max_steps,
                         const Numbers& samples, const std::vector<int>& recorded, const Outputs& out, std::size_t first,
                         const nb::object& progress) {
    if (ends.size() < 2) throw nb::value_error("steps lead from one instant to another");
    const Rows rows{recorded, place_in(out, recorded, first, samples.size()), out.shape(1)};
    const Pause pause = pausing(progress);
    Drive::State state = state_from(drive, start);
    Steps steps;
    const auto simulate = kernels().simulate_adaptively;
    {
        nb::gil_scoped_release free;
        state = simulate(drive, state, {{&command, &load, &temperature}}, {ends.data(), ends.size()}, {relative, absolute},
                         max_steps, {samples.data(), samples.size()}, rows, steps, pause);
    }
    return nb::make_tuple(array_of(drive, state), steps.accepted, steps.rejected);
}

/// What went wrong, in words.
std::string text_of(const OutOfBounds& error) {
    return std::string(error.part) + ": " + outside(error.domain) + "; first at t = " + with_unit(error.time, "s");
}

std::string text_of(const StepsSpent& error) {
    char text[256];
    std::snprintf(text, sizeof text,
                  "all steps that max_steps allows lead to t = %.6g s only; loosen rtol, give simulate_adaptively more steps, or "
                  "check the parameters: the gear vibrates at %.4g rad/s at rest, a shaft on its bristles at %.4g rad/s",
                  error.at, error.natural_frequency, error.bristle_frequency);
    return text;
}

/// Says that a run cannot begin, where quantities are known at the start or only the motion that the load prescribes.
std::string no_beginning(bool known) {
    if (known)
        return "there is no state that has the quantities of initial: motor, spring and load do not balance there; give another "
               "angle, or the torque";
    return "a run cannot begin with the motion that the load prescribes at t = 0: some number of its state is not finite there; "
           "let "
           "output_angle begin at a smaller angle and speed";
}

/// Quantities known at the start, one row each with a value for each member; at rest, if None.
Start start_from(const nb::object& known, std::size_t members) {
    Start start;
    if (known.is_none()) return start;
    const auto given = nb::cast<std::pair<std::vector<int>, Numbers>>(known);
    if (given.second.size() != given.first.size() * members)
        throw nb::value_error("values of n quantities and m members have shape (n, m)");
    for (const int q : given.first)
        if (q < 0 || q >= initial::quantities) throw nb::value_error("there is no such quantity");
    return {false, given.first, given.second.data(), members};
}

nb::tuple run_many(const Drive& drive, const std::vector<int>& numbers, const Numbers& values, const nb::object& known,
                   const Numbers& instants, const Numbers& inputs, const Flags& keep, const std::vector<int>& recorded,
                   double max_rate, int threads, const Series& out, const nb::object& progress) {
    const Request request(instants, inputs, keep);
    if (values.ndim() != 2 || values.shape(0) != numbers.size())
        throw nb::value_error("values of n numbers and m members have shape (n, m)");
    const Variation variation{numbers, values.data(), values.shape(1)};
    const Start start = start_from(known, variation.members);
    if (out.shape(0) != recorded.size() || out.shape(1) != variation.members || out.shape(2) != request.kept + 1)
        throw nb::value_error("outputs of m members have shape (recorded, m, 1 + kept)");
    const Pause pause = pausing(progress);
    const auto simulate_many = kernels().simulate_many;
    std::vector<MemberResult> results;
    {
        nb::gil_scoped_release free;
        results =
            simulate_many(drive, variation, start, request.schedule, recorded, max_rate, threads, out.data(), request.kept, pause);
    }
    auto sound = array<bool>({variation.members});
    Values twists = array({variation.members}), rates = array({variation.members}), on_bristles = array({variation.members});
    nb::dict refusals;
    for (std::size_t m = 0; m < results.size(); ++m) {
        sound.data()[m] = results[m].sound;
        twists.data()[m] = results[m].twist;
        rates.data()[m] = results[m].max_rate;
        on_bristles.data()[m] = results[m].bristle_frequency;
        if (results[m].refusal) refusals[nb::int_(m)] = text_of(*results[m].refusal);
        if (!results[m].problem.empty()) refusals[nb::int_(m)] = results[m].problem;
        if (!results[m].has_beginning) refusals[nb::int_(m)] = no_beginning(!start.quantities.empty());
    }
    return nb::make_tuple(sound, twists, rates, on_bristles, refusals);
}

nb::tuple run_derivatives(const Drive& drive, const nb::object& known, const Numbers& instants, const Numbers& inputs,
                          const Flags& keep, const std::vector<int>& parameters, const nb::object& progress) {
    const Request request(instants, inputs, keep);
    const auto channels = std::size_t(channels_of(drive));
    Values out = array({channels, request.kept + 1}), slopes = array({parameters.size(), channels, request.kept + 1});
    const Pause pause = pausing(progress);
    const Start start = start_from(known, 1);
    const auto differentiate = kernels().differentiate;
    {
        nb::gil_scoped_release free;
        differentiate(drive, start, request.schedule, parameters, out.data(), slopes.data(), request.kept, pause);
    }
    return nb::make_tuple(out, slopes);
}

}  // namespace

void bind_runs(nb::module_& core) {
    nb::register_exception_translator([](const std::exception_ptr& thrown, void*) {
        try {
            std::rethrow_exception(thrown);
        } catch (const OutOfBounds& error) {
            PyErr_SetString(PyExc_ValueError, text_of(error).c_str());
        } catch (const ToleranceMissed& error) {
            PyErr_SetString(PyExc_FloatingPointError,
                            ("no step is short enough to keep the tolerance between t = " + shortest(error.from) + " s and " +
                             with_unit(error.to, "s") + "; loosen rtol, or check the parameters")
                                .c_str());
        } catch (const StepsSpent& error) {
            PyErr_SetString(PyExc_FloatingPointError, text_of(error).c_str());
        } catch (const std::bad_alloc&) {
            PyErr_SetString(PyExc_MemoryError, "there is not enough memory for this; take fewer samples at a time");
        }
    });
    core.attr("max_lanes") = max_lanes;
    core.attr("largest") = largest;
    nb::enum_<Method>(core, "Method", "How steps are taken.")
        .value("exponential", Method::exponential)
        .value("moreau_jean", Method::moreau_jean)
        .value("rosenbrock", Method::rosenbrock);

#define SW_COURSE "instants: " SW_ARRAY ", inputs: " SW_ARRAY ", keep: numpy.typing.NDArray[numpy.uint8]"
#define SW_OUTPUTS "recorded: collections.abc.Sequence[int], out: " SW_ARRAY ", first: int"
#define SW_PROGRESS ", progress: collections.abc.Callable[[int], None] | None = None"
    core.def("simulate", &run_one, nb::arg("drive"), nb::arg("start"), nb::arg("instants"), nb::arg("inputs"), nb::arg("keep"),
             nb::arg("method"), nb::arg("recorded"), nb::arg("out").noconvert(), nb::arg("first"),
             nb::arg("progress").none() = nb::none(),
             nb::sig("def simulate(drive: Drive, start: " SW_ARRAY ", " SW_COURSE ", method: Method, " SW_OUTPUTS SW_PROGRESS
                     ") -> " SW_ARRAY),
             "The state at the end; the outputs go to `out`, shape (recorded, samples), from sample `first` on.");
    core.def("simulate_adaptively", &run_adaptively, nb::arg("drive"), nb::arg("start"), nb::arg("command"), nb::arg("load"),
             nb::arg("temperature"), nb::arg("ends"), nb::arg("relative"), nb::arg("absolute"), nb::arg("max_steps"),
             nb::arg("samples"), nb::arg("recorded"), nb::arg("out").noconvert(), nb::arg("first"),
             nb::arg("progress").none() = nb::none(),
             nb::sig("def simulate_adaptively(drive: Drive, start: " SW_ARRAY ", command: Signal, "
                     "load: Signal, temperature: Signal, ends: " SW_ARRAY
                     ", relative: float, absolute: float, max_steps: int, samples: " SW_ARRAY ", " SW_OUTPUTS SW_PROGRESS
                     ") -> tuple[" SW_ARRAY ", int, int]"),
             "The state at the end, steps taken and steps given up. Steps end at all of `ends` [s], between which no signal jumps; "
             "the outputs at `samples` [s] go to `out`, shape (recorded, samples), from sample `first` on.");
    core.def(
        "simulate_many", &run_many, nb::arg("drive"), nb::arg("numbers"), nb::arg("values"), nb::arg("initial").none(),
        nb::arg("instants"), nb::arg("inputs"), nb::arg("keep"), nb::arg("recorded"), nb::arg("max_rate"), nb::arg("threads"),
        nb::arg("out").noconvert(), nb::arg("progress").none() = nb::none(),
        nb::sig("def simulate_many(drive: Drive, numbers: collections.abc.Sequence[int], values: " SW_ARRAY
                ", initial: tuple[collections.abc.Sequence[int], " SW_ARRAY "] | None, " SW_COURSE
                ", recorded: collections.abc.Sequence[int], max_rate: float, threads: int, out: " SW_ARRAY SW_PROGRESS
                ") -> tuple[numpy.typing.NDArray[numpy.bool_], " SW_ARRAY ", " SW_ARRAY ", " SW_ARRAY ", dict[int, str]]"),
        "Runs members, whose outputs go to `out`, shape (recorded, members, 1 + kept). Of each: whether it ran and no "
        "output, recorded or not, is beyond `largest`, its largest twist [rad], the fastest that steps had to follow up to "
        "there, and the vibration of a shaft on its bristles [rad/s]; and why members ended early, if any did. `values`, shape "
        "(numbers, members), takes the place of the numbered parameters. Members that are faster by themselves than `max_rate` at "
        "rest are not run. `initial` has quantities known at the start, and their values, shape (quantities, members); all begin "
        "at rest if there is none.");
    core.def("no_beginning", &no_beginning, nb::arg("known"),
             "Says that a run cannot begin, where quantities are known at the start or only the motion that the load prescribes.");
    core.def("instruction_set", &instruction_set, "The instruction set that the loops over time are compiled for.");
    core.def(
        "differentiate", &run_derivatives, nb::arg("drive"), nb::arg("initial").none(), nb::arg("instants"), nb::arg("inputs"),
        nb::arg("keep"), nb::arg("parameters"), nb::arg("progress").none() = nb::none(),
        nb::sig("def differentiate(drive: Drive, initial: tuple[collections.abc.Sequence[int], " SW_ARRAY "] | None, " SW_COURSE
                ", parameters: collections.abc.Sequence[int]" SW_PROGRESS ") -> tuple[" SW_ARRAY ", " SW_ARRAY "]"),
        "Outputs, from rest or with quantities known at the start, shape (channels, 1 + kept), and derivatives, shape (parameters, "
        "channels, 1 + kept).");
}

}  // namespace strainwave::host
