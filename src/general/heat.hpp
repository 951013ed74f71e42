#pragma once
#include <strainwave/meter/meter.hpp>
#include <strainwave/thermal/thermal.hpp>

#include "part.hpp"

/// Temperatures and powers of a drive.
namespace strainwave::general {

/// Temperatures of gear and winding, by any law.
template <class S>
struct Thermal : Part {
    using State = Storage<S, 2>;
    using Output = OutputStorage<S, 1>;

    void read(kernel::Reader<S>& from);
    void places(Places& found) const;
    void output_places(Places& found) const;

    State initial_state() const;
    bool active() const;
    thermal::Temperatures<S> at(const State& x, const S& ambient) const;
    State rate(const State& x, const thermal::Heat<S>& heat, const S& ambient) const;
    S gear_rate(const State& rate, const S& ambient_rate) const;
    S fastest() const;
    Output output(const State& x, const S& ambient) const;
};

/// Meter of powers and energies, by any law.
template <class S>
struct Meter : Part {
    using State = Storage<S, 10>;
    using Output = OutputStorage<S, 25>;

    void read(kernel::Reader<S>& from);
    void places(Places& found) const;
    void output_places(Places& found) const;

    State initial_state() const;
    bool active() const;
    State rate(const meter::Powers<S>& powers) const;
    Output output(const State& x, const meter::Powers<S>& powers, const meter::Stored<S>& stored) const;
};

}  // namespace strainwave::general
