#pragma once
#include <strainwave/condition.hpp>
#include <strainwave/control/reference.hpp>
#include <strainwave/friction/contact.hpp>
#include <strainwave/friction/sticking.hpp>
#include <strainwave/gear.hpp>

namespace strainwave {

/// What drives a drive from outside, at one instant.
template <class S>
struct Input {
    S command{0.0};
    S command_rate{0.0};
    S load_torque{0.0};                         ///< N.m, added to the load's own
    S temperature{friction::room_temperature};  ///< K

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, command, "1", "Command: output angle [rad] of a controlled drive, voltage [V] of an open loop"));
        visit(SW_FIELD(m, command_rate, "1/s", "Time derivative of the command"));
        visit(SW_FIELD(m, load_torque, "N.m", "Torque that holds the output back, besides the load's own"));
        visit(SW_FIELD(m, temperature, "K", "Temperature of the gear"));
    }
};

/// What flows continuously. The transmission error theta_in / i - theta_out replaces the output angle.
template <class S, class MotorState, class ControlState, class FrictionInputState, class FrictionMeshState,
          class FrictionOutputState>
struct Motion {
    MotorState motor{};
    ControlState control{};
    S input_angle{0.0};
    S input_speed{0.0};
    S transmission_error{0.0};
    S output_speed{0.0};
    FrictionInputState friction_input{};
    FrictionMeshState friction_mesh{};
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
        visit(SW_PART(m, friction_mesh, "State of the friction of the mesh"));
        visit(SW_PART(m, friction_output, "State of the friction at the output"));
    }
};

/// A drive at one instant: the motion, and what it remembers of the past.
template <class S, class Motion, class HysteresisState>
struct State {
    Motion motion{};
    HysteresisState hysteresis{};
    S held_twist{0.0};
    S held_rate{0.0};
    S elapsed{0.0};
    S turns{0.0};
    S sliding_input{1.0};
    S sliding_output{1.0};

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, motion, "What flows continuously"));
        visit(SW_PART(m, hysteresis, "Memory of the hysteresis"));
        visit(SW_FIELD(m, held_twist, "rad", "Twist at which the hysteresis was last brought up to date"));
        visit(SW_FIELD(m, held_rate, "rad/s", "Rate of the twist there"));
        visit(SW_FIELD(m, elapsed, "s", "Time since"));
        visit(SW_FIELD(m, turns, "1", "Whole revolutions of the input"));
        visit(SW_FIELD(m, sliding_input, "1", "Sense of sliding at the input, 0 while it sticks"));
        visit(SW_FIELD(m, sliding_output, "1", "Sense of sliding at the output, 0 while it sticks"));
    }
};

/// Everything worth recording, at one instant.
template <class S>
struct Output {
    S command, input_angle, input_speed, output_angle, output_speed, twist, kinematic_error, transmission_error, torque, current,
        voltage, friction_input, friction_mesh, friction_output, load_torque, temperature;

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
        visit(SW_FIELD(m, friction_mesh, "N.m", "Friction torque of the mesh, opposing its motion, at the output's scale"));
        visit(SW_FIELD(m, friction_output, "N.m", "Friction torque at the output, opposing its motion"));
        visit(SW_FIELD(m, load_torque, "N.m", "Torque of the load, holding the output back"));
        visit(SW_FIELD(m, temperature, "K", "Temperature of the gear"));
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

        .. math:: J_{in} \ddot\theta_{in} = K_m i - (T + F_{mesh})\,(1/i - e') - F_{in}, \qquad
                  J_{out} \ddot\theta_{out} = T - T_{load} - F_{out}

        with J_in = motor.inertia + gear.input_inertia, J_out = load.inertia, T and e' of the gear, F the friction of each place.
        Where set-valued friction of the input and of the mesh hold the input together, the torque that each holds cannot be
        told apart: it is reported in proportion to what each can hold.
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
        return all(input_inertia() > S(0.0))
                   ? nullptr
                   : "motor.inertia and gear.input_inertia cannot both be 0: something must turn at the input";
    }

