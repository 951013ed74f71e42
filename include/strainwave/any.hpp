#pragma once
#include <strainwave/drive.hpp>
#include <strainwave/models.hpp>

#include <algorithm>
#include <cstring>
#include <optional>
#include <tuple>
#include <type_traits>
#include <variant>

/// Host only: a model chosen at run time that is itself a model. Physics sees one more static type, so code grows with the sum of
/// the models, not with their product.
namespace strainwave {

/// What numbers of a model storage hold: those that change continuously or that it remembers, at instants only, or for recordings.
enum class Holds { state, discrete, output };

/// Numbers of whichever model was chosen, of which it has at most n. Up to `few` are all carried along; of more, those it has.
template <class S, int n, Holds what = Holds::state, int few = 4>
struct Storage {
    std::conditional_t<(n <= few), Array<S, (n > 0 ? n : 1)>, Counted<S, n>> slot{};

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, slot, "1", "State of the model chosen, in the order it lists it"));
    }
};

template <class T>
inline constexpr bool is_storage = false;
template <class S, int n, Holds what, int few>
inline constexpr bool is_storage<Storage<S, n, what, few>> = true;

template <class S, class... Law>
struct Choice;

namespace detail {

/// The described struct in which a law keeps such numbers.
template <Holds what, class S, class Law>
constexpr auto kept_in() {
    if constexpr (what == Holds::discrete)
        return control::DiscreteOf<S, Law>{};
    else if constexpr (what == Holds::state && requires { typename Law::State; })
        return typename Law::State{};
    else if constexpr (what == Holds::output && requires { typename Law::Output; })
        return typename Law::Output{};
    else
        return Stateless<S>{};
}
template <Holds what, class S, class Law>
using KeptIn = decltype(kept_in<what, S, Law>());
template <Holds what, class S, class Law>
constexpr int kept_size() {
    return size_of<S, KeptIn<what, S, Law>>;
}

/// A sensor: most show what there is, and have no state, so that none is carried along for them.
template <class Law>
inline constexpr bool mostly_stateless = requires { &Law::shown; };

}  // namespace detail

/// A law chosen at run time under all that may modulate its contact, the outermost last: so that what modulates multiplies
/// neither the models to choose from nor the code.
template <class S, class Law_, class... Modulator>
struct Layers {
    Law_ law{};
    std::tuple<std::optional<Modulator>...> modulators{};

    using State = typename Law_::State;

    constexpr bool modulates() const {
        return std::apply([](const auto&... modulator) { return (modulator.has_value() || ...); }, modulators);
    }
    /// The contact as the law sees it. Factors alone are multiplied, by 1 where nothing modulates, so that no contact is copied.
    constexpr friction::Contact<S> modulated(const friction::Contact<S>& contact) const {
        friction::Factors<S> product;
        multiply<sizeof...(Modulator)>(contact, product);
        return contact.scaled(product);
    }

private:
    template <int i>
    constexpr void multiply(const friction::Contact<S>& contact, friction::Factors<S>& product) const {
        if constexpr (i > 0) {
            if (const auto& outer = std::get<i - 1>(modulators)) {
                const friction::Factors<S> by = outer->factors(contact);
                product = {product.dry * by.dry, product.dry_most * by.dry_most, product.viscous * by.viscous};
            }
            multiply<i - 1>(contact, product);
        }
    }
};

namespace detail {

/// The layers that hold each of some laws: the plain ones as a choice, and the others by what they modulate.
template <class S, class Laws, class Modulators, class... Law>
struct Sorted;
template <class S, class... Law, class... Outer>
struct Sorted<S, std::tuple<Law...>, std::tuple<Outer...>> {
    using type = Layers<S, Choice<S, Law...>, Outer...>;
};
template <class S, class... Law, class... Outer, class First, class... Rest>
struct Sorted<S, std::tuple<Law...>, std::tuple<Outer...>, First, Rest...> {
    static constexpr auto next() {
        if constexpr (friction::Modulation<First>)
            return Sorted<S, std::tuple<Law...>, std::tuple<Outer..., typename First::Modulator>, Rest...>{};
        else
            return Sorted<S, std::tuple<Law..., decltype(compiled(First{}))>, std::tuple<Outer...>, Rest...>{};
    }
    using type = typename decltype(next())::type;
};

template <class S, class... Law>
using LayersOf = Sorted<S, std::tuple<>, std::tuple<>, Law...>;

}  // namespace detail

