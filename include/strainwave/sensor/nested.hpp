#pragma once
#include <strainwave/field.hpp>

namespace strainwave::sensor {

/// The numbers of the state of a sensor that another holds.
template <class S, class Law>
using Numbers = Array<S, (size_of<S, typename Law::State> > 0 ? size_of<S, typename Law::State> : 1)>;

template <class S, class Law>
constexpr Numbers<S, Law> numbers([[maybe_unused]] const typename Law::State& x) {
    Numbers<S, Law> all{};
    if constexpr (size_of<S, typename Law::State> > 0) {
        const auto own = flattened<S>(x);
        for (int i = 0; i < own.size(); ++i) all[i] = own[i];
    }
    return all;
}
template <class S, class Law>
constexpr typename Law::State state(const Law& law, const Numbers<S, Law>& numbers) {
    return refilled(initial_state(law), numbers);
}

}  // namespace strainwave::sensor
