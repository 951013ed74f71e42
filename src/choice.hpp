#pragma once
#include <strainwave/compensation/compensator.hpp>
#include <strainwave/control/law.hpp>
#include <strainwave/field.hpp>
#include <strainwave/load/load.hpp>
#include <strainwave/motor/rotor.hpp>

#include <variant>

/// A part of a set of parameters whose law is chosen at run time. It is described, read, compared and checked; what moves is the
/// general drive, or a kernel.
namespace strainwave {

/// Stands for the state, or the output, of whichever law was chosen.
template <class S>
struct OfChosenLaw {
    S none{0.0};

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, none, "1", "Of the law chosen"));
    }
};
template <class T>
inline constexpr bool stands_for_chosen = false;
template <class S>
inline constexpr bool stands_for_chosen<OfChosenLaw<S>> = true;

template <class S, class... Law>
struct Choice {
    std::variant<Law...> model{};

    using State = OfChosenLaw<S>;
    using Output = OfChosenLaw<S>;

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

    // Facts of a part that the checks between parts need.

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
    constexpr bool follows_angle() const {
        return visit([](const auto& law) { return control::follows_angle(law); });
    }
    constexpr bool active() const {
        return visit([](const auto& law) { return compensation::active(law); });
    }
    constexpr S model_ratio() const {
        return visit([](const auto& law) { return control::model_ratio<S>(law); });
    }
    constexpr S max_period() const {
        return visit([](const auto& law) { return control::max_period<S>(law); });
    }
    constexpr const char* actuation() const {
        return visit([](const auto& law) { return motor::taken_by(law); });
    }
    constexpr bool has_current() const {
        return visit([](const auto& law) { return motor::has_current<S>(law); });
    }
};

template <class S, class... Body>
constexpr S inertia_of(const Choice<S, Body...>& body) {
    return body.visit([](const auto& chosen) { return inertia_of<S>(chosen); });
}
template <class S, class... Load>
constexpr bool prescribes(const Choice<S, Load...>& choice) {
    return choice.visit([]<class Chosen>(const Chosen&) { return load::can_prescribe<Chosen>; });
}

}  // namespace strainwave
