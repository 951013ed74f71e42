#pragma once
#include <algorithm>

#include "bind.hpp"

/// What a model can be asked from Python, found out from what it can do.
namespace strainwave::host {

using Argument = nb::ndarray<const double, nb::c_contig>;

/// Numbers from Python as an array, refused unless all are finite.
inline Argument numbers(nb::handle values, const char* name) {
    const nb::object given = nb::module_::import_("strainwave.arguments").attr("numbers")(name, values);
    const auto array = nb::cast<Argument>(nb::module_::import_("numpy").attr("asarray")(given, nb::arg("order") = "C"));
    for (std::size_t i = 0; i < array.size(); ++i)
        if (!std::isfinite(array.data()[i]))
            throw nb::value_error(
                (std::string(name) + "[" + std::to_string(i) + "] = " + shortest(array.data()[i]) + " is not finite").c_str());
    return array;
}

inline Argument path_of(nb::handle values, const char* name) {
    const auto path = numbers(values, name);
    if (path.ndim() != 1 || path.size() == 0)
        throw nb::value_error((std::string(name) + " must be a one-dimensional sequence of at least one number").c_str());
    return path;
}

/// A path no wider than numbers reach, with room for some times as much in sums along it.
inline Argument steps_of(nb::handle values, const char* name, const char* unit) {
    const auto path = path_of(values, name);
    const auto [low, high] = std::minmax_element(path.data(), path.data() + path.size());
    if (!std::isfinite(16.0 * (*high - *low)))
        throw nb::value_error(
            (std::string(name) + " from " + shortest(*low) + " to " + with_unit(*high, unit) + " is wider than numbers reach")
                .c_str());
    return path;
}

/// A new array of the same shape, and its numbers.
inline std::pair<Values, double*> like(const Argument& model) {
    std::vector<std::size_t> shape;
    for (std::size_t i = 0; i < model.ndim(); ++i) shape.push_back(model.shape(i));
    Values out = array(shape);
    return {out, out.data()};
}

/// A function of one number, for a number or an array of any shape.
template <class M, class F>
void function(nb::class_<M>& c, const char* name, const char* argument, const char* doc, F f) {
    c.def(
        name,
        [f, argument](const M& self, double x) {
            if (!std::isfinite(x)) throw nb::value_error((std::string(argument) + " = " + shortest(x) + " is not finite").c_str());
            return f(self, x);
        },
        nb::arg(argument).noconvert(), nb::sig(kept(std::string("def ") + name + "(self, " + argument + ": float) -> float")), doc);
    c.def(
        name,
        [f, argument](const M& self, nb::handle values) -> nb::object {
            const auto x = numbers(values, argument);
            const auto law = compiled(self);
            if (x.ndim() == 0) return nb::float_(f(law, *x.data()));
            auto [out, y] = like(x);
            for (std::size_t i = 0; i < x.size(); ++i) y[i] = f(law, x.data()[i]);
            return nb::cast(out);
        },
        nb::arg(argument),
        nb::sig(kept(
            std::string("def ") + name + "(self, " + argument +
            ": collections.abc.Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]")),
        doc);
}

/// An angle in turns and rest. One too large to tell which turn it is in stands where it would if turns were of 2 pi as rounded;
/// beyond 1e300 turns none is told from another.
inline Angle<double> turned(double angle) {
    const double turns = std::rint(angle / (2.0 * pi));
    if (std::abs(turns) > 9007199254740992.0) return {std::remainder(angle, 2.0 * pi), clip(turns, -1e300, 1e300)};
    return {angle - 2.0 * pi * turns, turns};
}

#define SW_NUMBER_OR "float | collections.abc.Sequence[float] | " SW_ARRAY
#define SW_NUMBERS "collections.abc.Sequence[float] | " SW_ARRAY

/// Refuses an argument outside of where a law is valid.
inline void check_domain(const char* law, const Domain<double>& domain) {
    if (domain.holds()) return;
    throw nb::value_error((std::string(law) + ": " + outside(domain)).c_str());
}

template <class M>
void stiffness_verbs(nb::class_<M>& c) {
    if constexpr (requires(const M& m) {
                      m.torque(1.0);
                      m.tangent(1.0);
                  }) {
        const auto within = [](const auto& m, double x) {
            check_domain(M::name, domain<double>(m, x));
            return x;
        };
        function(c, "torque", "twist", "Torque [N.m] at `twist` [rad].",
                 [=](const auto& m, double x) { return m.torque(within(m, x)); });
        function(c, "twist", "torque", "Twist [rad] at `torque` [N.m], the inverse of `torque`.",
                 [](const auto& m, double x) { return m.twist(x); });
        function(c, "tangent", "twist", "Stiffness dT/d(twist) [N.m/rad] at `twist` [rad].",
                 [=](const auto& m, double x) { return m.tangent(within(m, x)); });
        function(c, "energy", "twist", "Elastic energy [J] at `twist` [rad].",
                 [=](const auto& m, double x) { return m.energy(within(m, x)); });
    }
}

/// The harmonics of whole order up to `highest` that a kinematic error has over one turn of the input.
template <class M>
kinematic_error::Fourier<double> harmonics_of(const M& m, int highest) {
    constexpr int points = 4096;
    kinematic_error::Fourier<double> found{};
    if (highest < 1 || highest > found.capacity)
        throw nb::value_error(
            ("highest = " + std::to_string(highest) + " must lie in [1, " + std::to_string(found.capacity) + "]").c_str());
    found.order.count = found.amplitude.count = found.phase.count = highest;
    const auto law = compiled(m);
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

template <class M>
void error_verbs(nb::class_<M>& c) {
    if constexpr (requires(const M& m) { m.at(strainwave::Angle<double>{}); }) {
        function(c, "error", "angle", "Kinematic error [rad] at input `angle` [rad].",
                 [](const auto& m, double x) { return m.at(turned(x)).value; });
        function(c, "slope", "angle", "Its derivative [rad/rad] by the input angle.",
                 [](const auto& m, double x) { return m.at(turned(x)).slope; });
        c.def("harmonics", &harmonics_of<M>, nb::arg("highest") = 8,
              "Its harmonics of order 1 to `highest`, at most 16, over one turn of the input: a Fourier law, without the mean.");
    }
    if constexpr (requires(const M& m) { m.lobes(strainwave::Angle<double>{}); }) {
        c.def(
            "lobes",
            [](const M& m, nb::handle angle) {
                const auto x = numbers(angle, "angle");
                const auto law = compiled(m);
                auto [first, a] = like(x);
                auto [second, b] = like(x);
                for (std::size_t i = 0; i < x.size(); ++i) {
                    const auto lobes = law.lobes(turned(x.data()[i]));
                    a[i] = lobes.first.value;
                    b[i] = lobes.second.value;
                }
                return nb::make_tuple(first, second);
            },
            nb::arg("angle"), nb::sig("def lobes(self, angle: " SW_NUMBER_OR ") -> tuple[" SW_ARRAY ", " SW_ARRAY "]"),
            "Radial displacements delta_A, delta_B [m] of the two lobes at input `angle` [rad], each of the shape of `angle`.");
        c.def("leading", [](const M& m) { return m.leading(); }, "The harmonics to leading order, in closed form: a Fourier law.");
        c.def_prop_ro(
            "eccentricity", [](const M& m) { return nb::make_tuple(m.eccentricity().x, m.eccentricity().y); },
            nb::sig("def eccentricity(self) -> tuple[float, float]"), "What harmonics can tell: the vector m, x and y [m].");
    }
}

template <class M>
void noise_verbs(nb::class_<M>& c) {
    if constexpr (requires(const M& m) { m.at(strainwave::Angle<double>{}, 0.0, 0.0); }) {
        const auto verb = [&c](const char* name, const char* doc, auto what) {
            const auto define = [&](auto verb, const char* type, const char* result) {
                c.def(name, verb, nb::arg("angle"), nb::arg("torque") = 0.0, nb::arg("speed") = 0.0,
                      nb::sig(kept(std::string("def ") + name + "(self, angle: " + type +
                                   ", torque: float = 0.0, speed: float = 0.0) -> " + result)),
                      doc);
            };
            define([what](const M& m, double angle, double torque,
                          double speed) { return what(compiled(m).at(turned(angle), torque, speed)); },
                   "float", "float");
            define(
                [what](const M& m, nb::handle angle, double torque, double speed) {
                    const auto x = numbers(angle, "angle");
                    const auto law = compiled(m);
                    auto [out, y] = like(x);
                    for (std::size_t i = 0; i < x.size(); ++i) y[i] = what(law.at(turned(x.data()[i]), torque, speed));
                    return out;
                },
                SW_NUMBERS, SW_ARRAY);
        };
        verb("error", "Random kinematic error [rad] at input `angle` [rad], under `torque` [N.m] at `speed` [rad/s] of the input.",
             [](const auto& error) { return error.value; });
        verb("slope", "Its derivative [rad/rad] by the input angle, at constant amplitude.",
             [](const auto& error) { return error.slope; });
        c.def_prop_ro("active", [](const M& m) { return m.active(); }, "Whether there is any.");
    }
}

template <class M>
void kinematics_verbs(nb::class_<M>& c) {
    if constexpr (requires(const M& m) { m.ratio(); })
        c.def_prop_ro("ratio", [](const M& m) { return m.ratio(); }, "Input angle over output angle, signed.");
}

/// Calls visit(state, increment, i) along a path, the state brought up to date after each step.
template <class M, class Visit>
typename M::State follow(const M& m, typename M::State x, const Argument& path, Visit&& visit) {
    visit(x, 0.0, std::size_t{0});
    for (std::size_t i = 1; i < path.size(); ++i) {
        const double increment = path.data()[i] - path.data()[i - 1];
        visit(x, increment, i);
        x = m.advance(x, increment);
    }
    return x;
}

/// The state of a model as its member class; laws over others share the state of any.
template <class M>
void bind_state(nb::class_<M>& c) {
    using State = typename M::State;
    if (const nb::handle known = nb::type<State>(); known.is_valid())
        c.attr("State") = known;
    else
        bind<State>(c, "State", std::string(M::name) + ".state");
}

/// A hysteresis that has an exact inverse, and that inverse: torque in, twist out.
template <class M>
void inverse_verbs(nb::class_<M>& c) {
    if constexpr (requires(const M& m) { m.inverse(1.0); })
        c.def(
            "inverse",
            [](const M& m, double spring) {
                if (!(spring > 0.0 && std::isfinite(spring)))
                    throw nb::value_error(("spring = " + with_unit(spring, "N.m/rad") +
                                           " must lie in (0, inf): the inverse needs a positive final slope")
                                              .c_str());
                return m.inverse(spring);
            },
            nb::arg("spring"),
            "What undoes this hysteresis beside a linear `spring` [N.m/rad]: twist over torque, exact, its history included.");
    if constexpr (requires(const M& m, const typename M::State& x) { m.twist(x, 1.0); }) {
        bind_state<M>(c);
        c.def(
            "trace",
            [](const M& m, nb::handle torque, const typename M::State& state) {
                const auto path = steps_of(torque, "torque", "N.m");
                auto [out, twist] = like(path);
                follow(m, state, path,
                       [&, y = twist](const auto& x, double increment, std::size_t i) { y[i] = m.twist(x, increment); });
                return out;
            },
            nb::arg("torque"), nb::arg("state") = typename M::State{},
            nb::sig("def trace(self, torque: " SW_NUMBERS ", state: State = ...) -> " SW_ARRAY),
            "Twist [rad], shape (n,), along a path of `torque` [N.m], shape (n,), from rest at its first point.");
        c.def(
            "advance",
            [](const M& m, nb::handle torque, const typename M::State& state) {
                return follow(m, state, steps_of(torque, "torque", "N.m"), [](const auto&, double, std::size_t) {});
            },
            nb::arg("torque"), nb::arg("state") = typename M::State{},
            nb::sig("def advance(self, torque: " SW_NUMBERS ", state: State = ...) -> State"),
            "The state at the end of a path of `torque` [N.m].");
    }
}

template <class M>
void hysteresis_verbs(nb::class_<M>& c) {
    if constexpr (requires(const M& m, const typename M::State& x) { m.work(x, 1.0); }) {
        using State = typename M::State;
        bind_state<M>(c);
        c.def(
            "trace",
            [](const M& m, nb::handle twist, const State& state) {
                const auto path = steps_of(twist, "twist", "rad");
                auto [out, torque] = like(path);
                follow(m, state, path,
                       [&, y = torque](const State& x, double increment, std::size_t i) { y[i] = m.torque(x, increment); });
                return out;
            },
            nb::arg("twist"), nb::arg("state") = State{},
            nb::sig("def trace(self, twist: " SW_NUMBERS ", state: State = ...) -> " SW_ARRAY),
            "Torque [N.m], shape (n,), along a path of `twist` [rad], shape (n,), monotone between its points.\n\n"
            "The history starts with `state`, which stands at the first point; without it the model is virgin.");
        c.def(
            "work",
            [](const M& m, nb::handle twist, const State& state) {
                const auto path = steps_of(twist, "twist", "rad");
                auto [out, work] = like(path);
                double sum = 0.0;
                follow(m, state, path, [&, y = work](const State& x, double increment, std::size_t i) {
                    y[i] = sum += m.work(x, increment);
                    if (!std::isfinite(sum))
                        throw nb::value_error(("twist[" + std::to_string(i) + "] = " + with_unit(path.data()[i], "rad") +
                                               " takes more work than numbers reach")
                                                  .c_str());
                });
                return out;
            },
            nb::arg("twist"), nb::arg("state") = State{},
            nb::sig("def work(self, twist: " SW_NUMBERS ", state: State = ...) -> " SW_ARRAY),
            "Work [J] put in so far, shape (n,), along a path of `twist` [rad]; exact, as `trace` is.");
        c.def(
            "advance",
            [](const M& m, nb::handle twist, const State& state) {
                return follow(m, state, steps_of(twist, "twist", "rad"), [](const State&, double, std::size_t) {});
            },
            nb::arg("twist"), nb::arg("state") = State{},
            nb::sig("def advance(self, twist: " SW_NUMBERS ", state: State = ...) -> State"),
            "The state at the end of a path of `twist` [rad].");
        if constexpr (requires(const M& m, const State& x) { m.stored(x); })
            c.def(
                "stored",
                [](const M& m, nb::handle twist, const State& state) {
                    const auto path = steps_of(twist, "twist", "rad");
                    auto [out, energy] = like(path);
                    follow(m, state, path, [&, y = energy](const State& x, double increment, std::size_t i) {
                        y[i] = m.stored(m.advance(x, increment));
                    });
                    return out;
                },
                nb::arg("twist"), nb::arg("state") = State{},
                nb::sig("def stored(self, twist: " SW_NUMBERS ", state: State = ...) -> " SW_ARRAY),
                "Elastic energy [J] held, shape (n,), along a path of `twist` [rad]; work less stored is dissipated.");
    }
}

/// One argument of a verb that takes several: a number, or one for each of `n` points.
struct Series {
    Argument values;

    Series(nb::handle given, const char* name, std::size_t n) : values(numbers(given, name)) {
        if (values.ndim() != 0 && (values.ndim() != 1 || values.size() != n))
            throw nb::value_error((std::string(name) + " must be a number, or " + std::to_string(n) + " of them").c_str());
    }
    double operator[](std::size_t i) const { return values.data()[values.ndim() == 0 ? 0 : i]; }
};

#define SW_CONTACT_DOC                                                                                                        \
    "under `load` [N.m], the torque transmitted where it acts, positive if it drives a positive speed; at `angle` [rad] and " \
    "`temperature` [K]. The law looks at what it depends on."

/// A function f(law, contact, x) of one number and the contact, for numbers or arrays that broadcast.
template <class M, class F>
void over_contacts(nb::class_<M>& c, const char* name, const char* argument, const double* otherwise, const char* doc, F f) {
    const auto at = [f](const auto& law, double x, double angle, double load, double temperature) {
        const friction::Contact<double> contact{0.0, 1.0, turned(angle), load, temperature};
        check_domain(M::name, domain<double>(law, contact));
        return f(law, contact, x);
    };
    const auto define = [&](auto verb, const char* type, const char* result) {
        const char* rest = kept(std::string(", angle: ") + type + " = 0.0, load: " + type + " = 0.0, temperature: " + type +
                                " = 293.15) -> " + result);
        const char* sig =
            kept(std::string("def ") + name + "(self, " + argument + ": " + type + (otherwise ? " = 1.0" : "") + rest);
        const auto angle = nb::arg("angle") = 0.0, load = nb::arg("load") = 0.0,
                   temperature = nb::arg("temperature") = friction::room_temperature;
        if (otherwise)
            c.def(name, verb, nb::arg(argument) = *otherwise, angle, load, temperature, nb::sig(sig), doc);
        else
            c.def(name, verb, nb::arg(argument), angle, load, temperature, nb::sig(sig), doc);
    };
    define(
        [at, argument](const M& m, double x, double angle, double load, double temperature) {
            for (const auto& [given, called] :
                 {std::pair(x, argument), {angle, "angle"}, {load, "load"}, {temperature, "temperature"}})
                if (!std::isfinite(given))
                    throw nb::value_error((std::string(called) + " = " + shortest(given) + " is not finite").c_str());
            return at(m, x, angle, load, temperature);
        },
        "float", "float");
    define(
        [at, argument](const M& m, nb::handle x, nb::handle angle, nb::handle load, nb::handle temperature) -> nb::object {
            const nb::tuple given = nb::make_tuple(numbers(x, argument), numbers(angle, "angle"), numbers(load, "load"),
                                                   numbers(temperature, "temperature"));
            std::vector<Argument> each;
            for (nb::handle one : nb::list(nb::module_::import_("numpy").attr("broadcast_arrays")(*given)))
                each.push_back(numbers(one, argument));
            const auto law = compiled(m);
            auto [out, y] = like(each[0]);
            for (std::size_t i = 0; i < each[0].size(); ++i)
                y[i] = at(law, each[0].data()[i], each[1].data()[i], each[2].data()[i], each[3].data()[i]);
            if (each[0].ndim() == 0) return nb::float_(y[0]);
            return nb::cast(out);
        },
        SW_NUMBER_OR, "typing.Any");  // a number where all are numbers, else an array
}

template <class M>
Values friction_trace(const M& m, nb::handle time, nb::handle speed, double angle, nb::handle load, nb::handle temperature,
                      typename M::State state) {
    const auto t = steps_of(time, "time", "s"), v = path_of(speed, "speed");
    if (t.size() != v.size()) throw nb::value_error("time and speed must have the same length");
    const Series loads(load, "load", t.size()), temperatures(temperature, "temperature", t.size());
    const auto law = compiled(m);
    const auto contact = [&](std::size_t i, double at_speed) {
        const friction::Contact<double> at{at_speed, sign(at_speed), turned(angle), loads[i], temperatures[i]};
        check_domain(M::name, domain<double>(law, at));
        return at;
    };
    auto [out, torque] = like(t);
    for (std::size_t i = 0; i < t.size(); ++i) {
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
                                       " leads to a larger angle than numbers reach")
                                          .c_str());
        }
        torque[i] = friction::torque(law, state, contact(i, v.data()[i]));
    }
    return out;
}

