#pragma once
#include <algorithm>

#include "arrays.hpp"
#include "instruction_set.hpp"
#include "state.hpp"

/// States of a drive as Python holds them: arrays of their numbers.
namespace strainwave::host {

/// The state of a drive from its numbers as Python holds them, and back.
inline Drive::State state_from(const Drive& drive, const Numbers& numbers) {
    std::size_t count = 0;
    const Drive::State state = state_of(drive, [&](int i) {
        ++count;
        return std::size_t(i) < numbers.size() ? numbers.data()[i] : 0.0;
    });
    if (count != numbers.size()) throw nb::value_error("a state has as many numbers as its drive names");
    return state;
}
inline Values array_of(const Drive& drive, const Drive::State& state) {
    const auto numbers = numbers_of(drive, state);
    Values out = array({numbers.size()});
    std::copy(numbers.begin(), numbers.end(), out.data());
    return out;
}

}  // namespace strainwave::host
