#pragma once

namespace strainwave {

/// A fixed number of repeated elements of a state. Zero only if it is declared with {}.
template <class T, int n>
struct Array {
    T item[n > 0 ? n : 1];  // C++ has no array of no elements

    constexpr T& operator[](int i) { return item[i]; }
    constexpr const T& operator[](int i) const { return item[i]; }
    static constexpr int size() { return n; }
};

/// Up to `capacity` repeated elements of a set of parameters (harmonics, Maxwell elements).
template <class T, int capacity_>
struct Sequence {
    static constexpr int capacity = capacity_;
    T item[capacity]{};
    int count = 0;

    constexpr T& operator[](int i) { return item[i]; }
    constexpr const T& operator[](int i) const { return item[i]; }
    constexpr int size() const { return count; }
};

/// Elements of a model chosen at run time, at most `capacity`: no more are constructed or copied.
template <class T, int capacity_>
struct Counted {
    static constexpr int capacity = capacity_;
    union {
        T item[capacity];
    };
    int count;

    constexpr explicit Counted(int n = 0) : count(n) {}
    constexpr Counted(const Counted& other) : count(other.count) { copy(other); }
    constexpr Counted& operator=(const Counted& other) {
        count = other.count;
        copy(other);
        return *this;
    }

    constexpr T& operator[](int i) { return item[i]; }
    constexpr const T& operator[](int i) const { return item[i]; }
    constexpr int size() const { return count; }

private:
    constexpr void copy(const Counted& other) {
        for (int i = 0; i < count; ++i) item[i] = other.item[i];
    }
};

/// Gives others as many elements as one has; their values are not set.
template <class T, int n, class... Others>
constexpr void size_like(const Array<T, n>&, Others&...) {}
template <class T, int capacity, class... Others>
constexpr void size_like(const Counted<T, capacity>& elements, Others&... others) {
    ((others.count = elements.count), ...);
}

/// A sequence of zeros with the count of another.
template <class T, int n>
constexpr Array<T, n> zeros_like(const Array<T, n>&) {
    return Array<T, n>{};
}
template <class T, int capacity>
constexpr Counted<T, capacity> zeros_like(const Counted<T, capacity>& elements) {
    Counted<T, capacity> zeros(elements.count);
    for (int i = 0; i < zeros.count; ++i) zeros[i] = T(0.0);
    return zeros;
}

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

/// f(i) for the index of each element.
template <class T, int n, class F>
constexpr void for_each_index(const Array<T, n>&, const F& f) {
    for_each_of<n>(f);
}
template <class T, int capacity, class F>
constexpr void for_each_index(const Counted<T, capacity>& elements, const F& f) {
    for (int i = 0; i < elements.count; ++i) f(i);
}

}  // namespace strainwave