template <class S, class... Law>
struct Choice {
    std::variant<Law...> model{};

    template <Holds what, int few = 4>
    using StorageFor = Storage<S, std::max({detail::kept_size<what, S, Law>()...}), what, few>;
    using State = StorageFor<Holds::state, (detail::mostly_stateless<Law> || ...) ? 0 : 4>;
    using Output = StorageFor<Holds::output, 64>;

    /// f of the model chosen. A chain of comparisons, which inlines where a table of functions would not.
    template <int i = 0, class F>
    constexpr decltype(auto) visit(F&& f) const {
        if constexpr (i + 1 == sizeof...(Law)) {
            return f(*std::get_if<i>(&model));
        } else {
            if (model.index() == i) return f(*std::get_if<i>(&model));
            return visit<i + 1>(f);
        }
    }

    /// The same choice, of laws rearranged for speed; no choice any more where all come out alike.
    constexpr auto compile() const
        requires(friction::Modulation<Law> || ...)
    {
        typename detail::LayersOf<S, Law...>::type layers{};
        add_to(layers);
        return layers;
    }
    constexpr auto compile() const {
        using First = decltype(compiled(std::get<0>(model)));
        if constexpr (!requires { typename First::State; } &&
                      (std::is_same_v<First, decltype(compiled(std::declval<Law>()))> && ...))
            return visit([](const auto& law) { return compiled(law); });
        else
            return visit([](const auto& law) { return Choice<S, decltype(compiled(std::declval<Law>()))...>{compiled(law)}; });
    }

    /// Adds the model chosen, and what modulates it, to layers that hold any.
    template <class Layers>
    constexpr void add_to(Layers& layers) const {
        visit([&]<class Chosen>(const Chosen& law) {
            if constexpr (friction::Modulation<Chosen>) {
                std::get<std::optional<typename Chosen::Modulator>>(layers.modulators) = law.modulator();
                law.law.add_to(layers);
            } else {
                layers.law.model = compiled(law);
            }
        });
    }

// Calls the verb of the model chosen, with its own state in place of the slots.
#define SW_VERB(verb)                                                                                 \
    template <class... Arguments>                                                                     \
    constexpr auto verb(const Arguments&... arguments) const {                                        \
        return visit([&](const auto& law) { return stored(law, law.verb(own(law, arguments)...)); }); \
    }
    SW_VERB(ratio)
    SW_VERB(inverse_ratio)
    SW_VERB(at)
    SW_VERB(torque)
    SW_VERB(twist)
    SW_VERB(tangent)
    SW_VERB(energy)
    SW_VERB(advance)
    SW_VERB(current)
    SW_VERB(act)
    SW_VERB(shown)
    SW_VERB(settled)
    SW_VERB(relaxation_rate)
    SW_VERB(rate)
    SW_VERB(everett)
    SW_VERB(rising)
    SW_VERB(falling)
    SW_VERB(virgin)
    SW_VERB(virgin_work)
    SW_VERB(power)
    SW_VERB(of_stiffness)
    SW_VERB(of_hysteresis)
    SW_VERB(dissipation_rate)
    SW_VERB(gear_rate)
    SW_VERB(growth)
    SW_VERB(largest)
    SW_VERB(most)
    SW_VERB(generator)
    SW_VERB(generator_acceleration)
    SW_VERB(gap)
    SW_VERB(spring_twist)
    SW_VERB(spring_twist_rate)
    SW_VERB(deformation_rate)
    SW_VERB(energies)
    SW_VERB(compliance)
    SW_VERB(natural_frequency)
    SW_VERB(uneven_frequency)
    SW_VERB(uneven_decay)
    SW_VERB(decay)
#undef SW_VERB

    constexpr S fastest() const {
        return visit([](const auto& law) { return strainwave::fastest<S>(law); });
    }

