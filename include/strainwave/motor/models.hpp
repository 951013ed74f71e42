#pragma once
#include <strainwave/list.hpp>
#include <strainwave/motor/acceleration_source.hpp>
#include <strainwave/motor/brushless_dc.hpp>
#include <strainwave/motor/current_source.hpp>
#include <strainwave/motor/dc.hpp>
#include <strainwave/motor/pmsm.hpp>
#include <strainwave/motor/torque_source.hpp>

/// The closed list of motors: one more is its header, and here its include and its name. The first is the default.
namespace strainwave::motor {

using Models = List<DC, BrushlessDC, PMSM, TorqueSource, CurrentSource, AccelerationSource>;

}  // namespace strainwave::motor
