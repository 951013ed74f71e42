// The functions of FMI 3.0 for co-simulation.
#include "fmi3Functions.h"
#include "model.hpp"

#include <new>

namespace {

struct Instance {
    fmu::Model model;
    fmi3LogMessageCallback logger;
    fmi3InstanceEnvironment environment;
};

constexpr auto wrong_kind = "this instance is for model exchange, which has no communication steps";
constexpr auto no_clocked_execution = "this FMU has no scheduled execution";
constexpr auto wrong_token = "the instantiation token differs from that of modelDescription.xml";
constexpr auto no_clocks = "this FMU has no clocks";

fmu::Model& model_of(fmi3Instance c) { return static_cast<Instance*>(c)->model; }

fmi3Status checked(fmi3Instance c, bool done) {
    if (done) return fmi3OK;
    const Instance& instance = *static_cast<Instance*>(c);
    if (instance.logger) instance.logger(instance.environment, fmi3Error, "logStatusError", instance.model.message);
    return fmi3Error;
}
fmi3Status unsupported(fmi3Instance c, const char* what) { return checked(c, model_of(c).fail("%s", what)); }
fmi3Instance refused(fmi3LogMessageCallback logger, fmi3InstanceEnvironment environment, const char* why) {
    if (logger) logger(environment, fmi3Error, "logStatusError", why);
    return nullptr;
}
fmi3Instance instantiated(bool is_model_exchange, fmi3String token, fmi3LogMessageCallback logger,
                          fmi3InstanceEnvironment environment) {
    if (!token || strcmp(token, fmu::token) != 0) return refused(logger, environment, wrong_token);
    void* const memory = malloc(sizeof(Instance));
    if (!memory) return refused(logger, environment, "there is no memory left");
    auto* const instance = new (memory) Instance{{}, logger, environment};
    if (is_model_exchange) instance->model.exchange();
    return instance;
}

}  // namespace

using References = const fmi3ValueReference[];

// Get and set functions of the types that no variable has.
#define SW_NO_VARIABLES(Type)                                                                             \
    fmi3Status fmi3Get##Type(fmi3Instance c, References, size_t count, fmi3##Type[], size_t) {            \
        return count == 0 ? fmi3OK : unsupported(c, "this FMU has no variables of type " #Type);          \
    }                                                                                                     \
    fmi3Status fmi3Set##Type(fmi3Instance c, References, size_t count, const fmi3##Type[], size_t) {      \
        return count == 0 ? fmi3OK : unsupported(c, "this FMU has no variables of type " #Type);          \
    }

extern "C" {

const char* fmi3GetVersion(void) { return fmi3Version; }
fmi3Status fmi3SetDebugLogging(fmi3Instance, fmi3Boolean, size_t, const fmi3String[]) { return fmi3OK; }

fmi3Instance fmi3InstantiateCoSimulation(fmi3String, fmi3String token, fmi3String, fmi3Boolean, fmi3Boolean, fmi3Boolean,
                                         fmi3Boolean, References, size_t, fmi3InstanceEnvironment environment,
                                         fmi3LogMessageCallback logger, fmi3IntermediateUpdateCallback) {
    return instantiated(false, token, logger, environment);
}
fmi3Instance fmi3InstantiateModelExchange(fmi3String, fmi3String token, fmi3String, fmi3Boolean, fmi3Boolean,
                                          fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger) {
    return instantiated(true, token, logger, environment);
}
fmi3Instance fmi3InstantiateScheduledExecution(fmi3String, fmi3String, fmi3String, fmi3Boolean, fmi3Boolean,
                                               fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
                                               fmi3ClockUpdateCallback, fmi3LockPreemptionCallback, fmi3UnlockPreemptionCallback) {
    return refused(logger, environment, no_clocked_execution);
}
void fmi3FreeInstance(fmi3Instance c) { free(c); }

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean, fmi3Float64, fmi3Float64 start, fmi3Boolean, fmi3Float64) {
    model_of(c).start_at(start);
    model_of(c).enter(fmu::Phase::initialising);
    return fmi3OK;
}
fmi3Status fmi3ExitInitializationMode(fmi3Instance c) {
    const bool done = model_of(c).prepare();
    if (model_of(c).is_exchanged()) model_of(c).begin_exchange();
    model_of(c).enter(done ? fmu::Phase::stepping : fmu::Phase::failed);
    return checked(c, done);
}
fmi3Status fmi3EnterEventMode(fmi3Instance c) {
    return model_of(c).is_exchanged() ? fmi3OK : unsupported(c, "this FMU has no event mode");
}
fmi3Status fmi3Terminate(fmi3Instance c) {
    model_of(c).enter(fmu::Phase::ended);
    return fmi3OK;
}
fmi3Status fmi3Reset(fmi3Instance c) {
    model_of(c).reset();
    return fmi3OK;
}

