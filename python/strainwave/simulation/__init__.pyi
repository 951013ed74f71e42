from . import scenario as scenario
from .controller import Observation as Observation
from .ensemble import EnsembleWarning as EnsembleWarning
from .scenario_file import ScenarioFile as ScenarioFile
