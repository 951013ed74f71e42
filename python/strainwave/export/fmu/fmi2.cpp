// The functions of FMI 2.0 for co-simulation.
#include "fmi2Functions.h"
#include "model.hpp"

#define SW_FMI(name) fmi2##name
#define SW_FMI_STATE(verb) fmi2##verb##FMUstate
#define SW_TOKEN "the GUID"

namespace {

using Handle = fmi2Component;
using Status = fmi2Status;

struct Instance {
    fmi2CallbackLogger logger;
    fmi2ComponentEnvironment environment;
    char name[64];
    fmu::Model model{};
};
void log(const Instance& instance, const char* text) {
    if (instance.logger) instance.logger(instance.environment, instance.name, fmi2Error, "logStatusError", "%s", text);
}

}  // namespace

#include "functions.hpp"

// Get and set functions of the types that no variable has.
#define SW_NO_VARIABLES(Type)                                                                      \
    fmi2Status fmi2Get##Type(fmi2Component c, References, size_t count, fmi2##Type[]) {            \
        return count == 0 ? fmi2OK : unsupported(c, "all variables of this FMU are of type Real"); \
    }                                                                                              \
    fmi2Status fmi2Set##Type(fmi2Component c, References, size_t count, const fmi2##Type[]) {      \
        return count == 0 ? fmi2OK : unsupported(c, "all variables of this FMU are of type Real"); \
    }

extern "C" {

const char* fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char* fmi2GetVersion(void) { return fmi2Version; }
fmi2Status fmi2SetDebugLogging(fmi2Component, fmi2Boolean, size_t, const fmi2String[]) { return fmi2OK; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String token, fmi2String, const fmi2CallbackFunctions* functions,
                              fmi2Boolean, fmi2Boolean) {
    Instance members{functions ? functions->logger : nullptr, functions ? functions->componentEnvironment : nullptr, {}};
    snprintf(members.name, sizeof members.name, "%s", name ? name : "");
    return instantiated(members, token, type == fmi2ModelExchange);
}

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean, fmi2Real, fmi2Real start, fmi2Boolean, fmi2Real) {
    model_of(c).start_at(start);
    return fmi2OK;
}
fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    model_of(c).enter(fmu::Phase::initialising);
    return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count, fmi2Real value[]) {
    return got(c, vr, count, value);
}
fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count, const fmi2Real value[]) {
    return put(c, vr, count, value);
}
SW_NO_VARIABLES(Integer)
SW_NO_VARIABLES(Boolean)
SW_NO_VARIABLES(String)

fmi2Status fmi2SerializedFMUstateSize(fmi2Component, fmi2FMUstate, size_t* size) {
    *size = serialised_size;
    return fmi2OK;
}
fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate* state) {
    return deserialised(c, bytes, size, state);
}
fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknowns[], size_t unknown_count,
                                        const fmi2ValueReference knowns[], size_t known_count, const fmi2Real direction[],
                                        fmi2Real found[]) {
    return checked(c, model_of(c).derive(unknowns, unknown_count, knowns, known_count, direction, found));
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t count, const fmi2Integer order[],
                                       const fmi2Real value[]) {
    for (size_t i = 0; i < count; ++i) {
        if (order[i] != 1) return unsupported(c, "inputs have derivatives of first order only");
        if (!model_of(c).set_slope(vr[i], value[i])) return checked(c, false);
    }
    return fmi2OK;
}
fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference[], size_t, const fmi2Integer[], fmi2Real[]) {
    return unsupported(c, "this FMU gives no derivatives of its outputs");
}
fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real length, fmi2Boolean) { return stepped(c, time, length); }
fmi2Status fmi2CancelStep(fmi2Component c) { return unsupported(c, "a step of this FMU cannot be cancelled"); }
fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind, fmi2Status*) { return unsupported(c, "no step is pending"); }
fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real* value) {
    if (kind != fmi2LastSuccessfulTime) return unsupported(c, "no step is pending");
    return checked(c, model_of(c).get(0, *value));
}
fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind, fmi2Integer*) {
    return unsupported(c, "no step is pending");
}
fmi2Status fmi2GetBooleanStatus(fmi2Component, const fmi2StatusKind, fmi2Boolean* value) {
    *value = fmi2False;
    return fmi2OK;
}
fmi2Status fmi2GetStringStatus(fmi2Component c, const fmi2StatusKind, fmi2String*) { return unsupported(c, "no step is pending"); }

fmi2Status fmi2EnterEventMode(fmi2Component) { return fmi2OK; }
fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo* info) {
    bool has_changed = false;
    double next = 0.0;
    const bool done = model_of(c).apply_events(has_changed, next);
    *info = {fmi2False, fmi2False, fmi2False, has_changed, next < strainwave::unbounded, next};
    return checked(c, done);
}
fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real derivatives[], size_t) {
    model_of(c).get_derivatives(derivatives);
    return fmi2OK;
}

}  // extern "C"
