#pragma once
#include <strainwave/condition.hpp>
#include <strainwave/control/law.hpp>
#include <strainwave/drive/contacts.hpp>
#include <strainwave/drive/coupled_bodies.hpp>
#include <strainwave/drive/input.hpp>
#include <strainwave/drive/output.hpp>
#include <strainwave/drive/power.hpp>
#include <strainwave/drive/prescribed_motion.hpp>
#include <strainwave/drive/state.hpp>
#include <strainwave/gear.hpp>
#include <strainwave/load/load.hpp>
#include <strainwave/meter/no_meter.hpp>
#include <strainwave/motor/rotor.hpp>
#include <strainwave/sensors.hpp>
#include <strainwave/system.hpp>
#include <strainwave/thermal/isothermal.hpp>

namespace strainwave {

template <class S, class Control, class Motor, class Gear, class Load, class Sensors, class ThermalModel = thermal::Isothermal<S>,
          class Meter = meter::NoMeter<S>>
struct Drive {
    Gear gear{};
    Motor motor{};
    Control control{};
    Load load{};
    Sensors sensors{};
    ThermalModel thermal{};
    Meter meter{};

    static constexpr auto name = "drive";
    static constexpr auto source = SW_POSITION_ARTICLE ", eqs. of motion, with r = 1/100, not 100, and in the motor equation too";
    static constexpr auto doc = R"(
        Drive of a motor, its controller, one strain wave gear, a load, and the sensors of the controller.

