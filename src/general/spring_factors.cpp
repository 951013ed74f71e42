#include "spring_factors.hpp"

#include <strainwave/softening/models.hpp>
#include <strainwave/variation/models.hpp>

#include "laws.hpp"

namespace strainwave::general {

template <class S>
using VariationLaws = Laws<S, variation::Models>;
template <class S>
using SofteningLaws = Laws<S, softening::Models>;

SW_READ(Variation)
SW_CALL(Variation, bool, active, (), law.active())
SW_CALL(Variation, S, largest, (), law.largest())
SW_CALL(Variation, variation::Factor<S>, at, (const Angle<S>& angle), law.at(angle))

SW_READ(Softening)
SW_CALL(Softening, bool, active, (), law.active())
SW_CALL(Softening, S, of_stiffness, (const S& temperature), law.of_stiffness(temperature))
SW_CALL(Softening, S, of_hysteresis, (const S& temperature), law.of_hysteresis(temperature))
SW_CALL(Softening, S, dissipation_rate, (const S& warming), law.dissipation_rate(warming))

SW_GENERAL(Variation)
SW_GENERAL(Softening)

}  // namespace strainwave::general
