// A drive as an FMU, without what differs between the versions of FMI: its numbers, its state, and its steps.
#pragma once
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "contradictions.hpp"
#include "drive.hpp"  // Drive, laws, shape, parameters, channels, names; written for each drive
#include "stretches.hpp"

namespace fmu {

using strainwave::Input;
using strainwave::kernel::input_count;

using Compiled = decltype(Drive<double>{}.compile());
using Evaluation = Compiled::Evaluation;
using State = Compiled::State;

inline constexpr double max_step_rate = 1.0;     // internal step times the fastest angular frequency of the drive
inline constexpr double max_bristle_rate = 2.0;  // internal step times the angular frequency of a shaft on its bristles
inline constexpr double event_tolerance = 1e-6;  // of the internal step: how far a tool may miss an instant of sampling
inline constexpr double event_delay = 1e-9;      // rad/s of a shaft that slips, N.m of one that sticks
inline constexpr int max_events = 16;            // at one instant
inline constexpr int message_size = 512;         // characters

enum class Phase : int32_t { instantiated, initialising, stepping, failed, ended };
using Continuous = Compiled::Continuous;

// All that a state of the FMU contains, so that a copy of it is a copy of the state.
struct Content {
    Phase phase;
    bool numbers_changed, has_begun;  // whether the drive is to be made of its numbers again; whether a step was taken
    double time;
    double numbers[parameter_count];
    double inputs[input_count];
    double slopes[input_count / 2];    // of the inputs, in the next step only, as FMI 2 sets them
    bool rate_is_given;                // whether the tool has set a rate of the command
    double last_command, last_length;  // at the begin of the last step, and its length; 0 before the second
    double outputs[output_count];
    Input<double> acting;  // inputs at this instant
    Evaluation here;
    bool is_exchanged, is_on_trial;  // model exchange; whether the solver has moved away from `here`
    double reached;                  // time of `here`
    Continuous trial;                // numbers that the solver tries
};
static_assert(__is_trivially_copyable(Content));

class Model {
    Content content;
    Compiled drive;
    strainwave::integrate::Steps<double, Compiled> steps;

public:
    char message[message_size];

    Model() {
        content.is_exchanged = false;
        reset();
    }

    void reset() {
        const bool exchanged = is_exchanged();
        memset(static_cast<void*>(&content), 0, sizeof content);
        content.phase = Phase::instantiated;
        content.numbers_changed = true;
        for (int i = 0; i < parameter_count; ++i) content.numbers[i] = parameters[i].start;
        for (int i = 0; i < input_count; ++i) content.inputs[i] = input_starts[i];
        content.is_exchanged = exchanged;
        message[0] = 0;
    }
    Phase phase() const { return content.phase; }
    void enter(Phase phase) { content.phase = phase; }
    void start_at(double time) { content.time = time; }

    // Variables by their value references. False with a message if there is no such variable, or it cannot be set now.
    bool get(uint32_t reference, double& value) {
        if (reference == 0) {
            value = content.time;
        } else if (is(reference, first_input, input_count)) {
            value = content.inputs[reference - first_input];
        } else if (is(reference, first_output, output_count)) {
            if (content.phase == Phase::initialising && !prepare()) return false;
            if (content.phase == Phase::stepping && content.is_exchanged && !show_trial()) return false;
            value = content.outputs[reference - first_output];
        } else if (is(reference, first_parameter, parameter_count)) {
            value = content.numbers[reference - first_parameter];
        } else if (is(reference, first_state, 2 * state_count + 1)) {
            if (content.phase == Phase::initialising && !prepare()) return false;
            if (!content.has_begun) content.trial = content.here.state.continuous;
            double numbers[2 * state_count + 1];
            write(content.trial, numbers);
            write(tried().derivatives.rate, numbers + state_count);
            numbers[2 * state_count] = event_indicator();
            value = numbers[reference - first_state];
        } else {
            return fail("there is no variable with value reference %u", unsigned(reference));
        }
        return true;
    }
    bool set(uint32_t reference, double value) {
        if (is(reference, first_input, input_count)) {
            if (!finite(value)) return fail("%s = %g is no number", names[reference - first_input], value);
            content.inputs[reference - first_input] = value;
            content.rate_is_given |= reference == first_input + 1 && value != 0.0;
        } else if (is(reference, first_parameter, parameter_count)) {
            const Parameter& parameter = parameters[reference - first_parameter];
            if (content.phase != Phase::instantiated && content.phase != Phase::initialising)
                return fail("%s can be set before the end of the initialisation only", parameter.name);
            if (!(value >= parameter.low && value <= parameter.high))
                return fail("%s = %g %s must lie within [%g, %g]", parameter.name, value, parameter.unit, parameter.low,
                            parameter.high);
            content.numbers[reference - first_parameter] = value;
            content.numbers_changed = true;
        } else {
            return fail("the variable with value reference %u cannot be set", unsigned(reference));
        }
        return true;
    }
    // The rate of an input in the next step.
    bool set_slope(uint32_t reference, double rate) {
        if (!is(reference, first_input, input_count) || (reference - first_input) % 2 != 0)
            return fail("the variable with value reference %u has no rate that can be set", unsigned(reference));
        content.slopes[(reference - first_input) / 2] = rate;
        content.rate_is_given |= reference == first_input;
        return true;
    }

