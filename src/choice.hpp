#pragma once
#include <strainwave/drive.hpp>
#include <strainwave/models.hpp>

#include <tuple>
#include <variant>

/// Parameters as Python holds them: parts whose law is chosen at run time. They are described, read, compared and checked here; what
/// moves is the general drive, or a kernel.
namespace strainwave {

/// Stands for the state, or the output, of whichever law was chosen.
template <class S>
struct OfChosen {
    S none{0.0};

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, none, "1", "Of the law chosen"));
    }
};
template <class T>
inline constexpr bool is_of_chosen = false;
template <class S>
inline constexpr bool is_of_chosen<OfChosen<S>> = true;

template <class S, class... Law>
struct Choice {
    std::variant<Law...> model{};

    using State = OfChosen<S>;
    using Output = OfChosen<S>;

    /// f of the law chosen.
    template <int i = 0, class F>
    constexpr decltype(auto) visit(F&& f) const {
        if constexpr (i + 1 == sizeof...(Law)) {
            return f(*std::get_if<i>(&model));
        } else {
            if (model.index() == i) return f(*std::get_if<i>(&model));
            return visit<i + 1>(f);
        }
    }

    // What the parts of a drive must know of each other, to see whether they go together.

    constexpr S ratio() const {
        return visit([](const auto& law) { return law.ratio(); });
    }
    constexpr bool rigid() const {
        return visit([](const auto& law) { return law.rigid(); });
    }
    constexpr const char* gives() const {
        return visit([](const auto& law) { return control::given_by(law); });
    }
    constexpr bool needs_current() const {
        return visit([](const auto& law) { return control::needs_current(law); });
    }
    constexpr const char* actuation() const {
        return visit([](const auto& law) { return motor::taken_by(law); });
    }
    constexpr bool has_current() const {
        return visit([](const auto& law) { return motor::has_current<S>(law); });
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
constexpr bool prescribes(const Choice<S, Load...>& choice) {
    return choice.visit([]<class Chosen>(const Chosen&) { return load::can_prescribe<Chosen>; });
}

using ParameterGear =
    Gear<double, AnyOf<double, kinematics::Models>, AnyOf<double, kinematic_error::Models>, AnyOf<double, kinematic_error::Noises>,
         AnyOf<double, stiffness::Models>, AnyOf<double, hysteresis::Models>, AnyOf<double, friction::Models>,
         AnyOf<double, friction::Models>, AnyOf<double, friction::Models>, AnyOf<double, softening::Models>,
         AnyOf<double, structure::Models>, AnyOf<double, variation::Models>>;
using ParameterSensors = Sensors<double, AnyOf<double, sensor::Models>>;
using ParameterDrive = Drive<double, AnyOf<double, control::Models>, AnyOf<double, motor::Models>, ParameterGear,
                             AnyOf<double, load::Models>, ParameterSensors, AnyOf<double, thermal::Models>, AnyOf<double, meter::Models>>;

}  // namespace strainwave
