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
    TypeError: an unknown parameter, or one of the wrong kind
    ValueError: a number that is not finite or out of its range

    Source
    ------
    Newton's law of viscosity; document P, b_m and b_l of Table 3
    """

    def __init__(self, *, viscous: float = ...) -> None: ...

    def replace(self, *, viscous: float = ...) -> Viscous:
        """The same with the named parameters changed."""

    @property
    def viscous(self) -> float:
        """Torque per speed [N.m.s/rad]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    name: str = 'viscous'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    @overload
    def steady(self, speed: float) -> float: ...

    @overload
    def steady(self, speed: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """Torque [N.m] that opposes steady sliding at `speed` [rad/s]."""

class Coulomb:
    """
    Static, Coulomb and viscous friction, set-valued at rest: it sticks exactly.

    .. math:: F = F_c \\operatorname{sgn} v + b v \\quad (v \\ne 0), \\qquad |F| \\le F_s \\quad (v = 0)

    with v the speed of the side it acts on, F_c = coulomb, F_s = breakaway, b = viscous. At rest F balances whatever
    drives the side, up to F_s; there is no smoothed sign and no dead band of speed, both of which leave an error that no
    step size removes. A breakaway below coulomb counts as coulomb.

    >>> from strainwave.friction import Coulomb
    >>> Coulomb(coulomb=0.07, breakaway=0.075, viscous=5e-4).steady(-20.0)
    -0.08

    Parameters
    ----------
    coulomb: Kinetic friction torque F_c [N.m], in [0, inf); default 0.0
    breakaway: Static friction torque F_s [N.m], in [0, inf); default 0.0
    viscous: Torque per speed [N.m.s/rad], in [0, inf); default 0.0

    Raises
    ------
    TypeError: an unknown parameter, or one of the wrong kind
    ValueError: a number that is not finite or out of its range

    Source
    ------
    document P, simplified friction model (static + Coulomb + viscous); Coulomb1785
    """

    def __init__(self, *, coulomb: float = ..., breakaway: float = ..., viscous: float = ...) -> None: ...

    def replace(self, *, coulomb: float = ..., breakaway: float = ..., viscous: float = ...) -> Coulomb:
        """The same with the named parameters changed."""

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

    name: str = 'coulomb'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    @overload
    def steady(self, speed: float) -> float: ...

    @overload
    def steady(self, speed: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """Torque [N.m] that opposes steady sliding at `speed` [rad/s]."""

    def hold(self) -> float:
        """The largest torque [N.m] it balances at rest."""

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
    coulomb: Kinetic friction torque F_c [N.m], in [0, inf); default 0.03
    breakaway: Static friction torque F_s [N.m], in [0, inf); default 0.045
    stribeck_speed: Speed at which the excess F_s - F_c has fallen to 1/e [rad/s], in (0, inf); default 2.0
    viscous: Torque per speed [N.m.s/rad], in [0, inf); default 5e-05

    Raises
    ------
    TypeError: an unknown parameter, or one of the wrong kind
    ValueError: a number that is not finite or out of its range

    Source
    ------
    Stribeck1902; ArmstrongHelouvry1994, eq. (3) with exponent 2
    """

    def __init__(self, *, coulomb: float = ..., breakaway: float = ..., stribeck_speed: float = ..., viscous: float = ...) -> None: ...

    def replace(self, *, coulomb: float = ..., breakaway: float = ..., stribeck_speed: float = ..., viscous: float = ...) -> Stribeck:
        """The same with the named parameters changed."""

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

    name: str = 'stribeck'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    @overload
    def steady(self, speed: float) -> float: ...

    @overload
    def steady(self, speed: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """Torque [N.m] that opposes steady sliding at `speed` [rad/s]."""

    def hold(self) -> float:
        """The largest torque [N.m] it balances at rest."""

class LuGre:
    """
    Friction of an elastic bristle that bends before it slips: presliding, breakaway, Stribeck fall, viscous rise.

    .. math:: \\dot z = v - \\sigma_0 |v| z / G(v), \\quad G(v) = F_c + (F_s - F_c) e^{-(v/v_s)^2}, \\quad
              F = \\sigma_0 z + \\sigma_1 \\dot z + \\sigma_2 v

    with v the speed of the side it acts on, F_c = coulomb, F_s = breakaway, v_s = stribeck_speed,
    sigma_0 = bristle_stiffness, sigma_1 = bristle_damping, sigma_2 = viscous.

    Valid for one contact under constant load; leaves out load, position and temperature. Dissipates for every motion only
    if viscous >= bristle_damping (breakaway / coulomb - 1); a set that violates this is accepted, and ``check()`` warns
    with both sides.

    >>> from strainwave.friction import LuGre
    >>> LuGre(coulomb=0.05, breakaway=0.07, stribeck_speed=0.1, viscous=4e-4).steady(1.0)
    0.0504

    Parameters
    ----------
    coulomb: Kinetic friction torque F_c [N.m], in [0, inf); default 0.03
    breakaway: Static friction torque F_s [N.m], in [0, inf); default 0.045
    stribeck_speed: Speed at which the excess F_s - F_c has fallen to 1/e [rad/s], in (0, inf); default 2.0
    bristle_stiffness: Torque per bristle deflection [N.m/rad], in (0, inf); default 50.0
    bristle_damping: Torque per bristle rate [N.m.s/rad], in [0, inf); default 0.02
    viscous: Torque per speed [N.m.s/rad], in [0, inf); default 5e-05

    Raises
    ------
    TypeError: an unknown parameter, or one of the wrong kind
    ValueError: a number that is not finite or out of its range

    Source
    ------
    CanudasDeWit1995, eqs. (1)-(4); passivity: BarabanovOrtega2000
    """

    def __init__(self, *, coulomb: float = ..., breakaway: float = ..., stribeck_speed: float = ..., bristle_stiffness: float = ..., bristle_damping: float = ..., viscous: float = ...) -> None: ...

    def replace(self, *, coulomb: float = ..., breakaway: float = ..., stribeck_speed: float = ..., bristle_stiffness: float = ..., bristle_damping: float = ..., viscous: float = ...) -> LuGre:
        """The same with the named parameters changed."""

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
        """Torque per bristle rate [N.m.s/rad]"""

    @property
    def viscous(self) -> float:
        """Torque per speed [N.m.s/rad]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    name: str = 'lugre'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    @overload
    def steady(self, speed: float) -> float: ...

    @overload
    def steady(self, speed: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """Torque [N.m] that opposes steady sliding at `speed` [rad/s]."""

    class State:
        """
        Parameters
        ----------
        deflection: Mean bristle deflection z [rad]; default 0.0

        Raises
        ------
        TypeError: an unknown parameter, or one of the wrong kind
        ValueError: a number that is not finite or out of its range
        """

        def __init__(self, *, deflection: float = ...) -> None: ...

        def replace(self, *, deflection: float = ...) -> LuGre.State:
            """The same with the named parameters changed."""

        @property
        def deflection(self) -> float:
            """Mean bristle deflection z [rad]"""

        def __repr__(self) -> str: ...

        def __eq__(self, other: object, /) -> bool: ...

        def __hash__(self) -> int: ...

        def __getstate__(self) -> dict[str, object]: ...

        def __setstate__(self, state: dict[str, object], /) -> None: ...

        name: str = 'lugre.state'

        fields: tuple[dict[str, Any], ...]

    def trace(self, time: Sequence[float] | numpy.typing.NDArray[numpy.float64], speed: Sequence[float] | numpy.typing.NDArray[numpy.float64], state: State = ...) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), over `time` [s] and `speed` [rad/s], both of shape (n,).

        Exact for a speed that is constant between samples, whatever the step; else the mean of two samples stands for their step.
        """

    def check(self) -> None:
        """
        Warns with PassivityWarning, stating both sides, if the parameters let the model create energy.
        """