fmi3Status fmi3GetFloat64(fmi3Instance c, References vr, size_t count, fmi3Float64 values[], size_t value_count) {
    if (count != value_count) return unsupported(c, "every variable of this FMU has one value");
    for (size_t i = 0; i < count; ++i)
        if (!model_of(c).get(vr[i], values[i])) return checked(c, false);
    return fmi3OK;
}
fmi3Status fmi3SetFloat64(fmi3Instance c, References vr, size_t count, const fmi3Float64 values[], size_t value_count) {
    if (count != value_count) return unsupported(c, "every variable of this FMU has one value");
    for (size_t i = 0; i < count; ++i)
        if (!model_of(c).set(vr[i], values[i])) return checked(c, false);
    return fmi3OK;
}
SW_NO_VARIABLES(Float32)
SW_NO_VARIABLES(Int8)
SW_NO_VARIABLES(UInt8)
SW_NO_VARIABLES(Int16)
SW_NO_VARIABLES(UInt16)
SW_NO_VARIABLES(Int32)
SW_NO_VARIABLES(UInt32)
SW_NO_VARIABLES(Int64)
SW_NO_VARIABLES(UInt64)
SW_NO_VARIABLES(Boolean)
SW_NO_VARIABLES(String)
fmi3Status fmi3GetBinary(fmi3Instance c, References, size_t count, size_t[], fmi3Binary[], size_t) {
    return count == 0 ? fmi3OK : unsupported(c, "this FMU has no variables of type Binary");
}
fmi3Status fmi3SetBinary(fmi3Instance c, References, size_t count, const size_t[], const fmi3Binary[], size_t) {
    return count == 0 ? fmi3OK : unsupported(c, "this FMU has no variables of type Binary");
}
fmi3Status fmi3GetClock(fmi3Instance c, References, size_t count, fmi3Clock[]) {
    return count == 0 ? fmi3OK : unsupported(c, no_clocks);
}
fmi3Status fmi3SetClock(fmi3Instance c, References, size_t count, const fmi3Clock[]) {
    return count == 0 ? fmi3OK : unsupported(c, no_clocks);
}
fmi3Status fmi3GetNumberOfVariableDependencies(fmi3Instance, fmi3ValueReference, size_t* count) {
    *count = 0;
    return fmi3OK;
}
fmi3Status fmi3GetVariableDependencies(fmi3Instance c, fmi3ValueReference, size_t[], fmi3ValueReference[], size_t[],
                                       fmi3DependencyKind[], size_t) {
    return unsupported(c, "this FMU has no arrays, and its dependencies are in modelDescription.xml");
}

fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState* state) {
    if (!*state) *state = malloc(fmu::Model::state_size);
    if (!*state) return unsupported(c, "there is no memory left");
    model_of(c).save(*state);
    return fmi3OK;
}
fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState state) {
    model_of(c).restore(state);
    return fmi3OK;
}
fmi3Status fmi3FreeFMUState(fmi3Instance, fmi3FMUState* state) {
    if (state) {
        free(*state);
        *state = nullptr;
    }
    return fmi3OK;
}
fmi3Status fmi3SerializedFMUStateSize(fmi3Instance, fmi3FMUState, size_t* size) {
    *size = sizeof fmu::token + fmu::Model::state_size;
    return fmi3OK;
}
fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size) {
    if (size < sizeof fmu::token + fmu::Model::state_size) return unsupported(c, "the array for the state is too short");
    memcpy(bytes, fmu::token, sizeof fmu::token);
    memcpy(bytes + sizeof fmu::token, state, fmu::Model::state_size);
    return fmi3OK;
}
fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte bytes[], size_t size, fmi3FMUState* state) {
    if (size != sizeof fmu::token + fmu::Model::state_size || memcmp(bytes, fmu::token, sizeof fmu::token) != 0)
        return unsupported(c, "the bytes are not a state of this FMU");
    if (!*state) *state = malloc(fmu::Model::state_size);
    if (!*state) return unsupported(c, "there is no memory left");
    memcpy(*state, bytes + sizeof fmu::token, fmu::Model::state_size);
    return fmi3OK;
}
fmi3Status fmi3GetDirectionalDerivative(fmi3Instance c, References unknowns, size_t unknown_count, References knowns,
                                        size_t known_count, const fmi3Float64 direction[], size_t direction_count,
                                        fmi3Float64 found[], size_t found_count) {
    if (direction_count != known_count || found_count != unknown_count)
        return unsupported(c, "every variable of this FMU has one value");
    return checked(c, model_of(c).derive(unknowns, unknown_count, knowns, known_count, direction, found));
}
fmi3Status fmi3GetAdjointDerivative(fmi3Instance c, References, size_t, References, size_t, const fmi3Float64[], size_t,
                                    fmi3Float64[], size_t) {
    return unsupported(c, "this FMU has no adjoint derivatives");
}
fmi3Status fmi3EnterConfigurationMode(fmi3Instance c) { return unsupported(c, "this FMU has no structural parameters"); }
fmi3Status fmi3ExitConfigurationMode(fmi3Instance c) { return unsupported(c, "this FMU has no structural parameters"); }

