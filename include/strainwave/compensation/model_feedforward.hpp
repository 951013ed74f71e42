#pragma once
#include <strainwave/compensation/compensator.hpp>
#include <strainwave/compensation/inverse_twist.hpp>
#include <strainwave/friction/coulomb.hpp>
#include <strainwave/gear.hpp>
#include <strainwave/hysteresis/maxwell_slip.hpp>
#include <strainwave/kinematic_error/fourier.hpp>
#include <strainwave/kinematic_error/steepest.hpp>
#include <strainwave/kinematic_error/stochastic.hpp>
#include <strainwave/kinematics.hpp>
#include <strainwave/load/inertia.hpp>
#include <strainwave/load/load.hpp>
#include <strainwave/softening/thermal_softening.hpp>
#include <strainwave/stiffness/linear.hpp>

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

template <class S>
using PlainGear = Gear<S, kinematics::StrainWave<S>, kinematic_error::Fourier<S>, kinematic_error::Stochastic<S>,
                       stiffness::Linear<S>, hysteresis::MaxwellSlip<S>, friction::Coulomb<S>, friction::Coulomb<S>,
                       friction::Coulomb<S>, softening::ThermalSoftening<S>>;

template <class S, class Gear_ = PlainGear<S>, class Load_ = load::Inertia<S>>
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
        What a model of the drive asks for so that the output moves as it is commanded, before any error.

        .. math:: T = J_{out} \ddot r + T_{load}(r, \dot r) + F_{out}, \qquad \delta: T_{gear}(\delta, \text{history}) = T, \qquad
                  \theta = i\,(r + e(\theta) + \delta)

        .. math:: \tau = J_{in} \ddot\theta + (T + F_{mesh})\,(1/i - e'(\theta)) + F_{in}

        with r the commanded output angle, i the signed ratio, T the torque that the gear must transmit, delta its twist, e its
        kinematic error, theta the input angle that belongs to all that, J_in = motor_inertia + gear.input_inertia. The controller
        is given theta - i r as a lead of the input, and tau. ``gear`` and ``load`` are what is known of the drive: an effect
        that is left out of them is not compensated. The ratio of ``gear`` is that of the drive.

        theta is found by ``rounds`` rounds of theta <- i (r + e(theta) + delta), which converge if q = |i| max|e'| < 1: each
        leaves at most the share q of the error before. delta is found on the branch of the hysteresis that the command follows.
        Rates are differences over a period, so inertia comes half a period late. A set-valued friction acts in the sense s of
        the motion, which does not jump where the command turns back: ds = (sgn(d theta) - s) |d theta| / presliding, as a
        contact does that bends before it slides; laws with bristles have that of their own. friction_share takes part of all
        friction: less than 1 where the model may have too much of it, since friction compensated more than once drives by itself.

        Valid where the motion is slow against the vibration of load and gear. Leaves out damping of the spring, noise, bodies
        within the gear and the variation of the stiffness. The temperature is taken to be ``temperature``.

        >>> import strainwave as sw
        >>> gear = sw.Gear(friction_input=sw.friction.Coulomb(coulomb=0.05))
        >>> sw.compensation.ModelFeedforward(gear=gear, load=sw.loads.Inertia(inertia=0.1)).rounds
        4)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, gear, "What is known of the gear"));
        visit(SW_PART(m, load, "What the output carries"));
        visit(SW_FIELD(m, motor_inertia, "kg.m2", "Inertia of the motor's rotor", 0));
        visit(SW_FIELD(m, presliding, "rad", "Input angle over which the old sense of set-valued friction falls to 1/e", smallest));
        visit(SW_FIELD(m, friction_share, "1", "Share of the friction that is asked for", 0, 1));
        visit(SW_FIELD(m, rounds, "1", "Rounds in which the kinematic error is found; 0 leaves it out", 0, 8));
        visit(SW_FIELD(m, temperature, "K", "Temperature of the gear", smallest));
    }

    constexpr Contradiction<S> problem() const {
        if (moves_output(load))
            return {
                "load must not be Prescribed, which moves the output by itself and needs no torque; give the load that a motor "
                "moves"};
        const S contraction = abs(gear.kinematics.ratio()) * kinematic_error::steepest<S>(gear.kinematic_error);
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
            visit(SW_PART(m, gear, "What the model of the gear remembers"));
            visit(SW_FIELD(m, twist, "rad", "Twist of the model"));
            visit(SW_FIELD(m, speed, "rad/s", "Output speed commanded"));
            visit(SW_FIELD(m, lead_rate, "rad/s", "How fast the input led the rigid motion"));
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
        const auto found = engaged(command, next.twist, transmitted);
        const S lead = command.ratio * (found.value + next.twist);
        // input speed = ratio (rate + twist rate + slope * input speed)
        const S follows = max(S(1.0) - command.ratio * found.slope, S(least_follow));
        const S speed = command.ratio * (command.rate + twist_rate) / follows;
        const S lead_rate = speed - command.ratio * command.rate;
        const S input_acceleration = command.ratio * acceleration + changed(lead_rate, x.lead_rate);

        const S per_input = inverse - found.slope;
        const Angle<S> angle = reduced(command.ratio * command.value + lead);
        const Contact mesh{speed * per_input, output_sense, reduced(command.value), transmitted, temperature};
        const S at_mesh = slid(gear.friction_mesh, x.gear.friction_mesh, mesh, period, next.gear.friction_mesh);
        const Contact input{speed, x.sense, angle, per_input * transmitted, temperature};
        const S at_input = slid(gear.friction_input, x.gear.friction_input, input, period, next.gear.friction_input);
        const S friction = friction_share * (at_input + per_input * (at_mesh + at_output));

        next.speed = command.rate;
        next.lead_rate = lead_rate;
        next.begun = S(1.0);
        const S moved = speed * period, towards = sign(moved);
        next.sense = towards + (x.sense - towards) * exp(-min(abs(moved) / presliding, S(beyond_digits)));
        next.sense = select(towards == S(0.0), x.sense, next.sense);
        const S inertial = (motor_inertia + gear.input_inertia) * input_acceleration;
        return {{lead, lead_rate, command.ratio * next.twist, inertial + per_input * carried + friction, friction}, next};
    }

