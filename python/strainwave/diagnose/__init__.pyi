from .actuator_ramp import (
    LOOPS as LOOPS,
)
from .actuator_ramp import (
    ActuatorRamp as ActuatorRamp,
)
from .actuator_ramp import (
    in_series as in_series,
)
from .actuator_ramp import (
    wave_generator as wave_generator,
)
from .current_orders import OrderLine as OrderLine
from .current_orders import order_lines as order_lines
from .inversion import COMBINE as COMBINE
from .inversion import MisalignmentEstimate as MisalignmentEstimate
from .inversion import displaced as displaced
from .misalignment_sweep import (
    BOTH_LOOPS as BOTH_LOOPS,
)
from .misalignment_sweep import (
    LOBES as LOBES,
)
from .misalignment_sweep import (
    SWEEPS as SWEEPS,
)
from .misalignment_sweep import (
    SweepLevels as SweepLevels,
)
from .misalignment_sweep import (
    level_lines as level_lines,
)
from .misalignment_sweep import (
    sweep_misalignment as sweep_misalignment,
)
from .misalignment_sweep import (
    swing as swing,
)
from .misalignment_sweep import (
    table_number as table_number,
)
from .recovery import RecoveryModel as RecoveryModel
from .recovery import corrected as corrected
from .recovery import recover as recover
from .recovery import refined as refined
from .smallest_error import DetectionLimit as DetectionLimit
from .smallest_error import detection_limit as detection_limit
