"""The torsion test rig: images of two markers and masses on pans in, the loop of a gear, its stiffness and lost motion out."""

from strainwave.rig.analysis.analysis import LoopAnalysis, Row, analyse, table
from strainwave.rig.analysis.catalogue_check import CatalogueCheck
from strainwave.rig.analysis.comparison import Compared, Comparison, compare
from strainwave.rig.analysis.lost_motion import Width
from strainwave.rig.analysis.regimes import Regime, Segmented, cycles, segment
from strainwave.rig.analysis.result import Result
from strainwave.rig.analysis.sides import friction_at_rest, referred, without_friction
from strainwave.rig.analysis.soft_spot import SoftSpot, soft_spots, words_on_band
from strainwave.rig.analysis.stiffness import LocalStiffness, Stiffness, closure_of_secants, soft_parts
from strainwave.rig.bench.rig_file import load, rigs, write_rig
from strainwave.rig.bench.setup import Camera, Masses, Rig, Value
from strainwave.rig.bench.steps import Step
from strainwave.rig.bench.steps_file import append_step, read_steps, write_steps
from strainwave.rig.influence.influence import Influence
from strainwave.rig.influence.series import Series, analyse_series, read_series
from strainwave.rig.influence.trend import Trend
from strainwave.rig.loop import Loop
from strainwave.rig.reading.measurement import TorsionTest, loops, read_test
from strainwave.rig.reading.recorded import loop_of, read_loop
from strainwave.rig.running.plan import Plan, Stage, plan, reachable, task
from strainwave.rig.running.plan_check import Finding, check
from strainwave.rig.torque.budget import Budget, Contribution, angle_budget, stiffness_budget, torque_budget
from strainwave.rig.torque.couple import Couple, couple_of
from strainwave.rig.torque.torque import Torque, arm, blank, torque_of
from strainwave.rig.virtual.loading import Loading, load_by_steps
from strainwave.rig.virtual.printed import gear_of_regimes, printed_gear
from strainwave.rig.virtual.render import Scene, render
from strainwave.rig.virtual.test import VirtualTest, simulate_test
from strainwave.rig.vision.angle import Angles, Frame, Marker, camera_seen, follow, look, measure_angles, turn
from strainwave.rig.vision.circle import Circle, geometric, kasa, pratt, taubin
from strainwave.rig.vision.image import Image, as_image, read_image
from strainwave.rig.vision.marker import find_markers

__all__ = [
    "Angles",
    "Budget",
    "Camera",
    "CatalogueCheck",
    "Circle",
    "Compared",
    "Comparison",
    "Contribution",
    "Couple",
    "Finding",
    "Frame",
    "Image",
    "Influence",
    "Loading",
    "LocalStiffness",
    "Loop",
    "LoopAnalysis",
    "Marker",
    "Masses",
    "Plan",
    "Regime",
    "Result",
    "Rig",
    "Row",
    "Scene",
    "Segmented",
    "Series",
    "SoftSpot",
    "Stage",
    "Step",
    "Stiffness",
    "Torque",
    "TorsionTest",
    "Trend",
    "Value",
    "VirtualTest",
    "Width",
    "analyse",
    "analyse_series",
    "angle_budget",
    "append_step",
    "arm",
    "as_image",
    "blank",
    "camera_seen",
    "check",
    "closure_of_secants",
    "compare",
    "couple_of",
    "cycles",
    "find_markers",
    "follow",
    "friction_at_rest",
    "gear_of_regimes",
    "geometric",
    "kasa",
    "load",
    "load_by_steps",
    "look",
    "loop_of",
    "loops",
    "measure_angles",
    "plan",
    "pratt",
    "printed_gear",
    "reachable",
    "read_image",
    "read_loop",
    "read_series",
    "read_steps",
    "read_test",
    "referred",
    "render",
    "rigs",
    "segment",
    "simulate_test",
    "soft_parts",
    "soft_spots",
    "stiffness_budget",
    "table",
    "task",
    "taubin",
    "torque_budget",
    "torque_of",
    "turn",
    "without_friction",
    "words_on_band",
    "write_rig",
    "write_steps",
]
