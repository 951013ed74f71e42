#pragma once
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>

namespace strainwave::hysteresis {

template <class S>
struct FadingMemory {
    S stiffness{0.0};
    S forgetting{1e3};

    static constexpr auto name = "fading_memory";
    static constexpr auto source = "document R, section 4a; Dahl1968 (order 1); erratum E-R10";
    static constexpr auto doc = R"(
        Hysteresis that forgets exponentially with the twist travelled.

        .. math:: dT = A\, d\delta - \alpha T |d\delta|

        with delta the twist, A = stiffness, alpha = forgetting. Exact over any monotone step: with s the sense of motion,
        T approaches s A / alpha as exp(-alpha |Delta delta|). Rate-independent: document R calls it rate-dependent (E-R10).
        Identical with Dahl's model of order 1. Its minor loops do not close, unlike those of a gear: prefer MaxwellSlip where
        small reversals matter.

        >>> from strainwave.hysteresis import FadingMemory
        >>> FadingMemory(stiffness=1000.0, forgetting=2000.0).trace([0.0, 0.002, -0.001]).round(6)
        array([ 0.      ,  0.490842, -0.497544]))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, stiffness, "N.m/rad", "Stiffness A right after a reversal from zero torque", 0));
        visit(SW_FIELD(m, forgetting, "1/rad", "Rate alpha at which the twist travelled is forgotten", smallest));
    }

    struct State {
        S held{0.0};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, held, "N.m", "Torque T held"));
        }
    };

    /// The memory after the twist has moved by `increment` [rad], monotonically.
    constexpr State advance(const State& x, const S& increment) const {
        const S settled = sign(increment) * stiffness / forgetting;
        return {settled + (x.held - settled) * exp(-forgetting * abs(increment))};
    }

    /// Torque [N.m] once the twist has moved by `increment` [rad]; the state stays as it is.
    constexpr S torque(const State& x, const S& increment) const { return advance(x, increment).held; }

    /// Work [J] put in while the twist moves by `increment` [rad], monotonically.
    constexpr S work(const State& x, const S& increment) const {
        const S settled = stiffness / forgetting, sense = sign(increment), path = abs(increment);
        return settled * path + (sense * x.held - settled) * (S(1.0) - exp(-forgetting * path)) / forgetting;
    }
};

}  // namespace strainwave::hysteresis
