#pragma once
#include <strainwave/array.hpp>
#include <strainwave/math.hpp>

/// Small square matrices, and the functions of them that exponential methods take.
namespace strainwave::integrate {

namespace detail {
template <class Numbers>
struct Elements;
template <class S, int n>
struct Elements<Array<S, n>> {
    using Scalar = S;
    static constexpr int capacity = n;
};
template <class S, int n>
struct Elements<Counted<S, n>> {
    using Scalar = S;
    static constexpr int capacity = n;
};
}  // namespace detail

template <class Numbers>
using ScalarOf = typename detail::Elements<Numbers>::Scalar;

/// A square matrix, by its columns: as many as a column has elements.
template <class Numbers>
struct Square {
    Numbers column[detail::Elements<Numbers>::capacity];

    constexpr Numbers& operator[](int j) { return column[j]; }
    constexpr const Numbers& operator[](int j) const { return column[j]; }
    constexpr int size() const { return column[0].size(); }
};

/// Gives others as many rows and columns as one has; their values are not set.
template <class Numbers, class... Others>
constexpr void size_like(const Square<Numbers>& matrix, Others&... others) {
    for (int j = 0; j < matrix.size(); ++j) size_like(matrix[j], others[j]...);
}

template <class Numbers>
constexpr Numbers times(const Square<Numbers>& a, const Numbers& x) {
    Numbers y = zeros_like(x);
    for (int j = 0; j < x.size(); ++j)
        for (int i = 0; i < x.size(); ++i) y[i] = y[i] + a[j][i] * x[j];
    return y;
}
/// c becomes a b.
template <class Numbers>
constexpr void multiply(const Square<Numbers>& a, const Square<Numbers>& b, Square<Numbers>& c) {
    for (int j = 0; j < b.size(); ++j) c[j] = times(a, b[j]);
}

/// Brings the sums of each row and of each column close to each other: D^-1 Z D takes the place of Z, and D, which is diagonal, is
/// returned (Osborne 1960). Sums below 1 are left alone: they are of no account for exp Z.
template <class Numbers>
constexpr Numbers balance(Square<Numbers>& z) {
    using S = ScalarOf<Numbers>;
    constexpr int balancing_sweeps = 4;
    const int n = z.size();
    Numbers scale = zeros_like(z[0]);
    for (int i = 0; i < n; ++i) scale[i] = S(1.0);
    for (int sweep = 0; sweep < balancing_sweeps; ++sweep)
        for (int i = 0; i < n; ++i) {
            S of_column{1.0}, of_row{1.0};
            for (int j = 0; j < n; ++j) {
                if (j == i) continue;
                of_column = of_column + abs(z[i][j]);
                of_row = of_row + abs(z[j][i]);
            }
            const S by = value_only(S(sqrt(of_row / of_column))), inverse = S(1.0) / by;
            for (int j = 0; j < n; ++j) {
                if (j == i) continue;
                z[i][j] = by * z[i][j];
                z[j][i] = inverse * z[j][i];
            }
            scale[i] = scale[i] * by;
        }
    return scale;
}

/// The largest sum of a column's sizes.
template <class Numbers>
constexpr auto largest_column(const Square<Numbers>& z) {
    using S = ScalarOf<Numbers>;
    S largest{0.0};
    for (int j = 0; j < z.size(); ++j) {
        S sum{0.0};
        for (int i = 0; i < z.size(); ++i) sum = sum + abs(z[j][i]);
        largest = max(largest, sum);
    }
    return largest;
}

/// exp Z, and phi_1, phi_2, phi_3 of a matrix Z: phi_k = sum over j of Z^j / (j + k)!. Worked out in place, for there is little
/// memory on a microcontroller.
template <class Numbers>
struct PhiFunctions {
    using S = ScalarOf<Numbers>;

    Square<Numbers> exponential, first, second, third;