    // The drive at its begin, under the inputs of now.
    bool prepare() {
        if (content.numbers_changed && !make()) return false;
        content.numbers_changed = false;
        content.acting = at(0.0);
        if (!(content.acting.temperature > 0.0)) return fail("temperature = %g K must be positive", content.acting.temperature);
        if (!resolves()) return false;
        State state;
        if (!begin(state)) return false;
        new (&content.here) Evaluation(drive.evaluate(drive.consistent(state), content.acting));
        content.here = strainwave::system::up_to_date(drive, content.here, content.acting, 0.5 * next_instant(max_step()));
        return show("begins");
    }

    // A communication step of `length` [s].
    bool step(double time, double length) {
        const double longest = strainwave::exported::max_count * max_step();
        if (!(length >= 0.0 && length <= longest)) return fail("the step of %g s must lie within [0, %g] s", length, longest);
        content.time = time;
        const double command = content.inputs[0];
        const bool is_extrapolated = is_followed && !content.rate_is_given && content.last_length > 0.0;
        if (is_extrapolated) content.inputs[1] = (command - content.last_command) / content.last_length;
        if (!content.has_begun) {
            if (!prepare()) return false;
        } else if (const Input<double> now = at(0.0); memcmp(&now, &content.acting, sizeof now) != 0) {
            content.acting = now;
            content.here = drive.evaluate(content.here.state, now);
        }
        if (!(at(length).temperature > 0.0)) return fail("temperature = %g K must be positive", at(length).temperature);
        content.has_begun = true;
        if (length > 0.0 && !advance(length)) return false;
        content.acting = at(length);
        const auto reached = strainwave::flattened<double>(content.acting);
        for (int i = 0; i < input_count; i += 2) content.inputs[i] = reached[i];
        if (is_extrapolated) content.inputs[0] = command;  // until the tool sets another one
        for (double& slope : content.slopes) slope = 0.0;
        if (length > 0.0) {
            content.last_command = command;
            content.last_length = length;
        }
        content.time = time + length;
        return show("diverged");
    }

    // Model exchange: the solver of a tool moves the continuous numbers, this model its memory at the end of each step.

