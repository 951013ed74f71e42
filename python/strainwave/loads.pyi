"""What the output shaft carries."""

from collections.abc import Sequence
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

    .. math:: T_{load} = m g l \\sin(\\theta_{out} + \\varphi)

    with m g l = gravity_torque, phi = gravity_phase: it hangs down at theta_out = -phi, where an encoder counts from
    elsewhere than the lowest place.

    >>> from strainwave.loads import Pendulum
    >>> Pendulum(inertia=0.5, gravity_torque=15.0).gravity_torque
    15.0

    Parameters
    ----------
    inertia: Inertia about the output axis [kg.m2], in (0, inf); default 0.01
    gravity_torque: Weight times distance of the centre of mass [N.m], in [0, inf); default 0.0
    gravity_phase: Angle from hanging down to where theta_out = 0 [rad]; default 0.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition
    """

    def __init__(self, *, inertia: float = ..., gravity_torque: float = ..., gravity_phase: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, inertia: float = ..., gravity_torque: float = ..., gravity_phase: float = ...) -> Pendulum:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def inertia(self) -> float:
        """Inertia about the output axis [kg.m2]"""

    @property
    def gravity_torque(self) -> float:
        """Weight times distance of the centre of mass [N.m]"""

    @property
    def gravity_phase(self) -> float:
        """Angle from hanging down to where theta_out = 0 [rad]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'pendulum'

    source: str = 'definition'

    fields: tuple[dict[str, Any], ...]

class TorsionSpring:
    """
    A body that a spring and a damper tie to the housing.

    .. math:: T_{load} = k\\,(\\theta_{out} - \\theta_0) + c\\,\\omega_{out}

    with k = stiffness, c = damping, theta_0 = rest_angle.

    >>> from strainwave.loads import TorsionSpring
    >>> TorsionSpring(inertia=0.05, stiffness=200.0).rest_angle
    0.0

    Parameters
    ----------
    inertia: Inertia about the output axis [kg.m2], in (0, inf); default 0.01
    stiffness: Torque per angle k [N.m/rad], in [0, inf); default 0.0
    damping: Torque per speed c [N.m.s/rad], in [0, inf); default 0.0
    rest_angle: Angle theta_0 at which the spring is relaxed [rad]; default 0.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition
    """

    def __init__(self, *, inertia: float = ..., stiffness: float = ..., damping: float = ..., rest_angle: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, inertia: float = ..., stiffness: float = ..., damping: float = ..., rest_angle: float = ...) -> TorsionSpring:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def inertia(self) -> float:
        """Inertia about the output axis [kg.m2]"""

    @property
    def stiffness(self) -> float:
        """Torque per angle k [N.m/rad]"""

    @property
    def damping(self) -> float:
        """Torque per speed c [N.m.s/rad]"""

    @property
    def rest_angle(self) -> float:
        """Angle theta_0 at which the spring is relaxed [rad]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'torsion_spring'

    source: str = 'definition'

    fields: tuple[dict[str, Any], ...]

class Aerodynamic:
    """
    A body in an air stream: a control surface, a nacelle that tilts.

    .. math:: T_{load} = \\tfrac{1}{2} \\rho V^2 S \\bar c\\,(C_0 + C_1 \\sin(\\theta_{out} - \\theta_0))
              + \\tfrac{1}{2} \\rho S C_d r^3 |\\omega_{out}| \\omega_{out}

    with V = airspeed, rho = density, S = area, c = chord, C_0 = moment_coefficient, C_1 = moment_slope, theta_0 =
    neutral_angle, C_d = drag_coefficient of the surface as it turns, at the radius r = drag_radius. C_1 > 0 drives back to the
    neutral angle. The sine continues the linear law of small angles to all angles; it is no law of a particular body, whose
    measured moments a TorqueTable takes. Gusts are the run's input load_torque.

    >>> from strainwave.loads import Aerodynamic
    >>> Aerodynamic(area=0.5, chord=0.3, airspeed=40.0).density
    1.225

    Parameters
    ----------
    inertia: Inertia about the output axis [kg.m2], in (0, inf); default 0.01
    area: Reference area S [m2], in [0, inf); default 0.1
    chord: Reference length c [m], in [0, inf); default 0.2
    airspeed: Speed V of the stream [m/s], in [0, inf); default 0.0
    density: Density rho of the air [kg/m3], in [0, inf); default 1.225
    moment_coefficient: Hinge moment coefficient C_0 at the neutral angle; default 0.0
    moment_slope: Rise C_1 of that coefficient with the angle [1/rad]; default 0.1
    neutral_angle: Angle theta_0 [rad]; default 0.0
    drag_coefficient: Drag coefficient C_d of turning, in [0, inf); default 0.0
    drag_radius: Radius r at which that drag acts [m], in [0, inf); default 0.1

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition of the hinge moment coefficient: EtkinReid1996, section 2.5; sin in place of the angle, and the drag of turning are ours; density of the standard atmosphere at sea level: ISO1975
    """

    def __init__(self, *, inertia: float = ..., area: float = ..., chord: float = ..., airspeed: float = ..., density: float = ..., moment_coefficient: float = ..., moment_slope: float = ..., neutral_angle: float = ..., drag_coefficient: float = ..., drag_radius: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, inertia: float = ..., area: float = ..., chord: float = ..., airspeed: float = ..., density: float = ..., moment_coefficient: float = ..., moment_slope: float = ..., neutral_angle: float = ..., drag_coefficient: float = ..., drag_radius: float = ...) -> Aerodynamic:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def inertia(self) -> float:
        """Inertia about the output axis [kg.m2]"""

    @property
    def area(self) -> float:
        """Reference area S [m2]"""

    @property
    def chord(self) -> float:
        """Reference length c [m]"""

    @property
    def airspeed(self) -> float:
        """Speed V of the stream [m/s]"""

    @property
    def density(self) -> float:
        """Density rho of the air [kg/m3]"""

    @property
    def moment_coefficient(self) -> float:
        """Hinge moment coefficient C_0 at the neutral angle"""

    @property
    def moment_slope(self) -> float:
        """Rise C_1 of that coefficient with the angle [1/rad]"""

    @property
    def neutral_angle(self) -> float:
        """Angle theta_0 [rad]"""

    @property
    def drag_coefficient(self) -> float:
        """Drag coefficient C_d of turning"""

    @property
    def drag_radius(self) -> float:
        """Radius r at which that drag acts [m]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'aerodynamic'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

