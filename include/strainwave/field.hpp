#pragma once
#include <strainwave/array.hpp>
#include <strainwave/documents.hpp>
#include <strainwave/math.hpp>

/// Parameters are written once: a model lists its members here, and Python, files, fits, reports and docs read the list.
namespace strainwave {

/// A bound that is none. FMI writes "no limit" this way, and NVRTC has no infinity to offer.
inline constexpr double unbounded = 1.7976931348623157e308;
/// A bound that excludes zero: the smallest normal number of every scalar, float included.
inline constexpr double smallest = 1.1754943508222875e-38;

/// True if two texts are the same.
constexpr bool same(const char* one, const char* other) {
    while (*one != 0 && *one == *other) {
        ++one;
        ++other;
    }
    return *one == *other;
}

/// Description of a member. Its default value is in the struct.
struct Field {
    const char* name;
    const char* unit;  ///< FMI/Modelica spelling: "N.m", "rad/s", "1"; empty for a part
    const char* doc;
    double min = -unbounded;
    double max = unbounded;
    bool whole = false;             ///< Only whole numbers
    bool required = false;          ///< Whoever makes the model must give it: no number of its kind suits most gears
    bool optional = false;          ///< A file may leave it out: with its default it has no effect, or only with another number
    const char* follows = nullptr;  ///< The member, listed before, whose value it takes where it is not given