    /// Every part as the integrator wants it.
    constexpr auto compile() const {
        return PositionDrive<S, decltype(gear.compile()), decltype(compiled(motor)), decltype(compiled(control)),
                             decltype(compiled(load))>{gear.compile(), compiled(motor), compiled(control), compiled(load)};
    }

    using FrictionInput = decltype(Gear{}.friction_input);
    using FrictionMesh = decltype(Gear{}.friction_mesh);
    using FrictionOutput = decltype(Gear{}.friction_output);
    using Hysteresis = decltype(Gear{}.hysteresis);

    using Motion = strainwave::Motion<S, typename Motor::State, typename Control::State, typename FrictionInput::State,
                                      typename FrictionMesh::State, typename FrictionOutput::State>;
    using State = strainwave::State<S, Motion, typename Hysteresis::State>;
    using Output = strainwave::Output<S>;
    using Contact = friction::Contact<S>;

    /// The places where friction acts.
    struct Contacts {
        Contact input, mesh, output;
    };

    /// Rate of the motion, the torques that friction which can stick must hold, and what they came from.
    struct Flow {
        Motion rate;
        typename Gear::Mesh mesh;
        Contacts contacts;
        S voltage, current, load_torque;
        S friction_input, friction_mesh, friction_output;  ///< of places that slide, N.m
        S input_balance, output_balance;
    };

    /// Where a drive stands at one instant: its state, brought up to date, and what flows there. A step leads from one to the next.
    struct Standing {
        State state;
        Flow flow;
    };

    /// At rest at `output_angle` = 0 up to the kinematic error, untwisted and without history.
    constexpr State rest() const {
        State x{};
        // Once is enough without noise; with noise, whose amplitude follows the torque, a few rounds bring the twist to zero.
        for (int i = 0; i < 8; ++i)
            x.motion.transmission_error = gear.geometry({}, S(0.0), x.motion.transmission_error, S(0.0)).error;
        x.sliding_input = S(input_sticks() ? 0.0 : 1.0);
        x.sliding_output = S(output_sticks() ? 0.0 : 1.0);
        return x;
    }

    constexpr Flow flow(const State& x, const Motion& y, const Input<S>& u) const { return flow(x, y, u, mesh(x, y)); }

    /// Where a drive in this state stands, brought up to date.
    constexpr Standing standing(State x, const Input<S>& u) const {
        const auto geometry = this->geometry(x, x.motion);
        remember(x, geometry);
        return {x, flow(x, x.motion, u, gear.loaded(geometry, x.hysteresis, x.held_twist))};
    }

    constexpr Flow flow(const State& x, const Motion& y, const Input<S>& u, const typename Gear::Mesh& mesh) const {
        const auto reference = this->reference(x, y, u);
        const S voltage = control.voltage(y.control, reference), current = motor.current(y.motor, voltage, y.input_speed);
        const S motor_torque = motor.torque(current), load_torque = load.torque(output_angle(x, y)) + u.load_torque;

        Motion rate{};
        const Contacts at = contacts(x, y, mesh, u);
        const Resistance input = resistance(gear.friction_input, y.friction_input, at.input, rate.friction_input);
        const Resistance meshing = resistance(gear.friction_mesh, y.friction_mesh, at.mesh, rate.friction_mesh);
        const Resistance output = resistance(gear.friction_output, y.friction_output, at.output, rate.friction_output);
        const S input_balance = motor_torque - (mesh.torque + meshing.always) * mesh.per_input - input.always;
        const S output_balance = mesh.torque - load_torque - output.always;
        rate.motor = motor.rate(y.motor, voltage, y.input_speed);
        rate.control = control.rate(y.control, reference);
        rate.input_angle = y.input_speed;
        rate.input_speed = moving(at.input, input_balance - meshing.sliding * mesh.per_input - input.sliding) / input_inertia();
        rate.transmission_error = y.input_speed * gear.kinematics.inverse_ratio() - y.output_speed;
        rate.output_speed = moving(at.output, output_balance - output.sliding) / inertia_of(load);
        return {rate,          mesh,          at, voltage, current, load_torque, input.torque(), meshing.torque(), output.torque(),
                input_balance, output_balance};
    }

