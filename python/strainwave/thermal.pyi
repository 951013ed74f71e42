"""Temperatures of a drive."""

from typing import Any


class Isothermal:
    """
    A drive whose gear and whose winding are as warm as the temperature of the run says.

    .. math:: T_w = T_g = T(t)

    with T(t) the input temperature.

    >>> from strainwave.thermal import Isothermal
    >>> Isothermal()
    Isothermal()

    Parameters
    ----------

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition
    """

    def __init__(self) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /) -> Isothermal:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'isothermal'

    source: str = 'definition'

    fields: tuple[dict[str, Any], ...]

    @property
    def active(self) -> bool:
        """Whether it makes any difference."""

class Heating:
    """
    Winding and gear, warmed by what motor and gear lose.

    .. math:: C_w \\dot T_w = P_w - \\frac{T_w - T}{R_w} - G\\,(T_w - T_g), \\qquad
              C_g \\dot T_g = P_g - \\frac{T_g - T}{R_g} + G\\,(T_w - T_g)

    with T the temperature of the run, which is the ambient one; P_w what the motor loses; P_g what friction at all three places,
    damping and hysteresis take; C_w, C_g = winding_capacity, gear_capacity, R_w, R_g = winding_resistance, gear_resistance
    towards the air, G = coupling between both. All begin at initial_temperature. What the hysteresis holds back for a moment
    counts as heat at once: over a cycle that is the same. Leaves out the little heat that softening makes of elastic energy.

    Data sheets of motors give R_w and the time constant R_w C_w. For a gear the values follow from how its housing warms up.

    >>> from strainwave.thermal import Heating
    >>> body = Heating(winding_capacity=120.0, winding_resistance=2.5, gear_capacity=600.0, gear_resistance=0.8)
    >>> body.winding_capacity * body.winding_resistance  # time constant, s
    300.0

    Parameters
    ----------
    winding_capacity: Heat capacity C_w of the winding [J/K], in (0, inf); required
    winding_resistance: Thermal resistance R_w from winding to air [K/W], in (0, inf); required
    gear_capacity: Heat capacity C_g of the gear [J/K], in (0, inf); required
    gear_resistance: Thermal resistance R_g from gear to air [K/W], in (0, inf); required
    coupling: Heat flow G from winding to gear per difference of temperature [W/K], in [0, inf); default 0.0
    initial_temperature: Temperature of both where a run begins [K], in (0, inf); default 293.15

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition: two bodies of one temperature each; Newton1701 for what they give to the air
    """

    def __init__(self, *, winding_capacity: float, winding_resistance: float, gear_capacity: float, gear_resistance: float, coupling: float = ..., initial_temperature: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, winding_capacity: float = ..., winding_resistance: float = ..., gear_capacity: float = ..., gear_resistance: float = ..., coupling: float = ..., initial_temperature: float = ...) -> Heating:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def winding_capacity(self) -> float:
        """Heat capacity C_w of the winding [J/K]"""

    @property
    def winding_resistance(self) -> float:
        """Thermal resistance R_w from winding to air [K/W]"""

    @property
    def gear_capacity(self) -> float:
        """Heat capacity C_g of the gear [J/K]"""

    @property
    def gear_resistance(self) -> float:
        """Thermal resistance R_g from gear to air [K/W]"""

    @property
    def coupling(self) -> float:
        """Heat flow G from winding to gear per difference of temperature [W/K]"""

    @property
    def initial_temperature(self) -> float:
        """Temperature of both where a run begins [K]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'heating'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    @property
    def active(self) -> bool:
        """Whether it makes any difference."""
