#include "stiffness.hpp"

#include <strainwave/stiffness/models.hpp>

#include "laws.hpp"

namespace strainwave::general {

template <class S>
using StiffnessLaws = Laws<S, stiffness::Models, Stiffness<S>>;

SW_READ(Stiffness)
SW_CALL(Stiffness, S, torque, (const S& twist), law.torque(twist))
SW_CALL(Stiffness, S, twist, (const S& torque), law.twist(torque))
SW_CALL(Stiffness, S, tangent, (const S& twist), law.tangent(twist))
SW_CALL(Stiffness, S, energy, (const S& twist), law.energy(twist))
SW_CALL(Stiffness, bool, is_bounded, (), strainwave::bounded<S>(law))
SW_CALL(Stiffness, Domain<S>, domain, (const S& twist), strainwave::domain<S>(law, twist))

SW_GENERAL(Stiffness)

}  // namespace strainwave::general