    /// How fast each member forgets itself [1/s]: what an explicit method could not follow.
    constexpr Motion decay(const Motion& y, const Contacts& at) const {
        Motion rates{};
        rates.motor = motor.decay();
        rates.friction_input = friction::decay(gear.friction_input, y.friction_input, at.input);
        rates.friction_mesh = friction::decay(gear.friction_mesh, y.friction_mesh, at.mesh);
        rates.friction_output = friction::decay(gear.friction_output, y.friction_output, at.output);
        return rates;
    }

    /// The states of friction within what they can ever reach, also where an integrator's stage would leave it. `at` holds the
    /// contacts of an instant close by.
    constexpr Motion confined(Motion y, const Contacts& at, const S& per_input) const {
        y.friction_input = friction::confined(gear.friction_input, y.friction_input, at.input.moving(y.input_speed));
        y.friction_mesh = friction::confined(gear.friction_mesh, y.friction_mesh, at.mesh.moving(y.input_speed * per_input));
        y.friction_output = friction::confined(gear.friction_output, y.friction_output, at.output.moving(y.output_speed));
        return y;
    }

    /// What a step keeps fixed of the states of friction, decided anew at its end.
    constexpr Motion renewed(Motion y, const Contacts& at, const S& per_input) const {
        y.friction_input = friction::renewed(gear.friction_input, y.friction_input, at.input.moving(y.input_speed));
        y.friction_mesh = friction::renewed(gear.friction_mesh, y.friction_mesh, at.mesh.moving(y.input_speed * per_input));
        y.friction_output = friction::renewed(gear.friction_output, y.friction_output, at.output.moving(y.output_speed));
        return y;
    }

    /// What friction remembers after `dt` [s] at constant speeds; what moves stays where it is.
    constexpr State aged(State x, const Input<S>& u, const S& dt) const {
        const Contacts at = contacts(x, x.motion, mesh(x, x.motion), u);
        x.motion.friction_input = friction::advance(gear.friction_input, x.motion.friction_input, at.input, dt);
        x.motion.friction_mesh = friction::advance(gear.friction_mesh, x.motion.friction_mesh, at.mesh, dt);
        x.motion.friction_output = friction::advance(gear.friction_output, x.motion.friction_output, at.output, dt);
        return x;
    }

    /// Leads the hysteresis straight to a twist.
    constexpr void lead(State& x, const S& twist) const {
        x.hysteresis = gear.hysteresis.advance(x.hysteresis, twist - x.held_twist);
        x.held_twist = twist;
        x.held_rate = x.elapsed = S(0.0);
    }

    /// Brings the hysteresis up to date where the shafts now stand. Where the twist has turned round on the way it is led to the
    /// turning point first: missing it would be an error of memory, that stays.
    constexpr void remember(State& x, const typename Gear::Mesh& now) const {
        const auto turned = x.held_rate * now.twist_rate < S(0.0);
        if (any(turned)) {
            State there = x;
            lead(there, turning_point(x, now));
            x = chosen<S>(turned, there, x);
        }
        lead(x, now.twist);
        x.held_rate = now.twist_rate;
    }

    /// The state becomes that `dt` [s] after it was remembered: its input angle within its turn, whole turns counted.
    constexpr void wrap(State& x, const S& dt) const {
        x.elapsed = dt;
        const S turns = rint(x.motion.input_angle * S(0.5 / pi));
        x.motion.input_angle = x.motion.input_angle - turns * S(2.0 * pi);
        x.turns = x.turns + turns;
    }

