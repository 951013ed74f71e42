#pragma once
#include <strainwave/field.hpp>

namespace strainwave::initial {

enum Quantity { input_angle, output_angle, input_speed, output_speed, twist, torque, current, quantities };

inline constexpr Field fields[quantities]{
    {"input_angle", "rad", "Input angle"},
    {"output_angle", "rad", "Output angle"},
    {"input_speed", "rad/s", "Input speed"},
    {"output_speed", "rad/s", "Output speed"},
    {"twist", "rad", "Elastic twist of the gear, at the output"},
    {"torque", "N.m", "Torque transmitted, at the output"},
    {"current", "A", "Motor current"},
};

/// Quantities, of which some are known.
template <class S>
struct Known {
    S value[quantities]{};
    bool given[quantities]{};

    constexpr bool knows(Quantity q) const { return given[q]; }
    constexpr const S& operator[](Quantity q) const { return value[q]; }
    constexpr void set(Quantity q, const S& x) {
        value[q] = x;
        given[q] = true;
    }
};

}  // namespace strainwave::initial
