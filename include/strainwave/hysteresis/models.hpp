#pragma once
#include <strainwave/hysteresis/bouc_wen.hpp>
#include <strainwave/hysteresis/fading_memory.hpp>
#include <strainwave/hysteresis/frictional_windup.hpp>
#include <strainwave/hysteresis/maxwell_slip.hpp>
#include <strainwave/hysteresis/preisach.hpp>
#include <strainwave/hysteresis/regimes.hpp>
#include <strainwave/list.hpp>

/// The closed list of hystereses: one more is its header, and here its include and its name. The first is the default.
namespace strainwave::hysteresis {

using Models = List<MaxwellSlip, FadingMemory, BoucWen, Preisach, Regimes, FrictionalWindup>;
using Densities = List<PowerDensity, GridDensity>;

}  // namespace strainwave::hysteresis
