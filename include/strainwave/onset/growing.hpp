#pragma once
#include <strainwave/onset/onset.hpp>

namespace strainwave::onset {

template <class S>
struct Growing {
    S begin{0.0};
    S scale{1e6};
    S exponent{1.0};
    Unit unit{Unit::output_revolutions};

    static constexpr auto name = "growing";
    static constexpr auto source =
        "assumed: a power of the use since the beginning; the exponent is the user's; Archard1953 for wear by transmitted work";
    static constexpr auto doc = R"(
        Fault that grows as a power of the use of the drive.

        .. math:: g(u) = \min\left(1, \left(\frac{\max(u - u_0, 0)}{u_1}\right)^p\right)

        with u the use of the drive, u_0 = begin, u_1 = scale, all counted in ``unit``, p = exponent: 1 is wear in proportion
        to the use, above 1 the growth accelerates, as of cracks, below 1 is running in. The fault reaches its severity at u_0
        + u_1, and keeps it.

        Wear by load and sliding (Archard1953) has p = 1 in ``transmitted_work``: the worn volume is the load times the sliding
        distance over the hardness, times a constant of the pair. The teeth slide in proportion to the angle of the output, and
        their load is in proportion to its torque, so that the worn depth is in proportion to the integral of |torque| |d angle|.
        ``sw.diagnose.transmitted_work`` computes it from a recording, ``sw.diagnose.wear_life`` fits u_1 to repeated tests.

        >>> from strainwave.onset import Growing
        >>> Growing(begin=100.0, scale=100.0, exponent=2.0).share([50.0, 150.0, 300.0])
        array([0.  , 0.25, 1.  ]))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, begin, "1", "Use u_0 at which the fault begins", 0));
        visit(SW_REQUIRED(m, scale, "1", "Use u_1 from the beginning to the full severity", smallest));
        visit(SW_FIELD(m, exponent, "1", "Power p of the growth", 0.1, 10));
        visit(SW_FIELD(m, unit, "1", "Unit of usage"));
    }

    constexpr S share(const S& usage) const {
        const S grown = clip((usage - begin) / scale, S(0.0), S(1.0));
        return select(grown > S(0.0), exp(exponent * log(max(grown, S(smallest)))), S(0.0));
    }
};

}  // namespace strainwave::onset
