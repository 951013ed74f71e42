// A drive as an actuator plugin of MuJoCo. Its state is in plugin_state alone, so that MuJoCo copies, stores and resets it.
#include <dlfcn.h>
#include <mujoco/mujoco.h>
#ifdef __APPLE__
#include <mach-o/dyld.h>
#else
#include <link.h>
#endif

#include "coupled.hpp"

namespace {

using coupled::Shaft;

thread_local coupled::Stepper stepper;  // has no state from call to call
void (*warn)(const char*, ...);
const char* (*config)(const mjModel*, int, const char*);
const char* const attributes[] = {"command"};

// Functions of the MuJoCo that loads this library, whatever its version. With a library of one version as a dependency, the linker
// of the system would refuse others in its own words.
void* mujoco_library() {
    const char* name = nullptr;
#ifdef __APPLE__
    for (uint32_t i = 0; i < _dyld_image_count() && !name; ++i)
        if (strstr(_dyld_get_image_name(i), "libmujoco")) name = _dyld_get_image_name(i);
#else
    dl_iterate_phdr(
        [](dl_phdr_info* about, size_t, void* found) {
            if (!strstr(about->dlpi_name, "libmujoco.so")) return 0;
            *static_cast<const char**>(found) = about->dlpi_name;
            return 1;
        },
        &name);
#endif
    return dlopen(name, RTLD_LAZY | RTLD_NOLOAD);
}

// The actuator of an instance, -1 if there is none.
int actuator_of(const mjModel* m, int instance) {
    for (int i = 0; i < m->nactuator; ++i)
        if (m->actuator_plugin[i] == instance) return i;
    return -1;
}

const char* actuator_name(const mjModel* m, int actuator) { return m->names + m->name_actuatoradr[actuator]; }
int joint_of(const mjModel* m, int actuator) { return m->actuator_trnid[2 * actuator]; }

// False with a warning if the timestep is unstable.
bool is_stable(const mjModel* m, int actuator) {
    const double inertia = 1.0 / m->dof_invweight0[m->jnt_dofadr[joint_of(m, actuator)]];
    const double longest = coupled::max_timestep(inertia);
    if (m->opt.timestep <= longest) return true;
    const double stated = 0.95 * longest;  // whose two digits are no longer step
    warn("actuator %s: the timestep of %g s is unstable for a gear of %.4g N.m/rad before %.4g kg.m2; set %.2g s or less",
         actuator_name(m, actuator), m->opt.timestep, coupled::stiffness, inertia, stated);
    return false;
}

int init(const mjModel* m, mjData*, int instance) {
    const int actuator = actuator_of(m, instance);
    if (actuator < 0) {
        warn("%s: no actuator has this instance", coupled::plugin_name);
        return -1;
    }
    const char* name = actuator_name(m, actuator);
    const int joint = joint_of(m, actuator);
    if (m->actuator_trntype[actuator] != mjTRN_JOINT || m->jnt_type[joint] != mjJNT_HINGE ||
        m->actuator_gear[6 * actuator] != 1.0) {
        warn("actuator %s: a gear turns a hinge, with gear=\"1\"", name);
        return -1;
    }
    const double dry = m->dof_frictionloss[m->jnt_dofadr[joint]];
    if (dry < coupled::hold * (1.0 - 1e-9)) {
        warn("actuator %s: joint %s has the frictionloss %g; the output of this gear needs %g or more", name,
             m->names + m->name_jntadr[joint], dry, coupled::hold);
        return -1;
    }
    const char* way = config(m, instance, attributes[0]);
    if (!coupled::same(way, "held") && !coupled::same(way, "followed")) {
        warn("actuator %s: command is \"%s\"; give \"held\" or \"followed\"", name, way);
        return -1;
    }
    return is_stable(m, actuator) ? 0 : -1;
}

// The rate of the command: none if it is held within a step, that of the last step if a trajectory is followed.
double command_rate(const mjModel* m, int instance, double command, const mjtNum* state) {
    if (!coupled::same(config(m, instance, attributes[0]), "followed")) return 0.0;
    return (command - state[coupled::command_before]) / m->opt.timestep;
}

void reset(const mjModel*, mjtNum* state, void*, int) { memset(state, 0, coupled::state_size * sizeof *state); }

void compute(const mjModel* m, mjData* d, int instance, int) {
    const int actuator = actuator_of(m, instance), joint = joint_of(m, actuator);
    mjtNum* state = d->plugin_state + m->plugin_stateadr[instance];
    const double command = d->ctrl[m->actuator_ctrladr[actuator]], rate = command_rate(m, instance, command, state);
    const Shaft shaft{d->qpos[m->jnt_qposadr[joint]], d->qvel[m->jnt_dofadr[joint]], command};
    double& force = d->actuator_force[m->actuator_outadr[actuator]];
    force = NAN;  // after a failure; MuJoCo then resets the simulation, by its own rule
    if (!is_stable(m, actuator)) return;
    const double step = d->time - state[coupled::reached];
    const bool begins = state[coupled::taken] == 0.0;
    const bool is_ahead = !begins && step > 1e-9 * m->opt.timestep && step < 2.0 * m->opt.timestep;  // a stage of Runge and Kutta
    double ahead[coupled::state_size];
    if ((begins && !stepper.begin(d->time, shaft, state)) ||
        (is_ahead && !stepper.advance(state, shaft.angle, command, rate, step, ahead)) ||
        !stepper.torque(is_ahead ? ahead : state, shaft, force)) {
        force = NAN;
        warn("actuator %s: %s", actuator_name(m, actuator), stepper.message());
    }
}

void advance(const mjModel* m, mjData* d, int instance) {
    const int actuator = actuator_of(m, instance), joint = joint_of(m, actuator);
    mjtNum* state = d->plugin_state + m->plugin_stateadr[instance];
    const double angle = d->qpos[m->jnt_qposadr[joint]], command = d->ctrl[m->actuator_ctrladr[actuator]];
    const double rate = command_rate(m, instance, command, state);
    if (stepper.advance(state, angle, command, rate, m->opt.timestep, state)) {
        state[coupled::reached] = d->time;
        return;
    }
    warn("actuator %s: %s", actuator_name(m, actuator), stepper.message());
    for (int i = 0; i < coupled::state_size; ++i) state[i] = NAN;
}

}  // namespace

