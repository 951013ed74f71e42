#pragma once
#include <strainwave/field.hpp>
#include <strainwave/kinematics.hpp>
#include <strainwave/math.hpp>

/// Faults of a drive. A fault does not simulate: it lists the numbers of a drive that it changes. It has
///
///     severity                 in [0, 1]; 0 changes nothing, 1 is the change that its doc defines
///     mode, effect, signal     its row in the table of failure modes
///     changes(facts, visit)    calls visit(change) for each change, the same ones in the same order at every severity
///     missing(facts)           text of the fact that the drive lacks, or a null pointer; left out if the fault needs none
namespace strainwave::fault {

enum class Kind { scale, add, vector, wave };
constexpr Array<const char*, 4> choices(Kind) { return {{"scale", "add", "vector", "wave"}}; }

/// A change of the numbers called `quantity` under a part of a drive.
template <class S>
struct Change {
    const char* place;     ///< path of the part
    const char* quantity;  ///< of a vector, its length; of a wave, the amplitude
    Kind kind;
    S value;                     ///< factor, addend, length or amplitude
    const char* law = "";        ///< a law that has such numbers, to be put in where there are none; empty: nothing can be put in
    const char* direction = "";  ///< name of the direction of a vector or of the phase of a wave
    S phase{0.0};                ///< direction of a vector, phase of a wave [rad]
    S order{0.0};                ///< of a wave
};

/// Multiplies every number of this name, if there is any.
template <class S>
constexpr Change<S> scale(const char* place, const char* quantity, const S& factor) {
    return {place, quantity, Kind::scale, factor};
}
template <class S>
constexpr Change<S> add(const char* place, const char* quantity, const S& addend, const char* law) {
    return {place, quantity, Kind::add, addend, law};
}
/// Adds a vector of this length and direction to one that is held as length and direction.
template <class S>
constexpr Change<S> add_vector(const char* place, const char* quantity, const char* direction, const S& length, const S& angle,
                               const char* law) {
    return {place, quantity, Kind::vector, length, law, direction, angle};
}
/// Adds amplitude sin(order theta + phase) to a law with the sequences order, amplitude and phase.
template <class S>
constexpr Change<S> add_wave(const char* place, const char* law, const S& order, const S& amplitude, const S& phase) {
    return {place, "amplitude", Kind::wave, amplitude, law, "phase", phase, order};
}

/// Every name that a law of friction has for a dry level or a loss per torque.
inline constexpr Array<const char*, 14> dry_quantities{{"coulomb", "breakaway", "quadratic", "linear", "constant", "cosine", "sine",
                                                        "level", "driving_forward", "driving_reverse", "backdriving_forward",
                                                        "backdriving_reverse", "average_loss", "difference_loss"}};
/// Every name that a law of stiffness has for a stiffness, or for a coefficient in proportion to it.
inline constexpr Array<const char*, 8> stiffness_quantities{
    {"k", "k1", "k2", "k3", "a1", "a3", "flexspline_stiffness", "wave_generator_stiffness"}};

inline constexpr const char* error_place = "gear.kinematic_error";
inline constexpr const char* spring_place = "gear.stiffness";
inline constexpr const char* mesh_place = "gear.friction_mesh";
inline constexpr const char* variation_place = "gear.stiffness_variation";
inline constexpr const char* motor_place = "motor";

/// Shafts with an encoder.
enum class Shaft { input, output };
constexpr Array<const char*, 2> choices(Shaft) { return {{"input", "output"}}; }
constexpr const char* encoder_place(Shaft shaft) { return shaft == Shaft::input ? "sensors.input_angle" : "sensors.output_angle"; }

/// The two splines of a gear.
enum class Spline { flexspline, circular_spline };
constexpr Array<const char*, 2> choices(Spline) { return {{"flexspline", "circular_spline"}}; }

/// The form of a kinematic error.
enum class ErrorForm { waves, geometry };
constexpr Array<const char*, 2> choices(ErrorForm) { return {{"waves", "geometry"}}; }

template <class S>
struct Facts {
    int flexspline_teeth{0};
    int circular_spline_teeth{0};
    kinematics::Fixed fixed{kinematics::Fixed::circular_spline};
    S ratio{100.0};
    ErrorForm error{ErrorForm::waves};

    static constexpr auto name = "facts";
    static constexpr auto source = "definition";
    static constexpr auto doc = R"(
        Facts of a drive that a fault needs.

        >>> from strainwave.fault import Facts
        >>> Facts(flexspline_teeth=200, circular_spline_teeth=202, ratio=-100.0).fixed
        'circular_spline')";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, flexspline_teeth, "1", "Teeth of the flexspline z_f; 0 if they are not known", 0, 100000));
        visit(SW_FIELD(m, circular_spline_teeth, "1", "Teeth of the circular spline z_c; 0 if they are not known", 0, 100000));
        visit(SW_FIELD(m, fixed, "1", "The member that does not turn; the other spline is the output"));
        visit(SW_FIELD(m, ratio, "1", "Input angle per output angle, signed"));
        visit(SW_FIELD(m, error, "1", "Form of the kinematic error: waves, or the geometry of a misalignment"));
    }

    constexpr bool has_teeth() const { return flexspline_teeth > 0 && circular_spline_teeth > flexspline_teeth; }

    /// Revolutions of the wave generator against a spline, per revolution of the input.
    constexpr S passes(Spline spline) const {
        const S flexspline(flexspline_teeth), circular_spline(circular_spline_teeth);
        if (fixed == kinematics::Fixed::circular_spline)
            return spline == Spline::circular_spline ? S(1.0) : circular_spline / flexspline;
        return spline == Spline::flexspline ? S(1.0) : flexspline / circular_spline;
    }
};

/// Text of a fault that needs the teeth.
inline constexpr const char* needs_teeth =
    "the teeth of the gear and its fixed member, from which its orders follow; give the gear kinematics.StrainWave";

}  // namespace strainwave::fault
