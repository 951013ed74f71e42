from .analysis.analysis import LoopAnalysis as LoopAnalysis, LoopSummary as LoopSummary, analyse as analyse, table as table
from .analysis.comparison import Comparison as Comparison, compare as compare
from .analysis.cycle import Cycle as Cycle, Factors as Factors, cycle as cycle, cycle_to as cycle_to
from .analysis.regimes import cycles as cycles
from .analysis.result import Result as Result
from .analysis.sides import friction_at_rest as friction_at_rest, referred as referred, without_friction as without_friction
from .analysis.stiffness import (
    closure_of_secants as closure_of_secants,
    soft_parts as soft_parts,
    words_on_band as words_on_band,
)
from .bench.rig_file import load as load, rigs as rigs, write_rig as write_rig
from .bench.setup import Camera as Camera, Masses as Masses, Rig as Rig, Value as Value
from .bench.steps import Step as Step, append_step as append_step, read_steps as read_steps, write_steps as write_steps
from .bench.torque import (
    Budget as Budget,
    Torque as Torque,
    angle_budget as angle_budget,
    blank as blank,
    stiffness_budget as stiffness_budget,
    torque_budget as torque_budget,
    torque_of as torque_of,
)
from .influence.series import (
    Series as Series,
    analyse_series as analyse_series,
    read_series as read_series,
    series_of as series_of,
    trend_words as trend_words,
)
from .influence.trend import Trend as Trend
from .loop import Loop as Loop
from .reading.measurement import TorsionTest as TorsionTest, loops as loops, read_test as read_test
from .reading.recorded import read_loop as read_loop
from .running.plan import Deviation as Deviation, Plan as Plan, check as check, plan as plan
from .virtual.printed import printed_gear as printed_gear
from .virtual.render import Scene as Scene, render as render
from .virtual.test import VirtualTest as VirtualTest, simulate_test as simulate_test
from .vision.angle import Angles as Angles, camera_seen as camera_seen, measure_angles as measure_angles
from .vision.circle import Circle as Circle, geometric as geometric, kasa as kasa, pratt as pratt, taubin as taubin
from .vision.image import Image as Image, as_image as as_image, read_image as read_image
from .vision.marker import Marker as Marker, find_markers as find_markers
