"""What turns the command into the motor's voltage, current or torque."""

from collections.abc import Sequence
from typing import Any

import strainwave._core
import strainwave.loads


class OpenLoop:
    """
    No controller: the command, times a gain, is what the motor takes.

    .. math:: u = g r

    with r the command, u the voltage [V] of a DC, a BrushlessDC or a PMSM, the current [A] of a CurrentSource, the torque
    [N.m] of a TorqueSource or the acceleration [rad/s2] of an AccelerationSource, g = gain (an amplifier's). The command has the unit of u.

    >>> from strainwave.control import OpenLoop
    >>> OpenLoop().gain
    1.0

    Parameters
    ----------
    gain: Actuation per command; default 1.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition
    """

    def __init__(self, *, gain: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, gain: float = ...) -> OpenLoop:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def gain(self) -> float:
        """Actuation per command"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'open_loop'

    source: str = 'definition'

    fields: tuple[dict[str, Any], ...]

class PID:
    """
    Position controller: proportional, integral, derivative, with a limit.

    .. math:: u = \\operatorname{clip}(k_p \\epsilon + k_i \\textstyle\\int \\epsilon\\,dt + k_d \\dot\\epsilon, \\pm u_{max}), \\qquad
              \\epsilon = i r - \\theta_{in} \\text{ or } \\epsilon = i\\,(r - \\theta_{out})

    with r the commanded output angle [rad], i the signed ratio, k_p = proportional, k_i = integral, k_d = derivative,
    u_max = limit. The error is that of the encoder which feedback names. Where it is the motor's, on the input shaft,
    kinematic error and wind-up of the gear stay outside the loop. Where it is on the output shaft the loop sees them; the
    error is referred to the input, so that the gains mean the same. What leads the integral further beyond what limit or
    motor allow fades, and is nothing a twentieth of that range beyond.

    u is a voltage, and the units below are those, of a motor that takes one. For a motor that takes a current or a torque
    read A or N.m in place of V.

    >>> from strainwave.control import PID
    >>> PID(proportional=2.0, derivative=0.05, limit=48.0).integral
    0.0

    Parameters
    ----------
    proportional: Voltage per input angle [V/rad], in [0, inf); default 1.0
    integral: Voltage per integral of the input angle error [V/(rad.s)], in [0, inf); default 0.0
    derivative: Voltage per input speed error [V.s/rad], in [0, inf); default 0.0
    limit: Largest voltage, of either sign [V], in (0, inf); default 48.0
    feedback: The shaft whose encoder the loop closes on, one of ('input', 'output'); default 'input'

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    AstromHagglund1995, chapter 3; anti-windup by conditional integration, section 3.5
    """

    def __init__(self, *, proportional: float = ..., integral: float = ..., derivative: float = ..., limit: float = ..., feedback: str = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, proportional: float = ..., integral: float = ..., derivative: float = ..., limit: float = ..., feedback: str = ...) -> PID:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def proportional(self) -> float:
        """Voltage per input angle [V/rad]"""

    @property
    def integral(self) -> float:
        """Voltage per integral of the input angle error [V/(rad.s)]"""

    @property
    def derivative(self) -> float:
        """Voltage per input speed error [V.s/rad]"""

    @property
    def limit(self) -> float:
        """Largest voltage, of either sign [V]"""

    @property
    def feedback(self) -> str:
        """The shaft whose encoder the loop closes on"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'pid'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

