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
    k: Stiffness [N.m/rad], in (0, inf); required

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    Hooke's law; document P, K_s
    """

    def __init__(self, *, k: float) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, k: float = ...) -> Linear:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def k(self) -> float:
        """Stiffness [N.m/rad]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

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

class Piecewise:
    """
    A spring that turns stiffer at one twist: two straight segments, odd in the twist.

    .. math:: T = k_1 \\delta + k_2 \\operatorname{sgn}(\\delta) \\max(|\\delta| - \\delta_k, 0)

    with delta the twist, k_1 = k1, k_2 = k2, delta_k = knee. Document R's k_2 is an increment: the slope
    above the knee is k1 + k2 (E-R9), so to match a slope K there set k2 = K - k1. The slope jumps at the knee; at the knee
    itself it is k1. Leaves out the soft centre and the hysteresis.

    >>> from strainwave.stiffness import Piecewise
    >>> spring = Piecewise(k1=8000.0, k2=2000.0, knee=0.001)
    >>> spring.torque(0.003), spring.tangent(0.003)
    (28.0, 10000.0)

    Parameters
    ----------
    k1: Stiffness up to the knee [N.m/rad], in (0, inf); required
    k2: What the stiffness above the knee exceeds k1 by [N.m/rad], in [0, inf); required
    knee: Twist of the knee [rad], in [0, inf); required

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    document R, section 3, piecewise linear; erratum E-R9
    """

    def __init__(self, *, k1: float, k2: float, knee: float) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, k1: float = ..., k2: float = ..., knee: float = ...) -> Piecewise:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def k1(self) -> float:
        """Stiffness up to the knee [N.m/rad]"""

    @property
    def k2(self) -> float:
        """What the stiffness above the knee exceeds k1 by [N.m/rad]"""

    @property
    def knee(self) -> float:
        """Twist of the knee [rad]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'piecewise'

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
    k1: Stiffness below t1 [N.m/rad], in (0, inf); required
    k2: Stiffness between t1 and t2 [N.m/rad], in (0, inf); required
    k3: Stiffness above t2 [N.m/rad], in (0, inf); required
    t1: Torque of the first knee [N.m], in (0, inf); required
    t2: Torque of the second knee [N.m], in (0, inf); required

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    Harmonic Drive AG catalogue, torsional stiffness K1, K2, K3 with torques T1, T2
    """

    def __init__(self, *, k1: float, k2: float, k3: float, t1: float, t2: float) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, k1: float = ..., k2: float = ..., k3: float = ..., t1: float = ..., t2: float = ...) -> ThreeSegment:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

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

    def __reduce__(self) -> tuple[Any, ...]: ...

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
    a1: Stiffness at zero twist [N.m/rad], in (0, inf); required
    a3: Hardening [N.m/rad3], in [0, inf); default 0.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    document R, section 3, cubic polynomial; Tuttle1992
    """

    def __init__(self, *, a1: float, a3: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, a1: float = ..., a3: float = ...) -> Cubic:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

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

    def __reduce__(self) -> tuple[Any, ...]: ...

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

class MultiCompliance:
    """
    Flexspline and wave generator in series, each a spring that hardens until it gives way no further.

    .. math:: \\delta = \\frac{\\arctan(C_f T)}{C_f K_{f0}}
              + \\operatorname{sgn}(T) \\frac{1 - e^{-C_w |T| / N}}{N C_w K_{w0}}, \\qquad
              \\frac{d\\delta}{dT} = \\frac{1}{K_{f0} (1 + (C_f T)^2)} + \\frac{e^{-C_w |T| / N}}{N^2 K_{w0}}

    with delta the twist, K_f0 = flexspline_stiffness and C_f = flexspline_hardening at the output, K_w0 =
    wave_generator_stiffness and C_w = wave_generator_hardening at the input, where the torque is T / N, N = reduction: the
    ratio of the gear, without its sign. A hardening of 0 is a linear spring. If neither is 0 the twist has the bound
    pi / (2 C_f K_f0) + 1 / (N C_w K_w0), beyond which there is no torque: the law is then not valid. Hardens without
    end, more steeply than any gear well before the bound.

    In a compiled model torque rises up to max(1e6 / C_f, 40 N / C_w), at most 1e18 N.m, and stays there, from within
    1e-6 of the bound on. Elastic only: the friction torque that document R puts inside belongs to a law of friction or
    hysteresis, where it is passive (E-R14). A gear refuses a reduction that is not its own ratio.

    >>> from strainwave.stiffness import MultiCompliance
    >>> spring = MultiCompliance(flexspline_stiffness=8000.0, flexspline_hardening=0.02, wave_generator_stiffness=2.0,
    ...                          wave_generator_hardening=1.5, reduction=100.0)
    >>> round(spring.torque(0.003), 10)
    18.3471285987

    Parameters
    ----------
    flexspline_stiffness: Stiffness K_f0 of the flexspline at zero torque [N.m/rad], in (0, inf); required
    flexspline_hardening: Hardening C_f of the flexspline per torque at the output [1/(N.m)], in [0, inf); required
    wave_generator_stiffness: Stiffness K_w0 of the wave generator at zero torque, at the input [N.m/rad], in (0, inf); required
    wave_generator_hardening: Hardening C_w of the wave generator per torque at the input [1/(N.m)], in [0, inf); required
    reduction: Ratio N of the gear, without its sign, in [1, inf); required

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    document R, section 4c; erratum E-R14
    """

    def __init__(self, *, flexspline_stiffness: float, flexspline_hardening: float, wave_generator_stiffness: float, wave_generator_hardening: float, reduction: float) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, flexspline_stiffness: float = ..., flexspline_hardening: float = ..., wave_generator_stiffness: float = ..., wave_generator_hardening: float = ..., reduction: float = ...) -> MultiCompliance:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def flexspline_stiffness(self) -> float:
        """Stiffness K_f0 of the flexspline at zero torque [N.m/rad]"""

    @property
    def flexspline_hardening(self) -> float:
        """Hardening C_f of the flexspline per torque at the output [1/(N.m)]"""

    @property
    def wave_generator_stiffness(self) -> float:
        """
        Stiffness K_w0 of the wave generator at zero torque, at the input [N.m/rad]
        """

    @property
    def wave_generator_hardening(self) -> float:
        """Hardening C_w of the wave generator per torque at the input [1/(N.m)]"""

    @property
    def reduction(self) -> float:
        """Ratio N of the gear, without its sign"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'multi_compliance'

    source: str = 'document R, section 4c; erratum E-R14'

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