    // Control, sampled or not.
    template <class Discrete>
    constexpr S actuation(const State& x, const Discrete& held, const control::Command<S>& command,
                          const control::Measurement<S>& measured) const {
        return visit([&](const auto& law) { return control::actuation(law, own(law, x), own(law, held), command, measured); });
    }
    template <class Discrete>
    constexpr S held(const Discrete& x) const {
        return visit([&](const auto& law) { return control::held<S>(law, own(law, x)); });
    }
    template <class Discrete>
    constexpr Discrete sampled(const Discrete& x, const S& within, const control::Command<S>& command,
                               const control::Measurement<S>& measured) const {
        return visit(
            [&](const auto& law) { return put_in<Discrete>(control::sampled(law, own(law, x), within, command, measured)); });
    }
    template <class Discrete>
    constexpr Discrete elapsed(const Discrete& x, const S& dt) const {
        return visit([&](const auto& law) { return put_in<Discrete>(control::elapsed(law, own(law, x), dt)); });
    }
    template <class Discrete>
    constexpr bool due(const Discrete& x, const S& within) const {
        return visit([&](const auto& law) { return control::due(law, own(law, x), within); });
    }
    template <class Discrete>
    constexpr control::Schedule<S> schedule(const Discrete& x) const {
        return visit([&](const auto& law) { return control::schedule<S>(law, own(law, x)); });
    }
    constexpr auto initial_discrete() const {
        using Discrete = control::DiscreteOf<S, Choice>;
        return visit([]<class Chosen>(const Chosen&) { return put_in<Discrete>(control::DiscreteOf<S, Chosen>{}); });
    }

    constexpr const char* gives() const {
        return visit([](const auto& law) { return control::given_by(law); });
    }
    constexpr bool needs_current() const {
        return visit([](const auto& law) { return control::needs_current(law); });
    }

    // Motors, temperatures, meters: what they show of themselves in recordings, and what a motor takes.
    template <class... Arguments>
    constexpr Output output(const Arguments&... arguments) const {
        return visit([&](const auto& law) { return put_in<Output>(law.output(own(law, arguments)...)); });
    }
    constexpr const char* actuation() const {
        return visit([](const auto& law) { return motor::taken_by(law); });
    }
    constexpr bool prescribes() const {
        return visit([](const auto& law) { return motor::prescribes(law); });
    }
    constexpr S acceleration(const S& asked) const {
        return visit([&](const auto& law) { return motor::acceleration<S>(law, asked); });
    }
    constexpr Limits<S> limits(const State& x, const motor::Rotor<S>& rotor) const {
        return visit([&](const auto& law) { return motor::limits(law, own(law, x), rotor); });
    }

    // Structures of a gear.
    constexpr bool rigid() const {
        return visit([](const auto& law) { return law.rigid(); });
    }
    template <class Mesh>
    constexpr structure::Reaction<S, State> reaction(const State& inner, const structure::Shafts<S>& at, const Mesh& mesh,
                                                     const structure::Load<S>& load) const {
        return visit([&](const auto& law) {
            const auto found = law.reaction(own(law, inner), at, mesh, load);
            return structure::Reaction<S, State>{found.torque, found.input_torque, stored(law, found.rate)};
        });
    }
    template <class Mesh>
    constexpr structure::Reaction<S, State> even_reaction(const State& inner, const structure::Shafts<S>& at, const Mesh& mesh,
                                                          const structure::Load<S>& load) const {
        return visit([&](const auto& law) {
            const auto found = law.even_reaction(own(law, inner), at, mesh, load);
            return structure::Reaction<S, State>{found.torque, found.input_torque, stored(law, found.rate)};
        });
    }
    template <class Mesh>
    constexpr structure::Settled<S, State> settled(const State& inner, const structure::Shafts<S>& at, const Mesh& mesh,
                                                   const structure::Load<S>& load) const {
        return visit([&](const auto& law) {
            const auto found = law.settled(own(law, inner), at, mesh, load);
            return structure::Settled<S, State>{stored(law, found.state), found.transmission_error};
        });
    }

    // Kinematic errors.
    constexpr bool follows_load() const {
        return visit([](const auto& law) { return kinematic_error::follows_load(law); });
    }
    constexpr S side(const Angle<S>& angle) const {
        return visit([&](const auto& law) { return kinematic_error::side<S>(law, angle); });
    }
    constexpr kinematic_error::Relief<S> relief(const S& torque) const {
        return visit([&](const auto& law) { return kinematic_error::relief(law, torque); });
    }

    // Loads.
    constexpr S load_torque(const S& angle, const S& speed, const S& input) const {
        return visit([&](const auto& law) { return strainwave::load_torque<S>(law, angle, speed, input); });
    }
    constexpr S steepest() const {
        return visit([](const auto& law) { return load_stiffness<S>(law); });
    }
    constexpr Braking<S> braking(const S& input) const {
        return visit([&](const auto& law) { return strainwave::braking<S>(law, input); });
    }

