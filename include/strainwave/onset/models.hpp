#pragma once
#include <strainwave/list.hpp>
#include <strainwave/onset/constant.hpp>
#include <strainwave/onset/growing.hpp>
#include <strainwave/onset/step.hpp>

/// The closed list of onsets of faults: one more is its header, and here its include and its name. The first is the default.
namespace strainwave::onset {

using Models = List<Constant, Step, Growing>;

}  // namespace strainwave::onset
