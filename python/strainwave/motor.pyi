"""Motors on the input shaft."""

from typing import Any


class DC:
    """
    Armature-controlled DC motor.

    .. math:: L \\dot i = u - R i - K_b \\omega - V_b \\operatorname{sgn} i, \\qquad \\tau = K_m i + \\tau_c \\sin(n \\theta), \\qquad
              R = R_0\\,(1 + \\alpha\\,(T - 293.15\\,\\mathrm{K}))

    with u the voltage, omega the input speed, T the temperature of the winding, R_0 = resistance, L = inductance,
    K_m = torque_constant, K_b = back_emf, V_b = brush_drop, alpha = resistance_rise (0.00393 per kelvin for copper). With
    inductance = 0 the current follows at once, as document P assumes: i = (u - K_b omega) / R, and with a brush drop no
    current flows while abs(u - K_b omega) does not exceed it. A brush drop needs inductance = 0. Where K_b exceeds K_m the
    difference counts as lost, as iron losses do. It does so only while the motor drives: a motor with K_b > K_m that brakes,
    and one with K_m > K_b that drives, gives more power than it takes. In SI units K_m = K_b of a motor without iron losses.
    tau_c = cogging_torque, n = cogging_order, theta = the input angle; the energy of cogging is stored, not lost.
    Leaves out limits of the supply: those of BrushlessDC. A motor whose current is controlled by its amplifier
    is a CurrentSource.

    >>> from strainwave.motor import DC
    >>> DC(resistance=2.0, torque_constant=0.05, back_emf=0.05).torque_constant
    0.05

    Parameters
    ----------
    resistance: Armature resistance R_0 at 20 degC [Ohm], in (0, inf); default 1.0
    inductance: Armature inductance L; 0 lets the current follow at once [H], in [0, inf); default 0.0
    torque_constant: Torque per current K_m [N.m/A], in [0, inf); default 0.05
    back_emf: Back-electromotive force per speed K_b [V.s/rad], in [0, inf); default 0.05
    inertia: Rotor inertia [kg.m2], in [0, inf); default 1e-05
    brush_drop: Voltage V_b that the brushes take from any current [V], in [0, inf); default 0.0
    resistance_rise: Relative rise alpha of the resistance per kelvin [1/K], in [0, inf); default 0.0
    cogging_torque: Amplitude tau_c of the cogging [N.m], in [0, inf); default 0.0
    cogging_order: Periods n of the cogging per input revolution, in [1, 10000]; default 24.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    document P, armature equation u = R i + L di/dt + K_b omega
    """

    def __init__(self, *, resistance: float = ..., inductance: float = ..., torque_constant: float = ..., back_emf: float = ..., inertia: float = ..., brush_drop: float = ..., resistance_rise: float = ..., cogging_torque: float = ..., cogging_order: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, resistance: float = ..., inductance: float = ..., torque_constant: float = ..., back_emf: float = ..., inertia: float = ..., brush_drop: float = ..., resistance_rise: float = ..., cogging_torque: float = ..., cogging_order: float = ...) -> DC:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def resistance(self) -> float:
        """Armature resistance R_0 at 20 degC [Ohm]"""

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

    @property
    def brush_drop(self) -> float:
        """Voltage V_b that the brushes take from any current [V]"""

    @property
    def resistance_rise(self) -> float:
        """Relative rise alpha of the resistance per kelvin [1/K]"""

    @property
    def cogging_torque(self) -> float:
        """Amplitude tau_c of the cogging [N.m]"""

    @property
    def cogging_order(self) -> float:
        """Periods n of the cogging per input revolution"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'dc'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

class BrushlessDC:
    """
    Brushless DC motor as the DC motor that equals it, with the limits of its amplifier.

    .. math:: L \\dot i = u - R i - K \\omega, \\qquad \\tau = K i + \\tau_c \\sin(n \\theta), \\qquad
              |u| \\le U, \\quad |u - K \\omega| \\le R I

    with u the voltage between the two phases that conduct, omega the input speed, R = resistance, L = inductance of those two
    phases in series, K = torque_constant, of torque and back-EMF both, U = supply_voltage, I = current_limit. The amplifier
    limits the voltage so that the current never exceeds I; what it can give at each instant it hands back to the controller,
    whose integrals rest meanwhile. R rises with the temperature of the winding by resistance_rise per kelvin above 20 degC.
    Where a load turns the motor faster than (U + R I) / K the supply cannot hold the current back any more, and it exceeds I.

    tau_c = cogging_torque, n = cogging_order, theta = the input angle; the energy of cogging is stored, not lost.
    Leaves out commutation and its ripple: that of PMSM. Leaves out, too, that an amplifier may first use all of its
    voltage: here a current that is asked to be I approaches it with the time constant L / R.

    >>> from strainwave.motor import BrushlessDC
    >>> BrushlessDC(supply_voltage=24.0, current_limit=5.0).supply_voltage
    24.0

    Parameters
    ----------
    resistance: Resistance R of two phases in series, at 20 degC [Ohm], in (0, inf); default 1.0
    inductance: Inductance L of two phases in series [H], in (0, inf); default 0.001
    torque_constant: Torque per current K, and voltage per speed [N.m/A], in [0, inf); default 0.05
    inertia: Rotor inertia [kg.m2], in [0, inf); default 1e-05
    supply_voltage: Largest voltage U, of either sign [V], in (0, inf); default 48.0
    current_limit: Largest current I, of either sign [A], in (0, inf); default 10.0
    resistance_rise: Relative rise of the resistance per kelvin [1/K], in [0, inf); default 0.0
    cogging_torque: Amplitude tau_c of the cogging [N.m], in [0, inf); default 0.0
    cogging_order: Periods n of the cogging per input revolution, in [1, 10000]; default 24.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    document A, section Electric Motor: a brushless DC motor, simplified; the limits of amplifier and supply are ours
    """

    def __init__(self, *, resistance: float = ..., inductance: float = ..., torque_constant: float = ..., inertia: float = ..., supply_voltage: float = ..., current_limit: float = ..., resistance_rise: float = ..., cogging_torque: float = ..., cogging_order: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, resistance: float = ..., inductance: float = ..., torque_constant: float = ..., inertia: float = ..., supply_voltage: float = ..., current_limit: float = ..., resistance_rise: float = ..., cogging_torque: float = ..., cogging_order: float = ...) -> BrushlessDC:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def resistance(self) -> float:
        """Resistance R of two phases in series, at 20 degC [Ohm]"""

    @property
    def inductance(self) -> float:
        """Inductance L of two phases in series [H]"""

    @property
    def torque_constant(self) -> float:
        """Torque per current K, and voltage per speed [N.m/A]"""

    @property
    def inertia(self) -> float:
        """Rotor inertia [kg.m2]"""

    @property
    def supply_voltage(self) -> float:
        """Largest voltage U, of either sign [V]"""

    @property
    def current_limit(self) -> float:
        """Largest current I, of either sign [A]"""

    @property
    def resistance_rise(self) -> float:
        """Relative rise of the resistance per kelvin [1/K]"""

    @property
    def cogging_torque(self) -> float:
        """Amplitude tau_c of the cogging [N.m]"""

    @property
    def cogging_order(self) -> float:
        """Periods n of the cogging per input revolution"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'brushless_dc'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

