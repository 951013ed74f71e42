"""Friction torque of one side, over its speed."""

from collections.abc import Sequence
from typing import Any, overload

import numpy
import numpy.typing


class Viscous:
    """
    Friction proportional to speed.

    .. math:: F = b v

    with v the speed of the side it acts on, b = viscous. Leaves out everything that friction does near rest.

    >>> from strainwave.friction import Viscous
    >>> Viscous(viscous=0.5).steady(2.0)
    1.0

    Parameters
    ----------
    viscous: Torque per speed [N.m.s/rad], in [0, inf); default 0.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    Newton's law of viscosity; document P, b_m and b_l of Table 3
    """

    def __init__(self, *, viscous: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, viscous: float = ...) -> Viscous:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def viscous(self) -> float:
        """Torque per speed [N.m.s/rad]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'viscous'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    @overload
    def steady(self, speed: float, angle: float = 0.0, load: float = 0.0, temperature: float = 293.15) -> float: ...

    @overload
    def steady(self, speed: float | Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> Any:
        """
        Torque [N.m] that opposes steady sliding at `speed` [rad/s], under `load` [N.m], the torque transmitted where it acts, positive if it drives a positive speed; at `angle` [rad] and `temperature` [K]. The law looks at what it depends on.
        """

    @overload
    def hold(self, sense: float = 1.0, angle: float = 0.0, load: float = 0.0, temperature: float = 293.15) -> float: ...

    @overload
    def hold(self, sense: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 1.0, angle: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> Any:
        """
        The largest torque [N.m] it balances at rest, pushed towards `sense`, under `load` [N.m], the torque transmitted where it acts, positive if it drives a positive speed; at `angle` [rad] and `temperature` [K]. The law looks at what it depends on.

        Zero for a law that does not stick.
        """

    @property
    def set_valued(self) -> bool:
        """Whether it can hold at rest."""

    def trace(self, time: Sequence[float] | numpy.typing.NDArray[numpy.float64], speed: Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), over `time` [s] and `speed` [rad/s], both of shape (n,).

        `angle` [rad] is where the motion starts; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). Exact for a speed that is constant between samples, whatever the step; else the mean of two samples stands for their step. A law that sticks shows no torque at rest: what it holds depends on what drives it.
        """

    def quasistatic(self, displacement: Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), along a path of `displacement` [rad], shape (n,), monotone between its points, in the limit of infinite slowness.

        No torque follows from a speed, and no rate. A law that sticks shows the largest torque it balances, in the sense of the last motion, and none before the first. A law with memory starts virgin, keeps its torque at rest, and is exact over each step, whatever its length. `angle` [rad] is where displacement is zero; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). What varies with them is taken over a step as it is at its end.
        """

class Coulomb:
    """
    Static, Coulomb and viscous friction, set-valued at rest: it sticks exactly.

    .. math:: F = F_c \\operatorname{sgn} v + b v \\quad (v \\ne 0), \\qquad |F| \\le F_s \\quad (v = 0)

    with v the speed of the side it acts on, F_c = coulomb, F_s = breakaway, b = viscous. At rest F balances whatever
    drives the side, up to F_s; there is no smoothed sign and no dead band of speed, both of which leave an error that no
    step size removes. A breakaway that is not given equals coulomb; one below coulomb counts as coulomb.

    >>> from strainwave.friction import Coulomb
    >>> Coulomb(coulomb=0.07, breakaway=0.075, viscous=5e-4).steady(-20.0)
    -0.08

    Parameters
    ----------
    coulomb: Kinetic friction torque F_c [N.m], in [0, inf); default 0.0
    breakaway: Static friction torque F_s [N.m], in [0, inf); default as coulomb
    viscous: Torque per speed [N.m.s/rad], in [0, inf); default 0.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    document P, simplified friction model (static + Coulomb + viscous); Coulomb1785
    """

    def __init__(self, *, coulomb: float = ..., breakaway: float = ..., viscous: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, coulomb: float = ..., breakaway: float = ..., viscous: float = ...) -> Coulomb:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def coulomb(self) -> float:
        """Kinetic friction torque F_c [N.m]"""

    @property
    def breakaway(self) -> float:
        """Static friction torque F_s [N.m]"""

    @property
    def viscous(self) -> float:
        """Torque per speed [N.m.s/rad]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'coulomb'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    @overload
    def steady(self, speed: float, angle: float = 0.0, load: float = 0.0, temperature: float = 293.15) -> float: ...

    @overload
    def steady(self, speed: float | Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> Any:
        """
        Torque [N.m] that opposes steady sliding at `speed` [rad/s], under `load` [N.m], the torque transmitted where it acts, positive if it drives a positive speed; at `angle` [rad] and `temperature` [K]. The law looks at what it depends on.
        """

    @overload
    def hold(self, sense: float = 1.0, angle: float = 0.0, load: float = 0.0, temperature: float = 293.15) -> float: ...

    @overload
    def hold(self, sense: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 1.0, angle: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> Any:
        """
        The largest torque [N.m] it balances at rest, pushed towards `sense`, under `load` [N.m], the torque transmitted where it acts, positive if it drives a positive speed; at `angle` [rad] and `temperature` [K]. The law looks at what it depends on.

        Zero for a law that does not stick.
        """

    @property
    def set_valued(self) -> bool:
        """Whether it can hold at rest."""

    def trace(self, time: Sequence[float] | numpy.typing.NDArray[numpy.float64], speed: Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), over `time` [s] and `speed` [rad/s], both of shape (n,).

        `angle` [rad] is where the motion starts; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). Exact for a speed that is constant between samples, whatever the step; else the mean of two samples stands for their step. A law that sticks shows no torque at rest: what it holds depends on what drives it.
        """

    def quasistatic(self, displacement: Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), along a path of `displacement` [rad], shape (n,), monotone between its points, in the limit of infinite slowness.

        No torque follows from a speed, and no rate. A law that sticks shows the largest torque it balances, in the sense of the last motion, and none before the first. A law with memory starts virgin, keeps its torque at rest, and is exact over each step, whatever its length. `angle` [rad] is where displacement is zero; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). What varies with them is taken over a step as it is at its end.
        """

class Stribeck:
    """
    Friction that falls from its static to its kinetic level as sliding sets in, set-valued at rest.

    .. math:: F = \\left[F_c + (F_s - F_c) e^{-(v/v_s)^2}\\right] \\operatorname{sgn} v + b v \\quad (v \\ne 0), \\qquad
              |F| \\le F_s \\quad (v = 0)

    with v the speed of the side it acts on, F_c = coulomb, F_s = breakaway, v_s = stribeck_speed, b = viscous. Leaves out
    presliding: the contact is rigid until it breaks away (see LuGre).

    >>> from strainwave.friction import Stribeck
    >>> Stribeck(coulomb=0.05, breakaway=0.07, stribeck_speed=0.1, viscous=4e-4).steady(1.0)
    0.0504

    Parameters
    ----------
    coulomb: Kinetic friction torque F_c [N.m], in [0, inf); required
    breakaway: Static friction torque F_s [N.m], in [0, inf); required
    stribeck_speed: Speed at which the excess F_s - F_c has fallen to 1/e [rad/s], in (0, inf); required
    viscous: Torque per speed [N.m.s/rad], in [0, inf); default 0.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    Stribeck1902; ArmstrongHelouvry1994, eq. (3) with exponent 2
    """

    def __init__(self, *, coulomb: float, breakaway: float, stribeck_speed: float, viscous: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, coulomb: float = ..., breakaway: float = ..., stribeck_speed: float = ..., viscous: float = ...) -> Stribeck:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def coulomb(self) -> float:
        """Kinetic friction torque F_c [N.m]"""

    @property
    def breakaway(self) -> float:
        """Static friction torque F_s [N.m]"""

    @property
    def stribeck_speed(self) -> float:
        """Speed at which the excess F_s - F_c has fallen to 1/e [rad/s]"""

    @property
    def viscous(self) -> float:
        """Torque per speed [N.m.s/rad]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'stribeck'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    @overload
    def steady(self, speed: float, angle: float = 0.0, load: float = 0.0, temperature: float = 293.15) -> float: ...

    @overload
    def steady(self, speed: float | Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> Any:
        """
        Torque [N.m] that opposes steady sliding at `speed` [rad/s], under `load` [N.m], the torque transmitted where it acts, positive if it drives a positive speed; at `angle` [rad] and `temperature` [K]. The law looks at what it depends on.
        """

    @overload
    def hold(self, sense: float = 1.0, angle: float = 0.0, load: float = 0.0, temperature: float = 293.15) -> float: ...

    @overload
    def hold(self, sense: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 1.0, angle: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> Any:
        """
        The largest torque [N.m] it balances at rest, pushed towards `sense`, under `load` [N.m], the torque transmitted where it acts, positive if it drives a positive speed; at `angle` [rad] and `temperature` [K]. The law looks at what it depends on.

        Zero for a law that does not stick.
        """

    @property
    def set_valued(self) -> bool:
        """Whether it can hold at rest."""

    def trace(self, time: Sequence[float] | numpy.typing.NDArray[numpy.float64], speed: Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), over `time` [s] and `speed` [rad/s], both of shape (n,).

        `angle` [rad] is where the motion starts; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). Exact for a speed that is constant between samples, whatever the step; else the mean of two samples stands for their step. A law that sticks shows no torque at rest: what it holds depends on what drives it.
        """

    def quasistatic(self, displacement: Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), along a path of `displacement` [rad], shape (n,), monotone between its points, in the limit of infinite slowness.

        No torque follows from a speed, and no rate. A law that sticks shows the largest torque it balances, in the sense of the last motion, and none before the first. A law with memory starts virgin, keeps its torque at rest, and is exact over each step, whatever its length. `angle` [rad] is where displacement is zero; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). What varies with them is taken over a step as it is at its end.
        """

class PositionDependent:
    """
    Coulomb friction that varies with the angle, on average and over each turn, set-valued at rest.

    .. math:: F = f(q, v) \\operatorname{sgn} v + b v \\; (v \\ne 0), \\quad
              |F| \\le \\kappa\\, [f_{aver}(q) + f_{peri}(q)] \\; (v = 0), \\quad
              f = f_{aver}(q)\\, [1 + (|v| - v_c)\\, \\epsilon] + f_{peri}(q) \\ge 0, \\quad
              f_{aver} = s_1 q^2 + s_2 q + s_3, \\quad
              f_{peri} = \\sum_{k=1}^{10} (a_k \\cos k q + b_k \\sin k q)

    with q the angle and v the speed of the place it acts on, s_1 = quadratic, s_2 = linear, s_3 = constant, a_k = cosine and
    b_k = sine, by their place k = 1, 2 ..., kappa = static_ratio, epsilon = speed_factor, v_c = reference_speed (at which
    f_aver was measured), b = viscous. A level below zero counts as zero. Document P prints no a_k and b_k; its other numbers
    are those of the example, all SI.

    Valid for q from domain_start to domain_end. A parabola grows without bound: the one of document P has its minimum,
    0.0491812523669 N.m, at 120.412377685 rad, and is back at its start at twice that angle (E-P8). Beyond the domain,
    outside says what f_aver does: ``"clamp"`` keeps the value of the nearer end, ``"periodic"`` repeats the domain,
    ``"refuse"`` is an error. f_peri repeats with every turn anyway.

    Document P prints the sliding branch with the wrong sign and for v > 0 only (E-P3); its factor 0.0004 needs the unit
    s/rad (E-P4), and its v_c is no threshold but the reference speed (E-P5); a constant a_0 / 2 could not be told from s_3
    and is left out (E-P9).

    >>> from strainwave.friction import PositionDependent
    >>> law = PositionDependent(quadratic=1.5738e-6, linear=-3.7901e-4, constant=0.0720, static_ratio=1.0388,
    ...                         speed_factor=0.0004, reference_speed=0.8, domain_start=0.0, domain_end=240.8)
    >>> law.steady([0.8, -0.8])
    array([ 0.072, -0.072])

    Parameters
    ----------
    quadratic: Coefficient s_1 of the average friction [N.m/rad2]; default 0.0
    linear: Coefficient s_2 of the average friction [N.m/rad]; default 0.0
    constant: Average friction s_3 at angle 0 [N.m]; required
    cosine: Amplitudes a_k of cos k q, k = 1, 2 ... [N.m]; default ()
    sine: Amplitudes b_k of sin k q, k = 1, 2 ... [N.m]; default ()
    static_ratio: Static over kinetic friction kappa, in [1, inf); default 1.0
    speed_factor: Relative rise of the average friction with speed [s/rad], in [0, inf); default 0.0
    reference_speed: Speed v_c at which the average friction was measured [rad/s], in [0, inf); default 0.0
    viscous: Torque per speed, besides [N.m.s/rad], in [0, inf); default 0.0
    domain_start: Least angle at which the average friction was measured [rad]; required
    domain_end: Greatest angle at which the average friction was measured [rad]; required
    outside: What the average friction does beyond its domain, one of ('clamp', 'periodic', 'refuse'); default 'refuse'

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    document P, friction model of the motor side; errata E-P3, E-P4, E-P5, E-P8, E-P9
    """

    def __init__(self, *, quadratic: float = ..., linear: float = ..., constant: float, cosine: float | Sequence[float] = ..., sine: float | Sequence[float] = ..., static_ratio: float = ..., speed_factor: float = ..., reference_speed: float = ..., viscous: float = ..., domain_start: float, domain_end: float, outside: str = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, quadratic: float = ..., linear: float = ..., constant: float = ..., cosine: float | Sequence[float] = ..., sine: float | Sequence[float] = ..., static_ratio: float = ..., speed_factor: float = ..., reference_speed: float = ..., viscous: float = ..., domain_start: float = ..., domain_end: float = ..., outside: str = ...) -> PositionDependent:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def quadratic(self) -> float:
        """Coefficient s_1 of the average friction [N.m/rad2]"""

    @property
    def linear(self) -> float:
        """Coefficient s_2 of the average friction [N.m/rad]"""

    @property
    def constant(self) -> float:
        """Average friction s_3 at angle 0 [N.m]"""

    @property
    def cosine(self) -> tuple[float, ...]:
        """Amplitudes a_k of cos k q, k = 1, 2 ... [N.m]"""

    @property
    def sine(self) -> tuple[float, ...]:
        """Amplitudes b_k of sin k q, k = 1, 2 ... [N.m]"""

    @property
    def static_ratio(self) -> float:
        """Static over kinetic friction kappa"""

    @property
    def speed_factor(self) -> float:
        """Relative rise of the average friction with speed [s/rad]"""

    @property
    def reference_speed(self) -> float:
        """Speed v_c at which the average friction was measured [rad/s]"""

    @property
    def viscous(self) -> float:
        """Torque per speed, besides [N.m.s/rad]"""

    @property
    def domain_start(self) -> float:
        """Least angle at which the average friction was measured [rad]"""

    @property
    def domain_end(self) -> float:
        """Greatest angle at which the average friction was measured [rad]"""

    @property
    def outside(self) -> str:
        """What the average friction does beyond its domain"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'position_dependent'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    @overload
    def steady(self, speed: float, angle: float = 0.0, load: float = 0.0, temperature: float = 293.15) -> float: ...

    @overload
    def steady(self, speed: float | Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> Any:
        """
        Torque [N.m] that opposes steady sliding at `speed` [rad/s], under `load` [N.m], the torque transmitted where it acts, positive if it drives a positive speed; at `angle` [rad] and `temperature` [K]. The law looks at what it depends on.
        """

    @overload
    def hold(self, sense: float = 1.0, angle: float = 0.0, load: float = 0.0, temperature: float = 293.15) -> float: ...

    @overload
    def hold(self, sense: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 1.0, angle: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> Any:
        """
        The largest torque [N.m] it balances at rest, pushed towards `sense`, under `load` [N.m], the torque transmitted where it acts, positive if it drives a positive speed; at `angle` [rad] and `temperature` [K]. The law looks at what it depends on.

        Zero for a law that does not stick.
        """

    @property
    def set_valued(self) -> bool:
        """Whether it can hold at rest."""

    def trace(self, time: Sequence[float] | numpy.typing.NDArray[numpy.float64], speed: Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), over `time` [s] and `speed` [rad/s], both of shape (n,).

        `angle` [rad] is where the motion starts; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). Exact for a speed that is constant between samples, whatever the step; else the mean of two samples stands for their step. A law that sticks shows no torque at rest: what it holds depends on what drives it.
        """

    def quasistatic(self, displacement: Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), along a path of `displacement` [rad], shape (n,), monotone between its points, in the limit of infinite slowness.

        No torque follows from a speed, and no rate. A law that sticks shows the largest torque it balances, in the sense of the last motion, and none before the first. A law with memory starts virgin, keeps its torque at rest, and is exact over each step, whatever its length. `angle` [rad] is where displacement is zero; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). What varies with them is taken over a step as it is at its end.
        """

    odd: bool = True

class LuGre:
    """
    Friction of an elastic bristle that bends before it slips: presliding, breakaway, Stribeck fall, viscous rise.

    .. math:: \\dot z = v - \\sigma_0 |v| z / G(v), \\quad G(v) = F_c + (F_s - F_c) e^{-(v/v_s)^2}, \\quad
              F = \\sigma_0 z + \\sigma_1(v) \\dot z + \\sigma_2 v, \\quad \\sigma_1(v) = \\sigma_1 e^{-(\\varphi v)^2}

    with v the speed of the place it acts on, F_c = coulomb, F_s = breakaway, v_s = stribeck_speed,
    sigma_0 = bristle_stiffness, sigma_1 = bristle_damping, sigma_2 = viscous, phi = damping_fading: the reciprocal of the
    speed v_d at which the bristle's damping has fallen to 1/e, 0 for a constant one.

    Valid for one contact under constant load; leaves out load, position and temperature. At rest it holds elastically and
    drifts: under a load that wavers below breakaway each wave moves the shaft a little further, without end. Where the
    shaft must hold, use Coulomb or Stribeck. G must be positive: a bristle without reach at rest would lose all its
    torque in every reversal, in no time. Dissipates for every motion if sigma_2 >= max_v sigma_1(v) (F_s/G(v) - 1), which
    for a constant damping is sigma_2 >= sigma_1 (F_s - F_c)/F_c and then also necessary. A set that violates this is
    accepted, and ``check()`` warns with both sides.

    >>> from strainwave.friction import LuGre
    >>> law = LuGre(coulomb=0.05, breakaway=0.07, stribeck_speed=0.1, bristle_stiffness=50.0, bristle_damping=5e-5,
    ...             viscous=4e-4)
    >>> law.steady(1.0)
    0.0504

    Parameters
    ----------
    coulomb: Kinetic friction torque F_c [N.m], in [0, inf); required
    breakaway: Static friction torque F_s [N.m], in [0, inf); required
    stribeck_speed: Speed at which the excess F_s - F_c has fallen to 1/e [rad/s], in (0, inf); required
    bristle_stiffness: Torque per bristle deflection [N.m/rad], in (0, inf); required
    bristle_damping: Torque per bristle rate, at rest [N.m.s/rad], in [0, inf); required
    viscous: Torque per speed [N.m.s/rad], in [0, inf); default 0.0
    damping_fading: Reciprocal of the speed at which bristle_damping has fallen to 1/e [s/rad], in [0, inf); default 0.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    CanudasDeWit1995, eqs. (1)-(4); passivity: BarabanovOrtega2000; fading damping: document R
    """

    def __init__(self, *, coulomb: float, breakaway: float, stribeck_speed: float, bristle_stiffness: float, bristle_damping: float, viscous: float = ..., damping_fading: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, coulomb: float = ..., breakaway: float = ..., stribeck_speed: float = ..., bristle_stiffness: float = ..., bristle_damping: float = ..., viscous: float = ..., damping_fading: float = ...) -> LuGre:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def coulomb(self) -> float:
        """Kinetic friction torque F_c [N.m]"""

    @property
    def breakaway(self) -> float:
        """Static friction torque F_s [N.m]"""

    @property
    def stribeck_speed(self) -> float:
        """Speed at which the excess F_s - F_c has fallen to 1/e [rad/s]"""

    @property
    def bristle_stiffness(self) -> float:
        """Torque per bristle deflection [N.m/rad]"""

    @property
    def bristle_damping(self) -> float:
        """Torque per bristle rate, at rest [N.m.s/rad]"""

    @property
    def viscous(self) -> float:
        """Torque per speed [N.m.s/rad]"""

    @property
    def damping_fading(self) -> float:
        """
        Reciprocal of the speed at which bristle_damping has fallen to 1/e [s/rad]
        """

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'lugre'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    class State:
        """
        Parameters
        ----------
        deflection: Mean bristle deflection z [rad]; default 0.0

        Raises
        ------
        TypeError: an unknown parameter, one of the wrong kind, or none where it is required
        ValueError: a number that is not finite or out of its range
        """

        def __init__(self, *, deflection: float = ...) -> None: ...

        def replace(self, changes: dict[str, Any] = ..., /, *, deflection: float = ...) -> LuGre.State:
            """
            The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
            """

        @property
        def deflection(self) -> float:
            """Mean bristle deflection z [rad]"""

        def __repr__(self) -> str: ...

        def __eq__(self, other: object, /) -> bool: ...

        def __hash__(self) -> int: ...

        def __getstate__(self) -> dict[str, object]: ...

        def __setstate__(self, state: dict[str, object], /) -> None: ...

        def __reduce__(self) -> tuple[Any, ...]: ...

        name: str = 'lugre.state'

        fields: tuple[dict[str, Any], ...]

    @overload
    def steady(self, speed: float, angle: float = 0.0, load: float = 0.0, temperature: float = 293.15) -> float: ...

    @overload
    def steady(self, speed: float | Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> Any:
        """
        Torque [N.m] that opposes steady sliding at `speed` [rad/s], under `load` [N.m], the torque transmitted where it acts, positive if it drives a positive speed; at `angle` [rad] and `temperature` [K]. The law looks at what it depends on.
        """

    @overload
    def hold(self, sense: float = 1.0, angle: float = 0.0, load: float = 0.0, temperature: float = 293.15) -> float: ...

    @overload
    def hold(self, sense: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 1.0, angle: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> Any:
        """
        The largest torque [N.m] it balances at rest, pushed towards `sense`, under `load` [N.m], the torque transmitted where it acts, positive if it drives a positive speed; at `angle` [rad] and `temperature` [K]. The law looks at what it depends on.

        Zero for a law that does not stick.
        """

    @property
    def set_valued(self) -> bool:
        """Whether it can hold at rest."""

    def trace(self, time: Sequence[float] | numpy.typing.NDArray[numpy.float64], speed: Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15, state: State = ...) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), over `time` [s] and `speed` [rad/s], both of shape (n,).

        `angle` [rad] is where the motion starts; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). Exact for a speed that is constant between samples, whatever the step; else the mean of two samples stands for their step. A law that sticks shows no torque at rest: what it holds depends on what drives it.
        """

    def quasistatic(self, displacement: Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), along a path of `displacement` [rad], shape (n,), monotone between its points, in the limit of infinite slowness.

        No torque follows from a speed, and no rate. A law that sticks shows the largest torque it balances, in the sense of the last motion, and none before the first. A law with memory starts virgin, keeps its torque at rest, and is exact over each step, whatever its length. `angle` [rad] is where displacement is zero; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). What varies with them is taken over a step as it is at its end.
        """

    def check(self) -> None:
        """
        Warns with PassivityWarning, stating both sides, if the parameters let the model create energy.
        """

    odd: bool = True

class MaxwellSlipFriction:
    """
    Parallel springs that each stick or slip: presliding hysteresis with non-local memory, Stribeck fall, frictional lag.

    .. math:: F = \\sum_i F_i + \\sigma_2 v, \\quad \\text{sticking: } \\dot F_i = k_i v, \\quad
              \\text{slipping: } \\dot F_i = \\operatorname{sgn}(v)\\, C \\left(\\alpha_i - |F_i| / s(v)\\right), \\quad
              s(v) = F_c + (F_s - F_c) e^{-(v/v_s)^2}

    with v the speed of the place it acts on, k_i = stiffness, alpha_i = share over the sum of all shares, F_c = coulomb,
    F_s = breakaway, v_s = stribeck_speed, C = attraction, sigma_2 = viscous; up to 8 elements, none at all is no dry
    friction. An element sticks until it carries alpha_i s(v), and slips until the motion stops or turns round. A slipping
    element follows s(v) with the time constant s/C. A breakaway that is not given equals coulomb; one below counts as coulomb. Where dry friction is
    scaled (Cyclic, Thermal), s and C scale, stiffness and time constant do not.

    With breakaway = coulomb no element lags, it is Maxwell's slip with the levels alpha_i F_c, and dissipates for every
    motion. A Stribeck fall makes the law, as published, able to create energy: an element that slips fast, slows down, and
    goes back a little while it sticks returns up to alpha_i^2 (F_s - F_c)^2 / (2 k_i) more than it took; ``check()`` warns.
    Leaves out load, position and temperature.

    >>> from strainwave.friction import MaxwellSlipFriction
    >>> law = MaxwellSlipFriction(stiffness=[60, 30, 10], share=[0.2, 0.3, 0.5], coulomb=0.05, stribeck_speed=2.0,
    ...                           attraction=0.3)
    >>> law.trace([0.0, 1.0, 2.0], [1e-3, 1e-3, 1e-3]).round(6)
    array([0.   , 0.035, 0.045])

    Parameters
    ----------
    stiffness: Stiffness k_i of each element while it sticks [N.m/rad], in (0, inf); required
    share: Share alpha_i of each element in the friction torque, relative to the sum of all, in [0, inf); required
    coulomb: Kinetic friction torque F_c [N.m], in [0, inf); required
    breakaway: Static friction torque F_s [N.m], in [0, inf); default as coulomb
    stribeck_speed: Speed at which the excess F_s - F_c has fallen to 1/e [rad/s], in (0, inf); required
    attraction: Rate C at which slipping elements are drawn to the Stribeck curve [N.m/s], in (0, inf); required
    viscous: Torque per speed [N.m.s/rad], in [0, inf); default 0.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    AlBenderLampaertSwevers2005, generalized Maxwell-slip model, slip law with a constant attraction
    """

    def __init__(self, *, stiffness: float | Sequence[float], share: float | Sequence[float], coulomb: float, breakaway: float = ..., stribeck_speed: float, attraction: float, viscous: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, stiffness: float | Sequence[float] = ..., share: float | Sequence[float] = ..., coulomb: float = ..., breakaway: float = ..., stribeck_speed: float = ..., attraction: float = ..., viscous: float = ...) -> MaxwellSlipFriction:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def stiffness(self) -> tuple[float, ...]:
        """Stiffness k_i of each element while it sticks [N.m/rad]"""

    @property
    def share(self) -> tuple[float, ...]:
        """
        Share alpha_i of each element in the friction torque, relative to the sum of all
        """

    @property
    def coulomb(self) -> float:
        """Kinetic friction torque F_c [N.m]"""

    @property
    def breakaway(self) -> float:
        """Static friction torque F_s [N.m]"""

    @property
    def stribeck_speed(self) -> float:
        """Speed at which the excess F_s - F_c has fallen to 1/e [rad/s]"""

    @property
    def attraction(self) -> float:
        """
        Rate C at which slipping elements are drawn to the Stribeck curve [N.m/s]
        """

    @property
    def viscous(self) -> float:
        """Torque per speed [N.m.s/rad]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'maxwell_slip_friction'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    class State:
        """
        Parameters
        ----------
        torque: Torque F_i carried by each element [N.m]; default (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        slipping: 1 for an element that slips, 0 for one that sticks, 0.5 for one about to slip; default (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

        Raises
        ------
        TypeError: an unknown parameter, one of the wrong kind, or none where it is required
        ValueError: a number that is not finite or out of its range
        """

        def __init__(self, *, torque: Sequence[float] = ..., slipping: Sequence[float] = ...) -> None: ...

        def replace(self, changes: dict[str, Any] = ..., /, *, torque: Sequence[float] = ..., slipping: Sequence[float] = ...) -> MaxwellSlipFriction.State:
            """
            The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
            """

        @property
        def torque(self) -> tuple[float, ...]:
            """Torque F_i carried by each element [N.m]"""

        @property
        def slipping(self) -> tuple[float, ...]:
            """
            1 for an element that slips, 0 for one that sticks, 0.5 for one about to slip
            """

        def __repr__(self) -> str: ...

        def __eq__(self, other: object, /) -> bool: ...

        def __hash__(self) -> int: ...

        def __getstate__(self) -> dict[str, object]: ...

        def __setstate__(self, state: dict[str, object], /) -> None: ...

        def __reduce__(self) -> tuple[Any, ...]: ...

        name: str = 'maxwell_slip_friction.state'

        fields: tuple[dict[str, Any], ...]

    @overload
    def steady(self, speed: float, angle: float = 0.0, load: float = 0.0, temperature: float = 293.15) -> float: ...

    @overload
    def steady(self, speed: float | Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> Any:
        """
        Torque [N.m] that opposes steady sliding at `speed` [rad/s], under `load` [N.m], the torque transmitted where it acts, positive if it drives a positive speed; at `angle` [rad] and `temperature` [K]. The law looks at what it depends on.
        """

    @overload
    def hold(self, sense: float = 1.0, angle: float = 0.0, load: float = 0.0, temperature: float = 293.15) -> float: ...

    @overload
    def hold(self, sense: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 1.0, angle: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> Any:
        """
        The largest torque [N.m] it balances at rest, pushed towards `sense`, under `load` [N.m], the torque transmitted where it acts, positive if it drives a positive speed; at `angle` [rad] and `temperature` [K]. The law looks at what it depends on.

        Zero for a law that does not stick.
        """

    @property
    def set_valued(self) -> bool:
        """Whether it can hold at rest."""

    def trace(self, time: Sequence[float] | numpy.typing.NDArray[numpy.float64], speed: Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15, state: State = ...) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), over `time` [s] and `speed` [rad/s], both of shape (n,).

        `angle` [rad] is where the motion starts; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). Exact for a speed that is constant between samples, whatever the step; else the mean of two samples stands for their step. A law that sticks shows no torque at rest: what it holds depends on what drives it.
        """

    def quasistatic(self, displacement: Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), along a path of `displacement` [rad], shape (n,), monotone between its points, in the limit of infinite slowness.

        No torque follows from a speed, and no rate. A law that sticks shows the largest torque it balances, in the sense of the last motion, and none before the first. A law with memory starts virgin, keeps its torque at rest, and is exact over each step, whatever its length. `angle` [rad] is where displacement is zero; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). What varies with them is taken over a step as it is at its end.
        """

    def check(self) -> None:
        """
        Warns with PassivityWarning, stating both sides, if the parameters let the model create energy.
        """

    odd: bool = True

class LoadDependent:
    """
    Loss proportional to the torque transmitted, one ratio for each quadrant, set-valued at rest.

    .. math:: F = \\mu |T| \\operatorname{sgn} v \\quad (v \\ne 0), \\qquad |F| \\le \\mu |T| \\quad (v = 0)

    with v the speed of the place it acts on, T the torque it transmits (load), mu the ratio of the quadrant: if T v > 0 the
    power flows to the output, and mu = driving_forward for v > 0, driving_reverse for v < 0; if T v < 0 it flows back to
    the input, and mu = backdriving_forward for v > 0, backdriving_reverse for v < 0. At rest it is the quadrant of the
    motion that is about to begin.

    T is what arrives on the output's side. The efficiency is therefore 1 / (1 + mu) when driving and 1 - mu when
    back-driven; with backdriving mu >= 1 the output cannot turn the input: self-locking. Multiplying the stiffness by the
    efficiency instead creates energy when back-driven, for the input then receives more than the output gives. Leaves out
    what an idle gear loses.

    >>> from strainwave.friction import LoadDependent
    >>> LoadDependent(driving_forward=0.25, backdriving_reverse=0.5).steady([10.0, -10.0], load=4.0)
    array([ 1., -2.])

    Parameters
    ----------
    driving_forward: Loss per torque transmitted, at positive speed under positive load, in [0, inf); default 0.0
    driving_reverse: Loss per torque transmitted, at negative speed under negative load, in [0, inf); default 0.0
    backdriving_forward: Loss per torque transmitted, at positive speed under negative load, in [0, inf); default 0.0
    backdriving_reverse: Loss per torque transmitted, at negative speed under positive load, in [0, inf); default 0.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    Coulomb1785: friction proportional to load; one ratio for each quadrant, assumed
    """

    def __init__(self, *, driving_forward: float = ..., driving_reverse: float = ..., backdriving_forward: float = ..., backdriving_reverse: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, driving_forward: float = ..., driving_reverse: float = ..., backdriving_forward: float = ..., backdriving_reverse: float = ...) -> LoadDependent:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def driving_forward(self) -> float:
        """Loss per torque transmitted, at positive speed under positive load"""

    @property
    def driving_reverse(self) -> float:
        """Loss per torque transmitted, at negative speed under negative load"""

    @property
    def backdriving_forward(self) -> float:
        """Loss per torque transmitted, at positive speed under negative load"""

    @property
    def backdriving_reverse(self) -> float:
        """Loss per torque transmitted, at negative speed under positive load"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'load_dependent'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    @overload
    def steady(self, speed: float, angle: float = 0.0, load: float = 0.0, temperature: float = 293.15) -> float: ...

    @overload
    def steady(self, speed: float | Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> Any:
        """
        Torque [N.m] that opposes steady sliding at `speed` [rad/s], under `load` [N.m], the torque transmitted where it acts, positive if it drives a positive speed; at `angle` [rad] and `temperature` [K]. The law looks at what it depends on.
        """

    @overload
    def hold(self, sense: float = 1.0, angle: float = 0.0, load: float = 0.0, temperature: float = 293.15) -> float: ...

    @overload
    def hold(self, sense: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 1.0, angle: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> Any:
        """
        The largest torque [N.m] it balances at rest, pushed towards `sense`, under `load` [N.m], the torque transmitted where it acts, positive if it drives a positive speed; at `angle` [rad] and `temperature` [K]. The law looks at what it depends on.

        Zero for a law that does not stick.
        """

    @property
    def set_valued(self) -> bool:
        """Whether it can hold at rest."""

    def trace(self, time: Sequence[float] | numpy.typing.NDArray[numpy.float64], speed: Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), over `time` [s] and `speed` [rad/s], both of shape (n,).

        `angle` [rad] is where the motion starts; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). Exact for a speed that is constant between samples, whatever the step; else the mean of two samples stands for their step. A law that sticks shows no torque at rest: what it holds depends on what drives it.
        """

    def quasistatic(self, displacement: Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), along a path of `displacement` [rad], shape (n,), monotone between its points, in the limit of infinite slowness.

        No torque follows from a speed, and no rate. A law that sticks shows the largest torque it balances, in the sense of the last motion, and none before the first. A law with memory starts virgin, keeps its torque at rest, and is exact over each step, whatever its length. `angle` [rad] is where displacement is zero; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). What varies with them is taken over a step as it is at its end.
        """

    odd: bool = False

class MixedLubrication:
    """
    Friction of a lubricated bearing, as that of the wave generator: boundary, mixed and hydrodynamic by one number.

    .. math:: F = p \\left[F_c + (F_s - F_c) e^{-h^2}\\right] \\operatorname{sgn} v + b\\, \\eta\\, v \\quad (v \\ne 0), \\qquad
              |F| \\le p F_s \\quad (v = 0), \\\\
              h = \\frac{\\eta |v|}{v_s\\, p}, \\qquad \\eta = e^{-\\beta (T - T_0)}, \\qquad p = 1 + s\\,|T_{load}|

    with v the speed of the side it acts on, F_c = coulomb, F_s = breakaway, v_s = stribeck_speed, b = viscous, beta =
    viscosity_fall, s = load_sensitivity, T_0 = reference_temperature; T the temperature, T_load the torque that its place
    transmits: at the input that of the gear over the ratio. eta is the viscosity, p the load on the bearing, both relative to
    T_0 and no load. The speed at which the lubricant carries grows as the load grows and as the lubricant thins: h is the
    number of Hersey. Warm oil lowers the viscous part, and lets dry friction last to higher speeds; ``Thermal`` around
    ``Stribeck`` leaves these speeds where they are.

    >>> from strainwave.friction import MixedLubrication
    >>> law = MixedLubrication(coulomb=0.02, breakaway=0.05, stribeck_speed=5.0, viscous=1e-3, viscosity_fall=0.03)
    >>> cold, warm = (float(law.steady(speed, temperature=333.15)) > float(law.steady(speed)) for speed in (5.0, 100.0))
    >>> cold, warm  # warm oil: more friction at 5 rad/s, less at 100
    (True, False)

    Parameters
    ----------
    coulomb: Friction torque F_c that is left once the lubricant carries, without the viscous part [N.m], in [0, inf); required
    breakaway: Static friction torque F_s [N.m], in [0, inf); required
    stribeck_speed: Speed v_s at which the excess has fallen to 1/e, at T_0 without load [rad/s], in (0, inf); required
    viscous: Torque per speed at T_0 [N.m.s/rad], in [0, inf); default 0.0
    viscosity_fall: Relative fall beta of the viscosity per kelvin [1/K], in [0, inf); default 0.0
    load_sensitivity: Rise s of the load on the bearing with the torque transmitted [1/(N.m)], in [0, inf); default 0.0
    reference_temperature: Temperature T_0 at which the numbers hold [K], in (0, inf); default 293.15

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    Stribeck1902: friction over viscosity times speed per load (Hersey1914); viscosity over temperature: Reynolds1886; this curve, and how the load enters, are assumed
    """

    def __init__(self, *, coulomb: float, breakaway: float, stribeck_speed: float, viscous: float = ..., viscosity_fall: float = ..., load_sensitivity: float = ..., reference_temperature: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, coulomb: float = ..., breakaway: float = ..., stribeck_speed: float = ..., viscous: float = ..., viscosity_fall: float = ..., load_sensitivity: float = ..., reference_temperature: float = ...) -> MixedLubrication:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def coulomb(self) -> float:
        """
        Friction torque F_c that is left once the lubricant carries, without the viscous part [N.m]
        """

    @property
    def breakaway(self) -> float:
        """Static friction torque F_s [N.m]"""

    @property
    def stribeck_speed(self) -> float:
        """
        Speed v_s at which the excess has fallen to 1/e, at T_0 without load [rad/s]
        """

    @property
    def viscous(self) -> float:
        """Torque per speed at T_0 [N.m.s/rad]"""

    @property
    def viscosity_fall(self) -> float:
        """Relative fall beta of the viscosity per kelvin [1/K]"""

    @property
    def load_sensitivity(self) -> float:
        """
        Rise s of the load on the bearing with the torque transmitted [1/(N.m)]
        """

    @property
    def reference_temperature(self) -> float:
        """Temperature T_0 at which the numbers hold [K]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'mixed_lubrication'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    @overload
    def steady(self, speed: float, angle: float = 0.0, load: float = 0.0, temperature: float = 293.15) -> float: ...

    @overload
    def steady(self, speed: float | Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> Any:
        """
        Torque [N.m] that opposes steady sliding at `speed` [rad/s], under `load` [N.m], the torque transmitted where it acts, positive if it drives a positive speed; at `angle` [rad] and `temperature` [K]. The law looks at what it depends on.
        """

    @overload
    def hold(self, sense: float = 1.0, angle: float = 0.0, load: float = 0.0, temperature: float = 293.15) -> float: ...

    @overload
    def hold(self, sense: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 1.0, angle: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> Any:
        """
        The largest torque [N.m] it balances at rest, pushed towards `sense`, under `load` [N.m], the torque transmitted where it acts, positive if it drives a positive speed; at `angle` [rad] and `temperature` [K]. The law looks at what it depends on.

        Zero for a law that does not stick.
        """

    @property
    def set_valued(self) -> bool:
        """Whether it can hold at rest."""

    def trace(self, time: Sequence[float] | numpy.typing.NDArray[numpy.float64], speed: Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), over `time` [s] and `speed` [rad/s], both of shape (n,).

        `angle` [rad] is where the motion starts; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). Exact for a speed that is constant between samples, whatever the step; else the mean of two samples stands for their step. A law that sticks shows no torque at rest: what it holds depends on what drives it.
        """

    def quasistatic(self, displacement: Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), along a path of `displacement` [rad], shape (n,), monotone between its points, in the limit of infinite slowness.

        No torque follows from a speed, and no rate. A law that sticks shows the largest torque it balances, in the sense of the last motion, and none before the first. A law with memory starts virgin, keeps its torque at rest, and is exact over each step, whatever its length. `angle` [rad] is where displacement is zero; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). What varies with them is taken over a step as it is at its end.
        """

class CurvedViscous:
    """
    Friction whose viscous part bends over the speed, with Stribeck's fall, set-valued at rest.

    .. math:: F = \\left[F_c + (F_s - F_c) e^{-(v/v_s)^2} + F_v \\left(|v|/v_r\\right)^p\\right] \\operatorname{sgn} v
              \\quad (v \\ne 0), \\qquad |F| \\le F_s \\quad (v = 0)

    with v the speed of the side it acts on, F_c = coulomb, F_s = breakaway, v_s = stribeck_speed, F_v = viscous_torque at the
    speed v_r = reference_speed, p = exponent. The torque of a wave generator's grease often rises fast at first and then
    ever less: p < 1 (0.5 to 1 is an order of magnitude, assumed); p = 1 is Stribeck's law with viscous = F_v / v_r, and p = 2
    a drag. A breakaway that is not given equals coulomb, and one below counts as coulomb; stribeck_speed then says nothing.
    Below v_r / 10^6 the viscous part falls linearly, so that it has a slope at rest. Valid within the speeds it was measured
    at; leaves out presliding (see LuGre).

    >>> from strainwave.friction import CurvedViscous
    >>> law = CurvedViscous(coulomb=0.02, viscous_torque=0.03, exponent=0.5, reference_speed=100.0)
    >>> law.steady([25.0, 100.0]).round(12)
    array([0.035, 0.05 ])

    Parameters
    ----------
    coulomb: Kinetic friction torque F_c [N.m], in [0, inf); required
    breakaway: Static friction torque F_s [N.m], in [0, inf); default as coulomb
    stribeck_speed: Speed at which the excess F_s - F_c has fallen to 1/e [rad/s], in (0, inf); default 2.0
    viscous_torque: Viscous torque F_v at reference_speed [N.m], in [0, inf); required
    exponent: Exponent p of the speed, in [0.1, 4]; required
    reference_speed: Speed v_r at which viscous_torque holds [rad/s], in (0, inf); required

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    Olsson1998, section 2: viscous friction with an exponent; the fall as in Stribeck
    """

    def __init__(self, *, coulomb: float, breakaway: float = ..., stribeck_speed: float = ..., viscous_torque: float, exponent: float, reference_speed: float) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, coulomb: float = ..., breakaway: float = ..., stribeck_speed: float = ..., viscous_torque: float = ..., exponent: float = ..., reference_speed: float = ...) -> CurvedViscous:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def coulomb(self) -> float:
        """Kinetic friction torque F_c [N.m]"""

    @property
    def breakaway(self) -> float:
        """Static friction torque F_s [N.m]"""

    @property
    def stribeck_speed(self) -> float:
        """Speed at which the excess F_s - F_c has fallen to 1/e [rad/s]"""

    @property
    def viscous_torque(self) -> float:
        """Viscous torque F_v at reference_speed [N.m]"""

    @property
    def exponent(self) -> float:
        """Exponent p of the speed"""

    @property
    def reference_speed(self) -> float:
        """Speed v_r at which viscous_torque holds [rad/s]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'curved_viscous'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    @overload
    def steady(self, speed: float, angle: float = 0.0, load: float = 0.0, temperature: float = 293.15) -> float: ...

    @overload
    def steady(self, speed: float | Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> Any:
        """
        Torque [N.m] that opposes steady sliding at `speed` [rad/s], under `load` [N.m], the torque transmitted where it acts, positive if it drives a positive speed; at `angle` [rad] and `temperature` [K]. The law looks at what it depends on.
        """

    @overload
    def hold(self, sense: float = 1.0, angle: float = 0.0, load: float = 0.0, temperature: float = 293.15) -> float: ...

    @overload
    def hold(self, sense: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 1.0, angle: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> Any:
        """
        The largest torque [N.m] it balances at rest, pushed towards `sense`, under `load` [N.m], the torque transmitted where it acts, positive if it drives a positive speed; at `angle` [rad] and `temperature` [K]. The law looks at what it depends on.

        Zero for a law that does not stick.
        """

    @property
    def set_valued(self) -> bool:
        """Whether it can hold at rest."""

    def trace(self, time: Sequence[float] | numpy.typing.NDArray[numpy.float64], speed: Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), over `time` [s] and `speed` [rad/s], both of shape (n,).

        `angle` [rad] is where the motion starts; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). Exact for a speed that is constant between samples, whatever the step; else the mean of two samples stands for their step. A law that sticks shows no torque at rest: what it holds depends on what drives it.
        """

    def quasistatic(self, displacement: Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), along a path of `displacement` [rad], shape (n,), monotone between its points, in the limit of infinite slowness.

        No torque follows from a speed, and no rate. A law that sticks shows the largest torque it balances, in the sense of the last motion, and none before the first. A law with memory starts virgin, keeps its torque at rest, and is exact over each step, whatever its length. `angle` [rad] is where displacement is zero; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). What varies with them is taken over a step as it is at its end.
        """

class AngleSpeedMap:
    """
    Friction as a table over the speed and the angle within a turn, set-valued at rest.

    .. math:: F = F(\\theta, |v|) \\operatorname{sgn} v \\quad (v \\ne 0), \\qquad |F| \\le c_s\\, F(\\theta, 0) \\quad (v = 0)

    with v the speed of the place it acts on and theta its angle, c_s = static_ratio. F is bilinear between the entries of level.
    For each speed in turn, level lists the torques at equally spaced angles of one turn, beginning at theta = 0:
    n = len(level) / len(speed) of them, at 2 pi j / n. Periodic in the angle. Below the first and beyond the last speed the
    torque stays what it is there. Up to 8 speeds and 128 torques; without any there is no friction.

    All of it counts as dry friction where another law modulates it. Asymmetric around it tells the directions apart. For
    what no formula describes; where one does, as Cyclic around Stribeck, it needs fewer numbers and less data.

    >>> from strainwave.friction import AngleSpeedMap
    >>> law = AngleSpeedMap(speed=[1.0, 11.0], level=[0.1, 0.2, 0.3, 0.4])  # at 0 and at pi
    >>> law.steady([1.0, 6.0, 50.0]), round(float(law.steady(1.0, angle=3.141592653589793)), 12)
    (array([0.1, 0.2, 0.3]), 0.2)

    Parameters
    ----------
    speed: Speeds of the table, increasing [rad/s], in [0, inf); default ()
    level: Torques: of each speed in turn, those at equally spaced angles of one turn [N.m], in [0, inf); default ()
    static_ratio: Static friction over the friction at the lowest speed, in [1, inf); default 1.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition: bilinear interpolation in a table
    """

    def __init__(self, *, speed: float | Sequence[float] = ..., level: float | Sequence[float] = ..., static_ratio: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, speed: float | Sequence[float] = ..., level: float | Sequence[float] = ..., static_ratio: float = ...) -> AngleSpeedMap:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def speed(self) -> tuple[float, ...]:
        """Speeds of the table, increasing [rad/s]"""

    @property
    def level(self) -> tuple[float, ...]:
        """
        Torques: of each speed in turn, those at equally spaced angles of one turn [N.m]
        """

    @property
    def static_ratio(self) -> float:
        """Static friction over the friction at the lowest speed"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'angle_speed_map'

    source: str = 'definition: bilinear interpolation in a table'

    fields: tuple[dict[str, Any], ...]

    @overload
    def steady(self, speed: float, angle: float = 0.0, load: float = 0.0, temperature: float = 293.15) -> float: ...

    @overload
    def steady(self, speed: float | Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> Any:
        """
        Torque [N.m] that opposes steady sliding at `speed` [rad/s], under `load` [N.m], the torque transmitted where it acts, positive if it drives a positive speed; at `angle` [rad] and `temperature` [K]. The law looks at what it depends on.
        """

    @overload
    def hold(self, sense: float = 1.0, angle: float = 0.0, load: float = 0.0, temperature: float = 293.15) -> float: ...

    @overload
    def hold(self, sense: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 1.0, angle: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> Any:
        """
        The largest torque [N.m] it balances at rest, pushed towards `sense`, under `load` [N.m], the torque transmitted where it acts, positive if it drives a positive speed; at `angle` [rad] and `temperature` [K]. The law looks at what it depends on.

        Zero for a law that does not stick.
        """

    @property
    def set_valued(self) -> bool:
        """Whether it can hold at rest."""

    def trace(self, time: Sequence[float] | numpy.typing.NDArray[numpy.float64], speed: Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), over `time` [s] and `speed` [rad/s], both of shape (n,).

        `angle` [rad] is where the motion starts; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). Exact for a speed that is constant between samples, whatever the step; else the mean of two samples stands for their step. A law that sticks shows no torque at rest: what it holds depends on what drives it.
        """

    def quasistatic(self, displacement: Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), along a path of `displacement` [rad], shape (n,), monotone between its points, in the limit of infinite slowness.

        No torque follows from a speed, and no rate. A law that sticks shows the largest torque it balances, in the sense of the last motion, and none before the first. A law with memory starts virgin, keeps its torque at rest, and is exact over each step, whatever its length. `angle` [rad] is where displacement is zero; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). What varies with them is taken over a step as it is at its end.
        """

class TorqueEfficiency:
    """
    Loss proportional to the torque transmitted, which turns round with the motion over a presliding angle.

    .. math:: \\dot z = (v - |v| z) / h, \\qquad F = \\mu_{avg} |T| z + \\mu_{dif} T z^2 + b v

    with v the speed of the place it acts on, T the torque it transmits (load), z the engagement, +1 or -1 in steady motion,
    mu_avg = average_loss, mu_dif = difference_loss, h = presliding, b = viscous. In steady motion the loss per torque
    transmitted is mu_avg + mu_dif when driving (T v > 0) and mu_avg - mu_dif when back-driven: LoadDependent with equal
    ratios in both senses. mu_avg must not lie below the size of mu_dif, or steady motion would create energy.

    Under constant load it dissipates for every motion, with the stored energy mu_avg T h z^2 / 2 (size of T). Where the
    load varies, this energy rises and falls with it: a change of load can put in as much, and the motion after it take it
    out. It does not stick at rest: it yields by about h. Leaves out what an idle gear loses besides b v. The thread's tau
    is the torque of the motor; T is what arrives on the output's side, so a ratio m found there when driving is
    m / (1 - m) here.

    >>> from strainwave.friction import TorqueEfficiency
    >>> TorqueEfficiency(average_loss=0.25, difference_loss=0.05, presliding=0.001).steady([10.0, -10.0], load=4.0)
    array([ 1.2, -0.8])

    Parameters
    ----------
    average_loss: Loss per torque transmitted, mean of driving and back-driving, in [0, inf); required
    difference_loss: Half of what driving loses more than back-driving, per torque transmitted; default 0.0
    presliding: Angle h over which the loss turns round after a reversal [rad], in (0, inf); required
    viscous: Torque per speed [N.m.s/rad], in [0, inf); default 0.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    public thread google-deepmind/mujoco#3528, comment of 2026-09-18 (there tau is the electrical torque of the motor)
    """

    def __init__(self, *, average_loss: float, difference_loss: float = ..., presliding: float, viscous: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, average_loss: float = ..., difference_loss: float = ..., presliding: float = ..., viscous: float = ...) -> TorqueEfficiency:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def average_loss(self) -> float:
        """Loss per torque transmitted, mean of driving and back-driving"""

    @property
    def difference_loss(self) -> float:
        """
        Half of what driving loses more than back-driving, per torque transmitted
        """

    @property
    def presliding(self) -> float:
        """Angle h over which the loss turns round after a reversal [rad]"""

    @property
    def viscous(self) -> float:
        """Torque per speed [N.m.s/rad]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'torque_efficiency'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    class State:
        """
        Parameters
        ----------
        engagement: Engagement z: the sense of motion, as far as friction has followed it; default 0.0

        Raises
        ------
        TypeError: an unknown parameter, one of the wrong kind, or none where it is required
        ValueError: a number that is not finite or out of its range
        """

        def __init__(self, *, engagement: float = ...) -> None: ...

        def replace(self, changes: dict[str, Any] = ..., /, *, engagement: float = ...) -> TorqueEfficiency.State:
            """
            The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
            """

        @property
        def engagement(self) -> float:
            """Engagement z: the sense of motion, as far as friction has followed it"""

        def __repr__(self) -> str: ...

        def __eq__(self, other: object, /) -> bool: ...

        def __hash__(self) -> int: ...

        def __getstate__(self) -> dict[str, object]: ...

        def __setstate__(self, state: dict[str, object], /) -> None: ...

        def __reduce__(self) -> tuple[Any, ...]: ...

        name: str = 'torque_efficiency.state'

        fields: tuple[dict[str, Any], ...]

    @overload
    def steady(self, speed: float, angle: float = 0.0, load: float = 0.0, temperature: float = 293.15) -> float: ...

    @overload
    def steady(self, speed: float | Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> Any:
        """
        Torque [N.m] that opposes steady sliding at `speed` [rad/s], under `load` [N.m], the torque transmitted where it acts, positive if it drives a positive speed; at `angle` [rad] and `temperature` [K]. The law looks at what it depends on.
        """

    @overload
    def hold(self, sense: float = 1.0, angle: float = 0.0, load: float = 0.0, temperature: float = 293.15) -> float: ...

    @overload
    def hold(self, sense: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 1.0, angle: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> Any:
        """
        The largest torque [N.m] it balances at rest, pushed towards `sense`, under `load` [N.m], the torque transmitted where it acts, positive if it drives a positive speed; at `angle` [rad] and `temperature` [K]. The law looks at what it depends on.

        Zero for a law that does not stick.
        """

    @property
    def set_valued(self) -> bool:
        """Whether it can hold at rest."""

    def trace(self, time: Sequence[float] | numpy.typing.NDArray[numpy.float64], speed: Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15, state: State = ...) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), over `time` [s] and `speed` [rad/s], both of shape (n,).

        `angle` [rad] is where the motion starts; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). Exact for a speed that is constant between samples, whatever the step; else the mean of two samples stands for their step. A law that sticks shows no torque at rest: what it holds depends on what drives it.
        """

    def quasistatic(self, displacement: Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), along a path of `displacement` [rad], shape (n,), monotone between its points, in the limit of infinite slowness.

        No torque follows from a speed, and no rate. A law that sticks shows the largest torque it balances, in the sense of the last motion, and none before the first. A law with memory starts virgin, keeps its torque at rest, and is exact over each step, whatever its length. `angle` [rad] is where displacement is zero; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). What varies with them is taken over a step as it is at its end.
        """

    odd: bool = True

class Asymmetric:
    """
    Friction that is larger one way than the other.

    .. math:: F_{dry} \\propto 1 + a_d \\operatorname{sgn} v, \\qquad F_{viscous} \\propto 1 + a_v \\operatorname{sgn} v

    with v the speed of the place it acts on, a_d = dry_asymmetry, a_v = viscous_asymmetry, law the mean of both directions:
    its dry levels (Coulomb, breakaway) and its viscous torque are multiplied. At rest the torque that drives it says which
    way counts. A viscous_asymmetry that is not given equals dry_asymmetry: the whole curve is then larger one way.

    Each way it is the law itself with other levels, so it takes power from every motion where those would. A bristle keeps
    its stiffness and damping, and must be damped so little that it dissipates with the smaller viscous torque, too. Not for
    ``TorqueEfficiency``, whose torque would jump in a reversal and give energy.

    A constant error of a torque sensor looks much the same: of Coulomb friction without viscous_asymmetry, exactly.

    >>> from strainwave.friction import Asymmetric, Coulomb
    >>> law = Asymmetric(law=Coulomb(coulomb=0.25, viscous=0.01), dry_asymmetry=0.5, viscous_asymmetry=0.0)
    >>> law.steady([10.0, -10.0]), law.hold([1.0, -1.0])
    (array([ 0.475, -0.225]), array([0.375, 0.125]))

    Parameters
    ----------
    law: The friction, mean of both directions; default Viscous(viscous=0.0)
    dry_asymmetry: How much more dry friction a positive speed has, relative to the mean, in [-1, 1]; default 0.0
    viscous_asymmetry: How much more viscous friction a positive speed has, relative to the mean, in [-1, 1]; default as dry_asymmetry

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    CanudasDeWit1995, section II: G(v) need not be symmetrical, so that friction depends on the direction; one factor for each direction is assumed
    """

    def __init__(self, *, law: Viscous | Coulomb | Stribeck | PositionDependent | LuGre | MaxwellSlipFriction | LoadDependent | MixedLubrication | CurvedViscous | AngleSpeedMap = ..., dry_asymmetry: float = ..., viscous_asymmetry: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, law: Viscous | Coulomb | Stribeck | PositionDependent | LuGre | MaxwellSlipFriction | LoadDependent | MixedLubrication | CurvedViscous | AngleSpeedMap = ..., dry_asymmetry: float = ..., viscous_asymmetry: float = ...) -> Asymmetric:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def law(self) -> Viscous | Coulomb | Stribeck | PositionDependent | LuGre | MaxwellSlipFriction | LoadDependent | MixedLubrication | CurvedViscous | AngleSpeedMap:
        """The friction, mean of both directions"""

    @property
    def dry_asymmetry(self) -> float:
        """How much more dry friction a positive speed has, relative to the mean"""

    @property
    def viscous_asymmetry(self) -> float:
        """
        How much more viscous friction a positive speed has, relative to the mean
        """

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'asymmetric'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    class State:
        """
        Parameters
        ----------
        slot: State of the law chosen, in the order it lists it; default ()

        Raises
        ------
        TypeError: an unknown parameter, one of the wrong kind, or none where it is required
        ValueError: a number that is not finite or out of its range
        """

        def __init__(self, *, slot: float | Sequence[float] = ...) -> None: ...

        def replace(self, changes: dict[str, Any] = ..., /, *, slot: float | Sequence[float] = ...) -> Asymmetric.State:
            """
            The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
            """

        @property
        def slot(self) -> tuple[float, ...]:
            """State of the law chosen, in the order it lists it"""

        def __repr__(self) -> str: ...

        def __eq__(self, other: object, /) -> bool: ...

        def __hash__(self) -> int: ...

        def __getstate__(self) -> dict[str, object]: ...

        def __setstate__(self, state: dict[str, object], /) -> None: ...

        def __reduce__(self) -> tuple[Any, ...]: ...

        name: str = 'asymmetric.state'

        fields: tuple[dict[str, Any], ...]

    @overload
    def steady(self, speed: float, angle: float = 0.0, load: float = 0.0, temperature: float = 293.15) -> float: ...

    @overload
    def steady(self, speed: float | Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> Any:
        """
        Torque [N.m] that opposes steady sliding at `speed` [rad/s], under `load` [N.m], the torque transmitted where it acts, positive if it drives a positive speed; at `angle` [rad] and `temperature` [K]. The law looks at what it depends on.
        """

    @overload
    def hold(self, sense: float = 1.0, angle: float = 0.0, load: float = 0.0, temperature: float = 293.15) -> float: ...

    @overload
    def hold(self, sense: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 1.0, angle: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> Any:
        """
        The largest torque [N.m] it balances at rest, pushed towards `sense`, under `load` [N.m], the torque transmitted where it acts, positive if it drives a positive speed; at `angle` [rad] and `temperature` [K]. The law looks at what it depends on.

        Zero for a law that does not stick.
        """

    @property
    def set_valued(self) -> bool:
        """Whether it can hold at rest."""

    def trace(self, time: Sequence[float] | numpy.typing.NDArray[numpy.float64], speed: Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15, state: State = ...) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), over `time` [s] and `speed` [rad/s], both of shape (n,).

        `angle` [rad] is where the motion starts; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). Exact for a speed that is constant between samples, whatever the step; else the mean of two samples stands for their step. A law that sticks shows no torque at rest: what it holds depends on what drives it.
        """

    def quasistatic(self, displacement: Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), along a path of `displacement` [rad], shape (n,), monotone between its points, in the limit of infinite slowness.

        No torque follows from a speed, and no rate. A law that sticks shows the largest torque it balances, in the sense of the last motion, and none before the first. A law with memory starts virgin, keeps its torque at rest, and is exact over each step, whatever its length. `angle` [rad] is where displacement is zero; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). What varies with them is taken over a step as it is at its end.
        """

    odd: bool = False

class Cyclic:
    """
    Friction that varies with the angle, as the wave generator's contacts do over its turn.

    .. math:: F = f(\\theta)\\, F_{law}, \\qquad f(\\theta) = 1 + \\sum_h A_h \\sin(B_h \\theta + \\varphi_h) \\ge 0

    with theta the angle of the place it acts on, B_h = order, A_h = amplitude relative to the mean, phi_h = phase, law the
    friction that is modulated: its dry levels (Coulomb, breakaway) and its viscous torque are multiplied, so that a bristle
    keeps its stiffness. Up to 16 harmonics; where the sum falls below zero, f is zero.

    Document R prints (A + B v) f(theta), which pushes a reversed motion along: it must read (A sgn v + B v) f(theta)
    (E-R7). With law a Coulomb friction of coulomb = A and viscous = B this is that term.

    >>> from strainwave.friction import Coulomb, Cyclic
    >>> law = Cyclic(law=Coulomb(coulomb=0.25, viscous=0.0), order=[2], amplitude=[0.5], phase=[0.0])
    >>> law.steady(1.0, angle=0.25 * 3.141592653589793), law.steady(-1.0, angle=0.25 * 3.141592653589793)
    (0.375, -0.375)

    Parameters
    ----------
    law: The friction that varies; default Viscous(viscous=0.0)
    order: Order B_h: periods per revolution, in [0, inf); default ()
    amplitude: Amplitude A_h, relative to the mean friction, in [0, inf); default ()
    phase: Phase phi_h [rad]; default ()

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    document R, section 2, cyclic part of the friction torque; erratum E-R7
    """

    def __init__(self, *, law: Viscous | Coulomb | Stribeck | PositionDependent | LuGre | MaxwellSlipFriction | LoadDependent | MixedLubrication | CurvedViscous | AngleSpeedMap | TorqueEfficiency | Asymmetric = ..., order: float | Sequence[float] = ..., amplitude: float | Sequence[float] = ..., phase: float | Sequence[float] = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, law: Viscous | Coulomb | Stribeck | PositionDependent | LuGre | MaxwellSlipFriction | LoadDependent | MixedLubrication | CurvedViscous | AngleSpeedMap | TorqueEfficiency | Asymmetric = ..., order: float | Sequence[float] = ..., amplitude: float | Sequence[float] = ..., phase: float | Sequence[float] = ...) -> Cyclic:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def law(self) -> Viscous | Coulomb | Stribeck | PositionDependent | LuGre | MaxwellSlipFriction | LoadDependent | MixedLubrication | CurvedViscous | AngleSpeedMap | TorqueEfficiency | Asymmetric:
        """The friction that varies"""

    @property
    def order(self) -> tuple[float, ...]:
        """Order B_h: periods per revolution"""

    @property
    def amplitude(self) -> tuple[float, ...]:
        """Amplitude A_h, relative to the mean friction"""

    @property
    def phase(self) -> tuple[float, ...]:
        """Phase phi_h [rad]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'cyclic'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    class State:
        """
        Parameters
        ----------
        slot: State of the law chosen, in the order it lists it; default ()

        Raises
        ------
        TypeError: an unknown parameter, one of the wrong kind, or none where it is required
        ValueError: a number that is not finite or out of its range
        """

        def __init__(self, *, slot: float | Sequence[float] = ...) -> None: ...

        def replace(self, changes: dict[str, Any] = ..., /, *, slot: float | Sequence[float] = ...) -> Asymmetric.State:
            """
            The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
            """

        @property
        def slot(self) -> tuple[float, ...]:
            """State of the law chosen, in the order it lists it"""

        def __repr__(self) -> str: ...

        def __eq__(self, other: object, /) -> bool: ...

        def __hash__(self) -> int: ...

        def __getstate__(self) -> dict[str, object]: ...

        def __setstate__(self, state: dict[str, object], /) -> None: ...

        def __reduce__(self) -> tuple[Any, ...]: ...

        name: str = 'asymmetric.state'

        fields: tuple[dict[str, Any], ...]

    @overload
    def steady(self, speed: float, angle: float = 0.0, load: float = 0.0, temperature: float = 293.15) -> float: ...

    @overload
    def steady(self, speed: float | Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> Any:
        """
        Torque [N.m] that opposes steady sliding at `speed` [rad/s], under `load` [N.m], the torque transmitted where it acts, positive if it drives a positive speed; at `angle` [rad] and `temperature` [K]. The law looks at what it depends on.
        """

    @overload
    def hold(self, sense: float = 1.0, angle: float = 0.0, load: float = 0.0, temperature: float = 293.15) -> float: ...

    @overload
    def hold(self, sense: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 1.0, angle: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> Any:
        """
        The largest torque [N.m] it balances at rest, pushed towards `sense`, under `load` [N.m], the torque transmitted where it acts, positive if it drives a positive speed; at `angle` [rad] and `temperature` [K]. The law looks at what it depends on.

        Zero for a law that does not stick.
        """

    @property
    def set_valued(self) -> bool:
        """Whether it can hold at rest."""

    def trace(self, time: Sequence[float] | numpy.typing.NDArray[numpy.float64], speed: Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15, state: State = ...) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), over `time` [s] and `speed` [rad/s], both of shape (n,).

        `angle` [rad] is where the motion starts; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). Exact for a speed that is constant between samples, whatever the step; else the mean of two samples stands for their step. A law that sticks shows no torque at rest: what it holds depends on what drives it.
        """

    def quasistatic(self, displacement: Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), along a path of `displacement` [rad], shape (n,), monotone between its points, in the limit of infinite slowness.

        No torque follows from a speed, and no rate. A law that sticks shows the largest torque it balances, in the sense of the last motion, and none before the first. A law with memory starts virgin, keeps its torque at rest, and is exact over each step, whatever its length. `angle` [rad] is where displacement is zero; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). What varies with them is taken over a step as it is at its end.
        """

class Thermal:
    """
    Friction that falls as the gear warms up.

    .. math:: F_{dry} \\propto e^{-\\kappa_d (T - T_0)}, \\qquad F_{viscous} \\propto e^{-\\kappa_v (T - T_0)}

    with T the temperature, T_0 = reference_temperature, kappa_d = dry_fall, kappa_v = viscous_fall, law the friction as it
    is at T_0: its dry levels (Coulomb, breakaway) and its viscous torque are multiplied. The rates are not known from a
    catalogue; identify them. For the viscous part 0.02 to 0.03 per kelvin is an order of magnitude (assumed). Valid over
    some tens of kelvin; leaves out that friction heats the gear: the temperature is given.

    >>> from strainwave.friction import Coulomb, Thermal
    >>> law = Thermal(law=Coulomb(coulomb=0.0, viscous=0.01), viscous_fall=0.025, reference_temperature=293.15)
    >>> round(float(law.steady(10.0, temperature=333.15)), 9)
    0.036787944

    Parameters
    ----------
    law: The friction at the reference temperature; default Viscous(viscous=0.0)
    dry_fall: Relative fall kappa_d of dry friction per kelvin [1/K]; default 0.0
    viscous_fall: Relative fall kappa_v of viscous friction per kelvin [1/K]; default 0.0
    reference_temperature: Temperature T_0 at which the law was measured [K], in (0, inf); default 293.15

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    exponential fall of lubricant viscosity with temperature (Reynolds1886); rates: the user's
    """

    def __init__(self, *, law: Viscous | Coulomb | Stribeck | PositionDependent | LuGre | MaxwellSlipFriction | LoadDependent | MixedLubrication | CurvedViscous | AngleSpeedMap | TorqueEfficiency | Asymmetric | Cyclic = ..., dry_fall: float = ..., viscous_fall: float = ..., reference_temperature: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, law: Viscous | Coulomb | Stribeck | PositionDependent | LuGre | MaxwellSlipFriction | LoadDependent | MixedLubrication | CurvedViscous | AngleSpeedMap | TorqueEfficiency | Asymmetric | Cyclic = ..., dry_fall: float = ..., viscous_fall: float = ..., reference_temperature: float = ...) -> Thermal:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def law(self) -> Viscous | Coulomb | Stribeck | PositionDependent | LuGre | MaxwellSlipFriction | LoadDependent | MixedLubrication | CurvedViscous | AngleSpeedMap | TorqueEfficiency | Asymmetric | Cyclic:
        """The friction at the reference temperature"""

    @property
    def dry_fall(self) -> float:
        """Relative fall kappa_d of dry friction per kelvin [1/K]"""

    @property
    def viscous_fall(self) -> float:
        """Relative fall kappa_v of viscous friction per kelvin [1/K]"""

    @property
    def reference_temperature(self) -> float:
        """Temperature T_0 at which the law was measured [K]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'thermal'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    class State:
        """
        Parameters
        ----------
        slot: State of the law chosen, in the order it lists it; default ()

        Raises
        ------
        TypeError: an unknown parameter, one of the wrong kind, or none where it is required
        ValueError: a number that is not finite or out of its range
        """

        def __init__(self, *, slot: float | Sequence[float] = ...) -> None: ...

        def replace(self, changes: dict[str, Any] = ..., /, *, slot: float | Sequence[float] = ...) -> Asymmetric.State:
            """
            The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
            """

        @property
        def slot(self) -> tuple[float, ...]:
            """State of the law chosen, in the order it lists it"""

        def __repr__(self) -> str: ...

        def __eq__(self, other: object, /) -> bool: ...

        def __hash__(self) -> int: ...

        def __getstate__(self) -> dict[str, object]: ...

        def __setstate__(self, state: dict[str, object], /) -> None: ...

        def __reduce__(self) -> tuple[Any, ...]: ...

        name: str = 'asymmetric.state'

        fields: tuple[dict[str, Any], ...]

    @overload
    def steady(self, speed: float, angle: float = 0.0, load: float = 0.0, temperature: float = 293.15) -> float: ...

    @overload
    def steady(self, speed: float | Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> Any:
        """
        Torque [N.m] that opposes steady sliding at `speed` [rad/s], under `load` [N.m], the torque transmitted where it acts, positive if it drives a positive speed; at `angle` [rad] and `temperature` [K]. The law looks at what it depends on.
        """

    @overload
    def hold(self, sense: float = 1.0, angle: float = 0.0, load: float = 0.0, temperature: float = 293.15) -> float: ...

    @overload
    def hold(self, sense: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 1.0, angle: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> Any:
        """
        The largest torque [N.m] it balances at rest, pushed towards `sense`, under `load` [N.m], the torque transmitted where it acts, positive if it drives a positive speed; at `angle` [rad] and `temperature` [K]. The law looks at what it depends on.

        Zero for a law that does not stick.
        """

    @property
    def set_valued(self) -> bool:
        """Whether it can hold at rest."""

    def trace(self, time: Sequence[float] | numpy.typing.NDArray[numpy.float64], speed: Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15, state: State = ...) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), over `time` [s] and `speed` [rad/s], both of shape (n,).

        `angle` [rad] is where the motion starts; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). Exact for a speed that is constant between samples, whatever the step; else the mean of two samples stands for their step. A law that sticks shows no torque at rest: what it holds depends on what drives it.
        """

    def quasistatic(self, displacement: Sequence[float] | numpy.typing.NDArray[numpy.float64], angle: float = 0.0, load: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 0.0, temperature: float | Sequence[float] | numpy.typing.NDArray[numpy.float64] = 293.15) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), along a path of `displacement` [rad], shape (n,), monotone between its points, in the limit of infinite slowness.

        No torque follows from a speed, and no rate. A law that sticks shows the largest torque it balances, in the sense of the last motion, and none before the first. A law with memory starts virgin, keeps its torque at rest, and is exact over each step, whatever its length. `angle` [rad] is where displacement is zero; `load` [N.m] and `temperature` [K] are numbers or of shape (n,). What varies with them is taken over a step as it is at its end.
        """
