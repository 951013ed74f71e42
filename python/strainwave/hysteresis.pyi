"""Torque that depends on the history of the twist."""

from collections.abc import Sequence
from typing import Any

import numpy
import numpy.typing

import strainwave.stiffness


class PrandtlIshlinskii:
    """
    Twist over torque as a sum of plays: the compliance of a spring with slip, and the exact inverse of Maxwell-slip.

    .. math:: \\delta = \\sum_j w_j p_j, \\quad p_j \\leftarrow \\operatorname{clip}(p_j, T - r_j, T + r_j)

    with T the torque, delta the twist, r_j = threshold, w_j = weight, up to 17 plays; a threshold of 0 is a plain spring.
    The clip is exact for any step over which the torque is monotone, whatever its size. Rate-independent; obeys Masing's
    rules, wiping-out and congruency; symmetric.

    Maxwell-slip in parallel with a spring follows its virgin curve in straight pieces; this law follows the same pieces with
    the axes exchanged. The last slope must be positive: slipping elements without a spring have no inverse.

    >>> from strainwave.hysteresis import MaxwellSlip
    >>> gear = MaxwellSlip(stiffness=[1000, 600, 300], breakaway=[0.5, 0.9, 0.9])  # with a spring of 500: 3 and -2.2 N.m
    >>> gear.inverse(500.0).trace([0.0, 3.0, -2.2]).round(12)
    array([ 0.   ,  0.002, -0.001])

    Parameters
    ----------
    threshold: Torque r_j by which each play follows late [N.m], in [0, inf); default ()
    weight: Compliance w_j of each play [rad/(N.m)], in [0, inf); default ()

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    KrejciKuhnen2001 (plays, the inverse of stops)
    """

    def __init__(self, *, threshold: float | Sequence[float] = ..., weight: float | Sequence[float] = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, threshold: float | Sequence[float] = ..., weight: float | Sequence[float] = ...) -> PrandtlIshlinskii:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def threshold(self) -> tuple[float, ...]:
        """Torque r_j by which each play follows late [N.m]"""

    @property
    def weight(self) -> tuple[float, ...]:
        """Compliance w_j of each play [rad/(N.m)]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'prandtl_ishlinskii'

    source: str = 'KrejciKuhnen2001 (plays, the inverse of stops)'

    fields: tuple[dict[str, Any], ...]

    class State:
        """
        Parameters
        ----------
        torque: Torque T that acts [N.m]; default 0.0
        play: Torque p_j that each play follows with [N.m]; default (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

        Raises
        ------
        TypeError: an unknown parameter, one of the wrong kind, or none where it is required
        ValueError: a number that is not finite or out of its range
        """

        def __init__(self, *, torque: float = ..., play: Sequence[float] = ...) -> None: ...

        def replace(self, changes: dict[str, Any] = ..., /, *, torque: float = ..., play: Sequence[float] = ...) -> PrandtlIshlinskii.State:
            """
            The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
            """

        @property
        def torque(self) -> float:
            """Torque T that acts [N.m]"""

        @property
        def play(self) -> tuple[float, ...]:
            """Torque p_j that each play follows with [N.m]"""

        def __repr__(self) -> str: ...

        def __eq__(self, other: object, /) -> bool: ...

        def __hash__(self) -> int: ...

        def __getstate__(self) -> dict[str, object]: ...

        def __setstate__(self, state: dict[str, object], /) -> None: ...

        def __reduce__(self) -> tuple[Any, ...]: ...

        name: str = 'prandtl_ishlinskii.state'

        fields: tuple[dict[str, Any], ...]

    def trace(self, torque: Sequence[float] | numpy.typing.NDArray[numpy.float64], state: State = ...) -> numpy.typing.NDArray[numpy.float64]:
        """
        Twist [rad], shape (n,), along a path of `torque` [N.m], shape (n,), from rest at its first point.
        """

    def advance(self, torque: Sequence[float] | numpy.typing.NDArray[numpy.float64], state: State = ...) -> State:
        """The state at the end of a path of `torque` [N.m]."""

class PowerDensity:
    """
    Preisach density that falls with the width of the window as a power: a loop with three parameters.

    .. math:: E(a, b) = T_s [1 - (1 - u)^p], \\quad u = \\frac{a - b}{2 L}, \\quad
              \\mu = \\frac{p (p - 1) T_s}{4 L^2} (1 - u)^{p - 2}

    with L = limit, T_s = saturation, p = exponent, a and b cut at +-L; the initial curve is E(x, -x). Exponent 1 is a spring
    that gives way at L, without loss; 2 is uniform density, whose branches are the parabolas of Rayleigh's law; the higher,
    the stiffer after a reversal, p T_s / L, and the sooner it slips; with L in proportion to p it tends to exponential
    branches. Odd, and obeys Masing's rules, which Preisach's law in general does not.

    >>> from strainwave.hysteresis import PowerDensity, Preisach
    >>> gear = Preisach(density=PowerDensity(limit=1.0, saturation=1.0, exponent=2.0))
    >>> gear.trace([0.0, 0.5, -0.5, 0.0])
    array([ 0.   ,  0.75 , -0.75 ,  0.125])

    Parameters
    ----------
    limit: Twist L at which everything slips [rad], in (0, inf); required
    saturation: Torque T_s once everything slips [N.m], in [0, inf); required
    exponent: Power p: 1 elastic, 2 uniform density, in [1, 100]; default 2.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    Rayleigh1887 (exponent 2); Everett1955; the power is assumed
    """

    def __init__(self, *, limit: float, saturation: float, exponent: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, limit: float = ..., saturation: float = ..., exponent: float = ...) -> PowerDensity:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def limit(self) -> float:
        """Twist L at which everything slips [rad]"""

    @property
    def saturation(self) -> float:
        """Torque T_s once everything slips [N.m]"""

    @property
    def exponent(self) -> float:
        """Power p: 1 elastic, 2 uniform density"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'power_density'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

class GridDensity:
    """
    Preisach density in cells, for measured loops, symmetric or not.

    .. math:: E(a, b) = \\sum_{i \\ge j} w_{ij} (g_i + g_j - g_i g_j)

    with w_ij = weight, and g_i the share of row i that lies between the turning points b and a. [-L, L], L = limit, is cut
    into n equal rows. Cell (i, j) holds the hysterons whose window ends in row i and begins in row j, evenly spread: each
    pushes on from entering its window, forward from below, back from above. Weights are listed from the most negative
    twist on, (0,0), (1,0), (1,1), (2,0), ...: n (n + 1) / 2 of them, n up to 10; none at all is no hysteresis. The torque
    is linear in them, the change from one saturation to the other is twice their sum.

    Zero torque is that of the virgin gear, as with all hysteresis: where the weights are not symmetric, w_ij and
    w_(n-1-j)(n-1-i), the two saturations differ.

    >>> from strainwave.hysteresis import GridDensity, Preisach
    >>> gear = Preisach(density=GridDensity(limit=1.0, weight=[0.0, 0.5, 1.0]))
    >>> gear.trace([0.0, 1.0, -1.0, 1.0])
    array([ 0. ,  2.5, -0.5,  2.5])

    Parameters
    ----------
    limit: Twist L at which everything slips [rad], in (0, inf); required
    weight: Torque w_ij that each cell carries [N.m], in [0, inf); required

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    Mayergoyz1986; Everett integrals of uniform cells: own derivation
    """

    def __init__(self, *, limit: float, weight: float | Sequence[float]) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, limit: float = ..., weight: float | Sequence[float] = ...) -> GridDensity:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def limit(self) -> float:
        """Twist L at which everything slips [rad]"""

    @property
    def weight(self) -> tuple[float, ...]:
        """Torque w_ij that each cell carries [N.m]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'grid_density'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

class MaxwellSlip:
    """
    Parallel springs that each slip at their own torque: hysteresis with non-local memory.

    .. math:: T = \\sum_i T_i, \\quad T_i \\leftarrow \\operatorname{clip}(T_i + k_i \\Delta\\delta, \\pm F_i)

    with delta the twist, k_i = stiffness, F_i = breakaway, up to 16 elements; none at all is no hysteresis. The clip is
    exact for any step over which the twist is monotone, whatever its size. Rate-independent; obeys Masing's rules,
    wiping-out and congruency; symmetric.

    The rule printed in review articles, a capture position frozen where the element last stuck, lets the torque jump at a
    reversal (E-R11).

    >>> from strainwave.hysteresis import MaxwellSlip
    >>> gear = MaxwellSlip(stiffness=[1000, 600, 300, 100], breakaway=[0.5, 0.9, 0.9, 0.6])
    >>> gear.trace([0.0, 0.004, -0.002]).round(12)
    array([ 0. ,  2.7, -2.5])

    Parameters
    ----------
    stiffness: Stiffness k_i of each element while it sticks [N.m/rad], in (0, inf); default ()
    breakaway: Torque F_i at which each element slips [N.m], in [0, inf); default ()

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    Iwan1966; LampaertAlBenderSwevers2003, eq. (9); document R, section 4b; erratum E-R11
    """

    def __init__(self, *, stiffness: float | Sequence[float] = ..., breakaway: float | Sequence[float] = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, stiffness: float | Sequence[float] = ..., breakaway: float | Sequence[float] = ...) -> MaxwellSlip:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def stiffness(self) -> tuple[float, ...]:
        """Stiffness k_i of each element while it sticks [N.m/rad]"""

    @property
    def breakaway(self) -> tuple[float, ...]:
        """Torque F_i at which each element slips [N.m]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'maxwell_slip'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    class State:
        """
        Parameters
        ----------
        torque: Torque T_i held by each element [N.m]; default (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

        Raises
        ------
        TypeError: an unknown parameter, one of the wrong kind, or none where it is required
        ValueError: a number that is not finite or out of its range
        """

        def __init__(self, *, torque: Sequence[float] = ...) -> None: ...

        def replace(self, changes: dict[str, Any] = ..., /, *, torque: Sequence[float] = ...) -> MaxwellSlip.State:
            """
            The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
            """

        @property
        def torque(self) -> tuple[float, ...]:
            """Torque T_i held by each element [N.m]"""

        def __repr__(self) -> str: ...

        def __eq__(self, other: object, /) -> bool: ...

        def __hash__(self) -> int: ...

        def __getstate__(self) -> dict[str, object]: ...

        def __setstate__(self, state: dict[str, object], /) -> None: ...

        def __reduce__(self) -> tuple[Any, ...]: ...

        name: str = 'maxwell_slip.state'

        fields: tuple[dict[str, Any], ...]

    def trace(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64], state: State = ...) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), along a path of `twist` [rad], shape (n,), monotone between its points.

        The history starts with `state`, which stands at the first point; without it the model is virgin.
        """

    def work(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64], state: State = ...) -> numpy.typing.NDArray[numpy.float64]:
        """
        Work [J] put in so far, shape (n,), along a path of `twist` [rad]; exact, as `trace` is.
        """

    def advance(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64], state: State = ...) -> State:
        """The state at the end of a path of `twist` [rad]."""

    def stored(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64], state: State = ...) -> numpy.typing.NDArray[numpy.float64]:
        """
        Elastic energy [J] held, shape (n,), along a path of `twist` [rad]; work less stored is dissipated.
        """

    def inverse(self, spring: float) -> PrandtlIshlinskii:
        """
        What undoes this hysteresis beside a linear `spring` [N.m/rad]: twist over torque, exact, its history included.
        """

    odd: bool = True

    return_point_memory: bool = True

    congruent: bool = True

    masing: bool = True

class FadingMemory:
    """
    Hysteresis that forgets exponentially with the twist travelled.

    .. math:: T = \\sum_j T_j, \\quad dT_j = A_j\\, d\\delta - \\alpha_j T_j |d\\delta|

    with delta the twist, A_j = stiffness, alpha_j = forgetting, up to 8 parallel branches; none at all is no hysteresis.
    The branches sum up to the memory kernel Phi(u) = sum A_j exp(-alpha_j u) of the twist travelled u. Exact over any
    monotone step: with s the sense of motion, T_j approaches s A_j / alpha_j as exp(-alpha_j |Delta delta|). The elastic
    energy is sum T_j^2 / (2 A_j); alpha_j T_j^2 / A_j is lost per twist travelled, in either sense.

    Rate-independent: document R calls it rate-dependent (E-R10). One branch is Dahl's model of order 1, and BoucWen with
    sharpness 1 and shape 1. Its minor loops do not close, unlike those of a gear: prefer MaxwellSlip where small reversals
    matter.

    >>> from strainwave.hysteresis import FadingMemory
    >>> FadingMemory(stiffness=1000.0, forgetting=2000.0).trace([0.0, 0.002, -0.001]).round(6)
    array([ 0.      ,  0.490842, -0.497544])

    Parameters
    ----------
    stiffness: Stiffness A_j of each branch right after a reversal from zero torque [N.m/rad], in (0, inf); default ()
    forgetting: Rate alpha_j at which each branch forgets the twist travelled [1/rad], in (0, inf); default ()

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    document R, section 4a; Dahl1968 (order 1); erratum E-R10
    """

    def __init__(self, *, stiffness: float | Sequence[float] = ..., forgetting: float | Sequence[float] = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, stiffness: float | Sequence[float] = ..., forgetting: float | Sequence[float] = ...) -> FadingMemory:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def stiffness(self) -> tuple[float, ...]:
        """
        Stiffness A_j of each branch right after a reversal from zero torque [N.m/rad]
        """

    @property
    def forgetting(self) -> tuple[float, ...]:
        """Rate alpha_j at which each branch forgets the twist travelled [1/rad]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'fading_memory'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    class State:
        """
        Parameters
        ----------
        held: Torque T_j held by each branch [N.m]; default (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

        Raises
        ------
        TypeError: an unknown parameter, one of the wrong kind, or none where it is required
        ValueError: a number that is not finite or out of its range
        """

        def __init__(self, *, held: Sequence[float] = ...) -> None: ...

        def replace(self, changes: dict[str, Any] = ..., /, *, held: Sequence[float] = ...) -> FadingMemory.State:
            """
            The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
            """

        @property
        def held(self) -> tuple[float, ...]:
            """Torque T_j held by each branch [N.m]"""

        def __repr__(self) -> str: ...

        def __eq__(self, other: object, /) -> bool: ...

        def __hash__(self) -> int: ...

        def __getstate__(self) -> dict[str, object]: ...

        def __setstate__(self, state: dict[str, object], /) -> None: ...

        def __reduce__(self) -> tuple[Any, ...]: ...

        name: str = 'fading_memory.state'

        fields: tuple[dict[str, Any], ...]

    def trace(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64], state: State = ...) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), along a path of `twist` [rad], shape (n,), monotone between its points.

        The history starts with `state`, which stands at the first point; without it the model is virgin.
        """

    def work(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64], state: State = ...) -> numpy.typing.NDArray[numpy.float64]:
        """
        Work [J] put in so far, shape (n,), along a path of `twist` [rad]; exact, as `trace` is.
        """

    def advance(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64], state: State = ...) -> State:
        """The state at the end of a path of `twist` [rad]."""

    def stored(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64], state: State = ...) -> numpy.typing.NDArray[numpy.float64]:
        """
        Elastic energy [J] held, shape (n,), along a path of `twist` [rad]; work less stored is dissipated.
        """

    odd: bool = True

    return_point_memory: bool = False

    congruent: bool = False

    masing: bool = False

class BoucWen:
    """
    Bouc and Wen's hysteresis: a torque that bends smoothly towards its saturation.

    .. math:: dT = A\\, d\\delta - \\beta\\, |d\\delta|\\, |T|^{n-1} T - \\gamma\\, d\\delta\\, |T|^n, \\qquad
              \\beta = \\sigma A / T_s^n, \\quad \\gamma = (1 - \\sigma) A / T_s^n

    with delta the twist, A = stiffness, T_s = saturation, n = sharpness, sigma = shape; that is
    T_s = (A / (beta + gamma))^(1/n) and sigma = beta / (beta + gamma), in units that do not depend on n. Exact over any
    monotone step: solved by its integrals. The elastic energy is T^2 / (2 A); what is lost grows along every path, because
    gamma lies in [0, beta]. From saturation it unloads with the slope 2 sigma A at first: shape 1/2 unloads straight, shape
    1 twice as steeply.

    Sharpness 1 with shape 1 is FadingMemory, a large sharpness one element of MaxwellSlip. Rate-independent. Minor loops do
    not close. Leaves out -beta < gamma < 0, which is passive as well.

    >>> from strainwave.hysteresis import BoucWen
    >>> BoucWen(stiffness=1000.0, saturation=0.5, sharpness=2.0, shape=0.5).trace([0.0, 0.0005, -0.0005]).round(6)
    array([ 0.      ,  0.380797, -0.4225  ])

    Parameters
    ----------
    stiffness: Stiffness A at zero torque [N.m/rad], in (0, inf); required
    saturation: Torque T_s approached by a long motion [N.m], in (0, inf); required
    sharpness: Exponent n: how sharply the torque bends towards its saturation, in [1, inf); default 2.0
    shape: Share sigma = beta / (beta + gamma): 1/2 unloads straight, 1 most curved, in [0.5, 1]; default 0.5

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    Bouc1967; Wen1976; passivity: ErlicherPoint2004; IkhouaneRodellar2007
    """

    def __init__(self, *, stiffness: float, saturation: float, sharpness: float = ..., shape: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, stiffness: float = ..., saturation: float = ..., sharpness: float = ..., shape: float = ...) -> BoucWen:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def stiffness(self) -> float:
        """Stiffness A at zero torque [N.m/rad]"""

    @property
    def saturation(self) -> float:
        """Torque T_s approached by a long motion [N.m]"""

    @property
    def sharpness(self) -> float:
        """Exponent n: how sharply the torque bends towards its saturation"""

    @property
    def shape(self) -> float:
        """
        Share sigma = beta / (beta + gamma): 1/2 unloads straight, 1 most curved
        """

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'bouc_wen'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    class State:
        """
        Parameters
        ----------
        held: Torque T held [N.m]; default 0.0

        Raises
        ------
        TypeError: an unknown parameter, one of the wrong kind, or none where it is required
        ValueError: a number that is not finite or out of its range
        """

        def __init__(self, *, held: float = ...) -> None: ...

        def replace(self, changes: dict[str, Any] = ..., /, *, held: float = ...) -> BoucWen.State:
            """
            The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
            """

        @property
        def held(self) -> float:
            """Torque T held [N.m]"""

        def __repr__(self) -> str: ...

        def __eq__(self, other: object, /) -> bool: ...

        def __hash__(self) -> int: ...

        def __getstate__(self) -> dict[str, object]: ...

        def __setstate__(self, state: dict[str, object], /) -> None: ...

        def __reduce__(self) -> tuple[Any, ...]: ...

        name: str = 'bouc_wen.state'

        fields: tuple[dict[str, Any], ...]

    def trace(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64], state: State = ...) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), along a path of `twist` [rad], shape (n,), monotone between its points.

        The history starts with `state`, which stands at the first point; without it the model is virgin.
        """

    def work(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64], state: State = ...) -> numpy.typing.NDArray[numpy.float64]:
        """
        Work [J] put in so far, shape (n,), along a path of `twist` [rad]; exact, as `trace` is.
        """

    def advance(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64], state: State = ...) -> State:
        """The state at the end of a path of `twist` [rad]."""

    def stored(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64], state: State = ...) -> numpy.typing.NDArray[numpy.float64]:
        """
        Elastic energy [J] held, shape (n,), along a path of `twist` [rad]; work less stored is dissipated.
        """

    odd: bool = True

    return_point_memory: bool = False

    congruent: bool = False

    masing: bool = False

