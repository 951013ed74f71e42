#pragma once
#include <strainwave/compiled.hpp>
#include <strainwave/field.hpp>
#include <strainwave/kinematic_error/error.hpp>
#include <strainwave/math.hpp>

namespace strainwave {

/// What a spring takes the ratio of its gear for, without sign; 0 if it does not ask.
template <class S, class Spring>
constexpr S reduction_of(const Spring& spring) {
    if constexpr (requires { spring.reduction; })
        return spring.reduction;
    else
        return S(0.0);
}

template <class S, class Kinematics, class KinematicError, class KinematicNoise, class Stiffness, class Hysteresis,
          class FrictionInput, class FrictionMesh, class FrictionOutput, class Softening>
struct Gear {
    Kinematics kinematics{};
    KinematicError kinematic_error{};
    KinematicNoise kinematic_noise{};
    Stiffness stiffness{};
    Hysteresis hysteresis{};
    S damping{0.0};
    FrictionInput friction_input{};
    FrictionMesh friction_mesh{};
    FrictionOutput friction_output{};
    S input_inertia{0.0};
    Softening softening{};

    static constexpr auto name = "gear";
    static constexpr auto source =
        "physics: document R, sections 1-4, with the reaction of the kinematic error (errata E-R3, E-A5)";
    static constexpr auto doc = R"(
        One strain wave gear: rigid motion, kinematic error, stiffness, hysteresis, damping, friction at three places.

        .. math:: \delta = \theta_{in}/i - \theta_{out} - e(\theta_{in}), \qquad
                  T = T_{stiffness}(\delta) + T_{hysteresis}(\delta, \text{history}) + c\,\dot\delta

        T acts on the output and, as T (1/i - e'(theta_in)), on the input. The e' term is the reaction of the error on the
        input: the review derives none (E-R3) and the actuator paper omits it (E-A5), but without it energy is not conserved.
        e is the deterministic kinematic error plus the noise, whose amplitude follows the elastic torque and the input speed.

        Friction acts at the input (wave generator), at the mesh, and at the output (bearing). The mesh lies between the
        kinematics and the spring: it moves with (1/i - e') times the input speed, at the output's scale, transmits T, and
        what it takes weighs on the input. Every law of friction may stand at every place, each under the load that its place
        transmits, the angle it stands at and the temperature.

        Every part is a law of its own, from the ideal gear to one with all effects over the whole envelope of speed, load and
        temperature; change one with ``gear.replace(hysteresis=...)``.

        >>> import strainwave as sw
        >>> gear = sw.Gear(stiffness=sw.stiffness.Cubic(a1=1.2e4, a3=1e9), damping=10.0)
        >>> gear.stiffness.a1
        12000.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, kinematics, "Rigid motion: teeth and fixed member"));
        visit(SW_PART(m, kinematic_error, "Pure kinematic error at the output, over the input angle"));
        visit(SW_PART(m, kinematic_noise, "Random kinematic error, added to the deterministic one"));
        visit(SW_PART(m, stiffness, "Elastic torque over the twist"));
        visit(SW_PART(m, hysteresis, "Torque that depends on the history of the twist"));
        visit(SW_FIELD(m, damping, "N.m.s/rad", "Torque per rate of twist", 0));
        visit(SW_PART(m, friction_input, "Friction at the wave generator, over the input speed"));
        visit(SW_PART(m, friction_mesh, "Friction of the mesh, at the output's scale, over the speed of the input referred to it"));
        visit(SW_PART(m, friction_output, "Friction at the output, over the output speed"));
        visit(SW_FIELD(m, input_inertia, "kg.m2", "Inertia of the wave generator", 0));
        visit(SW_PART(m, softening, "How stiffness and hysteresis give way as the gear warms up"));
    }

    constexpr const char* problem() const {
        const S told = reduction_of<S>(stiffness), ratio = abs(kinematics.ratio()), rounding(1e-9);
        return all((told == S(0.0)) | (abs(told - ratio) <= rounding * ratio))
                   ? nullptr
                   : "stiffness.reduction must be the ratio of kinematics, without its sign; give both";
    }

    /// Every part as the integrator wants it.
    constexpr auto compile() const {
        return Gear<S, decltype(compiled(kinematics)), decltype(compiled(kinematic_error)), decltype(compiled(kinematic_noise)),
                    decltype(compiled(stiffness)), decltype(compiled(hysteresis)), decltype(compiled(friction_input)),
                    decltype(compiled(friction_mesh)), decltype(compiled(friction_output)), decltype(compiled(softening))>{
            compiled(kinematics),      compiled(kinematic_error),
            compiled(kinematic_noise), compiled(stiffness),
            compiled(hysteresis),      damping,
            compiled(friction_input),  compiled(friction_mesh),
            compiled(friction_output), input_inertia,
            compiled(softening)};
    }

