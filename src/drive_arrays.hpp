#pragma once
#include <algorithm>

#include "arrays.hpp"
#include "ensemble.hpp"
#include "general/verbs.hpp"
#include "members.hpp"
#include "names.hpp"

/// Drives and their states, from Python's objects to those of the runs.
namespace strainwave::host {

inline Parts parts_of(const ParameterDrive& drive) { return parts_of(description_of<ParameterDrive>(), &drive); }
inline Parts parts_of(const ParameterGear& gear) { return parts_of(description_of<ParameterGear>(), &gear); }
inline const Layout& layout_of(const ParameterDrive& drive) { return layout_of(drive, parts_of(drive).laws); }

inline void check_numbers(const Parts& parts, const std::vector<int>& numbers) {
    for (const int number : numbers)
        if (number < 0 || number >= int(parts.numbers.size())) throw nb::value_error("the drive has no parameter of this index");
}

/// The numbers of a state, refused unless there are as many as the drive has.
inline general::State state_from(const Layout& layout, const Numbers& numbers) {
    if (numbers.size() != layout.state.size()) throw nb::value_error("the count of numbers must be that of the state of the drive");
    return {numbers.data(), numbers.data() + numbers.size()};
}
inline general::State state_from(const ParameterDrive& drive, const Numbers& numbers) {
    return state_from(layout_of(drive), numbers);
}

/// Initial conditions of members: known quantities, one row of values each.
inline Start start_of(const std::vector<int>& quantities, const Numbers& values, std::size_t members) {
    if (values.size() != quantities.size() * members)
        throw nb::value_error("values of n quantities and m members have shape (n, m)");
    for (const int quantity : quantities)
        if (quantity < 0 || quantity >= initial::quantities) throw nb::value_error("there is no quantity of this index");
    return {false, quantities, values.data(), members};
}

inline Values array_of(const std::vector<double>& numbers) {
    Values out = array({numbers.size()});
    std::copy(numbers.begin(), numbers.end(), out.data());
    return out;
}

}  // namespace strainwave::host
