#pragma once
#include <strainwave/compensation/compensation.hpp>

#include "part.hpp"

namespace strainwave::general {

/// Lists of compensators that go by the command alone.
enum class Requests { feedforward, dither };

/// A feed-forward or a dither by any law.
template <class S, Requests list>
struct Feedforward : Part {
    using State = Storage<S, list == Requests::feedforward ? 96 : 4, 0>;

    void read(kernel::Reader<S>& from);
    void places(Places& found) const;

    State initial_state() const;
    compensation::RequestAndState<S, State> step(const State& x, const control::Command<S>& command, const S& period) const;
};

/// Lists of compensators that act on measurements.
enum class Corrections { learning, observer };

/// A learner or an observer by any law.
template <class S, Corrections list>
struct Correction : Part {
    using State = Storage<S, list == Corrections::learning ? 96 : 32, 0>;

    void read(kernel::Reader<S>& from);
    void places(Places& found) const;

    State initial_state() const;
    compensation::Request<S> request(const State& x, const compensation::Inputs<S>& inputs) const;
    State advance(const State& x, const compensation::Inputs<S>& inputs, const compensation::Request<S>& request,
                  const S& motor_torque, const S& period) const;
};

template <class S>
using AnyCompensation = Compensation<S, Feedforward<S, Requests::feedforward>, Correction<S, Corrections::learning>,
                                     Correction<S, Corrections::observer>, Feedforward<S, Requests::dither>>;

}  // namespace strainwave::general
