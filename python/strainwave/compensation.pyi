"""What takes away what the gear does to the motion."""

from collections.abc import Sequence
from typing import Any

import numpy
import numpy.typing

import strainwave._core
import strainwave.friction
import strainwave.loads


class NoFeedforward:
    """
    No feed-forward of a model: the controller acts on the error alone.

    .. math:: \\tau_f = 0

    >>> from strainwave.compensation import NoFeedforward
    >>> NoFeedforward()
    NoFeedforward()

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

    def replace(self, changes: dict[str, Any] = ..., /) -> NoFeedforward:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'no_feedforward'

    source: str = 'definition'

    fields: tuple[dict[str, Any], ...]

    def requests(self, angle: Sequence[float] | numpy.typing.NDArray[numpy.float64], speed: Sequence[float] | numpy.typing.NDArray[numpy.float64], ratio: float, period: float) -> tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]]:
        """
        Return its requests along a motion of the output, `angle` [rad] and `speed` [rad/s], each of shape (n,), one `period` [s] after another, through a gear of this signed `ratio`: the lead of the input over the rigid motion [rad], its rate [rad/s], the torque of the motor [N.m], and the share of it that overcomes friction [N.m], each of shape (n,). `ValueError` if the two differ in length, if `period` lies outside of [1e-9, 1e6], or `ratio` without its sign outside of [1e-6, 1e6].
        """

    @property
    def active(self) -> bool:
        """Whether it makes any difference."""

class ModelFeedforward:
    """
    Feed-forward of a model of the drive: the input angle and torque that move the output along its command.

    .. math:: T = J_{out} \\ddot r + T_{load}(r, \\dot r) + F_{out}, \\qquad \\delta: T_{gear}(\\delta, \\text{history}) = T, \\qquad
              \\theta = i\\,(r + e(\\theta) + \\delta)

    .. math:: \\tau = J_{in} \\ddot\\theta + (T + F_{mesh})\\,(1/i - e'(\\theta)) + F_{in}

    with r the commanded output angle, i the signed ratio, T the torque that the gear transmits, delta its twist, e its kinematic
    error, theta the input angle, J_in = motor_inertia + gear.input_inertia. The request is the lead theta - i r of the
    input, and the torque tau. ``gear`` and ``load`` are the model. An effect that the model lacks is not compensated.
    The ratio of ``gear`` must be that of the drive.

    The fixed point theta <- i (r + e(theta) + delta) is repeated ``rounds`` times. It converges if q = |i| max|e'| < 1: each
    round reduces the error to at most the share q. delta lies on the branch of the hysteresis that the command follows.
    Rates are differences over a period, so the torque of inertia is half a period late.

    A set-valued friction acts in the sense s of the motion. At a reversal s changes gradually, as bristles bend before they
    slide: ds = (sgn(d theta) - s) |d theta| / presliding. Laws with bristles have presliding of their own. friction_share is
    the share of the friction that is compensated. Use less than 1 if the model may have too much friction: compensation
    beyond the true friction drives the joint by itself.

    Valid if the motion is slow against the vibration of load and gear. The model has no damping of the spring, no noise, no
    bodies within the gear and no variation of the stiffness. Its temperature is constant.

    >>> import strainwave as sw
    >>> gear = sw.Gear(friction_input=sw.friction.Coulomb(coulomb=0.05))
    >>> sw.compensation.ModelFeedforward(gear=gear, load=sw.loads.Inertia(inertia=0.1)).rounds
    4

    Parameters
    ----------
    gear: Model of the gear; default Gear(kinematics=StrainWave(flexspline_teeth=200, circular_spline_teeth=202, fixed='circular_spline'), kinematic_error=Fourier(order=(), amplitude=(), phase=()), kinematic_noise=Stochastic(amplitude=0.0, lowest_order=8.0, highest_order=40.0, seed=0.0, load_sensitivity=0.0, speed_sensitivity=0.0, insertion_depth=0.0, depth_sensitivity=0.0), stiffness=Linear(k=10000.0), hysteresis=MaxwellSlip(stiffness=(), breakaway=()), damping=0.0, friction_input=Viscous(viscous=0.0), friction_mesh=Viscous(viscous=0.0), friction_output=Viscous(viscous=0.0), input_inertia=0.0, softening=ThermalSoftening(stiffness_fall=0.0, hysteresis_fall=0.0, reference_temperature=293.15), stiffness_variation=Constant(), structure=Lumped())
    load: Model of the load; default Inertia(inertia=0.01)
    motor_inertia: Inertia of the motor's rotor [kg.m2], in [0, inf); default 0.0
    presliding: Input angle over which the old sense of set-valued friction falls to 1/e [rad], in (0, inf); default 0.002
    friction_share: Share of the friction that is compensated, in [0, 1]; default 1.0
    rounds: Rounds of the fixed point; 0 leaves the kinematic error out, in [0, 8]; default 4
    temperature: Temperature of the gear [K], in (0, inf); default 293.15

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    the equations of the drive, solved for the input along the commanded motion; fixed point of the kinematic error: Banach1922; presliding of the sense of friction: Dahl1968
    """

    def __init__(self, *, gear: strainwave._core.Gear = ..., load: strainwave.loads.Inertia | strainwave.loads.Pendulum | strainwave.loads.TorsionSpring | strainwave.loads.Aerodynamic | strainwave.loads.TorqueTable | strainwave.loads.Brake | strainwave.loads.Prescribed = ..., motor_inertia: float = ..., presliding: float = ..., friction_share: float = ..., rounds: int = ..., temperature: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, gear: strainwave._core.Gear = ..., load: strainwave.loads.Inertia | strainwave.loads.Pendulum | strainwave.loads.TorsionSpring | strainwave.loads.Aerodynamic | strainwave.loads.TorqueTable | strainwave.loads.Brake | strainwave.loads.Prescribed = ..., motor_inertia: float = ..., presliding: float = ..., friction_share: float = ..., rounds: int = ..., temperature: float = ...) -> ModelFeedforward:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def gear(self) -> strainwave._core.Gear:
        """Model of the gear"""

    @property
    def load(self) -> strainwave.loads.Inertia | strainwave.loads.Pendulum | strainwave.loads.TorsionSpring | strainwave.loads.Aerodynamic | strainwave.loads.TorqueTable | strainwave.loads.Brake | strainwave.loads.Prescribed:
        """Model of the load"""

    @property
    def motor_inertia(self) -> float:
        """Inertia of the motor's rotor [kg.m2]"""

    @property
    def presliding(self) -> float:
        """
        Input angle over which the old sense of set-valued friction falls to 1/e [rad]
        """

    @property
    def friction_share(self) -> float:
        """Share of the friction that is compensated"""

    @property
    def rounds(self) -> int:
        """Rounds of the fixed point; 0 leaves the kinematic error out"""

    @property
    def temperature(self) -> float:
        """Temperature of the gear [K]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'model_feedforward'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    def requests(self, angle: Sequence[float] | numpy.typing.NDArray[numpy.float64], speed: Sequence[float] | numpy.typing.NDArray[numpy.float64], ratio: float, period: float) -> tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]]:
        """
        Return its requests along a motion of the output, `angle` [rad] and `speed` [rad/s], each of shape (n,), one `period` [s] after another, through a gear of this signed `ratio`: the lead of the input over the rigid motion [rad], its rate [rad/s], the torque of the motor [N.m], and the share of it that overcomes friction [N.m], each of shape (n,). `ValueError` if the two differ in length, if `period` lies outside of [1e-9, 1e6], or `ratio` without its sign outside of [1e-6, 1e6].
        """

class LostMotionMap:
    """
    Lead of the input by a table of measured lost motion over the output angle, for each sense of motion.

    .. math:: \\theta = i\\,\\Big(r + \\tfrac{1 + s}{2} f(r) + \\tfrac{1 - s}{2} b(r)\\Big), \\qquad
              ds = (\\operatorname{sgn}(dr) - s)\\, \\frac{|dr|}{r_0}

    with r the commanded output angle, f and b the lines through forward and backward over angle. angle increases; beyond its ends
    f and b are constant. s is the sense of motion: at an angle r_0 = reach after a reversal 1/e of the lost motion is left.
    Before the first motion s = 0, the middle of both. The map needs no model. It does not depend on load and speed.

    >>> from strainwave.compensation import LostMotionMap
    >>> LostMotionMap(angle=[0.0], forward=[2e-4], backward=[-2e-4]).reach
    0.001

    Parameters
    ----------
    angle: Output angles, rising [rad]; default ()
    forward: Lead at the output where it moves forwards [rad]; default ()
    backward: Lead at the output where it moves backwards [rad]; default ()
    reach: Output angle r_0 over which what is left to take up falls to 1/e [rad], in (0, inf); default 0.001

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    document T, which asks for maps of compensation; between the two branches: Dahl1968
    """

    def __init__(self, *, angle: float | Sequence[float] = ..., forward: float | Sequence[float] = ..., backward: float | Sequence[float] = ..., reach: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, angle: float | Sequence[float] = ..., forward: float | Sequence[float] = ..., backward: float | Sequence[float] = ..., reach: float = ...) -> LostMotionMap:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def angle(self) -> tuple[float, ...]:
        """Output angles, rising [rad]"""

    @property
    def forward(self) -> tuple[float, ...]:
        """Lead at the output where it moves forwards [rad]"""

    @property
    def backward(self) -> tuple[float, ...]:
        """Lead at the output where it moves backwards [rad]"""

    @property
    def reach(self) -> float:
        """Output angle r_0 over which what is left to take up falls to 1/e [rad]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'lost_motion_map'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    def requests(self, angle: Sequence[float] | numpy.typing.NDArray[numpy.float64], speed: Sequence[float] | numpy.typing.NDArray[numpy.float64], ratio: float, period: float) -> tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]]:
        """
        Return its requests along a motion of the output, `angle` [rad] and `speed` [rad/s], each of shape (n,), one `period` [s] after another, through a gear of this signed `ratio`: the lead of the input over the rigid motion [rad], its rate [rad/s], the torque of the motor [N.m], and the share of it that overcomes friction [N.m], each of shape (n,). `ValueError` if the two differ in length, if `period` lies outside of [1e-9, 1e6], or `ratio` without its sign outside of [1e-6, 1e6].
        """

