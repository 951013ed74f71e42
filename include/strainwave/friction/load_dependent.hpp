#pragma once
#include <strainwave/friction/contact.hpp>

namespace strainwave::friction {

template <class S>
struct LoadDependent {
    S driving_forward{0.0};
    S driving_reverse{0.0};
    S backdriving_forward{0.0};
    S backdriving_reverse{0.0};

    static constexpr auto name = "load_dependent";
    static constexpr auto source = "Coulomb1785: friction proportional to load; one ratio for each quadrant, assumed";
    static constexpr bool odd = false;
    static constexpr auto doc = R"(
        Friction proportional to the torque transmitted, one ratio for each quadrant, set-valued at rest.

        .. math:: F = \mu |T| \operatorname{sgn} v \quad (v \ne 0), \qquad |F| \le \mu |T| \quad (v = 0)

        with v the speed of the place it acts on, T the torque it transmits (load), mu the ratio of the quadrant: if T v > 0
        the power flows to the output, and mu = driving_forward for v > 0, driving_reverse for v < 0; if T v < 0 it flows back
        to the input, and mu = backdriving_forward for v > 0, backdriving_reverse for v < 0. At rest the quadrant is that of
        the motion that is about to begin.

        T is the torque on the side of the output. The efficiency is 1 / (1 + mu) when driving and 1 - mu when back-driven.
        With backdriving mu >= 1 the output cannot turn the input (self-locking). A stiffness multiplied by the efficiency
        would create energy when back-driven. Leaves out the loss of an idle gear.

        >>> from strainwave.friction import LoadDependent
        >>> LoadDependent(driving_forward=0.25, backdriving_reverse=0.5).steady([10.0, -10.0], load=4.0)
        array([ 1., -2.]))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, driving_forward, "1", "Loss per torque transmitted, at positive speed under positive load", 0));
        visit(SW_FIELD(m, driving_reverse, "1", "Loss per torque transmitted, at negative speed under negative load", 0));
        visit(SW_FIELD(m, backdriving_forward, "1", "Loss per torque transmitted, at positive speed under negative load", 0));
        visit(SW_FIELD(m, backdriving_reverse, "1", "Loss per torque transmitted, at negative speed under positive load", 0));
    }

    using State = Stateless<S>;

    /// Torque that opposes sliding, in N.m.
    constexpr S torque(const State&, const Contact<S>& contact) const { return level(contact, contact.sliding); }

    /// The largest torque it balances at rest, in N.m.
    constexpr S hold(const Contact<S>& contact) const { return level(contact, S(1.0)); }

private:
    /// Towards `sense`; the load comes last, so that no product overflows before the whole does.
    constexpr S level(const Contact<S>& contact, const S& sense) const {
        const auto positive = contact.load > S(0.0);
        const S forward = select(positive, driving_forward, backdriving_forward);
        const S reverse = select(positive, backdriving_reverse, driving_reverse);
        return sense * contact.dry * select(contact.sliding < S(0.0), reverse, forward) * abs(contact.load);
    }
};

}  // namespace strainwave::friction
