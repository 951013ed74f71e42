#pragma once
#include <strainwave/kinematic_error/fourier.hpp>
#include <strainwave/kinematic_error/micro_slip.hpp>
#include <strainwave/kinematic_error/misalignment.hpp>
#include <strainwave/kinematic_error/scaled.hpp>
#include <strainwave/kinematic_error/stochastic.hpp>
#include <strainwave/kinematic_error/temperature_dependent.hpp>
#include <strainwave/kinematic_error/tooth_errors.hpp>
#include <strainwave/list.hpp>

/// The closed list of kinematic errors: one more is its header, and here its include and its name. The first is the default.
namespace strainwave::kinematic_error {

using Pure = List<Fourier, Misalignment, ToothErrors>;
using Unloaded = Extended<Pure, TemperatureDependent>;
using Models = Extended<Unloaded, Scaled>;
using Noises = List<Stochastic, MicroSlip>;

}  // namespace strainwave::kinematic_error
