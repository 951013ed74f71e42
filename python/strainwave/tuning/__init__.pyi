from .approach import (
    LostMotion as LostMotion,
    PositioningPath as PositioningPath,
    lost_motion as lost_motion,
    positioning_path as positioning_path,
)
from .compensate import Compensated as Compensated
from .linear_quadratic import lqg as lqg
from .loops import LoopMargins as LoopMargins, loop_margins as loop_margins
from .model_predictive import PredictiveController as PredictiveController, mpc as mpc
from .pulses import (
    PulsedMove as PulsedMove,
    PulsePlan as PulsePlan,
    PulseRepeatability as PulseRepeatability,
    plan_pulses as plan_pulses,
    position_by_pulses as position_by_pulses,
    pulse_repeatability as pulse_repeatability,
    pulse_travel as pulse_travel,
    pulse_width as pulse_width,
)