class NoLearning:
    """
    No learning: errors that repeat with the angle are not corrected.

    .. math:: \\hat e = 0

    >>> from strainwave.compensation import NoLearning
    >>> NoLearning()
    NoLearning()

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

    def replace(self, changes: dict[str, Any] = ..., /) -> NoLearning:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'no_learning'

    source: str = 'definition'

    fields: tuple[dict[str, Any], ...]

    @property
    def active(self) -> bool:
        """Whether it makes any difference."""

class AdaptiveFourier:
    """
    Learning of errors that repeat with the input angle: one sine and one cosine for each order.

    .. math:: \\hat e = \\sum_n a_n \\sin n\\theta + b_n \\cos n\\theta, \\qquad
              \\dot a_n = \\gamma\\, (r - \\theta_{out}) \\sin(n\\theta - \\varphi_n), \\quad
              \\dot b_n = \\gamma\\, (r - \\theta_{out}) \\cos(n\\theta - \\varphi_n), \\qquad \\varphi_n = n\\, \\omega\\, t_{lag}

    with theta the input angle, r the commanded and theta_out the measured output angle, gamma = gain, t_lag = lag of
    the position loop. The input leads by i e^. Let P(j n omega) be the response of the output to the lead. The amplitude of
    a constant error of order n decays as exp(-gamma/2 |P| cos(Delta) t), with Delta the angle between P and exp(-j phi_n).
    It grows if Delta exceeds 90 degrees. Therefore learning stops if n |omega| exceeds ``max_frequency``, and if |omega| is
    below ``min_speed``. No sine and no cosine exceeds ``limit``. Keep |i| n times the largest
    amplitude below 1: beyond that the input has several angles for one command. An error of the output encoder itself is learnt as well.
    An order of 0 learns a constant: with min_speed = 0 it is a slow integral of the error of the output.

    >>> from strainwave.compensation import AdaptiveFourier
    >>> AdaptiveFourier(order=[1, 2]).gain
    5.0

    Parameters
    ----------
    order: Orders n: periods per revolution of the input; 0 for a constant, in [0, inf); default ()
    gain: Rate gamma at which the amplitudes follow the error [1/s], in [0, inf); default 5.0
    lag: Lag t_lag of the position loop [s], in [0, inf); default 0.0
    min_speed: Least input speed of learning [rad/s], in [0, inf); default 1.0
    max_frequency: Largest frequency n |omega| of learning [rad/s], in (0, inf); default 100.0
    limit: Largest sine and cosine at the output [rad], in [0, inf); default 0.001

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    BodsonSacksKhosla1994, adaptive feedforward cancellation, over the input angle in place of time; its rate by averaging (SandersVerhulstMurdock2007)
    """

    def __init__(self, *, order: float | Sequence[float] = ..., gain: float = ..., lag: float = ..., min_speed: float = ..., max_frequency: float = ..., limit: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, order: float | Sequence[float] = ..., gain: float = ..., lag: float = ..., min_speed: float = ..., max_frequency: float = ..., limit: float = ...) -> AdaptiveFourier:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def order(self) -> tuple[float, ...]:
        """Orders n: periods per revolution of the input; 0 for a constant"""

    @property
    def gain(self) -> float:
        """Rate gamma at which the amplitudes follow the error [1/s]"""

    @property
    def lag(self) -> float:
        """Lag t_lag of the position loop [s]"""

    @property
    def min_speed(self) -> float:
        """Least input speed of learning [rad/s]"""

    @property
    def max_frequency(self) -> float:
        """Largest frequency n |omega| of learning [rad/s]"""

    @property
    def limit(self) -> float:
        """Largest sine and cosine at the output [rad]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'adaptive_fourier'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