    constexpr Field needed() const {
        Field field = *this;
        field.required = true;
        return field;
    }
    constexpr Field without_effect() const {
        Field field = *this;
        field.optional = true;
        return field;
    }
    constexpr Field following(const char* leader) const {
        Field field = *this;
        field.follows = leader;
        return field;
    }
};

/// Describes a number, or a sequence of numbers: SW_FIELD(m, member, unit, doc, min, max).
#define SW_FIELD(self, member, ...) \
    (self).member, ::strainwave::Field { #member, __VA_ARGS__ }
/// A required member, without default in Python. The value in the struct is an order of magnitude.
#define SW_REQUIRED(self, member, ...) (self).member, ::strainwave::Field{#member, __VA_ARGS__}.needed()
/// A member without effect by default, which a file may leave out.
#define SW_OPTIONAL(self, member, ...) (self).member, ::strainwave::Field{#member, __VA_ARGS__}.without_effect()
/// A member whose default is another member, listed before: SW_FOLLOWS(m, member, leader, unit, doc, ...).
#define SW_FOLLOWS(self, member, leader, ...) (self).member, ::strainwave::Field{#member, __VA_ARGS__}.following(#leader)
/// Describes a member that is itself described: SW_PART(m, member, doc).
#define SW_PART(self, member, doc) \
    (self).member, ::strainwave::Field { #member, "", doc }

namespace detail {

struct Ignore {
    template <class T>
    constexpr void operator()(T&, const Field&) const {}
};

struct Anything {
    template <class T>
    constexpr operator T() const noexcept;
};

template <class T, class... Members>
consteval int members() {
    if constexpr (requires { T{Members{}..., Anything{}}; })
        return members<T, Members..., Anything>();
    else
        return sizeof...(Members);
}

/// Counts the base that models share: the first element of an aggregate. It names itself `Base`, and has no members.
template <class T>
inline constexpr int bases = requires { requires __is_empty(typename T::Base); } ? 1 : 0;

/// Counts the members visited; one visited twice does not count again.
struct Count {
    static constexpr int capacity = 64;
    const void* seen[capacity]{};
    int count = 0;

    template <class T>
    constexpr void operator()(T& member, const Field&) {
        for (int i = 0; i < count; ++i)
            if (seen[i] == &member) return;
        seen[count++] = &member;
    }
};

template <class T>
consteval int visited() {
    T model{};
    Count counter;
    T::fields(model, counter);
    return counter.count;
}

}  // namespace detail

/// A struct that lists its members.
template <class T>
concept Described = requires(T& model) { T::fields(model, detail::Ignore{}); };

/// Every member of `T` is described. Checked where a model is bound or listed, so a forgotten member does not compile.
template <Described T>
inline constexpr bool fully_described = detail::bases<T> + detail::visited<T>() == detail::members<T>();

namespace detail {

/// Count of scalars, elements of arrays included; of arrays with a count at run time, their capacity.
template <class S>
struct Counter {
    int count = 0;
    bool fixed = true;
    constexpr void operator()(const S&, const Field&) { ++count; }
    template <int n>
    constexpr void operator()(const Array<S, n>&, const Field&) {
        count += n;
    }
    template <int capacity>
    constexpr void operator()(const Counted<S, capacity>&, const Field&) {
        count += capacity;
        fixed = false;
    }
    template <Described T>
    constexpr void operator()(const T& part, const Field&) {
        T::fields(part, *this);
    }
};

template <class S, class X>
inline constexpr Counter<S> counter_of = [] {
    X state{};
    Counter<S> counter;
    X::fields(state, counter);
    return counter;
}();

/// Copies scalars one after the other: out of a state, or into one.
template <class S>
struct Read {
    S* target;
    int count = 0;
    template <class T>
    constexpr void operator()(const T& member, const Field&) {
        if constexpr (Described<T>)
            T::fields(member, *this);
        else if constexpr (requires { member.item; })
            for (int i = 0; i < member.size(); ++i) target[count++] = member[i];
        else
            target[count++] = member;
    }
};
template <class S>
struct Write {
    const S* source;
    int count = 0;
    template <class T>
    constexpr void operator()(T& member, const Field&) {
        if constexpr (Described<T>)
            T::fields(member, *this);
        else if constexpr (requires { member.item; })
            for (int i = 0; i < member.size(); ++i) member[i] = source[count++];
        else
            member = source[count++];
    }
};
template <class S>
Write(const S*) -> Write<S>;  // clang deduces none of an aggregate before version 17

template <class S>
struct Clear {
    template <class T>
    constexpr void operator()(T& member, const Field&) const {
        if constexpr (Described<T>)
            T::fields(member, *this);
        else if constexpr (requires { member.item; })
            for (int i = 0; i < member.size(); ++i) member[i] = S(0.0);
        else
            member = S(0.0);
    }
};

/// The scalars of a state, side by side.
template <class S, class X, bool fixed = counter_of<S, X>.fixed>
struct Flat {
    using type = Array<S, counter_of<S, X>.count>;
};
template <class S, class X>
struct Flat<S, X, false> {
    using type = Counted<S, counter_of<S, X>.count>;
};

}  // namespace detail

namespace detail {

struct Names {
    const char* name[64]{};
    int count = 0;
    template <class T>
    constexpr void operator()(const T&, const Field& field) {
        name[count++] = field.name;
    }
};

template <class One, class Other>
consteval bool alike() {
    One one{};
    Other other{};
    Names names, others;
    One::fields(one, names);
    Other::fields(other, others);
    for (int i = 0; i < names.count; ++i)
        if (others.count != names.count || !same(names.name[i], others.name[i])) return false;
    return true;
}

}  // namespace detail

/// True if two structs list members of the same names in the same order.
template <Described One, Described Other>
inline constexpr bool members_alike = detail::alike<One, Other>();

/// Largest count of scalars in a described state.
template <class S, Described X>
inline constexpr int size_of = detail::counter_of<S, X>.count;

template <class S, Described X>
using Flat = typename detail::Flat<S, X>::type;

/// The scalars of a described state, in the order it lists them.
template <class S, Described X>
constexpr Flat<S, X> flattened(const X& state) {
    Flat<S, X> scalars;
    detail::Read<S> read{scalars.item};
    X::fields(state, read);
    if constexpr (requires { scalars.count; }) scalars.count = read.count;
    return scalars;
}

/// Puts scalars in place of those of a state.
template <Described X, class Scalars>
constexpr void refill(X& state, const Scalars& scalars) {
    detail::Write write{scalars.item};
    X::fields(state, write);
}
/// The state with its scalars replaced by these.
template <Described X, class Scalars>
constexpr X refilled(const X& state, const Scalars& scalars) {
    X other = state;
    refill(other, scalars);
    return other;
}

/// The state that has these scalars.
template <Described X, class S>
constexpr X shaped(const Array<S, size_of<S, X>>& scalars) {
    X state{};
    refill(state, scalars);
    return state;
}

/// The first of two states in each lane in which the mask is true, else the second.
template <class S, Described X, class Mask>
constexpr X chosen(const Mask& mask, const X& first, const X& second) {
    auto scalars = flattened<S>(second);
    const auto others = flattened<S>(first);
    for (int i = 0; i < scalars.size(); ++i) scalars[i] = select(mask, others[i], scalars[i]);
    return refilled(second, scalars);
}

/// A state of the same shape whose scalars are zero.
template <class S, Described X>
constexpr X zeroed(const X& state) {
    X zero = state;
    X::fields(zero, detail::Clear<S>{});
    return zero;
}

/// The state of a law that has no history.
template <class Law>
constexpr typename Law::State initial_state(const Law& law) {
    if constexpr (requires { law.initial_state(); })
        return law.initial_state();
    else if constexpr (requires { law.law; })  // it varies another, whose state it has
        return initial_state(law.law);
    else
        return {};
}

/// A state without members.
template <class S>
struct Stateless {
    template <class Self, class Visit>
    static constexpr void fields(Self&, Visit&&) {}
};

namespace detail {
/// One of two types; firmware compilers need no standard library.
template <bool first, class First, class Second>
struct Either {
    using type = First;
};
template <class First, class Second>
struct Either<false, First, Second> {
    using type = Second;
};
}  // namespace detail

}  // namespace strainwave
