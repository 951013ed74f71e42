#pragma once
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>

/// Densities of Preisach's law. Each offers, for turning points low <= high and any twists:
///   everett(high, low)  half the change of torque on the branch between them [N.m]
///   rising(high, low)   integral of everett(s, low) over s from low to high [J]
///   falling(high, low)  integral of everett(high, s) over s from low to high [J]
///   virgin(reach)       torque on the initial curve at a twist of reach >= 0 [N.m]
///   virgin_work(twist)  work along the initial curve up to a twist of either sign [J]
namespace strainwave::hysteresis {

template <class S>
struct PowerDensity {
    S limit{1e-3};
    S saturation{0.0};
    S exponent{2.0};

    static constexpr auto name = "power_density";
    static constexpr auto source = "Rayleigh1887 (exponent 2); Everett1955; the power is assumed";
    static constexpr auto doc = R"(
        Preisach density that falls with the width of the window as a power: a loop with three parameters.

        .. math:: E(a, b) = T_s [1 - (1 - u)^p], \quad u = \frac{a - b}{2 L}, \quad
                  \mu = \frac{p (p - 1) T_s}{4 L^2} (1 - u)^{p - 2}

        with L = limit, T_s = saturation, p = exponent, a and b cut at +-L; the initial curve is E(x, -x). Exponent 1 is a
        spring that saturates at L, without loss. Exponent 2 is uniform density, whose branches are the parabolas of Rayleigh's
        law. A higher exponent is stiffer after a reversal, p T_s / L, and slips sooner; with L in proportion to p it tends to
        exponential branches. Odd, and obeys Masing's rules, which Preisach's law in general does not.

        >>> from strainwave.hysteresis import PowerDensity, Preisach
        >>> gear = Preisach(density=PowerDensity(limit=1.0, saturation=1.0, exponent=2.0))
        >>> gear.trace([0.0, 0.5, -0.5, 0.0])
        array([ 0.   ,  0.75 , -0.75 ,  0.125]))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_REQUIRED(m, limit, "rad", "Twist L at which everything slips", smallest));
        visit(SW_REQUIRED(m, saturation, "N.m", "Torque T_s at which everything slips", 0));
        visit(SW_FIELD(m, exponent, "1", "Power p: 1 elastic, 2 uniform density", 1, 100));
    }

    constexpr S everett(const S& high, const S& low) const { return saturation * curve(share(high, low)).level; }

    constexpr S rising(const S& high, const S& low) const {
        const Curve c = curve(share(high, low));
        return saturation * (S(2.0) * limit * c.area + (high - inside(high)) * c.level);
    }
    constexpr S falling(const S& high, const S& low) const {
        const Curve c = curve(share(high, low));
        return saturation * (S(2.0) * limit * c.area + (inside(low) - low) * c.level);
    }

    constexpr S virgin(const S& reach) const { return saturation * curve(inside(reach) / limit).level; }
    constexpr S virgin_work(const S& twist) const {
        const S reach = abs(twist);
        const Curve c = curve(inside(reach) / limit);
        return saturation * (limit * c.area + (reach - inside(reach)) * c.level);
    }

