"""Drives: motor, control, gear and load."""

from typing import Any

import strainwave._core
import strainwave.control
import strainwave.loads
import strainwave.motor
import strainwave.state


class PositionDrive:
    """
    A motor, its controller, one strain wave gear and a load.

    .. math:: J_{in} \\ddot\\theta_{in} = K_m i - (T + F_{mesh})\\,(1/i - e') - F_{in}, \\qquad
              J_{out} \\ddot\\theta_{out} = T - T_{load} - F_{out}

    with J_in = motor.inertia + gear.input_inertia, J_out = load.inertia, T and e' of the gear, F the friction of each place.
    Where set-valued friction of the input and of the mesh hold the input together, the torque that each holds cannot be
    told apart: it is reported in proportion to what each can hold.
    Angles are carried relative to the rigid motion, so an hour of rotation is as accurate as a second.

    >>> import strainwave as sw
    >>> drive = sw.drives.PositionDrive(motor=sw.motor.DC(resistance=2.0), load=sw.loads.Inertia(inertia=0.005))
    >>> drive.motor.resistance
    2.0

    Parameters
    ----------
    gear: The gear; default Gear(kinematics=StrainWave(flexspline_teeth=200, circular_spline_teeth=202, fixed='circular_spline'), kinematic_error=Fourier(order=(), amplitude=(), phase=()), kinematic_noise=Stochastic(amplitude=0.0, lowest_order=8.0, highest_order=40.0, seed=0.0, load_sensitivity=0.0, speed_sensitivity=0.0, insertion_depth=0.0, depth_sensitivity=0.0), stiffness=Linear(k=10000.0), hysteresis=MaxwellSlip(stiffness=(), breakaway=()), damping=0.0, friction_input=Viscous(viscous=0.0), friction_mesh=Viscous(viscous=0.0), friction_output=Viscous(viscous=0.0), input_inertia=0.0)
    motor: The motor on the input shaft; default DC(resistance=1.0, inductance=0.0, torque_constant=0.05, back_emf=0.05, inertia=1e-05)
    control: What turns the command into the motor's voltage; default OpenLoop(gain=1.0)
    load: What the output shaft carries; default Inertia(inertia=0.01)

    Raises
    ------
    TypeError: an unknown parameter, one of the wrong kind, or none where it is required
    ValueError: a number that is not finite or out of its range

    Source
    ------
    document P, eqs. of motion, with r = 1/100 (E-P1) in the motor equation too (E-P2)
    """

    def __init__(self, *, gear: strainwave._core.Gear = ..., motor: strainwave.motor.DC = ..., control: strainwave.control.OpenLoop | strainwave.control.PID = ..., load: strainwave.loads.Inertia | strainwave.loads.Pendulum = ...) -> None: ...

    def replace(self, changes: dict[str, Any] = ..., /, *, gear: strainwave._core.Gear = ..., motor: strainwave.motor.DC = ..., control: strainwave.control.OpenLoop | strainwave.control.PID = ..., load: strainwave.loads.Inertia | strainwave.loads.Pendulum = ...) -> PositionDrive:
        """
        The same with the named parameters changed. A dictionary names them by their paths: {"friction_input.viscous": 1e-4}.
        """

    @property
    def gear(self) -> strainwave._core.Gear:
        """The gear"""

    @property
    def motor(self) -> strainwave.motor.DC:
        """The motor on the input shaft"""

    @property
    def control(self) -> strainwave.control.OpenLoop | strainwave.control.PID:
        """What turns the command into the motor's voltage"""

    @property
    def load(self) -> strainwave.loads.Inertia | strainwave.loads.Pendulum:
        """What the output shaft carries"""

    def __repr__(self) -> str: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> dict[str, object]: ...

    def __setstate__(self, state: dict[str, object], /) -> None: ...

    def __reduce__(self) -> tuple[Any, ...]: ...

    name: str = 'position_drive'

    source: str = ...

    fields: tuple[dict[str, Any], ...]

    def rest(self) -> strainwave.state.State:
        """The state at rest, untwisted and without history, input angle 0."""

    def step(self, state: strainwave.state.State, *, command: float = 0.0, command_rate: float = 0.0, load_torque: float = 0.0, temperature: float = 293.15, dt: float) -> strainwave.state.State:
        """
        The state `dt` [s] later, the command moving at `command_rate`. `ValueError` for a state of another drive, for what is not finite, for a `dt` or a `temperature` that is not positive, and where a part is not valid; `FloatingPointError` if the step diverges.
        """
