#pragma once
#include <strainwave/list.hpp>
#include <strainwave/thermal/heating.hpp>
#include <strainwave/thermal/isothermal.hpp>

/// The closed list of thermal models: one more is its header, and here its include and its name. The first is the default.
namespace strainwave::thermal {

using Models = List<Isothermal, Heating>;

}  // namespace strainwave::thermal
