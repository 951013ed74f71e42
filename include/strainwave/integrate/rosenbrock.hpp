#pragma once
#include <strainwave/integrate/interval.hpp>

namespace strainwave::integrate {

namespace detail {
template <class Vector>
struct RowsOf;
template <class S, int n>
struct RowsOf<Array<S, n>> {
    using Scalar = S;
    using type = Array<Array<S, n>, n>;
    using Order = Array<int, n>;
};
template <class S, int capacity>
struct RowsOf<Counted<S, capacity>> {
    using Scalar = S;
    using type = Counted<Counted<S, capacity>, capacity>;
    using Order = Array<int, capacity>;
};
}  // namespace detail

/// A square matrix, by its rows: as many as a row has elements.
template <class Vector>
using Matrix = typename detail::RowsOf<Vector>::type;

/// A matrix of zeros whose rows are as long as `row`.
template <class Vector>
constexpr Matrix<Vector> zero_matrix(Vector row) {
    Matrix<Vector> matrix;
    if constexpr (requires { matrix.count; }) matrix.count = row.size();
    for (int j = 0; j < row.size(); ++j) row[j] = typename detail::RowsOf<Vector>::Scalar(0.0);
    for (int i = 0; i < row.size(); ++i) matrix[i] = row;
    return matrix;
}

/// A square matrix in its factors, to solve equations with.
template <class Vector>
class Factored {
    Matrix<Vector> rows;
    typename detail::RowsOf<Vector>::Order order;
    using S = typename detail::RowsOf<Vector>::Scalar;

public:
    /// Gauss's elimination with the largest pivot left in each column. A row with one number only comes first, so that its
    /// solution is exact to the last bit: a shaft that sticks does not move.
    constexpr explicit Factored(const Matrix<Vector>& matrix) : rows(matrix), order{} {
        const int n = rows.size();
        for (int i = 0; i < n; ++i) order[i] = i;
        for (int k = 0; k < n; ++k) {
            int pivot = k;
            for (int i = k + 1; i < n; ++i)
                if (!alone(rows[order[pivot]], k) &&
                    (alone(rows[order[i]], k) || abs(rows[order[i]][k]) > abs(rows[order[pivot]][k])))
                    pivot = i;
            const int first = order[pivot];
            order[pivot] = order[k];
            order[k] = first;
            for (int i = k + 1; i < n; ++i) {
                Vector& row = rows[order[i]];
                if (row[k] == S(0.0)) continue;
                row[k] = row[k] / rows[first][k];
                for (int j = k + 1; j < n; ++j) row[j] = row[j] - row[k] * rows[first][j];
            }
        }
    }
    /// True if a row has one number only, at place k.
    static constexpr bool alone(const Vector& row, int k) {
        for (int j = 0; j < row.size(); ++j)
            if ((row[j] == S(0.0)) == (j == k)) return false;
        return true;
    }
    constexpr Vector solve(const Vector& right) const {
        const int n = right.size();
        Vector x = right;
        for (int i = 0; i < n; ++i) {
            x[i] = right[order[i]];
            for (int j = 0; j < i; ++j) x[i] = x[i] - rows[order[i]][j] * x[j];
        }
        for (int i = n - 1; i >= 0; --i) {
            for (int j = i + 1; j < n; ++j) x[i] = x[i] - rows[order[i]][j] * x[j];
            x[i] = x[i] / rows[order[i]][i];
        }
        return x;
    }
};

namespace detail {

/// ROS34PW2 of Rang and Angermann (2005), table 4.1: four stages, third order with any matrix for the Jacobian, L-stable.
struct Ros34pw2 {
    static constexpr int stages = 4;
    static constexpr double gamma = 0.43586652150845900;
    static constexpr double argument[stages][stages] = {
        {}, {0.87173304301691801}, {0.84457060015369423, -0.11299064236484185}, {0.0, 0.0, 1.0}};
    static constexpr double coupling[stages][stages] = {{},
                                                        {-0.87173304301691801},
                                                        {-0.90338057013044082, 0.054180672388095326},
                                                        {0.24212380706095346, -1.2232505839045147, 0.54526025533510214}};
    static constexpr double weight[stages] = {0.24212380706095346, -1.2232505839045147, 1.5452602553351020, 0.43586652150845900};

