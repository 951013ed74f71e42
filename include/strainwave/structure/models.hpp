#pragma once
#include <strainwave/list.hpp>
#include <strainwave/structure/lumped.hpp>
#include <strainwave/structure/staged.hpp>

/// The closed list of structures of a gear: one more is its header, and here its include and its name. The first is the default.
namespace strainwave::structure {

using Models = List<Lumped, Staged>;

}  // namespace strainwave::structure
