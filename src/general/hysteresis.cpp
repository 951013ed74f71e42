#include "hysteresis.hpp"

#include "hysteresis_laws.hpp"

namespace strainwave::general {

template <class S>
void Density<S>::read(kernel::Reader<S>& from) {
    DensityLaws<S>::read(*this, from);
}
template <class S>
S Density<S>::everett(const S& high, const S& low) const {
    return DensityLaws<S>::visit(*this, [&](const auto& law) { return law.everett(high, low); });
}
template <class S>
S Density<S>::rising(const S& high, const S& low) const {
    return DensityLaws<S>::visit(*this, [&](const auto& law) { return law.rising(high, low); });
}
template <class S>
S Density<S>::falling(const S& high, const S& low) const {
    return DensityLaws<S>::visit(*this, [&](const auto& law) { return law.falling(high, low); });
}
template <class S>
S Density<S>::virgin(const S& reach) const {
    return DensityLaws<S>::visit(*this, [&](const auto& law) { return law.virgin(reach); });
}
template <class S>
S Density<S>::virgin_work(const S& twist) const {
    return DensityLaws<S>::visit(*this, [&](const auto& law) { return law.virgin_work(twist); });
}

template <class S>
void Hysteresis<S>::read(kernel::Reader<S>& from) {
    HysteresisLaws<S>::read(*this, from);
}
template <class S>
void Hysteresis<S>::places(Places& found) const {
    HysteresisLaws<S>::visit(*this, [&](const auto& law) { add_state_places<S>(law, found); });
}
template <class S>
auto Hysteresis<S>::initial_state() const -> State {
    return HysteresisLaws<S>::visit(*this, [](const auto& law) { return pack_slots<State>(strainwave::initial_state(law)); });
}
template <class S>
auto Hysteresis<S>::advance(const State& x, const S& increment) const -> State {
    return HysteresisLaws<S>::visit(
        *this, [&](const auto& law) { return pack_slots<State>(law.advance(unpack_state<S>(law, x), increment)); });
}
template <class S>
S Hysteresis<S>::torque(const State& x, const S& increment) const {
    return HysteresisLaws<S>::visit(*this, [&](const auto& law) { return law.torque(unpack_state<S>(law, x), increment); });
}
template <class S>
S Hysteresis<S>::work(const State& x, const S& increment) const {
    return HysteresisLaws<S>::visit(*this, [&](const auto& law) { return law.work(unpack_state<S>(law, x), increment); });
}
template <class S>
S Hysteresis<S>::stored(const State& x) const {
    return HysteresisLaws<S>::visit(*this, [&](const auto& law) {
        if constexpr (requires { law.stored(unpack_state<S>(law, x)); })
            return law.stored(unpack_state<S>(law, x));
        else
            return S(0.0);
    });
}
template <class S>
bool Hysteresis<S>::is_bounded() const {
    return HysteresisLaws<S>::visit(*this, [](const auto& law) { return strainwave::bounded<S>(law); });
}
template <class S>
Domain<S> Hysteresis<S>::domain(const S& twist) const {
    return HysteresisLaws<S>::visit(*this, [&](const auto& law) { return strainwave::domain<S>(law, twist); });
}

SW_GENERAL(Density)
SW_GENERAL(Hysteresis)

}  // namespace strainwave::general
