"""Rigid motion: the signed ratio from the teeth and the fixed member."""

from typing import Any


class StrainWave:
    """
    Ratio of a strain wave gear from its teeth and its fixed member.

    .. math:: i = \\omega_{in} / \\omega_{out} = -z_f / (z_c - z_f) \\text{ (circular spline fixed)}, \\quad
              i = z_c / (z_c - z_f) \\text{ (flexspline fixed)}

    with z_f = flexspline_teeth, z_c = circular_spline_teeth. A fixed circular spline reverses the motion, a fixed
    flexspline does not.

    >>> from strainwave.kinematics import StrainWave
    >>> StrainWave(flexspline_teeth=200, circular_spline_teeth=202, fixed="circular_spline").ratio
    -100.0
    >>> StrainWave(flexspline_teeth=200, circular_spline_teeth=202, fixed="flexspline").ratio
    101.0

    Parameters
    ----------
    flexspline_teeth: Teeth of the flexspline z_f, in [2, 100000]; default 200
    circular_spline_teeth: Teeth of the circular spline z_c, in [3, 100000]; default 202
    fixed: The member that does not turn; the other spline is the output, one of ('circular_spline', 'flexspline'); default 'circular_spline'

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    kinematics of the three members: z_c w_c - z_f w_f = (z_c - z_f) w_w
    """

    def __init__(self, *, flexspline_teeth: int = ..., circular_spline_teeth: int = ..., fixed: str = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, flexspline_teeth: int = ..., circular_spline_teeth: int = ..., fixed: str = ...) -> StrainWave:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def flexspline_teeth(self) -> int:
        """Teeth of the flexspline z_f"""

    @property
    def circular_spline_teeth(self) -> int:
        """Teeth of the circular spline z_c"""

    @property
    def fixed(self) -> str:
        """The member that does not turn; the other spline is the output"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'strain_wave'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    @property
    def ratio(self) -> float:
        """Input angle over output angle, signed."""

class PlainRatio:
    """
    A reducer of which only the reduction is known, output turning with the input.

    .. math:: i = \\omega_{in} / \\omega_{out} = \\text{reduction}

    The degenerate kinematics of texts that ignore the sign (document P); prefer StrainWave.

    >>> from strainwave.kinematics import PlainRatio
    >>> PlainRatio(reduction=100.0).ratio
    100.0

    Parameters
    ----------
    reduction: Input angle per output angle, in (0, inf); default 100.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    document P, eqs. of motion, which leave the sign of the ratio out; erratum E-P1
    """

    def __init__(self, *, reduction: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, reduction: float = ...) -> PlainRatio:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def reduction(self) -> float:
        """Input angle per output angle"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'plain_ratio'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    @property
    def ratio(self) -> float:
        """Input angle over output angle, signed."""
