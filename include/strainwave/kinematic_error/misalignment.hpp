#pragma once
#include <strainwave/condition.hpp>
#include <strainwave/kinematic_error/fourier.hpp>

namespace strainwave::kinematic_error {

/// Combination of the displacements of the two lobes: one tooth pair carries; two equally stiff ones share; the one that is pushed
/// further out carries.
enum class Combine { single, mean, max };
constexpr Array<const char*, 3> choices(Combine) { return {{"single", "mean", "max"}}; }

template <class S>
struct Planar {
    S x{0.0};
    S y{0.0};

    constexpr S dot(const Planar& other) const { return x * other.x + y * other.y; }
    constexpr S squared() const { return dot(*this); }
    /// Exactly 0 at 0, where a derivative of the square root would not be finite.
    constexpr S length() const { return select(squared() > S(smallest), sqrt(max(squared(), S(smallest))), S(0.0)); }
    /// Angle in [-pi, pi], by the half angle, which is differentiable on the axes too.
    constexpr S direction() const {
        const S inner = S(2.0) * atan(y / max(length() + abs(x), S(smallest)));
        return select(x < S(0.0), along(y, S(pi)) - inner, inner);
    }
    constexpr Planar scaled(const S& factor) const { return {factor * x, factor * y}; }
    /// Product as complex numbers.
    constexpr Planar turned(const Planar& by) const { return {x * by.x - y * by.y, x * by.y + y * by.x}; }
};

/// Radial displacement of one lobe [m] and its derivative by the input angle [m/rad].
template <class S>
struct Displacement {
    S value{0.0};
    S slope{0.0};
};

template <class S>
struct Lobes {
    Displacement<S> first;   ///< At the input angle
    Displacement<S> second;  ///< Opposite
};

template <class S>
struct Misalignment {
    S major_radius{25.25e-3};
    S minor_radius{24.75e-3};
    S pitch_radius{25e-3};
    S pressure_angle{0.3490658503988659};
    S offset{0.0};
    S housing_eccentricity{0.0};
    S housing_direction{0.0};
    S housing_tilt_x{0.0};
    S housing_tilt_y{0.0};
    S generator_eccentricity{0.0};
    S generator_direction{0.0};
    S generator_tilt_x{0.0};
    S generator_tilt_y{0.0};
    Combine combine{Combine::single};

    static constexpr auto name = "misalignment";
    static constexpr auto source = SW_ACTUATOR_PAPER
        ", section Kinematic error, worked out: the paper prints no equation; `combine` and the "
        "default values (teeth of module 0.25 mm, 200 and 202) are assumed";
    static constexpr auto doc = R"(
        Kinematic error of a wave generator that is eccentric and tilted in the circular spline.

        .. math:: e(\theta) = -\frac{\tan\alpha_t}{r_g} \operatorname{combine}(\delta_A, \delta_B), \qquad
                  \delta_A = \rho(\theta) - a, \quad \delta_B = \rho(\theta + \pi) - a

        .. math:: \rho(\psi) = \frac{u^T Q c + \sqrt{(u^T Q c)^2 - u^T Q u \, (c^T Q c - 1)}}{u^T Q u}, \qquad
                  u = (\cos\psi, \sin\psi)

        with theta the input angle, a = major_radius, b = minor_radius, alpha_t = pressure_angle, r_g = pitch_radius. The wave
        generator is an elliptic cylinder with half axes a, b. The plane normal to the input shaft at h = offset from the
        centre of tilt cuts it in the ellipse of centre c and matrix Q, both turning with theta. rho is the polar radius of the
        ellipse about the axis of the circular spline; delta_A and delta_B are the displacements of the two lobes. The input
        shaft stands off the axis of the circular spline by e_1 = housing_eccentricity towards beta_1 = housing_direction and
        leans towards x and y by beta_2 = housing_tilt_x, beta_3 = housing_tilt_y, all at rest in the housing; the generator
        stands on the shaft with e_2 = generator_eccentricity, alpha_1 = generator_direction, alpha_2 = generator_tilt_x,
        alpha_3 = generator_tilt_y, all turning with it. ``combine`` is ``single`` (delta_A: one tooth pair carries), ``mean``
        (two equally stiff lobes) or ``max`` (the lobe further out carries, and the slope jumps where the lobes change).

        Information in the harmonics: with m = ``eccentricity``, close to (e_1 cos beta_1 + h beta_2, e_1 sin beta_1 + h
        beta_3), and c = (e_2 cos alpha_1 + h alpha_2, e_2 sin alpha_1 + h alpha_3), the displacement that varies is, to the
        order that ``leading`` keeps,

