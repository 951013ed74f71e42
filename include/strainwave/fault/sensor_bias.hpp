#pragma once
#include <strainwave/fault/fault.hpp>

namespace strainwave::fault {

/// Quantity that a sensor measures, other than the angles of the encoders.
enum class Quantity { current, torque, input_speed, output_speed };
constexpr Array<const char*, 4> choices(Quantity) { return {{"current", "torque", "input_speed", "output_speed"}}; }

template <class S>
struct SensorBias {
    S severity{1.0};
    Quantity quantity{Quantity::current};
    S offset{0.1};

    static constexpr auto name = "sensor_bias";
    static constexpr auto mode = "Bias or drift of a sensor of current, torque or speed";
    static constexpr auto effect = "the controller sees a value that is wrong by a constant";
    static constexpr auto signal = "the reading at rest and without load; a mean that does not change with the direction of motion";
    static constexpr auto source = "definition; the amount is assumed";
    static constexpr auto doc = R"(
        Constant offset of a sensor. A drift is a bias with an onset that grows.

        .. math:: y \leftarrow y + s\, y_0

        with s = severity, y_0 = offset in the unit of ``quantity``: A, N.m or rad/s. At severity 1 the reading is wrong by y_0.
        An ideal sensor becomes a ``sensor.Gain``. Only controllers see sensors: a recording shows the quantities themselves, and
        the bias shows in it as far as the controller reacts. Within one run it is constant.

        >>> from strainwave.fault import Facts, SensorBias
        >>> SensorBias(quantity="current", offset=0.2, severity=0.5).changes(Facts())[0][:4]
        ('sensors.current', 'offset', 'add', 0.1))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, severity, "1", "Share s of the offset", 0, 1));
        visit(SW_FIELD(m, quantity, "1", "Quantity that the sensor measures"));
        visit(SW_FIELD(m, offset, "1", "Offset y_0 at severity 1, in the unit of the measured quantity"));
    }

    template <class Visit>
    constexpr void changes(const Facts<S>&, Visit&& visit) const {
        constexpr Array<const char*, 4> places{
            {"sensors.current", "sensors.torque", "sensors.input_speed", "sensors.output_speed"}};
        visit(add(places[int(quantity)], "offset", severity * offset, "gain"));
    }
};

}  // namespace strainwave::fault
