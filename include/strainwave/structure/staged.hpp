#pragma once
#include <strainwave/compiled.hpp>
#include <strainwave/ring/rigid.hpp>
#include <strainwave/structure/structure.hpp>
#include <strainwave/variation/constant.hpp>

namespace strainwave::structure {

template <class S, class Ring = ring::Rigid<S>, class CouplingVariation = variation::Constant<S>,
          class BearingVariation = CouplingVariation, class MeshVariation = CouplingVariation,
          class SplineVariation = CouplingVariation>
struct Staged {
    S pitch_radius{25e-3};
    S pressure_angle{0.3490658503988659};
    S coupling_stiffness{5e3};
    S coupling_damping{0.0};
    S bearing_stiffness{5e7};
    S bearing_damping{0.0};
    S mesh_stiffness{1e8};
    S mesh_damping{0.0};
    S circular_spline_stiffness{1e5};
    S circular_spline_damping{0.0};
    S radial_mass{0.03};
    S flexspline_inertia{2e-5};
    S circular_spline_inertia{3e-4};
    Ring ring{};
    CouplingVariation coupling_variation{};
    BearingVariation bearing_variation{};
    MeshVariation mesh_variation{};
    SplineVariation circular_spline_variation{};

    static constexpr auto name = "staged";
    static constexpr auto source = SW_ACTUATOR_PAPER
        ", eq. (1), with the two relations that it leaves out, corrected as the text states; the circular "
        "spline fixed, varying springs and the default values are assumed";
    static constexpr auto doc = R"(
        Gear of stages: wave generator, flexspline and circular spline have their own motion.

        .. math:: T_{WG} = K_{WG}(\theta_{in} - \theta_{WG}) + c_{WG}(\dot\theta_{in} - \dot\theta_{WG}) =
                  F_b \left(r_g \tan\alpha_n + \frac{d\delta}{d\theta_{WG}}\right) + J_{WG}\ddot\theta_{WG}

        .. math:: F_b = K_b (\delta + x_1 - x_2) + c_b(\dot\delta + \dot x_1 - \dot x_2) = F_m \sin\alpha_t + m_r \ddot x_2

        .. math:: F_m = K_m \mu + c_m \dot\mu, \qquad \mu = x_2 \sin\alpha_t - (y_1 + y_2) \cos\alpha_t

        .. math:: F_m r_g \cos\alpha_t = T_{FS}(y_1 / r_g) + J_{FS} \ddot y_1 / r_g = J_{CS}\ddot\theta_{CS} + T_{CS}, \qquad
                  T_{CS} = K_{CS}(\theta_{CS} - \theta_{out}) + c_{CS}(\dot\theta_{CS} - \dot\theta_{out})

        with theta_in, theta_WG, theta_CS, theta_out the angles of input shaft, wave generator, circular spline and output
        shaft, x_2 the radial and y_1 the tangential displacement of the flexspline, r_g = pitch_radius, alpha_t =
        pressure_angle, x_1 = r_g tan(alpha_n) theta_WG, tan(alpha_n) = 1 / (i tan(alpha_t)), y_2 = r_g theta_CS, and i the
        ratio. K_WG, c_WG = coupling_stiffness, coupling_damping join the motor shaft to the wave generator; K_b, c_b are those
        of its bearing, K_m, c_m those of the mesh, K_CS, c_CS = circular_spline_stiffness, circular_spline_damping join the
        circular spline to the output shaft and its position sensor. The other parts of the gear contain the rest: J_WG is its
        input_inertia, T_FS the torque of its stiffness, hysteresis and damping, delta = -e r_g / tan(alpha_t) its kinematic
        error as a radial displacement of the wave generator. m_r = radial_mass and J_FS = flexspline_inertia are those of the
        flexspline's toothed ring, J_CS = circular_spline_inertia.

        These are the equations of a gear with fixed flexspline, whose ratio is positive. If the circular spline is fixed, the
        ratio is negative and the two exchange their places: T_CS holds the circular spline to the housing, and T_FS, over the
        twist of the flexspline against the output shaft, is the torque on it.

        The modes of the ``ring`` are driven by F_m and take the displacement u from mu; see ring.Modes.

