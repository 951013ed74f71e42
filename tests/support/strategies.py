"""Random models of a family, drawn from what their fields say of themselves: a new model is covered without an edit."""

from __future__ import annotations

import warnings
from functools import cache
from typing import Any

import strainwave as sw
from hypothesis import reject, strategies as st
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
    "1/(N.m)": (1e-3, 1e-1),
    "m": (2.4e-2, 2.6e-2),
    "K": (250.0, 350.0),
    "1/K": (1e-3, 1e-1),
    "rad/K": (1e-8, 1e-5),
    "N/m": (1e6, 1e9),
    "N.s/m": (1e0, 1e3),
    "kg": (1e-3, 1e0),
    "ball_diameter": (1e-4, 7e-4),  # as many as fit on a circle of the size above
}
AROUND_ONE = (10**-1.5, 10**1.5)

Field = dict[str, Any]


def usual(model: Any) -> dict[str, Any]:
    """Every parameter of a model as it is by default, those too that whoever makes it must give."""
    return {field["name"]: field["default"] for field in model.fields}


def made(model: Any, **changed: Any) -> Any:
    """A model of usual numbers with some changed: for tests that the others do not matter to."""
    return model(**(usual(model) | changed))


def suited(part: Any, kinematics: Any) -> Any:
    """A part of a gear as the gear takes it: with its ratio and its teeth, where the part or what it holds asks for them."""
    if inner := {name: suited(getattr(part, name), kinematics) for name in HOLDING if hasattr(part, name)}:
        part = part.replace(**inner)
    if hasattr(part, "gear"):  # a controller with a model
        part = part.replace(gear=modelled(part.gear, kinematics))
    if type(part) is sw.stiffness.MultiCompliance:
        return part.replace(reduction=max(1.0, abs(kinematics.ratio)))
    return with_teeth_of(kinematics, part) if type(part) is sw.kinematic_error.ToothErrors else part


def modelled(gear: sw.Gear, kinematics: Any) -> sw.Gear:
    """The gear of a model with these kinematics; without its error, whose slope may be too steep for them."""
    parts = {name: suited(getattr(gear, name), kinematics) for name in SUITED}
    if abs(kinematics.ratio) < 1.0:  # MultiCompliance takes no reduction below 1
        if type(parts["stiffness"]) is sw.stiffness.MultiCompliance:
            parts["stiffness"] = made(sw.stiffness.Linear)
        if hasattr(parts["hysteresis"], "springs"):
            parts["hysteresis"] = sw.hysteresis.MaxwellSlip()
    return gear.replace(kinematics=kinematics, **(parts | {"kinematic_error": sw.kinematic_error.Fourier()}))


def with_teeth_of(kinematics: Any, error: Any) -> Any:
    """The error of these teeth; none where a gear has none, or meshes at one lobe."""
    if type(kinematics) is not sw.kinematics.StrainWave or (kinematics.circular_spline_teeth - kinematics.flexspline_teeth) % 2:
        return sw.kinematic_error.Fourier()
    return error.replace(**{field["name"]: getattr(kinematics, field["name"]) for field in kinematics.fields})


HOLDING = ("law", "springs", "compensation", "feedforward")  # parts within a part
SUITED = ("kinematic_error", "stiffness", "hysteresis")  # parts of a gear that may be told what its kinematics are


def log_uniform(low: float, high: float) -> st.SearchStrategy[float]:
    """Every decade between `low` and `high` equally likely."""
    return st.floats(0.0, 1.0).map(lambda share: low * (high / low) ** share)


def signed(magnitudes: st.SearchStrategy[float]) -> st.SearchStrategy[float]:
    return st.tuples(st.sampled_from([1.0, -1.0]), magnitudes).map(lambda drawn: drawn[0] * drawn[1])


def numbers(field: Field) -> st.SearchStrategy[float]:
    """What a number may be: zero too where that is allowed, negative too where nothing forbids it; within its limits."""
    low, high = TYPICAL.get(field["name"], TYPICAL.get(field["unit"], AROUND_ONE))
    if field["max"] is not None:
        low, high = min(low, field["max"]), min(high, field["max"])
    if field["min"]:
        low, high = max(low, field["min"]), max(high, field["min"])
    magnitudes = log_uniform(low, high)
    if field["min"] is None:
        return st.just(0.0) | signed(magnitudes)
    return magnitudes if field["open"] or field["min"] > 0.0 else st.one_of(st.just(0.0), *5 * [magnitudes])


