from .actuator_ramp import (
    LOOPS as LOOPS,
    ActuatorRamp as ActuatorRamp,
    in_series as in_series,
    wave_generator as wave_generator,
)
from .current_orders import OrderLine as OrderLine, order_lines as order_lines
from .inversion import (
    COMBINE as COMBINE,
    MisalignmentEstimate as MisalignmentEstimate,
    RecoveryModel as RecoveryModel,
    corrected as corrected,
    displaced as displaced,
    recover as recover,
    refined as refined,
)
from .misalignment_sweep import (
    BOTH_LOOPS as BOTH_LOOPS,
    LOBES as LOBES,
    SWEEPS as SWEEPS,
    SweepLevels as SweepLevels,
    level_lines as level_lines,
    sweep_misalignment as sweep_misalignment,
    swing as swing,
    table_number as table_number,
)
from .smallest_error import DetectionLimit as DetectionLimit, detection_limit as detection_limit
from .wear import (
    WearLife as WearLife,
    transmitted_work as transmitted_work,
    wear_life as wear_life,
)
