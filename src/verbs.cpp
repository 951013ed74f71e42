#include "verbs.hpp"

#include <strainwave/kinematic_error/fourier.hpp>

#include <algorithm>

#include "general/compensation.hpp"
#include "general/friction.hpp"
#include "general/hysteresis.hpp"
#include "general/kinematic_error.hpp"
#include "general/material.hpp"
#include "general/spring_factors.hpp"
#include "general/stiffness.hpp"

namespace strainwave::host {

Argument numbers(nb::handle values, const char* name) {
    const nb::object given = nb::module_::import_("strainwave.arguments").attr("numbers")(name, values);
    const auto array = nb::cast<Argument>(nb::module_::import_("numpy").attr("asarray")(given, nb::arg("order") = "C"));
    for (std::size_t i = 0; i < array.size(); ++i) {
        let_interrupt(i);
        if (!std::isfinite(array.data()[i]))
            throw nb::value_error(
                (std::string(name) + "[" + std::to_string(i) + "] = " + shortest(array.data()[i]) + " is not finite").c_str());
    }
    return array;
}

Argument path_of(nb::handle values, const char* name) {
    const auto path = numbers(values, name);
    if (path.ndim() != 1 || path.size() == 0)
        throw nb::value_error((std::string(name) + " must be a one-dimensional sequence of at least one number").c_str());
    return path;
}

Argument steps_of(nb::handle values, const char* name, const char* unit) {
    const auto path = path_of(values, name);
    const auto [low, high] = std::minmax_element(path.data(), path.data() + path.size());
    if (!std::isfinite(16.0 * (*high - *low)))
        throw nb::value_error((std::string(name) + " from " + shortest(*low) + " to " + with_unit(*high, unit) +
                               " is wider than the range of numbers")
                                  .c_str());
    return path;
}

std::pair<Values, double*> like(const Argument& model) {
    std::vector<std::size_t> shape;
    for (std::size_t i = 0; i < model.ndim(); ++i) shape.push_back(model.shape(i));
    Values out = array(shape);
    return {out, out.data()};
}

Angle<double> turned(double angle) {
    const double turns = std::rint(angle / (2.0 * pi));
    if (std::abs(turns) > 9007199254740992.0) return {std::remainder(angle, 2.0 * pi), clip(turns, -1e300, 1e300)};
    return {angle - 2.0 * pi * turns, turns};
}

void check_domain(std::string_view law, const Domain<double>& domain) {
    if (domain.holds()) return;
    throw nb::value_error((std::string(law) + ": " + outside(domain)).c_str());
}

namespace {

/// A single law as a part of the general drive: called with Python's objects.
template <class Part>
SingleLaw<Part> single_law(const BoundLaw& of, const void* model) {
    return {of.description, model, of.law};
}

/// Defines f(part, number) of one number, for a number or an array of any shape.
template <class Part, class F>
void function(const BoundLaw& of, const char* name, const char* argument, const char* doc, F f) {
    define_function(of.type, of.description, name, {{argument, "float"}}, doc,
                    [of, f](const void* model, const double* x) { return f(single_law<Part>(of, model).part, *x); });
    define_verb(of.type, of.description, name, {{argument, SW_NUMBERS}}, SW_ARRAY, doc,
                [of, f, argument](const void* model, const Call& call) -> nb::object {
                    const auto x = numbers(call[argument], argument);
                    const auto law = single_law<Part>(of, model);
                    if (x.ndim() == 0) return nb::float_(f(law.part, *x.data()));
                    auto [out, y] = like(x);
                    for (std::size_t i = 0; i < x.size(); ++i) {
                        let_interrupt(i);
                        y[i] = f(law.part, x.data()[i]);
                    }
                    return nb::cast(out);
                });
}

/// The harmonics of whole order up to `highest` that a kinematic error has over one turn of the input.
kinematic_error::Fourier<double> harmonics_of(const general::KinematicError<double>& law, int highest) {
    constexpr int points = 4096;
    kinematic_error::Fourier<double> found{};
    if (highest < 1 || highest > found.capacity)
        throw nb::value_error(
            ("highest = " + std::to_string(highest) + " must lie in [1, " + std::to_string(found.capacity) + "]").c_str());
    found.order.count = found.amplitude.count = found.phase.count = highest;
    std::vector<double> error(points);
    for (int i = 0; i < points; ++i) error[i] = law.at({2.0 * pi * i / points - pi, 0.0}).value;
    for (int n = 1; n <= highest; ++n) {
        double sine = 0.0, cosine = 0.0;
        for (int i = 0; i < points; ++i) {
            const double angle = 2.0 * pi * ((long long)(n)*i % points) / points - n * pi;
            sine += error[i] * std::sin(angle);
            cosine += error[i] * std::cos(angle);
        }
        found.order[n - 1] = n;
        found.amplitude[n - 1] = std::hypot(sine, cosine) * 2.0 / points;
        found.phase[n - 1] = std::atan2(cosine, sine);
    }
    return found;
}

}  // namespace

void stiffness_verbs(const BoundLaw& of) {
    using Part = general::Stiffness<double>;
    const auto within = [name = of.description.name](const Part& law, double x) {
        check_domain(name, law.domain(x));
        return x;
    };
    function<Part>(of, "torque", "twist", "Return the torque [N.m] at `twist` [rad].",
                   [=](const Part& law, double x) { return law.torque(within(law, x)); });
    function<Part>(of, "twist", "torque", "Return the twist [rad] at `torque` [N.m], the inverse of `torque`.",
                   [](const Part& law, double x) { return law.twist(x); });
    function<Part>(of, "tangent", "twist", "Return the stiffness dT/d(twist) [N.m/rad] at `twist` [rad].",
                   [=](const Part& law, double x) { return law.tangent(within(law, x)); });
    function<Part>(of, "energy", "twist", "Return the elastic energy [J] at `twist` [rad].",
                   [=](const Part& law, double x) { return law.energy(within(law, x)); });
}

void error_verbs(const BoundLaw& of) {
    using Part = general::KinematicError<double>;
    function<Part>(of, "error", "angle", "Return the kinematic error [rad] at input `angle` [rad].",
                   [](const Part& law, double x) { return law.at(turned(x)).value; });
    function<Part>(of, "slope", "angle", "Return the derivative [rad/rad] of the error by the input angle.",
                   [](const Part& law, double x) { return law.at(turned(x)).slope; });
    define_verb(
        of.type, of.description, "harmonics", {{"highest", "int", "8"}},
        qualified(description_of<kinematic_error::Fourier<double>>()),
        "Return the harmonics of order 1 to `highest`, at most 16, over one turn of the input: a Fourier law, without the mean.",
        [of](const void* model, const Call& call) {
            return nb::cast(harmonics_of(single_law<Part>(of, model).part, call.whole("highest")));
        });
}

void variation_verbs(const BoundLaw& of) {
    function<general::Variation<double>>(of, "factor", "angle",
                                         "Return the factor [1] of the stiffness at an `angle` [rad] of the wave generator.",
                                         [](const auto& law, double x) { return law.at(turned(x)).value; });
}

void feedforward_verbs(const BoundLaw& of) {
    using Part = general::Feedforward<double, general::Requests::feedforward>;
    define_verb(
        of.type, of.description, "requests",
        {{"angle", SW_NUMBERS}, {"speed", SW_NUMBERS}, {"ratio", "float"}, {"period", "float"}},
        "tuple[" SW_ARRAY ", " SW_ARRAY ", " SW_ARRAY ", " SW_ARRAY "]",
        "Return the requests along a motion of the output, `angle` [rad] and `speed` [rad/s], each of shape (n,), sampled with "
        "`period` [s], through a gear of this signed `ratio`: the lead of the input over the rigid motion [rad], its "
        "rate [rad/s], the torque of the motor [N.m], and the share of it that overcomes friction [N.m], each of shape "
        "(n,). `ValueError` if the two differ in length, if `period` lies outside of [1e-9, 1e6], or `ratio` without its sign "
        "outside of [1e-6, 1e6].",
        [of](const void* model, const Call& call) -> nb::object {
            const auto angle = path_of(call["angle"], "angle"), speed = path_of(call["speed"], "speed");
            const double period = call.number("period"), ratio = call.number("ratio");
            if (angle.size() != speed.size()) throw nb::value_error("angle and speed must have the same length");
            check_domain(of.description.name, {"period", period, 1e-9, 1e6, "s", ""});
            check_domain(of.description.name, {"ratio", std::abs(ratio), 1e-6, 1e6, "1", "it may have either sign"});
            const auto law = single_law<Part>(of, model);
            auto x = law.part.initial_state();
            auto [lead, a] = like(angle);
            auto [lead_rate, b] = like(angle);
            auto [torque, c] = like(angle);
            auto [friction, d] = like(angle);
            for (std::size_t i = 0; i < angle.size(); ++i) {
                let_interrupt(i);
                const auto found = law.part.step(x, {angle.data()[i], speed.data()[i], ratio}, period);
                x = found.next;
                a[i] = found.request.input_lead;
                b[i] = found.request.input_lead_rate;
                c[i] = found.request.torque;
                d[i] = found.request.friction;
            }
            return nb::make_tuple(lead, lead_rate, torque, friction);
        });
}

namespace {

/// Evaluations of a random error, for an angle or an array of any shape.
template <class F>
void noise_verb(const BoundLaw& of, const char* name, const char* doc, F what) {
    using Part = general::KinematicNoise<double>;
    define_function(of.type, of.description, name, {{"angle", "float"}, {"torque", "float", "0.0"}, {"speed", "float", "0.0"}}, doc,
                    [of, what](const void* model, const double* x) {
                        return what(single_law<Part>(of, model).part.at(turned(x[0]), x[1], x[2]));
                    });
    define_verb(of.type, of.description, name, {{"angle", SW_NUMBERS}, {"torque", "float", "0.0"}, {"speed", "float", "0.0"}},
                SW_ARRAY, doc, [of, what](const void* model, const Call& call) -> nb::object {
                    const auto x = numbers(call["angle"], "angle");
                    const double torque = call.number("torque"), speed = call.number("speed");
                    const auto law = single_law<Part>(of, model);
                    if (x.ndim() == 0) return nb::float_(what(law.part.at(turned(*x.data()), torque, speed)));
                    auto [out, y] = like(x);
                    for (std::size_t i = 0; i < x.size(); ++i) {
                        let_interrupt(i);
                        y[i] = what(law.part.at(turned(x.data()[i]), torque, speed));
                    }
                    return nb::cast(out);
                });
}

}  // namespace

void noise_verbs(const BoundLaw& of) {
    noise_verb(
        of, "error",
        "Return the random kinematic error [rad] at input `angle` [rad], under `torque` [N.m] at `speed` [rad/s] of the input.",
        [](const auto& error) { return error.value; });
    noise_verb(of, "slope", "Return the derivative [rad/rad] of the error by the input angle, at constant amplitude.",
               [](const auto& error) { return error.slope; });
}

// States. A law has one of its own, or that of any law of its family, which it varies.

namespace {

/// A state that Python gave, in the slots of a part; without a history if none was given.
template <class State>
State state_in(const BoundLaw& of, const Call& call) {
    State slots{};
    const nb::object given = of.state ? call.optional("state", *of.state) : nb::object();
    if (!given.is_valid()) return slots;
    const std::vector<double> numbers = parts_of(*of.state, nb::inst_ptr<void>(given)).numbers;
    slots.slot.count = int(numbers.size());
    std::copy(numbers.begin(), numbers.end(), slots.slot.item);
    return slots;
}
/// A state as Python holds it.
template <class State>
nb::object state_out(const BoundLaw& of, const State& slots) {
    if (of.state == &description_of<State>()) return nb::cast(slots);
    nb::object state = of.state->cast(of.state->defaults);  // Python's alone until it is handed over
    if (slots.slot.count > 0) set_numbers(*of.state, nb::inst_ptr<void>(state), slots.slot.item);
    return state;
}

using Hysteresis = general::Hysteresis<double>;

/// Values of value(law, state, increment, i) at each point of a path of twist, the state brought up to date after each.
template <class F>
Values along_path(const BoundLaw& of, const void* model, const Call& call, F&& value) {
    const auto law = single_law<Hysteresis>(of, model);
    const auto path = steps_of(call["twist"], "twist", "rad");
    auto [out, y] = like(path);
    auto x = state_in<Hysteresis::State>(of, call);
    for (std::size_t i = 0; i < path.size(); ++i) {
        let_interrupt(i);
        const double increment = i > 0 ? path.data()[i] - path.data()[i - 1] : 0.0;
        y[i] = value(law.part, x, increment, i);
        if (i > 0) x = law.part.advance(x, increment);
    }
    return out;
}

}  // namespace

void hysteresis_verbs(const BoundLaw& of) {
    using State = Hysteresis::State;
    const std::vector<Accepted> path{{"twist", SW_NUMBERS}, {"state", "State", "..."}};
    const auto define = [&](const char* name, const char* result, const char* doc, auto f) {
        define_verb(of.type, of.description, name, path, result, doc,
                    [of, f](const void* model, const Call& call) -> nb::object { return nb::cast(f(of, model, call)); });
    };
    define("trace", SW_ARRAY,
           "Return the torque [N.m], shape (n,), along a path of `twist` [rad], shape (n,), monotone between its points.\n\n"
           "The history starts with `state` at the first point; without it the model is virgin.",
           [](const BoundLaw& law, const void* model, const Call& call) {
               return along_path(law, model, call, [](const Hysteresis& m, const State& x, double increment, std::size_t) {
                   return m.torque(x, increment);
               });
           });
    define(
        "work", SW_ARRAY,
        "Return the work [J] done on the model so far, shape (n,), along a path of `twist` [rad]; exact, as `trace` is.",
        [](const BoundLaw& law, const void* model, const Call& call) {
            double sum = 0.0;
            return along_path(law, model, call, [&](const Hysteresis& m, const State& x, double increment, std::size_t i) {
                sum += m.work(x, increment);
                if (!std::isfinite(sum))
                    throw nb::value_error(("twist[" + std::to_string(i) + "] leads to work beyond the range of numbers").c_str());
                return sum;
            });
        });
    define("advance", "State", "Return the state at the end of a path of `twist` [rad].",
           [](const BoundLaw& of_law, const void* model, const Call& call) {
               const auto law = single_law<Hysteresis>(of_law, model);
               const auto twist = steps_of(call["twist"], "twist", "rad");
               State x = state_in<State>(of_law, call);
               for (std::size_t i = 1; i < twist.size(); ++i) {
                   let_interrupt(i);
                   x = law.part.advance(x, twist.data()[i] - twist.data()[i - 1]);
               }
               return state_out(of_law, x);
           });
    if (of.stores)
        define("stored", SW_ARRAY,
               "Return the elastic energy [J], shape (n,), along a path of `twist` [rad]; work less stored energy is dissipated.",
               [](const BoundLaw& law, const void* model, const Call& call) {
                   return along_path(law, model, call, [](const Hysteresis& m, const State& x, double increment, std::size_t) {
                       return m.stored(m.advance(x, increment));
                   });
               });
}

namespace {

using Material = general::Material<double>;

/// Values of value(law, state, increment, dt) at each instant of a twist over time, the state brought up to date after each.
template <class F>
Values over_time(const BoundLaw& of, const void* model, const Call& call, F&& value) {
    const auto time = steps_of(call["time"], "time", "s"), twist = steps_of(call["twist"], "twist", "rad");
    if (time.size() != twist.size()) throw nb::value_error("time and twist must have the same length");
    const auto law = single_law<Material>(of, model);
    auto x = state_in<Material::State>(of, call);
    auto [out, y] = like(time);
    for (std::size_t i = 0; i < time.size(); ++i) {
        let_interrupt(i);
        const double dt = i > 0 ? time.data()[i] - time.data()[i - 1] : 0.0;
        if (i > 0 && !(dt > 0.0))
            throw nb::value_error(
                ("time[" + std::to_string(i) + "] = " + with_unit(time.data()[i], "s") + " must lie after the time before it")
                    .c_str());
        y[i] = value(law.part, x, i > 0 ? twist.data()[i] - twist.data()[i - 1] : 0.0, dt);
    }
    return out;
}

}  // namespace

void material_verbs(const BoundLaw& of) {
    using State = Material::State;
    std::vector<Accepted> course{{"time", SW_NUMBERS}, {"twist", SW_NUMBERS}};
    if (of.state) course.push_back({"state", "State", "..."});
    define_verb(of.type, of.description, "trace", course, SW_ARRAY,
                "Return the torque [N.m], shape (n,), over `time` [s] and `twist` [rad], both of shape (n,).\n\n"
                "The history starts with `state` at the first instant; without it there is none. Exact for a rate that is constant "
                "between samples, whatever the step.",
                [of](const void* model, const Call& call) -> nb::object {
                    return nb::cast(over_time(of, model, call, [](const Material& m, State& x, double increment, double dt) {
                        x = m.advance(x, increment, dt);
                        return m.torque(x);
                    }));
                });
    define_verb(
        of.type, of.description, "work", course, SW_ARRAY,
        "Return the work [J] done on the material so far, shape (n,), over `time` [s] and `twist` [rad]; exact, as `trace` is.",
        [of](const void* model, const Call& call) -> nb::object {
            double sum = 0.0;
            return nb::cast(over_time(of, model, call, [&](const Material& m, State& x, double increment, double dt) {
                sum += m.work(x, increment, dt);
                x = m.advance(x, increment, dt);
                return sum;
            }));
        });
    define_verb(of.type, of.description, "stored", course, SW_ARRAY,
                "Return the elastic energy [J], shape (n,), over `time` [s] and `twist` [rad]; work less stored energy is lost.",
                [of](const void* model, const Call& call) -> nb::object {
                    return nb::cast(over_time(of, model, call, [](const Material& m, State& x, double increment, double dt) {
                        x = m.advance(x, increment, dt);
                        return m.stored(x);
                    }));
                });
    function<Material>(of, "storage", "frequency",
                       "Return the stiffness [N.m/rad] in phase with a sine of the twist, of an angular `frequency` [rad/s].",
                       [](const Material& law, double x) { return law.storage(x); });
    function<Material>(
        of, "loss", "frequency",
        "Return the stiffness [N.m/rad] a quarter of a period ahead of a sine of the twist, of an angular `frequency` "
        "[rad/s]: a cycle of amplitude a loses pi a^2 times it.",
        [](const Material& law, double x) { return law.loss(x); });
}

namespace {

/// One argument of a verb that takes several: a number, or one for each of `n` points.
struct Series {
    Argument values;

