#pragma once
#include <strainwave/control/reference.hpp>
#include <strainwave/friction/contact.hpp>
#include <strainwave/gear.hpp>

namespace strainwave {

/// What drives a drive from outside, at one instant.
template <class S>
struct Input {
    S command{0.0};
    S command_rate{0.0};
    S load_torque{0.0};  ///< N.m, added to the load's own

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, command, "1", "Command: output angle [rad] of a controlled drive, voltage [V] of an open loop"));
        visit(SW_FIELD(m, command_rate, "1/s", "Time derivative of the command"));
        visit(SW_FIELD(m, load_torque, "N.m", "Torque that holds the output back, besides the load's own"));
    }
};

/// What flows continuously. The transmission error theta_in / i - theta_out replaces the output angle.
template <class S, class MotorState, class ControlState, class FrictionInputState, class FrictionOutputState>
struct Motion {
    MotorState motor{};
    ControlState control{};
    S input_angle{0.0};
    S input_speed{0.0};
    S transmission_error{0.0};
    S output_speed{0.0};
    FrictionInputState friction_input{};
    FrictionOutputState friction_output{};

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, motor, "State of the motor"));
        visit(SW_PART(m, control, "State of the controller"));
        visit(SW_FIELD(m, input_angle, "rad", "Input angle within the turn, in [-pi, pi]"));
        visit(SW_FIELD(m, input_speed, "rad/s", "Input speed"));
        visit(SW_FIELD(m, transmission_error, "rad", "theta_in / i - theta_out"));
        visit(SW_FIELD(m, output_speed, "rad/s", "Output speed"));
        visit(SW_PART(m, friction_input, "State of the friction at the input"));
        visit(SW_PART(m, friction_output, "State of the friction at the output"));
    }
};

/// A drive at one instant: the motion, and what it remembers of the past.
template <class S, class Motion, class HysteresisState>
struct State {
    Motion motion{};
    HysteresisState hysteresis{};
    S held_twist{0.0};
    S turns{0.0};
    S sliding_input{1.0};
    S sliding_output{1.0};

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, motion, "What flows continuously"));
        visit(SW_PART(m, hysteresis, "Memory of the hysteresis"));
        visit(SW_FIELD(m, held_twist, "rad", "Twist at which the hysteresis was last brought up to date"));
        visit(SW_FIELD(m, turns, "1", "Whole revolutions of the input"));
        visit(SW_FIELD(m, sliding_input, "1", "Sense of sliding at the input, 0 while it sticks"));
        visit(SW_FIELD(m, sliding_output, "1", "Sense of sliding at the output, 0 while it sticks"));
    }
};

/// Everything worth recording, at one instant.
template <class S>
struct Output {
    S command, input_angle, input_speed, output_angle, output_speed, twist, kinematic_error, transmission_error, torque, current,
        voltage, friction_input, friction_output, load_torque;

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, command, "1", "Command"));
        visit(SW_FIELD(m, input_angle, "rad", "Input angle"));
        visit(SW_FIELD(m, input_speed, "rad/s", "Input speed"));
        visit(SW_FIELD(m, output_angle, "rad", "Output angle"));
        visit(SW_FIELD(m, output_speed, "rad/s", "Output speed"));
        visit(SW_FIELD(m, twist, "rad", "Elastic twist of the gear, at the output"));
        visit(SW_FIELD(m, kinematic_error, "rad", "Pure kinematic error, at the output"));
        visit(SW_FIELD(m, transmission_error, "rad", "Total error theta_in / i - theta_out"));
        visit(SW_FIELD(m, torque, "N.m", "Torque transmitted, at the output"));
        visit(SW_FIELD(m, current, "A", "Motor current"));
        visit(SW_FIELD(m, voltage, "V", "Motor voltage"));
        visit(SW_FIELD(m, friction_input, "N.m", "Friction torque at the input, opposing its motion"));
        visit(SW_FIELD(m, friction_output, "N.m", "Friction torque at the output, opposing its motion"));
        visit(SW_FIELD(m, load_torque, "N.m", "Torque of the load, holding the output back"));
    }
};

