#pragma once
#include <strainwave/field.hpp>

namespace strainwave::load {

template <class S>
struct Prescribed {
    static constexpr auto name = "prescribed";
    static constexpr auto source = "definition";
    static constexpr auto doc = R"(
        Output shaft with a prescribed motion: locked by a rig, or moved by another simulation.

        .. math:: \theta_{out} = \theta(t), \qquad T_{load} = T - F_{out}

        with theta(t) the run's input output_angle [rad], given with its speed. The torque of the load is the torque that the
        shaft exerts on the outside. At rest, set-valued friction at the output and this torque are not determined separately:
        the friction is reported as 0.

        >>> from strainwave.loads import Prescribed
        >>> Prescribed()
        Prescribed())";

    template <class Self, class Visit>
    static constexpr void fields(Self&, Visit&&) {}

    /// The input that this load takes.
    static constexpr Field input{"output_angle", "rad", "Angle at which the output shaft is"};
    static constexpr bool prescribes = true;

    constexpr S torque(const S&, const S&) const { return S(0.0); }
};

}  // namespace strainwave::load
