#pragma once
#include "part.hpp"

namespace strainwave::general {

/// A sensor by any law whose state has at most `room` numbers: a sensor holds one of fewer.
template <class S, int room>
struct SensorWithin : Part {
    using State = Storage<S, room, 0>;  // most sensors have no state, so none is carried along for them

    void read(kernel::Reader<S>& from);
    void places(Places& found) const;

    State initial_state() const;
    S shown(const State& x, const S& value) const;
    State rate(const State& x, const S& value) const;
    State relaxation_rate() const;
    State settled(const S& value) const;
    S fastest() const;
};
template <class S>
using Sensor = SensorWithin<S, 7>;

}  // namespace strainwave::general
