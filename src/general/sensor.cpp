#include "sensor.hpp"

#include <strainwave/fastest.hpp>
#include <strainwave/sensor/models.hpp>

#include "laws.hpp"

namespace strainwave::general {

/// Stands for whatever sensor another leaves room for.
struct SensorOfItsRoom {};

namespace detail {
template <template <class, class> class Outer, class S, class Law>
struct Around<Outer<S, Law>, SensorOfItsRoom> {
    using type = Outer<S, SensorWithin<S, Outer<S, Law>::room>>;
};
}  // namespace detail

template <int room>
struct SensorList;
template <>
struct SensorList<2> {
    using type = sensor::Plain;
};
template <>
struct SensorList<6> {
    using type = sensor::Late;
};
template <>
struct SensorList<7> {
    using type = sensor::Models;
};
template <class S, int room>
using SensorLaws = Laws<S, typename SensorList<room>::type, SensorOfItsRoom>;

template <class S, int room>
void SensorWithin<S, room>::read(kernel::Reader<S>& from) {
    SensorLaws<S, room>::read(*this, from);
}
template <class S, int room>
void SensorWithin<S, room>::places(Places& found) const {
    SensorLaws<S, room>::visit(*this, [&](const auto& law) { add_state_places<S>(law, found); });
}
template <class S, int room>
auto SensorWithin<S, room>::initial_state() const -> State {
    return SensorLaws<S, room>::visit(*this, [](const auto& law) { return packed<State>(strainwave::initial_state(law)); });
}
template <class S, int room>
S SensorWithin<S, room>::shown(const State& x, const S& value) const {
    return SensorLaws<S, room>::visit(*this, [&](const auto& law) { return law.shown(own<S>(law, x), value); });
}
template <class S, int room>
auto SensorWithin<S, room>::rate(const State& x, const S& value) const -> State {
    return SensorLaws<S, room>::visit(*this, [&](const auto& law) { return packed<State>(law.rate(own<S>(law, x), value)); });
}
template <class S, int room>
auto SensorWithin<S, room>::relaxation_rate() const -> State {
    return SensorLaws<S, room>::visit(*this, [](const auto& law) { return packed<State>(law.relaxation_rate()); });
}
template <class S, int room>
auto SensorWithin<S, room>::settled(const S& value) const -> State {
    return SensorLaws<S, room>::visit(*this, [&](const auto& law) { return packed<State>(law.settled(value)); });
}
template <class S, int room>
S SensorWithin<S, room>::fastest() const {
    return SensorLaws<S, room>::visit(*this, [](const auto& law) { return strainwave::fastest<S>(law); });
}

#define SW_WITHIN(room)                           \
    template struct SensorWithin<double, room>; \
    template struct SensorWithin<Slope, room>;
SW_WITHIN(2)
SW_WITHIN(6)
SW_WITHIN(7)

}  // namespace strainwave::general
