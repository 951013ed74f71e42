#pragma once
#include <strainwave/control/law.hpp>

#include "part.hpp"

namespace strainwave::general {

/// A controller by any law, sampled or not.
template <class S>
struct Control : Part {
    using State = Storage<S, 8>;
    using Discrete = Storage<S, 240>;
    using Command = control::Command<S>;
    using Measurement = control::Measurement<S>;

    void read(kernel::Reader<S>& from);
    void places(Places& found) const;
    void discrete_places(Places& found) const;

    State initial_state() const;
    Discrete initial_discrete() const;
    S act(const State& x, const Command& command, const Measurement& measured) const;
    State rate(const State& x, const Command& command, const Measurement& measured) const;
    State relaxation_rate() const;
    S fastest() const;
    S actuation(const State& x, const Discrete& held, const Command& command, const Measurement& measured) const;
    S held(const Discrete& x) const;
    Discrete sampled(const Discrete& x, const S& within, const Command& command, const Measurement& measured) const;
    Discrete elapsed(const Discrete& x, const S& dt) const;
    bool due(const Discrete& x, const S& within) const;
    control::Schedule<S> schedule(const Discrete& x) const;
};

}  // namespace strainwave::general
