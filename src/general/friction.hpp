#pragma once
#include <strainwave/friction/contact.hpp>

#include "part.hpp"

namespace strainwave::general {

/// Friction by any law, modulated by any others.
template <class S>
struct Friction : Part {
    using State = Storage<S, 16>;
    using Contact = friction::Contact<S>;

    void read(kernel::Reader<S>& from);
    void places(Places& found) const;

    State initial_state() const;
    S torque(const State& x, const Contact& at) const;
    friction::Response<S, State> response(const State& x, const Contact& at) const;
    bool set_valued() const;
    S hold(const Contact& at) const;
    State rate(const State& x, const Contact& at) const;
    State relaxation_rate(const State& x, const Contact& at) const;
    State clamped(const State& x, const Contact& at) const;
    State update_mode(const State& x, const Contact& at) const;
    State advance(const State& x, const Contact& at, const S& dt) const;
    State steady_state(const Contact& at) const;
    bool is_bounded() const;
    Domain<S> domain(const Contact& at) const;

    template <class Where>
    bool bounded() const {
        return is_bounded();
    }
};

}  // namespace strainwave::general
