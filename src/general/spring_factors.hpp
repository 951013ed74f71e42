#pragma once
#include <strainwave/variation/variation.hpp>

#include "part.hpp"

/// Factors on stiffness and hysteresis.
namespace strainwave::general {

/// Variation of a stiffness over the angle of the wave generator, by any law.
template <class S>
struct Variation : Part {
    void read(kernel::Reader<S>& from);

    bool active() const;
    S largest() const;
    variation::Factor<S> at(const Angle<S>& angle) const;
};

/// Softening of a gear with temperature, by any law.
template <class S>
struct Softening : Part {
    void read(kernel::Reader<S>& from);

    bool active() const;
    S of_stiffness(const S& temperature) const;
    S of_hysteresis(const S& temperature) const;
    S dissipation_rate(const S& warming) const;
};

}  // namespace strainwave::general
