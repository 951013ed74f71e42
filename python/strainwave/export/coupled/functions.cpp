// A drive as functions in C, for programs that call these at the instants of a period.
#include "coupled.hpp"

namespace {

struct Instance {
    coupled::Stepper stepper;
    double state[coupled::state_size];
    double command, command_rate;  // since the last call
    bool has_begun;
};

}  // namespace

#define SW_EXPORT extern "C" __attribute__((visibility("default")))

SW_EXPORT void* SW_NAME(open)(void) {
    void* memory = malloc(sizeof(Instance));
    return memory ? new (memory) Instance{} : nullptr;
}

SW_EXPORT void SW_NAME(close)(void* drive) { free(drive); }

SW_EXPORT void SW_NAME(torque)(void* drive, double time, double angle, double speed, double command, double command_rate,
                               double period, double* torque, double* torque_rate) {
    *torque = *torque_rate = NAN;
    if (!drive) return;
    Instance& of = *static_cast<Instance*>(drive);
    const double step = time - of.state[coupled::reached];
    bool works = true;
    if (fmu::is_followed && command_rate == 0.0 && of.has_begun && step > 0.0) command_rate = (command - of.command) / step;
    const coupled::Shaft now{angle, speed, command, command_rate};
    const coupled::Shaft then{angle + speed * period, speed, command + command_rate * period, command_rate};
    if (!of.has_begun)
        works = of.stepper.begin(time, now, of.state);
    else if (step > 0.0)
        works = of.stepper.advance(of.state, angle, of.command, of.command_rate, step, of.state);
    of.has_begun = true;
    of.command = command;
    of.command_rate = command_rate;
    double ahead[coupled::state_size], next = NAN;
    works = works && of.stepper.torque(of.state, now, *torque) &&
            of.stepper.advance(of.state, then.angle, command, command_rate, period, ahead) && of.stepper.torque(ahead, then, next);
    *torque_rate = (next - *torque) / period;
    if (!works) fprintf(stderr, "%s: %s\n", coupled::plugin_name, of.stepper.message());
}
