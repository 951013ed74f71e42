#pragma once
#include <strainwave/compiled.hpp>
#include <strainwave/condition.hpp>
#include <strainwave/stiffness/cubic.hpp>

namespace strainwave {

namespace stiffness {

template <class S, class Law_ = Cubic<S>>
struct Backlash {
    using Law = Law_;

    Law law{};
    S clearance{0.0};

    static constexpr auto name = "backlash";
    static constexpr auto source = SW_ACTUATOR_PAPER ", kinematic error: \"a constant component, related to clearance\"";
    static constexpr auto doc = R"(
        Spring behind play: no torque within the clearance, the torque of the spring beyond it.

        .. math:: T = T_{law}(\delta - p), \qquad p = \min(\max(\delta, -c/2), c/2)

        with delta the twist, p the play taken up, c = clearance, ``law`` any spring without play. Torque, stiffness and energy
        are 0 within the play. The two flanks are c apart at zero torque; a lost-motion test measures c in addition to the
        twist of the spring. The stiffness jumps at the flanks, where it is that of the spring. A torque of exactly 0 has the
        twist 0. With c = 0 the law is the spring itself.

        No energy is lost: flanks meet elastically. Losses of an impact are those of ``damping`` and friction of the gear,
        which also act within the play. Steps must be short against the period of the spring of a flank. Strain wave gears are
        sold as free of backlash, because their teeth are preloaded. Use this law for worn gears, for badly fitted ones, and
        for couplings between the gear and its load.

        >>> from strainwave.stiffness import Backlash, Linear
        >>> spring = Backlash(law=Linear(k=1e4), clearance=2e-4)
        >>> spring.torque([0.0, 1e-4, 3e-4]).round(9), round(spring.twist(2.0), 9)
        (array([0., 0., 2.]), 0.0003))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, law, "The spring behind the play"));
        visit(SW_REQUIRED(m, clearance, "rad", "Play c at the output, from flank to flank", 0));
    }

    constexpr auto compile() const { return Backlash<S, decltype(compiled(law))>{compiled(law), clearance}; }

    constexpr S torque(const S& twist) const { return law.torque(sprung(twist)); }
    constexpr S twist(const S& torque) const { return law.twist(torque) + sign(torque) * half(); }
    constexpr S tangent(const S& twist) const { return select(abs(twist) < half(), S(0.0), law.tangent(sprung(twist))); }
    constexpr S energy(const S& twist) const { return law.energy(sprung(twist)); }

    template <class Where>
    constexpr bool bounded() const {
        return strainwave::bounded<Where>(law);
    }
    /// Range in which its spring is valid, as twists of the gear.
    constexpr Domain<S> domain(const S& twist) const {
        Domain<S> valid = strainwave::domain<S>(law, sprung(twist));
        if (!strainwave::bounded<S>(law)) return valid;
        return {valid.name, twist, valid.low - half(), valid.high + half(), valid.unit, valid.remedy};
    }

private:
    constexpr S half() const { return S(0.5) * clearance; }
    /// Share of the spring in a twist.
    constexpr S sprung(const S& twist) const { return twist - clip(twist, -half(), half()); }
};

}  // namespace stiffness
}  // namespace strainwave
