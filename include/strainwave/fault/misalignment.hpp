#pragma once
#include <strainwave/fault/fault.hpp>
#include <strainwave/kinematic_error/misalignment.hpp>

namespace strainwave::fault {

template <class S>
struct Misalignment {
    S severity{1.0};
    S housing_eccentricity{3e-5};
    S housing_direction{0.0};
    S housing_tilt_x{0.0};
    S housing_tilt_y{0.0};
    S generator_eccentricity{0.0};
    S generator_direction{0.0};
    S generator_tilt_x{0.0};
    S generator_tilt_y{0.0};
    S offset{4e-3};
    S major_radius{25.25e-3};
    S minor_radius{24.75e-3};
    S pitch_radius{25e-3};
    S pressure_angle{0.3490658503988659};
    kinematic_error::Combine combine{kinematic_error::Combine::max};

    static constexpr auto name = "misalignment";
    static constexpr auto mode = "Misalignment of wave generator and circular spline";
    static constexpr auto effect = "kinematic error at the output, and its reaction on the input";
    static constexpr auto signal =
        "orders 1, 2, 4 of the input in output position, and in the motor current in proportion to the load";
    static constexpr auto source = SW_ACTUATOR_PAPER
        ", section Kinematic error, worked out, with the factor and the sign of the flank; the numbers at severity 1, and "
        "`combine`, are assumed";
    static constexpr auto doc = R"(
        Eccentricity and tilt of input shaft and wave generator against the circular spline.

        .. math:: e_1 \leftarrow e_1 + s\, \Delta e_1, \quad \beta \leftarrow \beta + s\, \Delta\beta, \quad
                  e_2 \leftarrow e_2 + s\, \Delta e_2, \quad \alpha \leftarrow \alpha + s\, \Delta\alpha

        with s = severity, e_1 = housing_eccentricity towards housing_direction, beta = housing_tilt_x, housing_tilt_y, e_2 =
        generator_eccentricity towards generator_direction, alpha = generator_tilt_x, generator_tilt_y. At severity 1 shaft and
        generator are displaced by these numbers from where they are in the healthy drive; eccentricities add as vectors.

        A drive whose kinematic error is a ``kinematic_error.Misalignment`` keeps the geometry of that law: its radii, pressure
        angle, h = offset and ``combine``; those given here are not used. For a drive whose error is a sum of waves, the
        harmonics of this misalignment are added: ``kinematic_error.Misalignment(...).leading()``, to leading order. Without
        offset, tilts have no effect of first order. e_2 and alpha alone give constants, which no harmonic shows.

        >>> from strainwave.fault import Facts, Misalignment
        >>> law = Misalignment(housing_eccentricity=1e-5, combine="single")
        >>> [(place, order, round(1e6 * value, 4)) for place, _, _, value, _, _, _, order in law.changes(Facts())]
        [('gear.kinematic_error', 1.0, 145.5881)])";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, severity, "1", "Share s of the displacements below", 0, 1));
        visit(SW_FIELD(m, housing_eccentricity, "m", "Distance e_1 of the input shaft from the axis of the circular spline", 0));
        visit(SW_FIELD(m, housing_direction, "rad", "Direction beta_1 of that distance"));
        visit(SW_FIELD(m, housing_tilt_x, "rad", "Lean beta_2 of the input shaft towards x", -0.5, 0.5));
        visit(SW_FIELD(m, housing_tilt_y, "rad", "Lean beta_3 of the input shaft towards y", -0.5, 0.5));
        visit(SW_FIELD(m, generator_eccentricity, "m", "Distance e_2 of the wave generator from the input shaft", 0));
        visit(SW_FIELD(m, generator_direction, "rad", "Direction alpha_1 of that distance, turning with the shaft"));
        visit(SW_FIELD(m, generator_tilt_x, "rad", "Lean alpha_2 of the wave generator on the shaft", -0.5, 0.5));
        visit(SW_FIELD(m, generator_tilt_y, "rad", "Lean alpha_3 of the wave generator on the shaft", -0.5, 0.5));
        visit(SW_FIELD(m, offset, "m", "Distance h of the teeth from the centre of tilt"));
        visit(SW_FIELD(m, major_radius, "m", "Half axis a of the wave generator", smallest));
        visit(SW_FIELD(m, minor_radius, "m", "Half axis b of the wave generator", smallest));
        visit(SW_FIELD(m, pitch_radius, "m", "Pitch radius r_g of the circular spline", smallest));
        visit(SW_FIELD(m, pressure_angle, "rad", "Pressure angle alpha_t of the teeth", 0, 1.5));
        visit(SW_FIELD(m, combine, "1", "Combination of the displacements of the two lobes"));
    }

    constexpr const char* problem() const {
        return all(minor_radius <= major_radius) ? nullptr : "minor_radius must not exceed major_radius";
    }

    /// The kinematic error of a gear that is aligned but for this fault.
    constexpr kinematic_error::Misalignment<S> law() const {
        return {.major_radius = major_radius,
                .minor_radius = minor_radius,
                .pitch_radius = pitch_radius,
                .pressure_angle = pressure_angle,
                .offset = offset,
                .housing_eccentricity = severity * housing_eccentricity,
                .housing_direction = housing_direction,
                .housing_tilt_x = severity * housing_tilt_x,
                .housing_tilt_y = severity * housing_tilt_y,
                .generator_eccentricity = severity * generator_eccentricity,
                .generator_direction = generator_direction,
                .generator_tilt_x = severity * generator_tilt_x,
                .generator_tilt_y = severity * generator_tilt_y,
                .combine = combine};
    }

    template <class Visit>
    constexpr void changes(const Facts<S>& facts, Visit&& visit) const {
        const kinematic_error::Misalignment<S> error = law();
        if (facts.error == ErrorForm::geometry) {
            const auto tilt = [&](const char* quantity, const S& angle) {
                visit(add(error_place, quantity, angle, "misalignment"));
            };
            visit(add_vector(error_place, "housing_eccentricity", "housing_direction", error.housing_eccentricity,
                             error.housing_direction, "misalignment"));
            visit(add_vector(error_place, "generator_eccentricity", "generator_direction", error.generator_eccentricity,
                             error.generator_direction, "misalignment"));
            tilt("housing_tilt_x", error.housing_tilt_x);
            tilt("housing_tilt_y", error.housing_tilt_y);
            tilt("generator_tilt_x", error.generator_tilt_x);
            tilt("generator_tilt_y", error.generator_tilt_y);
        } else {
            const kinematic_error::Fourier<S> waves = error.leading();
            for (int h = 0; h < waves.order.count; ++h)
                visit(add_wave(error_place, "fourier", waves.order[h], waves.amplitude[h], waves.phase[h]));
        }
    }
};

}  // namespace strainwave::fault
