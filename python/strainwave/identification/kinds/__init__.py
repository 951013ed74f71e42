"""The kinds of measurement, one line each, in the order of their fits: a file comes after those that it rests on.

Columns are recognised in the reverse order: the kinds that are fitted last need most columns, and are asked first.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from strainwave.identification.kinds.kind import Kind


class Listed(NamedTuple):
    """A kind as it is listed: what a file of it is, and where its class stands in this package."""

    title: str
    place: str


KINDS = {
    "friction": Listed("a table of steady friction", "friction_table.SteadyFriction"),
    "effort": Listed(
        "torque or current without the motion that made it, or at one constant speed", "constant_speed.ConstantSpeed"
    ),
    "starting": Listed("a table of the torque at which the input starts", "starting_torque.StartingTorque"),
    "coast_down": Listed("a run-down of the input without the motor", "coast_down.CoastDown"),
    "torsion": Listed("a torsion loop or branch", "torsion_loop.Torsion"),
    "positioning": Listed("commanded against measured angles of one axis", "positioning.PositioningSteps"),
    "vibration": Listed("a record of vibration while a shaft turns", "vibration.Vibration"),
    "encoders": Listed("a record of two encoders", "two_encoders.TwoEncoders"),
    "run": Listed("a run of the whole drive from rest under its command", "run_from_rest.RunFromRest"),
    "log": Listed("a log of a drive", "log.Log"),
    "presliding": Listed("a presliding loop: a small motion to and fro at rest", "presliding.Presliding"),
    "breakaway": Listed("ramps of torque until the shaft breaks away", "breakaway.Breakaway"),
}


def kind_named(name: str) -> Kind:
    """Return a kind by its name; its module is imported at the first use.

    >>> kind_named("torsion").title
    'a torsion loop or branch'
    """
    module, _, own = KINDS[name].place.rpartition(".")
    kind_class: type[Kind] = getattr(import_module(f"{__name__}.{module}"), own)
    return kind_class(name)
