// The functions of FMI 2.0 for co-simulation.
#include "fmi2Functions.h"
#include "model.hpp"

#include <new>

namespace {

struct Instance {
    fmu::Model model;
    fmi2CallbackLogger logger;
    fmi2ComponentEnvironment environment;
    char name[64];
};

Instance& instance_of(fmi2Component c) { return *static_cast<Instance*>(c); }
fmu::Model& model_of(fmi2Component c) { return instance_of(c).model; }

void log(const Instance& instance, const char* text) {
    if (instance.logger) instance.logger(instance.environment, instance.name, fmi2Error, "logStatusError", "%s", text);
}
fmi2Status checked(fmi2Component c, bool done) {
    if (done) return fmi2OK;
    log(instance_of(c), model_of(c).message);
    return fmi2Error;
}
fmi2Status unsupported(fmi2Component c, const char* what) { return checked(c, model_of(c).fail("%s", what)); }

constexpr auto no_such_type = "all variables of this FMU are of type Real";
constexpr auto wrong_kind = "this instance is for model exchange, which has no communication steps";

}  // namespace

extern "C" {

const char* fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char* fmi2GetVersion(void) { return fmi2Version; }
fmi2Status fmi2SetDebugLogging(fmi2Component, fmi2Boolean, size_t, const fmi2String[]) { return fmi2OK; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String token, fmi2String, const fmi2CallbackFunctions* functions,
                              fmi2Boolean, fmi2Boolean) {
    const fmi2CallbackLogger logger = functions ? functions->logger : nullptr;
    const fmi2ComponentEnvironment environment = functions ? functions->componentEnvironment : nullptr;
    const char* refused = nullptr;
    if (!token || strcmp(token, fmu::token) != 0) refused = "the GUID differs from that of modelDescription.xml";
    void* const memory = refused ? nullptr : malloc(sizeof(Instance));
    if (!memory) {
        if (logger) logger(environment, name, fmi2Error, "logStatusError", "%s", refused ? refused : "there is no memory left");
        return nullptr;
    }
    auto* const instance = new (memory) Instance{{}, logger, environment, {}};
    snprintf(instance->name, sizeof instance->name, "%s", name ? name : "");
    if (type == fmi2ModelExchange) instance->model.exchange();
    return instance;
}
void fmi2FreeInstance(fmi2Component c) { free(c); }

fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean, fmi2Real, fmi2Real start, fmi2Boolean, fmi2Real) {
    model_of(c).start_at(start);
    return fmi2OK;
}
fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    model_of(c).enter(fmu::Phase::initialising);
    return fmi2OK;
}
fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    const bool done = model_of(c).prepare();
    if (model_of(c).is_exchanged()) model_of(c).begin_exchange();
    model_of(c).enter(done ? fmu::Phase::stepping : fmu::Phase::failed);
    return checked(c, done);
}
fmi2Status fmi2Terminate(fmi2Component c) {
    model_of(c).enter(fmu::Phase::ended);
    return fmi2OK;
}
fmi2Status fmi2Reset(fmi2Component c) {
    model_of(c).reset();
    return fmi2OK;
}

fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count, fmi2Real value[]) {
    for (size_t i = 0; i < count; ++i)
        if (!model_of(c).get(vr[i], value[i])) return checked(c, false);
    return fmi2OK;
}
fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count, const fmi2Real value[]) {
    for (size_t i = 0; i < count; ++i)
        if (!model_of(c).set(vr[i], value[i])) return checked(c, false);
    return fmi2OK;
}
fmi2Status fmi2GetInteger(fmi2Component c, const fmi2ValueReference[], size_t count, fmi2Integer[]) {
    return count == 0 ? fmi2OK : unsupported(c, no_such_type);
}
fmi2Status fmi2GetBoolean(fmi2Component c, const fmi2ValueReference[], size_t count, fmi2Boolean[]) {
    return count == 0 ? fmi2OK : unsupported(c, no_such_type);
}
fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference[], size_t count, fmi2String[]) {
    return count == 0 ? fmi2OK : unsupported(c, no_such_type);
}
fmi2Status fmi2SetInteger(fmi2Component c, const fmi2ValueReference[], size_t count, const fmi2Integer[]) {
    return count == 0 ? fmi2OK : unsupported(c, no_such_type);
}
fmi2Status fmi2SetBoolean(fmi2Component c, const fmi2ValueReference[], size_t count, const fmi2Boolean[]) {
    return count == 0 ? fmi2OK : unsupported(c, no_such_type);
}
fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference[], size_t count, const fmi2String[]) {
    return count == 0 ? fmi2OK : unsupported(c, no_such_type);
}

fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate* state) {
    if (!*state) *state = malloc(fmu::Model::state_size);
    if (!*state) return unsupported(c, "there is no memory left");
    model_of(c).save(*state);
    return fmi2OK;
}
fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
    model_of(c).restore(state);
    return fmi2OK;
}
fmi2Status fmi2FreeFMUstate(fmi2Component, fmi2FMUstate* state) {
    if (state) {
        free(*state);
        *state = nullptr;
    }
    return fmi2OK;
}
fmi2Status fmi2SerializedFMUstateSize(fmi2Component, fmi2FMUstate, size_t* size) {
    *size = sizeof fmu::token + fmu::Model::state_size;
    return fmi2OK;
}
fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
    if (size < sizeof fmu::token + fmu::Model::state_size) return unsupported(c, "the array for the state is too short");
    memcpy(bytes, fmu::token, sizeof fmu::token);
    memcpy(bytes + sizeof fmu::token, state, fmu::Model::state_size);
    return fmi2OK;
}
fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate* state) {
    if (size != sizeof fmu::token + fmu::Model::state_size || memcmp(bytes, fmu::token, sizeof fmu::token) != 0)
        return unsupported(c, "the bytes are not a state of this FMU");
    if (!*state) *state = malloc(fmu::Model::state_size);
    if (!*state) return unsupported(c, "there is no memory left");
    memcpy(*state, bytes + sizeof fmu::token, fmu::Model::state_size);
    return fmi2OK;
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
fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real length, fmi2Boolean) {
    if (model_of(c).is_exchanged()) return unsupported(c, wrong_kind);
    if (model_of(c).phase() != fmu::Phase::stepping) return unsupported(c, "a step needs an FMU that was initialised");
    return checked(c, model_of(c).step(time, length));
}
fmi2Status fmi2CancelStep(fmi2Component c) { return unsupported(c, "a step of this FMU cannot be cancelled"); }
fmi2Status fmi2GetStatus(fmi2Component c, const fmi2StatusKind, fmi2Status*) { return unsupported(c, "no step is pending"); }
fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real* value) {
    if (kind != fmi2LastSuccessfulTime) return unsupported(c, "no step is pending");
    return checked(c, model_of(c).get(0, *value));
}
fmi2Status fmi2GetIntegerStatus(fmi2Component c, const fmi2StatusKind, fmi2Integer*) { return unsupported(c, "no step is pending"); }
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
fmi2Status fmi2EnterContinuousTimeMode(fmi2Component) { return fmi2OK; }
fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean, fmi2Boolean* event, fmi2Boolean* terminate) {
    *event = model_of(c).complete();
    *terminate = fmi2False;
    return fmi2OK;
}
fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time) {
    model_of(c).set_time(time);
    return fmi2OK;
}
fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t count) {
    return checked(c, model_of(c).set_states(x, count));
}
fmi2Status fmi2GetDerivatives(fmi2Component c, fmi2Real derivatives[], size_t) {
    model_of(c).get_derivatives(derivatives);
    return fmi2OK;
}
fmi2Status fmi2GetEventIndicators(fmi2Component c, fmi2Real indicators[], size_t count) {
    if (count > 0) indicators[0] = model_of(c).event_indicator();
    return fmi2OK;
}
fmi2Status fmi2GetContinuousStates(fmi2Component c, fmi2Real x[], size_t) {
    model_of(c).get_states(x);
    return fmi2OK;
}
fmi2Status fmi2GetNominalsOfContinuousStates(fmi2Component, fmi2Real nominals[], size_t count) {
    for (size_t i = 0; i < count; ++i) nominals[i] = fmu::state_nominals[i];
    return fmi2OK;
}

}  // extern "C"
