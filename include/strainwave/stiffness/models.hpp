#pragma once
#include <strainwave/list.hpp>
#include <strainwave/stiffness/backlash.hpp>
#include <strainwave/stiffness/cubic.hpp>
#include <strainwave/stiffness/linear.hpp>
#include <strainwave/stiffness/multi_compliance.hpp>
#include <strainwave/stiffness/piecewise.hpp>
#include <strainwave/stiffness/three_segment.hpp>
#include <strainwave/stiffness/two_sided.hpp>

/// The closed list of stiffnesses: one more is its header, and here its include and its name. The first is the default.
namespace strainwave::stiffness {

using Plain = List<Linear, Piecewise, ThreeSegment, Cubic, MultiCompliance>;
using Sided = Extended<Plain, TwoSided>;
using Models = Extended<Sided, Backlash>;

}  // namespace strainwave::stiffness