private:
    /// 1 - (1 - u)^p, and its integral from 0 to u.
    struct Curve {
        S level, area;
    };

    constexpr S inside(const S& twist) const { return clip(twist, -limit, limit); }
    constexpr S share(const S& high, const S& low) const { return (inside(high) - inside(low)) / (S(2.0) * limit); }

    constexpr Curve curve(const S& u) const {
        const int p = whole(exponent, 8);
        return p > 0 ? geometric(u, p) : real(u);
    }

    /// 1 - y^p = (1 - y)(1 + y + ... + y^(p-1)): no cancellation, however small u is.
    static constexpr Curve geometric(const S& u, int p) {
        const S y = S(1.0) - u;
        S sum{0.0}, sums{0.0};
        for (int k = 0; k < p; ++k) {
            sum = S(1.0) + y * sum;
            sums = sums + sum;
        }
        return {u * sum, u * u * sums / S(p + 1)};
    }

    constexpr Curve real(const S& u) const {
        const S y = S(1.0) - u, power = exp(exponent * log(max(y, S(smallest))));
        const Curve small = binomial(u), closed{S(1.0) - power, u - (S(1.0) - y * power) / (exponent + S(1.0))};
        const auto near = exponent * u < S(0.125);
        return {select(near, small.level, closed.level), select(near, small.area, closed.area)};
    }

    /// The binomial series, where the closed form would lose the digits of small u.
    constexpr Curve binomial(const S& u) const {
        S term = exponent * u;
        Curve sum{term, S(0.5) * term * u};
        for (int k = 2; k <= 12; ++k) {
            term = term * (S(k - 1) - exponent) * u / S(k);
            sum.level = sum.level + term;
            sum.area = sum.area + term * u / S(k + 1);
        }
        return sum;
    }
};

template <class S>
struct GridDensity {
    static constexpr int capacity = 55;

    S limit{1e-3};
    Sequence<S, capacity> weight{};

    static constexpr auto name = "grid_density";
    static constexpr auto source = "Mayergoyz1986; Everett integrals of uniform cells: own derivation";
    static constexpr auto doc = R"(
        Preisach density in uniform cells, for measured loops, symmetric or not.

        .. math:: E(a, b) = \sum_{i \ge j} w_{ij} (g_i + g_j - g_i g_j)

        with w_ij = weight, and g_i the share of row i that lies between the turning points b and a. [-L, L], L = limit, is cut
        into n equal rows. Cell (i, j) contains the hysterons whose window ends in row i and begins in row j, uniformly
        distributed. Each pushes from the moment its window is entered, forward from below, back from above. Weights begin at
        the most negative twist: (0,0), (1,0), (1,1), (2,0), ...: n (n + 1) / 2 of them, n up to 10; without weights there is
        no hysteresis. The torque is linear in the weights. The change from one saturation to the other is twice their sum.

        The torque of the virgin gear is zero, as with all hysteresis. If the weights w_ij and w_(n-1-j)(n-1-i) are not equal,
        the two saturations differ.

        >>> from strainwave.hysteresis import GridDensity, Preisach
        >>> gear = Preisach(density=GridDensity(limit=1.0, weight=[0.0, 0.5, 1.0]))
        >>> gear.trace([0.0, 1.0, -1.0, 1.0])
        array([ 0. ,  2.5, -0.5,  2.5]))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_REQUIRED(m, limit, "rad", "Twist L at which everything slips", smallest));
        visit(SW_REQUIRED(m, weight, "N.m", "Torque w_ij of each cell", 0));
    }

    constexpr const char* problem() const {
        return rows() * (rows() + 1) / 2 == weight.count ? nullptr : "weight must have 1, 3, 6, 10, ... elements, n (n + 1) / 2";
    }

    constexpr S everett(const S& high, const S& low) const {
        const Rows g = between(high, low);
        return summed([&](int i, int j) { return g[i] + g[j] - g[i] * g[j]; });
    }

    constexpr S rising(const S& high, const S& low) const {
        const Rows g = between(high, low);
        Rows above{};
        for (int i = 0; i < rows(); ++i) above[i] = max(high - edge(i + 1), S(0.0)) - max(low - edge(i + 1), S(0.0));
        return swept(g, above, [&](int i, int j, const Rows& area) { return area[j] + (S(1.0) - g[j]) * area[i]; });
    }
    constexpr S falling(const S& high, const S& low) const {
        const Rows g = between(high, low);
        Rows below{};
        for (int i = 0; i < rows(); ++i) below[i] = max(edge(i) - low, S(0.0)) - max(edge(i) - high, S(0.0));
        return swept(g, below, [&](int i, int j, const Rows& area) { return area[i] + (S(1.0) - g[i]) * area[j]; });
    }

    constexpr S virgin(const S& reach) const {
        const Rows r = between(reach, S(0.0));
        Rows half{};
        for (int i = 0; i < rows(); ++i) half[i] = r[i] * (S(1.0) - behind(i) - S(0.5) * r[i]);
        return S(2.0) * summed([&](int i, int j) { return entered(i, j, r, half); });
    }
    constexpr S virgin_work(const S& twist) const {
        const S reach = abs(twist);
        const Rows r = between(reach, S(0.0));
        Rows area{}, half{};
        for (int i = 0; i < rows(); ++i) {
            const S rest = S(1.0) - behind(i), above = max(reach - edge(i + 1), S(0.0));
            area[i] = r[i] * (S(0.5) * r[i] * width() + above);
            half[i] = r[i] * (r[i] * (S(0.5) * rest - r[i] / S(6.0)) * width() + (rest - S(0.5) * r[i]) * above);
        }
        // Backwards, the window (begin, end) is what (-end, -begin) is forwards.
        return S(2.0) * summed([&](int i, int j) {
                   const int last = rows() - 1;
                   return select(twist < S(0.0), entered(last - j, last - i, area, half), entered(i, j, area, half));
               });
    }

