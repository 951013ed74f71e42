#pragma once

namespace strainwave {

/// A fixed number of elements: what a state repeats.
template <class T, int n>
struct Array {
    T item[n]{};

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

}  // namespace strainwave
