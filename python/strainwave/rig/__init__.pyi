from .analysis.analysis import LoopAnalysis as LoopAnalysis
from .analysis.analysis import LoopSummary as LoopSummary
from .analysis.analysis import analyse as analyse
from .analysis.analysis import table as table
from .analysis.comparison import Comparison as Comparison
from .analysis.comparison import compare as compare
from .analysis.regimes import cycles as cycles
from .analysis.result import Result as Result
from .analysis.sides import friction_at_rest as friction_at_rest
from .analysis.sides import referred as referred
from .analysis.sides import without_friction as without_friction
from .analysis.soft_spot import words_on_band as words_on_band
from .analysis.stiffness import closure_of_secants as closure_of_secants
from .analysis.stiffness import soft_parts as soft_parts
from .bench.rig_file import load as load
from .bench.rig_file import rigs as rigs
from .bench.rig_file import write_rig as write_rig
from .bench.setup import Camera as Camera
from .bench.setup import Masses as Masses
from .bench.setup import Rig as Rig
from .bench.setup import Value as Value
from .bench.steps import Step as Step
from .bench.steps_file import append_step as append_step
from .bench.steps_file import read_steps as read_steps
from .bench.steps_file import write_steps as write_steps
from .influence.cycle import Cycle as Cycle
from .influence.cycle import Factors as Factors
from .influence.cycle import cycle as cycle
from .influence.cycle import cycle_to as cycle_to
from .influence.series import (
    Series as Series,
)
from .influence.series import (
    analyse_series as analyse_series,
)
from .influence.series import (
    read_series as read_series,
)
from .influence.series import (
    series_of as series_of,
)
from .influence.trend import Trend as Trend
from .influence.trend_words import trend_words as trend_words
from .loop import Loop as Loop
from .reading.measurement import TorsionTest as TorsionTest
from .reading.measurement import loops as loops
from .reading.measurement import read_test as read_test
from .reading.recorded import read_loop as read_loop
from .running.plan import Plan as Plan
from .running.plan import plan as plan
from .running.plan_check import Deviation as Deviation
from .running.plan_check import check as check
from .torque.budget import (
    Budget as Budget,
)
from .torque.budget import (
    angle_budget as angle_budget,
)
from .torque.budget import (
    stiffness_budget as stiffness_budget,
)
from .torque.budget import (
    torque_budget as torque_budget,
)
from .torque.torque import Torque as Torque
from .torque.torque import blank as blank
from .torque.torque import torque_of as torque_of
from .virtual.printed import printed_gear as printed_gear
from .virtual.render import Scene as Scene
from .virtual.render import render as render
from .virtual.test import VirtualTest as VirtualTest
from .virtual.test import simulate_test as simulate_test
from .vision.angle import Angles as Angles
from .vision.angle import Marker as Marker
from .vision.angle import camera_seen as camera_seen
from .vision.angle import measure_angles as measure_angles
from .vision.circle import Circle as Circle
from .vision.circle import geometric as geometric
from .vision.circle import kasa as kasa
from .vision.circle import pratt as pratt
from .vision.circle import taubin as taubin
from .vision.image import Image as Image
from .vision.image import as_image as as_image
from .vision.image import read_image as read_image
from .vision.marker import find_markers as find_markers
