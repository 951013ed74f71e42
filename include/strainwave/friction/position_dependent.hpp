#pragma once
#include <strainwave/condition.hpp>
#include <strainwave/friction/contact.hpp>

namespace strainwave::friction {

/// Behaviour of a law beyond the measured angles.
enum class Outside { clamp, periodic, refuse };
constexpr Array<const char*, 3> choices(Outside) { return {{"clamp", "periodic", "refuse"}}; }

template <class S>
struct PositionDependent {
    static constexpr int capacity = 10;

    S quadratic{0.0};
    S linear{0.0};
    S constant{0.0720};
    Sequence<S, capacity> cosine{};
    Sequence<S, capacity> sine{};
    S static_ratio{1.0};
    S speed_factor{0.0};
    S reference_speed{0.0};
    S viscous{0.0};
    S domain_start{0.0};
    S domain_end{2.0 * pi};
    Outside outside{Outside::refuse};

    static constexpr auto name = "position_dependent";
    static constexpr auto source = SW_POSITION_ARTICLE ", friction model of the motor side, corrected as the text states";
    static constexpr bool odd = true;
    static constexpr auto doc = R"(
        Coulomb friction that depends on the angle, by a parabola and by harmonics of one turn, set-valued at rest.

        .. math:: F = f(q, v) \operatorname{sgn} v + b v \; (v \ne 0), \quad
                  |F| \le \kappa\, [f_{aver}(q) + f_{peri}(q)] \; (v = 0), \quad
                  f = f_{aver}(q)\, [1 + (|v| - v_c)\, \epsilon] + f_{peri}(q) \ge 0, \quad
                  f_{aver} = s_1 q^2 + s_2 q + s_3, \quad
                  f_{peri} = \sum_{k=1}^{10} (a_k \cos k q + b_k \sin k q)

        with q the angle and v the speed of the place it acts on, s_1 = quadratic, s_2 = linear, s_3 = constant, a_k = cosine and
        b_k = sine, by their place k = 1, 2 ..., kappa = static_ratio, epsilon = speed_factor, v_c = reference_speed (at which
        f_aver was measured), b = viscous. A level below zero counts as zero. The article prints no a_k and b_k; its other numbers
        are those of the example, all SI.

        Valid for q from domain_start to domain_end. A parabola has no bound: that of the article has its minimum,
        0.0491812523669 N.m, at 120.412377685 rad, and its first value again at twice that angle. ``outside`` sets
        f_aver beyond the domain: ``"clamp"`` keeps the value of the nearer end, ``"periodic"`` repeats the domain,
        ``"refuse"`` is an error. f_peri is periodic in any case.

        The article prints the sliding branch with the wrong sign and for v > 0 only; its factor 0.0004 needs the unit
        s/rad, and its v_c is the reference speed, not a threshold. A constant a_0 / 2 is not identifiable
        together with s_3 and is left out.

        >>> from strainwave.friction import PositionDependent
        >>> law = PositionDependent(quadratic=1.5738e-6, linear=-3.7901e-4, constant=0.0720, static_ratio=1.0388,
        ...                         speed_factor=0.0004, reference_speed=0.8, domain_start=0.0, domain_end=240.8)
        >>> law.steady([0.8, -0.8])
        array([ 0.072, -0.072]))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, quadratic, "N.m/rad2", "Coefficient s_1 of the average friction"));
        visit(SW_FIELD(m, linear, "N.m/rad", "Coefficient s_2 of the average friction"));
        visit(SW_REQUIRED(m, constant, "N.m", "Average friction s_3 at angle 0"));
        visit(SW_FIELD(m, cosine, "N.m", "Amplitudes a_k of cos k q, k = 1, 2 ..."));
        visit(SW_FIELD(m, sine, "N.m", "Amplitudes b_k of sin k q, k = 1, 2 ..."));
        visit(SW_FIELD(m, static_ratio, "1", "Static over kinetic friction kappa", 1));
        visit(SW_FIELD(m, speed_factor, "s/rad", "Relative rise of the average friction with speed", 0));
        visit(SW_FIELD(m, reference_speed, "rad/s", "Speed v_c at which the average friction was measured", 0));
        visit(SW_FIELD(m, viscous, "N.m.s/rad", "Viscous torque per speed", 0));
        visit(SW_REQUIRED(m, domain_start, "rad", "Lower end of the measured domain of the average friction"));
        visit(SW_REQUIRED(m, domain_end, "rad", "Upper end of the measured domain of the average friction"));
        visit(SW_FIELD(m, outside, "1", "Average friction beyond its domain"));
    }

    constexpr const char* problem() const {
        return all(domain_end > domain_start) ? nullptr : "domain_end must exceed domain_start";
    }

    using State = Stateless<S>;

    /// Torque that opposes sliding, in N.m.
    constexpr S torque(const State&, const Contact<S>& contact) const {
        return contact.sliding * level(contact, abs(contact.speed) - reference_speed) + contact.viscous * viscous * contact.speed;
    }

    /// The largest torque it balances at rest, in N.m: at least the torque at the begin of sliding.
    constexpr S hold(const Contact<S>& contact) const {
        return max(static_ratio * level(contact, S(0.0)), level(contact, -reference_speed));
    }

    /// Range of angles in which the law is valid.
    constexpr Domain<S> domain(const Contact<S>& contact) const {
        if (outside != Outside::refuse) return {"angle", angle(contact), S(-unbounded), S(unbounded), "rad", ""};
        return {"angle",    angle(contact), domain_start,
                domain_end, "rad",          "widen domain_start to domain_end, or set outside to 'clamp' or 'periodic'"};
    }

private:
    static constexpr S angle(const Contact<S>& contact) { return contact.angle.within + S(2.0 * pi) * contact.angle.turns; }

    /// Factor at a speed `faster` than the reference; multiplied last, so that no product overflows before the result does.
    constexpr S level(const Contact<S>& contact, const S& faster) const {
        const S q = inside(angle(contact)), average = contact.dry * ((quadratic * q + linear) * q + constant);
        return max(average + average * speed_factor * faster + contact.dry * ripple(contact.angle.within), S(0.0));
    }

    /// The angle of the domain that replaces this one.
    constexpr S inside(const S& q) const {
        if (outside != Outside::periodic) return clip(q, domain_start, domain_end);
        const S length = max(domain_end - domain_start, S(smallest)), periods = (q - domain_start) / length;
        const S nearest = rint(periods), whole = nearest - select(periods < nearest, S(1.0), S(0.0));
        return min(max(domain_start, q - whole * length), domain_end);  // in this order also where q overflows
    }

    constexpr S ripple(const S& q) const {
        S sum{0.0};
        if (cosine.count == 0 && sine.count == 0) return sum;
        const SinCos<S> turn = sincos(q);
        S c = turn.cos, s = turn.sin;
        for (int k = 0; k < cosine.count || k < sine.count; ++k) {
            if (k < cosine.count) sum = sum + cosine[k] * c;
            if (k < sine.count) sum = sum + sine[k] * s;
            const S next = c * turn.cos - s * turn.sin;
            s = s * turn.cos + c * turn.sin;
            c = next;
        }
        return sum;
    }
};

}  // namespace strainwave::friction