        .. math:: J_{in} \ddot\theta_{in} = \tau - (T + F_{mesh})\,(1/i - e') - F_{in}, \qquad
                  J_{out} \ddot\theta_{out} = T - T_{load} - F_{out}

        with tau the torque of the motor, J_in = motor.inertia + gear.input_inertia, J_out = load.inertia, T and e' of the
        gear, F the friction of each place. A load can also prescribe the motion of the output shaft, a motor that of the
        input. The temperature of a run is that of gear and winding. With a thermal model it is the ambient temperature. If
        set-valued friction of input and mesh both hold the input at rest, their two torques are not determined separately:
        each is reported in proportion to its breakaway torque. Angles are relative to the rigid motion, so an hour of rotation
        is as accurate as a second.

        >>> import strainwave as sw
        >>> drive = sw.Drive(motor=sw.motor.DC(resistance=2.0), load=sw.loads.Inertia(inertia=0.005))
        >>> drive.motor.resistance
        2.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, gear, "The gear"));
        visit(SW_PART(m, motor, "The motor on the input shaft"));
        visit(SW_PART(m, control, "Controller: turns the command into voltage, current or torque of the motor"));
        visit(SW_PART(m, load, "Load on the output shaft"));
        visit(SW_PART(m, sensors, "Sensors of the controller"));
        visit(SW_PART(m, thermal, "Thermal model of gear and winding"));
        visit(SW_PART(m, meter, "Meter of powers and energies"));
    }

    constexpr Contradiction<S> problem() const {
        if (!all(input_inertia() > S(0.0)))
            return {gear.structure.rigid()
                        ? "motor.inertia and gear.input_inertia cannot both be 0: the input needs an inertia"
                        : "motor.inertia must exceed 0 with this structure of the gear: the input shaft is a body of its own"};
        const char* given = control::given_by(control);
        if (*given != 0 && !same(given, motor::taken_by(motor)))
            return {
                "control gives a voltage, and the motor takes none; a PositionSpeed suits one that takes a current or a torque"};
        if (control::needs_current(control) && !motor::has_current<S>(motor))
            return {
                "control acts at once on the current, which follows the motor's voltage at once: give the motor an "
                "inductance, or let the control be Sampled"};
        const S of_model = control::model_ratio<S>(control), ratio = gear.kinematics.ratio();
        if (!all(of_model == S(0.0)) && !all(abs(of_model - ratio) <= S(control::max_ratio_error) * abs(ratio)))
            return {
                "the model of the controller has the ratio {}, and the gear of the drive {}: give the gear of the model the "
                "kinematics of the drive's",
                of_model, ratio};
        return {};
    }

    /// Every part as the integrator wants it.
    constexpr auto compile() const {
        return Drive<S, decltype(compiled(control)), decltype(compiled(motor)), decltype(gear.compile()), decltype(compiled(load)),
                     decltype(sensors.compile()), decltype(compiled(thermal)), decltype(compiled(meter))>{
            gear.compile(),    compiled(motor),   compiled(control), compiled(load),
            sensors.compile(), compiled(thermal), compiled(meter)};
    }

    using FrictionInput = decltype(Gear{}.friction_input);
    using FrictionMesh = decltype(Gear{}.friction_mesh);
    using FrictionOutput = decltype(Gear{}.friction_output);
    using Hysteresis = decltype(Gear{}.hysteresis);
    using Structure = decltype(Gear{}.structure);
    using Material = decltype(Gear{}.material);

    using Continuous = strainwave::Continuous<S, typename Motor::State, typename Control::State, typename Sensors::State,
                                              typename FrictionInput::State, typename FrictionMesh::State,
                                              typename FrictionOutput::State, typename Structure::State, typename Material::State,
                                              typename ThermalModel::State, typename Meter::State>;
    using Discrete = strainwave::Discrete<S, control::DiscreteOf<S, Control>>;
    using State = strainwave::State<S, Continuous, Discrete, typename Hysteresis::State>;
    using Input = strainwave::Input<S>;
    using Output = strainwave::Output<S, typename Motor::Output, typename ThermalModel::Output, typename Meter::Output,
                                      typename Structure::Output>;
    using Rotor = motor::Rotor<S>;
    using Measurement = control::Measurement<S>;
    using Shaft = strainwave::Shaft<S>;
    using Contact = friction::Contact<S>;
    using Contacts = strainwave::Contacts<S>;
    using Mesh = typename Gear::Mesh;
    using Resistance = friction::Resistance<S>;

    /// The rate of the continuous numbers, and the quantities that it follows from.
    struct Derivatives {
        constexpr Derivatives() {}  // sets nothing to zero that `fill` sets
        Continuous rate;
        Mesh mesh;
        Contacts contacts;
        S actuation, load_torque;
        Braking<S> braking;                                ///< of the load
        S friction_input, friction_mesh, friction_output;  ///< N.m, of places that slip
        S input_driving_torque, output_driving_torque;     ///< N.m, all but set-valued friction
    };

    /// A state, its memory brought up to date, and the derivatives there. A step leads from one to the next.
    struct Evaluation {
        State state;
        Derivatives derivatives;
    };

    /// Calls visit(name in the state, part) for each part that has a state.
    template <class Visit>
    constexpr void stateful_parts(Visit&& visit) const {
        visit("motor", motor);
        visit("control", control);
        if constexpr (!Sensors::stateless) {
            visit("sensors.input_angle", sensors.input_angle);
            visit("sensors.input_speed", sensors.input_speed);
            visit("sensors.output_angle", sensors.output_angle);
            visit("sensors.output_speed", sensors.output_speed);
            visit("sensors.current", sensors.current);
            visit("sensors.torque", sensors.torque);
        }
        visit("hysteresis", gear.hysteresis);
        visit("friction_input", gear.friction_input);
        visit("friction_mesh", gear.friction_mesh);
        visit("friction_output", gear.friction_output);
        visit("structure", gear.structure);
        visit("material", gear.material);
        visit("thermal", thermal);
        visit("meter", meter);
    }

    /// All parts without history, and angles, speeds and twist zero.
    constexpr State initial_state() const {
        State x{};
        x.hysteresis = strainwave::initial_state(gear.hysteresis);
        x.continuous.motor = strainwave::initial_state(motor);
        x.continuous.control = strainwave::initial_state(control);
        x.continuous.sensors = sensors.initial_state();
        x.discrete.control = control::initial_discrete<S>(control);
        x.continuous.friction_input = strainwave::initial_state(gear.friction_input);
        x.continuous.friction_mesh = strainwave::initial_state(gear.friction_mesh);
        x.continuous.friction_output = strainwave::initial_state(gear.friction_output);
        x.continuous.structure = strainwave::initial_state(gear.structure);
        x.continuous.material = strainwave::initial_state(gear.material);
        x.continuous.thermal = strainwave::initial_state(thermal);
        x.continuous.meter = strainwave::initial_state(meter);
        return x;
    }

    /// The state at rest at `output_angle` = 0 up to the kinematic error, without twist and history.
    constexpr State rest() const {
        State x = initial_state();
        // Once is enough without noise; with noise, whose amplitude follows the torque, a few rounds bring the twist to zero.
        for (int i = 0; i < 8; ++i) settle_gear(x, geometry(x, x.continuous, Input{}), S(0.0), S(0.0), S(0.0));
        x.input_slip_direction = S(input_sticks() ? 0.0 : 1.0);
        x.output_slip_direction = S(output_sticks() ? 0.0 : 1.0);
        x.continuous.sensors = sensors.steady_state(measurable(x, x.continuous, Input{}, S(0.0)));
        return x;
    }

    /// The gear comes to rest where its spring is twisted so far [rad], under this torque of spring and hysteresis [N.m].
    constexpr void settle_gear(State& x, const Mesh& mesh, const S& twist, const S& torque, const S& temperature) const {
        const auto found =
            gear.steady_state(x.continuous.structure, gear_shafts(x, x.continuous, temperature), mesh, twist, torque, temperature);
        x.continuous.structure = found.state;
        x.continuous.transmission_error = found.transmission_error;
    }

    /// The derivatives; the kinematic error may be known.
    template <class... Foreseen>
    SW_RATES constexpr Derivatives derivatives(const State& x, const Continuous& y, const Input& u,
                                               const Foreseen&... error) const {
        if constexpr (load::can_prescribe<Load>) {
            if (prescribes(load)) {
                const Continuous z = prescribed_motion::placed<S>(*this, x, y, u);
                return derivatives_of(x, z, u, loaded(geometry(x, z, u, error...), x, z, u));
            }
        }
        return derivatives_of(x, y, u, loaded(geometry(x, y, u, error...), x, y, u));
    }
    /// Rates of which those of positions are right: they follow from the speeds.
    constexpr Continuous coasting(Continuous rate, const Continuous& y) const {
        rate.input_angle = y.input_speed;
        return rate;
    }
    static constexpr bool foresees = Gear::foresees;
    /// Quantities of the derivatives that follow from positions alone, at two stages of a step.
    constexpr auto foreseen(const State& one, const State& other) const {
        return gear.kinematic_error.at({one.continuous.input_angle, one.turns}, {other.continuous.input_angle, other.turns});
    }

    /// Brings the memory of a state up to date.
    constexpr Evaluation evaluate(const State& x, const Input& u) const {
        Evaluation at{x, {}};
        refresh(at, u);
        return at;
    }
    /// The same in place.
    template <class... Foreseen>
    SW_RATES constexpr void refresh(Evaluation& at, const Input& u, const Foreseen&... error) const {
        prescribed_motion::place<S>(*this, at.state, u);
        auto geometry = this->geometry(at.state, at.state.continuous, u, error...);
        commit(at.state, geometry);
        fill(at.derivatives, at.state, at.state.continuous, u, loaded(geometry, at.state, at.state.continuous, u));
    }

    constexpr Derivatives derivatives_of(const State& x, const Continuous& y, const Input& u, const Mesh& mesh) const {
        Derivatives now;
        fill(now, x, y, u, mesh);
        return now;
    }
    /// Fills in the derivatives where they stay: a copy would wait for all that was just stored.
    constexpr void fill(Derivatives& now, const State& x, const Continuous& y, const Input& u, const Mesh& mesh) const {
        auto asked = command(u);
        Measurement actual = measurable(x, y, u, mesh.torque), measured = sensors.shown(y.sensors, actual);
        const S actuation = control::actuation(control, y.control, x.discrete.control, asked, measured);
        Rotor rotor = this->rotor(x, y, u);
        const S motor_torque = motor.torque(y.motor, actuation, rotor);

        Continuous& rate = now.rate;
        Contacts at = contacts::at<S>(*this, x, y, mesh, u);
        Resistance input = friction::resistance(gear.friction_input, y.friction_input, at.input, rate.friction_input);
        Resistance meshing = friction::resistance(gear.friction_mesh, y.friction_mesh, at.mesh, rate.friction_mesh);
        Resistance output = friction::resistance(gear.friction_output, y.friction_output, at.output, rate.friction_output);
        const S load_torque = prescribes(load) ? mesh.torque - output.torque()
                                               : strainwave::load_torque<S>(load, output_angle(x, y), y.output_speed, u.load);
        Braking<S> braking = this->braking(u);
        const S brake = x.output_slip_direction * braking.slip;
        S input_driving_torque = motor_torque - mesh.input_torque - meshing.always * mesh.per_input - input.always;
        const S output_driving_torque = mesh.torque - load_torque - output.always;
        rate.motor = motor.rate(y.motor, actuation, rotor);
        rate.control = control.rate(y.control, asked, measured);
        rate.sensors = sensors.rate(y.sensors, actual);
        rate.input_angle = y.input_speed;
        rate.input_speed =
            moving(at.input, input_driving_torque - meshing.sliding * mesh.per_input - input.sliding) / input_inertia();
        if constexpr (motor::can_prescribe<Motor>) {
            if (motor::prescribes(motor)) {
                rate.input_speed = motor::acceleration<S>(motor, actuation);
                input_driving_torque = prescribed_motion::driving_torque<S>(*this, rate.input_speed, mesh, meshing, input);
            }
        }
        rate.structure = mesh.rate;
        rate.material = gear.material.rate(y.material, mesh.twist_rate);
        rate.transmission_error = y.input_speed * gear.kinematics.inverse_ratio() - y.output_speed;
        rate.output_speed = moving(at.output, output_driving_torque - output.sliding - brake) / output_inertia();
        now.mesh = mesh;
        now.contacts = at;
        now.actuation = actuation;
        now.load_torque = load_torque + brake;
        now.braking = braking;
        now.friction_input = input.torque();
        now.friction_mesh = meshing.torque();
        now.friction_output = output.torque();
        now.input_driving_torque = input_driving_torque;
        now.output_driving_torque = output_driving_torque;
        measure(x, y, u, now);
    }

    constexpr Continuous relaxation_rate(const Continuous& y, const Derivatives& now) const {
        Continuous rates = zeroed<S>(y);
        rates.motor = motor.relaxation_rate();
        rates.sensors = sensors.relaxation_rate();
        rates.material = gear.material.relaxation_rate();
        rates.friction_input = friction::relaxation_rate(gear.friction_input, y.friction_input, now.contacts.input);
        rates.friction_mesh = friction::relaxation_rate(gear.friction_mesh, y.friction_mesh, now.contacts.mesh);
        rates.friction_output = friction::relaxation_rate(gear.friction_output, y.friction_output, now.contacts.output);
        return rates;
    }
    constexpr Continuous clamped(Continuous y, const Derivatives& now) const {
        Contacts at = contacts::moved<S, Drive>(now, y);
        y.friction_input = friction::clamped(gear.friction_input, y.friction_input, at.input);
        y.friction_mesh = friction::clamped(gear.friction_mesh, y.friction_mesh, at.mesh);
        y.friction_output = friction::clamped(gear.friction_output, y.friction_output, at.output);
        return y;
    }
    constexpr Continuous update_mode(Continuous y, const Derivatives& now) const {
        Contacts at = contacts::moved<S, Drive>(now, y);
        y.friction_input = friction::update_mode(gear.friction_input, y.friction_input, at.input);
        y.friction_mesh = friction::update_mode(gear.friction_mesh, y.friction_mesh, at.mesh);
        y.friction_output = friction::update_mode(gear.friction_output, y.friction_output, at.output);
        return y;
    }

    // Bodies within the gear and both shafts, as one block.

    static constexpr int coupled_count = coupled_bodies::count<S, Gear, Structure>;
    using Coupled = coupled_bodies::Numbers<S, Gear, Structure>;
    constexpr bool couples() const { return !gear.structure.rigid(); }
    constexpr Coupled coupled(const Continuous& y) const { return coupled_bodies::numbers<S, Drive>(y); }
    constexpr void set_coupled(Continuous& y, const Coupled& z) const { coupled_bodies::set_numbers<S, Drive>(y, z); }
    constexpr Array<S, 2> coupled_mode(const State& x) const { return coupled_bodies::mode<S>(*this, x); }
    constexpr Coupled coupled_rate(const Array<S, 2>& moves, const Coupled& z) const {
        return coupled_bodies::rate<S>(*this, moves, z);
    }
    constexpr S side(const State& x) const { return gear.side(generator(x).angle); }
    constexpr S side(const State& x, const State& after, const S& dt, const S& fraction) const {
        return coupled_bodies::side<S>(*this, x, after, dt, fraction);
    }
    constexpr structure::Generator<S> generator(const State& x) const {
        return gear.structure.generator(x.continuous.structure, gear_shafts(x, x.continuous, Input{}));
    }
    /// Bodies of the vibration of a gear whose spring has a stiffness [N.m/rad].
    constexpr structure::Bodies<S> bodies(const S& stiffness) const {
        return {prescribed_motion::movable<S>(*this, input_inertia()),
                gear.input_inertia,
                output_inertia(),
                gear.kinematics.inverse_ratio(),
                stiffness,
                gear.damping,
                load_stiffness<S>(load)};
    }

    /// The state with the memory of friction after `dt` [s] at constant speeds; angles do not change.
    constexpr State relaxed(State x, const Input& u, const S& dt) const {
        const Contacts at = contacts::at<S>(*this, x, x.continuous, mesh(x, x.continuous, u), u);
        x.continuous.friction_input = friction::advance(gear.friction_input, x.continuous.friction_input, at.input, dt);
        x.continuous.friction_mesh = friction::advance(gear.friction_mesh, x.continuous.friction_mesh, at.mesh, dt);
        x.continuous.friction_output = friction::advance(gear.friction_output, x.continuous.friction_output, at.output, dt);
        return x;
    }

    /// Advances the hysteresis straight to a twist.
    constexpr void advance_hysteresis(State& x, const S& twist) const {
        x.hysteresis = gear.hysteresis.advance(x.hysteresis, twist - x.held_twist);
        x.held_twist = twist;
        x.held_rate = x.elapsed = S(0.0);
    }

    /// Commits the twist at which the shafts now stand to the hysteresis. Where the twist has turned round on the way, the turning
    /// point is committed first: to miss it would be an error of memory, which stays.
    constexpr void commit(State& x, const Mesh& now) const {
        const auto turned = x.held_rate * now.twist_rate < S(0.0);
        if (any(turned)) {
            State there = x;
            advance_hysteresis(there, x.turning_point(now.twist, now.twist_rate));
            x = chosen<S>(turned, there, x);
        }
        advance_hysteresis(x, now.twist);
        x.held_rate = now.twist_rate;
    }

    /// The state becomes that `dt` [s] after it was committed: its input angle within its turn, whole turns counted.
    constexpr void finish_step(State& x, const S& dt) const {
        x.elapsed = dt;
        x.discrete.control = control::elapsed(control, x.discrete.control, dt);
        const S turns = rint(x.continuous.input_angle * S(0.5 / pi));
        x.continuous.input_angle = x.continuous.input_angle - turns * S(2.0 * pi);
        x.turns = x.turns + turns;
    }

    // A controller that samples.

    constexpr bool due(const State& x, const S& within) const { return control::due(control, x.discrete.control, within); }
    constexpr State sampled(const Evaluation& at, const Input& u, const S& within) const {
        State x = at.state;
        const Measurement actual = measurable(x, x.continuous, u, at.derivatives.mesh.torque);
        x.discrete.control =
            control::sampled(control, x.discrete.control, within, command(u), sensors.shown(x.continuous.sensors, actual));
        return x;
    }
    constexpr control::Schedule<S> schedule(const State& x) const { return control::schedule<S>(control, x.discrete.control); }

    /// A state from outside, with the slip direction of each shaft as its speed and its friction have it.
    constexpr State consistent(State x) const {
        x.input_slip_direction =
            Shaft{input_sticks(), input_inertia(), x.continuous.input_speed, x.input_slip_direction}.consistent_direction();
        x.output_slip_direction =
            Shaft{output_sticks(), output_inertia(), x.continuous.output_speed, x.output_slip_direction}.consistent_direction();
        return x;
    }

    // Events: a shaft stops, or breaks away.

    constexpr bool has_events() const { return input_sticks() || output_sticks(); }

    /// True if a shaft sticks, in any lane.
    constexpr bool sticks(const State& x) const {
        return (input_sticks() && any(x.input_slip_direction == S(0.0))) ||
               (output_sticks() && any(x.output_slip_direction == S(0.0)));
    }
    constexpr Array<Shaft, 2> shafts(const State& x, const Derivatives& now) const {
        return {{input_shaft(x, now), output_shaft(x, now)}};
    }
    constexpr void set_shaft(State& x, int i, const S& speed, const S& slip_direction) const {
        (i == 0 ? x.continuous.input_speed : x.continuous.output_speed) = speed;
        (i == 0 ? x.input_slip_direction : x.output_slip_direction) = slip_direction;
    }
    constexpr S slip_friction(int i, const State& x, const Derivatives& now, const S& direction) const {
        return i == 0 ? contacts::input_friction<S>(*this, x, now, direction)
                      : contacts::output_friction<S>(*this, x, now, direction) + direction * now.braking.slip;
    }
    constexpr void move_positions(State& x, const State& before, const S& dt) const {
        const S half = S(0.5) * dt, inverse = gear.kinematics.inverse_ratio();
        const Continuous& from = before.continuous;
        Continuous& to = x.continuous;
        to.input_angle = from.input_angle + half * (from.input_speed + to.input_speed);
        to.transmission_error = from.transmission_error +
                                half * (inverse * (from.input_speed + to.input_speed) - (from.output_speed + to.output_speed));
    }

    // Error control. The torque shows what the hysteresis holds; where it turns over, friction that grows with it holds nothing,
    // be it for a moment.

    constexpr S watched(const Evaluation& at) const { return at.derivatives.mesh.torque; }
    constexpr State aligned(State x, const State& to) const {
        x.continuous.input_angle = x.continuous.input_angle + S(2.0 * pi) * (x.turns - to.turns);
        return x;
    }
    constexpr Continuous speeds(const Continuous& y) const {
        Continuous only = zeroed<S>(y);
        only.input_speed = y.input_speed;
        if (!prescribes(load)) only.output_speed = y.output_speed;  // else it follows no rate
        return only;
    }

    /// Calls visit(part, Domain) for each part that is valid within bounds only.
    template <class Visit>
    constexpr void bounds(const Derivatives& now, Visit&& visit) const {
        if (bounded<S>(gear.stiffness)) visit("gear.stiffness", domain<S>(gear.stiffness, now.mesh.twist));
        if (kinematic_error::follows_load(gear.kinematic_error))
            visit("gear.kinematic_error",
                  Domain<S>{"load_sensitivity times error times stiffness", S(1.0) - gear.unrelieved(now.mesh), S(-unbounded),
                            S(0.8), "1", "a smaller load_sensitivity keeps it there"});
        if (bounded<S>(gear.hysteresis)) visit("gear.hysteresis", domain<S>(gear.hysteresis, now.mesh.twist));
        if (bounded<Contact>(gear.friction_input)) visit("gear.friction_input", domain<S>(gear.friction_input, now.contacts.input));
        if (bounded<Contact>(gear.friction_mesh)) visit("gear.friction_mesh", domain<S>(gear.friction_mesh, now.contacts.mesh));
        if (bounded<Contact>(gear.friction_output))
            visit("gear.friction_output", domain<S>(gear.friction_output, now.contacts.output));
    }
    constexpr bool has_bounds() const {
        return kinematic_error::follows_load(gear.kinematic_error) || bounded<S>(gear.stiffness) || bounded<S>(gear.hysteresis) ||
               bounded<Contact>(gear.friction_input) || bounded<Contact>(gear.friction_mesh) ||
               bounded<Contact>(gear.friction_output);
    }

    constexpr S input_angle(const State& x, const Continuous& y) const { return y.input_angle + S(2.0 * pi) * x.turns; }
    constexpr S output_angle(const State& x, const Continuous& y) const {
        return input_angle(x, y) * gear.kinematics.inverse_ratio() - y.transmission_error;
    }
    template <class... Foreseen>
    constexpr Mesh geometry(const State& x, const Continuous& y, const Input& u, const Foreseen&... error) const {
        return gear.geometry(y.structure, gear_shafts(x, y, u), error...);
    }
    constexpr typename Gear::Shafts gear_shafts(const State& x, const Continuous& y, const Input& u) const {
        return gear_shafts(x, y, temperatures(y, u).gear);
    }
    constexpr typename Gear::Shafts gear_shafts(const State& x, const Continuous& y, const S& temperature) const {
        return gear.shafts({y.input_angle, x.turns}, y.input_speed, y.transmission_error, y.output_speed, temperature);
    }
    constexpr Mesh mesh(const State& x, const Continuous& y, const Input& u) const { return loaded(geometry(x, y, u), x, y, u); }
    constexpr Mesh loaded(const Mesh& geometry, const State& x, const Continuous& y, const Input& u) const {
        const S temperature = temperatures(y, u).gear;
        return gear.loaded(geometry, y.structure, gear_shafts(x, y, temperature), x.hysteresis, x.held_twist,
                           gear.material.torque(y.material), temperature);
    }
    constexpr thermal::Temperatures<S> temperatures(const Continuous& y, const Input& u) const {
        return thermal.at(y.thermal, u.temperature);
    }
    constexpr S input_inertia() const { return inertia_of<S>(motor) + gear.shaft_inertia(); }
    constexpr S output_inertia() const { return inertia_of<S>(load); }
    constexpr Rotor rotor(const State& x, const Continuous& y, const Input& u) const {
        return {{y.input_angle, x.turns}, y.input_speed, temperatures(y, u).winding};
    }
    /// The rotor, and the torque that its motion needs if the motor prescribes it.
    constexpr Rotor rotor(const State& x, const Continuous& y, const Input& u, const Derivatives& now) const {
        Rotor at = rotor(x, y, u);
        if constexpr (motor::can_prescribe<Motor>)
            if (motor::prescribes(motor)) at.torque = prescribed_motion::motor_torque<S>(*this, now);
        return at;
    }

    /// Quantities that sensors measure, under this torque of the gear.
    constexpr Measurement measurable(const State& x, const Continuous& y, const Input& u, const S& torque) const {
        return measurable(x, y, u, torque, control::held<S>(control, x.discrete.control));
    }
    constexpr Measurement measurable(const State& x, const Continuous& y, const Input& u, const S& torque,
                                     const S& actuation) const {
        const Rotor rotor = this->rotor(x, y, u);
        return {input_angle(x, y),
                y.input_speed,
                output_angle(x, y),
                y.output_speed,
                motor.current(y.motor, actuation, rotor),
                torque,
                motor::limits(motor, y.motor, rotor)};
    }
    /// Measurement for an external controller, which has set the present actuation.
    constexpr Measurement seen(const Evaluation& at, const Input& u) const {
        const Continuous& y = at.state.continuous;
        return sensors.shown(y.sensors, measurable(at.state, y, u, at.derivatives.mesh.torque, at.derivatives.actuation));
    }
    constexpr Output output(const Evaluation& at, const Input& u) const {
        const State& x = at.state;
        const Derivatives& now = at.derivatives;
        const Continuous& y = x.continuous;
        const S of_input = input_shaft(x, now).share_of_hold(), of_output = output_shaft(x, now).share_of_hold();
        const S braked = select(now.contacts.output.sliding == S(0.0), of_output * now.braking.hold, S(0.0));
        const S friction_output = friction::reported(gear.friction_output, now.contacts.output, now.friction_output, of_output);
        return {u.command,
                input_angle(x, y),
                y.input_speed,
                output_angle(x, y),
                y.output_speed,
                now.mesh.twist,
                now.mesh.error,
                y.transmission_error,
                now.mesh.torque,
                friction::reported(gear.friction_input, now.contacts.input, now.friction_input, of_input),
                friction::reported(gear.friction_mesh, now.contacts.mesh, now.friction_mesh, along(now.mesh.per_input, of_input)),
                friction_output,
                now.load_torque + braked,
                temperatures(y, u).gear,
                motor.output(y.motor, now.actuation, rotor(x, y, u, now)),
                thermal.output(y.thermal, u.temperature),
                measured(x, y, u, now),
                gear.output(y.structure, gear_shafts(x, y, u), now.mesh, friction_output)};
    }