class PI:
    """
    Speed controller: proportional and integral.

    .. math:: u = \\operatorname{clip}(k_p \\epsilon + k_i \\textstyle\\int \\epsilon\\,dt, \\pm u_{max}), \\qquad
              \\epsilon = i r - \\omega_{in} \\text{ or } \\epsilon = i\\,(r - \\omega_{out})

    with r the commanded output speed [rad/s], i the signed ratio, k_p = proportional, k_i = integral, u_max = limit. The error
    is that of the shaft which feedback names, referred to the input. What leads the integral further beyond what limit or
    motor allow fades, and is nothing a twentieth of that range beyond.

    u is a voltage, and the units below are those, of a motor that takes one. For a motor that takes a current or a torque
    read A or N.m in place of V.

    >>> from strainwave.control import PI
    >>> PI(proportional=0.2, integral=5.0).limit
    48.0

    Parameters
    ----------
    proportional: Voltage per error of the input speed [V.s/rad], in [0, inf); default 0.1
    integral: Voltage per integral of the error of the input speed [V/rad], in [0, inf); default 0.0
    limit: Largest voltage, of either sign [V], in (0, inf); default 48.0
    feedback: The shaft whose speed the loop closes on, one of ('input', 'output'); default 'input'

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    AstromHagglund1995, chapter 3; anti-windup by conditional integration, section 3.5
    """

    def __init__(self, *, proportional: float = ..., integral: float = ..., limit: float = ..., feedback: str = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, proportional: float = ..., integral: float = ..., limit: float = ..., feedback: str = ...) -> PI:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def proportional(self) -> float:
        """Voltage per error of the input speed [V.s/rad]"""

    @property
    def integral(self) -> float:
        """Voltage per integral of the error of the input speed [V/rad]"""

    @property
    def limit(self) -> float:
        """Largest voltage, of either sign [V]"""

    @property
    def feedback(self) -> str:
        """The shaft whose speed the loop closes on"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'pi'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

class PositionSpeed:
    """
    Position loop around a speed loop, for motors that take a current or a torque.

    .. math:: \\omega_r = \\operatorname{clip}(k_p \\epsilon + f\\, i \\dot r, \\pm \\omega_{max}), \\qquad
              u = \\operatorname{clip}(k_s (\\omega_r - \\omega) + k_i \\textstyle\\int (\\omega_r - \\omega)\\,dt
              + b\\, i \\dot r + c \\operatorname{sgn}(i \\dot r), \\pm u_{max})

    with r the commanded output angle, i the signed ratio, omega the input speed, epsilon the error of the angle, referred to the
    input: that of the input shaft, i r - theta_in, or of the output shaft, i (r - theta_out), as feedback names it.
    k_p = position_gain, k_s = speed_proportional, k_i = speed_integral, f, b, c = speed_, viscous_ and coulomb_feedforward,
    omega_max = speed_limit, u_max = limit. What leads the integral further beyond what limit or motor allow fades, and is
    nothing a twentieth of that range beyond.

    u is a current, and the units below are those, of a motor that takes one. For a motor that takes a torque or a voltage
    read N.m or V in place of A.

    >>> from strainwave.control import PositionSpeed
    >>> PositionSpeed(position_gain=30.0, speed_proportional=0.1, speed_integral=2.0).speed_limit
    500.0

    Parameters
    ----------
    position_gain: Input speed per error of the input angle [1/s], in [0, inf); default 20.0
    speed_proportional: Current per error of the input speed [A.s/rad], in [0, inf); default 0.05
    speed_integral: Current per integral of the error of the input speed [A/rad], in [0, inf); default 0.0
    speed_limit: Largest input speed that is asked for [rad/s], in (0, inf); default 500.0
    limit: Largest current, of either sign [A], in (0, inf); default 10.0
    speed_feedforward: Share of the commanded speed that is asked for without any error; default 0.0
    viscous_feedforward: Current per commanded input speed [A.s/rad]; default 0.0
    coulomb_feedforward: Current in the sense of the commanded speed [A]; default 0.0
    feedback: The shaft whose encoder the position loop closes on, one of ('input', 'output'); default 'input'

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    GrossHamannWiegaertner2001, cascade of position and speed; anti-windup by conditional integration: AstromHagglund1995, section 3.5
    """

    def __init__(self, *, position_gain: float = ..., speed_proportional: float = ..., speed_integral: float = ..., speed_limit: float = ..., limit: float = ..., speed_feedforward: float = ..., viscous_feedforward: float = ..., coulomb_feedforward: float = ..., feedback: str = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, position_gain: float = ..., speed_proportional: float = ..., speed_integral: float = ..., speed_limit: float = ..., limit: float = ..., speed_feedforward: float = ..., viscous_feedforward: float = ..., coulomb_feedforward: float = ..., feedback: str = ...) -> PositionSpeed:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def position_gain(self) -> float:
        """Input speed per error of the input angle [1/s]"""

    @property
    def speed_proportional(self) -> float:
        """Current per error of the input speed [A.s/rad]"""

    @property
    def speed_integral(self) -> float:
        """Current per integral of the error of the input speed [A/rad]"""

    @property
    def speed_limit(self) -> float:
        """Largest input speed that is asked for [rad/s]"""

    @property
    def limit(self) -> float:
        """Largest current, of either sign [A]"""

    @property
    def speed_feedforward(self) -> float:
        """Share of the commanded speed that is asked for without any error"""

    @property
    def viscous_feedforward(self) -> float:
        """Current per commanded input speed [A.s/rad]"""

    @property
    def coulomb_feedforward(self) -> float:
        """Current in the sense of the commanded speed [A]"""

    @property
    def feedback(self) -> str:
        """The shaft whose encoder the position loop closes on"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'position_speed'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

