"""How a stiffness varies as the wave generator turns."""

from collections.abc import Sequence
from typing import Any, overload

import numpy
import numpy.typing


class Constant:
    """
    A stiffness that does not change with the angle.

    .. math:: k(\\theta) = k_0

    >>> from strainwave.variation import Constant
    >>> Constant()
    Constant()

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
    def factor(self, angle: float) -> float: ...

    @overload
    def factor(self, angle: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """
        What the stiffness is multiplied by [1] at an `angle` [rad] of the wave generator.
        """

    @property
    def active(self) -> bool:
        """Whether it makes any difference."""

class Periodic:
    """
    A stiffness that changes as the wave generator turns: more or fewer teeth carry, the ball bearing rolls under the load.

    .. math:: k(\\theta) = k_0 \\left(1 + \\sum_h a_h \\sin(B_h \\theta + \\varphi_h)\\right)

    with k_0 the stiffness that its law gives, theta the angle of the wave generator, a_h = amplitude, B_h = order, phi_h =
    phase, up to 8 harmonics. Two lobes make order 2. A spring that holds the energy V(x, theta), x its deformation, turns
    the wave generator with the torque -dV/dtheta. Without this torque energy would come from nowhere. With it, a stiffness
    that varies shows in the motor current even where the output stands still. The amplitudes must add up to less than 1, so
    that the stiffness stays positive.

    >>> from strainwave.variation import Periodic
    >>> Periodic(order=[2], amplitude=[0.05], phase=[0.0]).amplitude
    (0.05,)

    Parameters
    ----------
    order: Order B_h: periods per turn of the wave generator, in [0, inf); default ()
    amplitude: Amplitude a_h, relative to the mean stiffness, in [0, 1]; default ()
    phase: Phase phi_h [rad]; default ()

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    document R, which names the stiffness of the mesh among what varies with time; the form, and the reaction on the wave generator, follow from the energy of the spring
    """

    def __init__(self, *, order: float | Sequence[float] = ..., amplitude: float | Sequence[float] = ..., phase: float | Sequence[float] = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, order: float | Sequence[float] = ..., amplitude: float | Sequence[float] = ..., phase: float | Sequence[float] = ...) -> Periodic:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def order(self) -> tuple[float, ...]:
        """Order B_h: periods per turn of the wave generator"""

    @property
    def amplitude(self) -> tuple[float, ...]:
        """Amplitude a_h, relative to the mean stiffness"""

    @property
    def phase(self) -> tuple[float, ...]:
        """Phase phi_h [rad]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'periodic'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    @overload
    def factor(self, angle: float) -> float: ...

    @overload
    def factor(self, angle: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """
        What the stiffness is multiplied by [1] at an `angle` [rad] of the wave generator.
        """

    @property
    def active(self) -> bool:
        """Whether it makes any difference."""
