#pragma once
#include <strainwave/variation/variation.hpp>

#include "part.hpp"

/// What stiffness and hysteresis are multiplied by.
namespace strainwave::general {

/// How a stiffness varies as the wave generator turns, by any law.
template <class S>
struct Variation : Part {
    void read(kernel::Reader<S>& from);

    bool active() const;
    S largest() const;
    variation::Factor<S> at(const Angle<S>& angle) const;
};

/// How a gear gives way as it warms up, by any law.
template <class S>
struct Softening : Part {
    void read(kernel::Reader<S>& from);

    bool active() const;
    S of_stiffness(const S& temperature) const;
    S of_hysteresis(const S& temperature) const;
    S dissipation_rate(const S& warming) const;
};

}  // namespace strainwave::general