/// Inertia of a body that has one.
template <class Body>
constexpr auto inertia_of(const Body& body)
    requires requires { body.inertia; }
{
    return body.inertia;
}

template <class S, class Gear, class Motor, class Control, class Load>
struct PositionDrive {
    Gear gear{};
    Motor motor{};
    Control control{};
    Load load{};

    static constexpr auto name = "position_drive";
    static constexpr auto source = "document P, eqs. of motion, with r = 1/100 (E-P1) in the motor equation too (E-P2)";
    static constexpr auto doc = R"(
        A motor, its controller, one strain wave gear and a load.

        .. math:: J_{in} \ddot\theta_{in} = K_m i - T\,(1/i - e') - F_{in}, \qquad
                  J_{out} \ddot\theta_{out} = T - T_{load} - F_{out}

        with J_in = motor.inertia + gear.input_inertia, J_out = load.inertia, T and e' of the gear, F the friction of each side.
        Angles are carried relative to the rigid motion, so an hour of rotation is as accurate as a second.

        >>> import strainwave as sw
        >>> drive = sw.drives.PositionDrive(motor=sw.motor.DC(resistance=2.0), load=sw.loads.Inertia(inertia=0.005))
        >>> drive.motor.resistance
        2.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, gear, "The gear"));
        visit(SW_PART(m, motor, "The motor on the input shaft"));
        visit(SW_PART(m, control, "What turns the command into the motor's voltage"));
        visit(SW_PART(m, load, "What the output shaft carries"));
    }

    constexpr const char* problem() const {
        return all(inertia_of(motor) + gear.input_inertia > S(0.0))
                   ? nullptr
                   : "motor.inertia and gear.input_inertia cannot both be 0: something must turn at the input";
    }

    constexpr auto compile() const {
        return PositionDrive<S, decltype(gear.compile()), decltype(compiled(motor)), Control, Load>{gear.compile(), compiled(motor),
                                                                                                    control, load};
    }

    using FrictionInput = decltype(Gear{}.friction_input);
    using FrictionOutput = decltype(Gear{}.friction_output);
    using Hysteresis = decltype(Gear{}.hysteresis);

    using Motion = strainwave::Motion<S, typename Motor::State, typename Control::State, typename FrictionInput::State,
                                      typename FrictionOutput::State>;
    using State = strainwave::State<S, Motion, typename Hysteresis::State>;
    using Output = strainwave::Output<S>;

    /// Rate of the motion, and the torque that drives each side with its friction left out.
    struct Flow {
        Motion rate;
        S twist;
        S input_balance;
        S output_balance;
    };

    /// At rest at `output_angle` = 0 up to the kinematic error, untwisted and without history.
    constexpr State rest() const {
        State x{};
        x.motion.transmission_error = gear.kinematic_error.at(kinematic_error::Angle<S>{}).value;
        x.sliding_input = at_rest(gear.friction_input);
        x.sliding_output = at_rest(gear.friction_output);
        return x;
    }

    constexpr Flow flow(const State& x, const Motion& y, const Input<S>& u) const {
        const auto mesh = this->mesh(x, y);
        const auto reference = this->reference(x, y, u);
        const S voltage = control.voltage(y.control, reference);
        const friction::Contact<S> input = contact_input(x, y), output = contact_output(x, y);
        const S torque = motor.torque(motor.current(y.motor, voltage, y.input_speed));

        Flow flow{};
        flow.twist = mesh.twist;
        flow.input_balance = torque - mesh.torque * mesh.per_input;
        flow.output_balance = mesh.torque - load.torque(output_angle(x, y)) - u.load_torque;
        Motion& rate = flow.rate;
        rate.motor = motor.rate(y.motor, voltage, y.input_speed);
        rate.control = control.rate(y.control, reference);
        rate.input_angle = y.input_speed;
        rate.input_speed = moving(input, flow.input_balance - gear.friction_input.torque(y.friction_input, input)) /
                           (inertia_of(motor) + gear.input_inertia);
        rate.transmission_error = y.input_speed * gear.kinematics.inverse_ratio() - y.output_speed;
        rate.output_speed =
            moving(output, flow.output_balance - gear.friction_output.torque(y.friction_output, output)) / inertia_of(load);
        if constexpr (friction::Bristle<FrictionInput>) rate.friction_input = gear.friction_input.rate(y.friction_input, input);
        if constexpr (friction::Bristle<FrictionOutput>)
            rate.friction_output = gear.friction_output.rate(y.friction_output, output);
        return flow;
    }

    /// How fast each member forgets itself [1/s]: what an explicit method could not follow.
    constexpr Motion decay(const State& x) const {
        Motion rates{};
        rates.motor = motor.decay();
        if constexpr (friction::Bristle<FrictionInput>)
            rates.friction_input = gear.friction_input.decay(contact_input(x, x.motion));
        if constexpr (friction::Bristle<FrictionOutput>)
            rates.friction_output = gear.friction_output.decay(contact_output(x, x.motion));
        return rates;
    }

    /// The bristles within what they can ever reach, also where an integrator's stage would leave it.
    constexpr Motion confined(Motion y) const {
        if constexpr (friction::Bristle<FrictionInput>) y.friction_input = gear.friction_input.confined(y.friction_input);
        if constexpr (friction::Bristle<FrictionOutput>) y.friction_output = gear.friction_output.confined(y.friction_output);
        return y;
    }

    /// The hysteresis brought up to date at `twist`.
    constexpr State remembered(State x, const S& twist) const {
        x.hysteresis = gear.hysteresis.advance(x.hysteresis, twist - x.held_twist);
        x.held_twist = twist;
        return x;
    }

    /// The input angle within its turn, whole turns counted.
    constexpr State wrapped(State x) const {
        const S turns = rint(x.motion.input_angle * S(0.5 / pi));
        x.motion.input_angle = x.motion.input_angle - turns * S(2.0 * pi);
        x.turns = x.turns + turns;
        return x;
    }

    /// A state from outside, with each side's sense of sliding as its speed and its law have it.
    constexpr State consistent(State x) const {
        x.sliding_input = sense_of(gear.friction_input, x.motion.input_speed, x.sliding_input);
        x.sliding_output = sense_of(gear.friction_output, x.motion.output_speed, x.sliding_output);
        return x;
    }

    /// Whether a side can stick.
    constexpr bool set_valued() const { return is_set_valued(gear.friction_input) || is_set_valued(gear.friction_output); }

    /// How far both sides are from changing between sticking and sliding; below zero, one has.
    constexpr S margin(const State& x, const Input<S>& u) const {
        const Flow now = flow(x, x.motion, u);
        return min(margin_input(x, now), margin_output(x, now));
    }

    /// Sides that stick and are driven beyond what their friction holds set off.
    constexpr State released(State x, const Input<S>& u) const {
        const Flow now = flow(x, x.motion, u);
        const auto input = (x.sliding_input == S(0.0)) & (margin_input(x, now) < S(0.0));
        const auto output = (x.sliding_output == S(0.0)) & (margin_output(x, now) < S(0.0));
        x.sliding_input = select(input, sign(now.input_balance), x.sliding_input);
        x.sliding_output = select(output, sign(now.output_balance), x.sliding_output);
        return x;
    }

    /// At an event: the side whose margin is used up stops, or breaks away, or turns round.
    template <class Mask>
    constexpr State settled(State x, const Input<S>& u, const Mask& lanes) const {
        const Flow before = flow(x, x.motion, u);
        const auto at_input = lanes & !(margin_output(x, before) < margin_input(x, before));
        const auto at_output = lanes & (margin_output(x, before) < margin_input(x, before));
        const auto input_stops = at_input & !(x.sliding_input == S(0.0)), output_stops = at_output & !(x.sliding_output == S(0.0));
        x.motion.input_speed = select(input_stops, S(0.0), x.motion.input_speed);
        x.motion.output_speed = select(output_stops, S(0.0), x.motion.output_speed);
        const Flow now = flow(x, x.motion, u);
        x.sliding_input = select(at_input, sense(now.input_balance, gear.friction_input, input_stops), x.sliding_input);
        x.sliding_output = select(at_output, sense(now.output_balance, gear.friction_output, output_stops), x.sliding_output);
        return x;
    }

    constexpr friction::Contact<S> contact_input(const State& x, const Motion& y) const { return {y.input_speed, x.sliding_input}; }
    constexpr friction::Contact<S> contact_output(const State& x, const Motion& y) const {
        return {y.output_speed, x.sliding_output};
    }

    constexpr auto mesh(const State& x, const Motion& y) const {
        return gear.mesh({y.input_angle, x.turns}, y.input_speed, y.transmission_error, y.output_speed, x.hysteresis, x.held_twist);
    }

    constexpr Output output(const State& x, const Input<S>& u) const {
        const Motion& y = x.motion;
        const auto mesh = this->mesh(x, y);
        const auto flow = this->flow(x, y, u);
        const S voltage = control.voltage(y.control, reference(x, y, u));
        const S output_angle = this->output_angle(x, y);
        const S load_torque = load.torque(output_angle) + u.load_torque;
        return {u.command,
                input_angle(x, y),
                y.input_speed,
                output_angle,
                y.output_speed,
                mesh.twist,
                mesh.error,
                y.transmission_error,
                mesh.torque,
                motor.current(y.motor, voltage, y.input_speed),
                voltage,
                holding(contact_input(x, y), flow.input_balance, gear.friction_input.torque(y.friction_input, contact_input(x, y))),
                holding(contact_output(x, y), flow.output_balance,
                        gear.friction_output.torque(y.friction_output, contact_output(x, y))),
                load_torque};
    }

