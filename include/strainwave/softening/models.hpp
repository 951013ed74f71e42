#pragma once
#include <strainwave/list.hpp>
#include <strainwave/softening/thermal_softening.hpp>

/// The closed list of softenings: one more is its header, and here its include and its name. The first is the default.
namespace strainwave::softening {

using Models = List<ThermalSoftening>;

}  // namespace strainwave::softening