fmi3Status fmi3GetIntervalDecimal(fmi3Instance c, References, size_t, fmi3Float64[], fmi3IntervalQualifier[]) {
    return unsupported(c, no_clocks);
}
fmi3Status fmi3GetIntervalFraction(fmi3Instance c, References, size_t, fmi3UInt64[], fmi3UInt64[], fmi3IntervalQualifier[]) {
    return unsupported(c, no_clocks);
}
fmi3Status fmi3GetShiftDecimal(fmi3Instance c, References, size_t, fmi3Float64[]) { return unsupported(c, no_clocks); }
fmi3Status fmi3GetShiftFraction(fmi3Instance c, References, size_t, fmi3UInt64[], fmi3UInt64[]) { return unsupported(c, no_clocks); }
fmi3Status fmi3SetIntervalDecimal(fmi3Instance c, References, size_t, const fmi3Float64[]) { return unsupported(c, no_clocks); }
fmi3Status fmi3SetIntervalFraction(fmi3Instance c, References, size_t, const fmi3UInt64[], const fmi3UInt64[]) {
    return unsupported(c, no_clocks);
}
fmi3Status fmi3SetShiftDecimal(fmi3Instance c, References, size_t, const fmi3Float64[]) { return unsupported(c, no_clocks); }
fmi3Status fmi3SetShiftFraction(fmi3Instance c, References, size_t, const fmi3UInt64[], const fmi3UInt64[]) {
    return unsupported(c, no_clocks);
}
fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance) { return fmi3OK; }
fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean* again, fmi3Boolean* terminate, fmi3Boolean* nominals,
                                    fmi3Boolean* values, fmi3Boolean* next_defined, fmi3Float64* next) {
    if (!model_of(c).is_exchanged()) return unsupported(c, "this FMU has no event mode");
    *again = *terminate = *nominals = *values = *next_defined = fmi3False;
    const bool done = model_of(c).apply_events(*values, *next);
    *next_defined = *next < strainwave::unbounded;
    return checked(c, done);
}

fmi3Status fmi3EnterStepMode(fmi3Instance c) { return unsupported(c, "this FMU has no event mode"); }
fmi3Status fmi3GetOutputDerivatives(fmi3Instance c, References, size_t, const fmi3Int32[], fmi3Float64[], size_t) {
    return unsupported(c, "this FMU gives no derivatives of its outputs");
}
fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 time, fmi3Float64 length, fmi3Boolean, fmi3Boolean* event, fmi3Boolean* terminate,
                      fmi3Boolean* early, fmi3Float64* last) {
    if (model_of(c).is_exchanged()) return unsupported(c, wrong_kind);
    if (model_of(c).phase() != fmu::Phase::stepping) return unsupported(c, "a step needs an FMU that was initialised");
    *event = *terminate = *early = fmi3False;
    const bool done = model_of(c).step(time, length);
    model_of(c).get(0, *last);
    return checked(c, done);
}
fmi3Status fmi3ActivateModelPartition(fmi3Instance c, fmi3ValueReference, fmi3Float64) { return unsupported(c, no_clocks); }

fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance) { return fmi3OK; }
fmi3Status fmi3CompletedIntegratorStep(fmi3Instance c, fmi3Boolean, fmi3Boolean* event, fmi3Boolean* terminate) {
    *event = model_of(c).complete();
    *terminate = fmi3False;
    return fmi3OK;
}
fmi3Status fmi3SetTime(fmi3Instance c, fmi3Float64 time) {
    model_of(c).set_time(time);
    return fmi3OK;
}
fmi3Status fmi3SetContinuousStates(fmi3Instance c, const fmi3Float64 x[], size_t count) {
    return checked(c, model_of(c).set_states(x, count));
}
fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance c, fmi3Float64 derivatives[], size_t) {
    model_of(c).get_derivatives(derivatives);
    return fmi3OK;
}
fmi3Status fmi3GetEventIndicators(fmi3Instance c, fmi3Float64 indicators[], size_t count) {
    if (count > 0) indicators[0] = model_of(c).event_indicator();
    return fmi3OK;
}
fmi3Status fmi3GetContinuousStates(fmi3Instance c, fmi3Float64 x[], size_t) {
    model_of(c).get_states(x);
    return fmi3OK;
}
fmi3Status fmi3GetNominalsOfContinuousStates(fmi3Instance, fmi3Float64 nominals[], size_t count) {
    for (size_t i = 0; i < count; ++i) nominals[i] = fmu::state_nominals[i];
    return fmi3OK;
}
fmi3Status fmi3GetNumberOfEventIndicators(fmi3Instance, size_t* count) {
    *count = fmu::indicator_count;
    return fmi3OK;
}
fmi3Status fmi3GetNumberOfContinuousStates(fmi3Instance, size_t* count) {
    *count = fmu::state_count;
    return fmi3OK;
}

}  // extern "C"