        .. math:: \text{single: } m \cdot u(\theta), \qquad \text{max: } |c_x + m \cdot u(\theta)|, \qquad
                  \text{mean: } \frac{a c_y}{b^2} (m_x \sin\theta - m_y \cos\theta) + \frac{a}{4}
                  \operatorname{Re}\left[\left(\frac{m^2}{b^2} - \beta^2\right) e^{-2 j \theta}\right]

        with m and beta = beta_2 + j beta_3 in the last bracket read as complex numbers. With a single lobe only the vector m
        is identifiable: e_1 and a tilt times h have the same effect, and a tilt with h = 0 acts in second order only.
        Misalignment of the generator alone (m = 0, beta = 0) gives a constant and no harmonic. Together with misalignment of
        the housing it acts in products with m or beta, of second order by c_y and of third by its tilts. c_x acts on the
        harmonics in first order with ``max`` alone, which compares it with m: odd orders appear. If c_x exceeds m the lobes no
        longer change, and the error is that of ``single``.

        Leaves out clearance, tooth errors and the flexspline's elastic fit to the generator. In eq. (2) the paper takes e r_g
        for the radial displacement. The displacement acts through the flank, with the factor tan(alpha_t) / r_g, and against
        the output. The paper also leaves out h, without which no tilt acts in first order, and the combination of the
        two lobes. In a gear of stages, pitch radius and pressure angle must be those of its structure.

