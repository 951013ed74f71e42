"""Statically typed drives as C++ text, which between them hold every model of every list: a new one is covered unasked."""

from __future__ import annotations

from itertools import cycle, islice
from pathlib import Path

from strainwave import _core

INCLUDE = Path(__file__).parents[1] / "include"
HEADERS = "#include <strainwave/integrate.hpp>\n#include <strainwave/models.hpp>\n"

# Python may not call a module as it calls the function `load`.
NAMESPACE = {"loads": "load"}
GEAR = ("kinematics", "kinematic_error", "stiffness", "hysteresis", "friction", "friction")
DRIVE = ("motor", "control", "loads")


def drives(scalar: str) -> list[str]:
    """As many drives as the longest list has models; every list goes round, friction at the output one ahead of the input."""
    count = max(map(len, _core.families.values()))

    def column(family: str, ahead: int) -> list[str]:
        names = [f"strainwave::{NAMESPACE.get(family, family)}::{model.__name__}" for model in _core.families[family].values()]
        return [f"{name}<{scalar}>" for name in islice(cycle(names), ahead, ahead + count)]

    gears = zip(*(column(family, ahead=i == len(GEAR) - 1) for i, family in enumerate(GEAR)), strict=True)
    parts = zip(*(column(family, ahead=0) for family in DRIVE), strict=True)
    return [
        f"strainwave::PositionDrive<{scalar}, strainwave::Gear<{scalar}, {', '.join(gear)}>, {', '.join(part)}>"
        for gear, part in zip(gears, parts, strict=True)
    ]