    /// How the two shafts stand to each other.
    struct Mesh {
        S error;       ///< Kinematic error e, rad
        S per_input;   ///< Twist per input angle: 1/i - e', rad/rad
        S twist;       ///< rad
        S twist_rate;  ///< rad/s
        S torque;      ///< Transmitted torque T at the output, N.m
    };

    /// All of it but the torque. `transmission_error` is theta_in / i - theta_out.
    constexpr Mesh geometry(const Angle<S>& input_angle, const S& input_speed, const S& transmission_error,
                            const S& output_speed) const {
        const kinematic_error::Error<S> error = this->error(input_angle, input_speed, transmission_error);
        const S per_input = kinematics.inverse_ratio() - error.slope;
        return {error.value, per_input, transmission_error - error.value, per_input * input_speed - output_speed, S(0.0)};
    }
    /// How fast the random error changes [rad/s] because its amplitude does so; what the angle does is in the twist rate.
    /// `transmission_rate` is that of the transmission error [rad/s].
    constexpr S noise_rate(const Angle<S>& input_angle, const S& input_speed, const S& acceleration, const S& transmission_error,
                           const S& transmission_rate) const {
        if (!kinematic_noise.active()) return S(0.0);
        const kinematic_error::Error<S> error = kinematic_error.at(input_angle);
        const S twist = transmission_error - error.value, twist_rate = transmission_rate - error.slope * input_speed;
        const S torque = stiffness.torque(twist), torque_rate = stiffness.tangent(twist) * twist_rate;
        return kinematic_noise.at(input_angle, torque, input_speed).value *
               kinematic_noise.growth(torque, torque_rate, input_speed, acceleration);
    }
    /// The torque of a gear that stands so at a temperature [K], its hysteresis last brought up to date at `held_twist`.
    constexpr Mesh loaded(Mesh mesh, const typename Hysteresis::State& held, const S& held_twist, const S& temperature) const {
        mesh.torque = held_torque(mesh.twist, held, mesh.twist - held_twist, temperature) + damping * mesh.twist_rate;
        return mesh;
    }
    /// What spring and hysteresis hold at a twist [rad], `moved` [rad] from where the hysteresis was last brought up to date, N.m.
    constexpr S held_torque(const S& twist, const typename Hysteresis::State& held, const S& moved, const S& temperature) const {
        const S elastic = stiffness.torque(twist), remembered = hysteresis.torque(held, moved);
        if (!softening.active()) return elastic + remembered;
        return softening.of_stiffness(temperature) * elastic + softening.of_hysteresis(temperature) * remembered;
    }
    /// What the spring alone holds, N.m, and the energy in it, J.
    constexpr S spring_torque(const S& twist, const S& temperature) const {
        return spring_factor(temperature) * stiffness.torque(twist);
    }
    constexpr S spring_energy(const S& twist, const S& temperature) const {
        return spring_factor(temperature) * stiffness.energy(twist);
    }

    /// The largest stiffness [N.m/rad] of the spring at twists up to `twist` [rad], of either sign, and with it that of the
    /// hysteresis where it is first loaded, at a temperature [K]; on turning back some are up to twice as stiff.
    constexpr S steepest(const S& twist, const S& temperature) const {
        constexpr int parts = 64;
        S largest = stiffness.tangent(S(0.0));
        for (int i = -parts; i <= parts; ++i) largest = max(largest, stiffness.tangent(twist * S(double(i) / parts)));
        const S little(1e-12);  // rad: within any loop's first slope, and more than rounding
        const S remembered = hysteresis.torque(typename Hysteresis::State{}, little) / little;
        if (!softening.active()) return largest + remembered;
        return softening.of_stiffness(temperature) * largest + softening.of_hysteresis(temperature) * remembered;
    }

private:
    constexpr S spring_factor(const S& temperature) const {
        return softening.active() ? softening.of_stiffness(temperature) : S(1.0);
    }
    /// The noise follows the elastic torque that there is without it, so that neither waits for the other.
    constexpr kinematic_error::Error<S> error(const Angle<S>& input_angle, const S& input_speed,
                                              const S& transmission_error) const {
        kinematic_error::Error<S> error = kinematic_error.at(input_angle);
        if (kinematic_noise.active()) {
            const S torque = stiffness.torque(transmission_error - error.value);
            const kinematic_error::Error<S> noise = kinematic_noise.at(input_angle, torque, input_speed);
            error = {error.value + noise.value, error.slope + noise.slope};
        }
        return error;
    }
};

}  // namespace strainwave
