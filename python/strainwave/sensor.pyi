"""What a controller sees a quantity by."""

from typing import Any


class Ideal:
    """
    A sensor that shows what there is.

    .. math:: y = x

    >>> from strainwave.sensor import Ideal
    >>> Ideal()
    Ideal()

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

    def replace(self, changes: dict[str, Any] = ..., /) -> Ideal:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'ideal'

    source: str = 'definition'

    fields: tuple[dict[str, Any], ...]

class FirstOrder:
    """
    A sensor that follows with a lag.

    .. math:: \\tau \\dot y = x - y

    with tau = time_constant. At the start of a run it has settled.

    >>> from strainwave.sensor import FirstOrder
    >>> FirstOrder(time_constant=2e-3).time_constant
    0.002

    Parameters
    ----------
    time_constant: Time constant tau [s], in (0, inf); required

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition; document A takes speed sensors of first order
    """

    def __init__(self, *, time_constant: float) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, time_constant: float = ...) -> FirstOrder:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def time_constant(self) -> float:
        """Time constant tau [s]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'first_order'

    source: str = ...

    fields: tuple[dict[str, Any], ...]