class Cascade:
    """
    Position loop around a speed loop around a current loop, for motors that take a voltage.

    .. math:: u = \\operatorname{clip}(k_c (i_r - i_m) + k_{ci} \\textstyle\\int (i_r - i_m)\\,dt + K \\omega, \\pm u_{max})

    with i_r what the loops of PositionSpeed ask for, limited to current_limit, i_m the measured current, omega the measured input
    speed, k_c = current_proportional, k_ci = current_integral, K = back_emf_feedforward, u_max = voltage_limit. The motor
    hands back what it can follow. Where u_max or the motor limits the voltage, neither integral leads further beyond; where
    the current is limited the integral of the speed does not. It fades there as that of PI.

    A current loop of the bandwidth w [rad/s] around resistance R and inductance L has k_c = L w and k_ci = R w. The motor must
    have an inductance, or the controller must be sampled: else voltage and current would determine each other at once.

    >>> from strainwave.control import Cascade
    >>> law = Cascade(position_gain=30.0, speed_proportional=0.1, speed_integral=2.0, current_proportional=2.0)
    >>> law.current_limit
    10.0

    Parameters
    ----------
    position_gain: Input speed per error of the input angle [1/s], in [0, inf); default 20.0
    speed_proportional: Current per error of the input speed [A.s/rad], in [0, inf); default 0.05
    speed_integral: Current per integral of the error of the input speed [A/rad], in [0, inf); default 0.0
    current_proportional: Voltage per error of the current [V/A], in [0, inf); default 1.0
    current_integral: Voltage per integral of the error of the current [V/(A.s)], in [0, inf); default 0.0
    speed_limit: Largest input speed that is asked for [rad/s], in (0, inf); default 500.0
    current_limit: Largest current that is asked for, of either sign [A], in (0, inf); default 10.0
    voltage_limit: Largest voltage, of either sign [V], in (0, inf); default 48.0
    speed_feedforward: Share of the commanded speed that is asked for without any error; default 0.0
    viscous_feedforward: Current per commanded input speed [A.s/rad]; default 0.0
    coulomb_feedforward: Current in the sense of the commanded speed [A]; default 0.0
    back_emf_feedforward: Voltage per input speed, as the back-EMF takes it [V.s/rad]; default 0.0
    feedback: The shaft whose encoder the position loop closes on, one of ('input', 'output'); default 'input'

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    GrossHamannWiegaertner2001, cascade of position, speed and current; anti-windup by conditional integration: AstromHagglund1995, section 3.5
    """

    def __init__(self, *, position_gain: float = ..., speed_proportional: float = ..., speed_integral: float = ..., current_proportional: float = ..., current_integral: float = ..., speed_limit: float = ..., current_limit: float = ..., voltage_limit: float = ..., speed_feedforward: float = ..., viscous_feedforward: float = ..., coulomb_feedforward: float = ..., back_emf_feedforward: float = ..., feedback: str = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, position_gain: float = ..., speed_proportional: float = ..., speed_integral: float = ..., current_proportional: float = ..., current_integral: float = ..., speed_limit: float = ..., current_limit: float = ..., voltage_limit: float = ..., speed_feedforward: float = ..., viscous_feedforward: float = ..., coulomb_feedforward: float = ..., back_emf_feedforward: float = ..., feedback: str = ...) -> Cascade:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def position_gain(self) -> float:
        """Input speed per error of the input angle [1/s]"""

    @property
    def speed_proportional(self) -> float:
        """Current per error of the input speed [A.s/rad]"""

    @property
    def speed_integral(self) -> float:
        """Current per integral of the error of the input speed [A/rad]"""

    @property
    def current_proportional(self) -> float:
        """Voltage per error of the current [V/A]"""

    @property
    def current_integral(self) -> float:
        """Voltage per integral of the error of the current [V/(A.s)]"""

    @property
    def speed_limit(self) -> float:
        """Largest input speed that is asked for [rad/s]"""

    @property
    def current_limit(self) -> float:
        """Largest current that is asked for, of either sign [A]"""

    @property
    def voltage_limit(self) -> float:
        """Largest voltage, of either sign [V]"""

    @property
    def speed_feedforward(self) -> float:
        """Share of the commanded speed that is asked for without any error"""

    @property
    def viscous_feedforward(self) -> float:
        """Current per commanded input speed [A.s/rad]"""

    @property
    def coulomb_feedforward(self) -> float:
        """Current in the sense of the commanded speed [A]"""

    @property
    def back_emf_feedforward(self) -> float:
        """Voltage per input speed, as the back-EMF takes it [V.s/rad]"""

    @property
    def feedback(self) -> str:
        """The shaft whose encoder the position loop closes on"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'cascade'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

class LeadLag:
    """
    Position controller of two sections, one to lead and one to lag.

    .. math:: u = \\operatorname{clip}\\left(k\\, \\frac{1 + a_1 s}{1 + b_1 s}\\, \\frac{1 + a_2 s}{1 + b_2 s}\\, \\epsilon,
              \\pm u_{max}\\right)

    with epsilon the error of the angle, referred to the input, of the shaft which feedback names: i r - theta_in or
    i (r - theta_out); k = gain, a_1, b_1 = lead_numerator, lead_denominator, a_2, b_2 = lag_numerator, lag_denominator,
    u_max = limit. The first leads where a_1 > b_1, the second lags where a_2 < b_2; either may do either. Both sections
    begin at rest. Steps of a fixed length must not be longer than 2.5 times the shorter of b_1 and b_2, unless the controller
    is sampled: then the first section is exact for an error that is held over a period. The second takes what the first gives at
    the begin of each period as constant over it, of first order in the period.

    u is a voltage, and the units below are those, of a motor that takes one. For a motor that takes a current or a torque
    read A or N.m in place of V.

    >>> from strainwave.control import LeadLag
    >>> LeadLag(gain=2.0, lead_numerator=0.02, lead_denominator=0.002).limit
    48.0

    Parameters
    ----------
    gain: Voltage per error of the input angle, at rest [V/rad], in [0, inf); default 1.0
    lead_numerator: Time constant a_1 [s], in [0, inf); default 0.05
    lead_denominator: Time constant b_1 [s], in (0, inf); default 0.005
    lag_numerator: Time constant a_2 [s], in [0, inf); default 1.0
    lag_denominator: Time constant b_2 [s], in (0, inf); default 1.0
    limit: Largest voltage, of either sign [V], in (0, inf); default 48.0
    feedback: The shaft whose encoder the loop closes on, one of ('input', 'output'); default 'input'

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    FranklinPowellEmamiNaeini2002, section 6.7
    """

    def __init__(self, *, gain: float = ..., lead_numerator: float = ..., lead_denominator: float = ..., lag_numerator: float = ..., lag_denominator: float = ..., limit: float = ..., feedback: str = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, gain: float = ..., lead_numerator: float = ..., lead_denominator: float = ..., lag_numerator: float = ..., lag_denominator: float = ..., limit: float = ..., feedback: str = ...) -> LeadLag:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def gain(self) -> float:
        """Voltage per error of the input angle, at rest [V/rad]"""

    @property
    def lead_numerator(self) -> float:
        """Time constant a_1 [s]"""

    @property
    def lead_denominator(self) -> float:
        """Time constant b_1 [s]"""

    @property
    def lag_numerator(self) -> float:
        """Time constant a_2 [s]"""

    @property
    def lag_denominator(self) -> float:
        """Time constant b_2 [s]"""

    @property
    def limit(self) -> float:
        """Largest voltage, of either sign [V]"""

    @property
    def feedback(self) -> str:
        """The shaft whose encoder the loop closes on"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'lead_lag'

    source: str = 'FranklinPowellEmamiNaeini2002, section 6.7'

    fields: tuple[dict[str, Any], ...]

