#include <nanobind/stl/function.h>

#include <new>

#include "instruction_set.hpp"
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

Drive::State run_one(const Drive& drive, const Drive::State& start, const Numbers& instants, const Numbers& inputs,
                     const Flags& keep, Method method, const Outputs& out, std::size_t first, const nb::object& progress) {
    const Request request(instants, inputs, keep);
    double* const place = place_in(out, first, request.kept);
    const Pause pause = pausing(progress);
    const auto simulate = kernels().simulate;
    nb::gil_scoped_release free;
    return simulate(drive, start, request.course, method, place, out.shape(1), pause);
}

nb::tuple run_adaptively(const Drive& drive, const Drive::State& start, const Signal& command, const Signal& load_torque,
                         const Signal& temperature, const Numbers& ends, double relative, double absolute, long most_steps,
                         const Numbers& samples, const Outputs& out, std::size_t first, const nb::object& progress) {
    if (ends.size() < 2) throw nb::value_error("steps lead from one instant to another");
    double* const place = place_in(out, first, samples.size());
    const Pause pause = pausing(progress);
    Drive::State end;
    Steps steps;
    const auto simulate = kernels().simulate_adaptively;
    {
        nb::gil_scoped_release free;
        end = simulate(drive, start, {command, load_torque, temperature}, {ends.data(), ends.size()}, {relative, absolute},
                       most_steps, {samples.data(), samples.size()}, place, out.shape(1), steps, pause);
    }
    return nb::make_tuple(end, steps.accepted, steps.rejected);
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

double vibration(const Drive& drive, double twist) { return drive.vibration(std::abs(twist)); }

double fastest_of(const Drive& drive, double twist) { return drive.fastest(std::abs(twist)); }

double bristle_vibration(const Drive& drive) { return drive.bristle_vibration(); }

Input<double> input_of(const Numbers& u) {
    if (u.size() != 4) throw nb::value_error("inputs at an instant are command, its rate, load torque and temperature");
    return {u.data()[0], u.data()[1], u.data()[2], u.data()[3]};
}

Values now(const Drive& drive, const Drive::State& x, const Numbers& u) {
    Values out = array({std::size_t(channels), 1});
    kernels().observe(drive, x, input_of(u), out.data());
    return out;
}

nb::tuple flow_derivatives(const Drive& drive, const Drive::State& x, const Numbers& u) {
    Values out = array({std::size_t(motions + channels)}),
           slopes = array({std::size_t(motions + driving), std::size_t(motions + channels)});
    kernels().differentiate_flow(drive, x, input_of(u), out.data(), slopes.data());
    return nb::make_tuple(out, slopes);
}

/// Appends number, name and unit of each number of a state, or of the state of the model chosen.
struct Naming {
    nb::list& list;
    std::string prefix;
    int number;

    template <class T>
    void operator()(const T& member, const Field& field) {
        if constexpr (is_array<T>)
            for (int i = 0; i < member.size(); ++i) append(std::string(field.name) + "[" + std::to_string(i) + "]", field);
        else
            append(field.name, field);
    }
    template <class Law>
    void chosen(const Law& law) {
        if constexpr (is_choice<Law>) {
            law.visit([&](const auto& model) { chosen(model); });
        } else if constexpr (friction::Modulation<Law>) {
            chosen(law.law);
        } else if constexpr (requires { typename Law::State; }) {
            const typename Law::State state{};
            Law::State::fields(state, *this);
        }
    }

private:
    void append(const std::string& name, const Field& field) { list.append(nb::make_tuple(number++, prefix + name, field.unit)); }
};

/// What flows in a drive with the models chosen.
nb::list motion_of(const Drive& drive) {
    nb::list list;
    int number = 0;
    const Drive::Continuous motion{};
    Drive::Continuous::fields(motion, [&]<class T>(const T& member, const Field& field) {
        if constexpr (is_slots<T>) {
            Naming naming{list, std::string(field.name) + ".", number};
            const std::string part = field.name;
            if (part == "motor") naming.chosen(drive.motor);
            if (part == "control") naming.chosen(drive.control);
            if (part == "friction_input") naming.chosen(drive.gear.friction_input);
            if (part == "friction_mesh") naming.chosen(drive.gear.friction_mesh);
            if (part == "friction_output") naming.chosen(drive.gear.friction_output);
            number += member.slot.size();
        } else {
            Naming{list, "", number++}(member, field);
        }
    });
    return list;
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
template <class M>
void bind_numbers(nb::module_& core) {
    const std::string type = python_type<M>(false);
    core.def(
        "parameters",
        [](const M& model) {
            nb::list list;
            for (const Parameter& p : parameters_of(model))
                list.append(nb::make_tuple(p.path, p.value, p.field.unit, p.field.doc,
                                           p.field.min <= -unbounded ? -HUGE_VAL : p.field.min,
                                           p.field.max >= unbounded ? HUGE_VAL : p.field.max));
            return list;
        },
        nb::arg("model"), nb::sig(kept("def parameters(model: " + type + ") -> list[tuple[str, float, str, str, float, float]]")),
        "Every number of a set of parameters: path, value, unit, doc, lower and upper limit.");
    core.def(
        "with_numbers",
        [](const M& model, const std::vector<double>& numbers) {
            const Parts parts = parts_of(model);
            if (numbers.size() != parts.numbers.size())
                throw nb::value_error("as many numbers as the model has parameters are needed");
            const M other = assembled<M, double>(parts.shape, [&](int i) { return numbers[i]; });
            const std::string problem = problem_of(other);
            if (!problem.empty()) throw nb::value_error(problem.c_str());
            return other;
        },
        nb::arg("model"), nb::arg("numbers"),
        nb::sig(kept("def with_numbers(model: " + type + ", numbers: collections.abc.Sequence[float]) -> " + type)),
        "The same models with other numbers, in the order of `parameters`.");
}

template <template <class...> class... Law>
void bind_numbers_of(nb::module_& core, List<Law...>) {
    (bind_numbers<AtRunTime<Law, double>>(core), ...);
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

    auto gear = bind<Gear>(core, "Gear", "gear");
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
    auto drive = bind<Drive>(drives, "PositionDrive", "position_drive");
    bind<Drive::Continuous>(core, "ContinuousState", "continuous");
    bind<Drive::State>(core, "State", "state");
    verb(drive, "rest", {}, python_type<Drive::State>(false), "The state at rest, untwisted and without history, input angle 0.",
         [](const Drive& self, const Call&) { return self.rest(); });
    verb(drive, "step",
         {{"state", kept(python_type<Drive::State>(false))},
          {"*", ""},
          {"command", "float", "0.0"},
          {"command_rate", "float", "0.0"},
          {"load_torque", "float", "0.0"},
          {"temperature", "float", "293.15"},
          {"dt", "float"}},
         python_type<Drive::State>(false),
         "The state `dt` [s] later, the command moving at `command_rate`. `ValueError` for what is not finite, for a `dt` or a "
         "`temperature` that is not positive, and where a part is not valid; `FloatingPointError` if the step diverges.",
         [](const Drive& self, const Call& call) {
             const auto state = call.part<Drive::State>("state");
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
             const auto before = self.evaluate(self.consistent(state), u.start);
             check_bounds<double>(self, before, 0.0);
             const auto after = step<double>(self, before, u, dt, called_step<double, Drive>);
             check_bounds<double>(self, after, dt);
             bool finite = true;
             const auto numbers = flattened<double>(after.state);
             for (int i = 0; i < numbers.size(); ++i) finite = finite && std::isfinite(numbers[i]);
             if (!finite) {
                 PyErr_SetString(PyExc_FloatingPointError, "the step diverged; take a smaller dt or check the parameters");
                 throw nb::python_error();
             }
             return after.state;
         });

    nb::list outputs;
    const Output<double> output{};
    Output<double>::fields(
        output, [&](const double&, const Field& field) { outputs.append(nb::make_tuple(field.name, field.unit, field.doc)); });
    core.attr("lanes") = lanes;
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
             nb::sig("def simulate(drive: strainwave.drives.PositionDrive, start: State, " SW_COURSE
                     ", method: Method, " SW_OUTPUTS SW_PROGRESS ") -> State"),
             "The state at the end; the outputs go to `out`, shape (channels, samples), from sample `first` on.");
    core.def("simulate_adaptively", &run_adaptively, nb::arg("drive"), nb::arg("start"), nb::arg("command"), nb::arg("load_torque"),
             nb::arg("temperature"), nb::arg("ends"), nb::arg("relative"), nb::arg("absolute"), nb::arg("most_steps"),
             nb::arg("samples"), nb::arg("out").noconvert(), nb::arg("first"), nb::arg("progress").none() = nb::none(),
             nb::sig("def simulate_adaptively(drive: strainwave.drives.PositionDrive, start: State, command: Signal, "
                     "load_torque: Signal, temperature: Signal, ends: " SW_ARRAY
                     ", relative: float, absolute: float, most_steps: int, samples: " SW_ARRAY ", " SW_OUTPUTS SW_PROGRESS
                     ") -> tuple[State, int, int]"),
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
    core.def("vibration", &vibration, nb::arg("drive"), nb::arg("twist"),
             nb::sig("def vibration(drive: strainwave.drives.PositionDrive, twist: float) -> float"),
             "The fastest angular frequency [rad/s] of the gear's vibration at twists up to `twist` [rad].");
    core.def("fastest", &fastest_of, nb::arg("drive"), nb::arg("twist"),
             nb::sig("def fastest(drive: strainwave.drives.PositionDrive, twist: float) -> float"),
             "The fastest that fixed steps must follow at twists up to `twist` [rad], as an angular frequency [rad/s]: the gear's "
             "vibration, or the decay of speeds.");
    core.def("bristle_vibration", &bristle_vibration, nb::arg("drive"),
             nb::sig("def bristle_vibration(drive: strainwave.drives.PositionDrive) -> float"),
             "The fastest angular frequency [rad/s] at which a shaft vibrates on the bristles that hold it.");
    core.def("instruction_set", &instruction_set, "The instruction set that the loops over time are compiled for.");
    core.def("differentiate", &run_derivatives, nb::arg("drive"), nb::arg("instants"), nb::arg("inputs"), nb::arg("keep"),
             nb::arg("parameters"), nb::arg("progress").none() = nb::none(),
             nb::sig("def differentiate(drive: strainwave.drives.PositionDrive, " SW_COURSE
                     ", parameters: collections.abc.Sequence[int]" SW_PROGRESS ") -> tuple[" SW_ARRAY ", " SW_ARRAY "]"),
             "Outputs from rest, shape (channels, 1 + kept), and derivatives, shape (parameters, channels, 1 + kept).");
    core.def("now", &now, nb::arg("drive"), nb::arg("state"), nb::arg("inputs"),
             nb::sig("def now(drive: strainwave.drives.PositionDrive, state: State, inputs: " SW_ARRAY ") -> " SW_ARRAY),
             "Outputs in `state`, shape (channels, 1).");
    core.def(
        "differentiate_flow", &flow_derivatives, nb::arg("drive"), nb::arg("state"), nb::arg("inputs"),
        nb::sig("def differentiate_flow(drive: strainwave.drives.PositionDrive, state: State, inputs: " SW_ARRAY
                ") -> tuple[" SW_ARRAY ", " SW_ARRAY "]"),
        "Rates of the n numbers of the motion, then outputs, shape (n + channels,), in `state`, and derivatives by the motion and "
        "the inputs, shape (n + 4, n + channels).");
    core.def("motion", &motion_of, nb::arg("drive"),
             nb::sig("def motion(drive: strainwave.drives.PositionDrive) -> list[tuple[int, str, str]]"),
             "Place, name and unit of the numbers of the motion that the models of a drive have.");
    core.def(
        "aged",
        [](const Drive& drive, const Drive::State& state, const Numbers& u, double dt) {
            return drive.aged(state, input_of(u), dt);
        },
        nb::arg("drive"), nb::arg("state"), nb::arg("inputs"), nb::arg("dt"),
        nb::sig("def aged(drive: strainwave.drives.PositionDrive, state: State, inputs: " SW_ARRAY ", dt: float) -> State"),
        "`state` with what friction remembers after `dt` [s] at constant speeds.");
    core.def(
        "advance_hysteresis",
        [](const Drive& drive, Drive::State state, double twist) {
            drive.advance_hysteresis(state, twist);
            return state;
        },
        nb::arg("drive"), nb::arg("state"), nb::arg("twist"),
        nb::sig("def advance_hysteresis(drive: strainwave.drives.PositionDrive, state: State, twist: float) -> State"),
        "`state` with its hysteresis brought up to date at `twist` [rad].");
    core.def(
        "consistent", [](const Drive& drive, const Drive::State& state) { return drive.consistent(state); }, nb::arg("drive"),
        nb::arg("state"), nb::sig("def consistent(drive: strainwave.drives.PositionDrive, state: State) -> State"),
        "`state` with the slip direction of each shaft as its speed and its law have it.");
    core.def(
        "break_away",
        [](const Drive& drive, const Drive::State& state, const Numbers& u) {
            return system::break_away(drive, drive.evaluate(state, input_of(u)), input_of(u)).state;
        },
        nb::arg("drive"), nb::arg("state"), nb::arg("inputs"),
        nb::sig("def break_away(drive: strainwave.drives.PositionDrive, state: State, inputs: " SW_ARRAY ") -> State"),
        "`state` with those shafts slipping that stick and are driven beyond what their friction holds.");
    core.def("differentiate_loop", &loop_derivatives, nb::arg("gear"), nb::arg("twist"), nb::arg("parameters"),
             nb::sig("def differentiate_loop(gear: Gear, twist: " SW_ARRAY
                     ", parameters: collections.abc.Sequence[int]) -> tuple[" SW_ARRAY ", " SW_ARRAY "]"),
             "Quasi-static torque [N.m] along a path of twist [rad], virgin at its first point, and derivatives, shape "
             "(parameters + 1, n), the last by a shift of all points but the first.");
    core.def("differentiate_steady", &steady_derivatives, nb::arg("gear"), nb::arg("speed"), nb::arg("parameters"),
             nb::sig("def differentiate_steady(gear: Gear, speed: " SW_ARRAY
                     ", parameters: collections.abc.Sequence[int]) -> tuple[" SW_ARRAY ", " SW_ARRAY "]"),
             "Steady friction torque [N.m] at the input over speed [rad/s], and derivatives, shape (parameters, n).");
    bind_numbers<Gear>(core);
    bind_numbers<Drive>(core);
    bind_numbers_of(core, friction::Models{});
    bind_numbers_of(core, stiffness::Models{});
    bind_numbers_of(core, hysteresis::Models{});
    bind_numbers_of(core, kinematic_error::Models{});
    bind_numbers_of(core, kinematic_error::Noises{});
}

}  // namespace strainwave::host
