#pragma once
#include <algorithm>

#include "call.hpp"

/// What a model can be asked from Python, found out from what it can do.
namespace strainwave::host {

using Argument = nb::ndarray<const double, nb::c_contig>;

/// Numbers from Python as an array, refused unless all are finite.
inline Argument numbers(nb::handle values, const char* name) {
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

#define SW_NUMBER_OR "float | collections.abc.Sequence[float] | " SW_ARRAY
#define SW_NUMBERS "collections.abc.Sequence[float] | " SW_ARRAY

/// A function of one number, for a number or an array of any shape.
template <class M, class F>
void function(const Bound<M>& bound, const char* name, const char* argument, const char* doc, F f) {
    define_function(bound.type, bound.description, name, {{argument, "float"}}, doc,
                    [f](const void* model, const double* x) { return f(*static_cast<const M*>(model), *x); });
    verb(bound, name, {{argument, SW_NUMBERS}}, SW_ARRAY, doc, [f, argument](const M& self, const Call& call) -> nb::object {
        const auto x = numbers(call[argument], argument);
        const auto law = compiled(self);
        if (x.ndim() == 0) return nb::float_(f(law, *x.data()));
        auto [out, y] = like(x);
        for (std::size_t i = 0; i < x.size(); ++i) {
            let_interrupt(i);
            y[i] = f(law, x.data()[i]);
        }
        return nb::cast(out);
    });
}

/// An angle in turns and rest. One too large to tell which turn it is in stands where it would if turns were of 2 pi as rounded;
/// beyond 1e300 turns none is told from another.
inline Angle<double> turned(double angle) {
    const double turns = std::rint(angle / (2.0 * pi));
    if (std::abs(turns) > 9007199254740992.0) return {std::remainder(angle, 2.0 * pi), clip(turns, -1e300, 1e300)};
    return {angle - 2.0 * pi * turns, turns};
}

/// Refuses an argument outside of where a law is valid.
inline void check_domain(const char* law, const Domain<double>& domain) {
    if (domain.holds()) return;
    throw nb::value_error((std::string(law) + ": " + outside(domain)).c_str());
}

template <class M>
void stiffness_verbs(const Bound<M>& c) {
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
void error_verbs(const Bound<M>& c) {
    if constexpr (requires(const M& m, kinematic_error::Error<double> e) { e = m.at(strainwave::Angle<double>{}); }) {
        function(c, "error", "angle", "Kinematic error [rad] at input `angle` [rad].",
                 [](const auto& m, double x) { return m.at(turned(x)).value; });
        function(c, "slope", "angle", "Its derivative [rad/rad] by the input angle.",
                 [](const auto& m, double x) { return m.at(turned(x)).slope; });
        verb(c, "harmonics", {{"highest", "int", "8"}}, python_type<kinematic_error::Fourier<double>>(false),
             "Its harmonics of order 1 to `highest`, at most 16, over one turn of the input: a Fourier law, without the mean.",
             [](const M& m, const Call& call) { return harmonics_of(m, call.whole("highest")); });
    }
    if constexpr (requires(const M& m) { m.lobes(strainwave::Angle<double>{}); }) {
        verb(c, "lobes", {{"angle", SW_NUMBER_OR}}, "tuple[" SW_ARRAY ", " SW_ARRAY "]",
             "Radial displacements delta_A, delta_B [m] of the two lobes at input `angle` [rad], each of the shape of `angle`.",
             [](const M& m, const Call& call) {
                 const auto x = numbers(call["angle"], "angle");
                 const auto law = compiled(m);
                 auto [first, a] = like(x);
                 auto [second, b] = like(x);
                 for (std::size_t i = 0; i < x.size(); ++i) {
                     let_interrupt(i);
                     const auto lobes = law.lobes(turned(x.data()[i]));
                     a[i] = lobes.first.value;
                     b[i] = lobes.second.value;
                 }
                 return nb::make_tuple(first, second);
             });
        verb(c, "leading", {}, python_type<kinematic_error::Fourier<double>>(false),
             "The harmonics to leading order, in closed form: a Fourier law.", [](const M& m, const Call&) { return m.leading(); });
        property(c, "eccentricity", "tuple[float, float]", "What harmonics can tell: the vector m, x and y [m].",
                 [](const M& m) { return nb::make_tuple(m.eccentricity().x, m.eccentricity().y); });
    }
}

template <class M>
void variation_verbs(const Bound<M>& c) {
    if constexpr (requires(const M& m, variation::Factor<double> f) { f = m.at(strainwave::Angle<double>{}); })
        function(c, "factor", "angle", "What the stiffness is multiplied by [1] at an `angle` [rad] of the wave generator.",
                 [](const auto& m, double x) { return m.at(turned(x)).value; });
}

/// What is taken of a random error, for an angle or an array of any shape.
template <class M, class F>
void noise_verb(const Bound<M>& c, const char* name, const char* doc, F what) {
    define_function(c.type, c.description, name, {{"angle", "float"}, {"torque", "float", "0.0"}, {"speed", "float", "0.0"}}, doc,
                    [what](const void* model, const double* x) {
                        return what(compiled(*static_cast<const M*>(model)).at(turned(x[0]), x[1], x[2]));
                    });
    verb(c, name, {{"angle", SW_NUMBERS}, {"torque", "float", "0.0"}, {"speed", "float", "0.0"}}, SW_ARRAY, doc,
         [what](const M& m, const Call& call) -> nb::object {
             const auto x = numbers(call["angle"], "angle");
             const double torque = call.number("torque"), speed = call.number("speed");
             const auto law = compiled(m);
             if (x.ndim() == 0) return nb::float_(what(law.at(turned(*x.data()), torque, speed)));
             auto [out, y] = like(x);
             for (std::size_t i = 0; i < x.size(); ++i) {
                 let_interrupt(i);
                 y[i] = what(law.at(turned(x.data()[i]), torque, speed));
             }
             return nb::cast(out);
         });
}

template <class M>
void noise_verbs(const Bound<M>& c) {
    if constexpr (requires(const M& m) { m.at(strainwave::Angle<double>{}, 0.0, 0.0); }) {
        noise_verb(c, "error",
                   "Random kinematic error [rad] at input `angle` [rad], under `torque` [N.m] at `speed` [rad/s] of the input.",
                   [](const auto& error) { return error.value; });
        noise_verb(c, "slope", "Its derivative [rad/rad] by the input angle, at constant amplitude.",
                   [](const auto& error) { return error.slope; });
    }
}

template <class M>
void activity(const Bound<M>& c) {
    if constexpr (requires(const M& m) { m.active(); })
        property(c, "active", "bool", "Whether it makes any difference.", [](const M& m) { return m.active(); });
}

template <class M>
void kinematics_verbs(const Bound<M>& c) {
    if constexpr (requires(const M& m) { m.ratio(); })
        property(c, "ratio", "float", "Input angle over output angle, signed.", [](const M& m) { return m.ratio(); });
}

/// Calls visit(state, increment, i) along a path, the state brought up to date after each step.
template <class M, class Visit>
typename M::State follow(const M& m, typename M::State x, const Argument& path, Visit&& visit) {
    visit(x, 0.0, std::size_t{0});
    for (std::size_t i = 1; i < path.size(); ++i) {
        let_interrupt(i);
        const double increment = path.data()[i] - path.data()[i - 1];
        visit(x, increment, i);
        x = m.advance(x, increment);
    }
    return x;
}

/// What value(state, increment, i) gives at each point of the path that a verb was called with.
template <class M, class F>
Values along_path(const M& m, const Call& call, const char* name, const char* unit, F&& value) {
    const auto path = steps_of(call[name], name, unit);
    auto [out, y] = like(path);
    follow(m, call.part<typename M::State>("state"), path,
           [&, y = y](const auto& x, double increment, std::size_t i) { y[i] = value(x, increment, i); });
    return out;
}

template <class M>
typename M::State end_of_path(const M& m, const Call& call, const char* name, const char* unit) {
    return follow(m, call.part<typename M::State>("state"), steps_of(call[name], name, unit),
                  [](const auto&, double, std::size_t) {});
}

/// The state of a model as its member class; laws over others share the state of any.
template <class M>
void bind_state(const Bound<M>& c) {
    using State = typename M::State;
    if (const nb::handle known = nb::type<State>(); known.is_valid())
        c.type.attr("State") = known;
    else
        host::bind<State>(c.type, "State", std::string(M::name) + ".state");  // not std::bind
}

/// A hysteresis that has an exact inverse, and that inverse: torque in, twist out.
template <class M>
void inverse_verbs(const Bound<M>& c) {
    if constexpr (requires(const M& m) { m.inverse(1.0); })
        verb(c, "inverse", {{"spring", "float"}}, python_type<decltype(std::declval<const M&>().inverse(1.0))>(false),
             "What undoes this hysteresis beside a linear `spring` [N.m/rad]: twist over torque, exact, its history included.",
             [](const M& m, const Call& call) {
                 const double spring = call.number("spring");
                 if (!(spring > 0.0))
                     throw nb::value_error(("spring = " + with_unit(spring, "N.m/rad") +
                                            " must lie in (0, inf): the inverse needs a positive final slope")
                                               .c_str());
                 return m.inverse(spring);
             });
    if constexpr (requires(const M& m, const typename M::State& x) { m.twist(x, 1.0); }) {
        const std::vector<Accepted> path{{"torque", SW_NUMBERS}, {"state", "State", "..."}};
        bind_state<M>(c);
        verb(c, "trace", path, SW_ARRAY,
             "Twist [rad], shape (n,), along a path of `torque` [N.m], shape (n,), from rest at its first point.",
             [](const M& m, const Call& call) {
                 return along_path(m, call, "torque", "N.m",
                                   [&](const auto& x, double increment, std::size_t) { return m.twist(x, increment); });
             });
        verb(c, "advance", path, "State", "The state at the end of a path of `torque` [N.m].",
             [](const M& m, const Call& call) { return end_of_path(m, call, "torque", "N.m"); });
    }
}

template <class M>
void hysteresis_verbs(const Bound<M>& c) {
    if constexpr (requires(const M& m, const typename M::State& x) { m.work(x, 1.0); }) {
        const std::vector<Accepted> path{{"twist", SW_NUMBERS}, {"state", "State", "..."}};
        bind_state<M>(c);
        verb(c, "trace", path, SW_ARRAY,
             "Torque [N.m], shape (n,), along a path of `twist` [rad], shape (n,), monotone between its points.\n\n"
             "The history starts with `state`, which stands at the first point; without it the model is virgin.",
             [](const M& m, const Call& call) {
                 return along_path(m, call, "twist", "rad",
                                   [&](const auto& x, double increment, std::size_t) { return m.torque(x, increment); });
             });
        verb(c, "work", path, SW_ARRAY, "Work [J] put in so far, shape (n,), along a path of `twist` [rad]; exact, as `trace` is.",
             [](const M& m, const Call& call) {
                 double sum = 0.0;
                 return along_path(m, call, "twist", "rad", [&](const auto& x, double increment, std::size_t i) {
                     sum += m.work(x, increment);
                     if (!std::isfinite(sum))
                         throw nb::value_error(("twist[" + std::to_string(i) + "] leads to more work than numbers reach").c_str());
                     return sum;
                 });
             });
        verb(c, "advance", path, "State", "The state at the end of a path of `twist` [rad].",
             [](const M& m, const Call& call) { return end_of_path(m, call, "twist", "rad"); });
        if constexpr (requires(const M& m, const typename M::State& x) { m.stored(x); })
            verb(c, "stored", path, SW_ARRAY,
                 "Elastic energy [J] held, shape (n,), along a path of `twist` [rad]; work less stored is dissipated.",
                 [](const M& m, const Call& call) {
                     return along_path(m, call, "twist", "rad", [&](const auto& x, double increment, std::size_t) {
                         return m.stored(m.advance(x, increment));
                     });
                 });
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

/// An argument and what a contact depends on, each of the same type.
inline std::vector<Accepted> contacted(const Accepted& first) {
    return {first, {"angle", first.type, "0.0"}, {"load", first.type, "0.0"}, {"temperature", first.type, "293.15"}};
}

/// A function f(law, contact, x) of one number and the contact, for numbers or arrays that broadcast.
template <class M, class F>
void over_contacts(const Bound<M>& c, const char* name, const char* argument, const char* otherwise, const char* doc, F f) {
    const auto at = [f](const auto& law, double x, double angle, double load, double temperature) {
        const friction::Contact<double> contact{0.0, 1.0, turned(angle), load, temperature};
        check_domain(M::name, domain<double>(law, contact));
        return f(law, contact, x);
    };
    const std::vector<Accepted> one = contacted({argument, "float", otherwise}),
                                any = contacted({argument, SW_NUMBER_OR, otherwise});
    define_function(c.type, c.description, name, one, doc,
                    [at](const void* model, const double* x) { return at(*static_cast<const M*>(model), x[0], x[1], x[2], x[3]); });
    // a number where all are numbers, else an array
    verb(c, name, any, "typing.Any", doc, [at, argument](const M& m, const Call& call) -> nb::object {
        nb::list given;
        for (const char* each : {argument, "angle", "load", "temperature"}) given.append(numbers(call[each], each));
        std::vector<Argument> each;
        for (nb::handle broadcast : nb::list(nb::module_::import_("numpy").attr("broadcast_arrays")(*given)))
            each.push_back(numbers(broadcast, argument));
        const auto law = compiled(m);
        auto [out, y] = like(each[0]);
        for (std::size_t i = 0; i < each[0].size(); ++i) {
            let_interrupt(i);
            y[i] = at(law, each[0].data()[i], each[1].data()[i], each[2].data()[i], each[3].data()[i]);
        }
        if (each[0].ndim() == 0) return nb::float_(y[0]);
        return nb::cast(out);
    });
}

template <class M>
Values friction_trace(const M& m, const Call& call, typename M::State state) {
    const auto t = steps_of(call["time"], "time", "s"), v = path_of(call["speed"], "speed");
    if (t.size() != v.size()) throw nb::value_error("time and speed must have the same length");
    const Series loads(call["load"], "load", t.size()), temperatures(call["temperature"], "temperature", t.size());
    const auto law = compiled(m);
    double angle = call.number("angle");
    const auto contact = [&](std::size_t i, double at_speed) {
        const friction::Contact<double> at{at_speed, sign(at_speed), turned(angle), loads[i], temperatures[i]};
        check_domain(M::name, domain<double>(law, at));
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
Values friction_quasistatic(const M& m, const Call& call) {
    const auto path = steps_of(call["displacement"], "displacement", "rad");
    const Series loads(call["load"], "load", path.size()), temperatures(call["temperature"], "temperature", path.size());
    const double angle = call.number("angle");
    const auto law = compiled(m);
    typename M::State state{};
    double sense = 0.0;
    auto [out, torque] = like(path);
    for (std::size_t i = 0; i < path.size(); ++i) {
        let_interrupt(i);
        const double step = i > 0 ? path.data()[i] - path.data()[i - 1] : 0.0;
        if (step != 0.0) sense = sign(step);
        const friction::Contact<double> at{0.0, sense, turned(angle + path.data()[i]), loads[i], temperatures[i]};
        check_domain(M::name, domain<double>(law, at));
        if (step != 0.0)
            state = friction::advance(law, state, at.moving(sense * quasistatic_speed), std::abs(step) / quasistatic_speed);
        torque[i] = friction::set_valued(law) ? along(sense, sense == 0.0 ? 0.0 : friction::hold(law, at))
                                              : friction::torque(law, state, at);
    }
    return out;
}

template <class M>
void friction_verbs(const Bound<M>& c) {
    using Contact = friction::Contact<double>;
    if constexpr (friction::Modulation<M> || requires(const M& m, const typename M::State& x) { m.torque(x, Contact{}); }) {
        using State = typename M::State;
        over_contacts(c, "steady", "speed", "", "Torque [N.m] that opposes steady sliding at `speed` [rad/s], " SW_CONTACT_DOC,
                      [](const auto& law, const Contact& at, double v) { return friction::steady(law, at.moving(v)); });
        over_contacts(c, "hold", "sense", "1.0",
                      "The largest torque [N.m] it balances at rest, pushed towards `sense`, " SW_CONTACT_DOC
                      "\n\nZero for a law that does not stick.",
                      [](const auto& law, const Contact& at, double s) { return friction::hold(law, at.pushed(sign(s))); });
        property(c, "set_valued", "bool", "Whether it can hold at rest.", [](const M& m) { return friction::set_valued(m); });
        const Accepted angle{"angle", "float", "0.0"}, load{"load", SW_NUMBER_OR, "0.0"},
            temperature{"temperature", SW_NUMBER_OR, "293.15"};
        std::vector<Accepted> traced{{"time", SW_NUMBERS}, {"speed", SW_NUMBERS}, angle, load, temperature};
        if constexpr (!std::is_empty_v<State>) {
            bind_state<M>(c);
            traced.push_back({"state", "State", "..."});
        }
        verb(c, "trace", traced, SW_ARRAY,
             "Torque [N.m], shape (n,), over `time` [s] and `speed` [rad/s], both of shape (n,).\n\n"
             "`angle` [rad] is where the motion starts; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). Exact for "
             "a speed that is constant between samples, whatever the step; else the mean of two samples stands for their step. A "
             "law that sticks shows no torque at rest: what it holds depends on what drives it.",
             [](const M& m, const Call& call) {
                 if constexpr (std::is_empty_v<State>)
                     return friction_trace(m, call, State{});
                 else
                     return friction_trace(m, call, call.part<State>("state"));
             });
        verb(
            c, "quasistatic", {{"displacement", SW_NUMBERS}, angle, load, temperature}, SW_ARRAY,
            "Torque [N.m], shape (n,), along a path of `displacement` [rad], shape (n,), monotone between its points, in the limit "
            "of infinite slowness.\n\n"
            "No torque follows from a speed, and no rate. A law that sticks shows the largest torque it balances, in the sense of "
            "the last motion, and none before the first. A law with memory starts virgin, keeps its torque at rest, and is exact "
            "over each step, whatever its length. `angle` [rad] is where displacement is zero; `load` [N.m] and `temperature` [K] "
            "are numbers or of shape (n,). What varies with them is taken over a step as it is at its end.",
            [](const M& m, const Call& call) { return friction_quasistatic(m, call); });
        if constexpr (requires(const M& m) { m.passivity(); })
            verb(c, "check", {}, "None",
                 "Warns with PassivityWarning, stating both sides, if the parameters let the model create energy.",
                 [](const M& m, const Call&) { check_passivity(m.passivity(), M::name); });
    }
}

/// What a law claims of itself beyond its family, for tests and docs to go by.
template <class M>
void claims(const Bound<M>& c) {
#define SW_CLAIM(claim) \
    if constexpr (requires { M::claim; }) c.type.attr(#claim) = M::claim;
    SW_CLAIM(odd)
    SW_CLAIM(return_point_memory)
    SW_CLAIM(congruent)
    SW_CLAIM(masing)
#undef SW_CLAIM
}

/// A model with every verb it has.
template <class M>
void bind_model(nb::handle scope, const char* python_name) {
    const Bound<M> c{bind<M>(scope, python_name, M::name), description_of<M>(python_name, M::name)};
    kinematics_verbs(c);
    stiffness_verbs(c);
    if constexpr (requires { typename M::State; }) {
        hysteresis_verbs(c);
        inverse_verbs(c);
        friction_verbs(c);
    }
    error_verbs(c);
    noise_verbs(c);
    variation_verbs(c);
    activity(c);
    claims(c);
}

}  // namespace strainwave::host
