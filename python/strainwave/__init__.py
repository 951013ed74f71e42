"""strainwave: from measurements of a strain wave gear to a validated model of that gear, and this one model everywhere.

>>> import strainwave as sw
>>> gear = sw.load("hfuc-25-100")
>>> gear.kinematics.ratio
-100.0
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from strainwave import drives
from strainwave._core import (
    Drive,
    Gear,
    PassivityWarning,
    Sensors,
    control,
    friction,
    hysteresis,
    kinematic_error,
    kinematics,
    loads,
    motor,
    sensor,
    stiffness,
)

if TYPE_CHECKING:
    from strainwave import scenario
    from strainwave.ensemble import Ensemble, EnsembleWarning, simulate_many, simulate_to
    from strainwave.gear_set import GearSet, catalogue, load, save
    from strainwave.identify.fit import Fit, fit
    from strainwave.identify.twin import Twin, twin
    from strainwave.linear import LinearView, linearise
    from strainwave.ratings import RatingCheck, RatingWarning, check_ratings
    from strainwave.recording import Recording
    from strainwave.response import FrequencyResponse, frequency_response
    from strainwave.sensitivity import Derivatives, derivatives
    from strainwave.simulation import Run, simulate, simulate_adaptively
    from strainwave.steady import equilibrium

# Imported at first use: numpy alone takes longer to import than `strainwave --help` may take to answer.
_LAZY = {
    "Derivatives": "sensitivity",
    "Ensemble": "ensemble",
    "EnsembleWarning": "ensemble",
    "Fit": "identify.fit",
    "FrequencyResponse": "response",
    "GearSet": "gear_set",
    "LinearView": "linear",
    "RatingCheck": "ratings",
    "RatingWarning": "ratings",
    "Recording": "recording",
    "Run": "simulation",
    "Twin": "identify.twin",
    "catalogue": "gear_set",
    "check_ratings": "ratings",
    "derivatives": "sensitivity",
    "equilibrium": "steady",
    "fit": "identify.fit",
    "frequency_response": "response",
    "linearise": "linear",
    "load": "gear_set",
    "save": "gear_set",
    "scenario": "scenario",
    "simulate": "simulation",
    "simulate_adaptively": "simulation",
    "simulate_many": "ensemble",
    "simulate_to": "ensemble",
    "twin": "identify.twin",
}

__all__ = [
    "Derivatives",
    "Drive",
    "Ensemble",
    "EnsembleWarning",
    "Fit",
    "FrequencyResponse",
    "Gear",
    "GearSet",
    "LinearView",
    "PassivityWarning",
    "RatingCheck",
    "RatingWarning",
    "Recording",
    "Run",
    "Sensors",
    "Twin",
    "catalogue",
    "check_ratings",
    "control",
    "derivatives",
    "drives",
    "equilibrium",
    "fit",
    "frequency_response",
    "friction",
    "hysteresis",
    "kinematic_error",
    "kinematics",
    "linearise",
    "load",
    "loads",
    "motor",
    "save",
    "scenario",
    "sensor",
    "simulate",
    "simulate_adaptively",
    "simulate_many",
    "simulate_to",
    "stiffness",
    "twin",
]


def __getattr__(name: str) -> Any:
    if name not in _LAZY:
        raise AttributeError(f"module 'strainwave' has no attribute {name!r}")
    module = import_module(f"strainwave.{_LAZY[name]}")
    return module if _LAZY[name] == name else getattr(module, name)


def __dir__() -> list[str]:
    return __all__
