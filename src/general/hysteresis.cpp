#include "hysteresis.hpp"

#include "hysteresis_laws.hpp"

namespace strainwave::general {

SW_READ(Density)
SW_CALL(Density, S, everett, (const S& high, const S& low), law.everett(high, low))
SW_CALL(Density, S, rising, (const S& high, const S& low), law.rising(high, low))
SW_CALL(Density, S, falling, (const S& high, const S& low), law.falling(high, low))
SW_CALL(Density, S, virgin, (const S& reach), law.virgin(reach))
SW_CALL(Density, S, virgin_work, (const S& twist), law.virgin_work(twist))

SW_READ(Hysteresis)
SW_STATE(Hysteresis)
SW_PACK(Hysteresis, State, advance, (const State& x, const S& increment), law.advance(unpack_state<S>(law, x), increment))
SW_CALL(Hysteresis, S, torque, (const State& x, const S& increment), law.torque(unpack_state<S>(law, x), increment))
SW_CALL(Hysteresis, S, work, (const State& x, const S& increment), law.work(unpack_state<S>(law, x), increment))
template <class S>
S Hysteresis<S>::stored(const State& x) const {
    return HysteresisLaws<S>::visit(*this, [&](const auto& law) {
        if constexpr (requires { law.stored(unpack_state<S>(law, x)); })
            return law.stored(unpack_state<S>(law, x));
        else
            return S(0.0);
    });
}
SW_CALL(Hysteresis, bool, is_bounded, (), strainwave::bounded<S>(law))
SW_CALL(Hysteresis, Domain<S>, domain, (const S& twist), strainwave::domain<S>(law, twist))

SW_GENERAL(Density)
SW_GENERAL(Hysteresis)

}  // namespace strainwave::general
