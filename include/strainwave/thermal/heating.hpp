#pragma once
#include <strainwave/field.hpp>
#include <strainwave/room_temperature.hpp>
#include <strainwave/thermal/thermal.hpp>

namespace strainwave::thermal {

template <class S>
struct Heating {
    S winding_capacity{100.0};
    S winding_resistance{1.0};
    S gear_capacity{500.0};
    S gear_resistance{1.0};
    S coupling{0.0};
    S initial_temperature{room_temperature};

    static constexpr auto name = "heating";
    static constexpr auto source = "definition: two bodies of one temperature each; Newton1701 for what they give to the air";
    static constexpr auto doc = R"(
        Two thermal masses, winding and gear, heated by the losses of motor and gear.

        .. math:: C_w \dot T_w = P_w - \frac{T_w - T}{R_w} - G\,(T_w - T_g), \qquad
                  C_g \dot T_g = P_g - \frac{T_g - T}{R_g} + G\,(T_w - T_g)

        with T the temperature of the run, which is the ambient one; P_w the loss of the motor; P_g the loss by friction at all
        three places, damping and hysteresis; C_w, C_g = winding_capacity, gear_capacity, R_w, R_g = winding_resistance,
        gear_resistance towards the air, G = coupling between both. All begin at initial_temperature. Energy that the
        hysteresis stores counts as heat at once, which is the same over a cycle. Leaves out the little heat from elastic
        energy of a softening spring.

        Data sheets of motors give R_w and the time constant R_w C_w. For a gear the values follow from a record of the
        temperature of its housing.

        >>> from strainwave.thermal import Heating
        >>> body = Heating(winding_capacity=120.0, winding_resistance=2.5, gear_capacity=600.0, gear_resistance=0.8)
        >>> body.winding_capacity * body.winding_resistance  # time constant, s
        300.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_REQUIRED(m, winding_capacity, "J/K", "Heat capacity C_w of the winding", smallest));
        visit(SW_REQUIRED(m, winding_resistance, "K/W", "Thermal resistance R_w from winding to air", smallest));
        visit(SW_REQUIRED(m, gear_capacity, "J/K", "Heat capacity C_g of the gear", smallest));
        visit(SW_REQUIRED(m, gear_resistance, "K/W", "Thermal resistance R_g from gear to air", smallest));
        visit(SW_FIELD(m, coupling, "W/K", "Heat flow G from winding to gear per difference of temperature", 0));
        visit(SW_FIELD(m, initial_temperature, "K", "Temperature of both at the start of a run", smallest));
    }

    struct State {
        S winding_temperature{room_temperature}, gear_temperature{room_temperature};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, winding_temperature, "K", "Temperature of the winding"));
            visit(SW_FIELD(m, gear_temperature, "K", "Temperature of the gear"));
        }
    };
    struct Output {
        S winding_temperature;

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, winding_temperature, "K", "Temperature of the winding"));
        }
    };
    static constexpr bool active() { return true; }

    constexpr State initial_state() const { return {initial_temperature, initial_temperature}; }
    constexpr Temperatures<S> at(const State& x, const S&) const { return {x.winding_temperature, x.gear_temperature}; }
    constexpr State rate(const State& x, const Heat<S>& heat, const S& ambient) const {
        const S exchanged = coupling * (x.winding_temperature - x.gear_temperature);
        return {(heat.winding - (x.winding_temperature - ambient) / winding_resistance - exchanged) / winding_capacity,
                (heat.gear - (x.gear_temperature - ambient) / gear_resistance + exchanged) / gear_capacity};
    }
    /// A Runge-Kutta step of fourth order is stable up to 2.78 times the time of a decay. Not taken exactly, so that bodies gain
    /// what the others lose to rounding.
    constexpr S fastest() const {
        const S winding = (S(1.0) / winding_resistance + S(2.0) * coupling) / winding_capacity;
        return max(winding, (S(1.0) / gear_resistance + S(2.0) * coupling) / gear_capacity) / S(2.5);
    }
    constexpr S gear_rate(const State& rate, const S&) const { return rate.gear_temperature; }
    constexpr Output output(const State& x, const S&) const { return {x.winding_temperature}; }
};

}  // namespace strainwave::thermal