    void exchange() { content.is_exchanged = true; }
    bool is_exchanged() const { return content.is_exchanged; }
    void begin_exchange() {
        content.has_begun = true;
        content.reached = content.time;
        content.trial = content.here.state.continuous;
    }
    void set_time(double time) {
        content.time = time;
        content.is_on_trial = true;
    }
    bool set_states(const double* numbers, size_t count) {
        if (count != size_t(state_count)) return fail("the model has %d continuous states", state_count);
        auto scalars = strainwave::flattened<double>(content.trial);
        for (int i = 0; i < state_count; ++i) scalars[i] = numbers[i];
        content.trial = strainwave::refilled(content.trial, scalars);
        content.is_on_trial = true;
        return true;
    }
    void get_states(double* numbers) const { write(content.trial, numbers); }
    void get_derivatives(double* numbers) const { write(tried().derivatives.rate, numbers); }
    // Positive until a shaft has stopped or broken away. It is zero a little later, so that a solver stops behind the event.
    double event_indicator() const { return strainwave::system::event_function<double>(drive, tried()) + event_delay; }
    // The end of a step of the solver. True if a further number has changed, as an angle that is reduced to one turn.
    bool complete() {
        if (!content.is_on_trial) return false;
        State x = content.here.state;
        const auto now = tried().derivatives;
        x.continuous = strainwave::system::update_mode(drive, strainwave::system::clamped(drive, content.trial, now), now);
        strainwave::system::finish_step(drive, x, content.time - content.reached);
        content.acting = at(0.0);
        content.here = drive.evaluate(x, content.acting);
        content.reached = content.time;
        double before[state_count], after[state_count];
        write(content.trial, before);
        write(content.here.state.continuous, after);
        content.trial = content.here.state.continuous;
        content.is_on_trial = false;
        return memcmp(before, after, sizeof after) != 0;
    }
    // Derivatives of variables at this instant along a direction of others, exact to rounding: of derivatives of states, and of
    // outputs, by states and inputs. Memory and slip stay as they are.
    template <int slopes = exchanges ? 1 : 0>  // compiled for model exchange alone: it doubles the work of the compiler
    bool derive(const uint32_t* unknowns, size_t unknown_count, const uint32_t* knowns, size_t known_count, const double* direction,
                double* found) {
        if constexpr (slopes == 0) {
            return fail("this FMU has directional derivatives for model exchange only");
        } else {
            return derive_by<strainwave::Dual<slopes>>(unknowns, unknown_count, knowns, known_count, direction, found);
        }
    }
    // Events at this instant: samples, shafts that stop or break away. `next` is the time of the next sample, or infinite.
    bool apply_events(bool& has_changed, double& next) {
        double before[state_count], after[state_count];
        write(content.trial, before);
        complete();
        content.acting = at(0.0);
        auto& here = content.here;
        here = drive.evaluate(here.state, content.acting);
        const double within = event_tolerance * max_step();
        here = strainwave::system::up_to_date(drive, here, content.acting, within);
        for (int i = 0; i < max_events && strainwave::system::has_events(drive); ++i) {
            if (strainwave::system::breaks_away(drive, here))
                here = strainwave::system::break_away(drive, here, content.acting);
            else if (strainwave::system::event_function<double>(drive, here) < 0.0)
                here = drive.evaluate(strainwave::system::apply_event(drive, here, content.acting, true), content.acting);
            else
                break;
        }
        content.trial = here.state.continuous;
        content.is_on_trial = false;
        write(content.trial, after);
        has_changed = memcmp(before, after, sizeof after) != 0;
        const double never = strainwave::unbounded, instant = next_instant(never);
        next = instant < never ? content.time + instant : never;
        return (!drive.has_bounds() || is_valid(content.time)) && show("diverged");
    }

    // States, as copies.
    static constexpr size_t state_size = sizeof(Content);
    void save(void* to) const { memcpy(to, &content, sizeof content); }
    void restore(const void* from) {
        double before[parameter_count];
        memcpy(before, content.numbers, sizeof before);
        const bool was_changed = content.numbers_changed;
        memcpy(static_cast<void*>(&content), from, sizeof content);
        steps = {};
        const bool same = !was_changed && memcmp(before, content.numbers, sizeof before) == 0;
        if (!same && !content.numbers_changed) make();
    }

    // States as numbers alone, for programs that store these: the drive is as it was made, and has taken steps.

    static constexpr int number_count = strainwave::size_of<double, State>;
    void write_numbers(double* to) const {
        const auto scalars = strainwave::flattened<double>(content.here.state);
        for (int i = 0; i < number_count; ++i) to[i] = scalars[i];
    }
    // Begins without currents in the motor, as a drive at rest does, rather than with those that the command asks for.
    void drop_currents() {
        State x = content.here.state;
        x.continuous.motor = strainwave::initial_state(drive.motor);
        content.here = drive.evaluate(x, content.acting);
    }
    // The drive with these numbers, under the inputs of now.
    bool resume(double time, const double* from) {
        if (content.numbers_changed && !make()) return false;
        content.numbers_changed = false;
        content.has_begun = true;
        content.last_length = 0.0;
        content.time = time;
        content.acting = at(0.0);
        const State whole = drive.initial_state();
        auto scalars = strainwave::flattened<double>(whole);
        for (int i = 0; i < number_count; ++i) scalars[i] = from[i];
        content.here = drive.evaluate(strainwave::refilled(whole, scalars), content.acting);
        return show("continues");
    }
    bool fail(const char* format, ...) __attribute__((format(printf, 2, 3))) {
        va_list values;
        va_start(values, format);
        vsnprintf(message, sizeof message, format, values);
        va_end(values);
        return false;
    }

private:
    static bool finite(double x) { return x - x == 0.0; }
    static bool is(uint32_t reference, uint32_t first, int count) {
        return reference >= first && reference < first + uint32_t(count);
    }
    double max_step() const { return content.numbers[0]; }

