#pragma once
#include <strainwave/compiled.hpp>
#include <strainwave/condition.hpp>
#include <strainwave/facts.hpp>
#include <strainwave/field.hpp>
#include <strainwave/kinematic_error/error.hpp>
#include <strainwave/material/elastic.hpp>
#include <strainwave/math.hpp>
#include <strainwave/structure/lumped.hpp>
#include <strainwave/variation/constant.hpp>

namespace strainwave {

template <class S, class Kinematics, class KinematicError, class KinematicNoise, class Stiffness, class Hysteresis,
          class FrictionInput, class FrictionMesh, class FrictionOutput, class Softening, class Structure = structure::Lumped<S>,
          class Variation = variation::Constant<S>, class Material = material::Elastic<S>>
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
    Variation stiffness_variation{};
    Structure structure{};
    Material material{};

    static constexpr auto name = "gear";
    static constexpr auto source =
        "physics: " SW_REVIEW
        ", sections 1-4, with the reaction of the kinematic error, which it lacks; for the bodies within it, " SW_ACTUATOR_PAPER;
    static constexpr auto doc = R"(
        Strain wave gear: rigid motion, kinematic error, stiffness, hysteresis, damping, friction at three places.

        .. math:: \delta = \theta_{in}/i - \theta_{out} - e(\theta_{in}), \qquad
                  T = T_{stiffness}(\delta) + T_{hysteresis}(\delta, \text{history}) + c\,\dot\delta + T_{material}(\delta, t)

