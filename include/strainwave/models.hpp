#pragma once
#include <strainwave/control/open_loop.hpp>
#include <strainwave/control/pid.hpp>
#include <strainwave/friction/coulomb.hpp>
#include <strainwave/friction/lugre.hpp>
#include <strainwave/friction/stribeck.hpp>
#include <strainwave/friction/viscous.hpp>
#include <strainwave/hysteresis/fading_memory.hpp>
#include <strainwave/hysteresis/maxwell_slip.hpp>
#include <strainwave/kinematic_error/fourier.hpp>
#include <strainwave/kinematics.hpp>
#include <strainwave/load/inertia.hpp>
#include <strainwave/load/pendulum.hpp>
#include <strainwave/motor/dc.hpp>
#include <strainwave/stiffness/cubic.hpp>
#include <strainwave/stiffness/linear.hpp>
#include <strainwave/stiffness/three_segment.hpp>

/// The closed lists of models. A new model is one header, and one line here. The first of a family is its default.
namespace strainwave {

template <template <class> class... Law>
struct List {};

namespace kinematics {
using Models = List<StrainWave, PlainRatio>;
}
namespace kinematic_error {
using Models = List<Fourier>;
}
namespace friction {
using Models = List<Viscous, Coulomb, Stribeck, LuGre>;
}
namespace stiffness {
using Models = List<Linear, Cubic, ThreeSegment>;
}
namespace hysteresis {
using Models = List<MaxwellSlip, FadingMemory>;
}
namespace motor {
using Models = List<DC>;
}
namespace control {
using Models = List<OpenLoop, PID>;
}
namespace load {
using Models = List<Inertia, Pendulum>;
}

}  // namespace strainwave