class Repetitive:
    """
    Learning of errors of any shape that repeat with each turn of the input: a table over the input angle.

    .. math:: \\hat e(\\theta) = \\sum_j c_j\\, w_j(\\theta), \\qquad \\dot c_j = \\gamma\\, w_j(\\theta - \\omega\\, t_{lag})\\,
              (r - \\theta_{out}) - \\sigma\\, w_j(\\theta)\\,\\big(c_j - \\tfrac{1}{2}(c_{j-1} + c_{j+1})\\big)

    with w_j the hat functions of 32 equal cells of a turn, gamma = gain, sigma = smoothing, t_lag = lag of the position loop.
    The term of sigma is the filter Q: it removes differences between neighbouring cells. The input leads by i e^. Learning
    needs an input speed between ``min_speed`` and ``max_speed``. At max_speed the highest order of the error must lag by less
    than 90 degrees. No value exceeds ``limit``. Orders above 8 are learnt in part only. Errors that do not repeat with each
    turn of the input are not learnt: AdaptiveFourier learns any order.

    >>> from strainwave.compensation import Repetitive
    >>> Repetitive(gain=10.0).limit
    0.001

    Parameters
    ----------
    gain: Rate gamma at which a cell follows the error [1/s], in [0, inf); default 5.0
    smoothing: Rate sigma at which a cell follows its neighbours [1/s], in [0, inf); default 0.0
    lag: Lag t_lag of the position loop [s], in [0, inf); default 0.0
    min_speed: Least input speed of learning [rad/s], in [0, inf); default 1.0
    max_speed: Largest input speed of learning [rad/s], in (0, inf); default 30.0
    limit: Largest value at the output [rad], in [0, inf); default 0.001

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    HaraYamamotoOmataNakano1988, repetitive control with a filter Q, over the input angle in place of time and with local functions in place of a delay
    """

    def __init__(self, *, gain: float = ..., smoothing: float = ..., lag: float = ..., min_speed: float = ..., max_speed: float = ..., limit: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, gain: float = ..., smoothing: float = ..., lag: float = ..., min_speed: float = ..., max_speed: float = ..., limit: float = ...) -> Repetitive:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def gain(self) -> float:
        """Rate gamma at which a cell follows the error [1/s]"""

    @property
    def smoothing(self) -> float:
        """Rate sigma at which a cell follows its neighbours [1/s]"""

    @property
    def lag(self) -> float:
        """Lag t_lag of the position loop [s]"""

    @property
    def min_speed(self) -> float:
        """Least input speed of learning [rad/s]"""

    @property
    def max_speed(self) -> float:
        """Largest input speed of learning [rad/s]"""

    @property
    def limit(self) -> float:
        """Largest value at the output [rad]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'repetitive'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

class IterativeLearning:
    """
    Learning of errors that repeat over the output angle, for each sense of motion: lost motion and kinematic error, without a model.

    .. math:: \\hat e = \\sum_j w_j(r)\\,\\Big(\\tfrac{1 + s}{2} f_j + \\tfrac{1 - s}{2} b_j\\Big), \\qquad
              ds = (\\operatorname{sgn}(dr) - s)\\, \\frac{|dr|}{r_0}

    .. math:: \\dot f_j = \\tfrac{1 + s}{2} \\Big(\\gamma\\, w_j(r - \\dot r\\, t_{lag})\\,(r - \\theta_{out})
              - \\sigma\\, w_j(r)\\,\\big(f_j - \\tfrac{1}{2}(f_{j-1} + f_{j+1})\\big)\\Big)

    with r the commanded and theta_out the measured output angle, w_j the hat functions of 32 angles from ``low`` to ``high``, f_j and
    b_j the tables of forward and backward motion, gamma = gain, sigma = smoothing, t_lag = lag of the position loop, s the
    sense of motion, r_0 = reach; b_j follows likewise with 1 - s. The input leads by i e^. Beyond the ends the lead is constant.
    Learning needs an angle within ``low`` and ``high`` and an input speed between ``min_speed`` and ``max_speed``. No value
    exceeds ``limit``. Keep reach above the way of the command in a period: after a reversal the lead changes at
    2 |dr/dt| / reach times half of f - b.

    A pass at output speed v over cells of width h leaves 1 - gamma h / v of an error that does not vary over the angle; at the
    ends half as much is learnt. gamma is at most v / h and at most one per period, whatever ``gain``: no pass learns more than the whole error. The cells
    within v t_lag of the end of a pass are not learnt. A wave of
    the error is learnt if the position loop lags by less than 90 degrees beyond ``lag``, as it must up to ``max_speed``.
    The output encoder is needed. Errors that change within two cells are not learnt: Repetitive and AdaptiveFourier learn
    errors that repeat with the input.

    >>> from strainwave.compensation import IterativeLearning
    >>> IterativeLearning(low=-0.5, high=0.5).limit
    0.001

    Parameters
    ----------
    low: Least output angle of the tables [rad], in [-1000000, 1000000]; default -1.0
    high: Largest output angle of the tables [rad], in [-1000000, 1000000]; default 1.0
    reach: Output angle r_0 after a reversal over which the old sense falls to 1/e [rad], in [1e-09, inf); default 0.001
    gain: Rate gamma at which a value follows the error [1/s], in [0, inf); default 5.0
    smoothing: Rate sigma at which a value follows its neighbours [1/s], in [0, inf); default 0.0
    lag: Lag t_lag of the position loop [s], in [0, inf); default 0.0
    min_speed: Least input speed of learning [rad/s], in [0, inf); default 1.0
    max_speed: Largest input speed of learning [rad/s], in (0, inf); default 300.0
    limit: Largest value at the output [rad], in [0, inf); default 0.001

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    BristowTharayilAlleyne2006, iterative learning control with a filter Q, over the output angle in place of time and for each sense of motion; between the two senses: Dahl1968
    """

    def __init__(self, *, low: float = ..., high: float = ..., reach: float = ..., gain: float = ..., smoothing: float = ..., lag: float = ..., min_speed: float = ..., max_speed: float = ..., limit: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, low: float = ..., high: float = ..., reach: float = ..., gain: float = ..., smoothing: float = ..., lag: float = ..., min_speed: float = ..., max_speed: float = ..., limit: float = ...) -> IterativeLearning:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def low(self) -> float:
        """Least output angle of the tables [rad]"""

    @property
    def high(self) -> float:
        """Largest output angle of the tables [rad]"""

    @property
    def reach(self) -> float:
        """
        Output angle r_0 after a reversal over which the old sense falls to 1/e [rad]
        """

    @property
    def gain(self) -> float:
        """Rate gamma at which a value follows the error [1/s]"""

    @property
    def smoothing(self) -> float:
        """Rate sigma at which a value follows its neighbours [1/s]"""

    @property
    def lag(self) -> float:
        """Lag t_lag of the position loop [s]"""

    @property
    def min_speed(self) -> float:
        """Least input speed of learning [rad/s]"""

    @property
    def max_speed(self) -> float:
        """Largest input speed of learning [rad/s]"""

    @property
    def limit(self) -> float:
        """Largest value at the output [rad]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'iterative_learning'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

