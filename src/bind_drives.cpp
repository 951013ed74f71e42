#include <nanobind/stl/vector.h>

#include <strainwave/quasi_static.hpp>

#include "state_arrays.hpp"
#include "verbs.hpp"

namespace strainwave::host {

namespace {

Input<double> input_of(const Numbers& u) {
    if (u.size() != std::size_t(input_count))
        throw nb::value_error("inputs at an instant are command, input of the load and temperature, each with its rate");
    Array<double, input_count> given;
    std::copy_n(u.data(), input_count, given.item);
    return shaped<Input<double>>(given);
}

Values now(const Drive& drive, const Numbers& state, const Numbers& u) {
    Values out = array({std::size_t(output_count), 1});
    kernels().observe(drive, state_from(drive, state), input_of(u), out.data());
    return out;
}

/// Name, unit and doc of the input that the load of a drive takes.
nb::tuple load_input(const Drive& drive) {
    const Field field = drive.load.visit([]<class Load>(const Load&) {
        if constexpr (requires { Load::input; })
            return Load::input;
        else
            return load::torque_input;
    });
    return nb::make_tuple(field.name, field.unit, field.doc);
}

/// Inputs over a step of `dt` [s] that run on from those given at its start.
Interval<Input<double>> inputs_of_step(const Drive& drive, const Call& call, double dt) {
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

nb::tuple rate_derivatives(const Drive& drive, const Numbers& numbers, const Numbers& u) {
    const Drive::State state = state_from(drive, numbers);
    const std::size_t count = numbers_of(drive, state.continuous).size();
    Values out = array({count + output_count}), slopes = array({count + input_count, count + output_count});
    kernels().differentiate_rates(drive, state, input_of(u), out.data(), slopes.data());
    return nb::make_tuple(out, slopes);
}

/// Name, unit and part of each number of a state, and how many of them are continuous.
nb::tuple state_of_drive(const Drive& drive) {
    nb::list list;
    Drive::State state = drive.initial_state();
    each_number(drive, state, [&](double, const std::string& part, const std::string& number, int element, const Field& field) {
        std::string name = part + (part.empty() ? "" : ".") + number;
        if (element >= 0) name += "[" + std::to_string(element) + "]";
        list.append(nb::make_tuple(name, field.unit, part.empty() ? number : part));
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

/// Name, unit, doc, part and channel of each number that a drive shows of itself.
nb::list outputs_of(const Drive& drive) {
    nb::list list;
    each_output(drive, [&](const std::string& name, const Field& field, const std::string& part, int channel) {
        list.append(nb::make_tuple(name, field.unit, field.doc, part, channel));
    });
    return list;
}

/// The unit of what a controller is given: of a law that only passes it on, that of what the motor takes.
template <class Law>
const char* command_unit(const Law& law, const char* of_motor) {
    if constexpr (requires { law.visit([](const auto&) {}); })
        return law.visit([&](const auto& chosen) { return command_unit(chosen, of_motor); });
    else if constexpr (requires { law.law; })
        return command_unit(law.law, of_motor);
    else
        return *Law::command_unit == 0 ? of_motor : Law::command_unit;
}

/// The output of the motor of a drive that is what the controller gives it, and its unit.
nb::tuple actuation_of(const Drive& drive) {
    return drive.motor.visit([]<class Motor>(const Motor&) {
        const char* unit = "";
        const typename Motor::Output own{};
        Motor::Output::fields(own, [&](const double&, const Field& field) {
            if (same(field.name, Motor::actuation)) unit = field.unit;
        });
        return nb::make_tuple(Motor::actuation, unit);
    });
}

nb::tuple loop_derivatives(const AnyGear<double>& gear, const Numbers& twist, const std::vector<int>& parameters) {
    const std::size_t n = twist.size();
    for (std::size_t i = 0; i < n; ++i) check_domain("gear.stiffness", domain<double>(gear.stiffness, twist.data()[i]));
    Values out = array({n}), slopes = array({parameters.size() + 1, n});
    kernels().differentiate_loop(gear, twist.data(), n, parameters, out.data(), slopes.data(),
                                 [](std::size_t) { let_interrupt(0); });
    return nb::make_tuple(out, slopes);
}

nb::tuple steady_derivatives(const AnyGear<double>& gear, const Numbers& speed, const Numbers& angle, const Numbers& load,
                             const Numbers& temperature, const std::vector<int>& parameters) {
    const std::size_t n = speed.size();
    if (angle.size() != n || load.size() != n || temperature.size() != n)
        throw nb::value_error("speed, angle, load and temperature must have equally many elements");
    for (std::size_t i = 0; i < n; ++i)
        check_domain("gear.friction_input",
                     domain<double>(gear.friction_input, friction::Contact<double>{.angle = turned(angle.data()[i])}));
    Values out = array({n}), slopes = array({parameters.size(), n});
    kernels().differentiate_steady(gear, {speed.data(), angle.data(), load.data(), temperature.data()}, n, parameters, out.data(),
                                   slopes.data(), [](std::size_t) { let_interrupt(0); });
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

Values trace_of(const AnyGear<double>& gear, const Call& call) {
    const auto path = steps_of(call["twist"], "twist", "rad");
    auto [out, torque] = like(path);
    QuasiStatic<double, AnyGear<double>> moved(gear, room_temperature);
    for (std::size_t i = 0; i < path.size(); ++i) {
        let_interrupt(i);
        check_domain("gear.stiffness", domain<double>(gear.stiffness, path.data()[i]));
        moved.move(path.data()[i]);
        torque[i] = moved.torque(path.data()[i]);
    }
    return out;
}

Values twist_of(const AnyGear<double>& gear, const Call& call) {
    const auto path = path_of(call["torque"], "torque");
    auto [out, twist] = like(path);
    QuasiStatic<double, AnyGear<double>> moved(gear, room_temperature);
    for (std::size_t i = 0; i < path.size(); ++i) {
        let_interrupt(i);
        twist[i] = moved.twist(path.data()[i]);
        if (!std::isfinite(twist[i]))
            throw nb::value_error(("no twist gives the torque " + with_unit(path.data()[i], "N.m")).c_str());
        check_domain("gear.stiffness", domain<double>(gear.stiffness, twist[i]));
        moved.move(twist[i]);
    }
    return out;
}

}  // namespace

void bind_drives(nb::module_& core) {
    using Gear = AnyGear<double>;
    const Bound<Gear> gear{bind<Gear>(core, "Gear", "gear"), description_of<Gear>("Gear", "gear")};
    verb(gear, "save", {{"path", "str | pathlib.Path"}, {"*", ""}, {"name", "str"}, {"source", "str"}}, "None",
         "Writes a gear file, as `strainwave.save` does.", [](const Gear& self, const Call& call) {
             nb::module_::import_("strainwave.files.gear_set")
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
    bind<AnySensors<double>>(core, "Sensors", "sensors");
    const Bound<Drive> drive{bind<Drive>(core, "Drive", "drive"), description_of<Drive>("Drive", "drive")};
    const auto as_state = [](const Drive& self, const Values& numbers) {
        return nb::module_::import_("strainwave.simulation.state").attr("State").attr("of")(self, numbers);
    };
    verb(drive, "rest", {}, "strainwave.simulation.state.State", "The state at rest, untwisted and without history, input angle 0.",
         [as_state](const Drive& self, const Call&) { return as_state(self, array_of(self, kernels().rest(self))); });
    verb(
        drive, "step",
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
        "The state `dt` [s] later, the command moving at `command_rate`; where the load prescribes the motion of the output shaft, "
        "that at `output_speed` from `output_angle`. A sampled controller acts within the step. `ValueError` for a state of "
        "another drive, for what is not finite, for a `dt` or a `temperature` that is not positive, and where a part is not valid; "
        "`FloatingPointError` if the step diverges.",
        [as_state](const Drive& self, const Call& call) {
            const nb::object given =
                nb::module_::import_("strainwave.simulation.state").attr("start_of")(self, call["state"], "state").attr("numbers");
            const Drive::State state = state_from(self, nb::cast<Numbers>(given));
            const double dt = call.real("dt");
            const Interval<Input<double>> u = inputs_of_step(self, call, dt);
            const Values numbers = array_of(self, kernels().step_once(self, state, u, dt));
            if (!std::all_of(numbers.data(), numbers.data() + numbers.size(), [](double x) { return std::isfinite(x); })) {
                PyErr_SetString(PyExc_FloatingPointError, "the step diverged; take a smaller dt or check the parameters");
                throw nb::python_error();
            }
            return as_state(self, numbers);
        });

    core.attr("output_count") = output_count;
    core.def("outputs", &outputs_of, nb::arg("drive"), nb::sig("def outputs(drive: Drive) -> list[tuple[str, str, str, str, int]]"),
             "Name, unit, doc, part and channel of each number that a drive shows of itself.");
    core.def("load_input", &load_input, nb::arg("drive"), nb::sig("def load_input(drive: Drive) -> tuple[str, str, str]"),
             "Name, unit and doc of the input that the load of a drive takes.");
    core.def("actuation", &actuation_of, nb::arg("drive"), nb::sig("def actuation(drive: Drive) -> tuple[str, str]"),
             "The output of a drive's motor that is what the controller gives it, and its unit.");
    core.def(
        "command_unit",
        [](const Drive& drive) { return command_unit(drive.control, nb::cast<const char*>(actuation_of(drive)[1])); },
        nb::arg("drive"), nb::sig("def command_unit(drive: Drive) -> str"), "The unit of the command of a drive.");
    core.def(
        "schedule",
        [](const Drive& drive, const Numbers& state) {
            const auto found = kernels().schedule(drive, state_from(drive, state));
            return nb::make_tuple(found.first, found.period, found.delay);
        },
        nb::arg("drive"), nb::arg("state"),
        nb::sig("def schedule(drive: Drive, state: " SW_ARRAY ") -> tuple[float, float, float]"),
        "When a sampled controller acts: time to its next sample, period and delay [s]. A period of 0: it acts all the time.");
    core.def(
        "natural_frequency",
        [](const Drive& drive, double twist, double temperature) {
            return kernels().natural_frequency(drive, std::abs(twist), temperature);
        },
        nb::arg("drive"), nb::arg("twist"), nb::arg("temperature") = room_temperature,
        nb::sig("def natural_frequency(drive: Drive, twist: float, temperature: float = 293.15) -> float"),
        "The fastest angular frequency [rad/s] at which gear and load vibrate at twists up to `twist` [rad], where a run of this "
        "`temperature` [K] begins.");
    core.def(
        "max_rate",
        [](const Drive& drive, double twist, double temperature) {
            return kernels().max_rate(drive, std::abs(twist), temperature);
        },
        nb::arg("drive"), nb::arg("twist"), nb::arg("temperature") = room_temperature,
        nb::sig("def max_rate(drive: Drive, twist: float, temperature: float = 293.15) -> float"),
        "The fastest that fixed steps must follow at twists up to `twist` [rad], as an angular frequency [rad/s], where a run of "
        "this `temperature` [K] begins: the vibration of gear and load, the decay of speeds, sensors and controller.");
    core.def(
        "bristle_frequency", [](const Drive& drive) { return kernels().bristle_frequency(drive); }, nb::arg("drive"),
        nb::sig("def bristle_frequency(drive: Drive) -> float"),
        "The fastest angular frequency [rad/s] at which a shaft vibrates on the bristles that hold it.");
    core.def("now", &now, nb::arg("drive"), nb::arg("state"), nb::arg("inputs"),
             nb::sig("def now(drive: Drive, state: " SW_ARRAY ", inputs: " SW_ARRAY ") -> " SW_ARRAY),
             "All channels in `state`, shape (channels, 1).");
    core.def(
        "measured",
        [](const Drive& drive, const Numbers& state, const Numbers& u) {
            const auto numbers = flattened<double>(kernels().measure(drive, state_from(drive, state), input_of(u)));
            Values out = array({std::size_t(numbers.size())});
            std::copy_n(numbers.item, numbers.size(), out.data());
            return out;
        },
        nb::arg("drive"), nb::arg("state"), nb::arg("inputs"),
        nb::sig("def measured(drive: Drive, state: " SW_ARRAY ", inputs: " SW_ARRAY ") -> " SW_ARRAY),
        "What a controller sees through the sensors: input angle and speed, output angle and speed, current, torque; then the "
        "least and the largest actuation that the motor can follow.");
    core.def(
        "differentiate_rates", &rate_derivatives, nb::arg("drive"), nb::arg("state"), nb::arg("inputs"),
        nb::sig("def differentiate_rates(drive: Drive, state: " SW_ARRAY ", inputs: " SW_ARRAY ") -> tuple[" SW_ARRAY ", " SW_ARRAY
                "]"),
        "Rates of the n continuous numbers, then outputs, shape (n + channels,), in `state`, and derivatives by those numbers and "
        "the inputs, shape (n + 6, n + channels).");
    core.def("state", &state_of_drive, nb::arg("drive"),
             nb::sig("def state(drive: Drive) -> tuple[list[tuple[str, str, str]], int]"),
             "Name, unit and part of each number of a drive's state, and how many of them are continuous; those come first.");
    core.def("shape", &shape_of, nb::arg("drive"), nb::sig("def shape(drive: Drive) -> dict[str, tuple[str, str]]"),
             "Of each part that has a state, the name of its model and the counts that say which number means what.");

    nb::list quantities;
    for (const Field& field : initial::fields) quantities.append(nb::make_tuple(field.name, field.unit, field.doc));
    core.attr("quantities") = nb::tuple(quantities);
    core.def(
        "started",
        [](const Drive& drive, const std::vector<int>& given, const Numbers& values, const Numbers& u) {
            if (values.size() != given.size()) throw nb::value_error("each quantity has a value");
            return array_of(drive, kernels().started(drive, Start{false, given, values.data(), 1}.of(0), input_of(u)));
        },
        nb::arg("drive"), nb::arg("quantities"), nb::arg("values"), nb::arg("inputs"),
        nb::sig("def started(drive: Drive, quantities: collections.abc.Sequence[int], values: " SW_ARRAY ", inputs: " SW_ARRAY
                ") -> " SW_ARRAY),
        "The state in which some quantities are known and the rest has settled; its transmission error is not finite where there "
        "is none.");

    // Functions from one state to another.
    const auto advanced = [&core](const char* name, const char* more, const char* doc, auto f, const auto&... arguments) {
        core.def(name, f, nb::arg("drive"), nb::arg("state"), arguments...,
                 nb::sig(kept(std::string("def ") + name + "(drive: Drive, state: " SW_ARRAY + more + ") -> " SW_ARRAY)), doc);
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
    advanced(
        "begin", ", inputs: " SW_ARRAY, "`state` as a run begins in it: consistent, and sampled if its controller samples.",
        [](const Drive& drive, const Numbers& state, const Numbers& u) {
            return array_of(drive, kernels().begin(drive, state_from(drive, state), input_of(u)));
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
    core.def("with_numbers", &with_numbers, nb::arg("model"), nb::arg("numbers"),
             nb::sig("def with_numbers(model: typing.Any, numbers: collections.abc.Sequence[float]) -> typing.Any"),
             "The same models with other numbers, in the order of `parameters`.");
}

}  // namespace strainwave::host