private:
    static constexpr int max_rows = 10;
    using Rows = Array<S, max_rows>;

    constexpr int rows() const {
        int n = 0;
        while (n < max_rows && n * (n + 1) / 2 < weight.count) ++n;
        return n;
    }
    constexpr S width() const { return S(2.0) * limit / S(rows()); }
    constexpr S edge(int i) const { return limit * S(2 * i - rows()) / S(rows()); }

    /// Count of rows below a twist.
    constexpr S place(const S& twist) const { return (clip(twist / limit, S(-1.0), S(1.0)) + S(1.0)) * S(0.5) * S(rows()); }
    /// The share of row i below a place.
    static constexpr S filled(const S& place, int i) { return clip(place - S(i), S(0.0), S(1.0)); }

    constexpr Rows between(const S& high, const S& low) const {
        const S top = place(high), bottom = place(low);
        const int n = rows();
        Rows g{};
        for (int i = 0; i < n; ++i) g[i] = filled(top, i) - filled(bottom, i);
        return g;
    }
    /// The share of row i that lies before the start.
    constexpr S behind(int i) const { return filled(S(0.5) * S(rows()), i); }

    /// The sum over the cells of weight times share(i, j).
    template <class Share>
    constexpr S summed(Share&& share) const {
        const int n = rows();
        S sum{0.0};
        for (int i = 0, cell = 0; i < n; ++i)
            for (int j = 0; j <= i && cell < weight.count; ++j, ++cell) sum = sum + weight[cell] * share(i, j);
        return sum;
    }

    /// The sum of the cells' shares integrated over a branch, which goes on for `beyond` after it has left a row. While it is in
    /// one row of a cell, the other is either passed or not yet met: only the cells on the diagonal hold a product.
    template <class Share>
    constexpr S swept(const Rows& g, const Rows& beyond, Share&& share) const {
        Rows area{}, square{};
        for (int i = 0; i < rows(); ++i) {
            area[i] = g[i] * (S(0.5) * g[i] * width() + beyond[i]);
            square[i] = g[i] * g[i] * (g[i] * width() / S(3.0) + beyond[i]);
        }
        return summed([&](int i, int j) { return i == j ? S(2.0) * area[i] - square[i] : share(i, j, area); });
    }

    /// The share of cell (i, j) that switches on the way from 0 forwards: the windows that begin there; and of those around 0, all
    /// that reach farther back than forth, at their end. `r` is the share of each row, `half` of it what is below the diagonal.
    constexpr S entered(int i, int j, const Rows& r, const Rows& half) const {
        const int across = i + j - (rows() - 1);
        if (i == j) return (across == 0 ? S(4.0) : S(2.0)) * half[i];
        return across < 0 ? r[j] + r[i] : across == 0 ? r[j] + half[i] : r[j];
    }
};

}  // namespace strainwave::hysteresis