class StateFeedback:
    """
    Position controller that feeds back all that is measured, each with a gain of its own.

    .. math:: u = \\operatorname{clip}\\big(k_1 (i r - \\theta_{in}) + k_2 (i \\dot r - \\omega_{in}) + k_3 (r - \\theta_{out})
              + k_4 (\\dot r - \\omega_{out}) - k_5 i_m - k_6 T, \\pm u_{max}\\big)

    with r the commanded output angle, i the signed ratio, i_m the current, T the torque transmitted, k_1 to k_6 = input_angle,
    input_speed, output_angle, output_speed, current, torque, u_max = limit. ``sw.linearise`` gives the matrices from which the
    gains follow, by placing poles or as a linear-quadratic regulator.

    u is a voltage, and the units below are those, of a motor that takes one. For a motor that takes a current or a torque
    read A or N.m in place of V.

    >>> from strainwave.control import StateFeedback
    >>> StateFeedback(input_angle=2.0, input_speed=0.05, torque=0.01).limit
    48.0

    Parameters
    ----------
    input_angle: Voltage per error k_1 of the input angle [V/rad]; default 0.0
    input_speed: Voltage per error k_2 of the input speed [V.s/rad]; default 0.0
    output_angle: Voltage per error k_3 of the output angle [V/rad]; default 0.0
    output_speed: Voltage per error k_4 of the output speed [V.s/rad]; default 0.0
    current: Voltage k_5 taken away per current [V/A]; default 0.0
    torque: Voltage k_6 taken away per torque transmitted [V/(N.m)]; default 0.0
    limit: Largest voltage, of either sign [V], in (0, inf); default 48.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    FranklinPowellEmamiNaeini2002, section 7.5
    """

    def __init__(self, *, input_angle: float = ..., input_speed: float = ..., output_angle: float = ..., output_speed: float = ..., current: float = ..., torque: float = ..., limit: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, input_angle: float = ..., input_speed: float = ..., output_angle: float = ..., output_speed: float = ..., current: float = ..., torque: float = ..., limit: float = ...) -> StateFeedback:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def input_angle(self) -> float:
        """Voltage per error k_1 of the input angle [V/rad]"""

    @property
    def input_speed(self) -> float:
        """Voltage per error k_2 of the input speed [V.s/rad]"""

    @property
    def output_angle(self) -> float:
        """Voltage per error k_3 of the output angle [V/rad]"""

    @property
    def output_speed(self) -> float:
        """Voltage per error k_4 of the output speed [V.s/rad]"""

    @property
    def current(self) -> float:
        """Voltage k_5 taken away per current [V/A]"""

    @property
    def torque(self) -> float:
        """Voltage k_6 taken away per torque transmitted [V/(N.m)]"""

    @property
    def limit(self) -> float:
        """Largest voltage, of either sign [V]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'state_feedback'

    source: str = 'FranklinPowellEmamiNaeini2002, section 7.5'

    fields: tuple[dict[str, Any], ...]

class StateSpace:
    """
    Linear controller of up to eight states and eight inputs, designed in another tool.

    .. math:: \\dot x = A x + B y + l\\,(u - v), \\qquad v = C x + D y + u_f, \\qquad u = \\operatorname{clip}(v, \\pm u_{max})

    .. math:: y = \\big(i r - \\theta_{in},\\; i \\dot r - \\omega_{in},\\; r - \\theta_{out},\\; \\dot r - \\omega_{out},\\;
              i_m,\\; T,\\; r,\\; \\dot r\\big)

    with r the commanded output angle, i the signed ratio, i_m the current, T the torque transmitted, u_f the feed-forward of a
    compensation, l = tracking, u_max = limit or what the motor limits. C has one element for each state. D has one element for each
    input: the controller takes the first inputs of y, and D determines how many. A and B are written row by row, one row for each
    state. The states begin at 0. An angle error counts from the input lead of the compensation, as in StateFeedback.

    In ``control.Sampled`` the states go forward by Euler, x + T (A x + B y). A controller of discrete time, x + = A_d x + B_d y, has
    A = (A_d - 1)/T and B = B_d/T, and the same C and D. It is then exact.

    Where the output is limited, ``tracking`` leads the states. An observer that contains C takes the actuation limited with l =
    the input matrix of its model. A PI controller takes l = 1/(C t), with t its tracking time. Without tracking an integral winds up.

    u is a voltage, and the units of a motor that takes one. For a motor that takes a current or a torque read A or N.m in place of V.

    >>> from strainwave.control import StateSpace
    >>> pi = StateSpace(A=[0.0], B=[1.0], C=[3.0], D=[0.5], tracking=[10.0], limit=10.0)
    >>> pi.C
    (3.0,)

    Parameters
    ----------
    A: Rates of the states per state, row by row [1/s]; default ()
    B: Rates of the states per input, row by row; default ()
    C: Output per state; default ()
    D: Output per input; its length is the number of inputs; default ()
    tracking: Rates l of the states per output beyond its limit; none if empty; default ()
    limit: Largest voltage, of either sign [V], in (0, inf); default 48.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    FranklinPowellEmamiNaeini2002, chapter 7; anti-windup by tracking of the limited output: AstromWittenmark1997, section 9.4
    """

    def __init__(self, *, A: float | Sequence[float] = ..., B: float | Sequence[float] = ..., C: float | Sequence[float] = ..., D: float | Sequence[float] = ..., tracking: float | Sequence[float] = ..., limit: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, A: float | Sequence[float] = ..., B: float | Sequence[float] = ..., C: float | Sequence[float] = ..., D: float | Sequence[float] = ..., tracking: float | Sequence[float] = ..., limit: float = ...) -> StateSpace:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def A(self) -> tuple[float, ...]:
        """Rates of the states per state, row by row [1/s]"""

    @property
    def B(self) -> tuple[float, ...]:
        """Rates of the states per input, row by row"""

    @property
    def C(self) -> tuple[float, ...]:
        """Output per state"""

    @property
    def D(self) -> tuple[float, ...]:
        """Output per input; its length is the number of inputs"""

    @property
    def tracking(self) -> tuple[float, ...]:
        """Rates l of the states per output beyond its limit; none if empty"""

    @property
    def limit(self) -> float:
        """Largest voltage, of either sign [V]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'state_space'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

