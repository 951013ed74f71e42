"""Random models of a family, drawn from what their fields say of themselves: a new model is covered without an edit."""

from __future__ import annotations

import re
from typing import Any

import strainwave as sw
from hypothesis import reject
from hypothesis import strategies as st
from strainwave import _core

# Where the numbers of gears and their motors lie, by unit; a unit not listed lies around one.
TYPICAL = {
    "N.m": (1e-2, 1e2),
    "N.m/rad": (1e1, 1e5),
    "N.m/rad3": (1e6, 1e10),
    "N.m.s/rad": (1e-5, 1e0),
    "1/rad": (1e1, 1e4),
    "rad": (1e-6, 1e-3),
    "rad/s": (1e-2, 1e1),
    "kg.m2": (1e-5, 1e0),
    "H": (1e-4, 1e-2),
}
AROUND_ONE = (10**-1.5, 10**1.5)

# The parts of a gear and of a drive that are named otherwise than the family they are chosen from.
FAMILY = {"friction_input": "friction", "friction_output": "friction", "load": "loads"}

Field = dict[str, Any]


def log_uniform(low: float, high: float) -> st.SearchStrategy[float]:
    """Every decade between `low` and `high` equally likely."""
    return st.floats(0.0, 1.0).map(lambda share: low * (high / low) ** share)


def signed(magnitudes: st.SearchStrategy[float]) -> st.SearchStrategy[float]:
    return magnitudes | magnitudes.map(lambda magnitude: -magnitude)


def refusal(model: type, field: Field, value: object) -> str:
    """What a model says to one value of a field; nothing if it takes it."""
    try:
        model(**{field["name"]: [value] if field["kind"] == "sequence" else value})
    except (TypeError, ValueError) as error:
        return str(error)
    return ""


def options(model: type, field: Field) -> list[str]:
    """What a field that is a choice can be, as the model names it to who asks for something else."""
    return re.findall(r"'(\w+)'", refusal(model, field, None))


def numbers(model: type, field: Field) -> st.SearchStrategy[float]:
    """What a number may be: zero too where that is allowed, negative too where nothing forbids it."""
    magnitudes = log_uniform(*TYPICAL.get(field["unit"], AROUND_ONE))
    if field["min"] is None:
        return st.just(0.0) | signed(magnitudes)
    positive = "must lie in (0" in refusal(model, field, 0.0)
    return magnitudes if positive else st.one_of(st.just(0.0), *5 * [magnitudes])


@st.composite
def built(draw: st.DrawFn, model: type) -> Any:
    """A model with every field drawn; its sequences are equally long."""
    length = draw(st.integers(0, 8))
    drawn: dict[str, Any] = {}
    for field in model.fields:
        name = field["name"]
        match field["kind"]:
            case "part":
                drawn[name] = draw(gears if name == "gear" else models(FAMILY.get(name, name)))
            case "choice":
                drawn[name] = draw(st.sampled_from(options(model, field)))
            case "count":
                drawn[name] = draw(st.integers(int(field["min"]), int(field["max"])))
            case "sequence":
                drawn[name] = draw(st.lists(numbers(model, field), min_size=length, max_size=length))
            case _:
                drawn[name] = draw(numbers(model, field))
    try:
        return model(**drawn)
    except ValueError:  # a relation between fields, as t2 >= t1, does not hold
        reject()


def models(family: str, *verbs: str) -> st.SearchStrategy[Any]:
    """Any model of a family that has these verbs, with any numbers."""
    return st.one_of([built(model) for model in _core.families[family].values() if all(hasattr(model, verb) for verb in verbs)])


gears = built(sw.Gear)
drives = built(sw.drives.PositionDrive)