class TwistIdentification:
    """
    Identification while the joint works: compliance of the gear and orders of its kinematic error, from both encoders.

    .. math:: z = \\frac{\\theta - \\theta_f}{i} - \\theta_{out} = \\varphi^T x + \\text{noise}, \\qquad
              \\varphi = \\big(\\delta,\\; 1,\\; \\sin n\\theta,\\; \\cos n\\theta\\big), \\qquad
              x = \\big(c,\\; z_0,\\; a_n,\\; b_n\\big)

    .. math:: K_j = \\frac{(P\\varphi)_j}{\\varphi^T P \\varphi + R}, \\qquad x \\leftarrow x + K\\,(z - \\varphi^T x), \\qquad
              P \\leftarrow (I - K\\varphi^T)\\,P\\,(I - K\\varphi^T)^T + R\\,K K^T, \\qquad R = \\sigma^2\\, t_n / t_s

    .. math:: \\dot x = -x / t_m, \\qquad \\dot P = \\frac{2}{t_m}\\,(P_0 - P)

    with theta and theta_out the measured angles, i the ratio, theta_f the lead and delta the twist that the feed-forward
    asks for, c the compliance over that of the model minus 1, z_0 the offset of the encoders, a_n, b_n the orders of the
    kinematic error that the model lacks, P their covariance, P_0 that of the priors, sigma = noise, t_n = noise_time, t_s the
    period, t_m = memory. The input leads by i (c delta + a_n sin n theta + b_n cos n theta); the offset is estimated only.

    A number is adapted while its excitation, var(phi_j) P_0jj / (sigma^2 t_n) over ``window``, is at least ``min_excitation``.
    The inverse of the excitation is the time in which the motion determines the number as well as its prior does. Otherwise
    the number and its standard deviation are kept, and the gain of the others accounts for its uncertainty. A constant torque does
    not determine the compliance. At an input speed below ``min_speed`` nothing changes. No number exceeds ``limit`` standard
    deviations of its prior. Keep |i| n times the largest amplitude below 1: beyond that the input has several angles for one
    command. Its own lead changes theta and i theta_out alike, so it does not change z.

    The state contains estimates (``value``), standard deviations (``deviation``), excitations, and ``residual``, the size of what
    the estimates leave. The deviations are right while the model errs by ``noise``, for no longer than ``noise_time`` in
    one sense. It needs both encoders and a feed-forward with a twist. A load that the feed-forward does not know is taken
    for compliance.

    >>> from strainwave.compensation import TwistIdentification
    >>> TwistIdentification(order=[2]).memory
    600.0

    Parameters
    ----------
    order: Orders n: periods per revolution of the input, in (0, inf); default ()
    compliance_prior: Standard deviation of the compliance over that of the model, a priori, in [0, 10]; default 0.3
    amplitude_prior: Standard deviation of each sine and cosine at the output, a priori [rad], in [0, 1]; default 0.0003
    offset_prior: Standard deviation of the offset of the encoders at the output, a priori [rad], in [0, 100]; default 0.001
    noise: Standard deviation sigma of the measured twist about the model [rad], in [1e-09, 1]; default 2e-05
    noise_time: Time t_n over which the error of the model repeats itself [s], in [1e-06, 1000000]; default 0.1
    memory: Time t_m of motion over which the numbers change by their priors [s], in [1e-06, inf); default 600.0
    window: Time of motion over which the excitation is measured [s], in (0, inf); default 10.0
    min_excitation: Excitation below which a number is kept [1/s], in [0, inf); default 1.0
    min_speed: Input speed below which nothing is adapted [rad/s], in [0, inf); default 1.0
    limit: Largest change of a number, over its prior, in [0, 1000000]; default 3.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    recursive least squares as a Kalman filter: Ljung1999, chapter 11; forgetting towards the prior: KulhavyKraus1996; update of the covariance: BucyJoseph1968; numbers without excitation: Schmidt1966
    """

    def __init__(self, *, order: float | Sequence[float] = ..., compliance_prior: float = ..., amplitude_prior: float = ..., offset_prior: float = ..., noise: float = ..., noise_time: float = ..., memory: float = ..., window: float = ..., min_excitation: float = ..., min_speed: float = ..., limit: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, order: float | Sequence[float] = ..., compliance_prior: float = ..., amplitude_prior: float = ..., offset_prior: float = ..., noise: float = ..., noise_time: float = ..., memory: float = ..., window: float = ..., min_excitation: float = ..., min_speed: float = ..., limit: float = ...) -> TwistIdentification:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def order(self) -> tuple[float, ...]:
        """Orders n: periods per revolution of the input"""

    @property
    def compliance_prior(self) -> float:
        """Standard deviation of the compliance over that of the model, a priori"""

    @property
    def amplitude_prior(self) -> float:
        """
        Standard deviation of each sine and cosine at the output, a priori [rad]
        """

    @property
    def offset_prior(self) -> float:
        """
        Standard deviation of the offset of the encoders at the output, a priori [rad]
        """

    @property
    def noise(self) -> float:
        """Standard deviation sigma of the measured twist about the model [rad]"""

    @property
    def noise_time(self) -> float:
        """Time t_n over which the error of the model repeats itself [s]"""

    @property
    def memory(self) -> float:
        """Time t_m of motion over which the numbers change by their priors [s]"""

    @property
    def window(self) -> float:
        """Time of motion over which the excitation is measured [s]"""

    @property
    def min_excitation(self) -> float:
        """Excitation below which a number is kept [1/s]"""

    @property
    def min_speed(self) -> float:
        """Input speed below which nothing is adapted [rad/s]"""

    @property
    def limit(self) -> float:
        """Largest change of a number, over its prior"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'twist_identification'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

class NoObserver:
    """
    No observer: disturbances are not estimated.

    .. math:: \\hat d = 0

    >>> from strainwave.compensation import NoObserver
    >>> NoObserver()
    NoObserver()

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

    def replace(self, changes: dict[str, Any] = ..., /) -> NoObserver:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'no_observer'

    source: str = 'definition'

    fields: tuple[dict[str, Any], ...]

    @property
    def active(self) -> bool:
        """Whether it makes any difference."""

