#include "sensor.hpp"

#include <strainwave/fastest.hpp>
#include <strainwave/sensor/models.hpp>

#include "laws.hpp"

namespace strainwave::general {

/// Placeholder for the inner sensor of another.
struct SensorWithin {};

namespace detail {

template <class L, class Law>
inline constexpr bool lists = false;
template <template <class...> class... Each, template <class, class> class Outer, class S, class Law>
inline constexpr bool lists<List<Each...>, Outer<S, Law>> = (std::is_same_v<Each<S>, Outer<S, Law>> || ...);

template <template <class, class> class Outer, class S, class Law>
struct Around<Outer<S, Law>, SensorWithin> {
    static constexpr SensorList before = lists<sensor::Late, Outer<S, Law>>   ? plain_sensor
                                         : lists<sensor::Loud, Outer<S, Law>> ? late_sensor
                                                                              : loud_sensor;
    using type = Outer<S, SensorOf<S, before>>;
};

}  // namespace detail

using SensorLists = std::tuple<sensor::Plain, sensor::Late, sensor::Loud, sensor::Models>;  // as SensorList names them
template <class S, SensorList list>
using SensorLaws = Laws<S, std::tuple_element_t<list, SensorLists>, SensorWithin>;

template <class S, SensorList list>
void SensorOf<S, list>::read(kernel::Reader<S>& from) {
    SensorLaws<S, list>::read(*this, from);
}
template <class S, SensorList list>
void SensorOf<S, list>::places(Places& found) const {
    SensorLaws<S, list>::visit(*this, [&](const auto& law) { add_state_places<S>(law, found); });
}
template <class S, SensorList list>
auto SensorOf<S, list>::initial_state() const -> State {
    return SensorLaws<S, list>::visit(*this, [](const auto& law) { return pack_slots<State>(strainwave::initial_state(law)); });
}
template <class S, SensorList list>
S SensorOf<S, list>::shown(const State& x, const S& value) const {
    return SensorLaws<S, list>::visit(*this, [&](const auto& law) { return law.shown(unpack_state<S>(law, x), value); });
}
template <class S, SensorList list>
auto SensorOf<S, list>::rate(const State& x, const S& value) const -> State {
    return SensorLaws<S, list>::visit(*this,
                                      [&](const auto& law) { return pack_slots<State>(law.rate(unpack_state<S>(law, x), value)); });
}
template <class S, SensorList list>
auto SensorOf<S, list>::relaxation_rate() const -> State {
    return SensorLaws<S, list>::visit(*this, [](const auto& law) { return pack_slots<State>(law.relaxation_rate()); });
}
template <class S, SensorList list>
auto SensorOf<S, list>::steady_state(const S& value) const -> State {
    return SensorLaws<S, list>::visit(*this, [&](const auto& law) { return pack_slots<State>(law.steady_state(value)); });
}
template <class S, SensorList list>
S SensorOf<S, list>::fastest() const {
    return SensorLaws<S, list>::visit(*this, [](const auto& law) { return strainwave::fastest<S>(law); });
}

#define SW_SENSORS(list)                    \
    template struct SensorOf<double, list>; \
    template struct SensorOf<Slope, list>;
SW_SENSORS(plain_sensor)
SW_SENSORS(late_sensor)
SW_SENSORS(loud_sensor)
SW_SENSORS(any_sensor)

}  // namespace strainwave::general
