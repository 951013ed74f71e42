"""Elastic torque over the twist."""

from collections.abc import Sequence
from typing import Any, overload

import numpy
import numpy.typing


class Linear:
    """
    A spring of constant stiffness.

    .. math:: T = k \\delta

    with delta the twist, k = k. Leaves out that a strain wave gear stiffens under load.

    >>> from strainwave.stiffness import Linear
    >>> Linear(k=150.0).torque(0.1)
    15.0

    Parameters
    ----------
    k: Stiffness [N.m/rad], in (0, inf); default 10000.0

    Raises
    ------
    TypeError: an unknown parameter, or one of the wrong kind
    ValueError: a number that is not finite or out of its range

    Source
    ------
    Hooke's law; document P, K_s
    """

    def __init__(self, *, k: float = ...) -> None: ...

    def replace(self, *, k: float = ...) -> Linear:
        """The same with the named parameters changed."""

    @property
    def k(self) -> float:
        """Stiffness [N.m/rad]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    name: str = 'linear'

    source: str = "Hooke's law; document P, K_s"

    fields: tuple[dict[str, Any], ...]

    @overload
    def torque(self, twist: float) -> float: ...

    @overload
    def torque(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """Torque [N.m] at `twist` [rad]."""

    @overload
    def twist(self, torque: float) -> float: ...

    @overload
    def twist(self, torque: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """Twist [rad] at `torque` [N.m], the inverse of `torque`."""

    @overload
    def tangent(self, twist: float) -> float: ...

    @overload
    def tangent(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """Stiffness dT/d(twist) [N.m/rad] at `twist` [rad]."""

    @overload
    def energy(self, twist: float) -> float: ...

    @overload
    def energy(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """Elastic energy [J] at `twist` [rad]."""

class Cubic:
    """
    A spring that stiffens smoothly under load.

    .. math:: T = a_1 \\delta + a_3 \\delta^3

    with delta the twist, a_1 = a1 > 0, a_3 = a3 >= 0. Odd and strictly increasing, so every torque has one twist. Valid
    over the range it was fitted on; beyond, the cubic stiffens faster than any gear.

    >>> from strainwave.stiffness import Cubic
    >>> spring = Cubic(a1=1.2e4, a3=1e9)
    >>> round(spring.twist(spring.torque(1e-3)), 12)
    0.001

    Parameters
    ----------
    a1: Stiffness at zero twist [N.m/rad], in (0, inf); default 10000.0
    a3: Hardening [N.m/rad3], in [0, inf); default 0.0

    Raises
    ------
    TypeError: an unknown parameter, or one of the wrong kind
    ValueError: a number that is not finite or out of its range

    Source
    ------
    document R, section 3, cubic polynomial; Tuttle1992
    """

    def __init__(self, *, a1: float = ..., a3: float = ...) -> None: ...

    def replace(self, *, a1: float = ..., a3: float = ...) -> Cubic:
        """The same with the named parameters changed."""

    @property
    def a1(self) -> float:
        """Stiffness at zero twist [N.m/rad]"""

    @property
    def a3(self) -> float:
        """Hardening [N.m/rad3]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    name: str = 'cubic'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    @overload
    def torque(self, twist: float) -> float: ...

    @overload
    def torque(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """Torque [N.m] at `twist` [rad]."""

    @overload
    def twist(self, torque: float) -> float: ...

    @overload
    def twist(self, torque: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """Twist [rad] at `torque` [N.m], the inverse of `torque`."""

    @overload
    def tangent(self, twist: float) -> float: ...

    @overload
    def tangent(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """Stiffness dT/d(twist) [N.m/rad] at `twist` [rad]."""

    @overload
    def energy(self, twist: float) -> float: ...

    @overload
    def energy(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """Elastic energy [J] at `twist` [rad]."""

class ThreeSegment:
    """
    The catalogue's spring: three straight segments that meet at two torques, odd in the twist.

    .. math:: \\delta(T) = T / K_1 \\; (T \\le T_1), \\quad T_1/K_1 + (T - T_1)/K_2 \\; (T \\le T_2), \\quad
              T_1/K_1 + (T_2 - T_1)/K_2 + (T - T_2)/K_3

    with delta the twist, K_i = k1, k2, k3, T_i = t1, t2. The slope jumps at the knees. Individual gears differ from their
    catalogue by up to 30 %. Without the hysteresis loss, which the catalogue states apart.

    The catalogue's worked example, size 32, ratio 100, 60 N.m:

    >>> from strainwave.stiffness import ThreeSegment
    >>> round(ThreeSegment(k1=67e3, k2=110e3, k3=120e3, t1=29.0, t2=108.0).twist(60.0), 16)
    0.0007146540027137

    Parameters
    ----------
    k1: Stiffness below t1 [N.m/rad], in (0, inf); default 31000.0
    k2: Stiffness between t1 and t2 [N.m/rad], in (0, inf); default 50000.0
    k3: Stiffness above t2 [N.m/rad], in (0, inf); default 57000.0
    t1: Torque of the first knee [N.m], in (0, inf); default 14.0
    t2: Torque of the second knee [N.m], in (0, inf); default 48.0

    Raises
    ------
    TypeError: an unknown parameter, or one of the wrong kind
    ValueError: a number that is not finite or out of its range

    Source
    ------
    Harmonic Drive AG catalogue, torsional stiffness K1, K2, K3 with torques T1, T2
    """

    def __init__(self, *, k1: float = ..., k2: float = ..., k3: float = ..., t1: float = ..., t2: float = ...) -> None: ...

    def replace(self, *, k1: float = ..., k2: float = ..., k3: float = ..., t1: float = ..., t2: float = ...) -> ThreeSegment:
        """The same with the named parameters changed."""

    @property
    def k1(self) -> float:
        """Stiffness below t1 [N.m/rad]"""

    @property
    def k2(self) -> float:
        """Stiffness between t1 and t2 [N.m/rad]"""

    @property
    def k3(self) -> float:
        """Stiffness above t2 [N.m/rad]"""

    @property
    def t1(self) -> float:
        """Torque of the first knee [N.m]"""

    @property
    def t2(self) -> float:
        """Torque of the second knee [N.m]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    name: str = 'three_segment'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    @overload
    def torque(self, twist: float) -> float: ...

    @overload
    def torque(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """Torque [N.m] at `twist` [rad]."""

    @overload
    def twist(self, torque: float) -> float: ...

    @overload
    def twist(self, torque: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """Twist [rad] at `torque` [N.m], the inverse of `torque`."""

    @overload
    def tangent(self, twist: float) -> float: ...

    @overload
    def tangent(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """Stiffness dT/d(twist) [N.m/rad] at `twist` [rad]."""

    @overload
    def energy(self, twist: float) -> float: ...

    @overload
    def energy(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """Elastic energy [J] at `twist` [rad]."""
