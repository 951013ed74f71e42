#pragma once
#include <strainwave/fault/cogging.hpp>
#include <strainwave/fault/encoder_eccentricity.hpp>
#include <strainwave/fault/encoder_offset.hpp>
#include <strainwave/fault/flexspline_crack.hpp>
#include <strainwave/fault/inverter_dead_time.hpp>
#include <strainwave/fault/linkage_play.hpp>
#include <strainwave/fault/lubrication_loss.hpp>
#include <strainwave/fault/magnet_loss.hpp>
#include <strainwave/fault/misalignment.hpp>
#include <strainwave/fault/open_phase.hpp>
#include <strainwave/fault/phase_resistance.hpp>
#include <strainwave/fault/preload_loss.hpp>
#include <strainwave/fault/sensor_bias.hpp>
#include <strainwave/fault/tooth_wear.hpp>
#include <strainwave/fault/wave_generator_bearing.hpp>
#include <strainwave/fault/winding_set_loss.hpp>
#include <strainwave/list.hpp>

/// The closed list of faults: one more is its header, and here its include and its name.
namespace strainwave::fault {

using Models =
    List<Misalignment, ToothWear, FlexsplineCrack, WaveGeneratorBearing, LubricationLoss, PreloadLoss, LinkagePlay, EncoderOffset,
         EncoderEccentricity, SensorBias, PhaseResistance, OpenPhase, WindingSetLoss, MagnetLoss, Cogging, InverterDeadTime>;

}  // namespace strainwave::fault