class Preisach:
    """
    Hysteresis by turning points: any law, symmetric or not, whose minor loops close and are equal between equal twists.

    .. math:: \\Delta T = \\pm 2 E(a, b), \\quad \\mu(a, b) = \\frac{\\partial^2 E}{\\partial a \\, \\partial b} \\ge 0

    with E the Everett function of the density mu, and b <= a the ends of the branch: the last turning point that is
    remembered, and the twist. Passing a turning point wipes it out, together with its partner. Exact for any step over
    which the twist is monotone. Rate-independent; obeys wiping-out and congruency, Masing's rules where E depends on a - b
    alone. Virgin is demagnetised: as after ever smaller oscillation around the twist it starts from.

    mu is the density of hysterons over the ends of their windows [b, a]: each pushes forward once its window is entered from
    below, back once it is entered from above; what else E holds is a spring. A loop loses twice the width of every window
    within it. Preisach's own relays switch late, on leaving their window: right for a magnet, whose field is the input. As
    torque of a twist they would give out with every loop what these take in; this law is an elastic curve less Preisach's
    operator of the same density.

    Sixteen maxima and minima are kept. A twist that turns back more often, ever more closely, moves along the innermost
    branch without loss.

    Uniform density, from negative saturation; the elastic line, here 2 N.m/rad, less the torque is what Preisach's relays give:

    >>> import numpy as np
    >>> from strainwave.hysteresis import PowerDensity, Preisach
    >>> gear = Preisach(density=PowerDensity(limit=1.0, saturation=1.0, exponent=2.0))
    >>> path = np.array([0.0, -1.0, 0.5, -0.2, 0.3, 0.5, 0.8])
    >>> (2.0 * path - gear.trace(path)).round(12)
    array([ 0.   , -1.   ,  0.125, -0.12 ,  0.005,  0.125,  0.62 ])

    Parameters
    ----------
    density: Density of hysterons over the ends of their windows; default PowerDensity(limit=0.001, saturation=0.0, exponent=2.0)

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    Preisach1935; Everett1955; Mayergoyz1986 (what wiping-out and congruency imply)
    """

    def __init__(self, *, density: PowerDensity | GridDensity = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, density: PowerDensity | GridDensity = ...) -> Preisach:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def density(self) -> PowerDensity | GridDensity:
        """Density of hysterons over the ends of their windows"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'preisach'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    class State:
        """
        Parameters
        ----------
        maximum: Maxima remembered, outermost first, the twist in place of those not there [rad]; default (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        minimum: Minima remembered, each after the maximum of its place [rad]; default (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        twist: Twist, from where the gear was virgin [rad]; default 0.0

        Raises
        ------
        TypeError: an unknown parameter, one of the wrong kind, or none where it is required
        ValueError: a number that is not finite or out of its range
        """

        def __init__(self, *, maximum: Sequence[float] = ..., minimum: Sequence[float] = ..., twist: float = ...) -> None: ...

        def replace(self, changes: dict[str, Any] = ..., /, *, maximum: Sequence[float] = ..., minimum: Sequence[float] = ..., twist: float = ...) -> Preisach.State:
            """
            The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
            """

        @property
        def maximum(self) -> tuple[float, ...]:
            """
            Maxima remembered, outermost first, the twist in place of those not there [rad]
            """

        @property
        def minimum(self) -> tuple[float, ...]:
            """Minima remembered, each after the maximum of its place [rad]"""

        @property
        def twist(self) -> float:
            """Twist, from where the gear was virgin [rad]"""

        def __repr__(self) -> str: ...

        def __eq__(self, other: object, /) -> bool: ...

        def __hash__(self) -> int: ...

        def __getstate__(self) -> dict[str, object]: ...

        def __setstate__(self, state: dict[str, object], /) -> None: ...

        def __reduce__(self) -> tuple[Any, ...]: ...

        name: str = 'preisach.state'

        fields: tuple[dict[str, Any], ...]

    def trace(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64], state: State = ...) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), along a path of `twist` [rad], shape (n,), monotone between its points.

        The history starts with `state`, which stands at the first point; without it the model is virgin.
        """

    def work(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64], state: State = ...) -> numpy.typing.NDArray[numpy.float64]:
        """
        Work [J] put in so far, shape (n,), along a path of `twist` [rad]; exact, as `trace` is.
        """

    def advance(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64], state: State = ...) -> State:
        """The state at the end of a path of `twist` [rad]."""

    odd: bool = False

    return_point_memory: bool = True

    congruent: bool = True

    masing: bool = False

