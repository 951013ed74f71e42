#pragma once
#include <strainwave/condition.hpp>
#include <strainwave/harmonics.hpp>
#include <strainwave/kinematic_error/error.hpp>
#include <strainwave/kinematics.hpp>
#include <strainwave/lobes.hpp>
#include <strainwave/random.hpp>

namespace strainwave::kinematic_error {

template <class S>
struct ToothErrors {
    static constexpr int highest = 16;  ///< order of the deviation along a pitch circle
    using Chart = Sequence<S, highest>;
    static constexpr int most_places = 16;     ///< along the engagement of a tooth
    static constexpr int flank_multiples = 4;  ///< of the order of passing teeth

    int flexspline_teeth{200};
    int circular_spline_teeth{202};
    kinematics::Fixed fixed{kinematics::Fixed::circular_spline};
    S pitch_radius{25e-3};
    S engaged_share{0.3};
    S first_lobe{0.5};
    Chart flexspline_amplitude{};
    Chart flexspline_phase{};
    Chart circular_spline_amplitude{};
    Chart circular_spline_phase{};
    S flexspline_deviation{0.0};
    S circular_spline_deviation{0.0};
    S seed{0.0};
    Sequence<S, most_places> flank_deviation{};

    static constexpr auto name = "tooth_errors";
    static constexpr auto source =
        "the cause is named by " SW_ACTUATOR_PAPER
        ", section Kinematic error, without an equation, and the order 2 z_c / z_f by " SW_REVIEW
        "; "
        "derived here from the geometry; terms of ISO2013; random chart: Feller1951, ShinozukaDeodatis1991, "
        "WichmannHill1982; which teeth are engaged, and how stiff they are, is assumed";
    static constexpr auto doc = R"(
        Kinematic error from pitch and flank deviations of the teeth of both splines.

        .. math:: e(\theta) = \frac{\bar F_{output}(\lambda_{output}) - \bar F_{fixed}(\lambda_{fixed})}{r_g}, \qquad
                  F(\varphi) = \sum_{n=1}^{16} A_n \sin(n \varphi + \varphi_n)

        .. math:: \bar F(\lambda) = \sum_n s_n \, W\!\left(\frac{\pi n \, \eta \, z_f}{2 z}\right) A_n \sin(n \lambda + \varphi_n),
                  \qquad W(x) = \frac{\sin x}{x \, (1 - x^2 / \pi^2)}

        with theta the input angle, r_g = pitch_radius, z_f and z_c the teeth, and z, in W, those of the averaged spline. F is
        the cumulative pitch deviation (index deviation) of a spline: the distance of the tooth flank at the angle phi from its
        nominal place, along the pitch circle, positive in the positive sense of rotation. F is periodic, so its orders n are
        whole. A_n is the n-th number of flexspline_amplitude or circular_spline_amplitude, phi_n of the phases; ``[0, 4e-6]``
        has order 2 alone. phi counts from the tooth that is under the first lobe at input angle 0.

        In the frame of each spline the first lobe stands at an angle lambda. Both splines pass the lobe tooth by tooth, so
        that z_f lambda_f = z_c lambda_c. In the frame of the ``fixed`` spline lambda is theta. In the frame of the output it
        is theta z_c / z_f (circular spline fixed) or theta z_f / z_c (flexspline fixed). The fixed spline therefore gives
        whole orders, and the output gives broken orders close to them, such as the review's 2 z_c / z_f. Order n of both beats
        n times in a turn of the output.

        Without torque the forces of all engaged teeth balance, so that e is the mean of their deviations, weighted by
        stiffness. The share eta = engaged_share of the flexspline's teeth is engaged, half of it under each lobe. The
        stiffness is assumed to fall as 1 + cos from the major axis to zero at the ends of a zone; W is the share of order n
        that remains in this mean. The first lobe has the share p = first_lobe of the stiffness of all engaged teeth: s_n = 1
        for even n, 2 p - 1 for odd n. If both lobes share equally, odd orders cancel: an eccentric spline (n = 1) gives no
        error, an oval one (n = 2) gives all of its own. Torque winds up all pairs alike and does not change e.

