#pragma once
#include <strainwave/motor/rotor.hpp>

#include "part.hpp"

namespace strainwave::general {

/// A motor by any law.
template <class S>
struct Motor : Part {
    using State = Storage<S, 2>;
    using Output = OutputStorage<S, 4>;
    using Rotor = motor::Rotor<S>;

    S inertia{0.0};

    void read(kernel::Reader<S>& from);
    void places(Places& found) const;
    void output_places(Places& found) const;

    State initial_state() const;
    S torque(const State& x, const S& actuation, const Rotor& rotor) const;
    S current(const State& x, const S& actuation, const Rotor& rotor) const;
    Output output(const State& x, const S& actuation, const Rotor& rotor) const;
    motor::Power<S> power(const State& x, const S& actuation, const Rotor& rotor) const;
    State rate(const State& x, const S& actuation, const Rotor& rotor) const;
    State relaxation_rate() const;
    Limits<S> limits(const State& x, const Rotor& rotor) const;
    bool prescribes() const;
    S acceleration(const S& asked) const;
    S fastest() const;
};

}  // namespace strainwave::general
