from . import scenario as scenario
from .controller import Observation as Observation
from .ensemble import EnsembleWarning as EnsembleWarning, simulate_to as simulate_to
from .scenario_file import ScenarioFile as ScenarioFile
