#pragma once
#include <strainwave/field.hpp>
#include <strainwave/math.hpp>

namespace strainwave {

/// Continuous part of the state of a drive. The transmission error theta_in / i - theta_out replaces the output angle.
template <class S, class MotorState, class ControlState, class SensorsState, class FrictionInputState, class FrictionMeshState,
          class FrictionOutputState, class StructureState, class MaterialState, class ThermalState, class MeterState>
struct Continuous {
    MotorState motor{};
    ControlState control{};
    SensorsState sensors{};
    S input_angle{0.0};
    S input_speed{0.0};
    S transmission_error{0.0};
    S output_speed{0.0};
    FrictionInputState friction_input{};
    FrictionMeshState friction_mesh{};
    FrictionOutputState friction_output{};
    StructureState structure{};
    MaterialState material{};
    ThermalState thermal{};
    MeterState meter{};

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, motor, "State of the motor"));
        visit(SW_PART(m, control, "State of the controller"));
        visit(SW_PART(m, sensors, "State of the sensors"));
        visit(SW_FIELD(m, input_angle, "rad", "Input angle within the turn, in [-pi, pi]"));
        visit(SW_FIELD(m, input_speed, "rad/s", "Input speed"));
        visit(SW_FIELD(m, transmission_error, "rad", "theta_in / i - theta_out"));
        visit(SW_FIELD(m, output_speed, "rad/s", "Output speed"));
        visit(SW_PART(m, friction_input, "State of the friction at the input"));
        visit(SW_PART(m, friction_mesh, "State of the friction of the mesh"));
        visit(SW_PART(m, friction_output, "State of the friction at the output"));
        visit(SW_PART(m, structure, "State of the bodies within the gear"));
        visit(SW_PART(m, material, "Torques of the material that relax"));
        visit(SW_PART(m, thermal, "Temperatures"));
        visit(SW_PART(m, meter, "Energies measured"));
    }
};

/// Discrete part of the state of a drive: it changes at instants only.
template <class S, class ControlDiscrete>
struct Discrete {
    ControlDiscrete control{};

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, control, "State of a sampled controller"));
    }
};

/// State of a drive at one instant: the motion, the discrete numbers, and the memory.
template <class S, class Continuous, class Discrete, class HysteresisState>
struct State {
    Continuous continuous{};
    Discrete discrete{};
    HysteresisState hysteresis{};
    S held_twist{0.0};
    S held_rate{0.0};
    S elapsed{0.0};
    S turns{0.0};
    S input_slip_direction{1.0};
    S output_slip_direction{1.0};

    template <class Self, class Visit>
    static constexpr void fields(Self& m, Visit&& visit) {
        visit(SW_PART(m, continuous, "Continuous part"));
        visit(SW_PART(m, discrete, "Discrete part"));
        visit(SW_PART(m, hysteresis, "Memory of the hysteresis"));
        visit(SW_FIELD(m, held_twist, "rad", "Twist at which the hysteresis was last brought up to date"));
        visit(SW_FIELD(m, held_rate, "rad/s", "Rate of the twist at that time"));
        visit(SW_FIELD(m, elapsed, "s", "Time since the hysteresis was last brought up to date"));
        visit(SW_FIELD(m, turns, "1", "Whole revolutions of the input"));
        visit(SW_FIELD(m, input_slip_direction, "1", "Slip direction of the input shaft, 0 while it sticks"));
        visit(SW_FIELD(m, output_slip_direction, "1", "Slip direction of the output shaft, 0 while it sticks"));
    }

    /// The twist at which it turned round since it was held, now at `twist` [rad] with `twist_rate` [rad/s]: where Hermite's cubic
    /// through both ends is steepest to neither side.
    constexpr S turning_point(const S& twist, const S& twist_rate) const {
        const S begin = held_rate * elapsed, end = twist_rate * elapsed, moved = twist - held_twist;
        const S sense = sign(begin), bend = S(3.0) * (begin + end - S(2.0) * moved);
        const S slope = S(2.0) * (S(3.0) * moved - S(2.0) * begin - end);
        const S root = sqrt(max(slope * slope - S(4.0) * bend * begin, S(0.0)));
        // The smaller root of the cubic's slope, or the larger one: of each the form that subtracts nothing.
        const auto grows = sense * slope > S(0.0);
        const S at = select(grows, root + sense * slope, S(2.0) * abs(begin)) /
                     max(select(grows, S(-2.0) * sense * bend, root - sense * slope), S(smallest));
        return held_twist + at * (begin + at * (S(0.5) * slope + at * bend * S(1.0 / 3.0)));
    }
};

}  // namespace strainwave