class Backlash:
    """
    A spring behind play: within the clearance nothing is transmitted, beyond it the spring is twisted from where the play ends.

    .. math:: T = T_{law}(\\delta - p), \\qquad p = \\min(\\max(\\delta, -c/2), c/2)

    with delta the twist, p the play taken up, c = clearance, ``law`` any spring without play. Torque, stiffness and energy
    are 0 within the play; the two flanks are c apart at zero torque, which is what a lost-motion test adds to the twist of
    the spring. The stiffness jumps at the flanks, where it is that of the spring; a torque of exactly 0 has the twist 0.
    With c = 0 it is the spring itself.

    No energy is lost: flanks meet elastically. What a blow loses belongs to ``damping`` and friction of the gear, which act
    within the play, too. Steps must be short against the time in which the spring of a flank swings. Makers call strain
    wave gears free of backlash, for their teeth are preloaded: this law is for worn ones, for badly fitted ones, and for
    what else stands between the gear and its load.

    >>> from strainwave.stiffness import Backlash, Linear
    >>> spring = Backlash(law=Linear(k=1e4), clearance=2e-4)
    >>> spring.torque([0.0, 1e-4, 3e-4]).round(9), round(spring.twist(2.0), 9)
    (array([0., 0., 2.]), 0.0003)

    Parameters
    ----------
    law: The spring behind the play; default Linear(k=10000.0)
    clearance: Play c at the output, from flank to flank [rad], in [0, inf); required

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    document A, kinematic error: "a constant component, related to clearance\"
    """

    def __init__(self, *, law: Linear | Piecewise | ThreeSegment | Cubic | MultiCompliance = ..., clearance: float) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, law: Linear | Piecewise | ThreeSegment | Cubic | MultiCompliance = ..., clearance: float = ...) -> Backlash:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def law(self) -> Linear | Piecewise | ThreeSegment | Cubic | MultiCompliance:
        """The spring behind the play"""

    @property
    def clearance(self) -> float:
        """Play c at the output, from flank to flank [rad]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'backlash'

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
