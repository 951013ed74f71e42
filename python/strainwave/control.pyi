"""What turns the command into the motor's voltage, current or torque."""

from typing import Any


class OpenLoop:
    """
    No controller: the command, times a gain, is what the motor takes.

    .. math:: u = g r

    with r the command, u the voltage [V] of a DC motor, the current [A] of a current source or the torque [N.m] of a
    torque source, g = gain (an amplifier's). The command has the unit of u.

    >>> from strainwave.control import OpenLoop
    >>> OpenLoop().gain
    1.0

    Parameters
    ----------
    gain: Actuation per command; default 1.0

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
        """Actuation per command"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'open_loop'

    source: str = 'definition'

    fields: tuple[dict[str, Any], ...]

class PID:
    """
    Position controller: proportional, integral, derivative, with the supply voltage as limit.

    .. math:: u = \\operatorname{clip}(k_p \\epsilon + k_i \\textstyle\\int \\epsilon\\,dt + k_d \\dot\\epsilon, \\pm u_{max}), \\qquad
              \\epsilon = i r - \\theta_{in} \\text{ or } \\epsilon = i\\,(r - \\theta_{out})

    with r the commanded output angle [rad], i the signed ratio, k_p = proportional, k_i = integral, k_d = derivative,
    u_max = limit. The error is that of the encoder which feedback names. Where it is the motor's, on the input shaft,
    kinematic error and wind-up of the gear stay outside the loop. Where it is on the output shaft the loop sees them; the
    error is referred to the input, so that the gains mean the same. The integral rests while the voltage is limited.

    u is a voltage, and the units below are those, of a motor that takes one. For a motor that takes a current or a torque
    read A or N.m in place of V.

    >>> from strainwave.control import PID
    >>> PID(proportional=2.0, derivative=0.05, limit=48.0).integral
    0.0

    Parameters
    ----------
    proportional: Voltage per input angle [V/rad], in [0, inf); default 1.0
    integral: Voltage per integral of the input angle error [V/(rad.s)], in [0, inf); default 0.0
    derivative: Voltage per input speed error [V.s/rad], in [0, inf); default 0.0
    limit: Largest voltage, of either sign [V], in (0, inf); default 48.0
    feedback: The shaft whose encoder the loop closes on, one of ('input', 'output'); default 'input'

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    AstromHagglund1995, chapter 3; anti-windup by conditional integration, section 3.5
    """

    def __init__(self, *, proportional: float = ..., integral: float = ..., derivative: float = ..., limit: float = ..., feedback: str = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, proportional: float = ..., integral: float = ..., derivative: float = ..., limit: float = ..., feedback: str = ...) -> PID:
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

    @property
    def feedback(self) -> str:
        """The shaft whose encoder the loop closes on"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'pid'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

class Sampled:
    """
    A controller that runs in a computer: it acts at instants and holds its output between them.

    .. math:: u(t) = u_k, \\quad t_k + d \\le t < t_{k+1} + d, \\qquad u_k = \\text{law}(x_k, r_k, y_k), \\qquad
              x_{k+1} = x_k + T \\dot x_k

    with t_k = k T, T = period, d = delay (what computing takes, at most a period), r_k and y_k command and measurement at
    t_k, x_k the numbers of the law, such as an integral. Before the first output the actuation is 0. Steps end at each t_k
    and each t_k + d, so what happens at an instant happens exactly there. The law is any that is not sampled itself.

    In an ensemble, period and delay are the same for all members. They have no derivatives: time is not among the numbers.

    >>> from strainwave.control import PID, Sampled
    >>> law = PID(proportional=2.0, derivative=0.05)
    >>> Sampled(law=law, period=1e-3, delay=2e-4).law.proportional
    2.0

    Parameters
    ----------
    law: What is worked out at each instant; default OpenLoop(gain=1.0)
    period: Time from one sample to the next [s], in (0, inf); default 0.001
    delay: Time from a sample to the output that is worked out from it [s], in [0, inf); default 0.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    AstromWittenmark1997, chapter 8: zero-order hold, integrals by forward differences
    """

    def __init__(self, *, law: OpenLoop | PID = ..., period: float = ..., delay: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, law: OpenLoop | PID = ..., period: float = ..., delay: float = ...) -> Sampled:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def law(self) -> OpenLoop | PID:
        """What is worked out at each instant"""

    @property
    def period(self) -> float:
        """Time from one sample to the next [s]"""

    @property
    def delay(self) -> float:
        """Time from a sample to the output that is worked out from it [s]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'sampled'

    source: str = ...

    fields: tuple[dict[str, Any], ...]