        >>> from strainwave.kinematic_error import Misalignment
        >>> law = Misalignment(major_radius=25.25e-3, minor_radius=24.75e-3, pitch_radius=25e-3, housing_eccentricity=20e-6,
        ...                    combine="single")
        >>> round(law.error(0.0), 10)
        -0.0002911762)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_REQUIRED(m, major_radius, "m", "Major half axis a of the wave generator", smallest));
        visit(SW_REQUIRED(m, minor_radius, "m", "Minor half axis b of the wave generator", smallest));
        visit(SW_REQUIRED(m, pitch_radius, "m", "Pitch radius r_g", smallest, 1));
        visit(SW_FIELD(m, pressure_angle, "rad", "Pressure angle alpha_t of the teeth", smallest, 1.5));
        visit(SW_FIELD(m, offset, "m", "Axial distance h of the section from the centre of tilt"));
        visit(SW_FIELD(m, housing_eccentricity, "m", "Distance e_1 of the input shaft from the axis of the circular spline", 0));
        visit(SW_FIELD(m, housing_direction, "rad", "Direction beta_1 of e_1 in the circular spline"));
        visit(SW_FIELD(m, housing_tilt_x, "rad", "Tilt beta_2 of the input shaft towards x of the circular spline", -0.5, 0.5));
        visit(SW_FIELD(m, housing_tilt_y, "rad", "Tilt beta_3 of the input shaft towards y of the circular spline", -0.5, 0.5));
        visit(SW_FIELD(m, generator_eccentricity, "m", "Distance e_2 of the wave generator from the input shaft", 0));
        visit(SW_FIELD(m, generator_direction, "rad", "Direction alpha_1 of e_2 from the major axis, turning with the shaft"));
        visit(SW_FIELD(m, generator_tilt_x, "rad", "Tilt alpha_2 of the wave generator towards its major axis", -0.5, 0.5));
        visit(SW_FIELD(m, generator_tilt_y, "rad", "Tilt alpha_3 of the wave generator towards its minor axis", -0.5, 0.5));
        visit(SW_FIELD(m, combine, "1", "Combination of the displacements of the two lobes"));
    }

    constexpr Contradiction<S> problem() const {
        if (!all((major_radius >= minor_radius) & (S(10.0) * minor_radius >= major_radius)))
            return {"major_radius = {} m must lie between minor_radius = {} m and ten times that", major_radius, minor_radius};
        // A rotation's corner does not stretch, so that this keeps the axis inside the ellipse at every angle.
        const S off = centre().length() + eccentricity().length();
        if (!all(minor_radius > off))
            return {
                "the axis of the circular spline must pass through the wave generator: minor_radius = {} m must exceed the "
                "eccentricities and the tilts times offset, together {} m",
                minor_radius, off};
        return {};
    }

    /// All lengths in units of the major radius, less their values without misalignment: displacements, some 1e-3 of the
    /// radius, then keep their digits in float too.
    struct Compiled {
        S radius, scale;
        S xx_less_one, xy, yy;           // matrix of the ellipse in axes that turn with the shaft
        Planar<S> centre, eccentricity;  // of the ellipse, turning; of the shaft, at rest
        S stretch;                       // the tilted plane seen along the axis: mean scale less 1 ...
        Planar<S> shear;                 // ... and what goes round with 2 theta
        Combine combine;

        constexpr Error<S> at(const Angle<S>& angle) const {
            const auto [first, second] = lobes(angle);
            if (combine == Combine::single) return {scale * first.value, scale * first.slope};
            if (combine == Combine::mean)
                return {S(0.5) * scale * (first.value + second.value), S(0.5) * scale * (first.slope + second.slope)};
            const auto behind = first.value < second.value;
            return {scale * select(behind, second.value, first.value), scale * select(behind, second.slope, first.slope)};
        }

        /// Lobe that determines the output, if one does: its lead over the other [m].
        constexpr S side(const Angle<S>& angle) const {
            if (combine != Combine::max) return S(1.0);
            const auto [first, second] = lobes(angle);
            return first.value - second.value;
        }

        /// With w the direction of the lobe and d the centre, both as the turning generator has them, P = w'Nw, X = w'Nd,
        /// D = d'Nd: the displacement solves P x^2 + 2 (P - X) x + (P - 1 - 2 X + D) = 0.
        constexpr Lobes<S> lobes(const Angle<S>& angle) const {
            const SinCos<S> turn = sincos(angle.within);
            const S twice = turn.sin + turn.sin;
            const Planar<S> back{turn.cos, -turn.sin}, back_twice{S(1.0) - twice * turn.sin, -twice * turn.cos};
            const Planar<S> swing = shear.turned(back_twice), shift = eccentricity.turned(back);
            const Planar<S> tilt{stretch + swing.x, swing.y - shear.y}, tilt_slope{swing.y + swing.y, -(swing.x + swing.x)};
            const Planar<S> d{centre.x + shift.x, centre.y + shift.y}, d_slope{shift.y, -shift.x};

            const Planar<S> by_tilt = weighed(tilt), by_d = weighed(d);
            const Planar<S> by_w{S(1.0) + xx_less_one + by_tilt.x, xy + by_tilt.y};
            const S p_less_one = xx_less_one + S(2.0) * by_tilt.x + tilt.dot(by_tilt), p = S(1.0) + p_less_one;
            const S x = d.dot(by_w), excess = p_less_one + d.dot(by_d);
            const S root = sqrt(x * x + p * (S(1.0) - d.dot(by_d)));
            const S first = (x + x - excess) / (p - x + root), second = -(x + x + excess) / (p + x + root);

            const S p_slope = tilt_slope.dot(by_w), x_slope = d_slope.dot(by_w) + tilt_slope.dot(by_d);
            const S d_part = d_slope.dot(by_d), there = S(1.0) + first, opposite = S(1.0) + second, per_root = radius / root;
            return {{radius * first, per_root * (there * (x_slope - there * p_slope) - d_part)},
                    {radius * second, -per_root * (opposite * (x_slope + opposite * p_slope) + d_part)}};
        }

    private:
        constexpr Planar<S> weighed(const Planar<S>& v) const { return {v.x + xx_less_one * v.x + xy * v.y, xy * v.x + yy * v.y}; }
    };

    constexpr Compiled compile() const {
        const SinCos<S> x = sincos(generator_tilt_x), y = sincos(generator_tilt_y);
        const SinCos<S> lean_x = sincos(housing_tilt_x), lean_y = sincos(housing_tilt_y);
        const S longer_x = secant_less_one(lean_x), longer_y = secant_less_one(lean_y), inverse = S(1.0) / major_radius;
        const S flatness = major_radius / minor_radius, squared = flatness * flatness;
        return {.radius = major_radius,
                .scale = scale(),
                .xx_less_one = x.sin * x.sin * (squared * y.sin * y.sin - S(1.0)),
                .xy = -squared * x.sin * y.sin * y.cos,
                .yy = squared * y.cos * y.cos,
                .centre = centre().scaled(inverse),
                .eccentricity = eccentricity().scaled(inverse),
                .stretch = S(0.5) * (longer_x + longer_y),
                .shear = {S(0.5) * (longer_x - longer_y), S(0.5) * tangent(lean_x) * tangent(lean_y)},
                .combine = combine};
    }

    constexpr Error<S> at(const Angle<S>& angle) const { return compile().at(angle); }
    constexpr S side(const Angle<S>& angle) const { return compile().side(angle); }

    /// Radial displacements delta_A and delta_B.
    constexpr Lobes<S> lobes(const Angle<S>& angle) const { return compile().lobes(angle); }

    /// Point at which the input shaft pierces the section, seen from the axis of the circular spline [m], at rest in the housing:
    /// all that harmonics determine of the misalignment, in first order.
    constexpr Planar<S> eccentricity() const {
        const SinCos<S> direction = sincos(housing_direction), x = sincos(housing_tilt_x), y = sincos(housing_tilt_y);
        const Planar<S> e{housing_eccentricity * direction.cos, housing_eccentricity * direction.sin};
        return {(e.x + offset * x.sin / y.cos) / x.cos + tangent(x) * tangent(y) * e.y, e.y / y.cos + offset * tangent(y)};
    }

    /// The harmonics of a small misalignment in closed form, each of the order that does not vanish: the first for `single`
    /// and `max` (up to 8 per turn), the second for `mean`. The constant is left out.
    constexpr Fourier<S> leading() const {
        Fourier<S> sum{};
        const Planar<S> m = eccentricity();
        if (combine == Combine::single)
            add(sum, m);
        else if (combine == Combine::mean)
            add_mean(sum, m);
        else
            add_max(sum, m);
        return sum;
    }

