#pragma once
#include <strainwave/list.hpp>
#include <strainwave/meter/energy_meter.hpp>
#include <strainwave/meter/no_meter.hpp>

/// The closed list of meters: one more is its header, and here its include and its name. The first is the default.
namespace strainwave::meter {

using Models = List<NoMeter, EnergyMeter>;

}  // namespace strainwave::meter
