from .approach import (
    LostMotion as LostMotion,
)
from .approach import (
    PositioningPath as PositioningPath,
)
from .approach import (
    lost_motion as lost_motion,
)
from .approach import (
    positioning_path as positioning_path,
)
from .compensate import Compensated as Compensated
from .linear_quadratic import lqg as lqg
from .loops import LoopMargins as LoopMargins
from .loops import loop_margins as loop_margins
from .model_predictive import PredictiveController as PredictiveController
from .model_predictive import mpc as mpc
from .pulses import (
    PulsedMove as PulsedMove,
)
from .pulses import (
    PulsePlan as PulsePlan,
)
from .pulses import (
    PulseRepeatability as PulseRepeatability,
)
from .pulses import (
    plan_pulses as plan_pulses,
)
from .pulses import (
    position_by_pulses as position_by_pulses,
)
from .pulses import (
    pulse_repeatability as pulse_repeatability,
)
from .pulses import (
    pulse_travel as pulse_travel,
)
from .pulses import (
    pulse_width as pulse_width,
)
