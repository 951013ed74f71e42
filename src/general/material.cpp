#include "material.hpp"

#include <strainwave/material/models.hpp>

#include "laws.hpp"

namespace strainwave::general {

template <class S>
using MaterialLaws = Laws<S, material::Models>;

SW_READ(Material)
SW_STATE(Material)
SW_CALL(Material, bool, active, (), law.active())
SW_CALL(Material, S, largest_stiffness, (), law.largest_stiffness())
SW_CALL(Material, S, torque, (const State& x), law.torque(unpack_state<S>(law, x)))
SW_PACK(Material, State, rate, (const State& x, const S& twist_rate), law.rate(unpack_state<S>(law, x), twist_rate))
SW_PACK(Material, State, relaxation_rate, (), law.relaxation_rate())
SW_CALL(Material, S, lost, (const State& x), law.lost(unpack_state<S>(law, x)))
SW_CALL(Material, S, stored, (const State& x), law.stored(unpack_state<S>(law, x)))
SW_PACK(Material, State, advance, (const State& x, const S& increment, const S& dt),
        law.advance(unpack_state<S>(law, x), increment, dt))
SW_CALL(Material, S, work, (const State& x, const S& increment, const S& dt), law.work(unpack_state<S>(law, x), increment, dt))
SW_CALL(Material, S, storage, (const S& frequency), law.storage(frequency))
SW_CALL(Material, S, loss, (const S& frequency), law.loss(frequency))

SW_GENERAL(Material)

}  // namespace strainwave::general
