#pragma once
#include <strainwave/array.hpp>
#include <strainwave/math.hpp>

/// Small square matrices of fixed size, and the functions of them that exponential methods take.
namespace strainwave::integrate {

/// A square matrix, by its columns.
template <class S, int n>
using Square = Array<Array<S, n>, n>;

template <class S, int n>
constexpr Array<S, n> times(const Square<S, n>& a, const Array<S, n>& x) {
    Array<S, n> y{};
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) y[i] = y[i] + a[j][i] * x[j];
    return y;
}
template <class S, int n>
constexpr Square<S, n> times(const Square<S, n>& a, const Square<S, n>& b) {
    Square<S, n> c;
    for (int j = 0; j < n; ++j) c[j] = times(a, b[j]);
    return c;
}
/// f(number of `a`, number of `b`, ...) at each place.
template <class F, class S, int n, class... Others>
constexpr Square<S, n> each(const F& f, const Square<S, n>& a, const Others&... others) {
    Square<S, n> c;
    for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) c[j][i] = f(a[j][i], others[j][i]...);
    return c;
}

/// Brings the sums of each row and of each column close to each other: D^-1 Z D takes the place of Z, and D, which is diagonal, is
/// returned (Osborne 1960). Sums below 1 are left alone: they are of no account for exp Z.
template <class S, int n>
constexpr Array<S, n> balance(Square<S, n>& z) {
    constexpr int sweeps = 4;
    Array<S, n> scale;
    for (int i = 0; i < n; ++i) scale[i] = S(1.0);
    for (int sweep = 0; sweep < sweeps; ++sweep)
        for (int i = 0; i < n; ++i) {
            S of_column{1.0}, of_row{1.0};
            for (int j = 0; j < n; ++j) {
                if (j == i) continue;
                of_column = of_column + abs(z[i][j]);
                of_row = of_row + abs(z[j][i]);
            }
            const S by = detached(S(sqrt(of_row / of_column))), inverse = S(1.0) / by;
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
template <class S, int n>
constexpr S largest_column(const Square<S, n>& z) {
    S largest{0.0};
    for (int j = 0; j < n; ++j) {
        S sum{0.0};
        for (int i = 0; i < n; ++i) sum = sum + abs(z[j][i]);
        largest = max(largest, sum);
    }
    return largest;
}

/// exp Z, and phi_1, phi_2, phi_3 of a matrix Z: phi_k = sum over j of Z^j / (j + k)!.
template <class S, int n>
struct PhiFunctions {
    Square<S, n> exponential, first, second, third;

    /// By their series where Z is small, and by doubling from there (Skaflestad and Wright 2009). How often is told for each lane
    /// by itself, so that each has the bits that it has alone.
    static constexpr PhiFunctions of(Square<S, n> z) {
        constexpr double small = 0.5;
        constexpr int most = 64;
        const Array<S, n> scale = balance(z);
        S norm = detached(largest_column(z)), part{1.0}, doublings{0.0};
        for (int i = 0; i < most; ++i) {
            const auto large = norm > S(small);
            if (!any(large)) break;
            norm = select(large, S(0.5) * norm, norm);
            part = select(large, S(0.5) * part, part);
            doublings = select(large, doublings + S(1.0), doublings);
        }
        PhiFunctions phi = of_small(each([&](const S& x) { return part * x; }, z));
        for (S done{0.0};; done = done + S(1.0)) {
            const auto less = done < doublings;
            if (!any(less)) break;
            phi.choose(less, phi.doubled());
        }
        phi.unbalance(scale);
        return phi;
    }
    /// The same of 2 Z.
    constexpr PhiFunctions doubled() const {
        PhiFunctions twice;
        twice.exponential = times(exponential, exponential);
        twice.first = each([](const S& moved, const S& one) { return S(0.5) * (moved + one); }, times(exponential, first), first);
        twice.second = each([](const S& moved, const S& one, const S& two) { return S(0.25) * (moved + (one + two)); },
                            times(exponential, second), first, second);
        twice.third = each(
            [](const S& moved, const S& one, const S& two, const S& three) {
                return S(0.125) * (moved + (S(0.5) * one + (two + three)));
            },
            times(exponential, third), first, second, third);
        return twice;
    }

private:
    /// Sums to z^12 / 15! of phi_3, nested; the others follow from phi_k = 1/k! + Z phi_(k+1). Where no column sums to more than
    /// 1/2 what is left out is below 1e-17.
    static constexpr PhiFunctions of_small(const Square<S, n>& z) {
        constexpr int last = 15, first_of_third = 4;
        Square<S, n> sum = plus(S(1.0), Square<S, n>{});
        S k{double(last)};
        for (int j = last; j >= first_of_third; --j) {
            const S share = S(1.0) / k;
            sum = plus(S(1.0), times(each([&](const S& x) { return share * x; }, z), sum));
            k = k - S(1.0);
        }
        PhiFunctions phi;
        phi.third = each([](const S& x) { return S(1.0 / 6.0) * x; }, sum);
        phi.second = plus(S(0.5), times(z, phi.third));
        phi.first = plus(S(1.0), times(z, phi.second));
        phi.exponential = plus(S(1.0), times(z, phi.first));
        return phi;
    }
    /// x more on the diagonal.
    static constexpr Square<S, n> plus(const S& x, Square<S, n> a) {
        for (int i = 0; i < n; ++i) a[i][i] = x + a[i][i];
        return a;
    }
    template <class Mask>
    constexpr void choose(const Mask& mask, const PhiFunctions& other) {
        const auto chosen = [&](const S& own, const S& others) { return select(mask, others, own); };
        exponential = each(chosen, exponential, other.exponential);
        first = each(chosen, first, other.first);
        second = each(chosen, second, other.second);
        third = each(chosen, third, other.third);
    }
    constexpr void unbalance(const Array<S, n>& scale) {
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) {
                const S by = scale[i] / scale[j];
                exponential[j][i] = by * exponential[j][i];
                first[j][i] = by * first[j][i];
                second[j][i] = by * second[j][i];
                third[j][i] = by * third[j][i];
            }
    }
};

}  // namespace strainwave::integrate
