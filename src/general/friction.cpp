#include "friction.hpp"

#include <strainwave/friction/models.hpp>

#include "laws.hpp"

namespace strainwave::general {

template <class S>
using FrictionLaws = Laws<S, friction::Models, Friction<S>>;

SW_READ(Friction)
SW_STATE(Friction)
SW_CALL(Friction, S, torque, (const State& x, const Contact& at), friction::torque(law, unpack_state<S>(law, x), at))
template <class S>
auto Friction<S>::response(const State& x, const Contact& at) const -> friction::Response<S, State> {
    return FrictionLaws<S>::visit(*this, [&](const auto& law) {
        const auto found = friction::response(law, unpack_state<S>(law, x), at);
        return friction::Response<S, State>{found.torque, pack_slots<State>(found.rate)};
    });
}
SW_CALL(Friction, bool, set_valued, (), friction::set_valued(law))
SW_CALL(Friction, S, hold, (const Contact& at), friction::hold(law, at))
SW_PACK(Friction, State, rate, (const State& x, const Contact& at), friction::rate(law, unpack_state<S>(law, x), at))
SW_PACK(Friction, State, relaxation_rate, (const State& x, const Contact& at),
        friction::relaxation_rate(law, unpack_state<S>(law, x), at))
SW_PACK(Friction, State, clamped, (const State& x, const Contact& at), friction::clamped(law, unpack_state<S>(law, x), at))
SW_PACK(Friction, State, update_mode, (const State& x, const Contact& at), friction::update_mode(law, unpack_state<S>(law, x), at))
SW_PACK(Friction, State, advance, (const State& x, const Contact& at, const S& dt),
        friction::advance(law, unpack_state<S>(law, x), at, dt))
SW_PACK(Friction, State, steady_state, (const Contact& at), friction::steady_state(law, at))
SW_CALL(Friction, bool, is_bounded, (), strainwave::bounded<Contact>(law))
SW_CALL(Friction, Domain<S>, domain, (const Contact& at), strainwave::domain<S>(law, at))

SW_GENERAL(Friction)

}  // namespace strainwave::general