class Regimes:
    """
    A spring with memory that has a stiffness for each of the four regimes of a torsion test.

    .. math:: \\delta = \\varepsilon + s, \\quad T = K \\varepsilon, \\quad -w/2 \\le s \\le w/2, \\qquad
              T = T_0 + H_+ (s + w/2) \\; (ds > 0), \\quad T = -T_0 - H_- (w/2 - s) \\; (ds < 0)

    with delta the twist, epsilon its elastic and s its plastic share, K = positive_unloading for T > 0 and
    negative_unloading for T < 0, T_0 = onset, w = lost_motion, H = K K_l / (K - K_l), so that the slope is K_l =
    positive_loading or negative_loading while s moves. At its stops s = +-w/2 only the elastic share moves. The closed loop
    is w wide at zero torque, its widest; all that s takes up is lost. Exact over any monotone step; minor loops close, no
    cycle creeps. Virgin is s = 0.

    The table's stiffnesses read as secants from 0 to +-0.36 N.m do not close (E-T4); they do as slopes between the stops, of
    a loop 50.5 degrees wide. They hold at the input, where they were measured, and are
    those of the example. In a gear the law acts on the output: behind a ratio N, torques grow by N, twists shrink by N.

    It is a whole spring: in a gear, the ``stiffness`` acts in parallel, and is what is stiff beside it (Linear with a
    negligible stiffness if nothing is).

    >>> from strainwave.hysteresis import Regimes
    >>> law = Regimes(positive_unloading=4.51, negative_loading=0.31, negative_unloading=4.85, positive_loading=0.30,
    ...               onset=0.03, lost_motion=0.8813912722571364)
    >>> law.trace([0.0, 0.6, 0.5, -0.6, 0.6]).round(6)
    array([ 0.      ,  0.718463,  0.267463, -0.772626,  0.718463])

    Parameters
    ----------
    positive_unloading: Stiffness while a positive torque falls, and beyond the stop [N.m/rad], in (0, inf); required
    negative_loading: Stiffness while a negative torque builds up [N.m/rad], in [0, inf); required
    negative_unloading: Stiffness while a negative torque falls, and beyond the stop [N.m/rad], in (0, inf); required
    positive_loading: Stiffness while a positive torque builds up [N.m/rad], in [0, inf); required
    onset: Torque T_0 at which the soft regimes set in [N.m], in [0, inf); required
    lost_motion: Plastic twist w between the stops: width of the loop at zero torque [rad], in [0, inf); required

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    document T, Table 2, row 0 degrees (at the input); erratum E-T4; generalised play: Visintin1994
    """

    def __init__(self, *, positive_unloading: float, negative_loading: float, negative_unloading: float, positive_loading: float, onset: float, lost_motion: float) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, positive_unloading: float = ..., negative_loading: float = ..., negative_unloading: float = ..., positive_loading: float = ..., onset: float = ..., lost_motion: float = ...) -> Regimes:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def positive_unloading(self) -> float:
        """Stiffness while a positive torque falls, and beyond the stop [N.m/rad]"""

    @property
    def negative_loading(self) -> float:
        """Stiffness while a negative torque builds up [N.m/rad]"""

    @property
    def negative_unloading(self) -> float:
        """Stiffness while a negative torque falls, and beyond the stop [N.m/rad]"""

    @property
    def positive_loading(self) -> float:
        """Stiffness while a positive torque builds up [N.m/rad]"""

    @property
    def onset(self) -> float:
        """Torque T_0 at which the soft regimes set in [N.m]"""

    @property
    def lost_motion(self) -> float:
        """
        Plastic twist w between the stops: width of the loop at zero torque [rad]
        """

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'regimes'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    class State:
        """
        Parameters
        ----------
        twist: Twist since the spring was virgin [rad]; default 0.0
        plastic: Plastic share s of the twist [rad]; default 0.0

        Raises
        ------
        TypeError: an unknown parameter, one of the wrong kind, or none where it is required
        ValueError: a number that is not finite or out of its range
        """

        def __init__(self, *, twist: float = ..., plastic: float = ...) -> None: ...

        def replace(self, changes: dict[str, Any] = ..., /, *, twist: float = ..., plastic: float = ...) -> Regimes.State:
            """
            The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
            """

        @property
        def twist(self) -> float:
            """Twist since the spring was virgin [rad]"""

        @property
        def plastic(self) -> float:
            """Plastic share s of the twist [rad]"""

        def __repr__(self) -> str: ...

        def __eq__(self, other: object, /) -> bool: ...

        def __hash__(self) -> int: ...

        def __getstate__(self) -> dict[str, object]: ...

        def __setstate__(self, state: dict[str, object], /) -> None: ...

        def __reduce__(self) -> tuple[Any, ...]: ...

        name: str = 'regimes.state'

        fields: tuple[dict[str, Any], ...]

    def trace(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64], state: State = ...) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), along a path of `twist` [rad], shape (n,), monotone between its points.

        The history starts with `state`, which stands at the first point; without it the model is virgin.
        """

    def work(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64], state: State = ...) -> numpy.typing.NDArray[numpy.float64]:
        """
        Work [J] put in so far, shape (n,), along a path of `twist` [rad]; exact, as `trace` is.
        """

    def advance(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64], state: State = ...) -> State:
        """The state at the end of a path of `twist` [rad]."""

    def stored(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64], state: State = ...) -> numpy.typing.NDArray[numpy.float64]:
        """
        Elastic energy [J] held, shape (n,), along a path of `twist` [rad]; work less stored is dissipated.
        """

    odd: bool = False

    return_point_memory: bool = True

    congruent: bool = False

    masing: bool = False

class FrictionalWindup:
    """
    Flexspline and wave generator in series, with dry friction that holds the wind-up of the wave generator.

    .. math:: \\delta = \\delta_f(T) + x(T_w), \\qquad |T - T_w| \\le F, \\qquad T = T_w + F \\; (dx > 0), \\quad
              T = T_w - F \\; (dx < 0)

    with delta the twist, delta_f and x the shares that flexspline and wave generator have in it, each a spring of
    MultiCompliance = springs, T the torque, T_w that of the wave generator's spring, F = friction, all at the output. While
    the wave generator sticks, the gear is as stiff as its flexspline; once it slips, as both in series. A cycle loses the
    integral of F |dx|, which is 4 F x(T_m - F) between +-T_m; without torque the twist x(F) is left. Exact over any
    monotone step; minor loops close. It begins without twist and torque.

    Document R has the friction at the input's scale, or divides it by N (E-R13), and lets it follow the speed of the input:
    then a torsion test, whose input is held, would show no hysteresis (E-R14).

    It is a whole spring: in a gear, the ``stiffness`` acts in parallel, and is what is stiff beside it (Linear with a
    negligible stiffness if nothing is). A gear refuses springs whose reduction is not its ratio. Where both springs harden,
    there is no torque beyond a twist (E-R16); the law is valid as far as MultiCompliance is, and keeps its greatest torque
    from there on.

    >>> from strainwave.hysteresis import FrictionalWindup
    >>> from strainwave.stiffness import MultiCompliance
    >>> springs = MultiCompliance(flexspline_stiffness=8000.0, flexspline_hardening=0.02, wave_generator_stiffness=2.0,
    ...                           wave_generator_hardening=1.5, reduction=100.0)
    >>> law = FrictionalWindup(springs=springs, friction=5.0)
    >>> law.trace([0.0, 0.003, 0.002, -0.003, 0.003]).round(6)
    array([  0.      ,  19.663744,  10.902808, -19.663744,  19.663744])

    Parameters
    ----------
    springs: Flexspline and wave generator; default MultiCompliance(flexspline_stiffness=8000.0, flexspline_hardening=0.02, wave_generator_stiffness=2.0, wave_generator_hardening=1.5, reduction=100.0)
    friction: Friction F against the wind-up, at the output's scale [N.m], in [0, inf); required

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    document R, section 4c, with T_fr; errata E-R13, E-R14; play: Visintin1994
    """

    def __init__(self, *, springs: strainwave.stiffness.MultiCompliance = ..., friction: float) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, springs: strainwave.stiffness.MultiCompliance = ..., friction: float = ...) -> FrictionalWindup:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def springs(self) -> strainwave.stiffness.MultiCompliance:
        """Flexspline and wave generator"""

    @property
    def friction(self) -> float:
        """Friction F against the wind-up, at the output's scale [N.m]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'frictional_windup'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    class State:
        """
        Parameters
        ----------
        twist: Twist since the springs were virgin [rad]; default 0.0
        torque: Torque T [N.m]; default 0.0
        windup_torque: Torque T_w of the wave generator's spring, at the output [N.m]; default 0.0

        Raises
        ------
        TypeError: an unknown parameter, one of the wrong kind, or none where it is required
        ValueError: a number that is not finite or out of its range
        """

        def __init__(self, *, twist: float = ..., torque: float = ..., windup_torque: float = ...) -> None: ...

        def replace(self, changes: dict[str, Any] = ..., /, *, twist: float = ..., torque: float = ..., windup_torque: float = ...) -> FrictionalWindup.State:
            """
            The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
            """

        @property
        def twist(self) -> float:
            """Twist since the springs were virgin [rad]"""

        @property
        def torque(self) -> float:
            """Torque T [N.m]"""

        @property
        def windup_torque(self) -> float:
            """Torque T_w of the wave generator's spring, at the output [N.m]"""

        def __repr__(self) -> str: ...

        def __eq__(self, other: object, /) -> bool: ...

        def __hash__(self) -> int: ...

        def __getstate__(self) -> dict[str, object]: ...

        def __setstate__(self, state: dict[str, object], /) -> None: ...

        def __reduce__(self) -> tuple[Any, ...]: ...

        name: str = 'frictional_windup.state'

        fields: tuple[dict[str, Any], ...]

    def trace(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64], state: State = ...) -> numpy.typing.NDArray[numpy.float64]:
        """
        Torque [N.m], shape (n,), along a path of `twist` [rad], shape (n,), monotone between its points.

        The history starts with `state`, which stands at the first point; without it the model is virgin.
        """

    def work(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64], state: State = ...) -> numpy.typing.NDArray[numpy.float64]:
        """
        Work [J] put in so far, shape (n,), along a path of `twist` [rad]; exact, as `trace` is.
        """

    def advance(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64], state: State = ...) -> State:
        """The state at the end of a path of `twist` [rad]."""

    def stored(self, twist: Sequence[float] | numpy.typing.NDArray[numpy.float64], state: State = ...) -> numpy.typing.NDArray[numpy.float64]:
        """
        Elastic energy [J] held, shape (n,), along a path of `twist` [rad]; work less stored is dissipated.
        """

    odd: bool = True

    return_point_memory: bool = True

    congruent: bool = False

    masing: bool = False
