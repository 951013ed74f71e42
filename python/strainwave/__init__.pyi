__all__: list[str]
from . import (
    analysis as analysis,
    dataset as dataset,
    diagnose as diagnose,
    export as export,
    files as files,
    identification as identification,
    native as native,
    orders as orders,
    rig as rig,
    simulation as simulation,
    tuning as tuning,
    typeset as typeset,
)
from ._core import (
    Compensation as Compensation,
    Drive as Drive,
    Gear as Gear,
    PassivityWarning as PassivityWarning,
    Sensors as Sensors,
    compensation as compensation,
    control as control,
    fault as fault,
    friction as friction,
    hysteresis as hysteresis,
    kinematic_error as kinematic_error,
    kinematics as kinematics,
    loads as loads,
    material as material,
    meter as meter,
    motor as motor,
    onset as onset,
    ring as ring,
    sensor as sensor,
    softening as softening,
    stiffness as stiffness,
    structure as structure,
    thermal as thermal,
    variation as variation,
)
from .analysis.compare import compare as compare
from .analysis.linear import linearise as linearise
from .files.gear_set import GearSet as GearSet, catalogue as catalogue, load as load, save as save
from .files.ratings import check_ratings as check_ratings
from .files.recording import Recording as Recording
from .identification.fitting.fit import fit as fit
from .identification.identify import identify as identify
from .identification.predict import predict as predict
from .identification.reading.mapping import FileMapping as FileMapping
from .native.compile import compile as compile
from .orders.two_encoders import transmission_error as transmission_error
from .report.listing import listing as listing
from .simulation import scenario as scenario
from .simulation.controller import simulate_controlled as simulate_controlled
from .simulation.ensemble import Ensemble as Ensemble, simulate_many as simulate_many
from .simulation.run import Run as Run, simulate as simulate, simulate_adaptively as simulate_adaptively
from .tuning.compensate import compensate as compensate
from .tuning.loops import cascade as cascade
