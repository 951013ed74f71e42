#pragma once
#include <strainwave/material/material.hpp>

#include "part.hpp"

namespace strainwave::general {

/// Material of a gear by any law.
template <class S>
struct Material : Part {
    using State = Storage<S, 8, 0>;

    void read(kernel::Reader<S>& from);
    void places(Places& found) const;

    State initial_state() const;
    bool active() const;
    S largest_stiffness() const;
    S torque(const State& x) const;
    State rate(const State& x, const S& twist_rate) const;
    State relaxation_rate() const;
    S lost(const State& x) const;
    S stored(const State& x) const;
    State advance(const State& x, const S& increment, const S& dt) const;
    S work(const State& x, const S& increment, const S& dt) const;
    S storage(const S& frequency) const;
    S loss(const S& frequency) const;
};

}  // namespace strainwave::general