class PMSM:
    """
    Permanent-magnet synchronous motor in the frame of its rotor, with an inverter that keeps the field oriented.

    .. math:: L_d \\dot i_d = u_d - R i_d + p \\omega L_q i_q, \\qquad
              L_q \\dot i_q = u_q - R i_q - p \\omega\\,(L_d i_d + \\psi), \\\\
              \\tau = \\tfrac{3}{2} p\\,(\\psi i_q + (L_d - L_q) i_d i_q) + \\tau_c \\sin(n \\theta)

    Currents and voltages are amplitudes of a phase. omega is the input speed, theta the input angle, R = resistance, L_d, L_q =
    direct_ and quadrature_inductance, psi = flux_linkage, p = pole_pairs, tau_c = cogging_torque, n = cogging_order. The
    controller gives u_q. The inverter gives u_d = R i_d0 - p omega L_q i_q, so that i_d settles at i_d0 = direct_current: 0
    for most motors, negative to gain reluctance torque where L_q exceeds L_d, or to weaken the field by hand.

    The inverter reaches a voltage of the length U = supply_voltage / sqrt(3). u_d comes first, and u_q has what is left; u_q
    is limited besides so that the length of the current does not exceed current_limit. What is left is handed back to the
    controller. Field weakening that sets i_d0 by itself is left out: at the voltage limit the current falls. Where a load
    turns the motor so fast that the inverter does not reach the voltages for this, the current exceeds its limit. Where even
    u_d alone exceeds U, nothing is left for u_q and the currents may oscillate without end: an inverter that keeps the
    direction of its voltage would not do so. Such a run says that the motor is beyond its range, no more.

    The sensors of the phase currents may each show a constant too much. Seen from the rotor that constant turns: the
    controller then sees i_q + I_o sin(p theta), I_o = current_offset, and makes a ripple of the torque out of it. The same
    ripple of i_d is left out. The energy of cogging is held, not lost. R rises with the temperature of the
    winding by resistance_rise per kelvin above 20 degC. Leaves out iron losses, saturation, harmonics of the flux and the
    switching of the inverter; and that an inverter may first use all of its voltage: here i_q approaches the limit of
    the current with the time constant L_q / R.

    Two faults take voltages v_d, v_q from u_d and u_q. The first phase, which the magnets face at theta = 0, has the
    resistance R + DR, DR = phase_resistance_excess. With phi = p theta:

    .. math:: v_d = \\tfrac{2}{3} \\Delta R \\cos\\varphi \\; i_1, \\qquad
              v_q = -\\tfrac{2}{3} \\Delta R \\sin\\varphi \\; i_1, \\qquad i_1 = i_d \\cos\\varphi - i_q \\sin\\varphi

    The currents and the torque get a ripple of order 2 p. DR does not depend on the temperature. DR far above R and
    p omega L_q is an open phase: i_1 tends to 0 as 1 / DR, and two phases are left. An exactly open phase has one current
    less, and is not a value of DR.

    The inverter waits between its two switches: each phase k loses dead_time_voltage against its current, which is the
    voltage of the supply times the dead time times the switching frequency. The loss is smaller in proportion below
    dead_time_current, at which the current recharges the switches within the dead time:

    .. math:: v_d = \\tfrac{2}{3} \\sum_k w_k \\cos\\varphi_k, \\quad v_q = -\\tfrac{2}{3} \\sum_k w_k \\sin\\varphi_k, \\quad
              w_k = V \\operatorname{clip}(i_k / i_c, \\pm 1), \\quad \\varphi_k = \\varphi - (k - 1) \\tfrac{2 \\pi}{3}

    V = dead_time_voltage, i_c = dead_time_current. The ripple has the order 6 p. Dead time takes no energy: the inverter gives
    less. The column voltage is the voltage that the inverter is set to, before these losses. The inverter limits i_q by
    measuring it, so that its limits include v_q; i_d is not controlled by a measurement, and is no longer i_d0 exactly.
    Fixed steps must follow the decay by 2/3 DR / L and by V / (i_c L), L being the smaller of L_d and L_q.

    >>> from strainwave.motor import PMSM
    >>> motor = PMSM(flux_linkage=0.02, pole_pairs=7)
    >>> round(1.5 * motor.pole_pairs * motor.flux_linkage, 12)  # torque per current, N.m/A
    0.21

    Parameters
    ----------
    resistance: Resistance R of a phase, at 20 degC [Ohm], in (0, inf); default 0.5
    direct_inductance: Inductance L_d along the magnets [H], in (0, inf); default 0.001
    quadrature_inductance: Inductance L_q across the magnets [H], in (0, inf); default 0.001
    flux_linkage: Amplitude psi of the flux of the magnets, linked with a phase [V.s/rad], in [0, inf); default 0.01
    pole_pairs: Pairs p of poles, in [1, 1000]; default 4.0
    inertia: Rotor inertia [kg.m2], in [0, inf); default 1e-05
    supply_voltage: Voltage of the direct-current supply of the inverter [V], in (0, inf); default 48.0
    current_limit: Largest amplitude of a phase current [A], in (0, inf); default 10.0
    direct_current: Current i_d0 along the magnets [A]; default 0.0
    cogging_torque: Amplitude tau_c of the cogging [N.m], in [0, inf); default 0.0
    cogging_order: Periods n of the cogging per input revolution, in [1, 10000]; default 24.0
    current_offset: Amplitude I_o that the current sensors add [A], in [0, inf); default 0.0
    resistance_rise: Relative rise of the resistance per kelvin [1/K], in [0, inf); default 0.0
    phase_resistance_excess: Resistance DR that one phase has more than the others [Ohm], in [0, inf); default 0.0
    dead_time_voltage: Voltage V that a phase loses by the dead time of the inverter [V], in [0, inf); default 0.0
    dead_time_current: Phase current i_c below which the dead time takes less [A], in (0, inf); default 0.1

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    PillayKrishnan1989, eqs. (1)-(7), in amplitudes; dead time: JeongPark1991; the uneven phase is the same equations with three resistances; limits of the inverter and their order of precedence are ours
    """

    def __init__(self, *, resistance: float = ..., direct_inductance: float = ..., quadrature_inductance: float = ..., flux_linkage: float = ..., pole_pairs: float = ..., inertia: float = ..., supply_voltage: float = ..., current_limit: float = ..., direct_current: float = ..., cogging_torque: float = ..., cogging_order: float = ..., current_offset: float = ..., resistance_rise: float = ..., phase_resistance_excess: float = ..., dead_time_voltage: float = ..., dead_time_current: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, resistance: float = ..., direct_inductance: float = ..., quadrature_inductance: float = ..., flux_linkage: float = ..., pole_pairs: float = ..., inertia: float = ..., supply_voltage: float = ..., current_limit: float = ..., direct_current: float = ..., cogging_torque: float = ..., cogging_order: float = ..., current_offset: float = ..., resistance_rise: float = ..., phase_resistance_excess: float = ..., dead_time_voltage: float = ..., dead_time_current: float = ...) -> PMSM:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def resistance(self) -> float:
        """Resistance R of a phase, at 20 degC [Ohm]"""

    @property
    def direct_inductance(self) -> float:
        """Inductance L_d along the magnets [H]"""

    @property
    def quadrature_inductance(self) -> float:
        """Inductance L_q across the magnets [H]"""

    @property
    def flux_linkage(self) -> float:
        """
        Amplitude psi of the flux of the magnets, linked with a phase [V.s/rad]
        """

    @property
    def pole_pairs(self) -> float:
        """Pairs p of poles"""

    @property
    def inertia(self) -> float:
        """Rotor inertia [kg.m2]"""

    @property
    def supply_voltage(self) -> float:
        """Voltage of the direct-current supply of the inverter [V]"""

    @property
    def current_limit(self) -> float:
        """Largest amplitude of a phase current [A]"""

    @property
    def direct_current(self) -> float:
        """Current i_d0 along the magnets [A]"""

    @property
    def cogging_torque(self) -> float:
        """Amplitude tau_c of the cogging [N.m]"""

    @property
    def cogging_order(self) -> float:
        """Periods n of the cogging per input revolution"""

    @property
    def current_offset(self) -> float:
        """Amplitude I_o that the current sensors add [A]"""

    @property
    def resistance_rise(self) -> float:
        """Relative rise of the resistance per kelvin [1/K]"""

    @property
    def phase_resistance_excess(self) -> float:
        """Resistance DR that one phase has more than the others [Ohm]"""

    @property
    def dead_time_voltage(self) -> float:
        """Voltage V that a phase loses by the dead time of the inverter [V]"""

    @property
    def dead_time_current(self) -> float:
        """Phase current i_c below which the dead time takes less [A]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'pmsm'

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

    with u what the controller asks for [A], K_m = torque_constant. The resistance tells what the current loses as
    heat, and nothing else. Leaves out that the supply limits the current as the
    speed grows.

    >>> from strainwave.motor import CurrentSource
    >>> CurrentSource(torque_constant=0.1).torque_constant
    0.1

    Parameters
    ----------
    torque_constant: Torque per current K_m [N.m/A], in [0, inf); default 0.05
    inertia: Rotor inertia [kg.m2], in [0, inf); default 1e-05
    resistance: Resistance of the winding [Ohm], in [0, inf); default 0.0

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    definition
    """

    def __init__(self, *, torque_constant: float = ..., inertia: float = ..., resistance: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, torque_constant: float = ..., inertia: float = ..., resistance: float = ...) -> CurrentSource:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def torque_constant(self) -> float:
        """Torque per current K_m [N.m/A]"""

    @property
    def inertia(self) -> float:
        """Rotor inertia [kg.m2]"""

    @property
    def resistance(self) -> float:
        """Resistance of the winding [Ohm]"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'current_source'

    source: str = 'definition'

    fields: tuple[dict[str, Any], ...]

class AccelerationSource:
    """
    A motor that prescribes the motion of the input shaft: it accelerates as it is asked to, whatever torque that needs.

    .. math:: \\dot\\omega = u, \\qquad \\tau = J_{in} u + (T + F_{mesh})\\,(1/i - e') + F_{in}

    with u what the controller asks for [rad/s2], and omega the input speed. Where the shaft begins, and how fast, is said where a
    run begins; Motion of strainwave.simulation.motion makes both of a measured angle. Its torque tau is a result: what a motor
    of that inertia must give. How input and output move does not depend on inertia and friction at the input, nor on
    friction of the mesh. At the instants at which the shaft is at rest, set-valued friction of both is reported as 0.

    >>> from strainwave.motor import AccelerationSource
    >>> AccelerationSource(inertia=2e-5).inertia
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
    definition; its torque is Newton's second law of the input shaft
    """

    def __init__(self, *, inertia: float = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, inertia: float = ...) -> AccelerationSource:
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

    name: str = 'acceleration_source'

    source: str = ...

    fields: tuple[dict[str, Any], ...]