    static void write(const Continuous& y, double* numbers) {
        const auto scalars = strainwave::flattened<double>(y);
        for (int i = 0; i < state_count; ++i) numbers[i] = scalars[i];
    }
    // The numbers that the solver tries, with the memory of the last step that it completed.
    Evaluation tried() const {
        State x = content.here.state;
        x.continuous = content.trial;
        return {x, drive.derivatives(content.here.state, content.trial, at(0.0))};
    }
    template <class Slope>
    bool derive_by(const uint32_t* unknowns, size_t unknown_count, const uint32_t* knowns, size_t known_count,
                   const double* direction, double* found) {
        Slope numbers[parameter_count], states[state_count];
        strainwave::Array<Slope, input_count> inputs;
        for (int i = 0; i < parameter_count; ++i) numbers[i] = content.numbers[i];
        const auto trial = strainwave::flattened<double>(content.trial);
        const auto acting = strainwave::flattened<double>(at(0.0));
        for (int i = 0; i < state_count; ++i) states[i] = trial[i];
        for (int i = 0; i < input_count; ++i) inputs[i] = acting[i];
        for (size_t i = 0; i < known_count; ++i) {
            if (is(knowns[i], first_state, state_count))
                states[knowns[i] - first_state].slope[0] += direction[i];
            else if (is(knowns[i], first_input, input_count))
                inputs[int(knowns[i] - first_input)].slope[0] += direction[i];
            else
                return fail("there is no derivative by the variable with value reference %u", unsigned(knowns[i]));
        }
        strainwave::kernel::Reader<Slope> from{laws, shape, numbers + own_parameters};
        const auto moved = strainwave::kernel::assembled<Drive<Slope>>(from).compile();
        const Differentiated at_trial = differentiated(moved, states, strainwave::shaped<Input<Slope>>(inputs));
        for (size_t i = 0; i < unknown_count; ++i) {
            if (is(unknowns[i], first_state + state_count, state_count))
                found[i] = at_trial.rates[unknowns[i] - first_state - state_count];
            else if (is(unknowns[i], first_output, output_count))
                found[i] = at_trial.outputs[unknowns[i] - first_output];
            else
                return fail("the variable with value reference %u has no derivative", unsigned(unknowns[i]));
        }
        return true;
    }
    struct Differentiated {
        double rates[state_count], outputs[output_count];
    };
    template <class Moved, class S>
    Differentiated differentiated(const Moved& moved, const S* states, const Input<S>& u) const {
        double plain[strainwave::size_of<double, State>];
        double* const end = strainwave::kernel::write(drive, content.here.state, plain);
        S numbers[strainwave::size_of<double, State>];
        for (int i = 0; i < end - plain; ++i) numbers[i] = plain[i];
        auto x = strainwave::kernel::state_of(moved, static_cast<const S*>(numbers));
        auto scalars = strainwave::flattened<S>(x.continuous);
        for (int i = 0; i < state_count; ++i) scalars[i] = states[i];
        const auto trial = strainwave::refilled(x.continuous, scalars);
        const auto now = moved.derivatives(x, trial, u);
        x.continuous = trial;
        const auto rates = strainwave::flattened<S>(now.rate);
        const auto all = strainwave::kernel::shown<S>(moved, {x, now}, u);
        const auto places = strainwave::kernel::outputs_of(moved);
        Differentiated found;
        for (int i = 0; i < state_count; ++i) found.rates[i] = rates[i].slope[0];
        for (int i = 0; i < output_count; ++i) found.outputs[i] = all[places.slot[channels[i]]].slope[0];
        return found;
    }
    bool show_trial() {
        const auto all = strainwave::kernel::shown<double>(drive, tried(), at(0.0));
        const auto places = strainwave::kernel::outputs_of(drive);
        for (int i = 0; i < output_count; ++i) content.outputs[i] = all[places.slot[channels[i]]];
        return true;
    }

