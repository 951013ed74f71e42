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

template <class S>
void Thermal<S>::read(kernel::Reader<S>& from) {
    ThermalLaws<S>::read(*this, from);
}
template <class S>
void Thermal<S>::places(Places& found) const {
    ThermalLaws<S>::visit(*this, [&](const auto& law) { add_state_places<S>(law, found); });
}
template <class S>
void Thermal<S>::output_places(Places& found) const {
    ThermalLaws<S>::visit(*this, [&]<class Law>(const Law& law) { add_places<S>(law, typename Law::Output{}, found); });
}
template <class S>
auto Thermal<S>::initial_state() const -> State {
    return ThermalLaws<S>::visit(*this, [](const auto& law) { return pack_slots<State>(strainwave::initial_state(law)); });
}
template <class S>
bool Thermal<S>::active() const {
    return ThermalLaws<S>::visit(*this, [](const auto& law) { return law.active(); });
}
template <class S>
thermal::Temperatures<S> Thermal<S>::at(const State& x, const S& ambient) const {
    return ThermalLaws<S>::visit(*this, [&](const auto& law) { return law.at(unpack_state<S>(law, x), ambient); });
}
template <class S>
auto Thermal<S>::rate(const State& x, const thermal::Heat<S>& heat, const S& ambient) const -> State {
    return ThermalLaws<S>::visit(
        *this, [&](const auto& law) { return pack_slots<State>(law.rate(unpack_state<S>(law, x), heat, ambient)); });
}
template <class S>
S Thermal<S>::gear_rate(const State& rate, const S& ambient_rate) const {
    return ThermalLaws<S>::visit(*this, [&](const auto& law) { return law.gear_rate(unpack_state<S>(law, rate), ambient_rate); });
}
template <class S>
S Thermal<S>::fastest() const {
    return ThermalLaws<S>::visit(*this, [](const auto& law) { return strainwave::fastest<S>(law); });
}
template <class S>
auto Thermal<S>::output(const State& x, const S& ambient) const -> Output {
    return ThermalLaws<S>::visit(*this,
                                 [&](const auto& law) { return pack_slots<Output>(law.output(unpack_state<S>(law, x), ambient)); });
}

template <class S>
void Meter<S>::read(kernel::Reader<S>& from) {
    MeterLaws<S>::read(*this, from);
}
template <class S>
void Meter<S>::places(Places& found) const {
    MeterLaws<S>::visit(*this, [&](const auto& law) { add_state_places<S>(law, found); });
}
template <class S>
void Meter<S>::output_places(Places& found) const {
    MeterLaws<S>::visit(*this, [&]<class Law>(const Law& law) { add_places<S>(law, typename Law::Output{}, found); });
}
template <class S>
auto Meter<S>::initial_state() const -> State {
    return MeterLaws<S>::visit(*this, [](const auto& law) { return pack_slots<State>(strainwave::initial_state(law)); });
}
template <class S>
bool Meter<S>::active() const {
    return MeterLaws<S>::visit(*this, [](const auto& law) { return law.active(); });
}
template <class S>
auto Meter<S>::rate(const meter::Powers<S>& powers) const -> State {
    return MeterLaws<S>::visit(*this, [&](const auto& law) { return pack_slots<State>(law.rate(powers)); });
}
template <class S>
auto Meter<S>::output(const State& x, const meter::Powers<S>& powers, const meter::Stored<S>& stored) const -> Output {
    return MeterLaws<S>::visit(
        *this, [&](const auto& law) { return pack_slots<Output>(law.output(unpack_state<S>(law, x), powers, stored)); });
}

SW_GENERAL(Thermal)
SW_GENERAL(Meter)

}  // namespace strainwave::general
