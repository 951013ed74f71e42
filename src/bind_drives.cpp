#include <nanobind/stl/vector.h>

#include "drive_arrays.hpp"
#include "general/friction.hpp"
#include "general/stiffness.hpp"
#include "verbs.hpp"

namespace strainwave::host {

namespace {

Input<double> input_of(const Numbers& u) {
    if (u.size() != std::size_t(kernel::input_count))
        throw nb::value_error("inputs at an instant are command, input of the load and temperature, each with its rate");
    Array<double, kernel::input_count> given;
    std::copy_n(u.data(), kernel::input_count, given.item);
    return shaped<Input<double>>(given);
}

Values now(const ParameterDrive& drive, const Numbers& state, const Numbers& u) {
    const std::vector<double> outputs = general::observe(parts_of(drive).set(), state_from(drive, state), input_of(u));
    Values out = array({outputs.size(), 1});
    std::copy(outputs.begin(), outputs.end(), out.data());
    return out;
}

/// Name, unit and doc of the input that the load of a drive takes.
nb::tuple load_input(const ParameterDrive& drive) {
    const Field field = drive.load.visit([]<class Load>(const Load&) {
        if constexpr (requires { Load::input; })
            return Load::input;
        else
            return load::torque_input;
    });
    return nb::make_tuple(field.name, field.unit, field.doc);
}

/// Inputs over a step of `dt` [s] that run on from those given at its start.
Interval<Input<double>> inputs_of_step(const ParameterDrive& drive, const Call& call, double dt) {
    const auto require = [](bool holds, const char* name, double value, const char* unit, const char* allowed) {
        if (!holds)
            throw nb::value_error((std::string("step.") + name + " = " + with_unit(value, unit) + " must " + allowed).c_str());
    };
    const auto finite = [&](const char* name, const char* unit) {
        const double value = call.real(name);
        require(std::isfinite(value), name, value, unit, "be finite");
        return value;
    };
    const double command = finite("command", "1"), command_rate = finite("command_rate", "1/s");
    const double load_torque = finite("load_torque", "N.m"), brake_torque = finite("brake_torque", "N.m");
    const double angle = finite("output_angle", "rad"), speed = finite("output_speed", "rad/s");
    const double temperature = call.real("temperature");
    require(temperature > 0.0 && std::isfinite(temperature), "temperature", temperature, "K", "lie in (0, inf)");
    require(dt > 0.0 && std::isfinite(dt), "dt", dt, "s", "lie in (0, inf)");
    const bool moved = prescribes(drive.load);
    const std::string taken = nb::cast<std::string>(load_input(drive)[0]);
    const auto refuse = [&](const char* name, double value) {
        if (taken != name && value != 0.0)
            throw nb::value_error((std::string("step.") + name + ": the load of this drive takes " + taken).c_str());
    };
    refuse("load_torque", load_torque);
    refuse("brake_torque", brake_torque);
    if (!moved && (angle != 0.0 || speed != 0.0))
        throw nb::value_error("step.output_angle: only a load that prescribes the motion of the output shaft takes it");
    const double load = moved ? angle : load_torque + brake_torque, rate = moved ? speed : 0.0;
    const auto at = [&](double time) {
        return Input<double>{command + time * command_rate, command_rate, load + time * rate, rate, temperature, 0.0};
    };
    return {at(0.0), at(0.5 * dt), at(dt)};
}

nb::tuple rate_derivatives(const ParameterDrive& drive, const Numbers& numbers, const Numbers& u) {
    const Parts parts = parts_of(drive);
    const Layout& layout = layout_of(drive, parts.laws);
    const std::size_t rates = layout.continuous, outputs = layout.outputs.size();
    Values out = array({rates + outputs}), slopes = array({rates + kernel::input_count, rates + outputs});
    general::differentiate_rates(parts.set(), state_from(layout, numbers), input_of(u), rates, outputs, out.data(), slopes.data());
    return nb::make_tuple(out, slopes);
}

/// Name, unit and part of each number of a state, and how many of them are continuous.
nb::tuple state_of_drive(const ParameterDrive& drive) {
    nb::list list;
    const Layout& layout = layout_of(drive);
    for (const auto& [part, number, element, field] : layout.state) {
        std::string name = part + (part.empty() ? "" : ".") + number;
        if (element >= 0) name += "[" + std::to_string(element) + "]";
        list.append(nb::make_tuple(name, field.unit, part.empty() ? number : part));
    }
    return nb::make_tuple(list, layout.continuous);
}

/// Shape of a state of a drive: for each part with a state, the chosen models and their element counts.
nb::dict shape_of(const ParameterDrive& drive) {
    nb::dict shapes;
    drive.stateful_parts([&](const char* name, const auto& part) {
        part.visit([&]<class Law>(const Law& law) {
            const Parts parts = parts_of(description_of<Law>(), &law);
            std::string text = std::to_string(part.model.index());
            for (const int n : parts.laws) text += " " + std::to_string(n);
            for (const int n : parts.shape) text += " " + std::to_string(n);
            shapes[name] = nb::make_tuple(Law::name, text);
        });
    });
    return shapes;
}

/// Name, unit, doc, part and channel of each number that a drive shows of itself.
nb::list outputs_of(const ParameterDrive& drive) {
    nb::list list;
    int channel = 0;
    for (const auto& [part, name, element, field] : layout_of(drive).outputs)
        list.append(nb::make_tuple(name, field.unit, field.doc, part, channel++));
    return list;
}

/// The unit of the command of a controller: for a law that only passes it on, that of the actuation.
template <class Law>
const char* command_unit(const Law& law, const char* of_motor) {
    if constexpr (requires { law.visit([](const auto&) {}); })
        return law.visit([&](const auto& chosen) { return command_unit(chosen, of_motor); });
    else if constexpr (requires { law.law; })
        return command_unit(law.law, of_motor);
    else
        return *Law::command_unit == 0 ? of_motor : Law::command_unit;
}

/// Name and unit of the output of the motor that is its actuation.
nb::tuple actuation_of(const ParameterDrive& drive) {
    return drive.motor.visit([]<class Motor>(const Motor&) {
        const char* unit = "";
        const typename Motor::Output own{};
        Motor::Output::fields(own, [&](const double&, const Field& field) {
            if (same(field.name, Motor::actuation)) unit = field.unit;
        });
        return nb::make_tuple(Motor::actuation, unit);
    });
}

/// Refuses a point of a path where the spring of a gear is not valid.
void check_spring(const ParameterGear& gear, const double* twist, std::size_t n) {
    const SingleLaw<general::Stiffness<double>> spring(gear.stiffness);
    if (!spring.part.is_bounded()) return;
    for (std::size_t i = 0; i < n; ++i) check_domain("gear.stiffness", domain<double>(spring.part, twist[i]));
}

nb::tuple loop_derivatives(const ParameterGear& gear, const Numbers& twist, const std::vector<int>& parameters) {
    const std::size_t n = twist.size();
    const Parts parts = parts_of(gear);
    check_numbers(parts, parameters);
    check_spring(gear, twist.data(), n);
    Values out = array({n}), slopes = array({parameters.size() + 1, n});
    general::differentiate_loop(parts.set(), twist.data(), n, parameters, out.data(), slopes.data(), &let_interrupt);
    return nb::make_tuple(out, slopes);
}

nb::tuple steady_derivatives(const ParameterGear& gear, const Numbers& speed, const Numbers& angle, const Numbers& load,
                             const Numbers& temperature, const std::vector<int>& parameters) {
    const std::size_t n = speed.size();
    if (angle.size() != n || load.size() != n || temperature.size() != n)
        throw nb::value_error("speed, angle, load and temperature must have equally many elements");
    const Parts parts = parts_of(gear);
    check_numbers(parts, parameters);
    const SingleLaw<general::Friction<double>> friction(gear.friction_input);
    for (std::size_t i = 0; i < n; ++i)
        check_domain("gear.friction_input",
                     domain<double>(friction.part, friction::Contact<double>{.angle = turned(angle.data()[i])}));
    Values out = array({n}), slopes = array({parameters.size(), n});
    general::differentiate_steady(parts.set(), {speed.data(), angle.data(), load.data(), temperature.data()}, n, parameters,
                                  out.data(), slopes.data(), &let_interrupt);
    return nb::make_tuple(out, slopes);
}

/// Description of every number of a set: path, value, unit, doc, min, max.
nb::list parameters_in(nb::handle model) {
    const Description& description = description_of(model);
    nb::list list;
    for (const Parameter& p : parameters_of(description, model_in(model, description)))
        list.append(nb::make_tuple(p.path, p.value, p.field.unit, p.field.doc, p.field.min <= -unbounded ? -HUGE_VAL : p.field.min,
                                   p.field.max >= unbounded ? HUGE_VAL : p.field.max));
    return list;
}

/// The laws that a drive has chosen, its other whole numbers, and its numbers.
nb::tuple parts_in(const ParameterDrive& drive) {
    const Parts parts = parts_of(drive);
    return nb::make_tuple(parts.laws, parts.shape, array_of(parts.numbers));
}

nb::object model_with_numbers(nb::handle model, const std::vector<double>& numbers) {
    const Description& description = description_of(model);
    return with_numbers(model_in(model, description), description, numbers);
}

Values trace_of(const ParameterGear& gear, const Call& call) {
    const auto path = steps_of(call["twist"], "twist", "rad");
    auto [out, torque] = like(path);
    check_spring(gear, path.data(), path.size());
    general::trace(parts_of(gear).set(), path.data(), path.size(), torque, &let_interrupt);
    return out;
}

Values twist_of(const ParameterGear& gear, const Call& call) {
    const auto path = path_of(call["torque"], "torque");
    auto [out, twist] = like(path);
    const std::size_t stuck = general::twist(parts_of(gear).set(), path.data(), path.size(), twist, &let_interrupt);
    if (stuck < path.size()) {
        if (!std::isfinite(twist[stuck]))
            throw nb::value_error(("no twist has the torque " + with_unit(path.data()[stuck], "N.m")).c_str());
        check_spring(gear, twist + stuck, 1);
    }
    return out;
}

}  // namespace

void bind_gear(nb::module_& core) {
    using Gear = ParameterGear;
    const Bound<Gear> gear{bind<Gear>(core, "Gear", "gear"), description_of<Gear>()};
    verb(gear, "save", {{"path", "str | pathlib.Path"}, {"*", ""}, {"name", "str"}, {"source", "str"}}, "None",
         "Write a gear file, as `strainwave.save` does.", [](const Gear& self, const Call& call) {
             nb::module_::import_("strainwave.files.gear_set")
                 .attr("save")(self, call["path"], nb::arg("name") = call["name"], nb::arg("source") = call["source"]);
         });
    verb(gear, "trace", {{"twist", SW_NUMBERS}}, SW_ARRAY,
         "Return the torque [N.m], shape (n,), of spring and hysteresis along a slow path of `twist` [rad], shape (n,), from twist "
         "0 and without history.",
         &trace_of);
    verb(gear, "twist", {{"torque", SW_NUMBERS}}, SW_ARRAY,
         "Return the twist [rad], shape (n,), along a slow path of `torque` [N.m], shape (n,): the inverse of `trace`, to "
         "rounding, for every spring and hysteresis.",
         &twist_of);
}

void bind_drives(nb::module_& core) {
    bind<ParameterSensors>(core, "Sensors", "sensors");
    using Drive = ParameterDrive;
    const Bound<Drive> drive{bind<Drive>(core, "Drive", "drive"), description_of<Drive>()};
    const auto as_state = [](const ParameterDrive& self, const Values& numbers) {
        return nb::module_::import_("strainwave.simulation.state").attr("State").attr("of")(self, numbers);
    };
    verb(drive, "rest", {}, "strainwave.simulation.state.State",
         "Return the state at rest, without twist and history, at input angle 0.",
         [as_state](const ParameterDrive& self, const Call&) {
             return as_state(self, array_of(general::rest(parts_of(self).set())));
         });
    verb(drive, "step",
         {{"state", "strainwave.simulation.state.State"},
          {"*", ""},
          {"command", "float", "0.0"},
          {"command_rate", "float", "0.0"},
          {"load_torque", "float", "0.0"},
          {"brake_torque", "float", "0.0"},
          {"output_angle", "float", "0.0"},
          {"output_speed", "float", "0.0"},
          {"temperature", "float", "293.15"},
          {"dt", "float"}},
         "strainwave.simulation.state.State",
         "Return the state `dt` [s] later. The command changes at `command_rate`; if the load prescribes the motion of the output "
         "shaft, it moves at `output_speed` from `output_angle`. A sampled controller acts within the step. `ValueError` for a "
         "state of another drive, an argument that is not finite, a `dt` or a `temperature` that is not positive, or a part "
         "outside its range of validity; `FloatingPointError` if the step diverges.",
         [as_state](const ParameterDrive& self, const Call& call) {
             const nb::object given =
                 nb::module_::import_("strainwave.simulation.state").attr("start_of")(self, call["state"], "state").attr("numbers");
             general::State state = state_from(self, nb::cast<Numbers>(given));
             const double dt = call.real("dt");
             const Interval<Input<double>> u = inputs_of_step(self, call, dt);
             if (const kernel::Outcome outcome = general::step_once(parts_of(self).set(), state, u, dt);
                 outcome.ending != kernel::Ending::done)
                 throw outcome;
             const Values numbers = array_of(state);
             if (!std::all_of(numbers.data(), numbers.data() + numbers.size(), [](double x) { return std::isfinite(x); })) {
                 PyErr_SetString(PyExc_FloatingPointError, "the step diverged; take a smaller dt or check the parameters");
                 throw nb::python_error();
             }
             return as_state(self, numbers);
         });

    core.def("outputs", &outputs_of, nb::arg("drive"), nb::sig("def outputs(drive: Drive) -> list[tuple[str, str, str, str, int]]"),
             "Name, unit, doc, part and channel of each output of a drive.");
    core.def("load_input", &load_input, nb::arg("drive"), nb::sig("def load_input(drive: Drive) -> tuple[str, str, str]"),
             "Name, unit and doc of the input that the load of a drive takes.");
    core.def("actuation", &actuation_of, nb::arg("drive"), nb::sig("def actuation(drive: Drive) -> tuple[str, str]"),
             "Name and unit of the output of the motor that is its actuation.");
    core.def(
        "command_unit",
        [](const ParameterDrive& drive) { return command_unit(drive.control, nb::cast<const char*>(actuation_of(drive)[1])); },
        nb::arg("drive"), nb::sig("def command_unit(drive: Drive) -> str"), "The unit of the command of a drive.");
    core.def(
        "schedule",
        [](const ParameterDrive& drive, const Numbers& state) {
            const auto found = general::schedule(parts_of(drive).set(), state_from(drive, state));
            return nb::make_tuple(found.first, found.period, found.delay);
        },
        nb::arg("drive"), nb::arg("state"),
        nb::sig("def schedule(drive: Drive, state: " SW_ARRAY ") -> tuple[float, float, float]"),
        "Schedule of a sampled controller: time to its next sample, period and delay [s]. The period is 0 for a continuous "
        "controller.");
    core.def(
        "natural_frequency",
        [](const ParameterDrive& drive, double twist, double temperature) {
            return general::natural_frequency(parts_of(drive).set(), std::abs(twist), temperature);
        },
        nb::arg("drive"), nb::arg("twist"), nb::arg("temperature") = room_temperature,
        nb::sig("def natural_frequency(drive: Drive, twist: float, temperature: float = 293.15) -> float"),
        "Highest angular frequency [rad/s] at which gear and load vibrate, at twists up to `twist` [rad] and the initial "
        "`temperature` [K] of a run.");
    core.def(
        "max_rate",
        [](const ParameterDrive& drive, double twist, double temperature) {
            return general::max_rate(parts_of(drive).set(), std::abs(twist), temperature);
        },
        nb::arg("drive"), nb::arg("twist"), nb::arg("temperature") = room_temperature,
        nb::sig("def max_rate(drive: Drive, twist: float, temperature: float = 293.15) -> float"),
        "Highest rate that fixed steps must resolve, as an angular frequency [rad/s], at twists up to `twist` [rad] and the "
        "initial `temperature` [K] of a run: vibration of gear and load, decay of speeds, sensors and controller.");
    core.def(
        "bristle_frequency", [](const ParameterDrive& drive) { return general::bristle_frequency(parts_of(drive).set()); },
        nb::arg("drive"), nb::sig("def bristle_frequency(drive: Drive) -> float"),
        "Highest angular frequency [rad/s] at which a shaft vibrates on the bristles of its friction.");
    core.def(
        "has_events", [](const ParameterDrive& drive) { return general::has_events(parts_of(drive).set()); }, nb::arg("drive"),
        nb::sig("def has_events(drive: Drive) -> bool"),
        "True if set-valued friction or a brake can hold a shaft of a drive, so that steps are cut at events.");
    core.def("now", &now, nb::arg("drive"), nb::arg("state"), nb::arg("inputs"),
             nb::sig("def now(drive: Drive, state: " SW_ARRAY ", inputs: " SW_ARRAY ") -> " SW_ARRAY),
             "All channels in `state`, shape (channels, 1).");
    core.def(
        "measured",
        [](const ParameterDrive& drive, const Numbers& state, const Numbers& u) {
            return array_of(general::measure(parts_of(drive).set(), state_from(drive, state), input_of(u)));
        },
        nb::arg("drive"), nb::arg("state"), nb::arg("inputs"),
        nb::sig("def measured(drive: Drive, state: " SW_ARRAY ", inputs: " SW_ARRAY ") -> " SW_ARRAY),
        "Readings of the sensors: input angle and speed, output angle and speed, current, torque; then the least and the largest "
        "actuation that the motor can follow.");
    core.def(
        "differentiate_rates", &rate_derivatives, nb::arg("drive"), nb::arg("state"), nb::arg("inputs"),
        nb::sig("def differentiate_rates(drive: Drive, state: " SW_ARRAY ", inputs: " SW_ARRAY ") -> tuple[" SW_ARRAY ", " SW_ARRAY
                "]"),
        "Rates of the n continuous numbers, then outputs, shape (n + channels,), in `state`, and derivatives by those numbers and "
        "the inputs, shape (n + 6, n + channels).");
    core.def("state", &state_of_drive, nb::arg("drive"),
             nb::sig("def state(drive: Drive) -> tuple[list[tuple[str, str, str]], int]"),
             "Name, unit and part of each number of a drive's state, and the count of continuous numbers, which come first.");
    core.def("shape", &shape_of, nb::arg("drive"), nb::sig("def shape(drive: Drive) -> dict[str, tuple[str, str]]"),
             "Name of the model and element counts of each part that has a state: they determine the meaning of each number.");

    nb::list quantities;
    for (const Field& field : initial::fields) quantities.append(nb::make_tuple(field.name, field.unit, field.doc));
    core.attr("quantities") = nb::tuple(quantities);
    core.def(
        "started",
        [](const ParameterDrive& drive, const std::vector<int>& given, const Numbers& values, const Numbers& u) {
            return array_of(general::started(parts_of(drive).set(), start_of(given, values, 1).of(0), input_of(u)));
        },
        nb::arg("drive"), nb::arg("quantities"), nb::arg("values"), nb::arg("inputs"),
        nb::sig("def started(drive: Drive, quantities: collections.abc.Sequence[int], values: " SW_ARRAY ", inputs: " SW_ARRAY
                ") -> " SW_ARRAY),
        "State with the given quantities, and all others in equilibrium. Its transmission error is not finite if there is no such "
        "state.");

    // Functions from one state to another.
    const auto advanced = [&core](const char* name, const char* more, const char* doc, auto f, const auto&... arguments) {
        core.def(name, f, nb::arg("drive"), nb::arg("state"), arguments...,
                 nb::sig(kept(std::string("def ") + name + "(drive: Drive, state: " SW_ARRAY + more + ") -> " SW_ARRAY)), doc);
    };
    advanced(
        "relaxed", ", inputs: " SW_ARRAY ", dt: float", "`state` with the memory of friction after `dt` [s] at constant speeds.",
        [](const ParameterDrive& drive, const Numbers& state, const Numbers& u, double dt) {
            return array_of(general::relaxed(parts_of(drive).set(), state_from(drive, state), input_of(u), dt));
        },
        nb::arg("inputs"), nb::arg("dt"));
    advanced(
        "advance_hysteresis", ", twist: float", "`state` with its hysteresis brought up to date at `twist` [rad].",
        [](const ParameterDrive& drive, const Numbers& numbers, double twist) {
            return array_of(general::advance_hysteresis(parts_of(drive).set(), state_from(drive, numbers), twist));
        },
        nb::arg("twist"));
    advanced("consistent", "", "`state` with the slip direction of each shaft that follows from its speed and its law.",
             [](const ParameterDrive& drive, const Numbers& state) {
                 return array_of(general::consistent(parts_of(drive).set(), state_from(drive, state)));
             });
    advanced(
        "break_away", ", inputs: " SW_ARRAY, "`state` in which each shaft slips that is driven beyond its breakaway torque.",
        [](const ParameterDrive& drive, const Numbers& state, const Numbers& u) {
            return array_of(general::break_away(parts_of(drive).set(), state_from(drive, state), input_of(u)));
        },
        nb::arg("inputs"));
    advanced(
        "begin", ", inputs: " SW_ARRAY, "`state` at the start of a run: consistent, and sampled if its controller samples.",
        [](const ParameterDrive& drive, const Numbers& state, const Numbers& u) {
            return array_of(general::begin(parts_of(drive).set(), state_from(drive, state), input_of(u)));
        },
        nb::arg("inputs"));
    core.def("differentiate_loop", &loop_derivatives, nb::arg("gear"), nb::arg("twist"), nb::arg("parameters"),
             nb::sig("def differentiate_loop(gear: Gear, twist: " SW_ARRAY
                     ", parameters: collections.abc.Sequence[int]) -> tuple[" SW_ARRAY ", " SW_ARRAY "]"),
             "Quasi-static torque [N.m] along a path of twist [rad], virgin at its first point, and derivatives, shape "
             "(parameters + 1, n), the last by a shift of all points but the first.");
    core.def(
        "differentiate_steady", &steady_derivatives, nb::arg("gear"), nb::arg("speed"), nb::arg("angle"), nb::arg("load"),
        nb::arg("temperature"), nb::arg("parameters"),
        nb::sig("def differentiate_steady(gear: Gear, speed: " SW_ARRAY ", angle: " SW_ARRAY ", load: " SW_ARRAY
                ", temperature: " SW_ARRAY ", parameters: collections.abc.Sequence[int]) -> tuple[" SW_ARRAY ", " SW_ARRAY "]"),
        "Steady friction torque [N.m] at the input over speed [rad/s], angle [rad] and load [N.m] of the input and temperature "
        "[K], each of shape (n,), and derivatives, shape (parameters, n).");
    core.def("parameters", &parameters_in, nb::arg("model"),
             nb::sig("def parameters(model: object) -> list[tuple[str, float, str, str, float, float]]"),
             "Every number of a set of parameters: path, value, unit, doc, lower and upper limit.");
    core.def("parts", &parts_in, nb::arg("drive"), nb::sig("def parts(drive: Drive) -> tuple[list[int], list[int], " SW_ARRAY "]"),
             "Indices of the laws of a drive, its other whole numbers (counts, teeth, options), and its real numbers.");
    core.def("with_numbers", &model_with_numbers, nb::arg("model"), nb::arg("numbers"),
             nb::sig("def with_numbers(model: typing.Any, numbers: collections.abc.Sequence[float]) -> typing.Any"),
             "Return the models with other parameter values, in the order of `parameters`.");
}

}  // namespace strainwave::host