private:
    /// A shaft that sticks does not accelerate.
    static constexpr S moving(const Contact& contact, const S& torque) { return select(contact.sliding == S(0.0), S(0.0), torque); }

    /// Temperatures and meter of an instant at which all else is known.
    constexpr void measure(const State& x, const Continuous& y, const Input& u, Derivatives& now) const {
        if constexpr (size_of<S, typename ThermalModel::State> > 0 || size_of<S, typename Meter::State> > 0) {
            if (!thermal.active() && !meter.active()) return;
            meter::Powers<S> power = powers<S>(*this, x, y, u, now);
            if (thermal.active()) {
                const S of_gear =
                    power.friction_input + power.friction_mesh + power.friction_output + power.damping + power.hysteresis;
                now.rate.thermal = thermal.rate(y.thermal, thermal::Heat<S>{power.motor, of_gear}, u.temperature);
            }
            if (!meter.active()) return;
            if (thermal.active()) power = powers<S>(*this, x, y, u, now);  // how fast the gear warms up is known by now
            now.rate.meter = meter.rate(power);
        }
    }
    constexpr typename Meter::Output measured(const State& x, const Continuous& y, const Input& u, const Derivatives& now) const {
        if constexpr (size_of<S, typename Meter::Output> > 0)
            if (meter.active()) return meter.output(y.meter, powers<S>(*this, x, y, u, now), stored<S>(*this, x, y, u, now));
        return {};
    }
    constexpr bool input_sticks() const {
        return !motor::prescribes(motor) && (friction::set_valued(gear.friction_input) || friction::set_valued(gear.friction_mesh));
    }
    constexpr bool output_sticks() const {
        return !prescribes(load) && (friction::set_valued(gear.friction_output) || brakes(load));
    }
    constexpr Braking<S> braking(const Input& u) const {
        if constexpr (load::can_brake<Load>)
            return strainwave::braking<S>(load, u.load);
        else
            return {};
    }

    constexpr Shaft input_shaft(const State& x, const Derivatives& now) const {
        const S hold = input_sticks() ? contacts::input_hold<S>(*this, now) : S(0.0);
        const S driving = motor::prescribes(motor) ? input_inertia() * now.rate.input_speed : now.input_driving_torque;
        return {input_sticks(), input_inertia(), x.continuous.input_speed, x.input_slip_direction, driving, hold};
    }
    constexpr Shaft output_shaft(const State& x, const Derivatives& now) const {
        const S hold = output_sticks() ? contacts::output_hold<S>(*this, now) : S(0.0);
        return {output_sticks(),         output_inertia(),          x.continuous.output_speed,
                x.output_slip_direction, now.output_driving_torque, hold};
    }

    constexpr control::Command<S> command(const Input& u) const { return {u.command, u.command_rate, gear.kinematics.ratio()}; }
};

}  // namespace strainwave
