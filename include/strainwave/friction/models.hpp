#pragma once
#include <strainwave/friction/angle_speed_map.hpp>
#include <strainwave/friction/asymmetric.hpp>
#include <strainwave/friction/coulomb.hpp>
#include <strainwave/friction/curved_viscous.hpp>
#include <strainwave/friction/cyclic.hpp>
#include <strainwave/friction/load_dependent.hpp>
#include <strainwave/friction/lugre.hpp>
#include <strainwave/friction/maxwell_slip_friction.hpp>
#include <strainwave/friction/mixed_lubrication.hpp>
#include <strainwave/friction/position_dependent.hpp>
#include <strainwave/friction/stribeck.hpp>
#include <strainwave/friction/thermal.hpp>
#include <strainwave/friction/torque_efficiency.hpp>
#include <strainwave/friction/viscous.hpp>
#include <strainwave/list.hpp>

/// The closed list of friction laws: one more is its header, and here its include and its name. The first is the default.
namespace strainwave::friction {

using Levelled = List<Viscous, Coulomb, Stribeck, PositionDependent, LuGre, MaxwellSlipFriction, LoadDependent, MixedLubrication,
                      CurvedViscous, AngleSpeedMap>;  // each way it slides at levels of its own
using Plain = Extended<Levelled, TorqueEfficiency>;
using Directed = Extended<Plain, Asymmetric>;
using Varying = Extended<Directed, Cyclic>;
using Models = Extended<Varying, Thermal>;

}  // namespace strainwave::friction
