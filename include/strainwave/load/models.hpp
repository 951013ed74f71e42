#pragma once
#include <strainwave/list.hpp>
#include <strainwave/load/aerodynamic.hpp>
#include <strainwave/load/brake.hpp>
#include <strainwave/load/inertia.hpp>
#include <strainwave/load/pendulum.hpp>
#include <strainwave/load/prescribed.hpp>
#include <strainwave/load/torque_table.hpp>
#include <strainwave/load/torsion_spring.hpp>

/// The closed list of loads: one more is its header, and here its include and its name. The first is the default.
namespace strainwave::load {

using Models = List<Inertia, Pendulum, TorsionSpring, Aerodynamic, TorqueTable, Brake, Prescribed>;

}  // namespace strainwave::load