    /// A state from outside, with each side's sense of sliding as its speed and its law have it.
    constexpr State consistent(State x) const {
        x.sliding_input = input_sticks() ? friction::sense_at(x.motion.input_speed, x.sliding_input) : S(1.0);
        x.sliding_output = output_sticks() ? friction::sense_at(x.motion.output_speed, x.sliding_output) : S(1.0);
        return x;
    }

    /// The fastest angular frequency [rad/s] of the gear's own vibration at twists up to `twist` [rad].
    constexpr S vibration(const S& twist) const {
        const S inverse = gear.kinematics.inverse_ratio();
        return sqrt(gear.steepest(twist) * (S(1.0) / inertia_of(load) + inverse * inverse / input_inertia()));
    }

    /// How fast speeds decay at most [1/s], of a drive at the beginning of its way whose sides both slide: by damping, friction,
    /// back-EMF and control. The larger eigenvalue of what two speeds do to their rates.
    constexpr S damping() const {
        State x = rest();
        x.sliding_input = x.sliding_output = S(1.0);
        const auto rate = [&](double input_speed, double output_speed) {
            Motion y = x.motion;
            y.input_speed = S(input_speed);
            y.output_speed = S(output_speed);
            return flow(x, y, Input<S>{}).rate;
        };
        const Motion slow = rate(1.0, 1.0), by_input = rate(2.0, 1.0), by_output = rate(1.0, 2.0);
        const S input = slow.input_speed - by_input.input_speed, output = slow.output_speed - by_output.output_speed;
        const S across = (slow.input_speed - by_output.input_speed) * (slow.output_speed - by_input.output_speed);
        const S mean = S(0.5) * (input + output), product = input * output - across, square = mean * mean - product;
        return select(square < S(0.0), sqrt(max(product, S(0.0))), max(mean + sqrt(max(square, S(0.0))), S(0.0)));
    }

    /// The fastest that fixed steps must follow, as an angular frequency [rad/s]: the gear's own vibration at twists up to `twist`
    /// [rad], or the decay of speeds. Of the latter a Runge-Kutta step of fourth order bears 2.78 times its length.
    constexpr S fastest(const S& twist) const { return max(vibration(twist), damping() / S(2.5)); }

    /// The fastest angular frequency [rad/s] at which a shaft vibrates on the bristles that hold it.
    constexpr S bristle_vibration() const {
        const S inverse = gear.kinematics.inverse_ratio();
        const S input = presliding_stiffness(gear.friction_input) + presliding_stiffness(gear.friction_mesh) * inverse * inverse;
        return sqrt(max(input / input_inertia(), presliding_stiffness(gear.friction_output) / inertia_of(load)));
    }

    /// Whether a side can stick.
    constexpr bool set_valued() const { return input_sticks() || output_sticks(); }

    /// Whether a side sticks, in any lane.
    constexpr bool sticks(const State& x) const {
        return (input_sticks() && any(x.sliding_input == S(0.0))) || (output_sticks() && any(x.sliding_output == S(0.0)));
    }

    /// How far both sides are from changing between sticking and sliding; below zero, one has.
    constexpr S margin(const Standing& at) const { return min(margin_input(at.state, at.flow), margin_output(at.state, at.flow)); }

    /// Whether a side that sticks is driven beyond what its friction holds, in any lane.
    constexpr bool sets_off(const Standing& at) const {
        return sticks(at.state) && ((input_sticks() && any(input_sets_off(at))) || (output_sticks() && any(output_sets_off(at))));
    }

    /// The same with those sides sliding.
    constexpr Standing released(const Standing& at, const Input<S>& u) const {
        State x = at.state;
        if (input_sticks()) x.sliding_input = select(input_sets_off(at), sign(at.flow.input_balance), x.sliding_input);
        if (output_sticks()) x.sliding_output = select(output_sets_off(at), sign(at.flow.output_balance), x.sliding_output);
        return standing(x, u);
    }

