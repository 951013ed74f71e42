from .compare import Agreement as Agreement, Difference as Difference
from .error_bounds import ErrorBound as ErrorBound, positioning_error as positioning_error
from .linear import Linearisation as Linearisation, modes as modes
from .measured_command import MeasuredCommand as MeasuredCommand
from .output_torque import OutputTorque as OutputTorque, output_torque as output_torque
from .response import FrequencyResponse as FrequencyResponse, frequency_response as frequency_response
from .sensitivity import Derivatives as Derivatives, derivatives as derivatives
from .settling import settling_time as settling_time
from .steady import equilibrium as equilibrium
from .strokes import stroke_within as stroke_within, strokes_apart as strokes_apart
