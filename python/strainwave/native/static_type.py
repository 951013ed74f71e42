"""The static type of a drive: the C++ type in which every law is fixed, so that nothing is chosen at run time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any, Literal, get_args

from strainwave import _core

Scalar = Literal["double", "float"]
SCALARS: tuple[Scalar, ...] = get_args(Scalar)
# Members that are template parameters, in the order of the C++ templates; of a law they are its members of a chosen law.
PARAMETERS = {
    _core.Drive: ("control", "motor", "gear", "load", "sensors", "thermal", "meter"),
    _core.Gear: (
        *("kinematics", "kinematic_error", "kinematic_noise", "stiffness", "hysteresis"),
        *("friction_input", "friction_mesh", "friction_output", "softening", "structure", "stiffness_variation", "material"),
    ),
    _core.control.Sampled: ("law", "compensation"),
    _core.Compensation: ("feedforward", "learning", "observer", "dither"),
    _core.compensation.ModelFeedforward: ("gear", "load"),
    _core.control.FeedbackLinearisation: ("gear", "load"),
    _core.control.KinematicErrorTracking: ("gear", "load"),
}
NAMESPACES = {"loads": "load"}  # the function `strainwave.load` takes that name in Python


def static_type(part: Any, scalar: str = "S") -> str:
    """Return the C++ name of the static type of a drive, a gear or a law, over a scalar.

    >>> import strainwave as sw
    >>> static_type(sw.friction.Thermal(law=sw.friction.Viscous(viscous=0.1)))
    'strainwave::friction::Thermal<S, strainwave::friction::Viscous<S>>'
    """
    kind = type(part)
    return instance(kind, [static_type(getattr(part, name), scalar) for name in parameters(kind)], scalar)


def instance(kind: type[Any], arguments: Sequence[str], scalar: str) -> str:
    """Return the C++ name of the template of a model with these arguments, in the order of `parameters`."""
    if kind not in PARAMETERS and len(set(arguments)) == 1:
        arguments = arguments[:1]  # the default of those that follow
    return f"{_template(kind)}<{', '.join([scalar, *arguments])}>"


def parameters(kind: type[Any]) -> tuple[str, ...]:
    """Return the members of a model that are parameters of its C++ template, in their order."""
    return PARAMETERS.get(kind) or tuple(field["name"] for field in kind.fields if field["options"] and field["kind"] == "part")


def in_words(drive: Any) -> str:
    """Return the models of a drive in words, those left out that every drive has by default.

    >>> import strainwave as sw
    >>> in_words(sw.Drive(control=sw.control.PID(), load=sw.loads.Pendulum()))
    'control PID, load Pendulum'
    """
    return ", ".join(_differences(drive, type(drive)())) or "default laws"


def _differences(part: Any, default: Any) -> Iterator[str]:
    """Yield member and model where a part differs in its models from another one of its class."""
    for name in parameters(type(part)):
        own, other = getattr(part, name), getattr(default, name)
        if type(own) is type(other) and parameters(type(own)):
            yield from _differences(own, other)
        elif type(own) is not type(other):
            yield f"{name} {short_name(own)}"


def short_name(law: Any) -> str:
    """Return the name of a model with those of the models that it is made of.

    >>> import strainwave as sw
    >>> short_name(sw.friction.Thermal(law=sw.friction.Viscous(viscous=0.1)))
    'Thermal(Viscous)'
    """
    inner = [words for name in parameters(type(law)) for words in _inner(getattr(law, name))]
    return type(law).__name__ + (f"({', '.join(dict.fromkeys(inner))})" if inner else "")


def _inner(part: Any) -> Iterator[str]:
    """Yield the model of a law within another, or where parts of one kind differ from those by default."""
    if type(part) in PARAMETERS and type(part) is not _core.control.Sampled:
        yield from _differences(part, type(part)())
    else:
        yield short_name(part)


def _template(kind: type[Any]) -> str:
    family = kind.__module__.removeprefix("strainwave").removeprefix(".")
    space = "" if family == "_core" else f"{NAMESPACES.get(family, family)}::"
    return f"strainwave::{space}{kind.__name__}"
