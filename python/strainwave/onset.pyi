"""Onsets of faults: the share of the severity after some use of a drive."""

from collections.abc import Sequence
from typing import Any, overload

import numpy
import numpy.typing


class Constant:
    """
    A fault that is there from the beginning.

    .. math:: g(u) = 1

    >>> from strainwave.onset import Constant
    >>> Constant().share(0.0)
    1.0

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

    def replace(self, changes: dict[str, Any] = ..., /) -> Constant:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'constant'

    source: str = 'definition'

    fields: tuple[dict[str, Any], ...]

    @overload
    def share(self, usage: float) -> float: ...

    @overload
    def share(self, usage: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """
        Return the share [1], in [0, 1], of its severity that a fault has after a `usage`, of the shape of `usage`.
        """

class Step:
    """
    A fault that is there at once, from some use on.

    .. math:: g(u) = 0 \\text{ for } u < u_0, \\qquad g(u) = 1 \\text{ for } u \\ge u_0

    with u the use of the drive, u_0 = at, both counted in ``unit``.

    >>> from strainwave.onset import Step
    >>> Step(at=1000.0).share([999.0, 1000.0])
    array([0., 1.])

    Parameters
    ----------
    at: Use u_0 at which the fault is there, in [0, inf); required
    unit: Unit of usage, one of ('output_revolutions', 'load_cycles'); default 'output_revolutions'

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition
    """

    def __init__(self, *, at: float, unit: str = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, at: float = ..., unit: str = ...) -> Step:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def at(self) -> float:
        """Use u_0 at which the fault is there"""

    @property
    def unit(self) -> str:
        """Unit of usage"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'step'

    source: str = 'definition'

    fields: tuple[dict[str, Any], ...]

    @overload
    def share(self, usage: float) -> float: ...

    @overload
    def share(self, usage: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """
        Return the share [1], in [0, 1], of its severity that a fault has after a `usage`, of the shape of `usage`.
        """

class Growing:
    """
    A fault that grows as a power of the use of the drive.

    .. math:: g(u) = \\min\\left(1, \\left(\\frac{\\max(u - u_0, 0)}{u_1}\\right)^p\\right)

    with u the use of the drive, u_0 = begin, u_1 = scale, all counted in ``unit``, p = exponent: 1 is wear in proportion to
    the use, more than 1 grows faster and faster, as cracks do, less than 1 is running in. The fault has its severity at
    u_0 + u_1, and keeps it.

    >>> from strainwave.onset import Growing
    >>> Growing(begin=100.0, scale=100.0, exponent=2.0).share([50.0, 150.0, 300.0])
    array([0.  , 0.25, 1.  ])

    Parameters
    ----------
    begin: Use u_0 at which the fault begins, in [0, inf); default 0.0
    scale: Use u_1 from its beginning to its severity, in (0, inf); required
    exponent: Power p of the growth, in [0.1, 10]; default 1.0
    unit: Unit of usage, one of ('output_revolutions', 'load_cycles'); default 'output_revolutions'

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    assumed: a power of the use since the beginning; the exponent is the user's
    """

    def __init__(self, *, begin: float = ..., scale: float, exponent: float = ..., unit: str = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, begin: float = ..., scale: float = ..., exponent: float = ..., unit: str = ...) -> Growing:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def begin(self) -> float:
        """Use u_0 at which the fault begins"""

    @property
    def scale(self) -> float:
        """Use u_1 from its beginning to its severity"""

    @property
    def exponent(self) -> float:
        """Power p of the growth"""

    @property
    def unit(self) -> str:
        """Unit of usage"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'growing'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    @overload
    def share(self, usage: float) -> float: ...

    @overload
    def share(self, usage: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """
        Return the share [1], in [0, 1], of its severity that a fault has after a `usage`, of the shape of `usage`.
        """
