#include "motor.hpp"

#include <strainwave/fastest.hpp>
#include <strainwave/motor/models.hpp>

#include "laws.hpp"

namespace strainwave::general {

template <class S>
using MotorLaws = Laws<S, motor::Models>;

template <class S>
void Motor<S>::read(kernel::Reader<S>& from) {
    MotorLaws<S>::read(*this, from, [this](const auto& law) { inertia = law.inertia; });
}
template <class S>
void Motor<S>::places(Places& found) const {
    MotorLaws<S>::visit(*this, [&](const auto& law) { add_state_places<S>(law, found); });
}
template <class S>
void Motor<S>::output_places(Places& found) const {
    MotorLaws<S>::visit(*this, [&]<class Law>(const Law& law) { add_places<S>(law, typename Law::Output{}, found); });
}
template <class S>
auto Motor<S>::initial_state() const -> State {
    return MotorLaws<S>::visit(*this, [](const auto& law) { return pack_slots<State>(strainwave::initial_state(law)); });
}
template <class S>
S Motor<S>::torque(const State& x, const S& actuation, const Rotor& rotor) const {
    return MotorLaws<S>::visit(*this, [&](const auto& law) { return law.torque(unpack_state<S>(law, x), actuation, rotor); });
}
template <class S>
S Motor<S>::current(const State& x, const S& actuation, const Rotor& rotor) const {
    return MotorLaws<S>::visit(*this, [&](const auto& law) { return law.current(unpack_state<S>(law, x), actuation, rotor); });
}
template <class S>
auto Motor<S>::output(const State& x, const S& actuation, const Rotor& rotor) const -> Output {
    return MotorLaws<S>::visit(
        *this, [&](const auto& law) { return pack_slots<Output>(law.output(unpack_state<S>(law, x), actuation, rotor)); });
}
template <class S>
motor::Power<S> Motor<S>::power(const State& x, const S& actuation, const Rotor& rotor) const {
    return MotorLaws<S>::visit(*this, [&](const auto& law) { return law.power(unpack_state<S>(law, x), actuation, rotor); });
}
template <class S>
auto Motor<S>::rate(const State& x, const S& actuation, const Rotor& rotor) const -> State {
    return MotorLaws<S>::visit(
        *this, [&](const auto& law) { return pack_slots<State>(law.rate(unpack_state<S>(law, x), actuation, rotor)); });
}
template <class S>
auto Motor<S>::relaxation_rate() const -> State {
    return MotorLaws<S>::visit(*this, [](const auto& law) { return pack_slots<State>(law.relaxation_rate()); });
}
template <class S>
Limits<S> Motor<S>::limits(const State& x, const Rotor& rotor) const {
    return MotorLaws<S>::visit(*this, [&](const auto& law) { return motor::limits(law, unpack_state<S>(law, x), rotor); });
}
template <class S>
bool Motor<S>::prescribes() const {
    return MotorLaws<S>::visit(*this, [](const auto& law) { return motor::prescribes(law); });
}
template <class S>
S Motor<S>::acceleration(const S& asked) const {
    return MotorLaws<S>::visit(*this, [&](const auto& law) { return motor::acceleration<S>(law, asked); });
}
template <class S>
S Motor<S>::fastest() const {
    return MotorLaws<S>::visit(*this, [](const auto& law) { return strainwave::fastest<S>(law); });
}

SW_GENERAL(Motor)

}  // namespace strainwave::general
