#pragma once
#include <strainwave/compensation/models.hpp>
#include <strainwave/control/models.hpp>
#include <strainwave/friction/models.hpp>
#include <strainwave/hysteresis/models.hpp>
#include <strainwave/kinematic_error/models.hpp>
#include <strainwave/kinematics.hpp>
#include <strainwave/list.hpp>
#include <strainwave/load/models.hpp>
#include <strainwave/material/models.hpp>
#include <strainwave/meter/models.hpp>
#include <strainwave/motor/models.hpp>
#include <strainwave/ring/models.hpp>
#include <strainwave/sensor/models.hpp>
#include <strainwave/softening/models.hpp>
#include <strainwave/stiffness/models.hpp>
#include <strainwave/structure/models.hpp>
#include <strainwave/thermal/models.hpp>
#include <strainwave/variation/models.hpp>

/// The closed lists of models, one of each family; that of the rigid motion, whose laws are in one header, is here.
namespace strainwave::kinematics {

using Models = List<StrainWave, PlainRatio>;

}  // namespace strainwave::kinematics
