/* The generated controller in the joint of another program, whose control line becomes a call of `controlled`. Encoders as that
   program records them; the input speed is the difference of two readings. ZERO is the reading of the motor encoder at rest [rad]. */
#include <math.h>

#include "controller.h"

#define TURN 6.283185307179586
#define PERIOD 5e-4

static double read_encoder(double angle, double count) { return rint(angle / count) * count; }

static double controlled(double ref, double rate, double th, double q, double current) {
    static controller_state state;
    static double before;
    static int begun;
    const double motor = read_encoder(th + ZERO, TURN / 16384);
    if (!begun) {
        controller_start(&state);
        before = motor;
        begun = 1;
    }
    const controller_inputs in = {
        .command = ref - ZERO / 80,
        .command_rate = rate,
        .input_angle = motor,
        .input_speed = (motor - before) / PERIOD,
        .output_angle = read_encoder(q - ZERO / 80, TURN / 524288),
        .current = current,
        .low = -48,
        .high = 48,
    };
    before = motor;
    return controller_step(&state, &in).voltage;
}