    /// The state `dt` [s] after `x`, at `end` but for what moves: its speeds are those that friction which can stick lets the two
    /// sides reach under the torques of `now`, a side that its friction brings to rest sticking.
    constexpr State arriving(const State& x, const Motion& end, const Flow& now, const S& dt) const {
        State y = x;
        y.motion = end;
        const auto input = arrival(input_sticks(), x.sliding_input, x.motion.input_speed, input_inertia(), now.input_balance * dt,
                                   hold_input(now) * dt, [&](const S& sense) { return input_friction(x, now, sense) * dt; });
        const auto output =
            arrival(output_sticks(), x.sliding_output, x.motion.output_speed, inertia_of(load), now.output_balance * dt,
                    hold_output(now) * dt, [&](const S& sense) { return output_friction(x, now, sense) * dt; });
        y.sliding_input = input.sliding;
        y.sliding_output = output.sliding;
        y.motion.input_speed = input.momentum / input_inertia();
        y.motion.output_speed = output.momentum / inertia_of(load);
        const S half = S(0.5) * dt, inverse = gear.kinematics.inverse_ratio();
        y.motion.input_angle = x.motion.input_angle + half * (x.motion.input_speed + y.motion.input_speed);
        y.motion.transmission_error =
            x.motion.transmission_error +
            half * (inverse * (x.motion.input_speed + y.motion.input_speed) - (x.motion.output_speed + y.motion.output_speed));
        return y;
    }

    /// At an event: the side whose margin is used up stops, or breaks away, or turns round.
    template <class Mask>
    constexpr State settled(const Standing& at, const Input<S>& u, const Mask& lanes) const {
        State x = at.state;
        const Flow& before = at.flow;
        const auto at_input = lanes & !(margin_output(x, before) < margin_input(x, before));
        const auto at_output = lanes & (margin_output(x, before) < margin_input(x, before));
        const auto input_stops = at_input & !(x.sliding_input == S(0.0)), output_stops = at_output & !(x.sliding_output == S(0.0));
        x.motion.input_speed = select(input_stops, S(0.0), x.motion.input_speed);
        x.motion.output_speed = select(output_stops, S(0.0), x.motion.output_speed);
        const Flow now = standing(x, u).flow;
        x.sliding_input = select(at_input, friction::sense_after(now.input_balance, hold_input(now), input_stops), x.sliding_input);
        x.sliding_output =
            select(at_output, friction::sense_after(now.output_balance, hold_output(now), output_stops), x.sliding_output);
        return x;
    }

    /// A drive whose event was settled in a state close by, `after` which its sides stand or slide: at the event itself friction
    /// that holds one way only may not tell.
    constexpr Standing as_settled(const Standing& at, const State& after, const Input<S>& u) const {
        State x = at.state;
        x.sliding_input = after.sliding_input;
        x.sliding_output = after.sliding_output;
        x.motion.input_speed = select(after.motion.input_speed == S(0.0), S(0.0), x.motion.input_speed);
        x.motion.output_speed = select(after.motion.output_speed == S(0.0), S(0.0), x.motion.output_speed);
        return standing(x, u);
    }

    /// Whether every part is valid where the drive stands; visit(part, Domain) of those that may not be.
    template <class Visit>
    constexpr void bounds(const Flow& now, Visit&& visit) const {
        if (bounded<S>(gear.stiffness)) visit("gear.stiffness", domain<S>(gear.stiffness, now.mesh.twist));
        if (bounded<Contact>(gear.friction_input)) visit("gear.friction_input", domain<S>(gear.friction_input, now.contacts.input));
        if (bounded<Contact>(gear.friction_mesh)) visit("gear.friction_mesh", domain<S>(gear.friction_mesh, now.contacts.mesh));
        if (bounded<Contact>(gear.friction_output))
            visit("gear.friction_output", domain<S>(gear.friction_output, now.contacts.output));
    }
    constexpr bool has_bounds() const {
        return bounded<S>(gear.stiffness) || bounded<Contact>(gear.friction_input) || bounded<Contact>(gear.friction_mesh) ||
               bounded<Contact>(gear.friction_output);
    }

