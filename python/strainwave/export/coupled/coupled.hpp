// A drive whose output shaft another program moves: this gives its angle and speed, and gets the torque.
#pragma once
#include "model.hpp"

#include "coupling.hpp"  // hold, stiffness, damping; written for each drive

namespace coupled {

// Motion of the output shaft [rad, rad/s], and the command of the drive with its rate.
struct Shaft {
    double angle, speed, command, command_rate = 0.0;
};

// Numbers of a state: whether a step was taken; time, output angle and last command there; then those of the drive. All are zero
// before the begin.
enum { taken, reached, angle_there, command_before, of_drive };
inline constexpr int state_size = of_drive + fmu::Model::number_count;

constexpr bool same(const char* a, const char* b) {
    for (; *a != 0 && *a == *b; ++a) ++b;
    return *a == *b;
}
constexpr int output(const char* name) {
    for (int i = 0; i < fmu::output_count; ++i)
        if (same(fmu::output_names[i], name)) return i;
    return -1;
}
static_assert(same(fmu::names[2], "output_angle") && output("load_torque") >= 0);

// Longest stable timestep [s] of a program that moves an inertia [kg.m2] by the torque at the begin of the step, and its angle by
// the speed at the end.
inline double max_timestep(double inertia) { return (sqrt(damping * damping + 4.0 * stiffness * inertia) - damping) / stiffness; }

// Steps of a drive from numbers to numbers. It keeps nothing of one call for the next. False with a message if one fails.
class Stepper {
    fmu::Model model;

public:
    const char* message() const { return model.message; }

    // The state of a drive that begins under this motion, without twist and currents.
    bool begin(double time, const Shaft& shaft, double* state) {
        model.reset();
        model.start_at(time);
        set(shaft);
        if (!model.prepare()) return false;
        model.drop_currents();
        write(0.0, time, shaft, state);
        return true;
    }

    // The state after a step [s] at whose end the output is at `angle` [rad]. The command goes on at its rate.
    bool advance(const double* from, double angle, double command, double command_rate, double step, double* to) {
        const double time = from[reached];
        set({from[angle_there], (angle - from[angle_there]) / step, command, command_rate});
        if (!model.resume(time, from + of_drive) || !model.step(time, step)) return false;
        write(1.0, time + step, {angle, 0.0, command}, to);
        return true;
    }

    // The torque [N.m] that drives the output, with the largest that holds it at rest added against its friction: a program that
    // has dry friction of this size at the shaft takes it away again.
    bool torque(const double* state, const Shaft& shaft, double& torque) {
        set(shaft);
        if (!model.resume(state[reached], state + of_drive)) return false;
        static constexpr unsigned reference = fmu::first_output + output("load_torque");
        if (!model.get(reference, torque)) return false;
        torque += hold * double((shaft.speed > 0.0) - (shaft.speed < 0.0));
        return true;
    }

private:
    void set(const Shaft& shaft) {
        model.set(fmu::first_input, shaft.command);
        model.set(fmu::first_input + 1, shaft.command_rate);
        model.set(fmu::first_input + 2, shaft.angle);
        model.set(fmu::first_input + 3, shaft.speed);
    }
    void write(double steps, double time, const Shaft& shaft, double* state) const {
        state[taken] = steps;
        state[reached] = time;
        state[angle_there] = shaft.angle;
        state[command_before] = shaft.command;
        model.write_numbers(state + of_drive);
    }
};

}  // namespace coupled
