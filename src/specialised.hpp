#pragma once
#include <strainwave/any.hpp>
#include <strainwave/scalar/pack.hpp>

#include <algorithm>

/// Drives whose parts are chosen from fewer models, or from one. A state is then as short as the longest among them and of fixed
/// size, and what a step calls can all be inlined. A drive runs as the most special of these types that it fits.
namespace strainwave::host {

namespace detail {

/// A choice from those of its laws whose state has at most `most` numbers.
template <int most, class Part>
struct Short {
    using type = Part;
};
template <int most, class Kept, class... Law>
struct Sifted {
    using type = Kept;
};
template <int most, class S, class... Kept, class First, class... Rest>
struct Sifted<most, Choice<S, Kept...>, First, Rest...> {
    static constexpr bool fits = strainwave::detail::kept_size<Holds::state, S, First>() <= most;
    using type = typename Sifted<most, std::conditional_t<fits, Choice<S, Kept..., First>, Choice<S, Kept...>>, Rest...>::type;
};
template <int most, class S, class... Law>
struct Short<most, Choice<S, Law...>> {
    using type = typename Sifted<most, Choice<S>, Law...>::type;
};
template <int most, class S, class Law, class... Modulator>
struct Short<most, Layers<S, Law, Modulator...>> {
    using type = Layers<S, typename Short<most, Law>::type, Modulator...>;
};
// Steps of packs are inlined: with what modulates a contact they would take half as long again to compile.
template <int most, int n, class Law, class... Modulator>
struct Short<most, Layers<Pack<n>, Law, Modulator...>> : Short<most, Law> {};

template <class Drive>
struct ShortDriveOf;
template <class S, class Control, class Motor, class Kinematics, class Error, class Noise, class Stiffness, class Hysteresis,
          class FrictionInput, class FrictionMesh, class FrictionOutput, class Softening, class Structure, class Variation,
          class Load, class Sensors_, class ThermalModel, class Meter>
struct ShortDriveOf<Drive<S, Control, Motor,
                          Gear<S, Kinematics, Error, Noise, Stiffness, Hysteresis, FrictionInput, FrictionMesh, FrictionOutput,
                               Softening, Structure, Variation>,
                          Load, Sensors_, ThermalModel, Meter>> {
    using type = Drive<S, Control, Motor,
                       Gear<S, Kinematics, Error, Noise, Stiffness, typename Short<16, Hysteresis>::type,
                            typename Short<1, FrictionInput>::type, typename Short<1, FrictionMesh>::type,
                            typename Short<1, FrictionOutput>::type, Softening, structure::Lumped<S>, Variation>,
                       Load, Sensors<S, sensor::Ideal<S>>, ThermalModel, Meter>;
};

/// One of a list of models: a choice only if there are several.
template <class S, template <class...> class... Law>
struct OneOf {
    using type = AnyOf<S, List<Law...>>;
};
template <class S, template <class...> class Law>
struct OneOf<S, Law> {
    using type = Law<S>;
};

/// The models of most papers and of most catalogues.
template <class S, class FrictionOutput, template <class...> class... FrictionInput>
using Usual = Drive<S, AnyOf<S, List<control::OpenLoop, control::PID>>, motor::DC<S>,
                    Gear<S, AnyOf<S, kinematics::Models>, kinematic_error::Fourier<S>, kinematic_error::Stochastic<S>,
                         AnyOf<S, List<stiffness::Linear, stiffness::Piecewise, stiffness::ThreeSegment, stiffness::Cubic>>,
                         hysteresis::MaxwellSlip<S>, typename OneOf<S, FrictionInput...>::type, friction::Viscous<S>,
                         FrictionOutput, softening::ThermalSoftening<S>>,
                    AnyOf<S, List<load::Inertia, load::Pendulum>>, Sensors<S, sensor::Ideal<S>>>;

}  // namespace detail

/// A drive of any models, as a run compiles it.
template <class S>
using CompiledDrive = decltype(AnyDrive<S>{}.compile());
/// The same without the laws that have long states.
template <class S>
using ShortDrive = typename detail::ShortDriveOf<CompiledDrive<S>>::type;
/// The usual drives, by the friction at their input. Without memory that of the output may stick, too, as a seal does.
template <class S>
using DriveOnBristles = decltype(detail::Usual<S, friction::Viscous<S>, friction::LuGre>{}.compile());
template <class S>
using DriveWithoutMemory = decltype(detail::Usual<S, AnyOf<S, List<friction::Viscous, friction::Coulomb>>, friction::Viscous,
                                                  friction::Coulomb, friction::Stribeck>{}
                                        .compile());

namespace detail {

template <class Part, class Law>
inline constexpr bool holds = false;
template <class S, class... Law, class Chosen>
inline constexpr bool holds<Choice<S, Law...>, Chosen> = (std::is_same_v<Law, Chosen> || ...);

template <class Part, class From>
bool specialise(Part& part, const From& from);
template <class S, class Sensor, class From>
bool specialise(Sensors<S, Sensor>& sensors, const From& from) {
    return specialise(sensors.input_angle, from.input_angle) && specialise(sensors.input_speed, from.input_speed) &&
           specialise(sensors.output_angle, from.output_angle) && specialise(sensors.output_speed, from.output_speed) &&
           specialise(sensors.current, from.current) && specialise(sensors.torque, from.torque);
}

/// Sets a part to a law if the part has the law's type or is a choice that has it; true if so. No lambda: in one, clang checks
/// `part.model` of every part, even in a branch that is discarded.
template <class Part, class Law>
bool set_law(Part& part, const Law& law) {
    if constexpr (std::is_same_v<Part, Law>)
        part = law;
    else if constexpr (holds<Part, Law>)
        part.model = law;
    return std::is_same_v<Part, Law> || holds<Part, Law>;
}

/// Sets a part to the same law if it is among those that the part can be; true if so.
template <class Part, class From>
bool specialise(Part& part, const From& from) {
    if constexpr (std::is_same_v<Part, From>) {
        part = from;
        return true;
    } else if constexpr (requires { part.modulators = from.modulators; }) {
        part.modulators = from.modulators;
        return specialise(part.law, from.law);
    } else if constexpr (requires { from.modulators; }) {
        return !from.modulates() && specialise(part, from.law);
    } else {
        return from.visit([&](const auto& law) { return set_law(part, law); });
    }
}

}  // namespace detail

/// Sets `special` to the same drive; false if it needs other models.
template <class S, class Special>
bool specialise(Special& special, const CompiledDrive<S>& drive) {
    const auto& from = drive.gear;
    auto& gear = special.gear;
    gear.damping = from.damping;
    gear.input_inertia = from.input_inertia;
    return detail::specialise(gear.kinematics, from.kinematics) && detail::specialise(gear.kinematic_error, from.kinematic_error) &&
           detail::specialise(gear.kinematic_noise, from.kinematic_noise) && detail::specialise(gear.stiffness, from.stiffness) &&
           detail::specialise(gear.hysteresis, from.hysteresis) && detail::specialise(gear.friction_input, from.friction_input) &&
           detail::specialise(gear.friction_mesh, from.friction_mesh) &&
           detail::specialise(gear.friction_output, from.friction_output) && detail::specialise(special.motor, drive.motor) &&
           detail::specialise(special.control, drive.control) && detail::specialise(special.load, drive.load) &&
           detail::specialise(special.sensors, drive.sensors) && detail::specialise(gear.softening, from.softening) &&
           detail::specialise(gear.structure, from.structure) &&
           detail::specialise(gear.stiffness_variation, from.stiffness_variation) &&
           detail::specialise(special.thermal, drive.thermal) && detail::specialise(special.meter, drive.meter);
}

namespace detail {

/// The numbers of one part's state, as another type of drive holds them.
template <class S, class To, class From>
void convert(To& to, const From& from) {
    if constexpr (size_of<S, To> > 0 && size_of<S, From> > 0) {
        auto scalars = flattened<S>(to);
        const auto values = flattened<S>(from);
        for (int i = 0; i < std::min(scalars.size(), values.size()); ++i) scalars[i] = values[i];
        to = refilled(to, scalars);
    }
}

}  // namespace detail

/// The state of a drive as the same drive of another type has it, of which `to` is a state.
template <class S, class To, class From>
To converted(To to, const From& from) {
    to.held_twist = from.held_twist;
    to.held_rate = from.held_rate;
    to.elapsed = from.elapsed;
    to.turns = from.turns;
    to.input_slip_direction = from.input_slip_direction;
    to.output_slip_direction = from.output_slip_direction;
    detail::convert<S>(to.hysteresis, from.hysteresis);
    auto& motion = to.continuous;
    motion.input_angle = from.continuous.input_angle;
    motion.input_speed = from.continuous.input_speed;
    motion.transmission_error = from.continuous.transmission_error;
    motion.output_speed = from.continuous.output_speed;
    detail::convert<S>(motion.structure, from.continuous.structure);
    detail::convert<S>(motion.motor, from.continuous.motor);
    detail::convert<S>(motion.control, from.continuous.control);
    detail::convert<S>(motion.sensors, from.continuous.sensors);
    detail::convert<S>(motion.thermal, from.continuous.thermal);
    detail::convert<S>(motion.meter, from.continuous.meter);
    detail::convert<S>(to.discrete.control, from.discrete.control);
    detail::convert<S>(motion.friction_input, from.continuous.friction_input);
    detail::convert<S>(motion.friction_mesh, from.continuous.friction_mesh);
    detail::convert<S>(motion.friction_output, from.continuous.friction_output);
    return to;
}

}  // namespace strainwave::host