        A Fourier series over the teeth turns a measured chart of index deviations into amplitudes and phases. If only a
        tolerance class is known, give flexspline_deviation and circular_spline_deviation, the total cumulative pitch deviation
        F_p of a typical part; the class states the largest one allowed. They add a random chart with amplitudes sqrt(2 / pi)
        F_p / (pi n) and phases that ``seed`` draws: the mean spectrum of pitches that are cut independently of each other and
        whose range over the turn is F_p in the mean (Feller1951). The 16 orders kept have nine tenths of that range.

        Flanks deviate also along the engagement. flank_deviation is that of the flexspline's flank less that of the circular
        spline's, in the sense of F, at equally spaced places from the beginning to the end of the engagement of a pair while
        the input turns forwards, and linear between them. Pairs pass each lobe with the order of the teeth of the fixed spline,
        z_p, so that the mean over the engaged pairs is periodic in it:

        .. math:: e_{flank}(\theta) = \pm \frac{2}{r_g} \operatorname{Re} \sum_{m=1}^{4} s_{m z_p} c_m e^{i m z_p \theta}, \qquad
                  c_m = \tfrac{1}{2} \int_{-1}^{1} (1 + \cos \pi t) (f(t) - \bar f) e^{-i m \pi N t} dt

        with N = eta z_f / 2 the pairs engaged under a lobe, f the deviation over the place t of a pair in the zone, f-bar its
        weighted mean, + with the circular spline fixed, else -. The sum over single pairs becomes these orders by Poisson's
        formula. f-bar itself is a constant and left out. Both lobes add up if z_p is even; if it is odd, m z_p cancels for odd
        m as far as they share equally.

        Assumed are: a linear stiffness of each pair, which teeth are engaged, how their stiffness falls, and one pitch radius
        for both splines. Leaves out pitch deviations of single teeth as they come and go (orders near the number of teeth),
        deviations of thickness, teeth that lose contact, load and speed, the radial part of an eccentricity (see Misalignment),
        runout of the output shaft, and deviations of order above 16, of which the engaged teeth leave little. A gear refuses
        teeth and a fixed member that are not those of its kinematics, and a pitch radius that is not that of its stages.

