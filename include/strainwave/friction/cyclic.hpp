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

    static constexpr auto name = "cyclic";
    static constexpr auto source = "document R, section 2, cyclic part of the friction torque; erratum E-R7";
    static constexpr auto doc = R"(
        Friction that varies with the angle, in harmonics of one turn.

        .. math:: F = f(\theta)\, F_{law}, \qquad f(\theta) = 1 + \sum_h A_h \sin(B_h \theta + \varphi_h) \ge 0

        with theta the angle of the place it acts on, B_h = order, A_h = amplitude relative to the mean, phi_h = phase, law the
        friction that is modulated. f multiplies its dry levels (Coulomb, breakaway) and its viscous torque; a bristle keeps
        its stiffness. Up to 16 harmonics. f is zero where the sum falls below zero.

        Document R prints (A + B v) f(theta), which drives a reversed motion. It must read (A sgn v + B v) f(theta) (E-R7).
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
    }

    constexpr const char* problem() const {
        return order.count == amplitude.count && order.count == phase.count
                   ? nullptr
                   : "order, amplitude and phase must have equally many elements";
    }

    using State = typename Law::State;

    /// Factors of friction at its angle.
    struct Modulator {
        Harmonics<S, capacity> sum;
        S most;

        constexpr Factors<S> factors(const Contact<S>& contact) const {
            const S factor = max(S(1.0) + sum.at(contact.angle).value, S(0.0));
            return {factor, most, factor};
        }
    };
    constexpr Modulator modulator() const {
        S most{1.0};
        for (int h = 0; h < amplitude.count; ++h) most = most + amplitude[h];
        return {Harmonics<S, capacity>::of(order, amplitude, phase), most};
    }

    constexpr auto compile() const { return Modulated<S, decltype(compiled(law)), Modulator>{modulator(), compiled(law)}; }

    constexpr Contact<S> modulated(const Contact<S>& contact) const { return contact.scaled(modulator().factors(contact)); }
};

}  // namespace strainwave::friction
