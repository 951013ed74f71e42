#pragma once
#include <strainwave/ring/ring.hpp>

namespace strainwave::ring {

template <class S>
struct Rigid {
    static constexpr int capacity = 0;

    static constexpr auto name = "rigid";
    static constexpr auto source = "definition";
    static constexpr auto doc = R"(
        Ring of the flexspline without vibration: the mesh does not move it.

        .. math:: u = 0

        with u the displacement of the ring's teeth along the line of action. Valid if every order of the mesh force, times the
        speed, is far below the natural frequencies of the ring; Modes has these.

        >>> from strainwave.ring import Rigid
        >>> Rigid()
        Rigid())";

    template <class Self, class Visit>
    static constexpr void fields(Self&, Visit&&) {}

    using State = Stateless<S>;

    static constexpr bool active() { return false; }
};

}  // namespace strainwave::ring