    // The inputs `after` [s] from now.
    Input<double> at(double after) const {
        double numbers[input_count];
        for (int i = 0; i < input_count; i += 2) {
            const double rate = content.inputs[i + 1] + content.slopes[i / 2];
            numbers[i] = content.inputs[i] + rate * after;
            numbers[i + 1] = rate;
        }
        return strainwave::kernel::input_from<double>(numbers);
    }

    bool make() {
        strainwave::kernel::Reader<double> from{laws, shape, content.numbers + own_parameters};
        const auto model = strainwave::kernel::assembled<Drive<double>>(from);
        strainwave::exported::Contradictions found;
        found.of(model);
        if (found.text) return contradiction(found);
        drive = model.compile();
        steps = {};
        return true;
    }
    bool contradiction(const strainwave::exported::Contradictions& found) {
        const double values[] = {found.first, found.second};
        char* to = message;
        int next = 0;
        for (const char* letter = found.text; *letter != 0 && to < message + message_size - 32; ++letter) {
            if (letter[0] == '{' && letter[1] == '}') {
                to += snprintf(to, 32, "%g", values[next < 2 ? next++ : 1]);
                ++letter;
            } else {
                *to++ = *letter;
            }
        }
        *to = 0;
        return false;
    }
    bool resolves() {
        constexpr double below_rounding = 1.0 - 1e-5;  // so that the six digits of a step that is stated do not exceed it
        const double fastest = strainwave::own_motion::max_rate<double>(drive, 0.0, content.acting.temperature);
        const double bristle = strainwave::own_motion::bristle_frequency<double>(drive);
        if (fastest * max_step() > max_step_rate)
            return fail("%s = %g s is too coarse: the drive is as fast as a vibration of %g rad/s; set %g s or less",
                        parameters[0].name, max_step(), fastest, below_rounding * max_step_rate / fastest);
        if (bristle * max_step() > max_bristle_rate)
            return fail("%s = %g s is too coarse: a shaft vibrates on its bristles at %g rad/s; set %g s or less",
                        parameters[0].name, max_step(), bristle, below_rounding * max_bristle_rate / bristle);
        return true;
    }

    // The state at the begin: at rest, or with the initial quantities that are not zero.
    bool begin(State& state) {
        strainwave::initial::Known<double> known{};
        bool any = false;
        for (int i = 0; i < initial_count; ++i) {
            const double value = content.numbers[1 + i];
            if (value == 0.0) continue;
            known.set(initial_quantities[i], value);
            any = true;
        }
        if (!any && !strainwave::prescribes(drive.load)) {
            state = drive.rest();
            return true;
        }
        state = strainwave::initial::state(drive, known, content.acting);
        if (!(fabs(state.continuous.transmission_error) <= strainwave::kernel::largest))
            return fail("no state of the drive has these initial quantities; set others");
        return true;
    }

    bool advance(double length) {
        const double begin = content.time;
        return strainwave::exported::advance(
            drive, content.here, [this](double after) { return at(after); }, length, max_step(), steps,
            [this, begin](double after) { return !drive.has_bounds() || is_valid(begin + after); });
    }
    double next_instant(double limit) const {
        return strainwave::exported::next_instant(drive, content.here.state, limit, max_step());
    }
    bool is_valid(double time) {
        strainwave::kernel::Outcome outcome;
        if (strainwave::kernel::within_bounds<double>(drive, content.here, time, outcome)) return true;
        const auto& domain = outcome.domain;
        return fail("at t = %g s %s leaves its range: %s = %g %s, valid within [%g, %g]", time, outcome.part, domain.name,
                    domain.value, domain.unit, domain.low, domain.high);
    }
    bool show(const char* what) {
        const auto all = strainwave::kernel::shown<double>(drive, content.here, content.acting);
        const auto places = strainwave::kernel::outputs_of(drive);
        for (int i = 0; i < output_count; ++i) {
            const double value = all[places.slot[channels[i]]];
            if (!(fabs(value) <= strainwave::kernel::largest))
                return fail("the simulation %s at t = %g s with %s = %g; set a smaller %s or check the parameters", what,
                            content.time, output_names[i], value, parameters[0].name);
            content.outputs[i] = value;
        }
        return true;
    }
};

}  // namespace fmu