    /// Fraction of the step of a stage.
    static constexpr double abscissa(int stage) {
        double sum = 0.0;
        for (int j = 0; j < stage; ++j) sum += argument[stage][j];
        return sum;
    }
};

/// The Jacobian of `rate` by `y`, by differences towards zero, within the limits of `clamped`.
template <class S, class Vector, class Rate, class Clamped>
constexpr Matrix<Vector> jacobian(const Rate& rate, const Clamped& clamped, const Vector& y, const Vector& now, const S& dt) {
    Matrix<Vector> matrix = zero_matrix(y);
    for (int j = 0; j < y.size(); ++j) {
        const S moved = S(1e-7) * (abs(y[j]) + dt * abs(now[j])) + S(1e-10);
        Vector perturbed = y;
        perturbed[j] = y[j] - along(y[j], moved);
        perturbed[j] = clamped(perturbed)[j];
        const S difference = perturbed[j] - y[j];
        if (difference == S(0.0)) continue;
        const Vector then = rate(perturbed);
        for (int i = 0; i < y.size(); ++i) matrix[i][j] = (then[i] - now[i]) / difference;
    }
    return matrix;
}

}  // namespace detail

/// One step without events of a Rosenbrock W-method, of third order: stable whatever the stiffness of the bristles. For scalars
/// that are plain numbers.
template <class S, class System>
constexpr typename System::State rosenbrock_step(const System& system, const typename System::Evaluation& from,
                                                 const Interval<typename System::Input>& u, const S& dt) {
    using Continuous = typename System::Continuous;
    using Table = detail::Ros34pw2;
    using Vector = Flat<S, Continuous>;
    auto x = from.state;
    const auto& now = from.derivatives;
    const Continuous start = x.continuous;
    const auto clamped = [&](const Vector& at) { return system::clamped(system, refilled(start, at), now); };
    const Vector y = flattened<S>(start);
    const int n = y.size();
    const auto matrix = detail::jacobian<S>(
        [&](const Vector& perturbed) { return flattened<S>(system.derivatives(x, refilled(start, perturbed), u.start).rate); },
        [&](const Vector& perturbed) { return flattened<S>(clamped(perturbed)); }, y, flattened<S>(now.rate), dt);
    Matrix<Vector> left = zero_matrix(y);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) left[i][j] = S(i == j ? 1.0 : 0.0) - dt * S(Table::gamma) * matrix[i][j];
    const Factored<Vector> factored(left);

    const Vector zero = flattened<S>(zeroed<S>(start));
    Vector k[Table::stages], end = y;
    for (int stage = 0; stage < Table::stages; ++stage) {
        Vector at = y, coupled = zero;
        for (int j = 0; j < stage; ++j)
            for (int i = 0; i < n; ++i) {
                at[i] = at[i] + S(Table::argument[stage][j]) * k[j][i];
                coupled[i] = coupled[i] + S(Table::coupling[stage][j]) * k[j][i];
            }
        const Vector rate = flattened<S>(system.derivatives(x, clamped(at), u.at(S(Table::abscissa(stage)), dt)).rate);
        Vector right = zero;
        for (int i = 0; i < n; ++i) {
            right[i] = dt * rate[i];
            for (int j = 0; j < n; ++j) right[i] = right[i] + dt * matrix[i][j] * coupled[j];
        }
        k[stage] = factored.solve(right);
        for (int i = 0; i < n; ++i) end[i] = end[i] + S(Table::weight[stage]) * k[stage][i];
    }
    x.continuous = system::update_mode(system, clamped(end), now);
    system::finish_step(system, x, dt);
    return x;
}

}  // namespace strainwave::integrate
