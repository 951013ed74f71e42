from .excitation.plan import ExperimentPlan as ExperimentPlan, plan_experiments as plan_experiments
from .fitting.bootstrap import Bootstrap as Bootstrap, bootstrap as bootstrap
from .fitting.combinations import Combination as Combination, combinations as combinations
from .fitting.fit import Fit as Fit
from .fitting.minima import Minima as Minima, minima as minima
from .fitting.profile import Profile as Profile, profile as profile
from .identify import Identified as Identified
from .results.prediction import Prediction as Prediction
