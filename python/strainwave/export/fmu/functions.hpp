// Functions that the versions of FMI have in common. Before it come Handle, Status, SW_FMI(name) for a name of the version,
// SW_FMI_STATE(verb) for one that ends in FMUstate, SW_TOKEN for what it calls the token, Instance with a model, and
// log(instance, text) of an error.
#pragma once
#include <new>

namespace {

constexpr auto wrong_kind = "this instance is for model exchange, which has no communication steps";
constexpr auto no_memory = "there is no memory left";
constexpr size_t serialised_size = sizeof fmu::token + fmu::Model::state_size;
using References = const uint32_t[];

fmu::Model& model_of(Handle c) { return static_cast<Instance*>(c)->model; }
Status checked(Handle c, bool done) {
    if (done) return SW_FMI(OK);
    log(*static_cast<Instance*>(c), model_of(c).message);
    return SW_FMI(Error);
}
Status unsupported(Handle c, const char* what) { return checked(c, model_of(c).fail("%s", what)); }

// A new instance of the same members; null with an error in the log of `members` if there cannot be one.
Instance* instantiated(const Instance& members, const char* token, bool is_model_exchange) {
    const bool is_of_this = token && strcmp(token, fmu::token) == 0;
    void* const memory = is_of_this ? malloc(sizeof(Instance)) : nullptr;
    if (!memory) {
        log(members, is_of_this ? no_memory : SW_TOKEN " differs from that of modelDescription.xml");
        return nullptr;
    }
    auto* const instance = new (memory) Instance(members);
    if (is_model_exchange) instance->model.exchange();
    return instance;
}
Status got(Handle c, References vr, size_t count, double values[]) {
    for (size_t i = 0; i < count; ++i)
        if (!model_of(c).get(vr[i], values[i])) return checked(c, false);
    return SW_FMI(OK);
}
Status put(Handle c, References vr, size_t count, const double values[]) {
    for (size_t i = 0; i < count; ++i)
        if (!model_of(c).set(vr[i], values[i])) return checked(c, false);
    return SW_FMI(OK);
}
Status stepped(Handle c, double time, double length) {
    if (model_of(c).is_exchanged()) return unsupported(c, wrong_kind);
    if (model_of(c).phase() != fmu::Phase::stepping) return unsupported(c, "a step needs an FMU that was initialised");
    return checked(c, model_of(c).step(time, length));
}
Status made_room(Handle c, void** state) {
    if (!*state) *state = malloc(fmu::Model::state_size);
    return *state ? SW_FMI(OK) : unsupported(c, no_memory);
}
Status deserialised(Handle c, const SW_FMI(Byte) bytes[], size_t size, void** state) {
    if (size != serialised_size || memcmp(bytes, fmu::token, sizeof fmu::token) != 0)
        return unsupported(c, "the bytes are not a state of this FMU");
    const Status status = made_room(c, state);
    if (status == SW_FMI(OK)) memcpy(*state, bytes + sizeof fmu::token, fmu::Model::state_size);
    return status;
}

}  // namespace

extern "C" {

void SW_FMI(FreeInstance)(Handle c) { free(c); }
Status SW_FMI(ExitInitializationMode)(Handle c) {
    const bool done = model_of(c).prepare();
    if (model_of(c).is_exchanged()) model_of(c).begin_exchange();
    model_of(c).enter(done ? fmu::Phase::stepping : fmu::Phase::failed);
    return checked(c, done);
}
Status SW_FMI(Terminate)(Handle c) {
    model_of(c).enter(fmu::Phase::ended);
    return SW_FMI(OK);
}
Status SW_FMI(Reset)(Handle c) {
    model_of(c).reset();
    return SW_FMI(OK);
}

Status SW_FMI_STATE(Get)(Handle c, void** state) {
    const Status status = made_room(c, state);
    if (status == SW_FMI(OK)) model_of(c).save(*state);
    return status;
}
Status SW_FMI_STATE(Set)(Handle c, void* state) {
    model_of(c).restore(state);
    return SW_FMI(OK);
}
Status SW_FMI_STATE(Free)(Handle, void** state) {
    if (state) {
        free(*state);
        *state = nullptr;
    }
    return SW_FMI(OK);
}
Status SW_FMI_STATE(Serialize)(Handle c, void* state, SW_FMI(Byte) bytes[], size_t size) {
    if (size < serialised_size) return unsupported(c, "the array for the state is too short");
    memcpy(bytes, fmu::token, sizeof fmu::token);
    memcpy(bytes + sizeof fmu::token, state, fmu::Model::state_size);
    return SW_FMI(OK);
}

Status SW_FMI(EnterContinuousTimeMode)(Handle) { return SW_FMI(OK); }
Status SW_FMI(SetTime)(Handle c, double time) {
    model_of(c).set_time(time);
    return SW_FMI(OK);
}
Status SW_FMI(SetContinuousStates)(Handle c, const double x[], size_t count) {
    return checked(c, model_of(c).set_states(x, count));
}
Status SW_FMI(GetContinuousStates)(Handle c, double x[], size_t) {
    model_of(c).get_states(x);
    return SW_FMI(OK);
}
Status SW_FMI(CompletedIntegratorStep)(Handle c, SW_FMI(Boolean), SW_FMI(Boolean) * event, SW_FMI(Boolean) * terminate) {
    *event = model_of(c).complete();
    *terminate = false;
    return SW_FMI(OK);
}
Status SW_FMI(GetEventIndicators)(Handle c, double indicators[], size_t count) {
    if (count > 0) indicators[0] = model_of(c).event_indicator();
    return SW_FMI(OK);
}
Status SW_FMI(GetNominalsOfContinuousStates)(Handle, double nominals[], size_t count) {
    for (size_t i = 0; i < count; ++i) nominals[i] = fmu::state_nominals[i];
    return SW_FMI(OK);
}

}  // extern "C"
