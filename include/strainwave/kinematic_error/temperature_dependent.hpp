#pragma once
#include <strainwave/compiled.hpp>
#include <strainwave/kinematic_error/fourier.hpp>
#include <strainwave/kinematic_error/steepest.hpp>
#include <strainwave/room_temperature.hpp>

namespace strainwave::kinematic_error {

template <class S, class Law = Fourier<S>>
struct TemperatureDependent {
    static constexpr int capacity = 16;

    Law law{};
    Sequence<S, capacity> order{};
    Sequence<S, capacity> change{};
    Sequence<S, capacity> phase{};
    S temperature{room_temperature};
    S reference_temperature{room_temperature};

    static constexpr auto name = "temperature_dependent";
    static constexpr auto source = SW_REVIEW
        ", last section, which asks for a model that is valid over the temperature and gives none: here the first term of the "
        "expansion in the difference of temperature; the rates are the user's";
    static constexpr auto doc = R"(
        Kinematic error whose amplitudes and phases change with the temperature of the gear.

        .. math:: e(\theta, T) = e_0(\theta) + (T - T_0) \sum_h a_h \sin(B_h \theta + \psi_h)

        with theta the input angle, e_0 the error of ``law`` at T_0 = reference_temperature, T = temperature, a_h = change,
        B_h = order, psi_h = phase; up to 16 harmonics. A harmonic of ``law`` of the same order, with amplitude A and phase phi,
        changes to first order by a_h cos(psi_h - phi) (T - T_0) in amplitude and by a_h sin(psi_h - phi) (T - T_0) / A in
        phase. The sine and the cosine part are exactly linear in T, as of sources of error that add up, some of which grow with
        the expansion of the parts. Valid over the range of temperatures at which the error was measured.

        In a run, T is the temperature of the gear, which a thermal model changes. As the error changes at a standstill, it moves
        the shafts against the spring, and does the work that an EnergyMeter has as that of the kinematic error. ``temperature`` is
        T where no run gives one: of the law by itself, and of the model in a controller.
        No catalogue gives the rates; ``sw.orders.error_over_temperature`` fits them to records at several temperatures.

        >>> from strainwave.kinematic_error import Fourier, TemperatureDependent
        >>> law = TemperatureDependent(law=Fourier(order=[2], amplitude=[3e-4], phase=[0]), order=[2], change=[2e-6], phase=[0])
        >>> round(law.slope(0.0), 9), round(law.replace(temperature=323.15).slope(0.0), 9)
        (0.0006, 0.00072))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, law, "The error at the reference temperature"));
        visit(SW_FIELD(m, order, "1", "Order B_h of a change: periods per input revolution", 0));
        visit(SW_FIELD(m, change, "rad/K", "Amplitude a_h of the change of the error per kelvin", 0));
        visit(SW_FIELD(m, phase, "rad", "Phase psi_h of that change"));
        visit(SW_FIELD(m, temperature, "K", "Temperature T of the law by itself and in a controller; a run has its own", smallest));
        visit(SW_FIELD(m, reference_temperature, "K", "Temperature T_0 at which the error is that of the law", smallest));
    }

    constexpr const char* problem() const {
        return order.count == change.count && order.count == phase.count
                   ? nullptr
                   : "order, change and phase must have equally many elements";
    }

    template <class Inner>
    struct Compiled {
        Inner at_reference;
        Harmonics<S, capacity> change;
        S temperature, reference_temperature;
        bool changes;

        constexpr S side(const Angle<S>& angle) const { return kinematic_error::side<S>(at_reference, angle); }
        constexpr bool follows_temperature() const { return changes; }
        constexpr Error<S> at(const Angle<S>& angle) const { return warmed(angle, temperature); }
        constexpr Error<S> warmed(const Angle<S>& angle, const S& warm) const {
            const Error<S> base = at_reference.at(angle);
            const auto [value, slope] = change.at(angle);
            const S warmer = warm - reference_temperature;
            return {base.value + warmer * value, base.slope + warmer * slope};
        }
        constexpr S per_kelvin(const Angle<S>& angle) const { return change.at(angle).value; }
    };

    constexpr auto compile() const {
        return Compiled<decltype(compiled(law))>{compiled(law), Harmonics<S, capacity>::of(order, change, phase), temperature,
                                                 reference_temperature, follows_temperature()};
    }

    constexpr S side(const Angle<S>& angle) const { return compile().side(angle); }
    constexpr bool follows_temperature() const { return order.count > 0; }
    constexpr Error<S> at(const Angle<S>& angle) const { return compile().at(angle); }
    constexpr Error<S> warmed(const Angle<S>& angle, const S& warm) const { return compile().warmed(angle, warm); }
    constexpr S per_kelvin(const Angle<S>& angle) const { return compile().per_kelvin(angle); }

    /// Upper bound of the magnitude of the slope [rad/rad], at its own temperature.
    constexpr S steepest() const {
        S sum = kinematic_error::steepest<S>(law);
        for (int h = 0; h < order.count; ++h) sum = sum + abs((temperature - reference_temperature) * order[h] * change[h]);
        return sum;
    }
};

}  // namespace strainwave::kinematic_error