    // Friction, modulated or not.
    constexpr S torque(const State& x, const friction::Contact<S>& at) const {
        return visit([&](const auto& law) { return friction::torque(law, own(law, x), at); });
    }
    constexpr friction::Response<S, State> response(const State& x, const friction::Contact<S>& at) const {
        return visit([&](const auto& law) {
            const auto found = friction::response(law, own(law, x), at);
            return friction::Response<S, State>{found.torque, stored(law, found.rate)};
        });
    }
    constexpr bool set_valued() const {
        return visit([](const auto& law) { return friction::set_valued(law); });
    }
    constexpr S hold(const friction::Contact<S>& at) const {
        return visit([&](const auto& law) { return friction::hold(law, at); });
    }
    constexpr State rate(const State& x, const friction::Contact<S>& at) const {
        return visit([&](const auto& law) { return stored(law, friction::rate(law, own(law, x), at)); });
    }
    constexpr State relaxation_rate(const State& x, const friction::Contact<S>& at) const {
        return visit([&](const auto& law) { return stored(law, friction::relaxation_rate(law, own(law, x), at)); });
    }
    constexpr State clamped(const State& x, const friction::Contact<S>& at) const {
        return visit([&](const auto& law) { return stored(law, friction::clamped(law, own(law, x), at)); });
    }
    constexpr State update_mode(const State& x, const friction::Contact<S>& at) const {
        return visit([&](const auto& law) { return stored(law, friction::update_mode(law, own(law, x), at)); });
    }
    constexpr State advance(const State& x, const friction::Contact<S>& at, const S& dt) const {
        return visit([&](const auto& law) { return stored(law, friction::advance(law, own(law, x), at, dt)); });
    }
    constexpr State steady_state(const friction::Contact<S>& at) const {
        return visit([&](const auto& law) { return stored(law, friction::steady_state(law, at)); });
    }

    template <class Where>
    constexpr bool bounded() const {
        return visit([](const auto& law) { return strainwave::bounded<Where>(law); });
    }
    template <class Where>
    constexpr Domain<S> domain(const Where& where) const {
        return visit([&](const auto& law) { return strainwave::domain<S>(law, where); });
    }
    constexpr bool active() const {
        return visit([](const auto& law) { return law.active(); });
    }

    /// The state of the model chosen, without a history.
    constexpr State initial_state() const {
        return visit([](const auto& law) { return stored(law, strainwave::initial_state(law)); });
    }

private:
    // A state is nothing but scalars, so it fits the slots as it lies in memory. Storage that hold none stand for no history.
    template <class Model, class T>
    static auto own(const Model&, const T& argument) {
        if constexpr (is_storage<T>)
            return taken_from<Model>(argument);
        else
            return argument;
    }
    template <class Model, int n, Holds what, int few>
    static auto taken_from(const Storage<S, n, what, few>& slots) {
        using X = detail::KeptIn<what, S, Model>;
        if constexpr (std::is_same_v<X, Storage<S, n, what, few>>) {  // a law that varies another has its state
            return slots;
        } else {
            X x{};
            if constexpr (size_of<S, X> > 0) {
                static_assert(sizeof x == size_of<S, X> * sizeof(S));
                if (slots.slot.size() >= size_of<S, X>) std::memcpy(static_cast<void*>(&x), slots.slot.item, sizeof x);
            }
            return x;
        }
    }
    template <class Model, class Result>
    static auto stored(const Model&, const Result& result) {
        if constexpr (std::is_same_v<Result, State> || !requires { requires std::is_same_v<Result, typename Model::State>; })
            return result;
        else
            return put_in<State>(result);
    }
    template <class Filled, class X>
    static Filled put_in(const X& x) {
        Filled slots{};
        if constexpr (std::is_same_v<Filled, X>) {
            slots = x;
        } else if constexpr (size_of<S, X> > 0) {
            if constexpr (requires { slots.slot.count; }) slots.slot.count = size_of<S, X>;
            std::memcpy(static_cast<void*>(slots.slot.item), &x, sizeof x);
        }
        return slots;
    }
};

namespace detail {

/// A law that holds another holds any, where it is chosen at run time.
template <class S, class Law>
struct AtRunTime {
    using type = Law;
};

template <class S, class L>
struct ChoiceOf;
template <class S, template <class...> class... Law>
struct ChoiceOf<S, List<Law...>> {
    using type = Choice<S, typename AtRunTime<S, Law<S>>::type...>;
};

}  // namespace detail

template <class S, class L>
using AnyOf = typename detail::ChoiceOf<S, L>::type;
template <template <class...> class Law, class S>
using AtRunTime = typename detail::AtRunTime<S, Law<S>>::type;

