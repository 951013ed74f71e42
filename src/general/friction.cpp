#include "friction.hpp"

#include <strainwave/friction/models.hpp>

#include "laws.hpp"

namespace strainwave::general {

template <class S>
using FrictionLaws = Laws<S, friction::Models, Friction<S>>;

template <class S>
void Friction<S>::read(kernel::Reader<S>& from) {
    FrictionLaws<S>::read(*this, from);
}
template <class S>
void Friction<S>::places(Places& found) const {
    FrictionLaws<S>::visit(*this, [&](const auto& law) { add_state_places<S>(law, found); });
}
template <class S>
auto Friction<S>::initial_state() const -> State {
    return FrictionLaws<S>::visit(*this, [](const auto& law) { return pack_slots<State>(strainwave::initial_state(law)); });
}
template <class S>
S Friction<S>::torque(const State& x, const Contact& at) const {
    return FrictionLaws<S>::visit(*this, [&](const auto& law) { return friction::torque(law, unpack_state<S>(law, x), at); });
}
template <class S>
auto Friction<S>::response(const State& x, const Contact& at) const -> friction::Response<S, State> {
    return FrictionLaws<S>::visit(*this, [&](const auto& law) {
        const auto found = friction::response(law, unpack_state<S>(law, x), at);
        return friction::Response<S, State>{found.torque, pack_slots<State>(found.rate)};
    });
}
template <class S>
bool Friction<S>::set_valued() const {
    return FrictionLaws<S>::visit(*this, [](const auto& law) { return friction::set_valued(law); });
}
template <class S>
S Friction<S>::hold(const Contact& at) const {
    return FrictionLaws<S>::visit(*this, [&](const auto& law) { return friction::hold(law, at); });
}
template <class S>
auto Friction<S>::rate(const State& x, const Contact& at) const -> State {
    return FrictionLaws<S>::visit(
        *this, [&](const auto& law) { return pack_slots<State>(friction::rate(law, unpack_state<S>(law, x), at)); });
}
template <class S>
auto Friction<S>::relaxation_rate(const State& x, const Contact& at) const -> State {
    return FrictionLaws<S>::visit(
        *this, [&](const auto& law) { return pack_slots<State>(friction::relaxation_rate(law, unpack_state<S>(law, x), at)); });
}
template <class S>
auto Friction<S>::clamped(const State& x, const Contact& at) const -> State {
    return FrictionLaws<S>::visit(
        *this, [&](const auto& law) { return pack_slots<State>(friction::clamped(law, unpack_state<S>(law, x), at)); });
}
template <class S>
auto Friction<S>::update_mode(const State& x, const Contact& at) const -> State {
    return FrictionLaws<S>::visit(
        *this, [&](const auto& law) { return pack_slots<State>(friction::update_mode(law, unpack_state<S>(law, x), at)); });
}
template <class S>
auto Friction<S>::advance(const State& x, const Contact& at, const S& dt) const -> State {
    return FrictionLaws<S>::visit(
        *this, [&](const auto& law) { return pack_slots<State>(friction::advance(law, unpack_state<S>(law, x), at, dt)); });
}
template <class S>
auto Friction<S>::steady_state(const Contact& at) const -> State {
    return FrictionLaws<S>::visit(*this, [&](const auto& law) { return pack_slots<State>(friction::steady_state(law, at)); });
}
template <class S>
bool Friction<S>::is_bounded() const {
    return FrictionLaws<S>::visit(*this, [](const auto& law) { return strainwave::bounded<Contact>(law); });
}
template <class S>
Domain<S> Friction<S>::domain(const Contact& at) const {
    return FrictionLaws<S>::visit(*this, [&](const auto& law) { return strainwave::domain<S>(law, at); });
}

SW_GENERAL(Friction)

}  // namespace strainwave::general