        >>> from strainwave.kinematic_error import ToothErrors
        >>> gear = dict(flexspline_teeth=200, circular_spline_teeth=202, pitch_radius=25e-3, engaged_share=0.3)
        >>> oval = ToothErrors(**gear, circular_spline_amplitude=[0, 5e-6], circular_spline_phase=[0, 1.5707963267948966])
        >>> round(oval.error(0.0), 9)
        -0.000188876
        >>> eccentric = ToothErrors(**gear, flexspline_amplitude=[5e-6], flexspline_phase=[0])
        >>> eccentric.error(1.0), round(eccentric.replace(first_lobe=1.0).error(1.0), 9)
        (0.0, 0.000166923)
        >>> relieved = ToothErrors(**gear, flank_deviation=[4e-6, 0, 0, 0, 4e-6])
        >>> bool(relieved.error(0.0) > 0.0)
        True
        >>> random = ToothErrors(**gear, flexspline_deviation=15e-6, circular_spline_deviation=15e-6, seed=1)
        >>> random.error(0.3) == random.replace(seed=2).error(0.3)
        False)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_REQUIRED(m, flexspline_teeth, "1", "Teeth of the flexspline z_f", 2, 100000));
        visit(SW_REQUIRED(m, circular_spline_teeth, "1", "Teeth of the circular spline z_c", 3, 100000));
        visit(SW_FIELD(m, fixed, "1", "The member that does not turn; the other spline is the output"));
        visit(SW_REQUIRED(m, pitch_radius, "m", "Pitch radius r_g", smallest, 1));
        visit(SW_REQUIRED(m, engaged_share, "1", "Share eta of the flexspline's teeth that is engaged, at both lobes together", 0,
                          1));
        visit(SW_FIELD(m, first_lobe, "1", "Share p of the first lobe in the stiffness of all engaged teeth", 0, 1));
        visit(SW_FIELD(m, flexspline_amplitude, "m", "Amplitudes A_n of the flexspline's deviation, orders 1, 2, ...", 0, 1e-3));
        visit(SW_FIELD(m, flexspline_phase, "rad", "Phases phi_n of the flexspline's deviation"));
        visit(SW_FIELD(m, circular_spline_amplitude, "m", "Amplitudes A_n of the circular spline's deviation, orders 1, 2, ...", 0,
                       1e-3));
        visit(SW_FIELD(m, circular_spline_phase, "rad", "Phases phi_n of the circular spline's deviation"));
        visit(SW_FIELD(m, flexspline_deviation, "m", "Total cumulative pitch deviation F_p of a random flexspline", 0, 1e-3));
        visit(SW_FIELD(m, circular_spline_deviation, "m", "Total cumulative pitch deviation F_p of a random circular spline", 0,
                       1e-3));
        visit(SW_FIELD(m, seed, "1", "Seed of the random numbers, a whole number", 0, 16777215, true));
        visit(SW_OPTIONAL(m, flank_deviation, "m",
                          "Deviations of the flank of each pair at equal distances from the beginning to the end of its engagement",
                          -1e-3, 1e-3));
    }

    constexpr Contradiction<S> problem() const {
        const int more = circular_spline_teeth - flexspline_teeth;
        if (more <= 0 || more % 2 != 0)
            return {"circular_spline_teeth = {} must exceed flexspline_teeth = {} by an even number, for teeth mesh at two lobes",
                    S(circular_spline_teeth), S(flexspline_teeth)};
        if (flexspline_amplitude.count != flexspline_phase.count)
            return {"flexspline_amplitude and flexspline_phase must have equally many elements"};
        if (circular_spline_amplitude.count != circular_spline_phase.count)
            return {"circular_spline_amplitude and circular_spline_phase must have equally many elements"};
        if (flank_deviation.count == 1)
            return {"flank_deviation must have at least 2 elements: at the beginning and at the end of the engagement"};
        return {};
    }

    struct Compiled {
        Harmonics<S, 1, highest> of_fixed, of_output;
        Harmonics<S, 1, flank_multiples> of_flanks;
        S passing;  ///< teeth that pass a lobe in a turn of the input
        S teeth;    ///< of the output
        S ahead;    ///< teeth by which the output passes the lobe in a turn of the input, beyond its own

        constexpr Error<S> at(const Angle<S>& angle) const {
            const S advance = ahead / teeth, passed = clip(ahead * angle.turns, S(-1e18), S(1e18));
            const S within = angle.within + advance * angle.within, rest = passed - teeth * rint(passed / teeth);
            const auto [still, still_slope] = of_fixed.at({angle.within, S(0.0)});
            const auto [turning, turning_slope] = of_output.at({within + S(2.0 * pi) * (rest / teeth), S(0.0)});
            const Error<S> pitches{still + turning, still_slope + turning_slope + advance * turning_slope};
            if (of_flanks.top == 0) return pitches;
            const auto [flanks, flank_slope] = of_flanks.at({passing * angle.within, S(0.0)});
            return {pitches.value + flanks, pitches.slope + passing * flank_slope};
        }
    };

    constexpr Error<S> at(const Angle<S>& angle) const { return compile().at(angle); }

    /// The sum, arranged for speed: with all random phases and all averages.
    constexpr Compiled compile() const {
        auto random = WichmannHill<S>::seeded(seed);
        Array<S, highest> first{}, second{};
        for (int i = 0; i < highest; ++i) first[i] = S(2.0 * pi) * random.share();
        for (int i = 0; i < highest; ++i) second[i] = S(2.0 * pi) * random.share();
        const S turns_forward = S(1.0) / pitch_radius;
        const bool flexspline_turns = fixed == kinematics::Fixed::circular_spline;
        const auto flexspline = averaged(flexspline_teeth, flexspline_amplitude, flexspline_phase, flexspline_deviation, first,
                                         flexspline_turns ? turns_forward : -turns_forward);
        const auto circular_spline = averaged(circular_spline_teeth, circular_spline_amplitude, circular_spline_phase,
                                              circular_spline_deviation, second, flexspline_turns ? -turns_forward : turns_forward);
        const S more(circular_spline_teeth - flexspline_teeth);
        const int passing = flexspline_turns ? circular_spline_teeth : flexspline_teeth;
        const auto flanks = of_flanks(passing, flexspline_turns ? turns_forward : -turns_forward);
        if (flexspline_turns) return {circular_spline, flexspline, flanks, S(passing), S(flexspline_teeth), more};
        return {flexspline, circular_spline, flanks, S(passing), S(circular_spline_teeth), -more};
    }