/// A speed [rad/s] so slow that no rate shows beside a torque and every time [s] has passed that a law relaxes in. A power of two:
/// a displacement over it, times it, is the displacement again.
inline constexpr double quasistatic_speed = 0x1p-500;

template <class M>
Values friction_quasistatic(const M& m, nb::handle displacement, double angle, nb::handle load, nb::handle temperature) {
    const auto path = steps_of(displacement, "displacement", "rad");
    const Series loads(load, "load", path.size()), temperatures(temperature, "temperature", path.size());
    const auto law = compiled(m);
    typename M::State state{};
    double sense = 0.0;
    auto [out, torque] = like(path);
    for (std::size_t i = 0; i < path.size(); ++i) {
        const double step = i > 0 ? path.data()[i] - path.data()[i - 1] : 0.0;
        if (step != 0.0) sense = sign(step);
        const friction::Contact<double> at{0.0, sense, turned(angle + path.data()[i]), loads[i], temperatures[i]};
        check_domain(M::name, domain<double>(law, at));
        if (step != 0.0)
            state = friction::advance(law, state, at.moving(sense * quasistatic_speed), std::abs(step) / quasistatic_speed);
        torque[i] = friction::set_valued(law) ? sense * friction::hold(law, at) : friction::torque(law, state, at);
    }
    return out;
}