class DisturbanceObserver:
    """
    Observer of the disturbance torque: its estimate is added to the torque of the motor.

    .. math:: \\hat d = \\frac{g}{s + g}\\,\\big(\\tau - \\tau_f - J s\\,(\\omega - \\omega_r)\\big), \\qquad
              \\tau \\leftarrow \\tau + \\operatorname{clip}(\\hat d, \\pm d_{max})

    with tau the torque of the motor, tau_f the feed-forward, omega the input speed, omega_r its command, J = inertia at the input,
    g = bandwidth, d_max = limit. Without a model the observer supplies friction, load and inertial torque. With a model it
    supplies the difference. The filter is exact for a torque that is constant over a period.

    tau is the actuation of the motor over actuation_per_torque. With a torque_constant it is that times the measured current,
    as a Cascade needs, whose actuation is a voltage. tau_f does not contain the torque that the law of control computes from
    its command or model. The observer would supply that torque twice. Set viscous_feedforward and coulomb_feedforward of the
    law to 0, and compensate friction by the model. Do not use the observer with FeedbackLinearisation or
    KinematicErrorTracking. The observer alone is stable if g T J / J_r < 2, with T the period and J_r the true inertia. Above the
    vibration of the load, J_r is the inertia of the input. A bandwidth near that vibration excites it.

    >>> from strainwave.compensation import DisturbanceObserver
    >>> DisturbanceObserver(inertia=2e-4, bandwidth=150.0, limit=0.3).bandwidth
    150.0

    Parameters
    ----------
    inertia: Inertia J at the input: rotor, wave generator, and load over ratio squared [kg.m2], in (0, inf); required
    bandwidth: Bandwidth g of the filter [rad/s], in (0, inf); default 100.0
    limit: Largest torque that it adds [N.m], in [0, inf); required
    torque_constant: Torque per measured current; 0: the torque by the actuation [N.m/A], in [0, inf); default 0.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    OhnishiShibataMurakami1996; SariyildizOboeOhnishi2020, with a low-pass filter of first order
    """

    def __init__(self, *, inertia: float, bandwidth: float = ..., limit: float, torque_constant: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, inertia: float = ..., bandwidth: float = ..., limit: float = ..., torque_constant: float = ...) -> DisturbanceObserver:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def inertia(self) -> float:
        """
        Inertia J at the input: rotor, wave generator, and load over ratio squared [kg.m2]
        """

    @property
    def bandwidth(self) -> float:
        """Bandwidth g of the filter [rad/s]"""

    @property
    def limit(self) -> float:
        """Largest torque that it adds [N.m]"""

    @property
    def torque_constant(self) -> float:
        """Torque per measured current; 0: the torque by the actuation [N.m/A]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'disturbance_observer'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

class FrictionScale:
    """
    Observer of the friction over that of the model. Friction changes with wear and temperature.

    .. math:: \\tau \\leftarrow \\tau + (\\hat s - 1) F, \\qquad \\dot{\\hat s} = \\gamma F \\sigma
              \\;\\text{ where } |\\omega_r| \\ge \\omega_{min}, \\qquad \\hat s \\in [s_{min}, s_{max}], \\qquad
              \\sigma = \\omega_r - \\omega + \\lambda\\, (\\theta_r - \\theta)

    with F the friction of the feed-forward, theta_r, omega_r and theta, omega the input angle and speed commanded
    and measured, gamma = gain, lambda = position_gain, that of the position loop, omega_min = min_speed,
    s_min, s_max = min_scale, max_scale. If the loop gives k sigma, and the inertia J at the input is at most k / lambda, the function
    J (sigma^2 + lambda^2 (theta_r - theta)^2) + (s - s^)^2 / gamma never grows, whatever the gain; with a delay in the loop
    gamma must be small. With lambda = 0, a motion of one sense under a position loop does not determine s. The scale is
    constant below omega_min, because rest and presliding do not determine s.

    >>> from strainwave.compensation import FrictionScale
    >>> FrictionScale(gain=5.0).max_scale
    1.5

    Parameters
    ----------
    gain: Rate gamma of the scale per friction and error sigma [1/(N.m.rad)], in [0, 1000000000000]; default 1.0
    position_gain: Weight lambda of the error of the input angle [1/s], in [0, inf); default 20.0
    min_scale: Least scale s_min, of the friction of the model, in [0, 1]; default 0.5
    max_scale: Largest scale s_max, in [1, 10]; default 1.5
    min_speed: Slowest commanded input speed omega_min that determines the scale [rad/s], in [0, inf); default 1.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    SlotineLi1991, section 8.2: gradient of a Lyapunov function, linear in the unknown
    """

    def __init__(self, *, gain: float = ..., position_gain: float = ..., min_scale: float = ..., max_scale: float = ..., min_speed: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, gain: float = ..., position_gain: float = ..., min_scale: float = ..., max_scale: float = ..., min_speed: float = ...) -> FrictionScale:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def gain(self) -> float:
        """Rate gamma of the scale per friction and error sigma [1/(N.m.rad)]"""

    @property
    def position_gain(self) -> float:
        """Weight lambda of the error of the input angle [1/s]"""

    @property
    def min_scale(self) -> float:
        """Least scale s_min, of the friction of the model"""

    @property
    def max_scale(self) -> float:
        """Largest scale s_max"""

    @property
    def min_speed(self) -> float:
        """
        Slowest commanded input speed omega_min that determines the scale [rad/s]
        """

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'friction_scale'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

class BristleObserver:
    """
    Observer of friction: a law of friction follows the measured input, and the motor supplies its torque.

    .. math:: \\tau \\leftarrow \\tau - \\tau_{fric} + \\rho\\, \\hat s\\, F(\\hat z, \\theta, \\omega), \\qquad
              \\dot{\\hat z} = f(\\hat z, v), \\quad v = \\omega + k \\sigma, \\qquad
              \\sigma = \\omega_r - \\omega + \\lambda\\, (\\theta_r - \\theta)

    .. math:: \\dot{\\hat s} = \\gamma \\rho F \\sigma \\;\\text{ where } |\\omega_r| \\ge \\omega_{min}, \\qquad
              \\hat s \\in [s_{min}, s_{max}]

    with ``friction`` the law of all friction at the input, F its torque, z its bristles, theta, omega and theta_r, omega_r the
    input angle and speed measured and commanded, rho = friction_share, k = bristle_gain, lambda = position_gain, gamma = gain.
    tau_fric is the friction that the feed-forward already requests. It is taken off, so no friction is supplied twice.

    k = 0 bends the bristles by the measured speed alone: friction is supplied after the input has moved. k = 1 bends them by
    omega_r + lambda (theta_r - theta). A shaft at rest then receives more torque until it breaks away, at most rho s^ times
    the breakaway torque. Bristles never leave their bounds. A set-valued law acts in the sense s of v, as
    ds = (sgn(v) - s) |v| dt / presliding. F is evaluated at the measured speed. Its load is the torque that
    feed-forward and dither request without friction, thus with the inertial torque.

    The scale converges to the true one over rho. rho s_max is the largest share of the friction of the law that is
    supplied: keep it below the true scale if over-compensation must not occur. Over-compensated friction drives the shaft by
    itself, because the compensation follows the measured motion. Let the loop give k_c sigma, with an inertia
    J <= k_c / lambda, F exact and s/rho within [s_min, s_max]. Then J (sigma^2 + lambda^2 (theta_r - theta)^2) +
    (s/rho - s^)^2 / gamma never grows.
    Below omega_min of the command the scale stands still.

    >>> import strainwave as sw
    >>> law = sw.friction.Coulomb(coulomb=0.05, breakaway=0.07)
    >>> sw.compensation.BristleObserver(friction=law, friction_share=0.9, gain=5.0).max_scale
    1.5

    Parameters
    ----------
    friction: Law of all friction, at the input; default Viscous(viscous=0.0)
    friction_share: Share rho of the friction that is supplied, in [0, 1]; default 1.0
    bristle_gain: Share k of the error that bends the bristles, in [0, 10]; default 0.0
    position_gain: Weight lambda of the error of the input angle [1/s], in [0, inf); default 20.0
    gain: Rate gamma of the scale per friction and error sigma; 0: constant scale [1/(N.m.rad)], in [0, 1000000000000]; default 0.0
    min_scale: Least scale s_min, of the friction of the law, in [0, 1]; default 0.5
    max_scale: Largest scale s_max, in [1, 10]; default 1.5
    min_speed: Slowest commanded input speed omega_min that determines the scale [rad/s], in [0, inf); default 1.0
    presliding: Input angle over which the old sense of set-valued friction falls to 1/e [rad], in (0, inf); default 0.002
    temperature: Temperature of the friction [K], in (0, inf); default 293.15

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    CanudasDeWit1995: bristles that follow the measured speed and the error; scale: SlotineLi1991, section 8.2; presliding of the sense of friction: Dahl1968
    """

    def __init__(self, *, friction: strainwave.friction.Viscous | strainwave.friction.Coulomb | strainwave.friction.Stribeck | strainwave.friction.PositionDependent | strainwave.friction.LuGre | strainwave.friction.MaxwellSlipFriction | strainwave.friction.LoadDependent | strainwave.friction.MixedLubrication | strainwave.friction.CurvedViscous | strainwave.friction.AngleSpeedMap | strainwave.friction.TorqueEfficiency | strainwave.friction.Asymmetric | strainwave.friction.Cyclic | strainwave.friction.Thermal = ..., friction_share: float = ..., bristle_gain: float = ..., position_gain: float = ..., gain: float = ..., min_scale: float = ..., max_scale: float = ..., min_speed: float = ..., presliding: float = ..., temperature: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, friction: strainwave.friction.Viscous | strainwave.friction.Coulomb | strainwave.friction.Stribeck | strainwave.friction.PositionDependent | strainwave.friction.LuGre | strainwave.friction.MaxwellSlipFriction | strainwave.friction.LoadDependent | strainwave.friction.MixedLubrication | strainwave.friction.CurvedViscous | strainwave.friction.AngleSpeedMap | strainwave.friction.TorqueEfficiency | strainwave.friction.Asymmetric | strainwave.friction.Cyclic | strainwave.friction.Thermal = ..., friction_share: float = ..., bristle_gain: float = ..., position_gain: float = ..., gain: float = ..., min_scale: float = ..., max_scale: float = ..., min_speed: float = ..., presliding: float = ..., temperature: float = ...) -> BristleObserver:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def friction(self) -> strainwave.friction.Viscous | strainwave.friction.Coulomb | strainwave.friction.Stribeck | strainwave.friction.PositionDependent | strainwave.friction.LuGre | strainwave.friction.MaxwellSlipFriction | strainwave.friction.LoadDependent | strainwave.friction.MixedLubrication | strainwave.friction.CurvedViscous | strainwave.friction.AngleSpeedMap | strainwave.friction.TorqueEfficiency | strainwave.friction.Asymmetric | strainwave.friction.Cyclic | strainwave.friction.Thermal:
        """Law of all friction, at the input"""

    @property
    def friction_share(self) -> float:
        """Share rho of the friction that is supplied"""

    @property
    def bristle_gain(self) -> float:
        """Share k of the error that bends the bristles"""

    @property
    def position_gain(self) -> float:
        """Weight lambda of the error of the input angle [1/s]"""

    @property
    def gain(self) -> float:
        """
        Rate gamma of the scale per friction and error sigma; 0: constant scale [1/(N.m.rad)]
        """

    @property
    def min_scale(self) -> float:
        """Least scale s_min, of the friction of the law"""

    @property
    def max_scale(self) -> float:
        """Largest scale s_max"""

    @property
    def min_speed(self) -> float:
        """
        Slowest commanded input speed omega_min that determines the scale [rad/s]
        """

    @property
    def presliding(self) -> float:
        """
        Input angle over which the old sense of set-valued friction falls to 1/e [rad]
        """

    @property
    def temperature(self) -> float:
        """Temperature of the friction [K]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'bristle_observer'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