class FeedbackLinearisation:
    """
    Position controller of a flexible joint that makes the output obey a linear equation of fourth order, however large its motion.

    .. math:: \\delta = \\theta/i - q - e(\\theta), \\qquad J \\ddot q = T(\\delta) - T_{load}(q, \\dot q), \\qquad
              \\dot\\delta = g\\,\\omega - \\dot q, \\qquad g = 1/i - e'(\\theta)

    .. math:: v = 4 w\\,(\\hat r^{(3)} - q^{(3)}) + 6 w^2 (\\hat{\\ddot r} - \\ddot q) + 4 w^3 (\\dot r - \\dot q) + w^4 (r - q)

    .. math:: \\ddot\\delta = \\frac{J v + \\ddot T_{load} - T''(\\delta)\\, \\dot\\delta^2}{T'(\\delta)}, \\qquad
              \\tau = J_{in}\\, \\frac{\\ddot\\delta + e''\\omega^2 + \\ddot q}{g} + g\\, T(\\delta), \\qquad
              u = \\operatorname{clip}(p\\,\\tau + b\\,\\omega + u_f, \\pm u_{max})

    with r the commanded output angle, theta, omega the measured input angle and speed, q the measured output angle, i the signed
    ratio, e the kinematic error, T the stiffness of ``gear``, J the inertia of ``load``, J_in = motor_inertia + gear.input_inertia,
    w = bandwidth, p = actuation_per_torque, b = actuation_per_speed (see ``Compensation``), u_f the feed-forward of a compensation,
    u_max = limit. If the model is exact and the limit is not reached, the output has four poles at -w. Its error obeys
    (d/dt + w)^4 (r - q) = r^(4) plus the error of the derivatives of r by the lags.

    It needs both encoders. The second and third derivative of the output follow from the twist. Those of the command come from two
    lags of the time reference_time, which must be at least the period of a sampled controller. Derivatives of load and stiffness over
    the motion are central differences over 0.01 / w, and e'' is one over 1 mrad of the input.

    A stiffness of the model of k times the real one moves the poles to those of

    .. math:: s^4 + 4 w s^3 + (6 w^2 - (k - 1)\\, \\Omega^2)\\, s^2 + (4 w^3 s + w^4)/k, \\qquad
              \\Omega^2 = \\frac{T'}{J} \\Big(1 + \\frac{J}{i^2 J_{in}}\\Big)

    Omega is the vibration of the joint with both ends free. With k above 1 the joint is stable only if w^2 exceeds
    (k - 1) Omega^2 / (5 - 1/k). If the stiffness is uncertain, use a smaller one.

    The law leaves out friction, damping and hysteresis of the gear, the relief of its kinematic error by load, and a brake of the
    load. Compensate the friction by a compensation. The law has no integral. A load torque d that the model lacks leaves the
    error (6/w^2 - T'/(J w^4)) d/J: its twist counts as acceleration. The law ignores the input leads of a compensation, because
    it contains gear and load. A ModelFeedforward for it must have the friction alone. If actuation_per_speed of the
    ``Compensation`` is not 0, set that of the law to 0: both add the back-EMF. The stiffness must be nowhere zero. Sensors and
    period must be fast against w. A large w amplifies noise by w^4.

    >>> import strainwave as sw
    >>> gear = sw.Gear(stiffness=sw.stiffness.Cubic(a1=1.2e4, a3=1e9))
    >>> sw.control.FeedbackLinearisation(gear=gear, load=sw.loads.Inertia(inertia=0.5), bandwidth=40.0).limit
    10.0

    Parameters
    ----------
    gear: Model of the gear; default Gear(kinematics=StrainWave(flexspline_teeth=200, circular_spline_teeth=202, fixed='circular_spline'), kinematic_error=Fourier(order=(), amplitude=(), phase=()), kinematic_noise=Stochastic(amplitude=0.0, lowest_order=8.0, highest_order=40.0, seed=0.0, load_sensitivity=0.0, speed_sensitivity=0.0, insertion_depth=0.0, depth_sensitivity=0.0), stiffness=Linear(k=10000.0), hysteresis=MaxwellSlip(stiffness=(), breakaway=()), damping=0.0, friction_input=Viscous(viscous=0.0), friction_mesh=Viscous(viscous=0.0), friction_output=Viscous(viscous=0.0), input_inertia=0.0, softening=ThermalSoftening(stiffness_fall=0.0, hysteresis_fall=0.0, reference_temperature=293.15), stiffness_variation=Constant(), structure=Lumped())
    load: Model of the load; default Inertia(inertia=0.01)
    motor_inertia: Inertia of the motor's rotor [kg.m2], in [0, inf); default 0.0001
    bandwidth: Magnitude w of the four poles of the output [rad/s], in [0.001, 100000]; default 50.0
    reference_time: Time of the lags that the derivatives of the command come from [s], in (0, inf); default 0.005
    actuation_per_torque: Actuation of the motor per torque, p [1/(N.m)], in (0, inf); default 1.0
    actuation_per_speed: Actuation of the motor per input speed, b: its back-EMF [s/rad]; default 0.0
    limit: Largest actuation, of either sign, in (0, inf); default 10.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    Spong1987, section 3, with the kinematic error and its reaction; document P, which asks for feedback linearisation
    """

    def __init__(self, *, gear: strainwave._core.Gear = ..., load: strainwave.loads.Inertia | strainwave.loads.Pendulum | strainwave.loads.TorsionSpring | strainwave.loads.Aerodynamic | strainwave.loads.TorqueTable | strainwave.loads.Brake | strainwave.loads.Prescribed = ..., motor_inertia: float = ..., bandwidth: float = ..., reference_time: float = ..., actuation_per_torque: float = ..., actuation_per_speed: float = ..., limit: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, gear: strainwave._core.Gear = ..., load: strainwave.loads.Inertia | strainwave.loads.Pendulum | strainwave.loads.TorsionSpring | strainwave.loads.Aerodynamic | strainwave.loads.TorqueTable | strainwave.loads.Brake | strainwave.loads.Prescribed = ..., motor_inertia: float = ..., bandwidth: float = ..., reference_time: float = ..., actuation_per_torque: float = ..., actuation_per_speed: float = ..., limit: float = ...) -> FeedbackLinearisation:
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
    def bandwidth(self) -> float:
        """Magnitude w of the four poles of the output [rad/s]"""

    @property
    def reference_time(self) -> float:
        """Time of the lags that the derivatives of the command come from [s]"""

    @property
    def actuation_per_torque(self) -> float:
        """Actuation of the motor per torque, p [1/(N.m)]"""

    @property
    def actuation_per_speed(self) -> float:
        """Actuation of the motor per input speed, b: its back-EMF [s/rad]"""

    @property
    def limit(self) -> float:
        """Largest actuation, of either sign"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'feedback_linearisation'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

class KinematicErrorTracking:
    """
    Position controller of a stiff gear with kinematic error, whose output converges although the ratio varies as the input turns.

    .. math:: q = \\theta/i - e(\\theta), \\qquad g = 1/i - e'(\\theta), \\qquad M = J_{in} + J g^2, \\qquad
              M \\dot\\omega + \\tfrac{1}{2} M' \\omega^2 = \\tau - g\\, T_{load}

    .. math:: \\omega_r = \\frac{\\dot r + \\lambda (r - q)}{g}, \\qquad s = \\omega - \\omega_r, \\qquad
              \\tau = M \\dot\\omega_r + \\tfrac{1}{2} M' \\omega\\, \\omega_r + g\\, T_{load} - K s

    with r the commanded output angle, theta, omega the measured input angle and speed, i the signed ratio, e the kinematic error of
    ``gear``, J and T_load inertia and torque of ``load``, J_in = motor_inertia + gear.input_inertia, lambda = bandwidth,
    K = speed_gain. q is the measured output angle, or that of the equation where ``feedback`` names the input.
    The actuation is clip(p tau + b omega + u_f, limit) as that of FeedbackLinearisation.

    M' comes from e'', a difference over 1 mrad of the input. V = M s^2 / 2 obeys dV/dt = -K s^2 if the gear is rigid and the model
    exact. Then s falls at the rate K / M, and the error r - q at lambda. A torque d that the model lacks leaves |s| up to |d| / K, and
    an error up to g |d| / (K lambda). A slope e' that is wrong by D leaves an error up to D omega / lambda. The acceleration of
    the command comes from a lag of the time reference_time, which must be at least the period of a sampled controller.

    The law leaves out torsion: K / M must be well below the vibration of load and gear. It leaves out friction: compensate it by a
    compensation, whose input leads the law ignores. It has no integral. If actuation_per_speed of the ``Compensation`` is not 0,
    set that of the law to 0: both add the back-EMF.

    >>> import strainwave as sw
    >>> error = sw.kinematic_error.Fourier(order=[2.0], amplitude=[3e-4], phase=[0.0])
    >>> law = sw.control.KinematicErrorTracking(gear=sw.Gear(kinematic_error=error), load=sw.loads.Inertia(inertia=0.5))
    >>> law.bandwidth
    20.0

    Parameters
    ----------
    gear: Model of the gear; default Gear(kinematics=StrainWave(flexspline_teeth=200, circular_spline_teeth=202, fixed='circular_spline'), kinematic_error=Fourier(order=(), amplitude=(), phase=()), kinematic_noise=Stochastic(amplitude=0.0, lowest_order=8.0, highest_order=40.0, seed=0.0, load_sensitivity=0.0, speed_sensitivity=0.0, insertion_depth=0.0, depth_sensitivity=0.0), stiffness=Linear(k=10000.0), hysteresis=MaxwellSlip(stiffness=(), breakaway=()), damping=0.0, friction_input=Viscous(viscous=0.0), friction_mesh=Viscous(viscous=0.0), friction_output=Viscous(viscous=0.0), input_inertia=0.0, softening=ThermalSoftening(stiffness_fall=0.0, hysteresis_fall=0.0, reference_temperature=293.15), stiffness_variation=Constant(), structure=Lumped())
    load: Model of the load; default Inertia(inertia=0.01)
    motor_inertia: Inertia of the motor's rotor [kg.m2], in [0, inf); default 0.0001
    bandwidth: Rate lambda at which the error of the output falls [1/s], in (0, inf); default 20.0
    speed_gain: Torque K per error s of the input speed [N.m.s/rad], in [0, inf); default 0.02
    reference_time: Time of the lag that the acceleration of the command comes from [s], in (0, inf); default 0.005
    actuation_per_torque: Actuation of the motor per torque, p [1/(N.m)], in (0, inf); default 1.0
    actuation_per_speed: Actuation of the motor per input speed, b: its back-EMF [s/rad]; default 0.0
    limit: Largest actuation, of either sign, in (0, inf); default 10.0
    feedback: The shaft whose encoder gives the output angle, one of ('input', 'output'); default 'output'

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    GandhiGhorbel2002, in the form of SlotineLi1991, section 9.1, with the load and the sign convention of this package
    """

    def __init__(self, *, gear: strainwave._core.Gear = ..., load: strainwave.loads.Inertia | strainwave.loads.Pendulum | strainwave.loads.TorsionSpring | strainwave.loads.Aerodynamic | strainwave.loads.TorqueTable | strainwave.loads.Brake | strainwave.loads.Prescribed = ..., motor_inertia: float = ..., bandwidth: float = ..., speed_gain: float = ..., reference_time: float = ..., actuation_per_torque: float = ..., actuation_per_speed: float = ..., limit: float = ..., feedback: str = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, gear: strainwave._core.Gear = ..., load: strainwave.loads.Inertia | strainwave.loads.Pendulum | strainwave.loads.TorsionSpring | strainwave.loads.Aerodynamic | strainwave.loads.TorqueTable | strainwave.loads.Brake | strainwave.loads.Prescribed = ..., motor_inertia: float = ..., bandwidth: float = ..., speed_gain: float = ..., reference_time: float = ..., actuation_per_torque: float = ..., actuation_per_speed: float = ..., limit: float = ..., feedback: str = ...) -> KinematicErrorTracking:
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
    def bandwidth(self) -> float:
        """Rate lambda at which the error of the output falls [1/s]"""

    @property
    def speed_gain(self) -> float:
        """Torque K per error s of the input speed [N.m.s/rad]"""

    @property
    def reference_time(self) -> float:
        """Time of the lag that the acceleration of the command comes from [s]"""

    @property
    def actuation_per_torque(self) -> float:
        """Actuation of the motor per torque, p [1/(N.m)]"""

    @property
    def actuation_per_speed(self) -> float:
        """Actuation of the motor per input speed, b: its back-EMF [s/rad]"""

    @property
    def limit(self) -> float:
        """Largest actuation, of either sign"""

    @property
    def feedback(self) -> str:
        """The shaft whose encoder gives the output angle"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'kinematic_error_tracking'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