    Series(nb::handle given, const char* name, std::size_t n) : values(numbers(given, name)) {
        if (values.ndim() != 0 && (values.ndim() != 1 || values.size() != n))
            throw nb::value_error((std::string(name) + " must be a number, or " + std::to_string(n) + " of them").c_str());
    }
    double operator[](std::size_t i) const { return values.data()[values.ndim() == 0 ? 0 : i]; }
};

using Friction = general::Friction<double>;
using Contact = friction::Contact<double>;

#define SW_CONTACT_DOC                                                                                                        \
    "under `load` [N.m], the torque transmitted where it acts, positive if it drives a positive speed; at `angle` [rad] and " \
    "`temperature` [K]. A law ignores the arguments that it does not depend on."

/// An argument and the numbers of a contact, each of the same type.
std::vector<Accepted> contacted(const Accepted& first) {
    return {first, {"angle", first.type, "0.0"}, {"load", first.type, "0.0"}, {"temperature", first.type, "293.15"}};
}

/// Defines f(law, contact, x) of one number and the contact, for numbers or arrays that broadcast.
template <class F>
void over_contacts(const BoundLaw& of, const char* name, const char* argument, const char* otherwise, const char* doc, F f) {
    const auto at = [f, owner = of.description.name](const Friction& law, double x, double angle, double load, double temperature) {
        const Contact contact{0.0, 1.0, turned(angle), load, temperature};
        check_domain(owner, law.domain(contact));
        return f(law, contact, x);
    };
    const std::vector<Accepted> one = contacted({argument, "float", otherwise}),
                                any = contacted({argument, SW_NUMBER_OR, otherwise});
    define_function(of.type, of.description, name, one, doc, [of, at](const void* model, const double* x) {
        return at(single_law<Friction>(of, model).part, x[0], x[1], x[2], x[3]);
    });
    // a number where all are numbers, else an array
    define_verb(of.type, of.description, name, any, "typing.Any", doc,
                [of, at, argument](const void* model, const Call& call) -> nb::object {
                    nb::list given;
                    for (const char* each : {argument, "angle", "load", "temperature"}) given.append(numbers(call[each], each));
                    std::vector<Argument> each;
                    for (nb::handle broadcast : nb::list(nb::module_::import_("numpy").attr("broadcast_arrays")(*given)))
                        each.push_back(numbers(broadcast, argument));
                    const auto law = single_law<Friction>(of, model);
                    auto [out, y] = like(each[0]);
                    for (std::size_t i = 0; i < each[0].size(); ++i) {
                        let_interrupt(i);
                        y[i] = at(law.part, each[0].data()[i], each[1].data()[i], each[2].data()[i], each[3].data()[i]);
                    }
                    if (each[0].ndim() == 0) return nb::float_(y[0]);
                    return nb::cast(out);
                });
}

Values friction_trace(const BoundLaw& of, const void* model, const Call& call) {
    const auto t = steps_of(call["time"], "time", "s"), v = path_of(call["speed"], "speed");
    if (t.size() != v.size()) throw nb::value_error("time and speed must have the same length");
    const Series loads(call["load"], "load", t.size()), temperatures(call["temperature"], "temperature", t.size());
    const auto held_law = single_law<Friction>(of, model);
    const Friction& law = held_law.part;
    Friction::State state = state_in<Friction::State>(of, call);
    double angle = call.number("angle");
    const auto contact = [&](std::size_t i, double at_speed) {
        const Contact at{at_speed, sign(at_speed), turned(angle), loads[i], temperatures[i]};
        check_domain(of.description.name, law.domain(at));
        return at;
    };
    auto [out, torque] = like(t);
    for (std::size_t i = 0; i < t.size(); ++i) {
        let_interrupt(i);
        if (i > 0) {
            const double dt = t.data()[i] - t.data()[i - 1], mean = 0.5 * v.data()[i - 1] + 0.5 * v.data()[i];
            if (!(dt > 0.0))
                throw nb::value_error(
                    ("time[" + std::to_string(i) + "] = " + with_unit(t.data()[i], "s") + " must lie after the time before it")
                        .c_str());
            state = friction::advance(law, state, contact(i, mean), dt);
            angle += mean * dt;
            if (!std::isfinite(angle))
                throw nb::value_error(("speed[" + std::to_string(i) + "] = " + with_unit(v.data()[i], "rad/s") +
                                       " leads to an angle beyond the range of numbers")
                                          .c_str());
        }
        torque[i] = friction::torque(law, state, contact(i, v.data()[i]));
    }
    return out;
}

/// A speed [rad/s] so slow that no rate is visible in a torque and every time [s] has passed that a law relaxes in. A power of
/// two: a displacement over it, times it, is the displacement again.
constexpr double quasistatic_speed = 0x1p-500;

Values friction_quasistatic(const BoundLaw& of, const void* model, const Call& call) {
    const auto path = steps_of(call["displacement"], "displacement", "rad");
    const Series loads(call["load"], "load", path.size()), temperatures(call["temperature"], "temperature", path.size());
    const double angle = call.number("angle");
    const auto held_law = single_law<Friction>(of, model);
    const Friction& law = held_law.part;
    Friction::State state{};
    double sense = 0.0;
    auto [out, torque] = like(path);
    for (std::size_t i = 0; i < path.size(); ++i) {
        let_interrupt(i);
        const double step = i > 0 ? path.data()[i] - path.data()[i - 1] : 0.0;
        if (step != 0.0) sense = sign(step);
        const Contact at{0.0, sense, turned(angle + path.data()[i]), loads[i], temperatures[i]};
        check_domain(of.description.name, law.domain(at));
        if (step != 0.0)
            state = friction::advance(law, state, at.moving(sense * quasistatic_speed), std::abs(step) / quasistatic_speed);
        torque[i] = friction::set_valued(law) ? along(sense, sense == 0.0 ? 0.0 : friction::hold(law, at))
                                              : friction::torque(law, state, at);
    }
    return out;
}

}  // namespace

void friction_verbs(const BoundLaw& of) {
    over_contacts(of, "steady", "speed", "", "Return the torque [N.m] against steady sliding at `speed` [rad/s], " SW_CONTACT_DOC,
                  [](const Friction& law, const Contact& at, double v) { return friction::steady(law, at.moving(v)); });
    over_contacts(of, "hold", "sense", "1.0",
                  "Return the breakaway torque [N.m] at rest in the direction `sense`, " SW_CONTACT_DOC
                  "\n\nZero for a law that does not stick.",
                  [](const Friction& law, const Contact& at, double s) { return friction::hold(law, at.pushed(sign(s))); });
    define_property(of.type, of.description, "set_valued", "bool", "True if the law is set-valued at rest.",
                    [of](const void* model) { return nb::cast(single_law<Friction>(of, model).part.set_valued()); });
    const Accepted angle{"angle", "float", "0.0"}, load{"load", SW_NUMBER_OR, "0.0"},
        temperature{"temperature", SW_NUMBER_OR, "293.15"};
    std::vector<Accepted> traced{{"time", SW_NUMBERS}, {"speed", SW_NUMBERS}, angle, load, temperature};
    if (of.state) traced.push_back({"state", "State", "..."});
    define_verb(of.type, of.description, "trace", traced, SW_ARRAY,
                "Return the torque [N.m], shape (n,), over `time` [s] and `speed` [rad/s], both of shape (n,).\n\n"
                "`angle` [rad] is the angle at the start; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). Exact "
                "for a speed that is constant between samples, whatever the step; otherwise each step has the mean speed of its "
                "two samples. The torque of a set-valued law is 0 at rest, because it depends on the driving torque.",
                [of](const void* model, const Call& call) { return nb::cast(friction_trace(of, model, call)); });
    define_verb(
        of.type, of.description, "quasistatic", {{"displacement", SW_NUMBERS}, angle, load, temperature}, SW_ARRAY,
        "Return the torque [N.m], shape (n,), along a slow path of `displacement` [rad], shape (n,), monotone between its "
        "points.\n\n"
        "In the limit of speed 0, without torques that depend on speed or rate. The torque of a set-valued law is its breakaway "
        "torque, in the sense of the last motion, and 0 before the first. A law with memory starts virgin, keeps its torque at "
        "rest, and is exact over each step, whatever its length. `angle` [rad] is the angle at displacement 0; `load` [N.m] and "
        "`temperature` [K] are numbers or of shape (n,). Each step has the angle, load and temperature at its end.",
        [of](const void* model, const Call& call) { return nb::cast(friction_quasistatic(of, model, call)); });
    if (of.description.check_passivity)
        define_verb(of.type, of.description, "check", {}, "None",
                    "Warn with PassivityWarning, with both sides of the condition, if the model can create energy.",
                    [check = of.description.check_passivity](const void* model, const Call&) -> nb::object {
                        check(model);
                        return nb::none();
                    });
}

}  // namespace strainwave::host
