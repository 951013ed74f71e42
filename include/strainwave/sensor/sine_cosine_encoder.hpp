#pragma once
#include <strainwave/field.hpp>

namespace strainwave::sensor {

template <class S>
struct SineCosineEncoder {
    S periods{2048.0};
    S cosine_offset{0.0};
    S sine_offset{0.0};
    S amplitude_ratio{1.0};
    S quadrature_error{0.0};
    S converter_step{0.0};

    static constexpr auto name = "sine_cosine_encoder";
    static constexpr auto source =
        "Heydemann1981: offsets, unequal gains and quadrature error of two tracks; a uniform quantiser of each track: definition";
    static constexpr auto doc = R"(
        Sine-cosine encoder or resolver, interpolated by the arctangent of its two tracks.

        .. math:: c = \cos N x + o_c, \quad s = r \sin(N x + \kappa) + o_s, \qquad
                  y = \frac{1}{N} \operatorname{arg}\left(h \operatorname{round}\frac{c}{h} + j\, h \operatorname{round}\frac{s}{h}\right)

        with x the angle, N = periods per revolution, o_c, o_s = cosine_ and sine_offset and h = converter_step relative to the
        amplitude of the cosine, r = amplitude_ratio, kappa = quadrature_error. The whole periods are counted without error. To
        first order the reading deviates by

        .. math:: N (y - x) = \tfrac{\kappa}{2} + o_s \cos N x - o_c \sin N x + \tfrac{1}{2} (r - 1) \sin 2 N x
                  + \tfrac{1}{2} \kappa \cos 2 N x

        so that offsets cause the order N of the shaft, unequal amplitudes and the quadrature error the order 2 N. The steps of
        the converter add an error with the root mean square h / (N sqrt(12)) where it is far below 1. A converter of b bits
        over the range from -A to A has h = 2 A / 2^b. A resolver has N pairs of poles.

        Leaves out the harmonics of the tracks, the lag of the amplifiers, and an eccentric disc. Quantised around this sensor
        gives the reading steps, as of a counter after interpolation. A controller that is not sampled jumps with each step of
        the converter, and steps of a run must resolve the order 2 N. Derivatives ignore the steps.

        >>> from strainwave.sensor import SineCosineEncoder
        >>> sensor = SineCosineEncoder(periods=1024, cosine_offset=0.01, amplitude_ratio=1.02, converter_step=2.5 / 2**12)
        >>> sensor.converter_step
        0.0006103515625)";

    // Within these limits no error reaches a quarter of a period, so that the count of periods stays right.
    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_REQUIRED(m, periods, "1", "Signal periods N per revolution", 1, 1e7, true));
        visit(SW_FIELD(m, cosine_offset, "1", "Offset o_c of the cosine, relative to its amplitude", -0.25, 0.25));
        visit(SW_FIELD(m, sine_offset, "1", "Offset o_s of the sine, relative to the amplitude of the cosine", -0.25, 0.25));
        visit(SW_FIELD(m, amplitude_ratio, "1", "Amplitude r of the sine over that of the cosine", 0.5, 2));
        visit(SW_FIELD(m, quadrature_error, "rad", "Lead kappa of the sine, beyond a quarter of a period", -0.5, 0.5));
        visit(SW_FIELD(m, converter_step, "1", "Step h of the converters, relative to the amplitude of the cosine; 0 is none", 0,
                       0.05));
    }

    using State = Stateless<S>;

    constexpr S shown(const State&, const S& angle) const {
        const S phase = periods * angle;
        const SinCos<S> at = sincos(phase);
        const S cosine = at.cos + cosine_offset, sine = amplitude_ratio * sin(phase + quadrature_error) + sine_offset;
        const S smooth = angle + deviation(at, cosine, sine);
        if (!any(converter_step > S(0.0))) return smooth;
        const S stepped = angle + deviation(at, converted(cosine), converted(sine));
        if constexpr (differentiates<S>)
            return smooth + value_only(stepped - smooth);
        else
            return stepped;
    }
    constexpr State rate(const State&, const S&) const { return {}; }
    constexpr State relaxation_rate() const { return {}; }
    constexpr State steady_state(const S&) const { return {}; }

private:
    constexpr S converted(const S& track) const {
        const S step = max(converter_step, S(smallest));
        return select(converter_step > S(0.0), step * rint(track / step), track);
    }
    /// Error of the angle [rad] by which these two tracks differ from those of the true phase.
    constexpr S deviation(const SinCos<S>& at, const S& cosine, const S& sine) const {
        return atan((sine * at.cos - cosine * at.sin) / (cosine * at.cos + sine * at.sin)) / periods;
    }
};

}  // namespace strainwave::sensor
