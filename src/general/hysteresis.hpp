#pragma once
#include <strainwave/condition.hpp>

#include "part.hpp"

namespace strainwave::general {

/// Density of Preisach's relays by any law.
template <class S>
struct Density : Part {
    void read(kernel::Reader<S>& from);

    S everett(const S& high, const S& low) const;
    S rising(const S& high, const S& low) const;
    S falling(const S& high, const S& low) const;
    S virgin(const S& reach) const;
    S virgin_work(const S& twist) const;
};

/// Hysteresis by any law.
template <class S>
struct Hysteresis : Part {
    using State = Storage<S, 32>;

    void read(kernel::Reader<S>& from);
    void places(Places& found) const;

    State initial_state() const;
    State advance(const State& x, const S& increment) const;
    S torque(const State& x, const S& increment) const;
    S work(const State& x, const S& increment) const;
    S stored(const State& x) const;  ///< 0 for a law without `stored`
    bool is_bounded() const;
    Domain<S> domain(const S& twist) const;

    template <class Where>
    bool bounded() const {
        return is_bounded();
    }
};

}  // namespace strainwave::general
