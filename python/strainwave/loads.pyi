"""What the output shaft carries."""

from typing import Any


class Inertia:
    """
    A balanced rotating body on the output shaft.

    .. math:: T_{load} = 0

    with inertia = inertia, about the output axis.

    >>> from strainwave.loads import Inertia
    >>> Inertia(inertia=0.005).inertia
    0.005

    Parameters
    ----------
    inertia: Inertia about the output axis [kg.m2], in (0, inf); default 0.01

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition
    """

    def __init__(self, *, inertia: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, inertia: float = ...) -> Inertia:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def inertia(self) -> float:
        """Inertia about the output axis [kg.m2]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'inertia'

    source: str = 'definition'

    fields: tuple[dict[str, Any], ...]

class Pendulum:
    """
    An unbalanced arm on a horizontal output shaft.

    .. math:: T_{load} = m g l \\sin\\theta_{out}

    with m g l = gravity_torque, hanging down at theta_out = 0.

    >>> from strainwave.loads import Pendulum
    >>> Pendulum(inertia=0.5, gravity_torque=15.0).gravity_torque
    15.0

    Parameters
    ----------
    inertia: Inertia about the output axis [kg.m2], in (0, inf); default 0.01
    gravity_torque: Weight times distance of the centre of mass [N.m], in [0, inf); default 0.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition; theta_out = 0 hangs down
    """

    def __init__(self, *, inertia: float = ..., gravity_torque: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, inertia: float = ..., gravity_torque: float = ...) -> Pendulum:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def inertia(self) -> float:
        """Inertia about the output axis [kg.m2]"""

    @property
    def gravity_torque(self) -> float:
        """Weight times distance of the centre of mass [N.m]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'pendulum'

    source: str = 'definition; theta_out = 0 hangs down'

    fields: tuple[dict[str, Any], ...]

class Prescribed:
    """
    An output shaft that is moved, or held, from outside: a rig that locks it, or another simulation that it is part of.

    .. math:: \\theta_{out} = \\theta(t), \\qquad T_{load} = T - F_{out}

    with theta(t) the run's input output_angle [rad], given with its speed. The torque of the load is what the shaft exerts
    on whatever moves it. While it is held, set-valued friction at the output cannot be told from that torque, and is
    reported as 0.

    >>> from strainwave.loads import Prescribed
    >>> Prescribed()
    Prescribed()

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

    def replace(self, changes: dict[str, Any] = ..., /) -> Prescribed:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'prescribed'

    source: str = 'definition'

    fields: tuple[dict[str, Any], ...]
