#pragma once
#include <strainwave/compensation/compensator.hpp>
#include <strainwave/compensation/inverse_twist.hpp>
#include <strainwave/drive_model.hpp>

namespace strainwave::compensation {

/// States of the model's hysteresis and frictions after the commanded motion.
template <class S, class Hysteresis, class FrictionInput, class FrictionMesh, class FrictionOutput>
struct GearMemory {
    Hysteresis hysteresis{};
    FrictionInput friction_input{};
    FrictionMesh friction_mesh{};
    FrictionOutput friction_output{};

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, hysteresis, "Memory of the hysteresis"));
        visit(SW_PART(m, friction_input, "State of the friction at the input"));
        visit(SW_PART(m, friction_mesh, "State of the friction of the mesh"));
        visit(SW_PART(m, friction_output, "State of the friction at the output"));
    }
};

template <class S, class Gear_ = drive_model::PlainGear<S>, class Load_ = drive_model::PlainLoad<S>>
struct ModelFeedforward {
    using Gear = Gear_;
    using Load = Load_;

    Gear gear{};
    Load load{};
    S motor_inertia{0.0};
    S presliding{0.002};
    S friction_share{1.0};
    int rounds{4};
    S temperature{room_temperature};

    static constexpr auto name = "model_feedforward";
    static constexpr auto source =
        "the equations of the drive, solved for the input along the commanded motion; fixed point of the kinematic error: "
        "Banach1922; "
        "presliding of the sense of friction: Dahl1968";
    static constexpr auto doc = R"(
        Feed-forward of a model of the drive: the input angle and torque that move the output along its command.

        .. math:: T = J_{out} \ddot r + T_{load}(r, \dot r) + F_{out}, \qquad \delta: T_{gear}(\delta, \text{history}) = T, \qquad
                  \theta = i\,(r + e(\theta) + \delta)

