#pragma once
#include <strainwave/field.hpp>
#include <strainwave/scalar/dual.hpp>

#include <memory>
#include <vector>

#include "../kernel/assemble.hpp"
#include "../kernel/places.hpp"
#include "../kernel/table.hpp"

/// The parts of the general drive: each is a law chosen at run time, and is a law itself. What its verbs do is compiled once, next
/// to the laws of its family; a drive only calls them. So a law costs the build what its own code costs.
namespace strainwave::general {

using kernel::Places;

/// The laws that a drive has chosen, for as long as it lives.
using OwnedLaws = std::vector<std::shared_ptr<const void>>;

using kernel::slopes;
using Slope = Dual<slopes>;

/// A law chosen at run time: its index in the list of its family, and its parameters.
struct Part {
    const void* law = nullptr;
    int chosen = 0;
};

/// Numbers of whichever law was chosen, at most n. Up to `few` are all carried along; of more, those that the law has.
template <class S, int n, int few = 4>
struct Storage {
    static_assert(n <= Places::capacity);
    static constexpr int capacity = n;
    typename detail::Either<(n <= few), Array<S, (n > 0 ? n : 1)>, Counted<S, n>>::type slot{};

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, slot, "1", "State of the law chosen, in the order it lists it"));
    }
};

namespace detail {

template <class S, class Law>
constexpr auto state_of() {
    if constexpr (requires { typename Law::State; })
        return typename Law::State{};
    else
        return Stateless<S>{};
}

}  // namespace detail

/// The described struct in which a law keeps its state.
template <class S, class Law>
using StateOf = decltype(detail::state_of<S, Law>());

template <class T>
inline constexpr bool is_storage = false;
template <class S, int n, int few>
inline constexpr bool is_storage<Storage<S, n, few>> = true;

/// Calls f(part) with the part of a law whose name is that of a part of its state. One arranged for speed has a law alone.
template <class Law, class F>
void with_part(const Law& law, const char* name, const F& f) {
    if constexpr (Described<Law>)
        Law::fields(law, [&](const auto& part, const Field& field) {
            if (same(field.name, name)) f(part);
        });
    else if constexpr (requires { law.law; })
        if (same(name, "law")) f(law.law);
}

/// Recorded numbers of whichever law was chosen: their places do not depend on it.
template <class S, int n>
using OutputStorage = Storage<S, n, n>;

}  // namespace strainwave::general