class Sampled:
    """
    A controller that runs in a computer: it acts at instants and holds its output between them.

    .. math:: u(t) = u_k, \\quad t_k + d \\le t < t_{k+1} + d, \\qquad u_k = \\text{law}(x_k, r_k, y_k), \\qquad
              x_{k+1} = x_k + \\frac{1 - e^{-\\lambda T}}{\\lambda}\\, \\dot x_k

    with t_k = k T, T = period, d = delay (what computing takes, at most a period), r_k and y_k command and measurement at
    t_k, x_k the numbers of the law. An integral has lambda = 0, thus x_{k+1} = x_k + T dx_k/dt. A section of a LeadLag has
    lambda = 1 / b: over a period it moves as it does under a constant input, which its second section does not have: that one is
    of first order in T, as an integral is. Before the first output the actuation is 0. ``compensation`` adds to the command at each
    instant what it knows of the drive.
    Steps end at each t_k and each t_k + d, so what happens at an instant happens exactly there. The law is any that is not
    sampled itself.

    In an ensemble, period and delay are the same for all members. They have no derivatives: time is not among the numbers.

    >>> from strainwave.control import PID, Sampled
    >>> law = PID(proportional=2.0, derivative=0.05)
    >>> Sampled(law=law, period=1e-3, delay=2e-4).law.proportional
    2.0

    Parameters
    ----------
    law: What is worked out at each instant; default OpenLoop(gain=1.0)
    compensation: What is known of the drive, and asked for beside the error; default Compensation(feedforward=NoFeedforward(), learning=NoLearning(), observer=NoObserver(), dither=NoDither(), actuation_per_torque=1.0, actuation_per_speed=0.0)
    period: Time from one sample to the next [s], in (0, inf); default 0.001
    delay: Time from a sample to the output that is worked out from it [s], in [0, inf); default 0.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    AstromWittenmark1997, chapters 2 and 8: zero-order hold, integrals by forward differences, lags exactly for a constant input
    """

    def __init__(self, *, law: OpenLoop | PID | PI | PositionSpeed | Cascade | LeadLag | StateFeedback | StateSpace | FeedbackLinearisation | KinematicErrorTracking = ..., compensation: strainwave._core.Compensation = ..., period: float = ..., delay: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, law: OpenLoop | PID | PI | PositionSpeed | Cascade | LeadLag | StateFeedback | StateSpace | FeedbackLinearisation | KinematicErrorTracking = ..., compensation: strainwave._core.Compensation = ..., period: float = ..., delay: float = ...) -> Sampled:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def law(self) -> OpenLoop | PID | PI | PositionSpeed | Cascade | LeadLag | StateFeedback | StateSpace | FeedbackLinearisation | KinematicErrorTracking:
        """What is worked out at each instant"""

    @property
    def compensation(self) -> strainwave._core.Compensation:
        """What is known of the drive, and asked for beside the error"""

    @property
    def period(self) -> float:
        """Time from one sample to the next [s]"""

    @property
    def delay(self) -> float:
        """Time from a sample to the output that is worked out from it [s]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'sampled'

    source: str = ...

    fields: tuple[dict[str, Any], ...]
