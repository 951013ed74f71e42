#pragma once
#include <strainwave/motor/rotor.hpp>

namespace strainwave::motor {

template <class S>
struct CurrentSource {
    S torque_constant{0.05};
    S inertia{1e-5};
    S resistance{0.0};

    static constexpr auto name = "current_source";
    static constexpr auto actuation = "current";
    static constexpr auto source = "definition";
    static constexpr auto doc = R"(
        Motor with an ideal current controller: the current equals its command, at any speed.

        .. math:: i = u, \qquad \tau = K_m i

        with u the actuation of the controller [A], K_m = torque_constant. The resistance has one effect: the heat of the
        current. Leaves out the limit of the supply, which lowers the current at high speed.

        >>> from strainwave.motor import CurrentSource
        >>> CurrentSource(torque_constant=0.1).torque_constant
        0.1)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, torque_constant, "N.m/A", "Torque per current K_m", 0));
        visit(SW_FIELD(m, inertia, "kg.m2", "Rotor inertia", 0));
        visit(SW_FIELD(m, resistance, "Ohm", "Resistance of the winding", 0));
    }

    using State = Stateless<S>;
    struct Output {
        S current;

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, current, "A", "Motor current"));
        }
    };

    constexpr S torque(const State&, const S& asked, const Rotor<S>&) const { return torque_constant * asked; }
    constexpr S current(const State&, const S& asked, const Rotor<S>&) const { return asked; }
    constexpr Output output(const State&, const S& asked, const Rotor<S>&) const { return {asked}; }
    constexpr Power<S> power(const State& x, const S& asked, const Rotor<S>& rotor) const {
        const S lost = resistance * asked * asked;
        return {torque(x, asked, rotor) * rotor.speed + lost, lost, S(0.0)};
    }
    constexpr State rate(const State&, const S&, const Rotor<S>&) const { return {}; }
    constexpr State relaxation_rate() const { return {}; }
};

}  // namespace strainwave::motor
