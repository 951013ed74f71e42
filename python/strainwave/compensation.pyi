"""What takes away what the gear does to the motion."""

from collections.abc import Sequence
from typing import Any

import numpy
import numpy.typing

import strainwave._core
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
    What a model of the drive asks for so that the output moves as it is commanded, before any error.

    .. math:: T = J_{out} \\ddot r + T_{load}(r, \\dot r) + F_{out}, \\qquad \\delta: T_{gear}(\\delta, \\text{history}) = T, \\qquad
              \\theta = i\\,(r + e(\\theta) + \\delta)

    .. math:: \\tau = J_{in} \\ddot\\theta + (T + F_{mesh})\\,(1/i - e'(\\theta)) + F_{in}

    with r the commanded output angle, i the signed ratio, T the torque that the gear must transmit, delta its twist, e its
    kinematic error, theta the input angle that belongs to all that, J_in = motor_inertia + gear.input_inertia. The controller
    is given theta - i r as a lead of the input, and tau. ``gear`` and ``load`` are what is known of the drive: an effect
    that is left out of them is not compensated. The ratio of ``gear`` is that of the drive.

    theta is found by ``rounds`` rounds of theta <- i (r + e(theta) + delta), which converge if q = |i| max|e'| < 1: each
    leaves at most the share q of the error before. delta is found on the branch of the hysteresis that the command follows.
    Rates are differences over a period, so inertia comes half a period late. A set-valued friction acts in the sense s of
    the motion, which does not jump where the command turns back: ds = (sgn(d theta) - s) |d theta| / presliding, as a
    contact does that bends before it slides; laws with bristles have that of their own. friction_share takes part of all
    friction: less than 1 where the model may have too much of it, since friction compensated more than once drives by itself.

    Valid where the motion is slow against the vibration of load and gear. Leaves out damping of the spring, noise, bodies
    within the gear and the variation of the stiffness. The temperature is taken to be ``temperature``.

    >>> import strainwave as sw
    >>> gear = sw.Gear(friction_input=sw.friction.Coulomb(coulomb=0.05))
    >>> sw.compensation.ModelFeedforward(gear=gear, load=sw.loads.Inertia(inertia=0.1)).rounds
    4

    Parameters
    ----------
    gear: What is known of the gear; default Gear(kinematics=StrainWave(flexspline_teeth=200, circular_spline_teeth=202, fixed='circular_spline'), kinematic_error=Fourier(order=(), amplitude=(), phase=()), kinematic_noise=Stochastic(amplitude=0.0, lowest_order=8.0, highest_order=40.0, seed=0.0, load_sensitivity=0.0, speed_sensitivity=0.0, insertion_depth=0.0, depth_sensitivity=0.0), stiffness=Linear(k=10000.0), hysteresis=MaxwellSlip(stiffness=(), breakaway=()), damping=0.0, friction_input=Viscous(viscous=0.0), friction_mesh=Viscous(viscous=0.0), friction_output=Viscous(viscous=0.0), input_inertia=0.0, softening=ThermalSoftening(stiffness_fall=0.0, hysteresis_fall=0.0, reference_temperature=293.15), stiffness_variation=Constant(), structure=Lumped())
    load: What the output carries; default Inertia(inertia=0.01)
    motor_inertia: Inertia of the motor's rotor [kg.m2], in [0, inf); default 0.0
    presliding: Input angle over which the old sense of set-valued friction falls to 1/e [rad], in (0, inf); default 0.002
    friction_share: Share of the friction that is asked for, in [0, 1]; default 1.0
    rounds: Rounds in which the kinematic error is found; 0 leaves it out, in [0, 8]; default 4
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
        """What is known of the gear"""

    @property
    def load(self) -> strainwave.loads.Inertia | strainwave.loads.Pendulum | strainwave.loads.TorsionSpring | strainwave.loads.Aerodynamic | strainwave.loads.TorqueTable | strainwave.loads.Brake | strainwave.loads.Prescribed:
        """What the output carries"""

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
        """Share of the friction that is asked for"""

    @property
    def rounds(self) -> int:
        """Rounds in which the kinematic error is found; 0 leaves it out"""

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
    Lost motion as it was measured: how far the input must lead, over the output angle, for each sense of motion.

    .. math:: \\theta = i\\,\\Big(r + \\tfrac{1 + s}{2} f(r) + \\tfrac{1 - s}{2} b(r)\\Big), \\qquad
              ds = (\\operatorname{sgn}(dr) - s)\\, \\frac{|dr|}{r_0}

    with r the commanded output angle, f and b the lines through forward and backward over angle, which rises; beyond its ends
    they stay as they are there. s is the sense of motion, r_0 = reach: so far after a reversal 1/e of the lost motion is
    left to take up; before the first motion s = 0, the middle of both. It needs no model, and knows nothing of load and speed.

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
    No learning: what repeats with the angle is not corrected.

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
    Learning of what repeats as the wave generator turns: one sine and one cosine for each order.

    .. math:: \\hat e = \\sum_n a_n \\sin n\\theta + b_n \\cos n\\theta, \\qquad
              \\dot a_n = \\gamma\\, (r - \\theta_{out}) \\sin(n\\theta - \\varphi_n), \\quad
              \\dot b_n = \\gamma\\, (r - \\theta_{out}) \\cos(n\\theta - \\varphi_n), \\qquad \\varphi_n = n\\, \\omega\\, t_{lag}

    with theta the input angle, r the commanded and theta_out the measured output angle, gamma = gain, t_lag = lag, which the
    position loop takes to follow. The input leads by i e^. Where the loop follows waves of order n with P(j n omega), a
    constant error of that order decays as exp(-gamma/2 |P| cos(Delta) t), Delta the angle between P and exp(-j phi_n): it
    grows beyond 90 degrees, so learning stands still where n |omega| exceeds ``max_frequency``, and where omega is below
    ``min_speed``. No sine and no cosine exceeds ``limit``. The encoder of the output must see the error; one that errs itself is learnt.

    >>> from strainwave.compensation import AdaptiveFourier
    >>> AdaptiveFourier(order=[1, 2]).gain
    5.0

    Parameters
    ----------
    order: Orders n: periods per revolution of the input, in (0, inf); default ()
    gain: Rate gamma at which the amplitudes follow the error [1/s], in [0, inf); default 5.0
    lag: Time t_lag that the position loop takes to follow [s], in [0, inf); default 0.0
    min_speed: Input speed below which it does not learn [rad/s], in [0, inf); default 1.0
    max_frequency: Frequency n |omega| of a wave above which it does not learn [rad/s], in (0, inf); default 100.0
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
        """Orders n: periods per revolution of the input"""

    @property
    def gain(self) -> float:
        """Rate gamma at which the amplitudes follow the error [1/s]"""

    @property
    def lag(self) -> float:
        """Time t_lag that the position loop takes to follow [s]"""

    @property
    def min_speed(self) -> float:
        """Input speed below which it does not learn [rad/s]"""

    @property
    def max_frequency(self) -> float:
        """Frequency n |omega| of a wave above which it does not learn [rad/s]"""

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
    Learning of whatever repeats with every turn of the wave generator, of any shape: a table over the input angle.

    .. math:: \\hat e(\\theta) = \\sum_j c_j\\, w_j(\\theta), \\qquad \\dot c_j = \\gamma\\, w_j(\\theta - \\omega\\, t_{lag})\\,
              (r - \\theta_{out}) - \\sigma\\, w_j(\\theta)\\,\\big(c_j - \\tfrac{1}{2}(c_{j-1} + c_{j+1})\\big)

    with w_j the hat functions of 32 equal cells of a turn, gamma = gain, sigma = smoothing: the filter Q, which takes away what
    changes from cell to cell, t_lag = lag of the position loop. The input leads by i e^. It learns where the input speed lies
    between ``min_speed`` and ``max_speed``, at which a wave of the highest order learnt may lag by no more than 90 degrees; no value
    exceeds ``limit``. Orders above 8 are learnt in part only, and what does not repeat with the input, as the second harmonic
    of the other spline, not at all: AdaptiveFourier takes any order.

    >>> from strainwave.compensation import Repetitive
    >>> Repetitive(gain=10.0).limit
    0.001

    Parameters
    ----------
    gain: Rate gamma at which a cell follows the error [1/s], in [0, inf); default 5.0
    smoothing: Rate sigma at which a cell follows its neighbours [1/s], in [0, inf); default 0.0
    lag: Time t_lag that the position loop takes to follow [s], in [0, inf); default 0.0
    min_speed: Input speed below which it does not learn [rad/s], in [0, inf); default 1.0
    max_speed: Input speed above which it does not learn [rad/s], in (0, inf); default 30.0
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
        """Time t_lag that the position loop takes to follow [s]"""

    @property
    def min_speed(self) -> float:
        """Input speed below which it does not learn [rad/s]"""

    @property
    def max_speed(self) -> float:
        """Input speed above which it does not learn [rad/s]"""

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

class NoObserver:
    """
    No observer: what disturbs the drive is not estimated.

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
    Observer of the torque that the drive needs beyond what controller and model expect, and gives at once.

    .. math:: \\hat d = \\frac{g}{s + g}\\,\\big(\\tau - \\tau_f - J s\\,(\\omega - \\omega_r)\\big), \\qquad
              \\tau \\leftarrow \\tau + \\operatorname{clip}(\\hat d, \\pm d_{max})

    with tau the torque of the motor, tau_f what is fed forward, omega the input speed, omega_r the commanded one, J = inertia of
    all that turns with the input, g = bandwidth, d_max = limit. Without a model it supplies friction, load and the torque of
    acceleration; with one, what the model lacks. The filter is exact for what is constant over a period.

    tau is what the motor is given, or, with a torque_constant, that times the current measured: for a Cascade, whose actuation
    is a voltage. What a law of control feeds forward by gains of its own is not in tau_f, so the observer supplies it once
    more: set viscous_feedforward and coulomb_feedforward of the law to 0, and let the compensation have the friction. With a
    period T and a real inertia J_r of what turns, the observer alone is stable if g T J / J_r < 2; above the vibration of the
    load, J_r is the inertia of the input. A bandwidth near that vibration makes it grow.

    >>> from strainwave.compensation import DisturbanceObserver
    >>> DisturbanceObserver(inertia=2e-4, bandwidth=150.0, limit=0.3).bandwidth
    150.0

    Parameters
    ----------
    inertia: Inertia J at the input: rotor, wave generator, and load over ratio squared [kg.m2], in (0, inf); required
    bandwidth: Bandwidth g of the filter [rad/s], in (0, inf); default 100.0
    limit: Largest torque that it adds [N.m], in [0, inf); required
    torque_constant: Torque per current measured; 0: by what the motor is given [N.m/A], in [0, inf); default 0.0

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
        """Torque per current measured; 0: by what the motor is given [N.m/A]"""

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
    Observer of how much more or less friction there is than a model has: it wears, warms up, cools down.

    .. math:: \\tau \\leftarrow \\tau + (\\hat s - 1) F, \\qquad \\dot{\\hat s} = \\gamma F \\sigma
              \\;\\text{ where } |\\omega_r| \\ge \\omega_{min}, \\qquad \\hat s \\in [s_{min}, s_{max}], \\qquad
              \\sigma = \\omega_r - \\omega + \\lambda\\, (\\theta_r - \\theta)

    with F the friction of the feed-forward, theta_r, omega_r and theta, omega the input angle and speed commanded
    and measured, gamma = gain, lambda = position_gain, that of the position loop, omega_min = min_speed,
    s_min, s_max = min_scale, max_scale. Where the loop gives k sigma, and the inertia J at the input is at most k / lambda, the function
    J (sigma^2 + lambda^2 (theta_r - theta)^2) + (s - s^)^2 / gamma never grows, whatever the gain; with a delay in the loop it
    must be small. By the speed alone, lambda = 0, a motion of one sense under a position loop does not determine s. Below
    omega_min it stands still: rest does not determine s, and around a reversal the error is that of the presliding.

    >>> from strainwave.compensation import FrictionScale
    >>> FrictionScale(gain=5.0).max_scale
    1.5

    Parameters
    ----------
    gain: Rate gamma of the scale per friction and error sigma [1/(N.m.rad)], in [0, inf); default 1.0
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