    constexpr typename Gear::Mesh geometry(const State& x, const Motion& y) const {
        return gear.geometry({y.input_angle, x.turns}, y.input_speed, y.transmission_error, y.output_speed);
    }
    constexpr typename Gear::Mesh mesh(const State& x, const Motion& y) const {
        return gear.loaded(geometry(x, y), x.hysteresis, x.held_twist);
    }

    constexpr Output output(const Standing& at, const Input<S>& u) const {
        const State& x = at.state;
        const Flow& now = at.flow;
        const Motion& y = x.motion;
        const S of_input = input_sticks() ? friction::share_of_hold(now.input_balance, hold_input(now)) : S(0.0);
        const S of_output = output_sticks() ? friction::share_of_hold(now.output_balance, hold_output(now)) : S(0.0);
        return {u.command,
                input_angle(x, y),
                y.input_speed,
                output_angle(x, y),
                y.output_speed,
                now.mesh.twist,
                now.mesh.error,
                y.transmission_error,
                now.mesh.torque,
                now.current,
                now.voltage,
                reported(gear.friction_input, now.contacts.input, now.friction_input, of_input),
                reported(gear.friction_mesh, now.contacts.mesh, now.friction_mesh, along(now.mesh.per_input, of_input)),
                reported(gear.friction_output, now.contacts.output, now.friction_output, of_output),
                now.load_torque,
                u.temperature};
    }

private:
    /// What a friction opposes: the part that acts at rest too, and the part that can stick.
    struct Resistance {
        S always, sliding;
        constexpr S torque() const { return always + sliding; }  // one of them is none
    };
    template <class Law>
    static constexpr Resistance resistance(const Law& law, const typename Law::State& x, const Contact& contact,
                                           typename Law::State& rate) {
        const auto found = friction::response(law, x, contact);
        rate = found.rate;
        if (friction::set_valued(law)) return {S(0.0), found.torque};
        return {found.torque, S(0.0)};
    }

    constexpr S input_inertia() const { return inertia_of(motor) + gear.input_inertia; }
    constexpr bool input_sticks() const {
        return friction::set_valued(gear.friction_input) || friction::set_valued(gear.friction_mesh);
    }
    constexpr bool output_sticks() const { return friction::set_valued(gear.friction_output); }

    /// How each place moves and what it bears. The output's angle is split into whole turns before it is multiplied out.
    constexpr Contacts contacts(const State& x, const Motion& y, const typename Gear::Mesh& mesh, const Input<S>& u) const {
        const S inverse = gear.kinematics.inverse_ratio(), turned = x.turns * inverse, turns = rint(turned);
        const S rigid = S(2.0 * pi) * (turned - turns) + y.input_angle * inverse;
        return {
            {y.input_speed, x.sliding_input, {y.input_angle, x.turns}, mesh.torque * mesh.per_input, u.temperature},
            {y.input_speed * mesh.per_input, along(mesh.per_input, x.sliding_input), {rigid, turns}, mesh.torque, u.temperature},
            {y.output_speed, x.sliding_output, {rigid - y.transmission_error, turns}, mesh.torque, u.temperature}};
    }

    /// The largest torque that holds the input against what drives it, and likewise the output.
    constexpr S hold_input(const Flow& now) const {
        const S push = sign(now.input_balance), per_input = now.mesh.per_input;
        const S held = friction::hold(gear.friction_input, now.contacts.input.pushed(push)) +
                       abs(per_input) * friction::hold(gear.friction_mesh, now.contacts.mesh.pushed(along(per_input, push)));
        return max(held, S(friction::negligible_hold));
    }
    constexpr S hold_output(const Flow& now) const {
        const S held = friction::hold(gear.friction_output, now.contacts.output.pushed(sign(now.output_balance)));
        return max(held, S(friction::negligible_hold));
    }

