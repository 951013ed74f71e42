#include <nanobind/stl/function.h>
#include <nanobind/stl/vector.h>

#include <new>

#include "instruction_set.hpp"
#include "state.hpp"
#include "verbs.hpp"

namespace strainwave::host {

namespace {

struct Request {
    Course course;
    std::size_t kept = 0;

    Request(const Numbers& instants, const Numbers& inputs, const Flags& keep)
        : course{instants.data(), inputs.data(), keep.data(), keep.size()} {
        if (course.steps == 0 || instants.size() != course.steps + 1 || inputs.size() != 3 * driving * course.steps)
            throw nb::value_error("a course of n > 0 steps has n + 1 instants, inputs of shape (n, 3, 4) and n flags");
        for (std::size_t i = 0; i < course.steps; ++i) kept += keep.data()[i] != 0;
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
double* place_in(const Outputs& out, std::size_t first, std::size_t count) {
    if (out.shape(0) != std::size_t(channels) || first > out.shape(1) || count > out.shape(1) - first)
        throw nb::value_error("outputs of n samples have shape (channels, n), and samples are written within");
    return out.data() + first;
}

/// The state of a drive from its numbers as Python holds them, and back.
Drive::State state_from(const Drive& drive, const Numbers& numbers) {
    std::size_t count = 0;
    const Drive::State state = state_of(drive, [&](int i) {
        ++count;
        return std::size_t(i) < numbers.size() ? numbers.data()[i] : 0.0;
    });
    if (count != numbers.size()) throw nb::value_error("a state has as many numbers as its drive names");
    return state;
}
Values array_of(const Drive& drive, const Drive::State& state) {
    const auto numbers = numbers_of(drive, state);
    Values out = array({numbers.size()});
    std::copy(numbers.begin(), numbers.end(), out.data());
    return out;
}

Values run_one(const Drive& drive, const Numbers& start, const Numbers& instants, const Numbers& inputs, const Flags& keep,
               Method method, const Outputs& out, std::size_t first, const nb::object& progress) {
    const Request request(instants, inputs, keep);
    double* const place = place_in(out, first, request.kept);
    const Pause pause = pausing(progress);
    const auto simulate = kernels().simulate;
    Drive::State state = state_from(drive, start);
    {
        nb::gil_scoped_release free;
        state = simulate(drive, state, request.course, method, place, out.shape(1), pause);
    }
    return array_of(drive, state);
}

nb::tuple run_adaptively(const Drive& drive, const Numbers& start, const Signal& command, const Signal& load_torque,
                         const Signal& temperature, const Numbers& ends, double relative, double absolute, long most_steps,
                         const Numbers& samples, const Outputs& out, std::size_t first, const nb::object& progress) {
    if (ends.size() < 2) throw nb::value_error("steps lead from one instant to another");
    double* const place = place_in(out, first, samples.size());
    const Pause pause = pausing(progress);
    Drive::State state = state_from(drive, start);
    Steps steps;
    const auto simulate = kernels().simulate_adaptively;
    {
        nb::gil_scoped_release free;
        state = simulate(drive, state, {command, load_torque, temperature}, {ends.data(), ends.size()}, {relative, absolute},
                         most_steps, {samples.data(), samples.size()}, place, out.shape(1), steps, pause);
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
                  "all steps that most_steps allows lead to t = %.6g s only; loosen rtol, give simulate_adaptively more steps, or "
                  "check the parameters: the gear vibrates at %.4g rad/s at rest, a shaft on its bristles at %.4g rad/s",
                  error.at, error.vibration, error.bristle_vibration);
    return text;
}

nb::tuple run_many(const Drive& drive, const std::vector<int>& numbers, const Numbers& values, const Numbers& instants,
                   const Numbers& inputs, const Flags& keep, const std::vector<int>& recorded, double fastest, int threads,
                   const Series& out, const nb::object& progress) {
    const Request request(instants, inputs, keep);
    if (values.ndim() != 2 || values.shape(0) != numbers.size())
        throw nb::value_error("values of n numbers and m members have shape (n, m)");
    const Variation variation{numbers, values.data(), values.shape(1)};
    if (out.shape(0) != recorded.size() || out.shape(1) != variation.members || out.shape(2) != request.kept + 1)
        throw nb::value_error("outputs of m members have shape (recorded, m, 1 + kept)");
    const Pause pause = pausing(progress);
    const auto simulate_many = kernels().simulate_many;
    std::vector<Verdict> verdicts;
    {
        nb::gil_scoped_release free;
        verdicts = simulate_many(drive, variation, request.course, recorded, fastest, threads, out.data(), request.kept, pause);
    }
    auto sound = array<bool>({variation.members});
    Values twists = array({variation.members}), rates = array({variation.members}), on_bristles = array({variation.members});
    nb::dict refusals;
    for (std::size_t m = 0; m < verdicts.size(); ++m) {
        sound.data()[m] = verdicts[m].sound;
        twists.data()[m] = verdicts[m].twist;
        rates.data()[m] = verdicts[m].fastest;
        on_bristles.data()[m] = verdicts[m].bristle_vibration;
        if (verdicts[m].refusal) refusals[nb::int_(m)] = text_of(*verdicts[m].refusal);
        if (!verdicts[m].problem.empty()) refusals[nb::int_(m)] = verdicts[m].problem;
    }
    return nb::make_tuple(sound, twists, rates, on_bristles, refusals);
}

nb::tuple run_derivatives(const Drive& drive, const Numbers& instants, const Numbers& inputs, const Flags& keep,
                          const std::vector<int>& parameters, const nb::object& progress) {
    const Request request(instants, inputs, keep);
    Values out = array({std::size_t(channels), request.kept + 1}),
           slopes = array({parameters.size(), std::size_t(channels), request.kept + 1});
    const Pause pause = pausing(progress);
    const auto differentiate = kernels().differentiate;
    {
        nb::gil_scoped_release free;
        differentiate(drive, request.course, parameters, out.data(), slopes.data(), request.kept, pause);
    }
    return nb::make_tuple(out, slopes);
}

Input<double> input_of(const Numbers& u) {
    if (u.size() != 4) throw nb::value_error("inputs at an instant are command, its rate, load torque and temperature");
    return {u.data()[0], u.data()[1], u.data()[2], u.data()[3]};
}

Values now(const Drive& drive, const Numbers& state, const Numbers& u) {
    Values out = array({std::size_t(channels), 1});
    kernels().observe(drive, state_from(drive, state), input_of(u), out.data());
    return out;
}

nb::tuple rate_derivatives(const Drive& drive, const Numbers& numbers, const Numbers& u) {
    const Drive::State state = state_from(drive, numbers);
    const std::size_t count = numbers_of(drive, state.continuous).size();
    Values out = array({count + channels}), slopes = array({count + driving, count + channels});
    kernels().differentiate_rates(drive, state, input_of(u), out.data(), slopes.data());
    return nb::make_tuple(out, slopes);
}

/// Name, unit and part of each number of a state, and how many of them are continuous.
nb::tuple state_of_drive(const Drive& drive) {
    nb::list list;
    Drive::State state = drive.initial_state();
    each_number(drive, state, [&](double, const std::string& part, int element, const Field& field) {
        std::string name = part + (part.empty() ? "" : ".") + field.name;
        if (element >= 0) name += "[" + std::to_string(element) + "]";
        list.append(nb::make_tuple(name, field.unit, part.empty() ? field.name : part));
    });
    return nb::make_tuple(list, numbers_of(drive, state.continuous).size());
}

/// What a state of a drive belongs to: of each part that has a state, the models chosen and their element counts.
nb::dict shape_of(const Drive& drive) {
    nb::dict shapes;
    drive.stateful_parts([&](const char* name, const auto& part) {
        std::string text;
        const auto number = [](const std::string&, double, const Field&) {};
        const auto structure = [&](int n) { text += (text.empty() ? "" : " ") + std::to_string(n); };
        Walk walk{number, structure};
        walk(part, Field{name, "", ""});
        const std::string model = part.visit([](const auto& law) { return std::string(law.name); });
        shapes[name] = nb::make_tuple(model, text);
    });
    return shapes;
}

nb::tuple loop_derivatives(const AnyGear<double>& gear, const Numbers& twist, const std::vector<int>& parameters) {
    const std::size_t n = twist.size();
    for (std::size_t i = 0; i < n; ++i) check_domain("gear.stiffness", domain<double>(gear.stiffness, twist.data()[i]));
    Values out = array({n}), slopes = array({parameters.size() + 1, n});
    kernels().differentiate_loop(gear, twist.data(), n, parameters, out.data(), slopes.data(), pausing(nb::none()));
    return nb::make_tuple(out, slopes);
}

nb::tuple steady_derivatives(const AnyGear<double>& gear, const Numbers& speed, const std::vector<int>& parameters) {
    Values out = array({speed.size()}), slopes = array({parameters.size(), speed.size()});
    kernels().differentiate_steady(gear, speed.data(), speed.size(), parameters, out.data(), slopes.data(), pausing(nb::none()));
    return nb::make_tuple(out, slopes);
}

/// What is known of every number of a set: path, value, unit, doc, min, max.
nb::list parameters_in(nb::handle model) {
    const Description& description = description_of(model);
    nb::list list;
    for (const Parameter& p : description.parameters(model_in(model, description)))
        list.append(nb::make_tuple(p.path, p.value, p.field.unit, p.field.doc, p.field.min <= -unbounded ? -HUGE_VAL : p.field.min,
                                   p.field.max >= unbounded ? HUGE_VAL : p.field.max));
    return list;
}

nb::object with_numbers(nb::handle model, const std::vector<double>& numbers) {
    const Description& description = description_of(model);
    const void* const from = model_in(model, description);
    return description.with_numbers(from, numbers);
}

/// Spring and hysteresis of a gear whose input is held, twisted slowly.
class QuasiStatic {
    const AnyGear<double>& gear;
    decltype(gear.hysteresis)::State held{};
    double at = 0.0;

public:
    explicit QuasiStatic(const AnyGear<double>& gear_) : gear(gear_) {}

    double torque(double twist) const { return gear.stiffness.torque(twist) + gear.hysteresis.torque(held, twist - at); }
    void move(double twist) {
        check_domain("gear.stiffness", domain<double>(gear.stiffness, twist));
        held = gear.hysteresis.advance(held, twist - at);
        at = twist;
    }

    /// The twist at which `wanted` [N.m] is reached without turning back on the way. The torque rises with the twist, so that a
    /// bracket closes.
    double twist(double wanted) const {
        const double away = wanted < torque(at) ? -1.0 : 1.0;
        double low = at, high = at, reach = std::max(std::abs(at), 1e-9) * away;
        while (away * (torque(high) - wanted) < 0.0) {
            low = high;
            high = at + (reach *= 2.0);
            if (!std::isfinite(high)) throw nb::value_error(("no twist gives the torque " + with_unit(wanted, "N.m")).c_str());
        }
        for (std::size_t i = 0; i < 2000 && low != high; ++i) {
            let_interrupt(i);
            const double middle = low + 0.5 * (high - low);
            if (middle == low || middle == high) break;
            (away * (torque(middle) - wanted) < 0.0 ? low : high) = middle;
        }
        return std::abs(torque(low) - wanted) < std::abs(torque(high) - wanted) ? low : high;
    }
};

Values trace_of(const AnyGear<double>& gear, const Call& call) {
    const auto path = steps_of(call["twist"], "twist", "rad");
    auto [out, torque] = like(path);
    QuasiStatic moved(gear);
    for (std::size_t i = 0; i < path.size(); ++i) {
        let_interrupt(i);
        moved.move(path.data()[i]);
        torque[i] = moved.torque(path.data()[i]);
    }
    return out;
}

Values twist_of(const AnyGear<double>& gear, const Call& call) {
    const auto path = path_of(call["torque"], "torque");
    auto [out, twist] = like(path);
    QuasiStatic moved(gear);
    for (std::size_t i = 0; i < path.size(); ++i) moved.move(twist[i] = moved.twist(path.data()[i]));
    return out;
}

}  // namespace

void bind_drives(nb::module_& core) {
    using Gear = AnyGear<double>;
    nb::module_ drives = nb::borrow<nb::module_>(PyImport_AddModule("strainwave.drives"));
    drives.attr("__doc__") = "Drives: motor, control, gear and load.";
    core.attr("drives") = drives;

    const Bound<Gear> gear{bind<Gear>(core, "Gear", "gear"), description_of<Gear>("Gear", "gear")};
    verb(gear, "save", {{"path", "str | pathlib.Path"}, {"*", ""}, {"name", "str"}, {"source", "str"}}, "None",
         "Writes a gear file, as `strainwave.save` does.", [](const Gear& self, const Call& call) {
             nb::module_::import_("strainwave.gear_set")
                 .attr("save")(self, call["path"], nb::arg("name") = call["name"], nb::arg("source") = call["source"]);
         });
    verb(gear, "trace", {{"twist", SW_NUMBERS}}, SW_ARRAY,
         "Torque [N.m], shape (n,), of spring and hysteresis along a slow path of `twist` [rad], shape (n,), from twist 0 and "
         "without history.",
         &trace_of);
    verb(gear, "twist", {{"torque", SW_NUMBERS}}, SW_ARRAY,
         "Twist [rad], shape (n,), along a slow path of `torque` [N.m], shape (n,), as a rig applies it; the inverse of "
         "`trace`, to rounding, for every spring and hysteresis.",
         &twist_of);
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
    const Bound<Drive> drive{bind<Drive>(drives, "PositionDrive", "position_drive"),
                             description_of<Drive>("PositionDrive", "position_drive")};
    const auto as_state = [](const Drive& self, const Values& numbers) {
        return nb::module_::import_("strainwave.state").attr("State").attr("of")(self, numbers);
    };
    verb(drive, "rest", {}, "strainwave.state.State", "The state at rest, untwisted and without history, input angle 0.",
         [as_state](const Drive& self, const Call&) { return as_state(self, array_of(self, kernels().rest(self))); });
    verb(drive, "step",
         {{"state", "strainwave.state.State"},
          {"*", ""},
          {"command", "float", "0.0"},
          {"command_rate", "float", "0.0"},
          {"load_torque", "float", "0.0"},
          {"temperature", "float", "293.15"},
          {"dt", "float"}},
         "strainwave.state.State",
         "The state `dt` [s] later, the command moving at `command_rate`. `ValueError` for a state of another drive, for what is "
         "not "
         "finite, for a `dt` or a `temperature` that is not positive, and where a part is not valid; `FloatingPointError` if the "
         "step diverges.",
         [as_state](const Drive& self, const Call& call) {
             const nb::object given =
                 nb::module_::import_("strainwave.state").attr("start_of")(self, call["state"], "state").attr("numbers");
             const Drive::State state = state_from(self, nb::cast<Numbers>(given));
             const double command = call.real("command"), command_rate = call.real("command_rate"),
                          load_torque = call.real("load_torque"), temperature = call.real("temperature"), dt = call.real("dt");
             const auto require = [](bool holds, const char* name, double value, const char* unit, const char* allowed) {
                 if (!holds)
                     throw nb::value_error(
                         (std::string("step.") + name + " = " + with_unit(value, unit) + " must " + allowed).c_str());
             };
             require(std::isfinite(command), "command", command, "1", "be finite");
             require(std::isfinite(command_rate), "command_rate", command_rate, "1/s", "be finite");
             require(std::isfinite(load_torque), "load_torque", load_torque, "N.m", "be finite");
             require(temperature > 0.0 && std::isfinite(temperature), "temperature", temperature, "K", "lie in (0, inf)");
             require(dt > 0.0 && std::isfinite(dt), "dt", dt, "s", "lie in (0, inf)");
             const auto at = [&](double share) {
                 return Input<double>{command + share * dt * command_rate, command_rate, load_torque, temperature};
             };
             const Interval<Input<double>> u{at(0.0), at(0.5), at(1.0)};
             const Values numbers = array_of(self, kernels().step_once(self, state, u, dt));
             if (!std::all_of(numbers.data(), numbers.data() + numbers.size(), [](double x) { return std::isfinite(x); })) {
                 PyErr_SetString(PyExc_FloatingPointError, "the step diverged; take a smaller dt or check the parameters");
                 throw nb::python_error();
             }
             return as_state(self, numbers);
         });

    nb::list outputs;
    const Output<double> output{};
    Output<double>::fields(
        output, [&](const double&, const Field& field) { outputs.append(nb::make_tuple(field.name, field.unit, field.doc)); });
    core.attr("max_lanes") = max_lanes;
    core.attr("largest") = largest;
    core.attr("outputs") = nb::tuple(outputs);
    nb::enum_<Method>(core, "Method", "How steps are taken.")
        .value("exponential", Method::exponential)
        .value("moreau_jean", Method::moreau_jean)
        .value("rosenbrock", Method::rosenbrock);

#define SW_COURSE "instants: " SW_ARRAY ", inputs: " SW_ARRAY ", keep: numpy.typing.NDArray[numpy.uint8]"
#define SW_OUTPUTS "out: " SW_ARRAY ", first: int"
#define SW_PROGRESS ", progress: collections.abc.Callable[[int], None] | None = None"
    core.def("simulate", &run_one, nb::arg("drive"), nb::arg("start"), nb::arg("instants"), nb::arg("inputs"), nb::arg("keep"),
             nb::arg("method"), nb::arg("out").noconvert(), nb::arg("first"), nb::arg("progress").none() = nb::none(),
             nb::sig("def simulate(drive: strainwave.drives.PositionDrive, start: " SW_ARRAY ", " SW_COURSE
                     ", method: Method, " SW_OUTPUTS SW_PROGRESS ") -> " SW_ARRAY),
             "The state at the end; the outputs go to `out`, shape (channels, samples), from sample `first` on.");
    core.def("simulate_adaptively", &run_adaptively, nb::arg("drive"), nb::arg("start"), nb::arg("command"), nb::arg("load_torque"),
             nb::arg("temperature"), nb::arg("ends"), nb::arg("relative"), nb::arg("absolute"), nb::arg("most_steps"),
             nb::arg("samples"), nb::arg("out").noconvert(), nb::arg("first"), nb::arg("progress").none() = nb::none(),
             nb::sig("def simulate_adaptively(drive: strainwave.drives.PositionDrive, start: " SW_ARRAY ", command: Signal, "
                     "load_torque: Signal, temperature: Signal, ends: " SW_ARRAY
                     ", relative: float, absolute: float, most_steps: int, samples: " SW_ARRAY ", " SW_OUTPUTS SW_PROGRESS
                     ") -> tuple[" SW_ARRAY ", int, int]"),
             "The state at the end, steps taken and steps given up. Steps end at all of `ends` [s], between which no signal jumps; "
             "the outputs at `samples` [s] go to `out`, shape (channels, samples), from sample `first` on.");
    core.def(
        "simulate_many", &run_many, nb::arg("drive"), nb::arg("numbers"), nb::arg("values"), nb::arg("instants"), nb::arg("inputs"),
        nb::arg("keep"), nb::arg("recorded"), nb::arg("fastest"), nb::arg("threads"), nb::arg("out").noconvert(),
        nb::arg("progress").none() = nb::none(),
        nb::sig(
            "def simulate_many(drive: strainwave.drives.PositionDrive, numbers: collections.abc.Sequence[int], values: " SW_ARRAY
            ", " SW_COURSE ", recorded: collections.abc.Sequence[int], fastest: float, threads: int, out: " SW_ARRAY SW_PROGRESS
            ") -> tuple[numpy.typing.NDArray[numpy.bool_], " SW_ARRAY ", " SW_ARRAY ", " SW_ARRAY ", dict[int, str]]"),
        "Runs members from rest, whose outputs go to `out`, shape (recorded, members, 1 + kept). Of each: whether it ran and no "
        "output, recorded or not, is beyond `largest`, its largest twist [rad], the fastest that steps had to follow up to "
        "there, and the vibration of a shaft on its bristles [rad/s]; and why members ended early, if any did. `values`, shape "
        "(numbers, members), takes the place of the numbered parameters. Members that are faster by themselves than `fastest` at "
        "rest are not run.");
    core.def(
        "vibration", [](const Drive& drive, double twist) { return kernels().vibration(drive, std::abs(twist)); }, nb::arg("drive"),
        nb::arg("twist"), nb::sig("def vibration(drive: strainwave.drives.PositionDrive, twist: float) -> float"),
        "The fastest angular frequency [rad/s] of the gear's vibration at twists up to `twist` [rad].");
    core.def(
        "fastest", [](const Drive& drive, double twist) { return kernels().fastest(drive, std::abs(twist)); }, nb::arg("drive"),
        nb::arg("twist"), nb::sig("def fastest(drive: strainwave.drives.PositionDrive, twist: float) -> float"),
        "The fastest that fixed steps must follow at twists up to `twist` [rad], as an angular frequency [rad/s]: the gear's "
        "vibration, or the decay of speeds.");
    core.def(
        "bristle_vibration", [](const Drive& drive) { return kernels().bristle_vibration(drive); }, nb::arg("drive"),
        nb::sig("def bristle_vibration(drive: strainwave.drives.PositionDrive) -> float"),
        "The fastest angular frequency [rad/s] at which a shaft vibrates on the bristles that hold it.");
    core.def("instruction_set", &instruction_set, "The instruction set that the loops over time are compiled for.");
    core.def("differentiate", &run_derivatives, nb::arg("drive"), nb::arg("instants"), nb::arg("inputs"), nb::arg("keep"),
             nb::arg("parameters"), nb::arg("progress").none() = nb::none(),
             nb::sig("def differentiate(drive: strainwave.drives.PositionDrive, " SW_COURSE
                     ", parameters: collections.abc.Sequence[int]" SW_PROGRESS ") -> tuple[" SW_ARRAY ", " SW_ARRAY "]"),
             "Outputs from rest, shape (channels, 1 + kept), and derivatives, shape (parameters, channels, 1 + kept).");
    core.def("now", &now, nb::arg("drive"), nb::arg("state"), nb::arg("inputs"),
             nb::sig("def now(drive: strainwave.drives.PositionDrive, state: " SW_ARRAY ", inputs: " SW_ARRAY ") -> " SW_ARRAY),
             "Outputs in `state`, shape (channels, 1).");
    core.def(
        "differentiate_rates", &rate_derivatives, nb::arg("drive"), nb::arg("state"), nb::arg("inputs"),
        nb::sig("def differentiate_rates(drive: strainwave.drives.PositionDrive, state: " SW_ARRAY ", inputs: " SW_ARRAY
                ") -> tuple[" SW_ARRAY ", " SW_ARRAY "]"),
        "Rates of the n continuous numbers, then outputs, shape (n + channels,), in `state`, and derivatives by those numbers and "
        "the inputs, shape (n + 4, n + channels).");
    core.def("state", &state_of_drive, nb::arg("drive"),
             nb::sig("def state(drive: strainwave.drives.PositionDrive) -> tuple[list[tuple[str, str, str]], int]"),
             "Name, unit and part of each number of a drive's state, and how many of them are continuous; those come first.");
    core.def("shape", &shape_of, nb::arg("drive"),
             nb::sig("def shape(drive: strainwave.drives.PositionDrive) -> dict[str, tuple[str, str]]"),
             "Of each part that has a state, the name of its model and the counts that say which number means what.");

    // Functions from one state to another.
    const auto advanced = [&core](const char* name, const char* more, const char* doc, auto f, const auto&... arguments) {
        core.def(name, f, nb::arg("drive"), nb::arg("state"), arguments...,
                 nb::sig(kept(std::string("def ") + name + "(drive: strainwave.drives.PositionDrive, state: " SW_ARRAY + more +
                              ") -> " SW_ARRAY)),
                 doc);
    };
    advanced(
        "aged", ", inputs: " SW_ARRAY ", dt: float", "`state` with what friction remembers after `dt` [s] at constant speeds.",
        [](const Drive& drive, const Numbers& state, const Numbers& u, double dt) {
            return array_of(drive, kernels().aged(drive, state_from(drive, state), input_of(u), dt));
        },
        nb::arg("inputs"), nb::arg("dt"));
    advanced(
        "advance_hysteresis", ", twist: float", "`state` with its hysteresis brought up to date at `twist` [rad].",
        [](const Drive& drive, const Numbers& numbers, double twist) {
            return array_of(drive, kernels().advance_hysteresis(drive, state_from(drive, numbers), twist));
        },
        nb::arg("twist"));
    advanced("consistent", "", "`state` with the slip direction of each shaft as its speed and its law have it.",
             [](const Drive& drive, const Numbers& state) {
                 return array_of(drive, kernels().consistent(drive, state_from(drive, state)));
             });
    advanced(
        "break_away", ", inputs: " SW_ARRAY, "`state` with those shafts slipping that stick and are driven beyond what holds them.",
        [](const Drive& drive, const Numbers& state, const Numbers& u) {
            return array_of(drive, kernels().break_away(drive, state_from(drive, state), input_of(u)));
        },
        nb::arg("inputs"));
    core.def("differentiate_loop", &loop_derivatives, nb::arg("gear"), nb::arg("twist"), nb::arg("parameters"),
             nb::sig("def differentiate_loop(gear: Gear, twist: " SW_ARRAY
                     ", parameters: collections.abc.Sequence[int]) -> tuple[" SW_ARRAY ", " SW_ARRAY "]"),
             "Quasi-static torque [N.m] along a path of twist [rad], virgin at its first point, and derivatives, shape "
             "(parameters + 1, n), the last by a shift of all points but the first.");
    core.def("differentiate_steady", &steady_derivatives, nb::arg("gear"), nb::arg("speed"), nb::arg("parameters"),
             nb::sig("def differentiate_steady(gear: Gear, speed: " SW_ARRAY
                     ", parameters: collections.abc.Sequence[int]) -> tuple[" SW_ARRAY ", " SW_ARRAY "]"),
             "Steady friction torque [N.m] at the input over speed [rad/s], and derivatives, shape (parameters, n).");
    core.def("parameters", &parameters_in, nb::arg("model"),
             nb::sig("def parameters(model: object) -> list[tuple[str, float, str, str, float, float]]"),
             "Every number of a set of parameters: path, value, unit, doc, lower and upper limit.");
    core.def("with_numbers", &with_numbers, nb::arg("model"), nb::arg("numbers"),
             nb::sig("def with_numbers(model: typing.Any, numbers: collections.abc.Sequence[float]) -> typing.Any"),
             "The same models with other numbers, in the order of `parameters`.");
}

}  // namespace strainwave::host
