#pragma once
#include <strainwave/fault/fault.hpp>

namespace strainwave::fault {

template <class S>
struct EncoderOffset {
    S severity{1.0};
    Shaft shaft{Shaft::output};
    S offset{1e-3};

    static constexpr auto name = "encoder_offset";
    static constexpr auto mode = "Offset of an encoder";
    static constexpr auto effect = "the controller sees an angle that is wrong by a constant";
    static constexpr auto signal = "difference of the two encoders at rest; constant error of position";
    static constexpr auto source = "definition; the amount is assumed";
    static constexpr auto doc = R"(
        Encoder that has slipped on its shaft, or has lost counts.

        .. math:: y \leftarrow y + s\, x_0

        with s = severity, x_0 = offset, y the angle that the controller sees of ``shaft``. At severity 1 the angle is wrong by
        x_0. A sensor without an offset of its own becomes a ``sensor.Gain`` if it is ideal. Counts lost one after the other are
        an onset: the offset grows with the revolutions.

        >>> from strainwave.fault import EncoderOffset, Facts
        >>> EncoderOffset(shaft="input", severity=0.5).changes(Facts())[0][:4]
        ('sensors.input_angle', 'offset', 'add', 0.0005))";

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, severity, "1", "Share s of the offset", 0, 1));
        visit(SW_FIELD(m, shaft, "1", "The shaft whose encoder it is"));
        visit(SW_FIELD(m, offset, "rad", "Offset x_0 at severity 1"));
    }

    template <class Visit>
    constexpr void changes(const Facts<S>&, Visit&& visit) const {
        visit(add(encoder_place(shaft), "offset", severity * offset, "gain"));
    }
};

}  // namespace strainwave::fault
