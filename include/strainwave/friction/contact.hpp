#pragma once
#include <strainwave/angle.hpp>
#include <strainwave/condition.hpp>
#include <strainwave/math.hpp>
#include <strainwave/room_temperature.hpp>

/// Friction torque opposes the motion of the place it acts on: the input shaft, the mesh or the output shaft.
namespace strainwave::friction {

/// Factors of a modulation.
template <class S>
struct Factors {
    S dry{1.0}, dry_most{1.0}, viscous{1.0};  ///< of dry friction, of the largest that can become, and of viscous friction
};

/// Motion of the two surfaces of a place against each other, their load and temperature.
template <class S>
struct Contact {
    S speed{0.0};                     ///< rad/s
    S sliding{1.0};                   ///< Sense of sliding of a set-valued law: -1, 1, or 0 while it sticks
    Angle<S> angle{};                 ///< Angle of the place
    S load{0.0};                      ///< Torque it transmits [N.m]: load * speed is the power that flows to the output
    S temperature{room_temperature};  ///< K
    S dry{1.0};                       ///< Factor on the torque levels of dry friction
    S dry_most{1.0};                  ///< The largest it can become
    S viscous{1.0};                   ///< Factor on viscous friction

    /// The contact with dry and viscous friction multiplied.
    constexpr Contact scaled(const Factors<S>& by) const {
        return {speed, sliding, angle, load, temperature, dry * by.dry, dry_most * by.dry_most, viscous * by.viscous};
    }
    constexpr Contact moving(const S& at_speed) const {
        Contact contact = *this;
        contact.speed = at_speed;
        return contact;
    }
    constexpr Contact pushed(const S& towards) const {
        Contact contact = *this;
        contact.sliding = towards;
        return contact;
    }
    /// Sliding the way its speed has it, as in a measurement at constant speed.
    constexpr Contact steady() const { return pushed(sign(speed)); }
};

/// A law that can hold its place at rest: while it sticks it balances any torque up to `hold(contact)`, which pushes towards
/// `contact.sliding`.
template <class Law>
concept SetValued = requires(const Law& law) { law.hold({}); };

/// A law with internal state that relaxes: rate = forcing - relaxation rate * state.
template <class Law>
concept Bristle = requires(const Law& law, const typename Law::State& x) { law.relaxation_rate(x, {}); };

/// A law that is another, under a contact it modulates.
template <class Law>
concept Modulation = requires(const Law& law) {
    law.law;
    law.modulated({});
};

/// A law and the modulation of its contact, rearranged for speed.
template <class S, class Law, class Modulator>
struct Modulated {
    Modulator modulator;
    Law law;

    using State = typename Law::State;

