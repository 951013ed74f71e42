from .campbell_diagram import Campbell as Campbell
from .campbell_diagram import campbell as campbell
from .order_spectrum import (
    BearingOrders as BearingOrders,
)
from .order_spectrum import (
    Orders as Orders,
)
from .order_spectrum import (
    bearing_orders as bearing_orders,
)
from .order_spectrum import (
    order_amplitudes as order_amplitudes,
)
from .order_spectrum import (
    order_spectrum as order_spectrum,
)
from .torque_ripple import Ripple as Ripple
from .torque_ripple import ripple as ripple
from .two_encoders import TransmissionError as TransmissionError
