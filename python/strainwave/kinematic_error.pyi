"""Pure kinematic error at the output, over the input angle."""

from collections.abc import Sequence
from typing import Any, overload

import numpy
import numpy.typing


class Fourier:
    """
    Kinematic error as a sum of harmonics of the wave generator's rotation.

    .. math:: e(\\theta) = \\sum_h A_h \\sin(B_h \\theta + \\varphi_h)

    with theta the input angle, A_h = amplitude at the output, B_h = order, phi_h = phase; up to 16 harmonics, none at all is
    a perfect gear. Orders need not be whole: 2 z_c / z_f occurs. Independent of load and speed.

    >>> from strainwave.kinematic_error import Fourier
    >>> Fourier(order=[2], amplitude=[3e-4], phase=[0.0]).slope(0.0)
    0.0006

    Parameters
    ----------
    order: Order B_h: periods per input revolution, in [0, inf); default ()
    amplitude: Amplitude A_h at the output [rad], in [0, inf); default ()
    phase: Phase phi_h [rad]; default ()

    Raises
    ------
    TypeError: an unknown parameter, or one of the wrong kind
    ValueError: a number that is not finite or out of its range

    Source
    ------
    document R, eq. (1a); sign convention: theta_error = theta_in / i - theta_out
    """

    def __init__(self, *, order: Sequence[float] = ..., amplitude: Sequence[float] = ..., phase: Sequence[float] = ...) -> None: ...

    def replace(self, *, order: Sequence[float] = ..., amplitude: Sequence[float] = ..., phase: Sequence[float] = ...) -> Fourier:
        """The same with the named parameters changed."""

    @property
    def order(self) -> tuple[float, ...]:
        """Order B_h: periods per input revolution"""

    @property
    def amplitude(self) -> tuple[float, ...]:
        """Amplitude A_h at the output [rad]"""

    @property
    def phase(self) -> tuple[float, ...]:
        """Phase phi_h [rad]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    name: str = 'fourier'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    @overload
    def error(self, angle: float) -> float: ...

    @overload
    def error(self, angle: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """Kinematic error [rad] at input `angle` [rad]."""

    @overload
    def slope(self, angle: float) -> float: ...

    @overload
    def slope(self, angle: Sequence[float] | numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]:
        """Its derivative [rad/rad] by the input angle."""