private:
    static constexpr S tangent(const SinCos<S>& angle) { return angle.sin / angle.cos; }
    static constexpr S secant_less_one(const SinCos<S>& angle) {
        return angle.sin * angle.sin / (angle.cos * (S(1.0) + angle.cos));
    }
    constexpr S scale() const { return -tangent(sincos(pressure_angle)) / pitch_radius; }

    /// Point at which the generator's axis pierces the section, seen from the input shaft [m], turning with it.
    constexpr Planar<S> centre() const {
        const SinCos<S> direction = sincos(generator_direction), x = sincos(generator_tilt_x), y = sincos(generator_tilt_y);
        return {generator_eccentricity * direction.cos + offset * tangent(x),
                generator_eccentricity * direction.sin + offset * tangent(y) / x.cos};
    }

    /// Adds the next order of the displacement x cos(n theta) + y sin(n theta).
    constexpr void add(Fourier<S>& sum, const Planar<S>& displacement) const {
        const int i = sum.order.count++;
        sum.amplitude.count = sum.phase.count = sum.order.count;
        const Planar<S> wave{scale() * displacement.y, scale() * displacement.x};
        sum.order[i] = S(sum.order.count);
        sum.amplitude[i] = wave.length();
        sum.phase[i] = wave.direction();
    }

    constexpr void add_mean(Fourier<S>& sum, const Planar<S>& m) const {
        const S per_b = S(1.0) / minor_radius;
        const Planar<S> slope = m.scaled(per_b), tilt{housing_tilt_x, housing_tilt_y};
        const Planar<S> square = slope.turned(slope), tilts = tilt.turned(tilt);
        add(sum, Planar<S>{-slope.y, slope.x}.scaled(major_radius * per_b * centre().y));
        add(sum, Planar<S>{square.x - tilts.x, square.y - tilts.y}.scaled(S(0.25) * major_radius));
    }

    /// |c + m cos(x)| in cosines. The sign changes at cos(x) = -share, where the integrand vanishes: the place of the change
    /// carries no derivative.
    constexpr void add_max(Fourier<S>& sum, const Planar<S>& m) const {
        const S length = m.length(), per_length = S(1.0) / max(length, S(smallest)), c = centre().x;
        const S share = clip(value_only(c / max(length, S(smallest))), S(-1.0), S(1.0)), step = S(-2.0) * share;
        const S edge = max((S(1.0) - share) * (S(1.0) + share), S(smallest)), height = sqrt(edge);
        const Planar<S> heading = m.scaled(per_length);
        Planar<S> direction = heading;
        S before{0.0}, sine = height, after = step * sine;  // sin((n - 1) x), sin(n x), sin((n + 1) x) at the change
        for (int n = 1; n <= 8; ++n) {
            const S lower = n == 1 ? atan(share / height) : before / S(n - 1);
            add(sum, direction.scaled(S(4.0 / pi) * (c * sine / S(n) + S(0.5) * length * (lower + after / S(n + 1)))));
            direction = direction.turned(heading);
            before = sine;
            sine = after;
            after = step * sine - before;
        }
    }
};

}  // namespace strainwave::kinematic_error
