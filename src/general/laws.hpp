#pragma once
#include <strainwave/compiled.hpp>
#include <strainwave/control/law.hpp>
#include <strainwave/list.hpp>

#include <cstring>
#include <tuple>

#include "../kernel/assemble.hpp"
#include "part.hpp"

/// The laws of a list in the form of the general drive, for the sources of all families.
namespace strainwave::general {

namespace detail {

/// A law that holds another holds one chosen at run time.
template <class Law, class Inner>
struct Around {
    using type = Law;
};
template <template <class, class> class Outer, class S, class Law, class Inner>
struct Around<Outer<S, Law>, Inner> {
    using type = Outer<S, Inner>;
};

}  // namespace detail

/// The laws of a list; those that hold another hold an `Inner`.
template <class S, class L, class Inner = void>
struct Laws;
template <class S, template <class...> class... Law, class Inner>
struct Laws<S, List<Law...>, Inner> {
    template <class Chosen>
    using WithInner = typename detail::Around<Chosen, Inner>::type;
    using All = std::tuple<WithInner<Law<S>>...>;
    static constexpr int count = sizeof...(Law);

    template <int i>
    using Compiled = decltype(compiled(std::tuple_element_t<i, All>{}));

    /// f of the law chosen.
    template <int i = 0, class F>
    static decltype(auto) visit(const Part& part, F&& f) {
        if constexpr (i + 1 == count) {
            return f(*static_cast<const Compiled<i>*>(part.law));
        } else {
            if (part.chosen == i) return f(*static_cast<const Compiled<i>*>(part.law));
            return visit<i + 1>(part, f);
        }
    }