    /// The functions of `z`: by their series if Z is small, and by doubling from there (Skaflestad and Wright 2009). The count of
    /// doublings follows for each lane by itself, so that each has the bits that it has alone. What `z` and `room` hold is lost.
    constexpr void set(Square<Numbers>& z, Square<Numbers>& room) {
        constexpr double max_series_norm = 0.5;
        constexpr int max_doublings = 64;
        const Numbers scale = balance(z);
        S norm = value_only(largest_column(z)), part{1.0}, doublings{0.0};
        for (int i = 0; i < max_doublings; ++i) {
            const auto large = norm > S(max_series_norm);
            if (!any(large)) break;
            norm = select(large, S(0.5) * norm, norm);
            part = select(large, S(0.5) * part, part);
            doublings = select(large, doublings + S(1.0), doublings);
        }
        size_like(z, exponential, first, second, third);
        for_each_place([&](int i, int j) { z[j][i] = part * z[j][i]; });
        set_small(z);
        for (S done{0.0};; done = done + S(1.0)) {
            const auto less = done < doublings;
            if (!any(less)) break;
            double_integrals(less);
            multiply(exponential, exponential, room);
            for_each_place([&](int i, int j) { exponential[j][i] = select(less, room[j][i], exponential[j][i]); });
        }
        for_each_place([&](int i, int j) {
            const S by = scale[i] / scale[j];
            exponential[j][i] = by * exponential[j][i];
            first[j][i] = by * first[j][i];
            second[j][i] = by * second[j][i];
            third[j][i] = by * third[j][i];
        });
    }
    /// phi_1, phi_2 and phi_3 of Z become those of 2 Z, in these lanes; exp Z stays.
    template <class Mask>
    constexpr void double_integrals(const Mask& lanes) {
        const int n = third.size();
        for (int j = 0; j < n; ++j) {
            Numbers moved = times(exponential, third[j]);
            for (int i = 0; i < n; ++i) {
                const S doubled = S(0.125) * (moved[i] + (S(0.5) * first[j][i] + (second[j][i] + third[j][i])));
                third[j][i] = select(lanes, doubled, third[j][i]);
            }
            moved = times(exponential, second[j]);
            for (int i = 0; i < n; ++i)
                second[j][i] = select(lanes, S(0.25) * (moved[i] + (first[j][i] + second[j][i])), second[j][i]);
            moved = times(exponential, first[j]);
            for (int i = 0; i < n; ++i) first[j][i] = select(lanes, S(0.5) * (moved[i] + first[j][i]), first[j][i]);
        }
    }

private:
    template <class F>
    constexpr void for_each_place(const F& f) const {
        for (int j = 0; j < third.size(); ++j)
            for (int i = 0; i < third.size(); ++i) f(i, j);
    }
    /// Sums to z^12 / 15! of phi_3, nested; the others follow from phi_k = 1/k! + Z phi_(k+1). Where no column sums to more than
    /// 1/2 what is left out is below 1e-17.
    constexpr void set_small(const Square<Numbers>& z) {
        constexpr int last = 15, first_of_third = 4;
        for_each_place([&](int i, int j) { third[j][i] = S(i == j ? 1.0 : 0.0); });
        S k{double(last)};
        for (int nested = last; nested >= first_of_third; --nested) {
            multiply(z, third, second);
            const S share = S(1.0) / k;
            for_each_place([&](int i, int j) { third[j][i] = share * second[j][i]; });
            add_to_diagonal(third, S(1.0));
            k = k - S(1.0);
        }
        for_each_place([&](int i, int j) { third[j][i] = S(1.0 / 6.0) * third[j][i]; });
        multiply(z, third, second);
        add_to_diagonal(second, S(0.5));
        multiply(z, second, first);
        add_to_diagonal(first, S(1.0));
        multiply(z, first, exponential);
        add_to_diagonal(exponential, S(1.0));
    }
    static constexpr void add_to_diagonal(Square<Numbers>& a, const S& x) {
        for (int i = 0; i < a.size(); ++i) a[i][i] = x + a[i][i];
    }
};

}  // namespace strainwave::integrate
