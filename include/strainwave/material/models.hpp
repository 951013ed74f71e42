#pragma once
#include <strainwave/list.hpp>
#include <strainwave/material/elastic.hpp>
#include <strainwave/material/generalised_maxwell.hpp>

/// The closed list of materials: one more is its header, and here its include and its name. The first is the default.
namespace strainwave::material {

using Models = List<Elastic, GeneralisedMaxwell>;

}  // namespace strainwave::material
