"""How a gear gives way as it warms up."""

from typing import Any


class ThermalSoftening:
    """
    A gear whose spring and whose hysteresis give way as it warms up.

    .. math:: T = e^{-\\kappa_s (T_g - T_0)}\\, T_{stiffness} + e^{-\\kappa_h (T_g - T_0)}\\, T_{hysteresis} + c\\,\\dot\\delta

    with T_g the temperature of the gear, T_0 = reference_temperature, kappa_s = stiffness_fall, kappa_h = hysteresis_fall. The
    laws of stiffness and hysteresis are those at T_0. No catalogue gives the rates; the elastic modulus of steel falls by
    some 2e-4 to 3e-4 per kelvin (assumed). Valid over some tens of kelvin. Elastic energy that a spring loses while it
    warms up turns to heat.

    >>> from strainwave.softening import ThermalSoftening
    >>> ThermalSoftening(stiffness_fall=3e-4).stiffness_fall
    0.0003

    Parameters
    ----------
    stiffness_fall: Relative fall kappa_s of the stiffness per kelvin [1/K]; default 0.0
    hysteresis_fall: Relative fall kappa_h of the hysteresis per kelvin [1/K]; default 0.0
    reference_temperature: Temperature T_0 at which the laws hold [K], in (0, inf); default 293.15

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    document R, section on temperature, which states the direction only: the exponential form is assumed, its rates are the user's
    """

    def __init__(self, *, stiffness_fall: float = ..., hysteresis_fall: float = ..., reference_temperature: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, stiffness_fall: float = ..., hysteresis_fall: float = ..., reference_temperature: float = ...) -> ThermalSoftening:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def stiffness_fall(self) -> float:
        """Relative fall kappa_s of the stiffness per kelvin [1/K]"""

    @property
    def hysteresis_fall(self) -> float:
        """Relative fall kappa_h of the hysteresis per kelvin [1/K]"""

    @property
    def reference_temperature(self) -> float:
        """Temperature T_0 at which the laws hold [K]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'thermal_softening'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    @property
    def active(self) -> bool:
        """Whether it makes any difference."""
