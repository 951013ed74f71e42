#pragma once
#include "bind.hpp"

/// What a model can be asked from Python, found out from what it can do.
namespace strainwave::host {

using Argument = nb::ndarray<const double, nb::c_contig>;

/// Numbers from Python as an array, refused unless all are finite.
inline Argument numbers(nb::handle values, const char* name) {
    const auto array = nb::cast<Argument>(
        nb::module_::import_("numpy").attr("asarray")(values, nb::arg("dtype") = "float64", nb::arg("order") = "C"));
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

/// A new array of the same shape, and its numbers.
inline std::pair<Values, double*> like(const Argument& model) {
    std::vector<std::size_t> shape;
    for (std::size_t i = 0; i < model.ndim(); ++i) shape.push_back(model.shape(i));
    auto* data = new double[model.size() + 1];
    nb::capsule owner(data, [](void* p) noexcept { delete[] static_cast<double*>(p); });
    return {Values(data, shape.size(), shape.data(), owner), data};
}

/// A function of one number, for a number or an array of any shape.
template <class M, class F>
void function(nb::class_<M>& c, const char* name, const char* argument, const char* doc, F f) {
    c.def(
        name, [f](const M& self, double x) { return f(self, x); }, nb::arg(argument).noconvert(),
        nb::sig(kept(std::string("def ") + name + "(self, " + argument + ": float) -> float")), doc);
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

#define SW_NUMBERS "collections.abc.Sequence[float] | " SW_ARRAY

template <class M>
void stiffness_verbs(nb::class_<M>& c) {
    if constexpr (requires(const M& m) {
                      m.torque(1.0);
                      m.tangent(1.0);
                  }) {
        function(c, "torque", "twist", "Torque [N.m] at `twist` [rad].", [](const auto& m, double x) { return m.torque(x); });
        function(c, "twist", "torque", "Twist [rad] at `torque` [N.m], the inverse of `torque`.",
                 [](const auto& m, double x) { return m.twist(x); });
        function(c, "tangent", "twist", "Stiffness dT/d(twist) [N.m/rad] at `twist` [rad].",
                 [](const auto& m, double x) { return m.tangent(x); });
        function(c, "energy", "twist", "Elastic energy [J] at `twist` [rad].", [](const auto& m, double x) { return m.energy(x); });
    }
}

template <class M>
void error_verbs(nb::class_<M>& c) {
    using Angle = kinematic_error::Angle<double>;
    if constexpr (requires(const M& m) { m.at(Angle{}); }) {
        function(c, "error", "angle", "Kinematic error [rad] at input `angle` [rad].",
                 [](const auto& m, double x) { return m.at(Angle{x, 0.0}).value; });
        function(c, "slope", "angle", "Its derivative [rad/rad] by the input angle.",
                 [](const auto& m, double x) { return m.at(Angle{x, 0.0}).slope; });
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

template <class M>
void hysteresis_verbs(nb::class_<M>& c) {
    if constexpr (requires(const M& m, const typename M::State& x) { m.work(x, 1.0); }) {
        using State = typename M::State;
        bind<State>(c, "State", std::string(M::name) + ".state");
        c.def(
            "trace",
            [](const M& m, nb::handle twist, const State& state) {
                const auto path = path_of(twist, "twist");
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
                const auto path = path_of(twist, "twist");
                auto [out, work] = like(path);
                double sum = 0.0;
                follow(m, state, path,
                       [&, y = work](const State& x, double increment, std::size_t i) { y[i] = sum += m.work(x, increment); });
                return out;
            },
            nb::arg("twist"), nb::arg("state") = State{},
            nb::sig("def work(self, twist: " SW_NUMBERS ", state: State = ...) -> " SW_ARRAY),
            "Work [J] put in so far, shape (n,), along a path of `twist` [rad]; exact, as `trace` is.");
        c.def(
            "advance",
            [](const M& m, nb::handle twist, const State& state) {
                return follow(m, state, path_of(twist, "twist"), [](const State&, double, std::size_t) {});
            },
            nb::arg("twist"), nb::arg("state") = State{},
            nb::sig("def advance(self, twist: " SW_NUMBERS ", state: State = ...) -> State"),
            "The state at the end of a path of `twist` [rad].");
        if constexpr (requires(const M& m, const State& x) { m.stored(x); })
            c.def(
                "stored",
                [](const M& m, nb::handle twist, const State& state) {
                    const auto path = path_of(twist, "twist");
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

template <class M>
void friction_verbs(nb::class_<M>& c) {
    using Contact = friction::Contact<double>;
    if constexpr (requires(const M& m, const typename M::State& x) { m.torque(x, Contact{}); }) {
        using State = typename M::State;
        function(c, "steady", "speed", "Torque [N.m] that opposes steady sliding at `speed` [rad/s].",
                 [](const auto& m, double speed) { return friction::steady(m, speed); });
        if constexpr (friction::SetValued<M>)
            c.def("hold", [](const M& m) { return m.hold(); }, "The largest torque [N.m] it balances at rest.");
        if constexpr (friction::Bristle<M>) {
            bind<State>(c, "State", std::string(M::name) + ".state");
            c.def(
                "trace",
                [](const M& m, nb::handle time, nb::handle speed, State state) {
                    const auto t = path_of(time, "time"), v = path_of(speed, "speed");
                    if (t.size() != v.size()) throw nb::value_error("time and speed must have the same length");
                    auto [out, torque] = like(t);
                    for (std::size_t i = 0; i < t.size(); ++i) {
                        if (i > 0) {
                            const double dt = t.data()[i] - t.data()[i - 1];
                            if (!(dt > 0.0))
                                throw nb::value_error(("time[" + std::to_string(i) + "] = " + with_unit(t.data()[i], "s") +
                                                       " must lie after the time before it")
                                                          .c_str());
                            state = m.advance(state, 0.5 * (v.data()[i - 1] + v.data()[i]), dt);
                        }
                        torque[i] = m.torque(state, Contact::at(v.data()[i]));
                    }
                    return out;
                },
                nb::arg("time"), nb::arg("speed"), nb::arg("state") = State{},
                nb::sig("def trace(self, time: " SW_NUMBERS ", speed: " SW_NUMBERS ", state: State = ...) -> " SW_ARRAY),
                "Torque [N.m], shape (n,), over `time` [s] and `speed` [rad/s], both of shape (n,).\n\n"
                "Exact for a speed that is constant between samples, whatever the step; else the mean of two samples stands for "
                "their step.");
        }
        if constexpr (requires(const M& m) { m.passivity(); })
            c.def(
                "check",
                [](const M& m) {
                    const Condition<double> rule = m.passivity();
                    if (rule.left >= rule.right) return;
                    const std::string text = std::string(M::name) + " can create energy: " + rule.left_name + " = " +
                                             with_unit(rule.left, rule.unit) + " must be at least " + rule.right_name + " = " +
                                             with_unit(rule.right, rule.unit);
                    if (PyErr_WarnEx(nb::module_::import_("strainwave._core").attr("PassivityWarning").ptr(), text.c_str(), 1) < 0)
                        throw nb::python_error();
                },
                "Warns with PassivityWarning, stating both sides, if the parameters let the model create energy.");
    }
}

/// A model with every verb it has.
template <class M>
void bind_model(nb::handle scope, const char* python_name) {
    auto c = bind<M>(scope, python_name, M::name);
    kinematics_verbs(c);
    stiffness_verbs(c);
    if constexpr (requires { typename M::State; }) {
        hysteresis_verbs(c);
        friction_verbs(c);
    }
    error_verbs(c);
    if constexpr (requires { M::command_unit; }) c.attr("command_unit") = M::command_unit;
}

}  // namespace strainwave::host
