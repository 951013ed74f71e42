#pragma once
#include <strainwave/field.hpp>

namespace strainwave::sensor {

/// Room for the numbers of the state of a sensor that another holds: for any that may stand there, so that a state has the same
/// numbers whether the inner sensor is chosen at run time or not.
template <class S, int room>
using Numbers = Array<S, room>;

template <class S, int room, class State>
constexpr Numbers<S, room> numbers([[maybe_unused]] const State& x) {
    static_assert(size_of<S, State> <= room, "a sensor leaves too little room for the state of one it may hold");
    Numbers<S, room> all{};
    if constexpr (size_of<S, State> > 0) {
        const auto own = flattened<S>(x);
        for (int i = 0; i < own.size(); ++i) all[i] = own[i];
    }
    return all;
}
template <class Law, class S, int room>
constexpr typename Law::State state(const Law& law, const Numbers<S, room>& numbers) {
    return refilled(initial_state(law), numbers);
}

}  // namespace strainwave::sensor
