"""Texts of firmware: the C++ header with all that a step needs, the header in C, and the source that joins both."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from strainwave.export import cplusplus
from strainwave.export.firmware.step import Member, StepFunction
from strainwave.export.host import DEFAULT_STEP
from strainwave.native.static_type import short_name, static_type

FLAGS = "-std=c++20 -O2 -ffreestanding -ffp-contract=off -fno-exceptions -fno-rtti"
OWN_HEADERS = ("strainwave/compiled.hpp", "strainwave/field.hpp")


def texts(step: StepFunction, name: str, scalar: str) -> dict[str, str]:
    """Return the files of a step by name."""
    return {
        f"{name}.hpp": _cplusplus(step, name, scalar),
        f"{name}.h": _c(step, name, scalar),
        f"{name}.cpp": _joint(name),
        f"{name}_main.c": _example(step, name, scalar),
    }


def _about(step: StepFunction) -> str:
    model = f"{step.words}: {short_name(step.model)}" if step.words.startswith("a law") else step.words
    return f"{model}{_every(step)}"


def _every(step: StepFunction) -> str:
    return f" every {step.period!r} s" if step.period else ""


def _members(members: Iterable[Member], scalar: str, comment: str) -> str:
    return "".join(
        f"    {scalar} {each.name}{f'[{len(each.start)}]' if each.is_array else ''};  "
        + comment.format("; ".join(filter(None, (each.unit, each.doc))) or "-")
        + "\n"
        for each in members
    )


def _c(step: StepFunction, name: str, scalar: str) -> str:
    """Return the declarations in C."""
    members = {"inputs": step.inputs, "state": step.state, "outputs": step.outputs}
    structs = "\n".join(
        f"typedef struct {{\n{_members(each, scalar, '/* {} */')}}} {name}_{kind};\n" for kind, each in members.items()
    )
    return f"""/* {name}: {_about(step)}. Compile {name}.cpp by GCC 12, Clang 14 or later:

       c++ {FLAGS} -c {name}.cpp

   Call {name}_start once, then {name}_step{_every(step)}. Several of them: a state for each. */
#ifndef {name.upper()}_H
#define {name.upper()}_H
#ifdef __cplusplus
extern "C" {{
#endif

{structs}
void {name}_start({name}_state* state);

/* Return the outputs at this instant, and move the state on to the next. */
{name}_outputs {name}_step({name}_state* state, const {name}_inputs* in);

#ifdef __cplusplus
}}
#endif
#endif
"""


def _example(step: StepFunction, name: str, scalar: str) -> str:
    """Return a program in C that calls the step from the system timer of a Cortex-M."""
    values = "".join(f"        .{each.name} = ({scalar}){each.start[0]!r}, /* {each.unit or '-'} */\n" for each in step.inputs)
    every = step.period or DEFAULT_STEP
    return f"""/* An example: {name}_step in the interrupt of the system timer of a Cortex-M, every {every!r} s.
   Replace `read_inputs`, `apply` and CORE_CLOCK by those of the board. The order of the calls: {name}_start once, before the
   timer runs; then, in each interrupt, the inputs of this instant, {name}_step, and its outputs at once.

       arm-none-eabi-gcc -std=c99 -O2 -mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16 -c {name}_main.c */
#include "{name}.h"

#define CORE_CLOCK 168000000u /* Hz */
#define PERIOD {every!r} /* s */
#define TIMER_CONTROL (*(volatile unsigned long*)0xE000E010)
#define TIMER_RELOAD (*(volatile unsigned long*)0xE000E014)
#define TIMER_VALUE (*(volatile unsigned long*)0xE000E018)
#define FLOATING_POINT_ACCESS (*(volatile unsigned long*)0xE000ED88)

static {name}_state state; /* one for each motor */
static volatile {name}_outputs latest;

static {name}_inputs read_inputs(void) {{
    const {name}_inputs in = {{
{values}    }};
    return in;
}}

static void apply(const {name}_outputs* out) {{ latest = *out; }}

void SysTick_Handler(void);
void SysTick_Handler(void) {{
    const {name}_inputs in = read_inputs();
    const {name}_outputs out = {name}_step(&state, &in);
    apply(&out);
}}

int main(void) {{
    FLOATING_POINT_ACCESS |= 0xFul << 20; /* before any number with a point */
    {name}_start(&state);
    TIMER_RELOAD = (unsigned long)(CORE_CLOCK * PERIOD) - 1u;
    TIMER_VALUE = 0u;
    TIMER_CONTROL = 7u; /* on, with interrupts, by the clock of the core */
    for (;;) {{
    }}
}}
"""


def _joint(name: str) -> str:
    """Return the source that gives the functions of C++ to C."""
    return f"""// The functions of {name}.h.
#include "{name}.h"

#include "{name}.hpp"

extern "C" void {name}_start({name}_state* state) {{ *state = __builtin_bit_cast({name}_state, {name}::start()); }}

