#pragma once
#include <strainwave/onset/onset.hpp>

namespace strainwave::onset {

template <class S>
struct Step {
    S at{1e5};
    Unit unit{Unit::output_revolutions};

    static constexpr auto name = "step";
    static constexpr auto source = "definition";
    static constexpr auto doc = R"(
        Fault that begins at once, at a given use.

        .. math:: g(u) = 0 \text{ for } u < u_0, \qquad g(u) = 1 \text{ for } u \ge u_0

        with u the use of the drive, u_0 = at, both counted in ``unit``.

        >>> from strainwave.onset import Step
        >>> Step(at=1000.0).share([999.0, 1000.0])
        array([0., 1.]))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_REQUIRED(m, at, "1", "Use u_0 at which the fault begins", 0));
        visit(SW_FIELD(m, unit, "1", "Unit of usage"));
    }

    constexpr S share(const S& usage) const { return select(usage < at, S(0.0), S(1.0)); }
};

}  // namespace strainwave::onset
