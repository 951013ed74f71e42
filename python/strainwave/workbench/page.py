"""The page of the workbench with a gear inside.

`python3 dev.py workbench` builds the page, and wheels contain it. It is one file that needs nothing else.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from strainwave import Drive, control, loads, motor
from strainwave.files.entries import NOT_GIVEN, Entry
from strainwave.files.gear_set import GearSet, catalogue
from strainwave.workbench.schema import values_of

FILE = Path(__file__).parent / "workbench.html"
MISSING = "the workbench is not installed: a wheel contains it, and python3 dev.py workbench builds it in a clone"
BEGIN, END = '<script type="application/json" id="gear">', "</script>"
FIRST_GEAR = "csg-20-100"  # of a page without a gear of its own: it has a rated torque
TRAVEL_SHARE = 0.3  # of the rated torque: travel of the loop at first
TWIST_WITHOUT_RATING = 1e-3  # rad: travel of the loop at first of a gear without rating
MIN_STIFFNESS = 1.0  # N.m/rad of the assumed controller's design
BANDWIDTH_SHARE = 0.2  # of the natural frequency of the load on the gear's spring: bandwidth of the assumed controller
MIN_INERTIA = 1e-6  # kg.m2 of the assumed rotor


def is_installed() -> bool:
    """True if the page was built."""
    return FILE.is_file()


def page(gear_set: GearSet | None = None) -> str:
    """Return the page with a gear inside, as one HTML file.

    Raises:
        FileNotFoundError: the page was not built
    """
    if not is_installed():
        raise FileNotFoundError(MISSING)
    before, _, rest = FILE.read_text("utf-8").partition(BEGIN)
    return before + BEGIN + embedded(start_of(gear_set or GearSet.read(FIRST_GEAR))) + END + rest.partition(END)[2]


def embedded(data: Any) -> str:
    """Return data as JSON that no text in it can end before its element does."""
    return json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c")


def start_of(gear_set: GearSet) -> dict[str, Any]:
    """Return what the page contains of a gear.

    A drive around it with the entries of its numbers, each source, spread and standard deviation; the travel of its loop, its
    ratings and its covariance.
    """
    parts = own_parts(gear_set)
    own = {path: entry for path, entry in gear_set.sources.items() if path.partition(".")[0] in {"gear", *parts}}
    covariance = None if gear_set.covariance is None else gear_set.covariance.among(own)
    return {
        "name": gear_set.name,
        "maker": gear_set.maker,
        "note": gear_set.note,
        "drive": changed(drive_around(gear_set)),
        "travel": {"by": "torque", "torque": first_torque(gear_set)},
        "parts": list(parts),
        "sources": {path: _stated(entry) for path, entry in own.items() if entry.source != NOT_GIVEN},
        "ratings": {name: [rating.value, rating.unit, *_stated(rating)] for name, rating in gear_set.ratings.items()},
        "covariance": None if covariance is None else {"numbers": covariance.paths, "matrix": covariance.matrix},
    }


def _stated(entry: Entry) -> list[Any]:
    return [entry.source, entry.spread, entry.uncertainty]


def entries() -> dict[str, Any]:
    """Return the gears of the catalogue, by their names."""
    return {name: start_of(GearSet.read(name)) for name in catalogue()}


def rated_torque(gear_set: GearSet) -> float | None:
    """Return the rated torque [N.m]; None if it is not known."""
    rating = gear_set.ratings.get("rated_torque")
    return None if rating is None else rating.to("N.m").value


def first_torque(gear_set: GearSet) -> float:
    """Return a travel [N.m] at which the loop of a gear shows."""
    if (rated := rated_torque(gear_set)) is not None:
        return TRAVEL_SHARE * rated
    return float(f"{abs(float(gear_set.gear.stiffness.torque(TWIST_WITHOUT_RATING))):.2g}") or 1.0


def drive_around(gear_set: GearSet) -> Drive:
    """Return the drive of a set; what `own_parts` lacks of motor, controller and load is assumed.

    The motor follows its torque command. The load has the inertia of rotor and wave generator, referred to the output. The
    controller is a PID of the input angle whose bandwidth lies well below the resonance of the load on the gear.
    """
    gear, own = gear_set.gear, own_parts(gear_set)
    source, load = own.get("motor"), own.get("load")
    if source is None:
        rotor = getattr(gear_set.motor, "inertia", 0.0) or max(gear.input_inertia, MIN_INERTIA)
        source = motor.TorqueSource(inertia=rotor)
    ratio = gear.kinematics.ratio
    at_input = max(source.inertia + gear.input_inertia, MIN_INERTIA)
    if load is None:
        load = loads.Inertia(inertia=at_input * ratio**2)
    at_output = getattr(load, "inertia", 0.0) or at_input * ratio**2
    return Drive(
        **(
            {"control": _position_control(gear_set, source, at_input, at_output)}
            | own
            | {"gear": gear, "motor": source, "load": load}
        )
    )


def own_parts(gear_set: GearSet) -> dict[str, Any]:
    """Return the parts of a drive, besides the gear, that a set has and the page can use.

    The assumed controller commands a torque or a current. If the controller is missing, any other motor is left out, and a
    controller without its motor too.
    """
    names = [field["name"] for field in Drive.fields if field["name"] != "gear"]
    own = {name: part for name in names if (part := getattr(gear_set, name)) is not None}
    if "motor" not in own:
        own.pop("control", None)
    elif "control" not in own and not isinstance(own["motor"], motor.TorqueSource | motor.CurrentSource):
        del own["motor"]
    return own


def _position_control(gear_set: GearSet, source: Any, at_input: float, at_output: float) -> control.PID:
    gear, ratio = gear_set.gear, abs(gear_set.gear.kinematics.ratio)
    torque = first_torque(gear_set)
    twist = float(gear.twist(np.array([torque]))[0])
    stiffness = max(torque / twist, MIN_STIFFNESS) if twist > 0.0 else MIN_STIFFNESS  # NaN if the spring is limited
    rate = BANDWIDTH_SHARE * (stiffness / at_output) ** 0.5  # rad/s
    inertia = at_input + at_output / ratio**2
    gravity = abs(getattr(gear_set.load, "gravity_torque", 0.0)) / ratio  # at the input, for each radian of the output at most
    per_torque = 1.0 / getattr(source, "torque_constant", 1.0)
    proportional = inertia * rate**2 + gravity / ratio
    return control.PID(
        proportional=per_torque * proportional,
        integral=per_torque * 0.2 * rate * proportional,
        derivative=per_torque * 2.0 * rate * inertia,
        limit=per_torque * (ratio * proportional + 2.0 * gravity),  # for an error of one radian at the output
    )


def changed(model: Any) -> dict[str, Any]:
    """Return the parameters of a model without those that have their default, which the page fills in.

    >>> import strainwave as sw
    >>> changed(sw.Gear(damping=2.0))
    {'damping': 2.0}
    """
    values = values_of(model)
    for field in model.fields:
        name, value = field["name"], getattr(model, field["name"])
        if value == field["default"] and not field["follows"]:
            del values[name]
        elif field["kind"] == "part":
            values[name] = ({"model": value.name} if field["options"] else {}) | changed(value)
    return values