        Each stiffness may vary as the wave generator turns. The torque with which such a spring turns the wave generator is
        part of the model. Without load and misalignment theta_CS = theta_WG / i exactly.

        The paper prints the torque of F_b as F_b r_g sin(alpha_n) cos(alpha_n), with which the gear gives more power than it
        takes. It damps the mesh by a rate that is not that of its deformation, gives the error the opposite sign
        of its own eq. (2), leaves out the reaction of the error, and counts three degrees of freedom where there
        are four. Its x_1 is linear in theta_WG: the equations leave out the cyclic deformation of the flexspline.

        Friction of input and mesh acts on the motor shaft, as in a lumped gear. Both rings have one radius, as in the paper:
        a turn of the held ring turns the output by the same angle, while the ratio of the teeth gives 1 percent more or less,
        so that the three torques on the gear do not balance.

        With the circular spline fixed, x_1, x_2 and the forces have the sign of the output's motion, y_1 is the twist of the
        flexspline against the output shaft times r_g, and y_2 counts against the output's sense.

        Outputs as in the paper: ``bearing_displacement`` x_1, ``radial_displacement`` x_2, ``flexspline_displacement`` y_1,
        ``circular_spline_displacement`` y_2, ``bearing_force`` F_b, ``mesh_force`` F_m, ``wave_generator_torque`` T_WG,
        ``circular_spline_torque`` T_CS, ``output_torque`` T = torque - friction_output, and ``ring_displacement`` u.

        Valid for deformations that are small against r_g. Leaves out clearance of mesh and bearing (stiffness.Backlash has play
        in the flexspline's spring alone) and, with a rigid ring, every mode of the flexspline except torsion and the radial one.
        The wave generator needs an input_inertia. If the kinematic error also has a pitch radius and a pressure angle, they must
        be those of the stages. No catalogue gives these stiffnesses: calculate or assume them. The bodies vibrate at 1e4 to 1e5
        rad/s. If every body has a damper, fixed steps need not resolve this vibration, but only the variation and the bend of the
        springs. A run with longer steps is refused; the message contains the longest step allowed.

        >>> import strainwave as sw
        >>> structure = sw.structure.Staged(pitch_radius=25e-3, bearing_stiffness=5e7, mesh_stiffness=1e8,
        ...     coupling_stiffness=5e3, circular_spline_stiffness=1e5, radial_mass=0.032, flexspline_inertia=2e-5,
        ...     circular_spline_inertia=3e-4)
        >>> gear = sw.Gear(structure=structure, input_inertia=8e-6)
        >>> gear.structure.mesh_stiffness
        100000000.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_REQUIRED(m, pitch_radius, "m", "Pitch radius r_g", smallest, 1));
        visit(SW_FIELD(m, pressure_angle, "rad", "Pressure angle alpha_t of the teeth", 0.01, 1.5));
        visit(SW_REQUIRED(m, coupling_stiffness, "N.m/rad", "Stiffness K_WG between input shaft and wave generator", smallest));
        visit(SW_FIELD(m, coupling_damping, "N.m.s/rad", "Damping c_WG between input shaft and wave generator", 0));
        visit(SW_REQUIRED(m, bearing_stiffness, "N/m", "Radial stiffness K_b of the wave generator's bearing", smallest));
        visit(SW_FIELD(m, bearing_damping, "N.s/m", "Damping c_b of that bearing", 0));
        visit(SW_REQUIRED(m, mesh_stiffness, "N/m", "Stiffness K_m of the mesh, along its line of action", smallest));
        visit(SW_FIELD(m, mesh_damping, "N.s/m", "Damping c_m of the mesh", 0));
        visit(SW_REQUIRED(m, circular_spline_stiffness, "N.m/rad",
                          "Stiffness K_CS between circular spline and output shaft, or housing if that spline is fixed", smallest));
        visit(SW_FIELD(m, circular_spline_damping, "N.m.s/rad", "Damping c_CS of the same joint", 0));
        visit(SW_REQUIRED(m, radial_mass, "kg", "Mass m_r of the flexspline's ring that moves radially", smallest));
        visit(SW_REQUIRED(m, flexspline_inertia, "kg.m2", "Inertia J_FS of the flexspline's ring, about its axis", smallest));
        visit(SW_REQUIRED(m, circular_spline_inertia, "kg.m2", "Inertia J_CS of the circular spline", smallest));
        visit(SW_PART(m, ring, "Vibration of the flexspline's ring"));
        visit(SW_PART(m, coupling_variation, "Variation of K_WG with the angle of the wave generator"));
        visit(SW_PART(m, bearing_variation, "Variation of K_b"));
        visit(SW_PART(m, mesh_variation, "Variation of K_m"));
        visit(SW_PART(m, circular_spline_variation, "Variation of K_CS"));
    }