template <class M>
void friction_verbs(nb::class_<M>& c) {
    using Contact = friction::Contact<double>;
    if constexpr (friction::Modulation<M> || requires(const M& m, const typename M::State& x) { m.torque(x, Contact{}); }) {
        using State = typename M::State;
        over_contacts(c, "steady", "speed", nullptr, "Torque [N.m] that opposes steady sliding at `speed` [rad/s], " SW_CONTACT_DOC,
                      [](const auto& law, const Contact& at, double v) { return friction::steady(law, at.moving(v)); });
        const double forward = 1.0;
        over_contacts(c, "hold", "sense", &forward,
                      "The largest torque [N.m] it balances at rest, pushed towards `sense`, " SW_CONTACT_DOC
                      "\n\nZero for a law that does not stick.",
                      [](const auto& law, const Contact& at, double s) { return friction::hold(law, at.pushed(sign(s))); });
        c.def_prop_ro("set_valued", [](const M& m) { return friction::set_valued(m); }, "Whether it can hold at rest.");
        constexpr auto doc =
            "Torque [N.m], shape (n,), over `time` [s] and `speed` [rad/s], both of shape (n,).\n\n"
            "`angle` [rad] is where the motion starts; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). Exact for "
            "a speed that is constant between samples, whatever the step; else the mean of two samples stands for their step. A "
            "law that sticks shows no torque at rest: what it holds depends on what drives it.";
#define SW_TRACE                                                                                           \
    "def trace(self, time: " SW_NUMBERS ", speed: " SW_NUMBERS ", angle: float = 0.0, load: " SW_NUMBER_OR \
    " = 0.0, temperature: " SW_NUMBER_OR " = 293.15"
        if constexpr (std::is_empty_v<State>) {
            c.def(
                "trace",
                [](const M& m, nb::handle time, nb::handle speed, double angle, nb::handle load, nb::handle temperature) {
                    return friction_trace(m, time, speed, angle, load, temperature, State{});
                },
                nb::arg("time"), nb::arg("speed"), nb::arg("angle") = 0.0, nb::arg("load") = 0.0,
                nb::arg("temperature") = friction::room_temperature, nb::sig(SW_TRACE ") -> " SW_ARRAY), doc);
        } else {
            bind_state<M>(c);
            c.def("trace", &friction_trace<M>, nb::arg("time"), nb::arg("speed"), nb::arg("angle") = 0.0, nb::arg("load") = 0.0,
                  nb::arg("temperature") = friction::room_temperature, nb::arg("state") = State{},
                  nb::sig(SW_TRACE ", state: State = ...) -> " SW_ARRAY), doc);
        }
        c.def(
            "quasistatic", &friction_quasistatic<M>, nb::arg("displacement"), nb::arg("angle") = 0.0, nb::arg("load") = 0.0,
            nb::arg("temperature") = friction::room_temperature,
            nb::sig("def quasistatic(self, displacement: " SW_NUMBERS ", angle: float = 0.0, load: " SW_NUMBER_OR
                    " = 0.0, temperature: " SW_NUMBER_OR " = 293.15) -> " SW_ARRAY),
            "Torque [N.m], shape (n,), along a path of `displacement` [rad], shape (n,), monotone between its points, in the limit "
            "of infinite slowness.\n\n"
            "No torque follows from a speed, and no rate. A law that sticks shows the largest torque it balances, in the sense of "
            "the last motion, and none before the first. A law with memory starts virgin, keeps its torque at rest, and is exact "
            "over each step, whatever its length. `angle` [rad] is where displacement is zero; `load` [N.m] and `temperature` [K] "
            "are numbers or of shape (n,). What varies with them is taken over a step as it is at its end.");
        if constexpr (requires(const M& m) { m.passivity(); })
            c.def(
                "check", [](const M& m) { check_passivity(m); },
                "Warns with PassivityWarning, stating both sides, if the parameters let the model create energy.");
    }
}

/// What a law claims of itself beyond its family, for tests and docs to go by.
template <class M>
void claims(nb::class_<M>& c) {
#define SW_CLAIM(claim) \
    if constexpr (requires { M::claim; }) c.attr(#claim) = M::claim;
    SW_CLAIM(odd)
    SW_CLAIM(return_point_memory)
    SW_CLAIM(congruent)
    SW_CLAIM(masing)
#undef SW_CLAIM
}

/// A model with every verb it has.
template <class M>
void bind_model(nb::handle scope, const char* python_name) {
    auto c = bind<M>(scope, python_name, M::name);
    kinematics_verbs(c);
    stiffness_verbs(c);
    if constexpr (requires { typename M::State; }) {
        hysteresis_verbs(c);
        inverse_verbs(c);
        friction_verbs(c);
    }
    error_verbs(c);
    noise_verbs(c);
    claims(c);
    if constexpr (requires { M::command_unit; }) c.attr("command_unit") = M::command_unit;
}

}  // namespace strainwave::host