namespace detail {

template <class S, class Law>
struct AtRunTime<S, friction::Asymmetric<S, Law>> {
    using type = friction::Asymmetric<S, AnyOf<S, friction::Levelled>>;
};
template <class S, class Law>
struct AtRunTime<S, friction::Cyclic<S, Law>> {
    using type = friction::Cyclic<S, AnyOf<S, friction::Directed>>;
};
template <class S, class Law>
struct AtRunTime<S, friction::Thermal<S, Law>> {
    using type = friction::Thermal<S, AnyOf<S, friction::Varying>>;
};
template <class S, class Law>
struct AtRunTime<S, control::Sampled<S, Law>> {
    using type = control::Sampled<S, AnyOf<S, control::Continuous>>;
};
template <class S, class Law>
struct AtRunTime<S, sensor::Delayed<S, Law>> {
    using type = sensor::Delayed<S, AnyOf<S, sensor::Plain>>;
};
template <class S, class Law>
struct AtRunTime<S, sensor::Noisy<S, Law>> {
    using type = sensor::Noisy<S, AnyOf<S, sensor::Late>>;
};
template <class S, class Law>
struct AtRunTime<S, sensor::Quantised<S, Law>> {
    using type = sensor::Quantised<S, AnyOf<S, sensor::Loud>>;
};
template <class S, class Law>
struct AtRunTime<S, stiffness::Backlash<S, Law>> {
    using type = stiffness::Backlash<S, AnyOf<S, stiffness::Plain>>;
};
template <class S, class Law>
struct AtRunTime<S, kinematic_error::Scaled<S, Law>> {
    using type = kinematic_error::Scaled<S, AnyOf<S, kinematic_error::Pure>>;
};
template <class S, class Variation>
struct AtRunTime<S, structure::Staged<S, Variation>> {
    using type = structure::Staged<S, AnyOf<S, variation::Models>>;
};
template <class S, class Density>
struct AtRunTime<S, hysteresis::Preisach<S, Density>> {
    using type = hysteresis::Preisach<S, AnyOf<S, hysteresis::Densities>>;
};

}  // namespace detail

template <class S, class... Body>
constexpr S inertia_of(const Choice<S, Body...>& body) {
    return body.visit([](const auto& chosen) { return inertia_of<S>(chosen); });
}
template <class S, class... Load>
inline constexpr bool load::can_prescribe<Choice<S, Load...>> = (load::can_prescribe<Load> || ...);
template <class S, class... Load>
constexpr bool prescribes(const Choice<S, Load...>& choice) {
    return choice.visit([]<class Chosen>(const Chosen&) { return load::can_prescribe<Chosen>; });
}
template <class S, class... Motor>
inline constexpr bool motor::can_prescribe<Choice<S, Motor...>> = (motor::can_prescribe<Motor> || ...);
template <class S, class... Load>
inline constexpr bool load::can_brake<Choice<S, Load...>> = (load::can_brake<Load> || ...);
template <class S, class... Load>
constexpr bool brakes(const Choice<S, Load...>& choice) {
    return choice.visit([]<class Chosen>(const Chosen&) { return load::can_brake<Chosen>; });
}
namespace control::detail {
template <class S, class... Law>
    requires(requires { typename Law::Discrete; } || ...)
struct DiscreteOf<S, Choice<S, Law...>> {
    using type = typename Choice<S, Law...>::template StorageFor<Holds::discrete>;
};
}  // namespace control::detail

template <class S>
using AnyGear =
    Gear<S, AnyOf<S, kinematics::Models>, AnyOf<S, kinematic_error::Models>, AnyOf<S, kinematic_error::Noises>,
         AnyOf<S, stiffness::Models>, AnyOf<S, hysteresis::Models>, AnyOf<S, friction::Models>, AnyOf<S, friction::Models>,
         AnyOf<S, friction::Models>, AnyOf<S, softening::Models>, AnyOf<S, structure::Models>, AnyOf<S, variation::Models>>;

template <class S>
using AnySensors = Sensors<S, AnyOf<S, sensor::Models>>;

template <class S>
using AnyDrive = Drive<S, AnyOf<S, control::Models>, AnyOf<S, motor::Models>, AnyGear<S>, AnyOf<S, load::Models>, AnySensors<S>,
                       AnyOf<S, thermal::Models>, AnyOf<S, meter::Models>>;

}  // namespace strainwave
