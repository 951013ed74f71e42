#pragma once
#include <strainwave/compensation/compensator.hpp>

namespace strainwave::compensation {

/// Base of every compensator without effect: feed-forward, dither, observer or learning.
template <class S>
struct None {
    using Base = None;
    using State = Stateless<S>;

    static constexpr auto source = "definition";

    template <class Self, class Visit>
    static constexpr void fields(Self&, Visit&&) {}

    static constexpr bool active() { return false; }
    constexpr RequestAndState<S, State> step(const State&, const control::Command<S>&, const S&) const { return {}; }
    constexpr Request<S> request(const State&, const Inputs<S>&) const { return {}; }
    constexpr State advance(const State&, const Inputs<S>&, const Request<S>&, const S&, const S&) const { return {}; }
};

template <class S>
struct NoFeedforward : None<S> {
    static constexpr auto name = "no_feedforward";
    static constexpr auto doc = R"(
        No feed-forward of a model: the controller acts on the error alone.

        .. math:: \tau_f = 0

        >>> from strainwave.compensation import NoFeedforward
        >>> NoFeedforward()
        NoFeedforward())";
};

template <class S>
struct NoDither : None<S> {
    static constexpr auto name = "no_dither";
    static constexpr auto doc = R"(
        No dither: no torque swings around zero.

        .. math:: \tau_d = 0

        >>> from strainwave.compensation import NoDither
        >>> NoDither()
        NoDither())";
};

template <class S>
struct NoObserver : None<S> {
    static constexpr auto name = "no_observer";
    static constexpr auto doc = R"(
        No observer: disturbances are not estimated.

        .. math:: \hat d = 0

        >>> from strainwave.compensation import NoObserver
        >>> NoObserver()
        NoObserver())";
};

template <class S>
struct NoLearning : None<S> {
    static constexpr auto name = "no_learning";
    static constexpr auto doc = R"(
        No learning: errors that repeat with the angle are not corrected.

        .. math:: \hat e = 0

        >>> from strainwave.compensation import NoLearning
        >>> NoLearning()
        NoLearning())";
};

}  // namespace strainwave::compensation
