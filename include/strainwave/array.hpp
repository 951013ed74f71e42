#pragma once

namespace strainwave {

/// A fixed number of elements: what a state repeats. Zero only where it is declared with {}.
template <class T, int n>
struct Array {
    T item[n];

    constexpr T& operator[](int i) { return item[i]; }
    constexpr const T& operator[](int i) const { return item[i]; }
    static constexpr int size() { return n; }
};

/// Up to `capacity` elements: what a set of parameters repeats (harmonics, Maxwell elements).
template <class T, int capacity_>
struct Sequence {
    static constexpr int capacity = capacity_;
    T item[capacity]{};
    int count = 0;

    constexpr T& operator[](int i) { return item[i]; }
    constexpr const T& operator[](int i) const { return item[i]; }
    constexpr int size() const { return count; }
};

/// f(0), ..., f(n - 1); written out where they are few. A short loop would become one of vectors, whose loads wait for the numbers
/// just stored one by one.
template <int n, int i = 0, class F>
constexpr void for_each_of(const F& f) {
    if constexpr (n > 16) {
        for (int k = 0; k < n; ++k) f(k);
    } else if constexpr (i < n) {
        f(i);
        for_each_of<n, i + 1>(f);
    }
}

}  // namespace strainwave
