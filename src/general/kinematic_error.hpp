#pragma once
#include <strainwave/kinematic_error/error.hpp>

#include "part.hpp"

namespace strainwave::general {

/// Kinematic error by any law.
template <class S>
struct KinematicError : Part {
    void read(kernel::Reader<S>& from);

    kinematic_error::Error<S> at(const Angle<S>& angle) const;
    bool follows_temperature() const;
    kinematic_error::Error<S> warmed(const Angle<S>& angle, const S& temperature) const;
    S per_kelvin(const Angle<S>& angle) const;
    S side(const Angle<S>& angle) const;
    bool follows_load() const;
    kinematic_error::Relief<S> relief(const S& torque) const;
};

/// Largest derivatives of a random error, at rest and without load.
template <class S>
struct MaxChange {
    S slope, per_torque, per_speed;
};

/// Random kinematic error by any law.
template <class S>
struct KinematicNoise : Part {
    void read(kernel::Reader<S>& from);

    bool active() const;
    kinematic_error::Error<S> at(const Angle<S>& angle, const S& torque, const S& speed) const;
    S drift(const Angle<S>& angle, const S& torque, const S& torque_rate, const S& speed, const S& acceleration) const;
    MaxChange<S> max_change() const;
};

}  // namespace strainwave::general