private:
    using Contact = friction::Contact<S>;
    /// True if the output moves as its load says, whatever the torque; asked of a choice, of the load chosen.
    template <class Carried>
    static constexpr bool moves_output(const Carried& carried) {
        if constexpr (requires { carried.model; })
            return carried.visit([](const auto& chosen) { return moves_output(chosen); });
        else
            return prescribes(carried);
    }
    static constexpr double least_follow = 0.1;  ///< share of the commanded speed that the input keeps where the error is steep

    /// The torque of a friction, in the state that the motion left it in; `next` is that a period on.
    template <class Law>
    static constexpr S slid(const Law& law, const typename Law::State& x, const Contact& at, const S& period,
                            typename Law::State& next) {
        next = friction::clamped(law, friction::update_mode(law, friction::advance(law, x, at, period), at), at);
        return friction::torque(law, next, at);
    }
    /// The kinematic error where the input must stand.
    constexpr kinematic_error::Error<S> engaged(const control::Command<S>& command, const S& twist, const S& torque) const {
        const S relief = kinematic_error::relief(gear.kinematic_error, torque).factor;
        kinematic_error::Error<S> found{};
        for (int i = 0; i < rounds; ++i) {
            const auto full = gear.kinematic_error.at(reduced(command.ratio * (command.value + twist + found.value)));
            found = {relief * full.value, relief * full.slope};
        }
        return found;
    }
    static constexpr Angle<S> reduced(const S& angle) {
        const S turns = rint(angle * S(0.5 / pi));
        return {angle - S(2.0 * pi) * turns, turns};
    }
};

}  // namespace strainwave::compensation