def fitting(field: Field) -> float:
    """One, or the largest number that a field takes."""
    return 1.0 if field["max"] is None else min(1.0, float(field["max"]))


def kinds_of(field: Field) -> list[Any]:
    """The models that a part may be; of a gear and of sensors there is one kind."""
    return list(field["options"].values()) if field["options"] else [type(field["default"])]


def models_of(part: Any) -> set[str]:
    """The models that a drive is made of, and those that these hold."""
    found = {type(part).__name__}
    for field in part.fields:
        if field["kind"] == "part":
            found |= models_of(getattr(part, field["name"]))
    return found


def values(field: Field, length: int) -> st.SearchStrategy[Any]:
    """Any value of a field; a sequence has this length, because all sequences of a model are equally long."""
    match field["kind"]:
        case "part" if field["name"] == "structure":
            return st.just(field["default"])  # random stages are as fast as no step can follow; tests/structure has its own
        case "part":
            return st.one_of([built(kind) for kind in kinds_of(field)])
        case "choice":
            return st.sampled_from(field["options"])
        case "count":
            return st.integers(int(field["min"]), int(field["max"]))
        case "sequence":
            element = st.integers(int(field["min"]), int(field["max"])) if field["whole"] else numbers(field)
            return st.lists(element, min_size=length, max_size=length)
        case _:
            return numbers(field)


@cache
def members(model: Any, length: int) -> dict[str, st.SearchStrategy[Any]]:
    """Any value of each field of a model, by name.

    Made once, because hypothesis examines a new strategy for longer than it draws from it.
    """
    return {
        field["name"]: values(field, length) if field["kind"] == "sequence" or length == 0 else members(model, 0)[field["name"]]
        for field in model.fields
    }


@st.composite
def drawn(draw: st.DrawFn, model: Any) -> Any:
    """A model with every field drawn; tried again where a relation between fields, as t2 >= t1, does not hold."""
    for _ in range(8):
        length = draw(st.integers(0, 8))
        made_of = {name: draw(strategy) for name, strategy in members(model, length).items()}
        if "kinematics" in made_of:
            made_of |= {name: suited(made_of[name], made_of["kinematics"]) for name in SUITED}
        try:
            with warnings.catch_warnings(action="ignore", category=_core.PassivityWarning):
                if model is sw.Drive:
                    made_of["control"] = suited(made_of["control"], made_of["gear"].kinematics)
                return model(**made_of)
        except ValueError:
            continue
    return reject()


@cache
def built(model: Any) -> st.SearchStrategy[Any]:
    """A model with every field drawn."""
    return drawn(model)


def models(family: str, *verbs: str, **claims: bool) -> st.SearchStrategy[Any]:
    """Any model of a family that has these verbs and claims this of itself, with any numbers."""
    return st.one_of(
        [
            built(model)
            for model in _core.families[family].values()
            if all(hasattr(model, verb) for verb in verbs)
            and all(getattr(model, claim, None) == claimed for claim, claimed in claims.items())
        ]
    )


gears = built(sw.Gear)
drives = built(sw.Drive)


# Those that are one system of differential equations, whose shafts are moved by torques.
def smooth(drive: sw.Drive) -> sw.Drive:
    control = getattr(drive.control, "law", drive.control)
    turned = hasattr(drive.load, "inertia") and not isinstance(drive.load, sw.loads.Brake)
    sensors = {name: quiet(getattr(drive.sensors, name)) for name in (field["name"] for field in sw.Sensors.fields)}
    try:
        return drive.replace(
            control=control,
            load=drive.load if turned else sw.loads.Inertia(inertia=0.1),
            sensors=sw.Sensors(**sensors),
            thermal=sw.thermal.Isothermal(),
            meter=sw.meter.NoMeter(),
        )
    except ValueError:  # a controller that needs to be sampled
        return reject()


def quiet(sensor: Any) -> Any:
    """Without noise and steps, and without the counts of an encoder, of which nothing is a small deviation."""
    if isinstance(sensor, sw.sensor.Noisy | sw.sensor.Quantised):
        return quiet(sensor.law)
    return sw.sensor.Ideal() if isinstance(getattr(sensor, "law", sensor), sw.sensor.Encoder) else sensor


smooth_drives = drives.map(smooth)


def without_detent(law: Any) -> Any:
    """Return the friction of a law without the torque over the angle that it stores and gives back within a turn."""
    if not hasattr(law, "law"):
        return law
    none = {name: () for name in ("detent_order", "detent_torque", "detent_phase") if hasattr(law, name)}
    return law.replace(law=without_detent(law.law), **none)
