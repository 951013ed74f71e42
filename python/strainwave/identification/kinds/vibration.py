"""Vibration while a shaft turns: `strainwave orders` finds its orders."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NoReturn

from strainwave.identification.kinds.kind import Kind
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.names import Side
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.reading.roles import Column, ColumnRoles, first, measured, names_of
from strainwave.identification.results.gear_so_far import GearSoFar
from strainwave.questions import QuestionError


class Vibration(Kind):
    """An acceleration over the angle or the speed of a shaft, without torque or current."""

    needs = "an angle or a speed, and a vibration in m/s²"
    time = "needed"

    def recognises(self, columns: Sequence[Column], mapping: FileMapping) -> bool:
        """True for a motion and a vibration, and nothing that drove it."""
        moves = measured(columns, "angle", "speed")
        return bool(moves and measured(columns, "vibration") and not measured(columns, "torque", "current", "voltage"))

    def roles(self, columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
        motions, vibration = measured(columns, "angle", "speed"), first(columns, "vibration")
        if not motions or not vibration:
            raise QuestionError(f"{self.title} needs {self.needs}; it has {names_of(columns)}")
        motion = motions[0]
        side: Side = mapping.side or motion.channel.side or "input"
        why = f"its columns are {names_of([motion, *vibration.values()])}: {self.title}"
        assumed = "" if mapping.side or motion.channel.side else f"{motion.name} is taken for that of the motor"
        by_channel = {**first(columns, "time"), f"{side}_{motion.channel.quantity}": motion, **vibration}
        return ColumnRoles(self.name, by_channel, side, tuple(filter(None, (why, assumed))))

    def fit(self, file: Recognised, known: GearSoFar) -> NoReturn:
        """
        Raises:
            ValueError: vibration determines no parameter of a gear
        """
        raise ValueError(
            "vibration determines no parameter of a gear: strainwave orders FILE finds the orders of the shaft, the resonance "
            "that they pass, and lines of fixed frequency"
        )