        T acts on the output and, as T (1/i - e'(theta_in)), on the input. The e' term is the reaction of the error on the
        input. The review derives none and the actuator paper omits it; without it energy is not conserved. e is
        the deterministic kinematic error, at the temperature of the gear, plus the noise, whose amplitude follows the elastic
        torque and the input speed.

        Friction acts at the input (wave generator), at the mesh, and at the output (bearing). The mesh lies between the
        kinematics and the spring: it moves with (1/i - e') times the input speed, at the output's scale, transmits T, and its
        friction acts on the input. Every law of friction is allowed at every place. It depends on the load that its place
        transmits, the angle of the place and the temperature.

        The ``material`` relaxes over time, so that its loss depends on the frequency; hysteresis depends on the path alone.

        If the stiffness varies with the angle of the wave generator, the energy in the spring also turns the wave generator.
        The ``structure`` determines whether the bodies between input shaft and output shaft have their own motion.

        Parameters that two parts have in common must agree: the ratio, the teeth, and, with stages, pitch radius and pressure
        angle.

        Each part is a separate law, from the ideal gear to a gear with all effects of speed, load and temperature. Change one
        with ``gear.replace(hysteresis=...)``.

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
        visit(SW_PART(m, softening, "Fall of stiffness and hysteresis with the temperature"));
        visit(SW_PART(m, stiffness_variation, "Variation of the stiffness with the angle of the wave generator"));
        visit(SW_PART(m, structure, "Bodies within the gear that have their own motion"));
        visit(SW_PART(m, material, "Torque that relaxes over time: internal damping of flexspline and elastomers"));
    }

    /// Parameters that two parts have in common must agree.
    constexpr Contradiction<S> problem() const {
        const S ratio = abs(kinematics.ratio());
        const S of_stiffness = facts::reduction<S>(stiffness), of_hysteresis = facts::reduction<S>(hysteresis);
        if (!facts::agree(of_stiffness, ratio))
            return {"stiffness.reduction = {} must be {}, the ratio of kinematics without its sign; give both alike", of_stiffness,
                    ratio};
        if (!facts::agree(of_hysteresis, ratio))
            return {"hysteresis.springs.reduction = {} must be {}, the ratio of kinematics without its sign; give both alike",
                    of_hysteresis, ratio};
        const S radius = facts::pitch_radius<S>(kinematic_error), own_radius = facts::pitch_radius<S>(structure);
        if (!facts::agree(radius, own_radius))
            return {"the pitch_radius of kinematic_error, {} m, must be that of structure, {} m; give both alike", radius,
                    own_radius};
        const S angle = facts::pressure_angle<S>(kinematic_error), own_angle = facts::pressure_angle<S>(structure);
        if (!facts::agree(angle, own_angle))
            return {"the pressure_angle of kinematic_error, {} rad, must be that of structure, {} rad; give both alike", angle,
                    own_angle};
        const Contradiction<S> of_teeth = problem_of_teeth(ratio);
        if (of_teeth.text) return of_teeth;
        if (!structure.rigid() && !all(input_inertia > S(0.0)))
            return {"input_inertia = {} kg.m2 must exceed 0 with stages: the wave generator is a body of its own; give its inertia",
                    input_inertia};
        return {};
    }

    /// Every part as the integrator wants it.
    constexpr auto compile() const {
        return Gear<S, decltype(compiled(kinematics)), decltype(compiled(kinematic_error)), decltype(compiled(kinematic_noise)),
                    decltype(compiled(stiffness)), decltype(compiled(hysteresis)), decltype(compiled(friction_input)),
                    decltype(compiled(friction_mesh)), decltype(compiled(friction_output)), decltype(compiled(softening)),
                    decltype(compiled(structure)), decltype(compiled(stiffness_variation)), decltype(compiled(material))>{
            compiled(kinematics),      compiled(kinematic_error),
            compiled(kinematic_noise), compiled(stiffness),
            compiled(hysteresis),      damping,
            compiled(friction_input),  compiled(friction_mesh),
            compiled(friction_output), input_inertia,
            compiled(softening),       compiled(stiffness_variation),
            compiled(structure),       compiled(material)};
    }

    using Shafts = structure::Shafts<S>;
    using Inner = typename Structure::State;

    static constexpr bool always_rigid = size_of<S, Inner> == 0;
    using Mesh = structure::Mesh<S, Inner>;

    constexpr Shafts shafts(const Angle<S>& input_angle, const S& input_speed, const S& transmission_error, const S& output_speed,
                            const S& temperature) const {
        return {input_angle, input_speed, transmission_error, output_speed, kinematics.inverse_ratio(), temperature};
    }

    /// True if the kinematic error at two angles takes little longer than at one.
    static constexpr bool foresees =
        always_rigid && requires(const KinematicError& law, const Angle<S>& angle) { law.at(angle, angle); };

    /// All of it but the torques.
    constexpr Mesh geometry(const Inner& inner, const Shafts& at) const { return geometry(inner, at, full_error(inner, at)); }
    /// The same where the law's kinematic error is known.
    constexpr Mesh geometry(const Inner& inner, const Shafts& at, const kinematic_error::Error<S>& full) const {
        Engaged found = engaged(inner, at, full);
        Mesh mesh{};
        mesh.error = found.error.value;
        mesh.per_input = found.per_output * at.inverse_ratio - found.error.slope;
        mesh.per_output = found.per_output;
        mesh.twist = structure.spring_twist(inner, at, found.deformation);
        mesh.twist_rate = structure.spring_twist_rate(inner, at, mesh);
        if constexpr (!always_rigid) {
            mesh.apart.deformation = found.deformation;
            mesh.apart.per_twist = found.per_twist;
            mesh.apart.deformation_rate = structure.deformation_rate(inner, mesh);
        }
        return mesh;
    }
    /// Rate of the error [rad/s] at constant angles: of the random error, whose amplitude changes as the input shaft accelerates
    /// at `acceleration` [rad/s2], and of a gear that warms up at `warming` [K/s]. What the angle does is in the rate of the
    /// deformation.
    constexpr S error_drift(const Inner& inner, const Shafts& at, const Mesh& mesh, const S& acceleration, const S& warming) const {
        const bool warms = kinematic_error::follows_temperature(kinematic_error);
        if (!kinematic_noise.active() && !warms) return S(0.0);
        const auto generator = structure.generator(inner, at);
        const Engaged without = engaged_without_noise(inner, at, full_error(inner, at));
        S by_warming{0.0};
        if (warms)
            by_warming =
                without.per_output * without.relief * kinematic_error::per_kelvin<S>(kinematic_error, generator.angle) * warming;
        if (!kinematic_noise.active()) return by_warming;
        const S rate = structure.rigid() ? without.per_output * (at.inverse_ratio * at.input_speed - at.output_speed) -
                                               without.error.slope * at.input_speed - by_warming
                                         : mesh.twist_rate;
        const S torque = stiffness.torque(without.twist), torque_rate = stiffness.tangent(without.twist) * rate;
        const S noise = kinematic_noise.drift(generator.angle, torque, torque_rate, generator.speed,
                                              structure.generator_acceleration(mesh.rate, acceleration));
        return by_warming + noise;
    }
    /// The torques of a gear at these angles and a temperature [K], its hysteresis last brought up to date at `held_twist`, its
    /// material holding a torque `relaxing` [N.m].
    constexpr Mesh loaded(Mesh mesh, const Inner& inner, const Shafts& at, const typename Hysteresis::State& held,
                          const S& held_twist, const S& relaxing, const S& temperature) const {
        variation::Factor<S> factor = stiffness_factor(inner, at);
        mesh.spring = held_torque(mesh.twist, held, mesh.twist - held_twist, temperature, factor.value) + damping * mesh.twist_rate;
        if (material.active()) mesh.spring = mesh.spring + relaxing;
        auto reaction = structure.reaction(inner, at, mesh, load(mesh, turning(factor, mesh.twist, temperature)));
        mesh.torque = reaction.torque;
        mesh.input_torque = reaction.input_torque;
        mesh.rate = reaction.rate;
        return mesh;
    }
    /// Turns its sign where the slope of the kinematic error jumps.
    constexpr S side(const Angle<S>& generator) const { return kinematic_error::side<S>(kinematic_error, generator); }
    /// The torques of the gear without its kinematic error, on springs that do not vary, its own as stiff as at rest: linear in
    /// how it stands and moves. Most of what drives bodies within it is here.
    constexpr structure::Reaction<S, Inner> even_reaction(const Inner& inner, const Shafts& at) const {
        Mesh mesh{};
        mesh.per_input = at.inverse_ratio;
        mesh.per_output = S(1.0);
        const S gap = structure.gap(inner, at);
        mesh.twist = structure.spring_twist(inner, at, gap);
        mesh.twist_rate = structure.spring_twist_rate(inner, at, mesh);
        if constexpr (!always_rigid) {
            mesh.apart.deformation = gap;
            mesh.apart.deformation_rate = structure.deformation_rate(inner, mesh);
        }
        mesh.spring = even_stiffness() * mesh.twist + damping * mesh.twist_rate;
        return structure.even_reaction(inner, at, mesh, load(mesh, S(0.0)));
    }
    constexpr S even_stiffness() const { return stiffness.tangent(S(0.0)); }
    /// Factor of the mean stiffness of the spring, and its slope over the angle of the wave generator.
    constexpr variation::Factor<S> stiffness_factor(const Inner& inner, const Shafts& at) const {
        if (!stiffness_variation.active()) return {};
        return stiffness_variation.at(structure.generator(inner, at).angle);
    }
    /// Torque of spring and hysteresis at a twist [rad], `moved` [rad] from where the hysteresis was last brought up to date, N.m;
    /// the stiffness is `factor` times its mean.
    constexpr S held_torque(const S& twist, const typename Hysteresis::State& held, const S& moved, const S& temperature,
                            const S& factor = S(1.0)) const {
        return softened(factor * stiffness.torque(twist), hysteresis.torque(held, moved), temperature);
    }
    /// Sum of the torques of spring and hysteresis [N.m] at a temperature [K].
    constexpr S softened(const S& elastic, const S& remembered, const S& temperature) const {
        if (!softening.active()) return elastic + remembered;
        return softening.of_stiffness(temperature) * elastic + softening.of_hysteresis(temperature) * remembered;
    }
    /// Torque of the spring alone, N.m.
    constexpr S spring_torque(const Inner& inner, const Shafts& at, const Mesh& mesh, const S& temperature) const {
        return stiffness_factor(inner, at).value * softness(temperature) * stiffness.torque(mesh.twist);
    }
    /// The energy in it, J.
    constexpr S spring_energy(const Inner& inner, const Shafts& at, const Mesh& mesh, const S& temperature) const {
        return stiffness_factor(inner, at).value * softness(temperature) * stiffness.energy(mesh.twist);
    }
    /// Energies of the bodies within the gear.
    constexpr auto energies(const Inner& inner, const Shafts& at, const Mesh& mesh) const {
        return structure.energies(inner, at, mesh, load(mesh, S(0.0)));
    }
    constexpr auto output(const Inner& inner, const Shafts& at, const Mesh& mesh, const S& friction) const {
        return structure.output(inner, at, mesh, friction);
    }

    /// State of the gear at rest at a twist of its spring [rad], under this torque of spring and hysteresis [N.m].
    constexpr auto steady_state(const Inner& inner, const Shafts& at, Mesh mesh, const S& twist, const S& torque,
                                const S& temperature) const {
        mesh.twist = twist;
        mesh.spring = torque;
        return structure.steady_state(inner, at, mesh, load(mesh, turning(stiffness_factor(inner, at), twist, temperature)));
    }
    /// Torque of the spring so that this torque [N.m] reaches the output at rest: not the same if the error follows the load.
    constexpr S spring_torque_for(const Mesh& mesh, const S& torque) const { return torque * unrelieved(mesh); }
    /// Share of the twist that is not relief of the error: 1 if the error does not follow the load.
    constexpr S unrelieved(const Mesh& mesh) const {
        if constexpr (!always_rigid)
            if (!structure.rigid()) return S(1.0) + mesh.apart.per_twist;
        return S(1.0) / mesh.per_output;
    }
    /// Compliance of the gear without its spring, rad/(N.m).
    constexpr S compliance(const Shafts& at, const Mesh& mesh) const { return structure.compliance(at, mesh); }

    /// Inertia of the wave generator that turns with the input shaft, kg.m2.
    constexpr S shaft_inertia() const { return structure.rigid() ? input_inertia : S(0.0); }

    /// The largest stiffness [N.m/rad] at twists up to `twist` [rad], of either sign, and at a temperature [K]: that of the spring,
    /// and with it that of the hysteresis as it is first loaded; on turning back some are up to twice as stiff.
    constexpr S steepest(const S& twist, const S& temperature) const {
        S largest = stiffness.tangent(S(0.0));
        over_twists(twist, [&](const S& tangent) { largest = max(largest, tangent); });
        largest = stiffness_variation.largest() * largest;
        const S remembered = max(steepest_loading(twist, S(1.0)), steepest_loading(twist, S(-1.0)));
        const S relaxing = material.largest_stiffness();
        if (!softening.active()) return largest + remembered + relaxing;
        return softening.of_stiffness(temperature) * largest + softening.of_hysteresis(temperature) * remembered + relaxing;
    }

    /// Largest part that the even reaction leaves out at these twists and this temperature, over a turn of the wave generator.
    constexpr structure::Unevenness<S> unevenness(const S& twist, const S& temperature) const {
        constexpr int samples = 512;
        const S even = even_stiffness();
        S softest = stiffness.tangent(S(0.0));
        over_twists(twist, [&](const S& tangent) { softest = min(softest, tangent); });
        softest = (S(2.0) - stiffness_variation.largest()) * softness(temperature) * softest;
        const S stiffest = steepest(twist, temperature);
        structure::Unevenness<S> found{max(stiffest - even, even - softest), S(0.0), S(0.0), S(0.0)};
        const auto inner = initial_state(structure);
        for (int i = 0; i < samples; ++i) {
            const Shafts at = shafts({S((2.0 * i / samples - 1.0) * pi), S(0.0)}, S(0.0), S(0.0), S(0.0), temperature);
            const Engaged stood = engaged_without_noise(inner, at, full_error(inner, at));
            found.slope = max(found.slope, abs(stood.error.slope));
            found.per_twist = max(found.per_twist, abs(stood.per_twist));
        }
        const structure::Unevenness<S> random = random_unevenness(stiffest);
        return {found.stiffness, found.slope + random.slope, found.per_twist + random.per_twist, random.per_speed};
    }
    /// The share of the random error in it, at rest, for a stiffness of the spring [N.m/rad].
    constexpr structure::Unevenness<S> random_unevenness(const S& spring) const {
        if (!kinematic_noise.active()) return {S(0.0), S(0.0), S(0.0), S(0.0)};
        const auto change = kinematic_noise.max_change();
        return {S(0.0), change.slope, change.per_torque * spring, change.per_speed};
    }

private:
    /// Calls visit(tangent) for the stiffness [N.m/rad] of the spring at twists up to `twist` [rad], of either sign.
    template <class Visit>
    constexpr void over_twists(const S& twist, const Visit& visit) const {
        constexpr int samples = 64;
        for (int i = -samples; i <= samples; ++i) visit(stiffness.tangent(twist * S(double(i) / samples)));
    }
    /// The largest stiffness [N.m/rad] of the hysteresis on its first way to a twist [rad], to one side.
    constexpr S steepest_loading(const S& twist, const S& side) const {
        constexpr int samples = 64;
        const typename Hysteresis::State virgin{};
        const S little = side * S(1e-12);  // rad: within any loop's first slope, and more than rounding
        S largest = hysteresis.torque(virgin, little) / little;
        if (!any(twist > S(0.0))) return largest;
        const S part = side * max(twist / S(samples), S(1e-12));
        S before{0.0};
        for (int i = 1; i <= samples; ++i) {
            const S torque = hysteresis.torque(virgin, S(i) * part);
            largest = max(largest, (torque - before) / part);
            before = torque;
        }
        const S rest = S(1.0 / samples) * part;  // of the way, for a stiffness that rises steeply
        return max(largest, (before - hysteresis.torque(virgin, S(samples) * part - rest)) / rest);
    }
    /// Teeth of the kinematic error must be those of the kinematics, or have its ratio if the kinematics has no teeth.
    constexpr Contradiction<S> problem_of_teeth(const S& ratio) const {
        const facts::Teeth error_teeth = facts::teeth(kinematic_error), gear_teeth = facts::teeth(kinematics);
        if (error_teeth.flexspline == 0) return {};
        if (gear_teeth.flexspline == 0)
            return facts::agree(S(error_teeth.ratio()), ratio)
                       ? Contradiction<S>{}
                       : Contradiction<S>{"the teeth of kinematic_error have the ratio {}, kinematics has {}; give both alike",
                                          S(error_teeth.ratio()), ratio};
        if (error_teeth.flexspline != gear_teeth.flexspline)
            return {"the flexspline_teeth of kinematic_error, {}, must be those of kinematics, {}; give both alike",
                    S(error_teeth.flexspline), S(gear_teeth.flexspline)};
        if (error_teeth.circular_spline != gear_teeth.circular_spline)
            return {"the circular_spline_teeth of kinematic_error, {}, must be those of kinematics, {}; give both alike",
                    S(error_teeth.circular_spline), S(gear_teeth.circular_spline)};
        if (error_teeth.fixed == gear_teeth.fixed) return {};
        return {gear_teeth.fixed == kinematics::Fixed::flexspline
                    ? "kinematic_error has the circular_spline fixed, kinematics the flexspline; give both alike"
                    : "kinematic_error has the flexspline fixed, kinematics the circular_spline; give both alike"};
    }

    /// The error at these angles, and the gap less the error.
    struct Engaged {
        kinematic_error::Error<S> error;
        S deformation;
        S twist;  ///< at which the amplitude of the noise is evaluated
        S per_output{1.0}, per_twist{0.0}, relief{1.0};
    };

    constexpr kinematic_error::Error<S> full_error(const Inner& inner, const Shafts& at) const {
        return kinematic_error::warmed<S>(kinematic_error, structure.generator(inner, at).angle, at.temperature);
    }
    /// The noise follows the elastic torque that there is without it, so that neither waits for the other.
    constexpr Engaged engaged(const Inner& inner, const Shafts& at, const kinematic_error::Error<S>& full) const {
        Engaged found = engaged_without_noise(inner, at, full);
        if (kinematic_noise.active()) {
            const auto generator = structure.generator(inner, at);
            const kinematic_error::Error<S> noise =
                kinematic_noise.at(generator.angle, stiffness.torque(found.twist), generator.speed);
            found.error = {found.error.value + noise.value, found.error.slope + noise.slope};
            found.deformation = structure.gap(inner, at) - found.error.value;
        }
        return found;
    }
    constexpr Engaged engaged_without_noise(const Inner& inner, const Shafts& at, const kinematic_error::Error<S>& full) const {
        const S gap = structure.gap(inner, at), left = gap - full.value;
        if (!kinematic_error::follows_load(kinematic_error)) return {full, left, structure.spring_twist(inner, at, left)};
        const S twist = structure.spring_twist(inner, at, structure.rigid() ? relieved_twist(full.value, gap) : left);
        const kinematic_error::Relief<S> relief = kinematic_error::relief(kinematic_error, S(stiffness.torque(twist)));
        const S error = relief.factor * full.value, slope = relief.factor * full.slope;
        const S per_twist = full.value * relief.slope * stiffness.tangent(twist);
        if (!structure.rigid()) return {{error, slope}, gap - error, twist, S(1.0), per_twist, relief.factor};
        const S per_output = S(1.0) / (S(1.0) + per_twist);
        return {{error, per_output * slope}, gap - error, twist, per_output, S(0.0), relief.factor};
    }
    /// The twist that is left of a gap by an error that its own torque relieves, rad: Newton's iteration, from the error's full
    /// size on. What is left to find is the square of what was left before.
    constexpr S relieved_twist(const S& error, const S& gap) const {
        constexpr int rounds = 6;
        S twist = gap - error;
        for (int i = 0; i < rounds; ++i) {
            const kinematic_error::Relief<S> relief = kinematic_error::relief(kinematic_error, S(stiffness.torque(twist)));
            const S per_twist = error * relief.slope * stiffness.tangent(twist);
            twist = twist - (twist + relief.factor * error - gap) / (S(1.0) + per_twist);
        }
        return twist;
    }

    constexpr S turning(const variation::Factor<S>& factor, const S& twist, const S& temperature) const {
        if (!stiffness_variation.active()) return S(0.0);
        return factor.slope * softness(temperature) * stiffness.energy(twist);
    }
    constexpr structure::Load<S> load(const Mesh& mesh, const S& turning) const { return {mesh.spring, turning, input_inertia}; }
    constexpr S softness(const S& temperature) const { return softening.active() ? softening.of_stiffness(temperature) : S(1.0); }
};

}  // namespace strainwave