    /// The torque with which friction that can stick would oppose the input sliding one way, and likewise the output.
    constexpr S input_friction(const State& x, const Flow& now, const S& sense) const {
        const Contact mesh = now.contacts.mesh.pushed(along(now.mesh.per_input, sense));
        return sliding(gear.friction_input, x.motion.friction_input, now.contacts.input.pushed(sense)) +
               sliding(gear.friction_mesh, x.motion.friction_mesh, mesh) * now.mesh.per_input;
    }
    constexpr S output_friction(const State& x, const Flow& now, const S& sense) const {
        return sliding(gear.friction_output, x.motion.friction_output, now.contacts.output.pushed(sense));
    }
    template <class Law>
    static constexpr S sliding(const Law& law, const typename Law::State& x, const Contact& contact) {
        return friction::set_valued(law) ? friction::torque(law, x, contact) : S(0.0);
    }

    constexpr auto input_sets_off(const Standing& at) const {
        return friction::sets_off(at.state.sliding_input, hold_input(at.flow), at.flow.input_balance);
    }
    constexpr auto output_sets_off(const Standing& at) const {
        return friction::sets_off(at.state.sliding_output, hold_output(at.flow), at.flow.output_balance);
    }

    constexpr S margin_input(const State& x, const Flow& now) const {
        if (!input_sticks()) return S(unbounded);
        return friction::margin(x.sliding_input, x.motion.input_speed, hold_input(now), now.input_balance);
    }
    constexpr S margin_output(const State& x, const Flow& now) const {
        if (!output_sticks()) return S(unbounded);
        return friction::margin(x.sliding_output, x.motion.output_speed, hold_output(now), now.output_balance);
    }
    /// Torque per angle [N.m/rad] of a friction that is about to slip.
    template <class Law>
    static constexpr S presliding_stiffness(const Law& law) {
        const S little(1e-9), soon(1e-3);  // rad/s, s: less than any bristle's reach, and more than rounding
        const Contact still = Contact{}.pushed(S(0.0));
        const auto bent = friction::advance(law, typename Law::State{}, still.moving(little), soon);
        return (friction::torque(law, bent, still) - friction::torque(law, typename Law::State{}, still)) / (little * soon);
    }

    /// The twist at which it turned round since it was held: where Hermite's cubic through both ends is steepest to neither side.
    static constexpr S turning_point(const State& x, const typename Gear::Mesh& now) {
        const S begin = x.held_rate * x.elapsed, end = now.twist_rate * x.elapsed, moved = now.twist - x.held_twist;
        const S sense = sign(begin), bend = S(3.0) * (begin + end - S(2.0) * moved);
        const S slope = S(2.0) * (S(3.0) * moved - S(2.0) * begin - end);
        const S root = sqrt(max(slope * slope - S(4.0) * bend * begin, S(0.0)));
        const S at = S(2.0) * abs(begin) / max(root - sense * slope, S(smallest));
        return x.held_twist + at * (begin + at * (S(0.5) * slope + at * bend * S(1.0 / 3.0)));
    }

    /// How a side moves after the impulse `push`, be it one that `can_stick`.
    template <class Friction>
    static constexpr friction::Arrival<S> arrival(bool can_stick, const S& sliding, const S& speed, const S& inertia, const S& push,
                                                  const S& hold, const Friction& friction) {
        const S momentum = speed * inertia;
        if (!can_stick) return {momentum + push, sliding};
        return friction::arrival(sliding, momentum, push, hold, friction);
    }

    /// A side that sticks does not accelerate.
    static constexpr S moving(const Contact& contact, const S& torque) { return select(contact.sliding == S(0.0), S(0.0), torque); }

    /// A place that sticks balances its share of what drives its side.
    template <class Law>
    static constexpr S reported(const Law& law, const Contact& contact, const S& sliding, const S& share) {
        if (!friction::set_valued(law)) return sliding;
        return select(contact.sliding == S(0.0), share * friction::hold(law, contact.pushed(sign(share))), sliding);
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
