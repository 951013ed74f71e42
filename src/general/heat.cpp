#include "heat.hpp"

#include <strainwave/fastest.hpp>
#include <strainwave/meter/models.hpp>
#include <strainwave/thermal/models.hpp>

#include "laws.hpp"

namespace strainwave::general {

template <class S>
using ThermalLaws = Laws<S, thermal::Models>;
template <class S>
using MeterLaws = Laws<S, meter::Models>;

SW_READ(Thermal)
SW_STATE(Thermal)
SW_OUTPUT_PLACES(Thermal)
SW_CALL(Thermal, bool, active, (), law.active())
SW_CALL(Thermal, thermal::Temperatures<S>, at, (const State& x, const S& ambient), law.at(unpack_state<S>(law, x), ambient))
SW_PACK(Thermal, State, rate, (const State& x, const thermal::Heat<S>& heat, const S& ambient),
        law.rate(unpack_state<S>(law, x), heat, ambient))
SW_CALL(Thermal, S, gear_rate, (const State& rate, const S& ambient_rate), law.gear_rate(unpack_state<S>(law, rate), ambient_rate))
SW_CALL(Thermal, S, fastest, (), strainwave::fastest<S>(law))
SW_PACK(Thermal, Output, output, (const State& x, const S& ambient), law.output(unpack_state<S>(law, x), ambient))

SW_READ(Meter)
SW_STATE(Meter)
SW_OUTPUT_PLACES(Meter)
SW_CALL(Meter, bool, active, (), law.active())
SW_PACK(Meter, State, rate, (const meter::Powers<S>& powers), law.rate(powers))
SW_PACK(Meter, Output, output, (const State& x, const meter::Powers<S>& powers, const meter::Stored<S>& stored),
        law.output(unpack_state<S>(law, x), powers, stored))

SW_GENERAL(Thermal)
SW_GENERAL(Meter)

}  // namespace strainwave::general
