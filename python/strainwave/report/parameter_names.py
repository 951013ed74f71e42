"""Standard names of parameters, and the effect that each describes."""

from __future__ import annotations

from typing import Any

from strainwave import Drive
from strainwave.identification.results.file_result import FileEstimate

EFFECTS = {  # of a gear and its drive, with the beginnings of the paths of their parameters
    "Friction": ("gear.friction",),
    "Stiffness": ("gear.stiffness", "gear.structure", "gear.softening"),
    "Hysteresis and damping": ("gear.hysteresis", "gear.damping", "gear.material"),
    "Kinematic error": ("gear.kinematic_error", "gear.kinematic_noise"),
    "Load": ("load",),
}
OTHER = "Other"
STANDARD = {  # by the end of the path
    "friction_input.coulomb": "Coulomb torque",
    "friction_input.breakaway": "Breakaway torque",
    "friction_input.viscous": "Viscous coefficient",
    "friction_input.stribeck_speed": "Stribeck speed",
    "friction_input.bristle_stiffness": "Bristle stiffness",
    "stiffness.k": "Stiffness",
    "stiffness.k1": "Stiffness K1, first segment",
    "stiffness.k2": "Stiffness K2, second segment",
    "stiffness.k3": "Stiffness K3, third segment",
    "stiffness.t1": "Torque T1, end of the first segment",
    "stiffness.t2": "Torque T2, end of the second segment",
    "hysteresis.stiffness": "Stiffness of hysteresis element",
    "hysteresis.breakaway": "Slip torque of hysteresis element",
    "gear.damping": "Damping coefficient",
    "load.inertia": "Inertia of the load",
    "load.gravity_torque": "Gravity torque",
    "load.gravity_phase": "Phase of gravity",
}


def effect_of(path: str) -> str:
    """Return the effect that a parameter describes.

    >>> effect_of("gear.stiffness.k1"), effect_of("load.inertia"), effect_of("gear.input_inertia")
    ('Stiffness', 'Load', 'Other')
    """
    return next((effect for effect, beginnings in EFFECTS.items() if path.startswith(beginnings)), OTHER)


def name_of(estimate: FileEstimate) -> str:
    """Return the name of the parameter of an estimate.

    >>> name_of(FileEstimate("gear.friction_input.law.viscous", "N.m.s/rad", 3e-4, 1e-6, ""))
    'Viscous coefficient'
    >>> name_of(FileEstimate("gear.kinematic_error.amplitude of order 2", "rad", 6e-5, 1e-6, "fourier"))
    'Amplitude A_h at the output, of order 2'
    """
    return name_of_path(estimate.path, estimate.law)


def name_of_path(path: str, law: str = "") -> str:
    """Return the name of a parameter: the standard one, else that of its law.

    >>> name_of_path("gear.stiffness.k1"), name_of_path("gear.hysteresis.stiffness[1]")
    ('Stiffness K1, first segment', 'Stiffness of hysteresis element, no. 2')
    """
    path, _, order = path.partition(" of order ")
    path, _, place = path.removesuffix("]").partition("[")
    plain = path.replace(".law.", ".")
    words = next((name for end, name in STANDARD.items() if plain.endswith(end)), "") or _documented(path, law)
    if place:
        words += f", no. {int(place) + 1}"
    return f"{words}, of order {order}" if order else words


def _documented(path: str, law: str) -> str:
    """Return what the law of a parameter calls it."""
    *parts, last = path.split(".")
    owners: list[Any] = [Drive]
    for part in parts:
        fields = [field for owner in owners for field in owner.fields if field["name"] == part and field["kind"] == "part"]
        owners = list(dict.fromkeys(option for field in fields for option in _options(field)))
    owners.sort(key=lambda owner: getattr(owner, "name", "") != law)  # the law that it belongs to comes first
    docs = [field["doc"] for owner in owners for field in owner.fields if field["name"] == last]
    return docs[0] if docs else last.replace("_", " ").capitalize()


def _options(field: dict[str, Any]) -> list[Any]:
    """Return the laws that a part may have; one that has no choice is what it is by default."""
    return list(field["options"].values()) if field["options"] else [type(field["default"])]
