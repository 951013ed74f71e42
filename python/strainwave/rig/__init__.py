"""The torsion test rig: images of two markers and masses on pans in, the loop of a gear, its stiffness and lost motion out.

What is here is what one calls, and what that gives back. The parts of a result, and the steps on the way to it, are in the
modules of the rooms: `bench`, `torque`, `running`, `vision`, `reading`, `analysis`, `influence` and `virtual`.
"""

from strainwave.rig.analysis.analysis import LoopAnalysis, LoopSummary, analyse, table
from strainwave.rig.analysis.comparison import Comparison, compare
from strainwave.rig.analysis.regimes import cycles
from strainwave.rig.analysis.result import Result
from strainwave.rig.analysis.sides import friction_at_rest, referred, without_friction
from strainwave.rig.analysis.soft_spot import words_on_band
from strainwave.rig.analysis.stiffness import closure_of_secants, soft_parts
from strainwave.rig.bench.rig_file import load, rigs, write_rig
from strainwave.rig.bench.setup import Camera, Masses, Rig, Value
from strainwave.rig.bench.steps import Step
from strainwave.rig.bench.steps_file import append_step, read_steps, write_steps
from strainwave.rig.influence.cycle import Cycle, Factors, cycle, cycle_to
from strainwave.rig.influence.series import Series, analyse_series, read_series, series_of
from strainwave.rig.influence.trend import Trend
from strainwave.rig.influence.trend_words import trend_words
from strainwave.rig.loop import Loop
from strainwave.rig.reading.measurement import TorsionTest, loops, read_test
from strainwave.rig.reading.recorded import read_loop
from strainwave.rig.running.plan import Plan, plan
from strainwave.rig.running.plan_check import Deviation, check
from strainwave.rig.torque.budget import Budget, angle_budget, stiffness_budget, torque_budget
from strainwave.rig.torque.torque import Torque, blank, torque_of
from strainwave.rig.virtual.printed import printed_gear
from strainwave.rig.virtual.render import Scene, render
from strainwave.rig.virtual.test import VirtualTest, simulate_test
from strainwave.rig.vision.angle import Angles, Marker, camera_seen, measure_angles
from strainwave.rig.vision.circle import Circle, geometric, kasa, pratt, taubin
from strainwave.rig.vision.image import Image, as_image, read_image
from strainwave.rig.vision.marker import find_markers

__all__ = [
    "Angles",
    "Budget",
    "Camera",
    "Circle",
    "Comparison",
    "Cycle",
    "Deviation",
    "Factors",
    "Image",
    "Loop",
    "LoopAnalysis",
    "LoopSummary",
    "Marker",
    "Masses",
    "Plan",
    "Result",
    "Rig",
    "Scene",
    "Series",
    "Step",
    "Torque",
    "TorsionTest",
    "Trend",
    "Value",
    "VirtualTest",
    "analyse",
    "analyse_series",
    "angle_budget",
    "append_step",
    "as_image",
    "blank",
    "camera_seen",
    "check",
    "closure_of_secants",
    "compare",
    "cycle",
    "cycle_to",
    "cycles",
    "find_markers",
    "friction_at_rest",
    "geometric",
    "kasa",
    "load",
    "loops",
    "measure_angles",
    "plan",
    "pratt",
    "printed_gear",
    "read_image",
    "read_loop",
    "read_series",
    "read_steps",
    "read_test",
    "referred",
    "render",
    "rigs",
    "series_of",
    "simulate_test",
    "soft_parts",
    "stiffness_budget",
    "table",
    "taubin",
    "torque_budget",
    "torque_of",
    "trend_words",
    "without_friction",
    "words_on_band",
    "write_rig",
    "write_steps",
]
