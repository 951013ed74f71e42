#pragma once
#include <strainwave/drive.hpp>

#include "control.hpp"
#include "friction.hpp"
#include "heat.hpp"
#include "hysteresis.hpp"
#include "kinematic_error.hpp"
#include "kinematics.hpp"
#include "load.hpp"
#include "material.hpp"
#include "motor.hpp"
#include "sensor.hpp"
#include "spring_factors.hpp"
#include "stiffness.hpp"
#include "structure.hpp"

/// The drive that serves every choice of laws.
namespace strainwave::general {

template <class S>
using GeneralGear = Gear<S, Kinematics<S>, KinematicError<S>, KinematicNoise<S>, Stiffness<S>, Hysteresis<S>, Friction<S>,
                         Friction<S>, Friction<S>, Softening<S>, Structure<S>, Variation<S>, Material<S>>;

template <class S>
using GeneralDrive = Drive<S, Control<S>, Motor<S>, GeneralGear<S>, Load<S>, Sensors<S, Sensor<S>>, Thermal<S>, Meter<S>>;

}  // namespace strainwave::general