        .. math:: \tau = J_{in} \ddot\theta + (T + F_{mesh})\,(1/i - e'(\theta)) + F_{in}

        with r the commanded output angle, i the signed ratio, T the torque that the gear transmits, delta its twist, e its
        kinematic error, theta the input angle, J_in = motor_inertia + gear.input_inertia. The request is the lead theta - i r
        of the input, and the torque tau. ``gear`` and ``load`` are the model. An effect that the model lacks is not
        compensated. The ratio of ``gear`` must be that of the drive.

        The fixed point theta <- i (r + e(theta) + delta) is repeated ``rounds`` times. It converges if q = |i| max|e'| < 1: each
        round reduces the error to at most the share q. delta lies on the branch of the hysteresis that the command follows.
        Rates are differences over a period, so the torque of inertia is half a period late.

        A set-valued friction acts in the sense s of the motion. At a reversal s changes gradually, as bristles bend before they
        slide: ds = (sgn(d theta) - s) |d theta| / presliding. Laws with bristles have presliding of their own. friction_share is
        the share of the friction that is compensated. Use less than 1 if the model may have too much friction: compensation
        beyond the true friction drives the joint by itself.

        Valid if the motion is slow against the vibration of load and gear. The model has no damping and no material of the spring, no
        noise, no bodies within the gear and no variation of the stiffness. Its temperature is constant.

        >>> import strainwave as sw
        >>> gear = sw.Gear(friction_input=sw.friction.Coulomb(coulomb=0.05))
        >>> sw.compensation.ModelFeedforward(gear=gear, load=sw.loads.Inertia(inertia=0.1)).rounds
        4)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, gear, "Model of the gear"));
        visit(SW_PART(m, load, "Model of the load"));
        visit(SW_FIELD(m, motor_inertia, "kg.m2", "Inertia of the motor's rotor", 0));
        visit(SW_FIELD(m, presliding, "rad", "Input angle over which the old sense of set-valued friction falls to 1/e", smallest));
        visit(SW_FIELD(m, friction_share, "1", "Share of the friction that is compensated", 0, 1));
        visit(SW_FIELD(m, rounds, "1", "Rounds of the fixed point; 0 leaves the kinematic error out", 0, 8));
        visit(SW_FIELD(m, temperature, "K", "Temperature of the gear", smallest));
    }

    constexpr Contradiction<S> problem() const {
        if (const auto contradiction = drive_model::problem_of_load<S>(load); contradiction.text) return contradiction;
        const S contraction = drive_model::contraction<S>(gear);
        if (rounds == 0 || all(contraction < S(1.0))) return {};
        return {
            "the kinematic error cannot be fed forward: |ratio| times its steepest slope is {}, and must be less than 1; set "
            "rounds = 0 to leave it out",
            contraction};
    }

    constexpr S model_ratio() const { return gear.kinematics.ratio(); }

    constexpr auto compile() const {
        return ModelFeedforward<S, decltype(gear.compile()), decltype(compiled(load))>{
            gear.compile(), compiled(load), motor_inertia, presliding, friction_share, rounds, temperature};
    }

    using Memory = GearMemory<S, typename decltype(Gear{}.hysteresis)::State, typename decltype(Gear{}.friction_input)::State,
                              typename decltype(Gear{}.friction_mesh)::State, typename decltype(Gear{}.friction_output)::State>;
    struct State {
        Memory gear{};
        S twist{0.0};
        S speed{0.0};
        S lead_rate{0.0};
        S sense{0.0};
        S begun{0.0};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_PART(m, gear, "States of hysteresis and friction of the model"));
            visit(SW_FIELD(m, twist, "rad", "Twist of the model"));
            visit(SW_FIELD(m, speed, "rad/s", "Output speed commanded"));
            visit(SW_FIELD(m, lead_rate, "rad/s", "Rate of the lead of the input"));
            visit(SW_FIELD(m, sense, "1", "Sense of friction, in [-1, 1]"));
            visit(SW_FIELD(m, begun, "1", "1 after the first instant"));
        }
    };
    constexpr State initial_state() const {
        State x{};
        x.gear = {strainwave::initial_state(gear.hysteresis), strainwave::initial_state(gear.friction_input),
                  strainwave::initial_state(gear.friction_mesh), strainwave::initial_state(gear.friction_output)};
        return x;
    }

    constexpr RequestAndState<S, State> step(const State& x, const control::Command<S>& command, const S& period) const {
        const auto changed = [&](const S& now, const S& before) { return x.begun * (now - before) / period; };
        State next = x;
        const S acceleration = changed(command.rate, x.speed);
        const S output_sense = sign(command.ratio) * x.sense;
        const S carried = inertia_of<S>(load) * acceleration + load_torque<S>(load, command.value, command.rate, S(0.0)) +
                          output_sense * braking<S>(load, S(0.0)).slip;
        const S inverse = S(1.0) / command.ratio;
        const Contact output{command.rate, output_sense, reduced(command.value), carried, temperature};
        const S at_output = slid(gear.friction_output, x.gear.friction_output, output, period, next.gear.friction_output);
        const S transmitted = carried + at_output;

        next.twist = inverse_twist(gear, x.gear.hysteresis, x.twist, transmitted, temperature);
        next.gear.hysteresis = gear.hysteresis.advance(x.gear.hysteresis, next.twist - x.twist);
        const S twist_rate = changed(next.twist, x.twist);
        const auto error = engaged(command, next.twist, transmitted);
        const S lead = command.ratio * (error.value + next.twist);
        // input speed = ratio (rate + twist rate + slope * input speed)
        const S follows = max(S(1.0) - command.ratio * error.slope, S(least_follow));
        const S speed = command.ratio * (command.rate + twist_rate) / follows;
        const S lead_rate = speed - command.ratio * command.rate;
        const S input_acceleration = command.ratio * acceleration + changed(lead_rate, x.lead_rate);

        const S per_input = inverse - error.slope;
        const Angle<S> angle = reduced(command.ratio * command.value + lead);
        const Contact mesh{speed * per_input, output_sense, reduced(command.value), transmitted, temperature};
        const S at_mesh = slid(gear.friction_mesh, x.gear.friction_mesh, mesh, period, next.gear.friction_mesh);
        const Contact input{speed, x.sense, angle, per_input * transmitted, temperature};
        const S at_input = slid(gear.friction_input, x.gear.friction_input, input, period, next.gear.friction_input);
        const S friction = friction_share * (at_input + per_input * (at_mesh + at_output));

        next.speed = command.rate;
        next.lead_rate = lead_rate;
        next.begun = S(1.0);
        next.sense = slid_sense(x.sense, speed * period, presliding);
        const S inertial = (motor_inertia + gear.input_inertia) * input_acceleration;
        return {{lead, lead_rate, command.ratio * next.twist, inertial + per_input * carried + friction, friction}, next};
    }

private:
    using Contact = friction::Contact<S>;
    static constexpr double least_follow = 0.1;  ///< share of the commanded speed that the input keeps where the error is steep

    /// Friction torque after one more period of motion. Sets `next` to the state after it.
    template <class Law>
    static constexpr S slid(const Law& law, const typename Law::State& x, const Contact& at, const S& period,
                            typename Law::State& next) {
        next = friction::slide(law, x, at, period);
        return friction::torque(law, next, at);
    }
    /// The kinematic error at the input angle that the command needs.
    constexpr kinematic_error::Error<S> engaged(const control::Command<S>& command, const S& twist, const S& torque) const {
        const S relief = kinematic_error::relief(gear.kinematic_error, torque).factor;
        kinematic_error::Error<S> error{};
        for (int i = 0; i < rounds; ++i) {
            const auto full = gear.kinematic_error.at(reduced(command.ratio * (command.value + twist + error.value)));
            error = {relief * full.value, relief * full.slope};
        }
        return error;
    }
};

}  // namespace strainwave::compensation
