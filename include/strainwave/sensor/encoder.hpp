#pragma once
#include <strainwave/field.hpp>

namespace strainwave::sensor {

template <class S>
struct Encoder {
    S counts{4096.0};
    S offset{0.0};
    S eccentricity{0.0};
    S eccentricity_phase{0.0};

    static constexpr auto name = "encoder";
    static constexpr auto source = "definition";
    static constexpr auto doc = R"(
        Encoder with counts, an offset and an eccentric disc.

        .. math:: y = q \operatorname{round}\left(\frac{x + x_0 + a \sin(x + \varphi)}{q}\right), \qquad q = \frac{2 \pi}{N}

        with x the angle, N = counts per revolution, after interpolation, x_0 = offset, a = eccentricity, phi =
        eccentricity_phase. A controller that is not sampled jumps with each count. Fixed steps do not locate these jumps, and
        adaptive steps become very short. Noise around an encoder is added after counting. Derivatives ignore the rounding.

        >>> from strainwave.sensor import Encoder
        >>> Encoder(counts=2**17, eccentricity=1e-5).offset
        0.0)";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_REQUIRED(m, counts, "1", "Counts N per revolution", 1));
        visit(SW_FIELD(m, offset, "rad", "Added to the angle"));
        visit(SW_FIELD(m, eccentricity, "rad", "Amplitude a of the error once per revolution"));
        visit(SW_FIELD(m, eccentricity_phase, "rad", "Phase phi of that error"));
    }

    using State = Stateless<S>;

    constexpr S shown(const State&, const S& angle) const {
        const S marked = angle + offset + eccentricity * sin(angle + eccentricity_phase);
        const S count = S(2.0 * pi) / counts, counted = count * rint(marked / count);
        if constexpr (differentiates<S>)
            return marked + value_only(counted - marked);
        else
            return counted;
    }
    constexpr State rate(const State&, const S&) const { return {}; }
    constexpr State relaxation_rate() const { return {}; }
    constexpr State steady_state(const S&) const { return {}; }
};

}  // namespace strainwave::sensor
