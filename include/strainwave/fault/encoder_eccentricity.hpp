#pragma once
#include <strainwave/fault/fault.hpp>

namespace strainwave::fault {

template <class S>
struct EncoderEccentricity {
    S severity{1.0};
    Shaft shaft{Shaft::output};
    S eccentricity{1e-4};
    S phase{0.0};

    static constexpr auto name = "encoder_eccentricity";
    static constexpr auto mode = "Eccentric disc of an encoder";
    static constexpr auto effect = "the controller sees an angle with an error once per revolution";
    static constexpr auto signal = "order 1 of its own shaft in position, speed and current: order 1 of the input, or 1 / i";
    static constexpr auto source = "definition; the amount is assumed";
    static constexpr auto doc = R"(
        Encoder whose disc has moved off the centre of its shaft.

        .. math:: y \leftarrow y + s\, a \sin(x + \varphi)

        with s = severity, a = eccentricity, phi = phase, x the angle of ``shaft``. It adds as a vector to the eccentricity
        that the encoder has. At severity 1 the error has the amplitude a. The sensor must be a ``sensor.Encoder``: no other
        sensor depends on the angle of the shaft.

        >>> from strainwave.fault import EncoderEccentricity, Facts
        >>> EncoderEccentricity(severity=0.5).changes(Facts())[0][:4]
        ('sensors.output_angle', 'eccentricity', 'vector', 5e-05))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, severity, "1", "Share s of the eccentricity", 0, 1));
        visit(SW_FIELD(m, shaft, "1", "The shaft whose encoder it is"));
        visit(SW_FIELD(m, eccentricity, "rad", "Amplitude a of the error at severity 1", 0));
        visit(SW_FIELD(m, phase, "rad", "Phase phi of the error"));
    }

    template <class Visit>
    constexpr void changes(const Facts<S>&, Visit&& visit) const {
        visit(add_vector(encoder_place(shaft), "eccentricity", "eccentricity_phase", severity * eccentricity, phase, "encoder"));
    }
};

}  // namespace strainwave::fault
