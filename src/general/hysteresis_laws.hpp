#pragma once
#include <strainwave/hysteresis/models.hpp>
#include <strainwave/quasi_static.hpp>

#include "drive.hpp"
#include "laws.hpp"

namespace strainwave::general {

template <class S>
using DensityLaws = Laws<S, hysteresis::Densities>;
template <class S>
using HysteresisLaws = Laws<S, hysteresis::Models, Density<S>>;

/// A gear whose law of hysteresis is known when this is compiled: its state is not copied into slots and back.
template <class S, class Law>
struct KnownHysteresis {
    const GeneralGear<S>& gear;
    const Law& hysteresis;

    S held_torque(const S& twist, const typename Law::State& held, const S& moved, const S& temperature, const S& factor) const {
        return gear.softened(factor * gear.stiffness.torque(twist), hysteresis.torque(held, moved), temperature);
    }
};

/// Calls f with spring and hysteresis of a gear, twisted slowly from `begin` [rad] on, where it has no history.
template <class S, class F>
auto with_quasi_static(const GeneralGear<S>& gear, const S& begin, const F& f) {
    return HysteresisLaws<S>::visit(gear.hysteresis, [&]<class Law>(const Law& law) {
        const KnownHysteresis<S, Law> known{gear, law};
        return f(QuasiStatic<S, KnownHysteresis<S, Law>>(known, S(room_temperature), begin));
    });
}

}  // namespace strainwave::general
