#pragma once
#include <strainwave/field.hpp>

namespace strainwave {

/// Everything worth recording, at one instant.
template <class S, class MotorOutput, class ThermalOutput, class MeterOutput, class StructureOutput>
struct Output {
    S command, input_angle, input_speed, output_angle, output_speed, twist, kinematic_error, transmission_error, torque;
    S friction_input, friction_mesh, friction_output, load_torque, temperature;
    MotorOutput motor;
    ThermalOutput thermal;
    MeterOutput meter;
    StructureOutput structure;  ///< last: a drive of a type whose gear has none counts no places for it

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_FIELD(m, command, "1", "Command"));
        visit(SW_FIELD(m, input_angle, "rad", "Input angle"));
        visit(SW_FIELD(m, input_speed, "rad/s", "Input speed"));
        visit(SW_FIELD(m, output_angle, "rad", "Output angle"));
        visit(SW_FIELD(m, output_speed, "rad/s", "Output speed"));
        visit(SW_FIELD(m, twist, "rad", "Elastic twist of the gear, at the output"));
        visit(SW_FIELD(m, kinematic_error, "rad", "Pure kinematic error, at the output"));
        visit(SW_FIELD(m, transmission_error, "rad", "Total error theta_in / i - theta_out"));
        visit(SW_FIELD(m, torque, "N.m", "Torque transmitted, at the output"));
        visit(SW_FIELD(m, friction_input, "N.m", "Friction torque at the input, opposing its motion"));
        visit(SW_FIELD(m, friction_mesh, "N.m", "Friction torque of the mesh, opposing its motion, at the output's scale"));
        visit(SW_FIELD(m, friction_output, "N.m", "Friction torque at the output, opposing its motion"));
        visit(SW_FIELD(m, load_torque, "N.m", "Torque of the load, holding the output back"));
        visit(SW_FIELD(m, temperature, "K", "Temperature of the gear"));
        visit(SW_PART(m, motor, "Outputs of the motor"));
        visit(SW_PART(m, thermal, "Outputs of the thermal model"));
        visit(SW_PART(m, meter, "Outputs of the meter"));
        visit(SW_PART(m, structure, "Outputs of the bodies within the gear"));
    }
};

}  // namespace strainwave
