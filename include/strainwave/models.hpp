#pragma once
#include <strainwave/control/cascade.hpp>
#include <strainwave/control/lead_lag.hpp>
#include <strainwave/control/open_loop.hpp>
#include <strainwave/control/pi.hpp>
#include <strainwave/control/pid.hpp>
#include <strainwave/control/position_speed.hpp>
#include <strainwave/control/sampled.hpp>
#include <strainwave/control/state_feedback.hpp>
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
#include <strainwave/hysteresis/bouc_wen.hpp>
#include <strainwave/hysteresis/fading_memory.hpp>
#include <strainwave/hysteresis/frictional_windup.hpp>
#include <strainwave/hysteresis/maxwell_slip.hpp>
#include <strainwave/hysteresis/preisach.hpp>
#include <strainwave/hysteresis/regimes.hpp>
#include <strainwave/kinematic_error/fourier.hpp>
#include <strainwave/kinematic_error/misalignment.hpp>
#include <strainwave/kinematic_error/scaled.hpp>
#include <strainwave/kinematic_error/stochastic.hpp>
#include <strainwave/kinematic_error/tooth_errors.hpp>
#include <strainwave/kinematics.hpp>
#include <strainwave/load/aerodynamic.hpp>
#include <strainwave/load/brake.hpp>
#include <strainwave/load/inertia.hpp>
#include <strainwave/load/pendulum.hpp>
#include <strainwave/load/prescribed.hpp>
#include <strainwave/load/torque_table.hpp>
#include <strainwave/load/torsion_spring.hpp>
#include <strainwave/meter/energy_meter.hpp>
#include <strainwave/meter/no_meter.hpp>
#include <strainwave/motor/acceleration_source.hpp>
#include <strainwave/motor/brushless_dc.hpp>
#include <strainwave/motor/current_source.hpp>
#include <strainwave/motor/dc.hpp>
#include <strainwave/motor/pmsm.hpp>
#include <strainwave/motor/torque_source.hpp>
#include <strainwave/sensor/delayed.hpp>
#include <strainwave/sensor/encoder.hpp>
#include <strainwave/sensor/first_order.hpp>
#include <strainwave/sensor/gain.hpp>
#include <strainwave/sensor/ideal.hpp>
#include <strainwave/sensor/noisy.hpp>
#include <strainwave/sensor/quantised.hpp>
#include <strainwave/sensor/second_order.hpp>
#include <strainwave/softening/thermal_softening.hpp>
#include <strainwave/stiffness/backlash.hpp>
#include <strainwave/stiffness/cubic.hpp>
#include <strainwave/stiffness/linear.hpp>
#include <strainwave/stiffness/multi_compliance.hpp>
#include <strainwave/stiffness/piecewise.hpp>
#include <strainwave/stiffness/three_segment.hpp>
#include <strainwave/structure/lumped.hpp>
#include <strainwave/structure/staged.hpp>
#include <strainwave/thermal/heating.hpp>
#include <strainwave/thermal/isothermal.hpp>
#include <strainwave/variation/constant.hpp>
#include <strainwave/variation/periodic.hpp>

/// The closed lists of models. A new model is one header, and here its include and its name. The first of a family is its default.
namespace strainwave {

template <template <class...> class... Law>
struct List {};

namespace detail {
template <class L, template <class...> class... More>
struct Extension;
template <template <class...> class... Law, template <class...> class... More>
struct Extension<List<Law...>, More...> {
    using type = List<Law..., More...>;
};
}  // namespace detail
/// A list, and what may stand around its laws.
template <class L, template <class...> class... More>
using Extended = typename detail::Extension<L, More...>::type;

namespace kinematics {
using Models = List<StrainWave, PlainRatio>;
}
namespace kinematic_error {
using Pure = List<Fourier, Misalignment, ToothErrors>;
using Models = Extended<Pure, Scaled>;
using Noises = List<Stochastic>;
}  // namespace kinematic_error
namespace friction {
using Levelled = List<Viscous, Coulomb, Stribeck, PositionDependent, LuGre, MaxwellSlipFriction, LoadDependent, MixedLubrication,
                      CurvedViscous, AngleSpeedMap>;  // each way it slides at levels of its own
using Plain = Extended<Levelled, TorqueEfficiency>;
using Directed = Extended<Plain, Asymmetric>;
using Varying = Extended<Directed, Cyclic>;
using Models = Extended<Varying, Thermal>;
}  // namespace friction
namespace stiffness {
using Plain = List<Linear, Piecewise, ThreeSegment, Cubic, MultiCompliance>;
using Models = Extended<Plain, Backlash>;
}  // namespace stiffness
namespace hysteresis {
using Models = List<MaxwellSlip, FadingMemory, BoucWen, Preisach, Regimes, FrictionalWindup>;
using Densities = List<PowerDensity, GridDensity>;
}  // namespace hysteresis
namespace motor {
using Models = List<DC, BrushlessDC, PMSM, TorqueSource, CurrentSource, AccelerationSource>;
}
namespace control {
using Continuous = List<OpenLoop, PID, PI, PositionSpeed, Cascade, LeadLag, StateFeedback>;
using Models = Extended<Continuous, Sampled>;
}  // namespace control
namespace load {
using Models = List<Inertia, Pendulum, TorsionSpring, Aerodynamic, TorqueTable, Brake, Prescribed>;
}
namespace sensor {
using Plain = List<Ideal, Gain, FirstOrder, SecondOrder, Encoder>;
using Late = Extended<Plain, Delayed>;
using Loud = Extended<Late, Noisy>;
using Models = Extended<Loud, Quantised>;
}  // namespace sensor
namespace variation {
using Models = List<Constant, Periodic>;
}
namespace structure {
using Models = List<Lumped, Staged>;
}
namespace softening {
using Models = List<ThermalSoftening>;
}
namespace thermal {
using Models = List<Isothermal, Heating>;
}
namespace meter {
using Models = List<NoMeter, EnergyMeter>;
}

}  // namespace strainwave
