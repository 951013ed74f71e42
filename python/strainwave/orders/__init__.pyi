from .bearing_candidates import BearingCandidates as BearingCandidates, bearing_candidates as bearing_candidates
from .campbell_diagram import Campbell as Campbell, campbell as campbell
from .mesh.laws import MeshLaws as MeshLaws, mesh_laws as mesh_laws
from .order_spectrum import (
    BearingOrders as BearingOrders,
    Orders as Orders,
    bearing_orders as bearing_orders,
    order_amplitudes as order_amplitudes,
    order_spectrum as order_spectrum,
)
from .over_temperature import (
    ErrorOverTemperature as ErrorOverTemperature,
    error_over_temperature as error_over_temperature,
)
from .ring_modes import RingModes as RingModes, ring_modes as ring_modes
from .torque_ripple import Ripple as Ripple, ripple as ripple
from .tracked_orders import OrderTracks as OrderTracks, order_tracks as order_tracks
from .two_encoders import TransmissionError as TransmissionError
