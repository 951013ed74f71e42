"""What turns the command into the motor's voltage."""

from typing import Any


class OpenLoop:
    """
    No controller: the command, times a gain, is the motor's voltage.

    .. math:: u = g r

    with r the command [V], g = gain (an amplifier's).

    >>> from strainwave.control import OpenLoop
    >>> OpenLoop().gain
    1.0

    Parameters
    ----------
    gain: Voltage per command; default 1.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition
    """

    def __init__(self, *, gain: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, gain: float = ...) -> OpenLoop:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def gain(self) -> float:
        """Voltage per command"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'open_loop'

    source: str = 'definition'

    fields: tuple[dict[str, Any], ...]

    command_unit: str = 'V'

class PID:
    """
    Position controller at the input: proportional, integral, derivative, with the supply voltage as limit.

    .. math:: u = \\operatorname{clip}(k_p \\epsilon + k_i \\textstyle\\int \\epsilon\\,dt + k_d \\dot\\epsilon, \\pm u_{max}), \\qquad
              \\epsilon = i r - \\theta_{in}

    with r the commanded output angle [rad], i the signed ratio, theta_in the input angle, k_p = proportional,
    k_i = integral, k_d = derivative, u_max = limit. The integral rests while the voltage is limited. The feedback is the
    motor's encoder, so error and wind-up of the gear stay outside the loop.

    >>> from strainwave.control import PID
    >>> PID(proportional=2.0, derivative=0.05, limit=48.0).integral
    0.0

    Parameters
    ----------
    proportional: Voltage per input angle [V/rad], in [0, inf); default 1.0
    integral: Voltage per integral of the input angle error [V/(rad.s)], in [0, inf); default 0.0
    derivative: Voltage per input speed error [V.s/rad], in [0, inf); default 0.0
    limit: Largest voltage, of either sign [V], in (0, inf); default 48.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    AstromHagglund1995, chapter 3; anti-windup by conditional integration, section 3.5
    """

    def __init__(self, *, proportional: float = ..., integral: float = ..., derivative: float = ..., limit: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, proportional: float = ..., integral: float = ..., derivative: float = ..., limit: float = ...) -> PID:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def proportional(self) -> float:
        """Voltage per input angle [V/rad]"""

    @property
    def integral(self) -> float:
        """Voltage per integral of the input angle error [V/(rad.s)]"""

    @property
    def derivative(self) -> float:
        """Voltage per input speed error [V.s/rad]"""

    @property
    def limit(self) -> float:
        """Largest voltage, of either sign [V]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'pid'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    command_unit: str = 'rad'
