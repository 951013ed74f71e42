#pragma once
#include <strainwave/fault/cogging.hpp>
#include <strainwave/fault/flexspline_crack.hpp>
#include <strainwave/fault/inverter_dead_time.hpp>
#include <strainwave/fault/lubrication_loss.hpp>
#include <strainwave/fault/magnet_loss.hpp>
#include <strainwave/fault/misalignment.hpp>
#include <strainwave/fault/open_phase.hpp>
#include <strainwave/fault/phase_resistance.hpp>
#include <strainwave/list.hpp>

/// The closed list of faults: one more is its header, and here its include and its name.
namespace strainwave::fault {

using Models =
    List<Misalignment, FlexsplineCrack, LubricationLoss, PhaseResistance, OpenPhase, MagnetLoss, Cogging, InverterDeadTime>;

}  // namespace strainwave::fault