    /// Reads which law it is and its parameters, and keeps it.
    static void read(Part& part, kernel::Reader<S>& from) {
        read(part, from, [](const auto&) {});
    }
    /// Also calls note(law) with the law as it was written.
    template <class Note>
    static void read(Part& part, kernel::Reader<S>& from, const Note& note) {
        part.chosen = *from.laws++;
        read_chosen(part, from, note);
    }
    /// The parameters of the law chosen.
    static void read_chosen(Part& part, kernel::Reader<S>& from) {
        read_chosen(part, from, [](const auto&) {});
    }

private:
    template <int i = 0, class Note>
    static void read_chosen(Part& part, kernel::Reader<S>& from, const Note& note) {
        if constexpr (i < count) {
            if (part.chosen != i) return read_chosen<i + 1>(part, from, note);
            const auto law = kernel::assembled<std::tuple_element_t<i, All>>(from);
            note(law);
            auto made = std::make_shared<const Compiled<i>>(compiled(law));
            part.law = made.get();
            static_cast<OwnedLaws*>(from.owned_laws)->push_back(std::move(made));
        }
    }
};

// A state of a fixed size is nothing but scalars, so it fits the slots as it lies in memory; one with parts of other laws is copied
// number by number. Slots that hold none stand for no history.

namespace detail {
template <class S, class X>
inline constexpr bool is_of_fixed_size = strainwave::detail::counter_of<S, X>.fixed;
}

/// The state of a law, out of the slots of its part; `initial()` is that without history.
template <class X, class S, int n, int few, class Initial>
X unpack_slots(const Storage<S, n, few>& slots, const Initial& initial) {
    if constexpr (std::is_same_v<X, Storage<S, n, few>>) {  // a law that varies another has its state
        return slots;
    } else if constexpr (detail::is_of_fixed_size<S, X>) {
        X x{};
        if constexpr (size_of<S, X> > 0) {
            static_assert(sizeof x == size_of<S, X> * sizeof(S) && size_of<S, X> <= n);
            if (slots.slot.size() >= size_of<S, X>) std::memcpy(static_cast<void*>(&x), slots.slot.item, sizeof x);
        }
        return x;
    } else {
        X x = initial();
        if (slots.slot.size() > 0) refill(x, slots.slot);
        return x;
    }
}
template <class S, class Law, class Slots>
auto unpack_state(const Law& law, const Slots& slots) {
    return unpack_slots<StateOf<S, Law>, S>(slots, [&] { return strainwave::initial_state(law); });
}
template <class S, class Law, class Slots>
auto unpack_discrete(const Law& law, const Slots& slots) {
    return unpack_slots<control::DiscreteOf<S, Law>, S>(slots, [&] { return control::initial_discrete<S>(law); });
}

/// A state or an output of a law in the slots of its part.
template <class Slots, class X>
Slots pack_slots(const X& x) {
    if constexpr (std::is_same_v<Slots, X>) {
        return x;
    } else {
        Slots slots{};
        using S = std::remove_cvref_t<decltype(slots.slot[0])>;
        constexpr int count = size_of<S, X>;
        static_assert(count <= Slots::capacity, "the storage of this family has too few slots for a law");
        if constexpr (count > 0 && detail::is_of_fixed_size<S, X>) {
            if constexpr (requires { slots.slot.count; }) slots.slot.count = count;
            std::memcpy(static_cast<void*>(slots.slot.item), &x, sizeof x);
        } else if constexpr (count > 0) {
            const auto numbers = flattened<S>(x);
            slots.slot.count = numbers.size();
            for (int i = 0; i < numbers.size(); ++i) slots.slot[i] = numbers[i];
        }
        return slots;
    }
}

/// Slots of the numbers of a state or an output, in order; returns the slot after them. Of laws within a law those that they have.
template <class S, class X, class Law>
int add_places(const Law& law, const X& x, Places& found, int first = 0) {
    X::fields(x, [&]<class T>(const T& member, const Field& field) {
        if constexpr (is_storage<T>) {
            Places within;
            with_part(law, field.name, [&](const auto& part) {
                if constexpr (requires { part.places(within); }) part.places(within);
            });
            for (int i = 0; i < within.count; ++i) found.add(first + within.slot[i]);
            first += member.slot.size();
        } else if constexpr (Described<T>) {
            int end = -1;
            with_part(law, field.name, [&](const auto& part) { end = add_places<S>(part, member, found, first); });
            first = end < 0 ? add_places<S>(law, member, found, first) : end;
        } else if constexpr (requires { member.item; }) {
            for (int i = 0; i < member.size(); ++i) found.add(first++);
        } else {
            found.add(first++);
        }
    });
    return first;
}
template <class S, class Law>
void add_state_places(const Law& law, Places& found) {
    if constexpr (is_storage<StateOf<S, Law>>)
        law.law.places(found);
    else
        add_places<S>(law, StateOf<S, Law>(strainwave::initial_state(law)), found);
}

// Functions of a part, each of which is that of the law that it holds. The laws of `Part` are `PartLaws<S>`.

/// Defines a function that returns an expression of `law`.
#define SW_CALL(Part, Result, function, arguments, ...)                                   \
    template <class S>                                                                    \
    auto Part<S>::function arguments const->Result {                                      \
        return Part##Laws<S>::visit(*this, [&](const auto& law) { return __VA_ARGS__; }); \
    }
/// The same of a function that returns a state or an output.
#define SW_PACK(Part, Result, function, arguments, ...) SW_CALL(Part, Result, function, arguments, pack_slots<Result>(__VA_ARGS__))
#define SW_READ(Part)                             \
    template <class S>                            \
    void Part<S>::read(kernel::Reader<S>& from) { \
        Part##Laws<S>::read(*this, from);         \
    }
#define SW_STATE(Part)                                                                          \
    template <class S>                                                                          \
    void Part<S>::places(Places& found) const {                                                 \
        Part##Laws<S>::visit(*this, [&](const auto& law) { add_state_places<S>(law, found); }); \
    }                                                                                           \
    SW_PACK(Part, State, initial_state, (), strainwave::initial_state(law))
#define SW_OUTPUT_PLACES(Part)                                                                                              \
    template <class S>                                                                                                      \
    void Part<S>::output_places(Places& found) const {                                                                      \
        Part##Laws<S>::visit(*this, [&]<class Law>(const Law& law) { add_places<S>(law, typename Law::Output{}, found); }); \
    }

#define SW_GENERAL(Name)          \
    template struct Name<double>; \
    template struct Name<Slope>;

}  // namespace strainwave::general