class TorqueTable:
    """
    A torque over the output angle, given as a table.

    .. math:: T_{load} = T_k + (T_{k+1} - T_k) \\frac{\\theta_{out} - \\theta_k}{\\theta_{k+1} - \\theta_k}, \\qquad
              \\theta_k \\le \\theta_{out} < \\theta_{k+1}

    with theta_k = angle, increasing, T_k = held_torque, up to 32 of each. Before the first and behind the last angle the torque
    stays what it is there. What changes over time besides is the run's input load_torque, which adds to it: a table of
    time is a scenario.

    >>> from strainwave.loads import TorqueTable
    >>> TorqueTable(angle=[-1.0, 0.0, 1.0], held_torque=[-3.0, 0.0, 5.0]).held_torque[2]
    5.0

    Parameters
    ----------
    inertia: Inertia about the output axis [kg.m2], in (0, inf); default 0.01
    angle: Output angles, increasing [rad]; default ()
    held_torque: Torque at each that holds the output back [N.m]; default ()

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition
    """

    def __init__(self, *, inertia: float = ..., angle: float | Sequence[float] = ..., held_torque: float | Sequence[float] = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, inertia: float = ..., angle: float | Sequence[float] = ..., held_torque: float | Sequence[float] = ...) -> TorqueTable:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def inertia(self) -> float:
        """Inertia about the output axis [kg.m2]"""

    @property
    def angle(self) -> tuple[float, ...]:
        """Output angles, increasing [rad]"""

    @property
    def held_torque(self) -> tuple[float, ...]:
        """Torque at each that holds the output back [N.m]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'torque_table'

    source: str = 'definition'

    fields: tuple[dict[str, Any], ...]

class Brake:
    """
    A friction brake on the output shaft, as of a load rig: it resists motion, and holds at rest.

    .. math:: T_{load} = B(t) \\operatorname{sgn} \\omega_{out} \\quad (\\omega_{out} \\ne 0), \\qquad
              |T_{load}| \\le \\kappa B(t) \\quad (\\omega_{out} = 0)

    with B(t) the run's input brake_torque [N.m], of which a negative one counts as 0, kappa = breakaway_ratio. It sticks
    exactly. While the shaft sticks, torque that friction of the gear at the output holds besides cannot be told from the
    brake's; it is shared in proportion to what each can hold.

    >>> from strainwave.loads import Brake
    >>> Brake(inertia=0.02).breakaway_ratio
    1.0

    Parameters
    ----------
    inertia: Inertia about the output axis [kg.m2], in (0, inf); default 0.01
    breakaway_ratio: What it holds at rest per what it resists in motion, in [1, inf); default 1.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition: dry friction of a commanded level, set-valued at rest
    """

    def __init__(self, *, inertia: float = ..., breakaway_ratio: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, inertia: float = ..., breakaway_ratio: float = ...) -> Brake:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def inertia(self) -> float:
        """Inertia about the output axis [kg.m2]"""

    @property
    def breakaway_ratio(self) -> float:
        """What it holds at rest per what it resists in motion"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'brake'

    source: str = ...

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
