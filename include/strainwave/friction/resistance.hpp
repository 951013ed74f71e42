#pragma once
#include <strainwave/friction/contact.hpp>

/// Action of a law of friction on its shaft, set-valued or not.
namespace strainwave::friction {

/// Torque of a friction: the part that acts at rest too, and the part that can stick.
template <class S>
struct Resistance {
    S always, sliding;
    constexpr S torque() const { return always + sliding; }  // one of them is none
};
template <class S, class Law>
constexpr Resistance<S> resistance(const Law& law, const typename Law::State& x, const Contact<S>& contact,
                                   typename Law::State& rate) {
    const auto found = response(law, x, contact);
    rate = found.rate;
    if (set_valued(law)) return {S(0.0), found.torque};
    return {found.torque, S(0.0)};
}

/// The part that can stick, alone.
template <class S, class Law>
constexpr S sliding_torque(const Law& law, const typename Law::State& x, const Contact<S>& contact) {
    return set_valued(law) ? torque(law, x, contact) : S(0.0);
}

/// Friction torque in outputs: a place that sticks balances its share of the driving torque of its side.
template <class S, class Law>
constexpr S reported(const Law& law, const Contact<S>& contact, const S& sliding, const S& share) {
    if (!set_valued(law)) return sliding;
    return select(contact.sliding == S(0.0), share * hold(law, contact.pushed(sign(share))), sliding);
}

/// Torque per angle [N.m/rad] of a friction that is about to slip.
template <class S, class Law>
constexpr S presliding_stiffness(const Law& law) {
    const S little(1e-9), soon(1e-3);  // rad/s, s: less than any bristle's reach, and more than rounding
    const Contact<S> still = Contact<S>{}.pushed(S(0.0));
    const auto bent = advance(law, typename Law::State{}, still.moving(little), soon);
    return (torque(law, bent, still) - torque(law, typename Law::State{}, still)) / (little * soon);
}

}  // namespace strainwave::friction
