#pragma once
#include <strainwave/load/load.hpp>

#include "part.hpp"

namespace strainwave::general {

/// A load by any law.
template <class S>
struct Load : Part {
    S inertia{0.0};
    bool prescribes = false, brakes = false;

    void read(kernel::Reader<S>& from);

    S load_torque(const S& angle, const S& speed, const S& input) const;
    S steepest() const;
    Braking<S> braking(const S& input) const;
};

template <class S>
S inertia_of(const Load<S>& load) {
    return load.inertia;
}
template <class S>
bool prescribes(const Load<S>& load) {
    return load.prescribes;
}
template <class S>
bool brakes(const Load<S>& load) {
    return load.brakes;
}

}  // namespace strainwave::general

namespace strainwave::load {
template <class S>
inline constexpr bool can_prescribe<general::Load<S>> = true;
template <class S>
inline constexpr bool can_brake<general::Load<S>> = true;
}  // namespace strainwave::load
