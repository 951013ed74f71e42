#pragma once
#include "general/friction.hpp"
#include "general/hysteresis.hpp"
#include "general/material.hpp"
#include "parameter_drive.hpp"
#include "verbs.hpp"

/// Laws as Python binds them, each with its verbs.
namespace strainwave::host {

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

/// Values of value(state, increment, i) at each point of the path of a call.
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

/// A hysteresis that has an exact inverse, and that inverse: torque in, twist out.
template <class M>
void inverse_verbs(const Bound<M>& c) {
    if constexpr (requires(const M& m) { m.inverse(1.0); })
        verb(c, "inverse", {{"spring", "float"}}, qualified(description_of<decltype(std::declval<const M&>().inverse(1.0))>()),
             "Return the exact inverse of this hysteresis in parallel with a linear `spring` [N.m/rad]: twist over torque, history "
             "included.",
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
        host::bind<typename M::State>(c.type, "State", std::string(M::name) + ".state");  // not std::bind
        verb(c, "trace", path, SW_ARRAY,
             "Return the twist [rad], shape (n,), along a path of `torque` [N.m], shape (n,), from rest at its first point.",
             [](const M& m, const Call& call) {
                 return along_path(m, call, "torque", "N.m",
                                   [&](const auto& x, double increment, std::size_t) { return m.twist(x, increment); });
             });
        verb(c, "advance", path, "State", "Return the state at the end of a path of `torque` [N.m].",
             [](const M& m, const Call& call) { return end_of_path(m, call, "torque", "N.m"); });
    }
}

/// Functions that some laws have beyond those of their family.
template <class M>
void own_verbs(const Bound<M>& c) {
    if constexpr (requires(const M& m) { m.lobes(strainwave::Angle<double>{}); }) {
        verb(c, "lobes", {{"angle", SW_NUMBER_OR}}, "tuple[" SW_ARRAY ", " SW_ARRAY "]",
             "Return the radial displacements delta_A, delta_B [m] of the two lobes at input `angle` [rad], each of the shape of "
             "`angle`.",
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
        verb(c, "leading", {}, qualified(description_of<kinematic_error::Fourier<double>>()),
             "Return the harmonics to leading order, in closed form: a Fourier law.",
             [](const M& m, const Call&) { return m.leading(); });
        property(c, "eccentricity", "tuple[float, float]", "Vector m that the harmonics determine, x and y [m].",
                 [](const M& m) { return nb::make_tuple(m.eccentricity().x, m.eccentricity().y); });
    }
    if constexpr (requires(const M& m) { m.active(); })
        property(c, "active", "bool", "True if the law has an effect.", [](const M& m) { return m.active(); });
    if constexpr (requires(const M& m) { m.ratio(); })
        property(c, "ratio", "float", "Input angle over output angle, signed.", [](const M& m) { return m.ratio(); });
}

/// Properties that a law claims beyond its family, for tests and docs.
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

/// The struct of the state of a law, as its member class; null if it has none. A law that varies another has the state of any.
template <class M, class StateOfAny>
const Description* state_of(nb::handle type) {
    using State = std::conditional_t<stands_for_chosen<typename M::State>, StateOfAny, typename M::State>;
    if constexpr (std::is_empty_v<State>) {
        return nullptr;
    } else {
        if (const nb::handle known = nb::type<State>(); known.is_valid())
            type.attr("State") = known;
        else
            host::bind<State>(type, "State", std::string(M::name) + ".state");
        return &description_of<State>();
    }
}

// The verbs of a family, for law number `law` of it.

struct NoVerbs {
    template <class M>
    static void add(const Bound<M>&, int) {}
};
struct StiffnessVerbs {
    template <class M>
    static void add(const Bound<M>& c, int law) {
        stiffness_verbs({c.type, c.description, law});
    }
};
struct HysteresisVerbs {
    template <class M>
    static void add(const Bound<M>& c, int law) {
        constexpr bool stores = requires(const M& m, const typename M::State& x) { m.stored(x); };
        hysteresis_verbs({c.type, c.description, law, state_of<M, general::Hysteresis<double>::State>(c.type), stores});
    }
};
struct FrictionVerbs {
    template <class M>
    static void add(const Bound<M>& c, int law) {
        friction_verbs({c.type, c.description, law, state_of<M, general::Friction<double>::State>(c.type)});
    }
};
struct ErrorVerbs {
    template <class M>
    static void add(const Bound<M>& c, int law) {
        error_verbs({c.type, c.description, law});
    }
};
struct NoiseVerbs {
    template <class M>
    static void add(const Bound<M>& c, int law) {
        noise_verbs({c.type, c.description, law});
    }
};
struct VariationVerbs {
    template <class M>
    static void add(const Bound<M>& c, int law) {
        variation_verbs({c.type, c.description, law});
    }
};
struct MaterialVerbs {
    template <class M>
    static void add(const Bound<M>& c, int law) {
        material_verbs({c.type, c.description, law, state_of<M, general::Material<double>::State>(c.type)});
    }
};
struct FeedforwardVerbs {
    template <class M>
    static void add(const Bound<M>& c, int law) {
        feedforward_verbs({c.type, c.description, law});
    }
};

/// A law with every verb it has.
template <class Verbs, class M>
void bind_model(nb::handle scope, const char* python_name, int law) {
    const Bound<M> c{bind<M>(scope, python_name, M::name), description_of<M>()};
    Verbs::add(c, law);
    if constexpr (requires { typename M::State; }) inverse_verbs(c);
    own_verbs(c);
    claims(c);
}

/// The law's name in C++ is its name in Python: LuGre of `strainwave::friction::LuGre<double>`.
template <class M>
const char* python_name() {
    return name_of_template(__PRETTY_FUNCTION__);
}

/// A family of models as a module of the package.
nb::module_ family_module(nb::module_& core, const char* name, const char* doc);

/// The models of a list, and the list by their names in files, in a table of such lists.
template <class Verbs, template <class...> class... Law>
void bind_list(nb::module_& core, nb::module_ family, const char* name, List<Law...>, const char* table = "families") {
    nb::dict models;
    int law = 0;
    (bind_model<Verbs, AtRunTime<Law, double>>(family, python_name<Law<double>>(), law++), ...);
    ((models[Law<double>::name] = nb::type<AtRunTime<Law, double>>()), ...);
    core.attr(table)[name] = models;
}

template <class Verbs, class L>
void bind_family(nb::module_& core, const char* name, const char* doc, L list) {
    bind_list<Verbs>(core, family_module(core, name, doc), name, list);
}

}  // namespace strainwave::host
