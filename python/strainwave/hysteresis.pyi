"""Torque that depends on the history of the twist."""

from collections.abc import Sequence
from typing import Any

import numpy
import numpy.typing


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
    TypeError: an unknown parameter, or one of the wrong kind
    ValueError: a number that is not finite or out of its range

    Source
    ------
    Iwan1966; LampaertAlBenderSwevers2003, eq. (9); document R, section 4b; erratum E-R11
    """

    def __init__(self, *, stiffness: Sequence[float] = ..., breakaway: Sequence[float] = ...) -> None: ...

    def replace(self, *, stiffness: Sequence[float] = ..., breakaway: Sequence[float] = ...) -> MaxwellSlip:
        """The same with the named parameters changed."""

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
        TypeError: an unknown parameter, or one of the wrong kind
        ValueError: a number that is not finite or out of its range
        """

        def __init__(self, *, torque: Sequence[float] = ...) -> None: ...

        def replace(self, *, torque: Sequence[float] = ...) -> MaxwellSlip.State:
            """The same with the named parameters changed."""

        @property
        def torque(self) -> tuple[float, ...]:
            """Torque T_i held by each element [N.m]"""

        def __repr__(self) -> str: ...

        def __eq__(self, other: object, /) -> bool: ...

        def __hash__(self) -> int: ...

        def __getstate__(self) -> dict[str, object]: ...

        def __setstate__(self, state: dict[str, object], /) -> None: ...

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

class FadingMemory:
    """
    Hysteresis that forgets exponentially with the twist travelled.

    .. math:: dT = A\\, d\\delta - \\alpha T |d\\delta|

    with delta the twist, A = stiffness, alpha = forgetting. Exact over any monotone step: with s the sense of motion,
    T approaches s A / alpha as exp(-alpha |Delta delta|). Rate-independent: document R calls it rate-dependent (E-R10).
    Identical with Dahl's model of order 1. Its minor loops do not close, unlike those of a gear: prefer MaxwellSlip where
    small reversals matter.

    >>> from strainwave.hysteresis import FadingMemory
    >>> FadingMemory(stiffness=1000.0, forgetting=2000.0).trace([0.0, 0.002, -0.001]).round(6)
    array([ 0.      ,  0.490842, -0.497544])

    Parameters
    ----------
    stiffness: Stiffness A right after a reversal from zero torque [N.m/rad], in [0, inf); default 0.0
    forgetting: Rate alpha at which the twist travelled is forgotten [1/rad], in (0, inf); default 1000.0

    Raises
    ------
    TypeError: an unknown parameter, or one of the wrong kind
    ValueError: a number that is not finite or out of its range

    Source
    ------
    document R, section 4a; Dahl1968 (order 1); erratum E-R10
    """

    def __init__(self, *, stiffness: float = ..., forgetting: float = ...) -> None: ...

    def replace(self, *, stiffness: float = ..., forgetting: float = ...) -> FadingMemory:
        """The same with the named parameters changed."""

    @property
    def stiffness(self) -> float:
        """Stiffness A right after a reversal from zero torque [N.m/rad]"""

    @property
    def forgetting(self) -> float:
        """Rate alpha at which the twist travelled is forgotten [1/rad]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    name: str = 'fading_memory'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    class State:
        """
        Parameters
        ----------
        held: Torque T held [N.m]; default 0.0

        Raises
        ------
        TypeError: an unknown parameter, or one of the wrong kind
        ValueError: a number that is not finite or out of its range
        """

        def __init__(self, *, held: float = ...) -> None: ...

        def replace(self, *, held: float = ...) -> FadingMemory.State:
            """The same with the named parameters changed."""

        @property
        def held(self) -> float:
            """Torque T held [N.m]"""

        def __repr__(self) -> str: ...

        def __eq__(self, other: object, /) -> bool: ...

        def __hash__(self) -> int: ...

        def __getstate__(self) -> dict[str, object]: ...

        def __setstate__(self, state: dict[str, object], /) -> None: ...

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
