#pragma once
#include <strainwave/compiled.hpp>
#include <strainwave/friction/stribeck.hpp>
#include <strainwave/harmonics.hpp>

namespace strainwave::friction {

template <class S, class Law_ = Stribeck<S>>
struct Cyclic {
    static constexpr int capacity = 16;
    using Law = Law_;

    Law law{};
    Sequence<S, capacity> order{};
    Sequence<S, capacity> amplitude{};
    Sequence<S, capacity> phase{};
    S viscous_share{1.0};
    Sequence<S, capacity> detent_order{};
    Sequence<S, capacity> detent_torque{};
    Sequence<S, capacity> detent_phase{};

    static constexpr auto name = "cyclic";
    static constexpr auto source = SW_REVIEW ", section 2, cyclic part of the friction torque, with the sign of the speed";
    static constexpr auto doc = R"(
        Friction that varies with the angle, in harmonics of one turn.

        .. math:: F = f(\theta)\, F_{law} + \sum_h D_h \sin(d_h \theta + \psi_h), \qquad
                  f(\theta) = 1 + \sum_h A_h \sin(B_h \theta + \varphi_h) \ge 0

        with theta the angle of the place it acts on, B_h = order, A_h = amplitude relative to the mean, phi_h = phase, law the
        friction that is modulated. f multiplies its dry levels (Coulomb, breakaway) and its viscous torque; a bristle keeps
        its stiffness. With s = viscous_share, 1 + s (f - 1) multiplies the viscous torque: 0 if only dry friction varies.
        Up to 16 harmonics. f is zero where the sum falls below zero.

        D_h = detent_torque, d_h = detent_order and psi_h = detent_phase describe a detent: a torque over the angle that has the
        same sign in both directions of motion and takes no energy over a turn. At rest it adds to the torque that drives the
        place. Valid while it is smaller than the dry friction, as that of a gear is: a larger one would turn the place by itself.

        The review prints (A + B v) f(theta), which drives a reversed motion. It must read (A sgn v + B v) f(theta).
        With law a Coulomb friction of coulomb = A and viscous = B this is that term.

        >>> from strainwave.friction import Coulomb, Cyclic
        >>> law = Cyclic(law=Coulomb(coulomb=0.25, viscous=0.0), order=[2], amplitude=[0.5], phase=[0.0])
        >>> law.steady(1.0, angle=0.25 * 3.141592653589793), law.steady(-1.0, angle=0.25 * 3.141592653589793)
        (0.375, -0.375))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, law, "Friction law that is modulated"));
        visit(SW_FIELD(m, order, "1", "Order B_h: periods per revolution", 0));
        visit(SW_FIELD(m, amplitude, "1", "Amplitude A_h, relative to the mean friction", 0));
        visit(SW_FIELD(m, phase, "rad", "Phase phi_h"));
        visit(SW_OPTIONAL(m, viscous_share, "1", "Share s of the variation that viscous friction has", 0, 1));
        visit(SW_OPTIONAL(m, detent_order, "1", "Order d_h of the detent: periods per revolution", 0));
        visit(SW_OPTIONAL(m, detent_torque, "N.m", "Amplitude D_h of the detent", 0));
        visit(SW_OPTIONAL(m, detent_phase, "rad", "Phase psi_h of the detent"));
    }

    constexpr const char* problem() const {
        if (order.count != amplitude.count || order.count != phase.count)
            return "order, amplitude and phase must have equally many elements";
        return detent_order.count == detent_torque.count && detent_order.count == detent_phase.count
                   ? nullptr
                   : "detent_order, detent_torque and detent_phase must have equally many elements";
    }

    using State = typename Law::State;

    /// Factors of friction at its angle, and the detent there.
    struct Modulator {
        Harmonics<S, capacity> sum, stored;
        S most, viscous_share;

        constexpr Factors<S> factors(const Contact<S>& contact) const {
            const S varied = sum.at(contact.angle).value;
            return {max(S(1.0) + varied, S(0.0)), most, max(S(1.0) + viscous_share * varied, S(0.0))};
        }
        constexpr S detent(const Contact<S>& contact) const { return stored.at(contact.angle).value; }
    };
    constexpr Modulator modulator() const {
        S most{1.0};
        for (int h = 0; h < amplitude.count; ++h) most = most + amplitude[h];
        return {Harmonics<S, capacity>::of(order, amplitude, phase),
                Harmonics<S, capacity>::of(detent_order, detent_torque, detent_phase), most, viscous_share};
    }

    constexpr auto compile() const { return Modulated<S, decltype(compiled(law)), Modulator>{modulator(), compiled(law)}; }

    constexpr Contact<S> modulated(const Contact<S>& contact) const { return contact.scaled(modulator().factors(contact)); }
    constexpr S detent(const Contact<S>& contact) const { return modulator().detent(contact); }
};

}  // namespace strainwave::friction
