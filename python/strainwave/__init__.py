"""strainwave: identification and simulation of strain wave gears (harmonic drives).

>>> import strainwave as sw
>>> gear = sw.load("hfuc-25-100")
>>> gear.kinematics.ratio
-100.0
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

try:
    import_module("strainwave._core")
except Exception as error:  # in a clone also one of the build, which compiles what was edited
    import sys
    import sysconfig

    raise ImportError(
        f"the compiled core of strainwave does not load: {error}. In a clone, `python3 dev.py demo` compiles it, and "
        f"`source .venv/bin/activate` finds the tools for that; a wheel must be one for Python "
        f"{sys.version_info.major}.{sys.version_info.minor} on {sysconfig.get_platform()}"
    ) from None
from strainwave import presented_models as _presented_models
from strainwave._core import (
    Compensation,
    Drive,
    Gear,
    PassivityWarning,
    Sensors,
    compensation,
    control,
    fault,
    friction,
    hysteresis,
    kinematic_error,
    kinematics,
    loads,
    meter,
    motor,
    onset,
    sensor,
    softening,
    stiffness,
    structure,
    thermal,
    variation,
)

if TYPE_CHECKING:
    from strainwave import diagnose, export, rig, typeset
    from strainwave.analysis.agreement import Agreement
    from strainwave.analysis.compare import compare
    from strainwave.analysis.difference import Difference
    from strainwave.analysis.linear import Linearisation, linearise, modes
    from strainwave.analysis.measured_command import MeasuredCommand
    from strainwave.analysis.output_torque import OutputTorque, output_torque
    from strainwave.analysis.positioning_error import ErrorBound, positioning_error
    from strainwave.analysis.response import FrequencyResponse, frequency_response
    from strainwave.analysis.sensitivity import Derivatives, derivatives
    from strainwave.analysis.settling import settling_time
    from strainwave.analysis.steady import equilibrium
    from strainwave.analysis.strokes import stroke_within, strokes_apart
    from strainwave.dataset.faults import with_faults
    from strainwave.diagnose.detection_limit import DetectionLimit, detection_limit
    from strainwave.diagnose.order_lines import OrderLine, order_lines
    from strainwave.files.entries import Entry, Quantity
    from strainwave.files.gear_set import GearSet, catalogue, load, save
    from strainwave.files.ratings import RatingCheck, RatingWarning, check_ratings
    from strainwave.files.recording import Recording
    from strainwave.identification.excitation.plan import ExperimentPlan, plan_experiments
    from strainwave.identification.fitting.bootstrap import Bootstrap, bootstrap
    from strainwave.identification.fitting.combinations import Combination, combinations
    from strainwave.identification.fitting.fit import Fit, fit
    from strainwave.identification.fitting.minima import Minima, minima
    from strainwave.identification.fitting.profile import Profile, profile
    from strainwave.identification.identify import Identified, identify
    from strainwave.identification.reading.mapping import FileMapping
    from strainwave.native.cache import KernelWarning
    from strainwave.native.compile import Compilation, compile
    from strainwave.orders.campbell import Campbell, campbell
    from strainwave.orders.order_spectrum import BearingOrders, Orders, bearing_orders, order_amplitudes, order_spectrum
    from strainwave.orders.ripple import Ripple, ripple
    from strainwave.orders.two_encoders import TransmissionError, transmission_error
    from strainwave.report.listing import listing
    from strainwave.simulation import scenario
    from strainwave.simulation.controller import Observation, simulate_controlled
    from strainwave.simulation.ensemble import Ensemble, EnsembleWarning, simulate_many, simulate_to
    from strainwave.simulation.run import Run, simulate, simulate_adaptively
    from strainwave.simulation.scenario_file import ScenarioFile
    from strainwave.tuning.approach import LostMotion, PositioningPath, lost_motion, positioning_path
    from strainwave.tuning.compensate import Compensated, compensate
    from strainwave.tuning.loops import LoopMargins, cascade, loop_margins
    from strainwave.tuning.predictive import PredictiveController, predictive
    from strainwave.tuning.pulses import (
        PulsedMove,
        PulsePlan,
        PulseRepeatability,
        plan_pulses,
        position_by_pulses,
        pulse_repeatability,
        pulse_travel,
        pulse_width,
    )
    from strainwave.tuning.regulator import regulator

# Imported at first use: numpy alone takes longer to import than `strainwave --help` may take to answer.
_LAZY = {
    "Agreement": "analysis.agreement",
    "BearingOrders": "orders.order_spectrum",
    "Bootstrap": "identification.fitting.bootstrap",
    "Campbell": "orders.campbell",
    "Combination": "identification.fitting.combinations",
    "Compensated": "tuning.compensate",
    "Compilation": "native.compile",
    "Derivatives": "analysis.sensitivity",
    "DetectionLimit": "diagnose.detection_limit",
    "Difference": "analysis.difference",
    "Ensemble": "simulation.ensemble",
    "EnsembleWarning": "simulation.ensemble",
    "Entry": "files.entries",
    "ErrorBound": "analysis.positioning_error",
    "ExperimentPlan": "identification.excitation.plan",
    "FileMapping": "identification.reading.mapping",
    "Fit": "identification.fitting.fit",
    "FrequencyResponse": "analysis.response",
    "GearSet": "files.gear_set",
    "Identified": "identification.identify",
    "KernelWarning": "native.cache",
    "Linearisation": "analysis.linear",
    "LoopMargins": "tuning.loops",
    "LostMotion": "tuning.approach",
    "MeasuredCommand": "analysis.measured_command",
    "Minima": "identification.fitting.minima",
    "Observation": "simulation.controller",
    "OrderLine": "diagnose.order_lines",
    "Orders": "orders.order_spectrum",
    "OutputTorque": "analysis.output_torque",
    "PositioningPath": "tuning.approach",
    "Prediction": "identification.results.prediction",
    "PredictiveController": "tuning.predictive",
    "Profile": "identification.fitting.profile",
    "PulsePlan": "tuning.pulses",
    "PulseRepeatability": "tuning.pulses",
    "PulsedMove": "tuning.pulses",
    "Quantity": "files.entries",
    "RatingCheck": "files.ratings",
    "RatingWarning": "files.ratings",
    "Recording": "files.recording",
    "Ripple": "orders.ripple",
    "Run": "simulation.run",
    "ScenarioFile": "simulation.scenario_file",
    "TransmissionError": "orders.two_encoders",
    "bearing_orders": "orders.order_spectrum",
    "bootstrap": "identification.fitting.bootstrap",
    "campbell": "orders.campbell",
    "cascade": "tuning.loops",
    "catalogue": "files.gear_set",
    "check_ratings": "files.ratings",
    "combinations": "identification.fitting.combinations",
    "compare": "analysis.compare",
    "compensate": "tuning.compensate",
    "compile": "native.compile",
    "derivatives": "analysis.sensitivity",
    "detection_limit": "diagnose.detection_limit",
    "diagnose": "diagnose",
    "equilibrium": "analysis.steady",
    "export": "export",
    "fit": "identification.fitting.fit",
    "frequency_response": "analysis.response",
    "identify": "identification.identify",
    "linearise": "analysis.linear",
    "listing": "report.listing",
    "load": "files.gear_set",
    "loop_margins": "tuning.loops",
    "lost_motion": "tuning.approach",
    "minima": "identification.fitting.minima",
    "modes": "analysis.linear",
    "order_amplitudes": "orders.order_spectrum",
    "order_lines": "diagnose.order_lines",
    "order_spectrum": "orders.order_spectrum",
    "output_torque": "analysis.output_torque",
    "plan_experiments": "identification.excitation.plan",
    "plan_pulses": "tuning.pulses",
    "position_by_pulses": "tuning.pulses",
    "positioning_error": "analysis.positioning_error",
    "positioning_path": "tuning.approach",
    "predict": "identification.predict",
    "predictive": "tuning.predictive",
    "profile": "identification.fitting.profile",
    "pulse_repeatability": "tuning.pulses",
    "pulse_travel": "tuning.pulses",
    "pulse_width": "tuning.pulses",
    "regulator": "tuning.regulator",
    "rig": "rig",
    "ripple": "orders.ripple",
    "save": "files.gear_set",
    "scenario": "simulation.scenario",
    "settling_time": "analysis.settling",
    "simulate": "simulation.run",
    "simulate_adaptively": "simulation.run",
    "simulate_controlled": "simulation.controller",
    "simulate_many": "simulation.ensemble",
    "simulate_to": "simulation.ensemble",
    "stroke_within": "analysis.strokes",
    "strokes_apart": "analysis.strokes",
    "transmission_error": "orders.two_encoders",
    "typeset": "typeset",
    "with_faults": "dataset.faults",
}

__all__ = [
    "Agreement",
    "BearingOrders",
    "Bootstrap",
    "Campbell",
    "Combination",
    "Compensated",
    "Compensation",
    "Compilation",
    "Derivatives",
    "DetectionLimit",
    "Difference",
    "Drive",
    "Ensemble",
    "EnsembleWarning",
    "Entry",
    "ErrorBound",
    "ExperimentPlan",
    "FileMapping",
    "Fit",
    "FrequencyResponse",
    "Gear",
    "GearSet",
    "Identified",
    "KernelWarning",
    "Linearisation",
    "LoopMargins",
    "LostMotion",
    "MeasuredCommand",
    "Minima",
    "Observation",
    "OrderLine",
    "Orders",
    "OutputTorque",
    "PassivityWarning",
    "PositioningPath",
    "Prediction",
    "PredictiveController",
    "Profile",
    "PulsePlan",
    "PulseRepeatability",
    "PulsedMove",
    "Quantity",
    "RatingCheck",
    "RatingWarning",
    "Recording",
    "Ripple",
    "Run",
    "ScenarioFile",
    "Sensors",
    "TransmissionError",
    "bearing_orders",
    "bootstrap",
    "campbell",
    "cascade",
    "catalogue",
    "check_ratings",
    "combinations",
    "compare",
    "compensate",
    "compensation",
    "compile",
    "control",
    "derivatives",
    "detection_limit",
    "diagnose",
    "equilibrium",
    "export",
    "fault",
    "fit",
    "frequency_response",
    "friction",
    "hysteresis",
    "identify",
    "kinematic_error",
    "kinematics",
    "linearise",
    "listing",
    "load",
    "loads",
    "loop_margins",
    "lost_motion",
    "meter",
    "minima",
    "modes",
    "motor",
    "onset",
    "order_amplitudes",
    "order_lines",
    "order_spectrum",
    "output_torque",
    "plan_experiments",
    "plan_pulses",
    "position_by_pulses",
    "positioning_error",
    "positioning_path",
    "predict",
    "predictive",
    "profile",
    "pulse_repeatability",
    "pulse_travel",
    "pulse_width",
    "regulator",
    "rig",
    "ripple",
    "save",
    "scenario",
    "sensor",
    "settling_time",
    "simulate",
    "simulate_adaptively",
    "simulate_controlled",
    "simulate_many",
    "simulate_to",
    "softening",
    "stiffness",
    "stroke_within",
    "strokes_apart",
    "structure",
    "thermal",
    "transmission_error",
    "typeset",
    "variation",
    "with_faults",
]


def from_datasheet(ratio: float, **figures: Any) -> Gear:
    """The gear of `GearSet.from_datasheet`; that set also has the source of each number.

    Args:
        ratio: that with the circular spline held, signed, or with `fixed`
        figures: of the data sheet, as k1="31e3 N.m/rad"; `strainwave.files.datasheet.from_datasheet` describes all

    Raises:
        TypeError, ValueError: as there

    >>> gear = Gear.from_datasheet(ratio=-100, size=25, k1="0.9 kgf.m/arcmin")
    >>> round(gear.stiffness.k1)
    26190
    """
    return import_module("strainwave.files.datasheet").from_datasheet(ratio, **figures).gear  # type: ignore[no-any-return]


Gear.from_datasheet = staticmethod(from_datasheet)  # type: ignore[method-assign]
del from_datasheet
_presented_models.present(
    [
        *(compensation, control, fault, friction, hysteresis, kinematic_error, kinematics, loads, meter, motor, onset),
        *(sensor, softening, stiffness, structure, thermal, variation),
    ],
    [Gear, Drive, Compensation, Sensors],
)


def __getattr__(name: str) -> Any:
    if name not in _LAZY:
        raise AttributeError(f"module 'strainwave' has no attribute {name!r}")
    module = import_module(f"strainwave.{_LAZY[name]}")
    return module if name in ("diagnose", "export", "rig", "scenario", "typeset") else getattr(module, name)


def __dir__() -> list[str]:
    return __all__
