#pragma once
#include "part.hpp"

namespace strainwave::general {

/// Lists of sensors, each of which may hold one of the list before, and the numbers of a state that its laws have at most.
enum SensorList { plain_sensor, late_sensor, loud_sensor, any_sensor };
inline constexpr int sensor_slots[]{2, 6, 7, 7};

/// A sensor by any law of a list.
template <class S, SensorList list>
struct SensorOf : Part {
    // Most sensors have no state, so none is carried along for them. Within another, the slots are some of its own.
    using State = Storage<S, sensor_slots[list], (list == any_sensor ? 0 : sensor_slots[list])>;

    void read(kernel::Reader<S>& from);
    void places(Places& found) const;

    State initial_state() const;
    S shown(const State& x, const S& value) const;
    State rate(const State& x, const S& value) const;
    State relaxation_rate() const;
    State steady_state(const S& value) const;
    S fastest() const;
};
template <class S>
using Sensor = SensorOf<S, any_sensor>;

}  // namespace strainwave::general
