#pragma once
#include <strainwave/fault/fault.hpp>

namespace strainwave::fault {

template <class S>
struct InverterDeadTime {
    S severity{1.0};
    S voltage{1.0};

    static constexpr auto name = "inverter_dead_time";
    static constexpr auto mode = "Dead time of the inverter that is not compensated";
    static constexpr auto effect = "each phase loses voltage against its current; the current is distorted at its zeros";
    static constexpr auto signal =
        "order 6 p of the input in motor current and torque, less where a current loop is fast; voltage per current";
    static constexpr auto source = "JeongPark1991; the voltage at severity 1 is assumed";
    static constexpr auto doc = R"(
        Inverter with a longer dead time between its switches, or without compensation of it.

        .. math:: V \leftarrow V + s\, \Delta V

        with s = severity, Delta V = voltage, V the dead_time_voltage of a PMSM, p the number of its pole pairs. The voltage is that
        of the supply times dead time times switching frequency: 48 V, 1 us and 20 kHz give 0.96 V.

        >>> from strainwave.fault import Facts, InverterDeadTime
        >>> InverterDeadTime(severity=0.5).changes(Facts())[0][:4]
        ('motor', 'dead_time_voltage', 'add', 0.5))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, severity, "1", "Share s of the voltage", 0, 1));
        visit(SW_FIELD(m, voltage, "V", "Voltage Delta V that a phase loses at severity 1", 0));
    }

    template <class Visit>
    constexpr void changes(const Facts<S>&, Visit&& visit) const {
        visit(add(motor_place, "dead_time_voltage", severity * voltage, "pmsm"));
    }
};

}  // namespace strainwave::fault