mjPLUGIN_LIB_INIT(strainwave_drive) {
    void* library = mujoco_library();
    const auto version = reinterpret_cast<int (*)()>(dlsym(library, "mj_version"));
    const auto add = reinterpret_cast<int (*)(const mjpPlugin*)>(dlsym(library, "mjp_registerPlugin"));
    warn = reinterpret_cast<decltype(warn)>(dlsym(library, "mju_warning"));
    config = reinterpret_cast<decltype(config)>(dlsym(library, "mj_getPluginConfig"));
    const int found = version ? version() : 0;
    if (found != mjVERSION_HEADER || !add || !warn || !config) {
        fprintf(stderr, "%s: compiled for MuJoCo %d.%d.%d, and loaded by %d.%d.%d; export it again with that version installed\n",
                coupled::plugin_name, mjVERSION_HEADER / 1000000, mjVERSION_HEADER / 1000 % 1000, mjVERSION_HEADER % 1000,
                found / 1000000, found / 1000 % 1000, found % 1000);
        return;
    }
    static mjpPlugin plugin{};
    plugin.name = coupled::plugin_name;
    plugin.nattribute = sizeof attributes / sizeof *attributes;
    plugin.attributes = attributes;
    plugin.capabilityflags = mjPLUGIN_ACTUATOR;
    plugin.nstate = [](const mjModel*, int) { return coupled::state_size; };
    plugin.init = init;
    plugin.reset = reset;
    plugin.compute = compute;
    plugin.advance = advance;
    add(&plugin);
}