extern "C" {name}_outputs {name}_step({name}_state* state, const {name}_inputs* in) {{
    {name}::State moved = __builtin_bit_cast({name}::State, *state);
    const {name}::Outputs out = {name}::step(moved, __builtin_bit_cast({name}::Inputs, *in));
    *state = __builtin_bit_cast({name}_state, moved);
    return __builtin_bit_cast({name}_outputs, out);
}}
"""


def _cplusplus(step: StepFunction, name: str, scalar: str) -> str:
    """Return the header in C++ that contains all that it needs."""
    package = cplusplus.amalgamated([*cplusplus.headers_of(step.model), *step.headers, *OWN_HEADERS])
    macros = "".join(f"#undef {each}\n" for each in cplusplus.macros(package))
    members = {"Inputs": step.inputs, "State": step.state, "Outputs": step.outputs}
    structs = "\n".join(f"struct {kind} {{\n{_members(each, 'S', '// {}')}}};\n" for kind, each in members.items())
    numbers = "".join(f"    {line}\n" for line in cplusplus.assignments(step.model, "model"))
    start = "".join(f"    state.{line};\n" for each in step.state for line in _starts(each))
    bad = ", ".join(each.is_bad.format(name=each.name) for each in step.inputs)
    return f"""/* {name}: {_about(step)}.
   A header of C++20 without includes: {name}::start and {name}::step. */
#ifndef {name.upper()}_HPP
#define {name.upper()}_HPP

#define strainwave {name}_strainwave  // so that a program may contain several such headers

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"        // counts of teeth become S
#pragma GCC diagnostic ignored "-Wfloat-conversion"  // defaults in double are rounded to S once, by the compiler
#pragma GCC diagnostic ignored "-Wsign-conversion"   // places in arrays of a fixed length are int

namespace strainwave::std {{

{cplusplus.own_text("mathematics.hpp")}
}}  // namespace strainwave::std
{package}
#pragma GCC diagnostic pop

namespace {name} {{

using S = {scalar};

{structs}
namespace constants {{

constexpr S period{{S({step.period!r})}};  // s
constexpr auto made = [] {{
    {static_type(step.model, "S")} model{{}};
{numbers}    return model;
}};
using Model = decltype(strainwave::compiled(made()));
constexpr Model model = strainwave::compiled(made());

}}  // namespace constants

/// Return the state before the first step.
constexpr State start() {{
    State state{{}};
{start}    return state;
}}

/// Return the inputs with the last good value in place of each bad one, and count the calls with a bad one.
static inline Inputs held(State& state, Inputs in) {{
    constexpr int count = sizeof in / sizeof(S);
    const bool is_bad[count] = {{{bad}}};
    S values[count];
    __builtin_memcpy(values, &in, sizeof in);
    bool any_bad = false;
    for (int i = 0; i < count; ++i) {{
        values[i] = state.good_inputs[i] = is_bad[i] ? state.good_inputs[i] : values[i];
        any_bad |= is_bad[i];
    }}
    state.bad_samples += S(any_bad);
    __builtin_memcpy(&in, values, sizeof in);
    return in;
}}

/// True if all numbers of the state are finite.
static inline bool is_finite(const State& state) {{
    S differences{{0.0}};
    for (unsigned i = 0; i < sizeof state / sizeof(S); ++i) {{
        S number;
        __builtin_memcpy(&number, reinterpret_cast<const char*>(&state) + i * sizeof number, sizeof number);
        differences += number - number;  // not a number, if this one is not finite
    }}
    return differences == S(0.0);
}}

/// Return the state before the first step, with the inputs of now, and one bad sample more.
static inline State restarted(const State& before) {{
    State state = start();
    __builtin_memcpy(state.good_inputs, before.good_inputs, sizeof state.good_inputs);
    state.bad_samples = before.bad_samples + S(1.0);
    return state;
}}

/// Return the outputs at this instant, and move the state on to the next.
static inline Outputs step(State& state, const Inputs& measured_inputs) {{
    using namespace constants;
    const Inputs in = held(state, measured_inputs);
    using Memory = decltype({step.memory});
    strainwave::Flat<S, Memory> numbers;  // with which the state begins
    static_assert(sizeof numbers <= sizeof state);
    __builtin_memcpy(&numbers, &state, sizeof numbers);
    auto x = strainwave::refilled({step.memory}, numbers);
    Outputs out;
{step.body.removeprefix(chr(10))}
    numbers = strainwave::flattened<S>(x);
    if constexpr (strainwave::size_of<S, Memory> > 0) __builtin_memcpy(&state, &numbers, sizeof numbers);
    if (!is_finite(state)) state = restarted(state);
    return out;
}}

}}  // namespace {name}

{macros}#undef strainwave
#endif
"""


def _starts(member: Member) -> Sequence[str]:
    if not member.is_array:
        return [f"{member.name} = S({member.start[0]!r})"] if member.start[0] else []
    return [f"{member.name}[{i}] = S({value!r})" for i, value in enumerate(member.start) if value]