class NoDither:
    """
    No dither: no torque swings around zero.

    .. math:: \\tau_d = 0

    >>> from strainwave.compensation import NoDither
    >>> NoDither()
    NoDither()

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

    def replace(self, changes: dict[str, Any] = ..., /) -> NoDither:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'no_dither'

    source: str = 'definition'

    fields: tuple[dict[str, Any], ...]

    @property
    def active(self) -> bool:
        """Whether it makes any difference."""

class Dither:
    """
    Torque that swings around zero. The input does not rest, so its mean friction becomes smooth over the speed.

    .. math:: \\tau_d = A \\sin(2 \\pi \\varphi)\\, \\operatorname{sgn}(\\dot r), \\qquad \\dot\\varphi = f \\;\\text{ where } \\dot r \\ne 0

    with r the commanded output angle, A = amplitude, f = frequency. The phase stands still while the command rests. An inertia
    J with Coulomb friction F_c swings with the speed a = sqrt(A^2 - (4 F_c / pi)^2) / (2 pi f J). At a mean speed v its
    mean friction is (2 / pi) F_c asin(v / a) if v < a: about that of a viscous friction, in place of a jump. Choose A so
    that a exceeds the speeds at which the drive sticks.

    If A is at most 4 F_c / pi the input rests during a part of each period, and the formula does not hold.

    Keep f above the bandwidth of the speed loop and away from the vibrations of the drive. It must be below half of the sample
    rate.
    Dither heats the motor, wears the gear, and can be heard. It swings the input; the output follows with the share that gear
    and load let through.

    >>> from strainwave.compensation import Dither
    >>> Dither(amplitude=0.05, frequency=80.0).frequency
    80.0

    Parameters
    ----------
    amplitude: Amplitude A, of the motor [N.m], in [0, inf); default 0.0
    frequency: Frequency f [Hz], in (0, inf); default 50.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    ArmstrongHelouvry1994; mean of Coulomb friction, by the dual-input describing function: GelbVanderVelde1968
    """

    def __init__(self, *, amplitude: float = ..., frequency: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, amplitude: float = ..., frequency: float = ...) -> Dither:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def amplitude(self) -> float:
        """Amplitude A, of the motor [N.m]"""

    @property
    def frequency(self) -> float:
        """Frequency f [Hz]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'dither'

    source: str = ...

    fields: tuple[dict[str, Any], ...]