private:
    /// Mean deviation of the engaged teeth of a spline, times `scale`.
    constexpr Harmonics<S, 1, highest> averaged(int teeth, const Chart& amplitude, const Chart& phase, const S& total,
                                                const Array<S, highest>& drawn, const S& scale) const {
        Sequence<S, 2 * highest> order{}, size{}, start{};
        const auto add = [&](int n, const S& deviation, const S& at_zero) {
            const int i = order.count++;
            size.count = start.count = order.count;
            order[i] = S(n);
            size[i] = scale * left(n, teeth) * deviation;
            start[i] = at_zero;
        };
        for (int i = 0; i < amplitude.count; ++i) add(i + 1, amplitude[i], phase[i]);
        if (is_differentiated(total) || any(total > S(0.0)))
            for (int i = 0; i < highest; ++i) add(i + 1, S(0.25397454373696393) * total / S(i + 1), drawn[i]);  // sqrt(2 / pi) / pi
        return Harmonics<S, 1, highest>::of(order, size, start);
    }

    /// The share of order n of a deviation that the mean over all engaged teeth leaves.
    constexpr S left(int n, int teeth) const {
        const S x = S(0.5 * pi) * S(n) * engaged_share * (S(flexspline_teeth) / S(teeth));
        return lobes::of_both(n, first_lobe, lobes::zone_share(x));
    }

    struct Complex {
        S real{0.0}, imaginary{0.0};
    };

    /// Mean flank deviation of the engaged pairs, less its mean over the passing of a tooth, times `scale`.
    constexpr Harmonics<S, 1, flank_multiples> of_flanks(int passing, const S& scale) const {
        Sequence<S, 2 * flank_multiples> order{}, size{}, start{};
        if (flank_deviation.count > 0) {
            const S pairs = S(0.5) * S(flexspline_teeth) * engaged_share, mean = weighted_flank(S(0.0)).real;
            order.count = size.count = start.count = 2 * flank_multiples;
            for (int m = 1; m <= flank_multiples; ++m) {
                const S phase = S(pi) * S(m) * pairs, share = S(2.0) * lobes::of_both(m * passing, first_lobe, scale);
                const Complex wave = weighted_flank(phase);
                const int i = 2 * (m - 1);
                order[i] = order[i + 1] = S(m);
                size[i] = share * (wave.real - mean * lobes::zone_share(phase));
                start[i] = S(0.5 * pi);
                size[i + 1] = -share * wave.imaginary;
            }
        }
        return Harmonics<S, 1, flank_multiples>::of(order, size, start);
    }
    /// 1/2 times the integral of (1 + cos(pi t)) f(t) exp(-i phase t) over t in [-1, 1], with f the flank deviation.
    constexpr Complex weighted_flank(const S& phase) const {
        const Complex middle = flank_wave(phase), above = flank_wave(phase + S(pi)), below = flank_wave(phase - S(pi));
        return {S(0.5) * middle.real + S(0.25) * (above.real + below.real),
                S(0.5) * middle.imaginary + S(0.25) * (above.imaginary + below.imaginary)};
    }
    /// The integral of f(t) exp(-i phase t): f is a sum of triangles, of which those at both ends are halves.
    constexpr Complex flank_wave(const S& phase) const {
        const int last = flank_deviation.count - 1;
        const S width = S(2.0) / S(last), turned = phase * width;
        const S quotient = lobes::sine_quotient(S(0.5) * turned);
        const S even = S(0.5) * width * quotient * quotient, odd = width * lag(turned);
        Complex sum{};
        for (int j = 0; j <= last; ++j) {
            const SinCos<S> at = sincos(phase * (S(j) * width - S(1.0)));
            const S both = S(j > 0 && j < last ? 2.0 : 1.0) * even, skew = S(j == 0 ? -1.0 : j == last ? 1.0 : 0.0) * odd;
            sum.real = sum.real + flank_deviation[j] * (both * at.cos + skew * at.sin);
            sum.imaginary = sum.imaginary + flank_deviation[j] * (skew * at.cos - both * at.sin);
        }
        return sum;
    }
    /// (x - sin x) / x^2: by how much half a triangle lags.
    static constexpr S lag(const S& x) {
        const auto near = abs(x) < S(1e-2);
        const S safe = select(near, S(1.0), x);
        return select(near, x * (S(1.0 / 6.0) - x * x * S(1.0 / 120.0)), (x - sincos(x).sin) / (safe * safe));
    }
};

}  // namespace strainwave::kinematic_error
