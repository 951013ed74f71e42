#pragma once
#include <strainwave/fault/flexspline_crack.hpp>
#include <strainwave/fault/lubrication_loss.hpp>
#include <strainwave/fault/misalignment.hpp>
#include <strainwave/list.hpp>

/// The closed list of faults: one more is its header, and here its include and its name.
namespace strainwave::fault {

using Models = List<Misalignment, FlexsplineCrack, LubricationLoss>;

}  // namespace strainwave::fault
