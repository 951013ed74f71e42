#pragma once
#include <strainwave/list.hpp>
#include <strainwave/ring/modes.hpp>
#include <strainwave/ring/rigid.hpp>

/// The closed list of vibrations of the flexspline's ring: one more is its header, and here its include and its name. The first is
/// the default.
namespace strainwave::ring {

using Models = List<Rigid, Modes>;

}  // namespace strainwave::ring