    constexpr Contact<S> modulated(const Contact<S>& contact) const { return contact.scaled(modulator.factors(contact)); }
    constexpr S detent(const Contact<S>& contact) const
        requires requires { modulator.detent(contact); }
    {
        return modulator.detent(contact);
    }
};

/// A modulation that adds a torque [N.m] over the angle, the same in both directions of motion.
template <class Law, class S>
concept Detaining = requires(const Law& law, const Contact<S>& contact) { law.detent(contact); };

/// A torque of the law within a modulation, with the detent that the modulation adds.
template <class Law, class S>
constexpr S with_detent(const Law& law, const S& torque, const Contact<S>& contact) {
    if constexpr (Detaining<Law, S>)
        return torque + law.detent(contact);
    else
        return torque;
}

// The verbs of friction, for plain laws and modulated ones, with or without memory.

/// Torque [N.m] that opposes the motion.
template <class Law, class S>
constexpr S torque(const Law& law, const typename Law::State& x, const Contact<S>& contact) {
    if constexpr (Modulation<Law>)
        return with_detent(law, S(torque(law.law, x, law.modulated(contact))), contact);
    else
        return law.torque(x, contact);
}

/// Response of a law to a contact: torque that opposes the motion, and the rate of its state.
template <class S, class State>
struct Response {
    S torque;
    State rate;
};

/// Torque and rate at once.
template <class Law, class S>
constexpr Response<S, typename Law::State> response(const Law& law, const typename Law::State& x, const Contact<S>& contact) {
    if constexpr (Modulation<Law>) {
        const auto [torque, rate] = response(law.law, x, law.modulated(contact));
        return {with_detent(law, S(torque), contact), rate};
    } else if constexpr (requires { law.response(x, contact); }) {
        return law.response(x, contact);
    } else if constexpr (requires { law.torque(x, contact, x); }) {
        const auto rate = law.rate(x, contact);
        return {law.torque(x, contact, rate), rate};
    } else if constexpr (Bristle<Law>) {
        return {law.torque(x, contact), law.rate(x, contact)};
    } else {
        return {law.torque(x, contact), {}};
    }
}

template <class Law>
constexpr bool set_valued(const Law& law) {
    if constexpr (Modulation<Law>)
        return set_valued(law.law);
    else if constexpr (requires { law.set_valued(); })
        return law.set_valued();
    else
        return SetValued<Law>;
}

/// The largest torque [N.m] balanced at rest; none by a law that is not set-valued. A detent adds to what it resists.
template <class Law, class S>
constexpr S hold(const Law& law, const Contact<S>& contact) {
    if constexpr (Modulation<Law>) {
        const S held = hold(law.law, law.modulated(contact));
        if constexpr (Detaining<Law, S>)
            if (set_valued(law)) return max(held + contact.sliding * law.detent(contact), S(0.0));
        return held;
    } else if constexpr (SetValued<Law>)
        return law.hold(contact);
    else
        return S(0.0);
}

template <class Law, class S>
constexpr typename Law::State rate(const Law& law, const typename Law::State& x, const Contact<S>& contact) {
    if constexpr (Modulation<Law>)
        return rate(law.law, x, law.modulated(contact));
    else if constexpr (Bristle<Law>)
        return law.rate(x, contact);
    else
        return {};
}

/// Relaxation rate of each member of the state [1/s].
template <class Law, class S>
constexpr typename Law::State relaxation_rate(const Law& law, const typename Law::State& x, const Contact<S>& contact) {
    if constexpr (Modulation<Law>)
        return relaxation_rate(law.law, x, law.modulated(contact));
    else if constexpr (Bristle<Law>)
        return law.relaxation_rate(x, contact);
    else
        return {};
}

/// The state within its invariant bounds.
template <class Law, class S>
constexpr typename Law::State clamped(const Law& law, const typename Law::State& x, const Contact<S>& contact) {
    if constexpr (Modulation<Law>)
        return clamped(law.law, x, law.modulated(contact));
    else if constexpr (Bristle<Law>)
        return law.clamped(x, contact);
    else
        return x;
}

/// The state with its discrete modes re-evaluated, which are constant over a step.
template <class Law, class S>
constexpr typename Law::State update_mode(const Law& law, const typename Law::State& x, const Contact<S>& contact) {
    if constexpr (Modulation<Law>)
        return update_mode(law.law, x, law.modulated(contact));
    else if constexpr (requires { law.update_mode(x, contact); })
        return law.update_mode(x, contact);
    else
        return x;
}

/// The state after `dt` [s] under one contact.
template <class Law, class S>
constexpr typename Law::State advance(const Law& law, const typename Law::State& x, const Contact<S>& contact, const S& dt) {
    if constexpr (Modulation<Law>)
        return advance(law.law, x, law.modulated(contact), dt);
    else if constexpr (Bristle<Law>)
        return law.advance(x, contact, dt);
    else
        return x;
}

/// The state after `dt` [s] under one contact, whatever the step: within its bounds, and its modes decided.
template <class Law, class S>
constexpr typename Law::State slide(const Law& law, const typename Law::State& x, const Contact<S>& contact, const S& dt) {
    return clamped(law, update_mode(law, advance(law, x, contact, dt), contact), contact);
}

/// The state of a contact that has long been sliding.
template <class Law, class S>
constexpr typename Law::State steady_state(const Law& law, const Contact<S>& contact) {
    if constexpr (Modulation<Law>)
        return steady_state(law.law, law.modulated(contact));
    else if constexpr (requires { law.steady_state(contact); })
        return law.steady_state(contact);
    else
        return {};
}

/// Torque [N.m] that opposes steady sliding, all transients gone.
template <class Law, class S>
constexpr S steady(const Law& law, const Contact<S>& contact) {
    return torque(law, steady_state(law, contact), contact.steady());
}

}  // namespace strainwave::friction