    /// All but the windup and the speed of the wave generator at the output's scale. The ring that is held is the one joined to
    /// the housing, the ring that drives the one joined to the output shaft.
    struct State {
        S windup{0.0};
        S generator_speed{0.0};
        S radial_lag{0.0};
        S radial_speed{0.0};
        S held_angle{0.0};
        S held_speed{0.0};
        S driving_lead{0.0};
        S driving_speed{0.0};
        [[no_unique_address]] typename Ring::State ring{};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, windup, "rad", "Input angle less the angle of the wave generator"));
            visit(SW_FIELD(m, generator_speed, "rad/s", "Speed of the wave generator"));
            visit(SW_FIELD(m, radial_lag, "rad", "Radial displacement of the flexspline behind that of the wave generator"));
            visit(SW_FIELD(m, radial_speed, "rad/s", "Speed of the radial displacement"));
            visit(SW_FIELD(m, held_angle, "rad", "Angle by which the held ring yields to the torque"));
            visit(SW_FIELD(m, held_speed, "rad/s", "Speed of the held ring"));
            visit(SW_FIELD(m, driving_lead, "rad", "Angle of the ring that drives less the output angle"));
            visit(SW_FIELD(m, driving_speed, "rad/s", "Speed of the ring that drives"));
            visit(SW_PART(m, ring, "Vibration of the flexspline's ring"));
        }
    };

    struct Output {
        S bearing_displacement{0.0}, radial_displacement{0.0}, flexspline_displacement{0.0}, circular_spline_displacement{0.0};
        S bearing_force{0.0}, mesh_force{0.0}, wave_generator_torque{0.0}, circular_spline_torque{0.0}, output_torque{0.0};
        S ring_displacement{0.0};

        template <class Self, class Visit>
        static constexpr void fields(Self& m, Visit&& visit) {
            visit(SW_FIELD(m, bearing_displacement, "m", "Radial displacement x_1 of the wave generator's bearing"));
            visit(SW_FIELD(m, radial_displacement, "m", "Radial displacement x_2 of the flexspline"));
            visit(SW_FIELD(m, flexspline_displacement, "m", "Tangential displacement y_1 of the flexspline by its torsion"));
            visit(SW_FIELD(m, circular_spline_displacement, "m", "Tangential displacement y_2 of the circular spline"));
            visit(SW_FIELD(m, bearing_force, "N", "Radial force F_b of the bearing"));
            visit(SW_FIELD(m, mesh_force, "N", "Force F_m of the mesh"));
            visit(SW_FIELD(m, wave_generator_torque, "N.m", "Torque T_WG on the wave generator"));
            visit(SW_FIELD(m, circular_spline_torque, "N.m", "Torque T_CS of the circular spline on its joint"));
            visit(SW_FIELD(m, output_torque, "N.m", "Torque T at the output shaft, less the friction there"));
            visit(SW_FIELD(m, ring_displacement, "m", "Displacement u of the mesh by the modes of the flexspline's ring"));
        }
    };

    /// Two bodies joined, at the output's scale.
    template <class Varying>
    struct Joint {
        S stiffness{1.0};  ///< N.m/rad
        S damping{0.0};    ///< N.m.s/rad
        Varying variation{};

        constexpr variation::Factor<S> factor(const Angle<S>& generator) const {
            return variation.active() ? variation.at(generator) : variation::Factor<S>{};
        }
        constexpr S max_stiffness() const { return stiffness * variation.largest(); }
        constexpr S varying_part() const { return max_stiffness() - stiffness; }
    };
    /// A deformed joint, and its torque.
    struct Strained {
        S deformation, rate;  ///< rad, rad/s
        S elastic, torque;    ///< N.m, with damping
        S turning;            ///< with which it holds the wave generator back as its stiffness varies, N.m
    };

    /// The chain of bodies at the output's scale: every radial displacement times tan(alpha_t) / r_g, every tangential one by r_g.
    template <class Vibration, class CouplingVarying, class BearingVarying, class MeshVarying, class SplineVarying>
    struct Chain {
        Joint<CouplingVarying> coupling;
        Joint<BearingVarying> bearing;
        Joint<MeshVarying> mesh;
        Joint<SplineVarying> spline;
        S radial_inertia, flexspline_inertia, spline_inertia;  ///< kg.m2
        S lever;                                               ///< r_g / tan(alpha_t), m: force of the bearing per torque
        S mesh_lever;                                          ///< r_g cos(alpha_t), m
        S radius;                                              ///< r_g
        Vibration ring;

        using State = typename Staged::State;
        using Output = typename Staged::Output;

        static constexpr bool rigid() { return false; }

        constexpr Generator<S> generator(const State& inner, const Shafts<S>& at) const {
            return {{at.input_angle.within - inner.windup, at.input_angle.turns}, inner.generator_speed};
        }
        constexpr S generator_acceleration(const State& rate, const S&) const { return rate.generator_speed; }
        constexpr S gap(const State& inner, const Shafts<S>&) const { return inner.radial_lag; }
        constexpr S spring_twist(const State& inner, const Shafts<S>& at, const S&) const {
            return select(flexspline_held(at), inner.held_angle, inner.driving_lead);
        }
        template <class Mesh>
        constexpr S spring_twist_rate(const State& inner, const Shafts<S>& at, const Mesh&) const {
            return select(flexspline_held(at), inner.held_speed, inner.driving_speed - at.output_speed);
        }
        template <class Mesh>
        constexpr S deformation_rate(const State& inner, const Mesh& stance) const {
            return stance.per_input * inner.generator_speed - inner.radial_speed - stance.apart.per_twist * stance.twist_rate;
        }

        template <class Mesh>
        constexpr Reaction<S, State> reaction(const State& inner, const Shafts<S>& at, const Mesh& stance,
                                              const Load<S>& load) const {
            return reaction(joints(inner, at, stance), inner, at, stance, load, passing(at, inner.generator_speed));
        }
        template <class Mesh>
        constexpr Reaction<S, State> even_reaction(const State& inner, const Shafts<S>& at, const Mesh& stance,
                                                   const Load<S>& load) const {
            const auto even = [](const auto&) { return variation::Factor<S>{}; };
            const Passing still{S(0.0), S(0.0)};
            return reaction(joints(inner, at, stance, even, still), inner, at, stance, load, still);
        }

        template <class Mesh>
        constexpr Energies<S> energies(const State& inner, const Shafts<S>& at, const Mesh& stance, const Load<S>& load) const {
            const Joints of = joints(inner, at, stance);
            const auto elastic = [](const Strained& joint) { return S(0.5) * joint.elastic * joint.deformation; };
            const auto lost = [](const Strained& joint) { return (joint.torque - joint.elastic) * joint.rate; };
            const Ends inertia = at_ends(at.inverse_ratio, flexspline_inertia, spline_inertia);
            Energies<S> found{elastic(of.coupling) + elastic(of.bearing) + elastic(of.mesh) + elastic(of.spline),
                              S(0.5) * (load.generator_inertia * inner.generator_speed * inner.generator_speed +
                                        radial_inertia * inner.radial_speed * inner.radial_speed +
                                        inertia.held * inner.held_speed * inner.held_speed +
                                        inertia.driving * inner.driving_speed * inner.driving_speed),
                              lost(of.coupling) + lost(of.bearing) + lost(of.mesh) + lost(of.spline), of.bearing.elastic};
            if constexpr (vibrates) {
                const ring::Energies<S> of_ring = ring.energies(inner.ring);
                found.elastic = found.elastic + of_ring.elastic;
                found.kinetic = found.kinetic + of_ring.kinetic;
                found.damping = found.damping + of_ring.damping;
            }
            return found;
        }

        template <class Mesh>
        constexpr Output output(const State& inner, const Shafts<S>& at, const Mesh& stance, const S& friction) const {
            const auto held_flexspline = flexspline_held(at);
            const Joints of = joints(inner, at, stance);
            const S input = at.input_angle.within + S(2.0 * pi) * at.input_angle.turns;
            const S generator = (input - inner.windup) * at.inverse_ratio;
            const S driving = input * at.inverse_ratio - at.transmission_error + inner.driving_lead;
            return {lever * generator,         lever * (generator - inner.radial_lag),
                    radius * stance.twist,     radius * select(held_flexspline, driving, inner.held_angle),
                    of.bearing.torque / lever, of.mesh.torque / mesh_lever,
                    of.coupling.torque,        of.spline.torque,
                    stance.torque - friction,  ring_displacement(inner)};
        }

        template <class Mesh>
        constexpr SteadyState<S, State> steady_state(const State& inner, const Shafts<S>& at, const Mesh& stance,
                                                     const Load<S>& load) const {
            const auto held_flexspline = flexspline_held(at);
            const Angle<S> angle = generator(inner, at).angle;
            const S torque = load.spring / (S(1.0) + stance.apart.per_twist);
            const Strained of_bearing = resting(bearing, angle, torque), of_mesh = resting(mesh, angle, torque),
                           of_spline = resting(spline, angle, torque);
            S turning = load.turning + of_bearing.turning + of_mesh.turning + of_spline.turning;
            State found{};
            if constexpr (vibrates) {
                const Passing lobes = passing(at, at.input_speed);
                const S force = torque / mesh_lever;
                found.ring = ring.steady_state(force, lobes.speed);
                turning = turning - lobes.per_angle * ring.torque(found.ring, force);
            }
            const variation::Factor<S> factor = coupling.factor(angle);
            const S bend = S(0.5) * coupling.stiffness * factor.slope * inner.windup * inner.windup;
            found.windup = (stance.per_input * torque + turning + bend) / (coupling.stiffness * factor.value);
            found.generator_speed = at.input_speed;
            found.radial_lag = stance.error + of_bearing.deformation;
            found.radial_speed = stance.per_input * at.input_speed;
            found.held_angle = select(held_flexspline, stance.twist, of_spline.deformation);
            found.driving_lead = select(held_flexspline, of_spline.deformation, stance.twist);
            found.driving_speed = at.output_speed;
            S in_mesh = of_mesh.deformation;
            if constexpr (vibrates) in_mesh = in_mesh + ring_displacement(found) / mesh_lever;
            return {found, found.windup * at.inverse_ratio + found.radial_lag + in_mesh + found.held_angle + found.driving_lead};
        }
        template <class Mesh>
        constexpr S compliance(const Shafts<S>& at, const Mesh& stance) const {
            const S joints = S(1.0) / bearing.stiffness + S(1.0) / mesh.stiffness + S(1.0) / spline.stiffness +
                             abs(stance.per_input * at.inverse_ratio) / coupling.stiffness;
            if constexpr (vibrates)
                return joints + ring.compliance() / (mesh_lever * mesh_lever);
            else
                return joints;
        }

        /// Upper bound of the highest undamped natural frequency [rad/s].
        constexpr S natural_frequency(const Bodies<S>& bodies) const {
            const Ends ends = at_ends(bodies.inverse_ratio, bodies.stiffness, spline.max_stiffness());
            return sqrt(largest_eigenvalue(bodies, {coupling.max_stiffness(), bearing.max_stiffness(), mesh.max_stiffness(),
                                                    ends.held, ends.driving, bodies.load_stiffness, &ring::Mode<S>::stiffness}));
        }
        /// Highest frequency [rad/s] of springs with the varying part of their stiffness, twice. At a resonance of step and
        /// vibration, a step of one radian of this frequency can excite an undamped mode. In shorter steps the mode still grows a
        /// little, which the damping must exceed. A bearing that a sloped error moves adds the largest eigenvalue of b d' + d b' +
        /// d d': the difference of its force on the generator and on the spring. b is the deformation of the bearing by each
        /// position, d that by the error, both over the roots of the inertias.
        constexpr S uneven_frequency(const Bodies<S>& bodies, const Unevenness<S>& of) const {
            const Ends ends = at_ends(bodies.inverse_ratio, of.stiffness, spline.varying_part());
            const S springs = largest_eigenvalue(bodies, {coupling.varying_part(), bearing.varying_part(), mesh.varying_part(),
                                                          ends.held, ends.driving, S(0.0), nullptr});
            const S straight = bodies.inverse_ratio * bodies.inverse_ratio / bodies.generator_inertia + S(1.0) / radial_inertia;
            const S bent = of.slope * of.slope / bodies.generator_inertia + of.per_twist * of.per_twist / flexspline_inertia;
            const S along_both = abs(bodies.inverse_ratio) * of.slope / bodies.generator_inertia;
            const S square = S(4.0) * springs + bearing.max_stiffness() * (along_both + sqrt(straight * bent) + bent);
            return max(sqrt(square), S(growth) * square / max(slowest_decay(bodies), S(smallest)));
        }
        constexpr S uneven_decay(const Bodies<S>& bodies, const Unevenness<S>& of) const {
            return bearing.max_stiffness() * of.per_speed * (abs(bodies.inverse_ratio) + of.slope) / bodies.generator_inertia;
        }
        constexpr S decay(const Bodies<S>& bodies) const {
            const Ends ends = at_ends(bodies.inverse_ratio, bodies.damping, spline.damping);
            return largest_eigenvalue(bodies, {coupling.damping, bearing.damping, mesh.damping, ends.held, ends.driving, S(0.0),
                                               &ring::Mode<S>::damping});
        }

    private:
        struct Joints {
            Strained coupling, bearing, mesh, spline;
        };
        struct Ends {
            S held, driving;
        };
        /// Joints in series, from the input to the load, and the number of the ring's modes beside the mesh.
        struct Line {
            S coupling, bearing, mesh, held, driving, load;
            S ring::Mode<S>::* of_mode;  ///< none: modes are free
        };
        /// Speed at which the lobes pass the flexspline [rad/s], and the angle that they pass per angle of the wave generator.
        struct Passing {
            S speed, per_angle;
        };
        static constexpr bool vibrates = Vibration::capacity > 0;

        static constexpr auto flexspline_held(const Shafts<S>& at) { return at.inverse_ratio > S(0.0); }
        /// Values of the flexspline and of the circular spline, by which of them is held.
        static constexpr Ends at_ends(const S& inverse_ratio, const S& of_flexspline, const S& of_spline) {
            const auto held_flexspline = inverse_ratio > S(0.0);
            return {select(held_flexspline, of_flexspline, of_spline), select(held_flexspline, of_spline, of_flexspline)};
        }

        static constexpr Passing passing(const Shafts<S>& at, const S& generator_speed) {
            const S per_angle = select(flexspline_held(at), S(1.0), S(1.0) - at.inverse_ratio);
            return {per_angle * generator_speed, per_angle};
        }
        constexpr S ring_displacement(const State& inner) const {
            if constexpr (vibrates)
                return ring.displacement(inner.ring);
            else
                return S(0.0);
        }

        template <class Varying>
        static constexpr Strained strained(const Joint<Varying>& joint, const variation::Factor<S>& factor, const S& deformation,
                                           const S& rate) {
            const S stiff = joint.stiffness * deformation, elastic = factor.value * stiff;
            return {deformation, rate, elastic, elastic + joint.damping * rate, S(0.5) * factor.slope * stiff * deformation};
        }
        template <class Varying>
        static constexpr Strained resting(const Joint<Varying>& joint, const Angle<S>& angle, const S& torque) {
            const variation::Factor<S> factor = joint.factor(angle);
            const S deformation = torque / (joint.stiffness * factor.value);
            return strained(joint, factor, deformation, S(0.0));
        }

        template <class Mesh>
        constexpr Reaction<S, State> reaction(const Joints& of, const State& inner, const Shafts<S>& at, const Mesh& stance,
                                              const Load<S>& load, const Passing& lobes) const {
            const Ends torque =
                at_ends(at.inverse_ratio, load.spring - stance.apart.per_twist * of.bearing.torque, of.spline.torque);
            S turning = load.turning + of.bearing.turning + of.mesh.turning + of.spline.turning + of.coupling.turning;
            State rate{};
            if constexpr (vibrates) {
                const S force = of.mesh.torque / mesh_lever;
                rate.ring = ring.rate(inner.ring, force, lobes.speed);
                turning = turning - lobes.per_angle * ring.torque(inner.ring, force);
            }
            rate.windup = at.input_speed - inner.generator_speed;
            rate.generator_speed = (of.coupling.torque - stance.per_input * of.bearing.torque - turning) / load.generator_inertia;
            rate.radial_lag = inner.generator_speed * at.inverse_ratio - inner.radial_speed;
            rate.radial_speed = (of.bearing.torque - of.mesh.torque) / radial_inertia;
            rate.held_angle = inner.held_speed;
            const Ends inertia = at_ends(at.inverse_ratio, flexspline_inertia, spline_inertia);
            rate.held_speed = (of.mesh.torque - torque.held) / inertia.held;
            rate.driving_lead = inner.driving_speed - at.output_speed;
            rate.driving_speed = (of.mesh.torque - torque.driving) / inertia.driving;
            return {torque.driving, of.coupling.torque, rate};
        }

        template <class Mesh>
        constexpr Joints joints(const State& inner, const Shafts<S>& at, const Mesh& stance) const {
            const Angle<S> angle = generator(inner, at).angle;
            return joints(
                inner, at, stance, [&](const auto& joint) { return joint.factor(angle); }, passing(at, inner.generator_speed));
        }
        template <class Mesh, class FactorOf>
        constexpr Joints joints(const State& inner, const Shafts<S>& at, const Mesh& stance, const FactorOf& factor,
                                const Passing& lobes) const {
            const auto held_flexspline = flexspline_held(at);
            S in_mesh =
                at.transmission_error - inner.windup * at.inverse_ratio - inner.radial_lag - inner.held_angle - inner.driving_lead;
            S in_mesh_rate = inner.radial_speed - inner.held_speed - inner.driving_speed;
            if constexpr (vibrates) {
                in_mesh = in_mesh - ring.displacement(inner.ring) / mesh_lever;
                in_mesh_rate = in_mesh_rate - ring.displacement_rate(inner.ring, lobes.speed) / mesh_lever;
            }
            const S on_spline = select(held_flexspline, inner.driving_lead, inner.held_angle);
            const S on_spline_rate = select(held_flexspline, inner.driving_speed - at.output_speed, inner.held_speed);
            return {strained(coupling, factor(coupling), inner.windup, at.input_speed - inner.generator_speed),
                    strained(bearing, factor(bearing), stance.apart.deformation, stance.apart.deformation_rate),
                    strained(mesh, factor(mesh), in_mesh, in_mesh_rate),
                    strained(spline, factor(spline), on_spline, on_spline_rate)};
        }

        /// Growth of a vibration in a step, as a share of the square of the radians of `uneven_frequency`: five times the measured
        /// one.
        static constexpr double growth = 0.01;

        /// Lowest decay rate [1/s] of a body within the gear while the others are at rest.
        constexpr S slowest_decay(const Bodies<S>& bodies) const {
            const Ends ends = at_ends(bodies.inverse_ratio, bodies.damping, spline.damping);
            const Ends inertia = at_ends(bodies.inverse_ratio, flexspline_inertia, spline_inertia);
            const S turned = bodies.inverse_ratio * bodies.inverse_ratio * bearing.damping;
            S lowest =
                min(min((coupling.damping + turned) / bodies.generator_inertia, (bearing.damping + mesh.damping) / radial_inertia),
                    min((mesh.damping + ends.held) / inertia.held, (mesh.damping + ends.driving) / inertia.driving));
            if constexpr (vibrates)
                for (int i = 0; i < ring.size(); ++i) lowest = min(lowest, ring.mode(i).damping / ring.mode(i).mass);
            return S(0.5) * lowest;
        }

        constexpr S of_mode(const Line& line, int i) const {
            return line.of_mode ? mesh_lever * mesh_lever * ring.mode(i).*line.of_mode : S(0.0);
        }

        /// Largest eigenvalue of the inverse of the inertias times the joints, by power iteration. Rayleigh's quotient comes from
        /// below and is close enough for a limit on steps.
        constexpr S largest_eigenvalue(const Bodies<S>& bodies, const Line& line) const {
            constexpr int chain_count = 6, rounds = 100;
            using Numbers = Array<S, chain_count + Vibration::capacity>;
            const Ends rings = at_ends(bodies.inverse_ratio, flexspline_inertia, spline_inertia);
            Numbers inertia{
                {bodies.input_inertia, bodies.generator_inertia, radial_inertia, rings.held, rings.driving, bodies.output_inertia}};
            int count = chain_count;
            if constexpr (vibrates)
                for (int i = 0; i < ring.size(); ++i) inertia[count++] = mesh_lever * mesh_lever * ring.mode(i).mass;
            Numbers x{};
            for (int i = 0; i < count; ++i) x[i] = S(1.0 + 0.1 * i) * S(i % 2 == 0 ? 1.0 : -1.0) / sqrt(inertia[i]);
            S eigenvalue{0.0};
            for (int round = 0; round < rounds; ++round) {
                const S turned = bodies.inverse_ratio * x[1];
                const S coupled = line.coupling * (x[0] - x[1]), borne = line.bearing * (turned - x[2]);
                S in_mesh = x[2] - x[3] - x[4];
                for (int i = chain_count; i < count; ++i) in_mesh = in_mesh - x[i];
                const S meshed = line.mesh * in_mesh, kept = line.held * x[3], driven = line.driving * (x[4] - x[5]);
                Numbers force{{coupled, bodies.inverse_ratio * borne - coupled, meshed - borne, kept - meshed, driven - meshed,
                               line.load * x[5] - driven}};
                if constexpr (vibrates)
                    for (int i = chain_count; i < count; ++i) force[i] = of_mode(line, i - chain_count) * x[i] - meshed;
                S work{0.0}, size{0.0};
                for (int i = 0; i < count; ++i) {
                    work = work + x[i] * force[i];
                    size = size + x[i] * inertia[i] * x[i];
                }
                eigenvalue = work / max(size, S(smallest));
                for (int i = 0; i < count; ++i) x[i] = force[i] / (inertia[i] * max(eigenvalue, S(smallest)));
            }
            return eigenvalue;
        }
    };

    /// The chain of these bodies, its numbers worked out once.
    constexpr auto compile() const {
        const SinCos<S> flank = sincos(pressure_angle);
        const S lever = pitch_radius * flank.cos / flank.sin, mesh_lever = pitch_radius * flank.cos;
        const S of_bearing = lever * lever, of_mesh = mesh_lever * mesh_lever;
        return Chain<decltype(compiled(ring)), decltype(compiled(coupling_variation)), decltype(compiled(bearing_variation)),
                     decltype(compiled(mesh_variation)), decltype(compiled(circular_spline_variation))>{
            {coupling_stiffness, coupling_damping, compiled(coupling_variation)},
            {bearing_stiffness * of_bearing, bearing_damping * of_bearing, compiled(bearing_variation)},
            {mesh_stiffness * of_mesh, mesh_damping * of_mesh, compiled(mesh_variation)},
            {circular_spline_stiffness, circular_spline_damping, compiled(circular_spline_variation)},
            radial_mass * of_bearing,
            flexspline_inertia,
            circular_spline_inertia,
            lever,
            mesh_lever,
            pitch_radius,
            compiled(ring)};
    }

    static constexpr bool rigid() { return false; }

// A gear that is not compiled works the chain out anew each time.
#define SW_OF_CHAIN(verb)                                      \
    template <class... Arguments>                              \
    constexpr auto verb(const Arguments&... arguments) const { \
        return compile().verb(arguments...);                   \
    }
    SW_OF_CHAIN(generator)
    SW_OF_CHAIN(generator_acceleration)
    SW_OF_CHAIN(gap)
    SW_OF_CHAIN(spring_twist)
    SW_OF_CHAIN(spring_twist_rate)
    SW_OF_CHAIN(deformation_rate)
    SW_OF_CHAIN(reaction)
    SW_OF_CHAIN(even_reaction)
    SW_OF_CHAIN(energies)
    SW_OF_CHAIN(output)
    SW_OF_CHAIN(steady_state)
    SW_OF_CHAIN(compliance)
    SW_OF_CHAIN(natural_frequency)
    SW_OF_CHAIN(uneven_frequency)
    SW_OF_CHAIN(uneven_decay)
    SW_OF_CHAIN(decay)
#undef SW_OF_CHAIN
};

}  // namespace strainwave::structure
