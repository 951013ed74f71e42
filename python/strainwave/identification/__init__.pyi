from .candidates.torsion.losses.shares import LossShare as LossShare, LossShares as LossShares, loss_shares as loss_shares
from .excitation.loops import plan_loops as plan_loops
from .excitation.plan import ExperimentPlan as ExperimentPlan, plan_experiments as plan_experiments
from .fitting.confidence import (
    Bootstrap as Bootstrap,
    Minima as Minima,
    Profile as Profile,
    bootstrap as bootstrap,
    minima as minima,
    profile as profile,
)
from .fitting.fit import Fit as Fit
from .fitting.influence import Combination as Combination, combinations as combinations
from .identify import Identified as Identified
from .results.prediction import Prediction as Prediction
