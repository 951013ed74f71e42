"""Motors on the input shaft."""

from typing import Any


class DC:
    """
    Armature-controlled DC motor.

    .. math:: L \\dot i = u - R i - K_b \\omega, \\qquad \\tau = K_m i

    with u the voltage, omega the input speed, R = resistance, L = inductance, K_m = torque_constant, K_b = back_emf. With
    inductance = 0 the current follows at once, i = (u - K_b omega) / R, as document P assumes. Leaves out cogging, iron
    losses, saturation and the warming of the winding. A motor whose current is controlled by its amplifier
    is a CurrentSource.

    >>> from strainwave.motor import DC
    >>> DC(resistance=2.0, torque_constant=0.05, back_emf=0.05).torque_constant
    0.05

    Parameters
    ----------
    resistance: Armature resistance R [Ohm], in (0, inf); default 1.0
    inductance: Armature inductance L; 0 lets the current follow at once [H], in [0, inf); default 0.0
    torque_constant: Torque per current K_m [N.m/A], in [0, inf); default 0.05
    back_emf: Back-electromotive force per speed K_b [V.s/rad], in [0, inf); default 0.05
    inertia: Rotor inertia [kg.m2], in [0, inf); default 1e-05

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    document P, armature equation u = R i + L di/dt + K_b omega
    """

    def __init__(self, *, resistance: float = ..., inductance: float = ..., torque_constant: float = ..., back_emf: float = ..., inertia: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, resistance: float = ..., inductance: float = ..., torque_constant: float = ..., back_emf: float = ..., inertia: float = ...) -> DC:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def resistance(self) -> float:
        """Armature resistance R [Ohm]"""

    @property
    def inductance(self) -> float:
        """Armature inductance L; 0 lets the current follow at once [H]"""

    @property
    def torque_constant(self) -> float:
        """Torque per current K_m [N.m/A]"""

    @property
    def back_emf(self) -> float:
        """Back-electromotive force per speed K_b [V.s/rad]"""

    @property
    def inertia(self) -> float:
        """Rotor inertia [kg.m2]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'dc'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

class TorqueSource:
    """
    A motor that gives the torque it is asked for, at once and at any speed.

    .. math:: \\tau = u

    with u what the controller asks for [N.m]. For studies of the gear alone, and for drives whose motor is not known.

    >>> from strainwave.motor import TorqueSource
    >>> TorqueSource(inertia=2e-5).inertia
    2e-05

    Parameters
    ----------
    inertia: Rotor inertia [kg.m2], in [0, inf); default 1e-05

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition
    """

    def __init__(self, *, inertia: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, inertia: float = ...) -> TorqueSource:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def inertia(self) -> float:
        """Rotor inertia [kg.m2]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'torque_source'

    source: str = 'definition'

    fields: tuple[dict[str, Any], ...]

class CurrentSource:
    """
    A motor behind a fast current controller: the current is what it is asked to be, at once and at any speed.

    .. math:: i = u, \\qquad \\tau = K_m i

    with u what the controller asks for [A], K_m = torque_constant. Leaves out that the supply limits the current as the
    speed grows.

    >>> from strainwave.motor import CurrentSource
    >>> CurrentSource(torque_constant=0.1).torque_constant
    0.1

    Parameters
    ----------
    torque_constant: Torque per current K_m [N.m/A], in [0, inf); default 0.05
    inertia: Rotor inertia [kg.m2], in [0, inf); default 1e-05

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition
    """

    def __init__(self, *, torque_constant: float = ..., inertia: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, torque_constant: float = ..., inertia: float = ...) -> CurrentSource:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def torque_constant(self) -> float:
        """Torque per current K_m [N.m/A]"""

    @property
    def inertia(self) -> float:
        """Rotor inertia [kg.m2]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'current_source'

    source: str = 'definition'

    fields: tuple[dict[str, Any], ...]