private:
    template <class Law>
    static constexpr bool is_set_valued(const Law& law) {
        if constexpr (requires { law.set_valued(); })
            return law.set_valued();
        else
            return friction::SetValued<Law>;
    }
    template <class Law>
    static constexpr S sense_of(const Law& law, const S& speed, const S& sliding) {
        if (!is_set_valued(law)) return S(1.0);
        return select(speed == S(0.0), sign(sliding), sign(speed));
    }
    template <class Law>
    static constexpr S at_rest(const Law& law) {
        return S(is_set_valued(law) ? 0.0 : 1.0);
    }

    constexpr S margin_input(const State& x, const Flow& now) const {
        return margin(gear.friction_input, contact_input(x, x.motion), now.input_balance);
    }
    constexpr S margin_output(const State& x, const Flow& now) const {
        return margin(gear.friction_output, contact_output(x, x.motion), now.output_balance);
    }
    template <class Law>
    static constexpr S margin(const Law& law, const friction::Contact<S>& contact, const S& balance) {
        if constexpr (friction::SetValued<Law>) {
            if (is_set_valued(law))
                return select(contact.sliding == S(0.0), law.hold() - abs(balance), contact.sliding * contact.speed);
        }
        return S(unbounded);
    }

    /// Which way a side goes at an event: one that stops sticks if its friction holds it.
    template <class Law, class Mask>
    static constexpr S sense(const S& balance, const Law& law, const Mask& stops) {
        if constexpr (friction::SetValued<Law>)
            return select(stops & !(abs(balance) > law.hold()), S(0.0), sign(balance));
        else
            return S(1.0);
    }

    /// A side that sticks does not accelerate.
    static constexpr S moving(const friction::Contact<S>& contact, const S& torque) {
        return select(contact.sliding == S(0.0), S(0.0), torque);
    }
    /// A side that sticks balances what drives it.
    static constexpr S holding(const friction::Contact<S>& contact, const S& balance, const S& sliding) {
        return select(contact.sliding == S(0.0), balance, sliding);
    }

    constexpr S input_angle(const State& x, const Motion& y) const { return y.input_angle + S(2.0 * pi) * x.turns; }
    constexpr S output_angle(const State& x, const Motion& y) const {
        return input_angle(x, y) * gear.kinematics.inverse_ratio() - y.transmission_error;
    }

    constexpr control::Reference<S> reference(const State& x, const Motion& y, const Input<S>& u) const {
        const S ratio = gear.kinematics.ratio();
        return {u.command, ratio * u.command - input_angle(x, y), ratio * u.command_rate - y.input_speed};
    }
};

}  // namespace strainwave
