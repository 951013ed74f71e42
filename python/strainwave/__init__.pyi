__all__: list[str]
from . import (
    analysis as analysis,
)
from . import (
    dataset as dataset,
)
from . import (
    diagnose as diagnose,
)
from . import (
    export as export,
)
from . import (
    files as files,
)
from . import (
    identification as identification,
)
from . import (
    native as native,
)
from . import (
    orders as orders,
)
from . import (
    rig as rig,
)
from . import (
    simulation as simulation,
)
from . import (
    tuning as tuning,
)
from ._core import (
    Compensation as Compensation,
)
from ._core import (
    Drive as Drive,
)
from ._core import (
    Gear as Gear,
)
from ._core import (
    PassivityWarning as PassivityWarning,
)
from ._core import (
    Sensors as Sensors,
)
from ._core import (
    compensation as compensation,
)
from ._core import (
    control as control,
)
from ._core import (
    fault as fault,
)
from ._core import (
    friction as friction,
)
from ._core import (
    hysteresis as hysteresis,
)
from ._core import (
    kinematic_error as kinematic_error,
)
from ._core import (
    kinematics as kinematics,
)
from ._core import (
    loads as loads,
)
from ._core import (
    meter as meter,
)
from ._core import (
    motor as motor,
)
from ._core import (
    onset as onset,
)
from ._core import (
    sensor as sensor,
)
from ._core import (
    softening as softening,
)
from ._core import (
    stiffness as stiffness,
)
from ._core import (
    structure as structure,
)
from ._core import (
    thermal as thermal,
)
from ._core import (
    variation as variation,
)
from .analysis.compare import compare as compare
from .analysis.linear import linearise as linearise
from .analysis.output_torque import output_torque as output_torque
from .files.gear_set import GearSet as GearSet
from .files.gear_set import catalogue as catalogue
from .files.gear_set import load as load
from .files.gear_set import save as save
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
from .simulation.ensemble import Ensemble as Ensemble
from .simulation.ensemble import simulate_many as simulate_many
from .simulation.ensemble import simulate_to as simulate_to
from .simulation.run import Run as Run
from .simulation.run import simulate as simulate
from .simulation.run import simulate_adaptively as simulate_adaptively
from .tuning.compensate import compensate as compensate
from .tuning.loops import cascade as cascade
