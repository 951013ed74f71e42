#pragma once
#include <strainwave/compiled.hpp>
#include <strainwave/control/law.hpp>
#include <strainwave/fastest.hpp>

namespace strainwave {

/// The state of each sensor of a drive.
template <class S, class InputAngle, class InputSpeed, class OutputAngle, class OutputSpeed, class Current, class Torque>
struct SensorStates {
    InputAngle input_angle{};
    InputSpeed input_speed{};
    OutputAngle output_angle{};
    OutputSpeed output_speed{};
    Current current{};
    Torque torque{};

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, input_angle, "State of the sensor of the input angle"));
        visit(SW_PART(m, input_speed, "State of the sensor of the input speed"));
        visit(SW_PART(m, output_angle, "State of the sensor of the output angle"));
        visit(SW_PART(m, output_speed, "State of the sensor of the output speed"));
        visit(SW_PART(m, current, "State of the sensor of the current"));
        visit(SW_PART(m, torque, "State of the sensor of the torque"));
    }
};

template <class S, class InputAngle, class InputSpeed = InputAngle, class OutputAngle = InputAngle, class OutputSpeed = InputAngle,
          class Current = InputAngle, class Torque = InputAngle>
struct Sensors {
    InputAngle input_angle{};
    InputSpeed input_speed{};
    OutputAngle output_angle{};
    OutputSpeed output_speed{};
    Current current{};
    Torque torque{};

    static constexpr auto name = "sensors";
    static constexpr auto source = "definition";
    static constexpr auto doc = R"(
        Sensors of the controller of a drive: one for each quantity.

        Recordings contain the true quantities, not the readings of the sensors.

        >>> import strainwave as sw
        >>> sensors = sw.Sensors(output_angle=sw.sensor.FirstOrder(time_constant=2e-3))
        >>> sensors.output_angle.time_constant
        0.002)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, input_angle, "Sensor of the input angle: the motor's encoder"));
        visit(SW_PART(m, input_speed, "Sensor of the input speed"));
        visit(SW_PART(m, output_angle, "Sensor of the output angle"));
        visit(SW_PART(m, output_speed, "Sensor of the output speed"));
        visit(SW_PART(m, current, "Sensor of the motor current"));
        visit(SW_PART(m, torque, "Sensor of the torque transmitted, at the output"));
    }

    constexpr auto compile() const {
        return Sensors<S, decltype(compiled(input_angle)), decltype(compiled(input_speed)), decltype(compiled(output_angle)),
                       decltype(compiled(output_speed)), decltype(compiled(current)), decltype(compiled(torque))>{
            compiled(input_angle),  compiled(input_speed), compiled(output_angle),
            compiled(output_speed), compiled(current),     compiled(torque)};
    }

    using States = SensorStates<S, typename InputAngle::State, typename InputSpeed::State, typename OutputAngle::State,
                                typename OutputSpeed::State, typename Current::State, typename Torque::State>;
    static constexpr bool stateless = size_of<S, States> == 0;
    using State = typename detail::Either<stateless, Stateless<S>, States>::type;
    using Measurement = control::Measurement<S>;

    constexpr State initial_state() const {
        return each([](const auto& sensor, const S&) { return strainwave::initial_state(sensor); }, Measurement{});
    }
    /// Readings of the sensors at the true quantities.
    constexpr Measurement shown(const State& x, const Measurement& actual) const {
        if constexpr (stateless)
            return shown_by(States{}, actual);
        else
            return shown_by(x, actual);
    }
    constexpr State rate(const State& x, const Measurement& actual) const {
        if constexpr (stateless)
            return {};
        else
            return {input_angle.rate(x.input_angle, actual.input_angle),
                    input_speed.rate(x.input_speed, actual.input_speed),
                    output_angle.rate(x.output_angle, actual.output_angle),
                    output_speed.rate(x.output_speed, actual.output_speed),
                    current.rate(x.current, actual.current),
                    torque.rate(x.torque, actual.torque)};
    }
    constexpr State relaxation_rate() const {
        return each([](const auto& sensor, const S&) { return sensor.relaxation_rate(); }, Measurement{});
    }
    constexpr S fastest() const {
        const S input = max(one(input_angle), one(input_speed)), output = max(one(output_angle), one(output_speed));
        return max(max(input, output), max(one(current), one(torque)));
    }
    /// The state in which each sensor shows the true value.
    constexpr State steady_state(const Measurement& actual) const {
        return each([](const auto& sensor, const S& value) { return sensor.steady_state(value); }, actual);
    }

private:
    template <class Sensor>
    static constexpr S one(const Sensor& sensor) {
        return strainwave::fastest<S>(sensor);
    }
    constexpr Measurement shown_by(const States& x, const Measurement& actual) const {
        return {input_angle.shown(x.input_angle, actual.input_angle),
                input_speed.shown(x.input_speed, actual.input_speed),
                output_angle.shown(x.output_angle, actual.output_angle),
                output_speed.shown(x.output_speed, actual.output_speed),
                current.shown(x.current, actual.current),
                torque.shown(x.torque, actual.torque),
                actual.limits};
    }
    template <class F>
    constexpr State each(const F& f, const Measurement& of) const {
        if constexpr (stateless)
            return {};
        else
            return {f(input_angle, of.input_angle),   f(input_speed, of.input_speed), f(output_angle, of.output_angle),
                    f(output_speed, of.output_speed), f(current, of.current),         f(torque, of.torque)};
    }
};

}  // namespace strainwave
