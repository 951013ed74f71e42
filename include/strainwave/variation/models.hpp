#pragma once
#include <strainwave/list.hpp>
#include <strainwave/variation/ball_bearing.hpp>
#include <strainwave/variation/constant.hpp>
#include <strainwave/variation/periodic.hpp>

/// The closed list of variations of a stiffness: one more is its header, and here its include and its name. The first is the
/// default.
namespace strainwave::variation {

using Models = List<Constant, Periodic, BallBearing>;

}  // namespace strainwave::variation
