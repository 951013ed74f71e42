"""Steps: what firmware calls once in each period, as inputs, state, outputs and a body in C++; one for each part of a drive."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from strainwave import Drive, _core, arguments
from strainwave.export.fmu.source import RATES
from strainwave.export.host import MIN_STEP, default_step, internal_step
from strainwave.messages import shortened
from strainwave.simulation.controller import MAX_SIGNAL
from strainwave.simulation.excitation import ROOM_TEMPERATURE
from strainwave.simulation.signals import actuation, command_unit, outputs

MAX_STEPS_PER_PERIOD = 1000  # of a sampled controller
MAX_RELATIVE_REST = 1e-9  # of a step: instants closer than this to a multiple of it are that multiple
BAD_LIMITS = f"!(S(-{MAX_SIGNAL:g}) <= in.low && in.low <= in.high && in.high <= S({MAX_SIGNAL:g}))"
RUN_HEADER = "strainwave/integrate.hpp"
CONTACT_HEADER = "strainwave/friction/contact.hpp"


@dataclass(frozen=True)
class Member:
    """A member of a struct in C.

    Attributes:
        name: in C
        unit: in SI; empty without one
        doc: what it is, if the name does not suffice
        start: value at the start; several are an array
        is_bad: condition in C++ on an input, under which its last good value replaces it; by default not finite, or too large
    """

    name: str
    unit: str
    doc: str = ""
    start: tuple[float, ...] = (0.0,)
    is_array: bool = False
    is_bad: str = f"!(strainwave::abs(in.{{name}}) <= S({MAX_SIGNAL:g}))"


@dataclass(frozen=True)
class StepFunction:
    """A function that firmware calls once in each period.

    Attributes:
        model: part of a drive; its numbers are the constants of the function
        words: what the function does, in one line
        inputs, outputs: members of the structs of these names in C
        memory_state: numbers of `memory`, then those that `body` adds
        period: time from one call to the next [s]; 0 if the time does not matter
        memory: described state of the model in C++, over scalars S
        body: C++ that turns the inputs `in` and the memory `x` into the outputs `out`, and `x` into the next memory
        headers: of the package that the body needs besides those of the model
    """

    model: Any
    words: str
    inputs: tuple[Member, ...]
    outputs: tuple[Member, ...]
    body: str
    memory_state: tuple[Member, ...] = ()
    period: float = 0.0
    memory: str = "strainwave::Stateless<S>{}"
    headers: tuple[str, ...] = ()

    @property
    def state(self) -> tuple[Member, ...]:
        """Members of the struct `state` in C: the memory, and what a step keeps of its inputs."""
        starts = tuple(start for each in self.inputs for start in each.start)
        return (
            *self.memory_state,
            Member("good_inputs", "", "last good value of each input", starts, is_array=True),
            Member("bad_samples", "1", "calls with an input that was held, or after which the state began anew"),
        )


def step(drive: Drive, part: str, period: float | None) -> StepFunction:
    """Return the step of a part of a drive.

    Args:
        drive: with the part
        part: one of `PARTS`
        period: time between calls [s]; by default that of the controller, or the step of a simulation

    Raises:
        TypeError, ValueError: an argument is not of its kind, or the part does not run in this period
    """
    make = PARTS[arguments.one_of("part", part, PARTS)]
    if period is not None:
        period = arguments.number("period", period, "s", low=MIN_STEP)
    return make(drive, part, period)


def _controller(drive: Drive, part: str, period: float | None) -> StepFunction:
    control = drive.control
    if not isinstance(control, _core.control.Sampled):
        raise TypeError(
            f"drive.control = {shortened(control)} must be sampled, as sw.control.Sampled(law=...) makes one; a law of the "
            'gear needs no controller: --part gear.friction_input, in Python part="gear.friction_input"'
        )
    if period not in (None, control.period):
        raise ValueError(f"period = {period:g} s must be drive.control.period, {control.period:g} s: leave it out")
    command, given = command_unit(drive), actuation(drive)
    return StepFunction(
        control.replace(delay=0.0),
        "the sampled controller of a drive",
        (
            Member("command", command),
            Member("command_rate", RATES.get(command, f"{command}/s"), "time derivative of the command"),
            Member("input_angle", "rad", "as measured; what the controller does not use may be 0"),
            Member("input_speed", "rad/s"),
            Member("output_angle", "rad"),
            Member("output_speed", "rad/s"),
            Member("current", "A", "of the motor"),
            Member("torque", "N.m", "transmitted, at the output"),
            Member("low", given.unit, "least actuation that the motor can follow now", (-MAX_SIGNAL,), is_bad=BAD_LIMITS),
            Member("high", given.unit, "largest one", (MAX_SIGNAL,), is_bad=BAD_LIMITS),
        ),
        (Member(given.name, given.unit, "for the motor, within [low, high]"),),
        f"""
    const strainwave::control::Command<S> command{{in.command, in.command_rate, S({drive.gear.kinematics.ratio!r})}};
    const strainwave::control::Measurement<S> measured{{in.input_angle, in.input_speed, in.output_angle, in.output_speed,
                                                       in.current, in.torque, {{in.low, in.high}}}};
    x = model.elapsed(model.sampled(x, x.until_sample, command, measured), model.period);
    out = {{strainwave::clip(model.held(x), in.low, in.high)}};""",
        tuple(_state(drive, "control", "control.")),
        control.period,
        "model.initial_discrete()",
    )


def _drive(drive: Drive, part: str, period: float | None) -> StepFunction:
    load, load_unit, load_doc = _core.load_input(drive)
    command = command_unit(drive)
    shown = [each for each in outputs(drive).values() if each.name != "command"]
    state = tuple(_state(drive, None, ""))
    steps, kept = "strainwave::integrate::Steps<S, Model> steps;", ""
    if _kept_counts(drive):
        steps = "auto steps = __builtin_bit_cast(strainwave::integrate::Steps<S, Model>, state.kept);"
        kept = "\n    __builtin_memcpy(state.kept, &steps, sizeof steps);"
    return StepFunction(
        drive,
        "a drive, by one step of a simulation",
        (
            Member("command", command, "of the controller, or of the motor in open loop"),
            Member("command_rate", RATES.get(command, f"{command}/s"), "its rate within the period; 0 if it is held"),
            Member(load, load_unit, load_doc),
            Member(f"{load}_rate", RATES.get(load_unit, f"{load_unit}/s"), "its rate"),
            Member("temperature", "K", "around the drive", (ROOM_TEMPERATURE,)),
            Member("temperature_rate", "K/s", "its rate"),
        ),
        tuple(Member(each.name, each.unit, " ".join(each.doc.split())) for each in shown),
        f"""
    const auto after = [&](S time) -> strainwave::Input<S> {{
        return {{in.command + time * in.command_rate, in.command_rate,
                in.{load} + time * in.{load}_rate, in.{load}_rate,
                in.temperature + time * in.temperature_rate, in.temperature_rate}};
    }};
    const strainwave::Interval<strainwave::Input<S>> u{{after(S(0.0)), after(S(0.5) * period), after(period)}};
    auto here = model.evaluate(x, u.start);
    const auto shown = strainwave::flattened<S>(model.output(here, u.start));
    strainwave::Array<S, sizeof(Outputs) / sizeof(S)> signals;
    static_assert(decltype(shown)::size() == decltype(signals)::size() + 1);
    for (int i = 0; i < signals.size(); ++i) signals[i] = shown[i + 1];  // all but the command
    out = __builtin_bit_cast(Outputs, signals);
    here = strainwave::system::up_to_date(model, here, u.start, S(0.5) * period);
    {steps}
    steps.begin(period);
    const auto smooth = [&](const auto& moved, const auto& from, const auto& over, const S& dt) {{
        return moved.evaluate(steps(moved, from, over, dt), over.end);
    }};
    if (strainwave::system::has_events(model))
        x = strainwave::integrate::event_driven_step(model, here, u, period, smooth).state;
    else
        x = steps(model, here, u, period);{kept}""",
        (
            *state,
            *(Member("kept", "", "by a step for the next", (0.0,) * count, is_array=True) for count in _kept_counts(drive)),
        ),
        _period_of_drive(drive, period),
        "model.initial_state()",
        (RUN_HEADER,),
    )


def _kept_counts(drive: Drive) -> list[int]:
    """Return how many numbers a step of a drive keeps for the next: matrices, if bodies within its gear move by themselves."""
    inner = sum(owner == "structure" for _, _, owner in _core.state(drive)[0])
    return [7 * (3 + inner) ** 2 + 6] if inner else []


def _period_of_drive(drive: Drive, period: float | None) -> float:
    """Return the period of the steps of a drive [s]: instants of its sampled controller are multiples of it.

    Raises:
        ValueError: they are not, or the period is too coarse for the drive
    """
    _, sampled, delay = _core.schedule(drive, drive.rest().numbers)
    if sampled == 0.0:
        return internal_step(drive, period, "period")
    longest = internal_step(drive, period, "period")
    for count in range(max(1, math.ceil(sampled / longest - MAX_RELATIVE_REST)), MAX_STEPS_PER_PERIOD + 1):
        own = sampled / count
        if abs(delay / own - round(delay / own)) < MAX_RELATIVE_REST * count and (
            period is None or abs(own - period) <= MAX_RELATIVE_REST * period
        ):
            return own
        if period is not None:
            break
    asked = f"period = {period:g} s" if period is not None else f"a period up to {longest:g} s"
    raise ValueError(
        f"{asked} must divide period = {sampled:g} s and delay = {delay:g} s of drive.control, which acts at the end of steps; "
        "give another period, or drive.replace(control=sw.control.OpenLoop())"
    )


def _friction(drive: Drive, part: str, period: float | None) -> StepFunction:
    law = _law(drive, part)
    period = default_step(drive) if period is None else period
    held = (Member("hold_forward", "N.m", "most that it balances at rest against a push forwards"),
            Member("hold_backward", "N.m", "the same backwards")) if law.set_valued else ()  # fmt: skip
    holds = ", ".join(f"strainwave::friction::hold(model, now.pushed(S({sense})))" for sense in ("1.0", "-1.0"))
    return StepFunction(
        law,
        "a law of friction: torque that opposes the motion",
        (
            Member("speed", "rad/s"),
            Member("angle", "rad", "where it depends on that, else 0"),
            Member("load", "N.m", "torque transmitted; positive if it drives a positive speed; 0 if the law has no use for it"),
            Member("temperature", "K", start=(ROOM_TEMPERATURE,)),
        ),
        (Member("torque", "N.m", "against the speed"), *held),
        f"""
    const auto contact = [&](S speed, S angle) -> strainwave::friction::Contact<S> {{
        return {{speed, strainwave::sign(speed), strainwave::reduced(angle), in.load, in.temperature}};
    }};
    const auto now = contact(in.speed, in.angle);
    const auto before = contact(S(0.5) * state.last_speed + S(0.5) * in.speed, state.last_angle);
    x = strainwave::friction::slide(model, x, before, state.has_begun * period);
    state.last_speed = in.speed;
    state.last_angle = in.angle;
    state.has_begun = S(1.0);
    out = {{strainwave::friction::torque(model, x, now){f", {holds}" if held else ""}}};""",
        (*_state(drive, part.partition(".")[2], f"{part.partition('.')[2]}."),
         Member("last_speed", "rad/s", "at the last call"), Member("last_angle", "rad", "at the last call"),
         Member("has_begun", "1", "1 after the first call")),
        period,
        "strainwave::initial_state(model)",
        (CONTACT_HEADER,),
    )  # fmt: skip


def _hysteresis(drive: Drive, part: str, period: float | None) -> StepFunction:
    _check_static(part, period)
    return StepFunction(
        _law(drive, part),
        "a law of hysteresis: torque over the history of the twist",
        (Member("twist", "rad", "at the output"),),
        (Member("torque", "N.m", "at the output"),),
        """
    const S moved = state.has_begun * (in.twist - state.last_twist);
    out = {model.torque(x, moved)};
    x = model.advance(x, moved);
    state.last_twist = in.twist;
    state.has_begun = S(1.0);""",
        (*_state(drive, "hysteresis", "hysteresis."), Member("last_twist", "rad", "at the last call"),
         Member("has_begun", "1", "1 after the first call")),
        memory="strainwave::initial_state(model)",
    )  # fmt: skip


def _stiffness(drive: Drive, part: str, period: float | None) -> StepFunction:
    _check_static(part, period)
    return StepFunction(
        _law(drive, part),
        "a law of stiffness: elastic torque over the twist",
        (Member("twist", "rad", "at the output"),),
        (Member("torque", "N.m", "at the output"), Member("tangent", "N.m/rad", "its slope")),
        "\n    out = {model.torque(in.twist), model.tangent(in.twist)};",
    )


def _kinematic_error(drive: Drive, part: str, period: float | None) -> StepFunction:
    _check_static(part, period)
    return StepFunction(
        _law(drive, part),
        "a law of the kinematic error at the output",
        (Member("input_angle", "rad"),),
        (Member("error", "rad", "at the output"), Member("slope", "1", "over the input angle")),
        """
    const auto found = model.at(strainwave::reduced(in.input_angle));
    out = {found.value, found.slope};""",
        headers=("strainwave/angle.hpp",),
    )


def _kinematic_noise(drive: Drive, part: str, period: float | None) -> StepFunction:
    _check_static(part, period)
    return StepFunction(
        _law(drive, part),
        "a law of the random kinematic error at the output",
        (Member("input_angle", "rad"), Member("torque", "N.m", "elastic"), Member("input_speed", "rad/s")),
        (Member("error", "rad", "at the output"), Member("slope", "1", "over the input angle")),
        """
    const auto found = model.at(strainwave::reduced(in.input_angle), in.torque, in.input_speed);
    out = {found.value, found.slope};""",
        headers=("strainwave/angle.hpp",),
    )


Maker = Callable[[Drive, str, float | None], StepFunction]
PARTS: dict[str, Maker] = {
    "control": _controller,
    "drive": _drive,
    **{f"gear.friction_{place}": _friction for place in ("input", "mesh", "output")},
    "gear.stiffness": _stiffness,
    "gear.hysteresis": _hysteresis,
    "gear.kinematic_error": _kinematic_error,
    "gear.kinematic_noise": _kinematic_noise,
}


def _law(drive: Drive, part: str) -> Any:
    return getattr(drive.gear, part.partition(".")[2])


def _check_static(part: str, period: float | None) -> None:
    if period is not None:
        raise ValueError(f"{part} does not depend on time; leave out period = {period:g} s")


def _state(drive: Drive, part: str | None, prefix: str) -> Iterator[Member]:
    """Yield the numbers of the state of a part of a drive at rest, without the prefix of their names; of all parts if None."""
    members: dict[str, tuple[str, bool, list[float]]] = {}
    for (path, unit, owner), value in zip(_core.state(drive)[0], drive.rest().numbers, strict=True):
        if part in (None, owner):
            member, bracket, _ = path.removeprefix(prefix).replace(".", "_").partition("[")
            members.setdefault(member, (unit, bool(bracket), []))[2].append(float(value))
    return (Member(name, unit, "", tuple(start), is_array) for name, (unit, is_array, start) in members.items())
