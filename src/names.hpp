#pragma once
#include <string>
#include <vector>

#include "parameter_drive.hpp"

namespace strainwave::host {

/// A number of the state or of the outputs of a drive.
struct Name {
    std::string part;  ///< path of the part that it belongs to, or "" if it is the drive's own
    std::string name;
    int element;  ///< -1 of a single number
    Field field;
};

/// The numbers of a drive, in the order in which the general drive and every kernel has them.
struct Layout {
    std::vector<Name> state, outputs;
    std::size_t continuous = 0;  ///< numbers of a state that change continuously; they come first
};

/// Layout of drives with the laws of one drive. Needs Python's lock.
const Layout& layout_of(const ParameterDrive& drive, const std::vector<int>& laws);

}  // namespace strainwave::host
