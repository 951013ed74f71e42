#pragma once
#include <strainwave/kinematic_error/stochastic.hpp>

namespace strainwave::kinematic_error {

template <class S>
struct MicroSlip {
    static constexpr int waves = Spectrum<S>::waves;

    S excitation{0.0};
    S friction{1.0};
    S load_share{0.0};
    S stiffness{1e4};
    S lowest_order{8.0};
    S highest_order{40.0};
    S seed{0.0};

    static constexpr auto name = "micro_slip";
    static constexpr auto source = SW_REVIEW
        ", section on the kinematic error: micro-slip between wave generator and flexspline at low load, driven by the speed; slip "
        "of one contact: Johnson1985, section 7.2, to the first term; that the exciting torque rises in proportion to the speed, "
        "and "
        "its band, are assumed; spectral representation: ShinozukaDeodatis1991; random numbers: WichmannHill1982";
    static constexpr auto doc = R"(
        Random kinematic error by micro-slip of the wave generator in the flexspline: large at high speed and low load.

        .. math:: n(\theta) = \frac{Q |Q|}{6 k F}, \qquad Q = c\, |\omega|\, g(\theta), \qquad F = F_0 + \mu |T|, \qquad |Q| \le F

        with theta the input angle, omega the input speed, T the elastic torque at the reference temperature, c = excitation, F_0 =
        friction, mu = load_share, k = stiffness of the contact, all at the output's scale. g is random, with the root mean square
        1, in the band from lowest_order to highest_order, drawn by ``seed`` as that of Stochastic. A contact of Hertz under the
        tangential force Q below its friction F slips in an outer ring: by Mindlin it moves by 3 F / (2 k) (1 - (1 - Q / F)^(2/3)),
        of which Q / k is elastic, and Q^2 / (6 k F) the first term of the slip; the next is larger by 4 Q / (9 F). Beyond F, where
        the whole contact would slide, the slip stays F / (6 k).

        While Q stays below F, the root mean square of the error is sqrt(3) c^2 omega^2 / (6 k F) for a Gaussian g: it rises with
        the square of the speed and falls with the load. Its spectrum reaches from 0 to three times the highest order. The slip has
        no memory: the elastic flexspline returns it with the force. The work of friction in it is part of the friction of the
        gear; the numbers follow from the error measured at several speeds and loads. ``slope`` is the derivative by theta at
        constant speed and load.

        >>> from strainwave.kinematic_error import MicroSlip
        >>> noise = MicroSlip(excitation=0.01, friction=5.0, load_share=0.5, stiffness=1e4)
        >>> slow, fast = noise.error(0.3, speed=50.0), noise.error(0.3, speed=100.0)
        >>> round(fast / slow, 12), round(slow / noise.error(0.3, torque=-10.0, speed=50.0), 12)
        (4.0, 2.0))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, excitation, "N.m.s/rad", "Root mean square c of the exciting torque per input speed; 0 is no noise", 0));
        visit(SW_FIELD(m, friction, "N.m", "Friction F_0 of the contact without load", smallest));
        visit(SW_FIELD(m, load_share, "1", "Rise mu of that friction per torque transmitted", 0));
        visit(SW_FIELD(m, stiffness, "N.m/rad", "Tangential stiffness k of the contact", smallest));
        visit(SW_FIELD(m, lowest_order, "1", "Lower end of the band: periods per input revolution", 0, 1e4));
        visit(SW_FIELD(m, highest_order, "1", "Upper end of the band: periods per input revolution", smallest, 1e4));
        visit(SW_FIELD(m, seed, "1", "Seed of the random numbers, a whole number", 0, 16777215, true));
    }

    constexpr const char* problem() const {
        return all(highest_order > lowest_order) ? nullptr : "highest_order must exceed lowest_order";
    }

    using MaxChange = typename Stochastic<S>::MaxChange;

    struct Compiled {
        bool engaged = false;
        S excitation{0.0}, friction{1.0}, load_share{0.0}, compliance{0.0};  ///< compliance: 1 / (6 k), rad/(N.m)
        typename Stochastic<S>::Compiled exciting{};                         ///< g, of which only the angle matters

        constexpr bool active() const { return engaged; }

        constexpr Error<S> at(const Angle<S>& angle, const S& torque, const S& speed) const {
            if (!engaged) return {};
            const Error<S> excited = exciting.at(angle, S(0.0), S(0.0));
            const S amplitude = force(speed), limit = holding(torque), share = shared(excited.value, amplitude, limit);
            const S slope = select(abs(share) < S(1.0), S(2.0) * compliance * abs(share) * amplitude, S(0.0));
            return {compliance * limit * share * abs(share), slope * excited.slope};
        }
        /// Rate of the error [rad/s] at a constant angle.
        constexpr S drift(const Angle<S>& angle, const S& torque, const S& torque_rate, const S& speed,
                          const S& acceleration) const {
            const S excited = exciting.at(angle, S(0.0), S(0.0)).value, limit = holding(torque);
            const S share = shared(excited, force(speed), limit), hold_rate = load_share * sign(torque) * torque_rate;
            const S by_force = S(2.0) * abs(share) * excited * excitation * sign(speed) * acceleration;
            const S partial = by_force - share * abs(share) * hold_rate;
            return compliance * select(abs(share) < S(1.0), partial, share * hold_rate);
        }
        /// At rest nothing slips.
        constexpr MaxChange max_change() const { return {S(0.0), S(0.0), S(0.0)}; }

    private:
        constexpr S force(const S& speed) const { return min(excitation * abs(speed), S(1e30)); }
        constexpr S holding(const S& torque) const { return friction + load_share * min(abs(torque), S(1e30)); }
        /// The exciting torque over the friction, within [-1, 1].
        static constexpr S shared(const S& excited, const S& amplitude, const S& limit) {
            return clip(amplitude * excited / limit, S(-1.0), S(1.0));
        }
    };

    /// True if the law has an effect, or a derivative by its parameters.
    constexpr bool active() const { return is_differentiated(excitation) || any(excitation > S(0.0)); }

    constexpr Compiled compile() const {
        Compiled law{active(), excitation, friction, load_share, S(1.0 / 6.0) / stiffness};
        if (!law.engaged) return law;
        Stochastic<S> unit{};
        unit.amplitude = S(1.0);
        unit.lowest_order = lowest_order;
        unit.highest_order = highest_order;
        unit.seed = seed;
        law.exciting = unit.compile();
        return law;
    }

    constexpr Error<S> at(const Angle<S>& angle, const S& torque, const S& speed) const {
        return compile().at(angle, torque, speed);
    }
    constexpr S drift(const Angle<S>& angle, const S& torque, const S& torque_rate, const S& speed, const S& acceleration) const {
        return compile().drift(angle, torque, torque_rate, speed, acceleration);
    }
    constexpr MaxChange max_change() const { return compile().max_change(); }
};

}  // namespace strainwave::kinematic_error
