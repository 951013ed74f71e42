// The functions of FMI 3.0 for co-simulation.
#include "fmi3Functions.h"
#include "model.hpp"

#define SW_FMI(name) fmi3##name
#define SW_FMI_STATE(verb) fmi3##verb##FMUState
#define SW_TOKEN "the instantiation token"

namespace {

using Handle = fmi3Instance;
using Status = fmi3Status;

struct Instance {
    fmi3LogMessageCallback logger;
    fmi3InstanceEnvironment environment;
    fmu::Model model{};
};
void log(const Instance& instance, const char* text) {
    if (instance.logger) instance.logger(instance.environment, fmi3Error, "logStatusError", text);
}

constexpr auto no_clocks = "this FMU has no clocks";

}  // namespace

#include "functions.hpp"

// Get and set functions of the types that no variable has.
#define SW_NO_VARIABLES(Type)                                                                        \
    fmi3Status fmi3Get##Type(fmi3Instance c, References, size_t count, fmi3##Type[], size_t) {       \
        return count == 0 ? fmi3OK : unsupported(c, "this FMU has no variables of type " #Type);     \
    }                                                                                                \
    fmi3Status fmi3Set##Type(fmi3Instance c, References, size_t count, const fmi3##Type[], size_t) { \
        return count == 0 ? fmi3OK : unsupported(c, "this FMU has no variables of type " #Type);     \
    }

extern "C" {

const char* fmi3GetVersion(void) { return fmi3Version; }
fmi3Status fmi3SetDebugLogging(fmi3Instance, fmi3Boolean, size_t, const fmi3String[]) { return fmi3OK; }

fmi3Instance fmi3InstantiateCoSimulation(fmi3String, fmi3String token, fmi3String, fmi3Boolean, fmi3Boolean, fmi3Boolean,
                                         fmi3Boolean, References, size_t, fmi3InstanceEnvironment environment,
                                         fmi3LogMessageCallback logger, fmi3IntermediateUpdateCallback) {
    return instantiated({logger, environment}, token, false);
}
fmi3Instance fmi3InstantiateModelExchange(fmi3String, fmi3String token, fmi3String, fmi3Boolean, fmi3Boolean,
                                          fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger) {
    return instantiated({logger, environment}, token, true);
}
fmi3Instance fmi3InstantiateScheduledExecution(fmi3String, fmi3String, fmi3String, fmi3Boolean, fmi3Boolean,
                                               fmi3InstanceEnvironment environment, fmi3LogMessageCallback logger,
                                               fmi3ClockUpdateCallback, fmi3LockPreemptionCallback, fmi3UnlockPreemptionCallback) {
    log({logger, environment}, "this FMU has no scheduled execution");
    return nullptr;
}

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean, fmi3Float64, fmi3Float64 start, fmi3Boolean, fmi3Float64) {
    model_of(c).start_at(start);
    model_of(c).enter(fmu::Phase::initialising);
    return fmi3OK;
}
fmi3Status fmi3EnterEventMode(fmi3Instance c) {
    return model_of(c).is_exchanged() ? fmi3OK : unsupported(c, "this FMU has no event mode");
}

fmi3Status fmi3GetFloat64(fmi3Instance c, References vr, size_t count, fmi3Float64 values[], size_t value_count) {
    if (count != value_count) return unsupported(c, "every variable of this FMU has one value");
    return got(c, vr, count, values);
}
fmi3Status fmi3SetFloat64(fmi3Instance c, References vr, size_t count, const fmi3Float64 values[], size_t value_count) {
    if (count != value_count) return unsupported(c, "every variable of this FMU has one value");
    return put(c, vr, count, values);
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

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance, fmi3FMUState, size_t* size) {
    *size = serialised_size;
    return fmi3OK;
}
fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte bytes[], size_t size, fmi3FMUState* state) {
    return deserialised(c, bytes, size, state);
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
fmi3Status fmi3GetShiftFraction(fmi3Instance c, References, size_t, fmi3UInt64[], fmi3UInt64[]) {
    return unsupported(c, no_clocks);
}
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
    *event = *terminate = *early = fmi3False;
    const Status status = stepped(c, time, length);
    model_of(c).get(0, *last);
    return status;
}
fmi3Status fmi3ActivateModelPartition(fmi3Instance c, fmi3ValueReference, fmi3Float64) { return unsupported(c, no_clocks); }

fmi3Status fmi3GetContinuousStateDerivatives(fmi3Instance c, fmi3Float64 derivatives[], size_t) {
    model_of(c).get_derivatives(derivatives);
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
