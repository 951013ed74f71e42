"""Figures of the parts of a drive on theory pages: each part is simulated in a small joint."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import strainwave as sw
from matplotlib.axes import Axes
from numpy.typing import NDArray
from strainwave.simulation import signals

Array = NDArray[np.float64]
Draw = Callable[[Axes], None]
Shown = Sequence[tuple[str, Any]]  # label and model

GEAR = sw.Gear(
    kinematics=sw.kinematics.PlainRatio(reduction=100.0),
    stiffness=sw.stiffness.Linear(k=3e4),
    damping=20.0,
    friction_input=sw.friction.Coulomb(coulomb=0.03, breakaway=0.04, viscous=2e-4),
)
JOINT = sw.Drive(
    gear=GEAR,
    motor=sw.motor.BrushlessDC(
        resistance=0.5, inductance=5e-4, torque_constant=0.1, inertia=1e-4, supply_voltage=48.0, current_limit=12.0
    ),
    control=sw.control.PID(proportional=5.0, derivative=0.1),
    load=sw.loads.Inertia(inertia=0.5),
)
RIG = sw.Drive(
    gear=GEAR.replace(friction_input=sw.friction.Viscous()), motor=sw.motor.TorqueSource(), load=sw.loads.Prescribed()
)


def of(family: str, *but: str) -> Callable[[Callable[[Any], list[Draw]]], Callable[[Shown], list[Draw]]]:
    """Panels for the models of one family, each shown alone, but for some of them, by name."""

    def only(draw: Callable[[Any], list[Draw]]) -> Callable[[Shown], list[Draw]]:
        def drawn(models: Shown) -> list[Draw]:
            model = models[0][1]
            wanted = type(model).__module__ == f"strainwave.{family}" and model.name not in but
            return draw(model) if wanted else []

        return drawn

    return only


# ---- Kinematic error -------------------------------------------------------------------------------------------------


def error_under_load(law: Any, angle: Array, torque: float) -> Array:
    """Return the kinematic error [rad] at input angles [rad] of a gear that turns at 10 rad/s under a torque [N.m]."""
    speed, stiffness = 10.0, 1e3
    gear = GEAR.replace(kinematic_error=law, stiffness=sw.stiffness.Linear(k=stiffness))
    drive = sw.Drive(gear=gear, motor=sw.motor.AccelerationSource(), load=sw.loads.Inertia(inertia=0.01))
    twist, ratio = torque / stiffness, gear.kinematics.ratio
    start = {"input_speed": speed, "output_speed": speed / ratio, "output_angle": -twist, "twist": twist}
    turning = sw.scenario.constant(0.0, duration=angle[-1] / speed)
    run = sw.simulate(drive, turning, dt=1e-3, load_torque=torque, initial=start)
    return np.interp(angle, run["input_angle"], run["kinematic_error"])


# ---- Motors ----------------------------------------------------------------------------------------------------------


@of("motor", "torque_source", "current_source", "acceleration_source")
def run_up(motor: Any) -> list[Draw]:
    """From rest without load, under all the voltage there is."""
    volts = getattr(motor, "supply_voltage", 24.0)
    drive = JOINT.replace(motor=motor.replace(inertia=1e-4), control=sw.control.OpenLoop(), load=sw.loads.Inertia(inertia=0.1))
    run = sw.simulate(drive, sw.scenario.constant(volts, duration=1.5), dt=1e-4)

    def current(axes: Axes) -> None:
        axes.plot(run["input_speed"], run["current"], label="current [A]")
        axes.plot(run["input_speed"], run["voltage"], label="voltage [V]")
        axes.set(xlabel=f"speed [rad/s], running up at {volts:g} V", ylim=(0.0, None))

    return [current]


# ---- Controllers -----------------------------------------------------------------------------------------------------


@of("control", "open_loop")
def step_response(law: Any) -> list[Draw]:
    """A step of the command, and what the motor is given for it."""
    plain = getattr(law, "law", law)
    drive, unit = JOINT.replace(control=law), signals.command_unit(JOINT.replace(control=plain))
    if plain.name == "position_speed":
        drive = drive.replace(motor=sw.motor.CurrentSource(torque_constant=0.1, inertia=1e-4))
    over, size = ("output_angle", 0.05) if unit == "rad" else ("output_speed", 1.0)
    run = sw.simulate(drive, sw.scenario.step(size, duration=0.4, start=0.02), dt=5e-5)
    given = "voltage" if "voltage" in run.names else "current"

    def answer(axes: Axes) -> None:
        axes.plot(1e3 * run.time, run["command"], color="0.6", label="command")
        axes.plot(1e3 * run.time, run[over], label=over.replace("_", " "))
        axes.set(xlabel="time [ms]", ylabel=f"{over.replace('_', ' ')} [{unit}]")

    def actuation(axes: Axes) -> None:
        axes.plot(1e3 * run.time, run[given], linewidth=1.0)
        axes.set(xlabel="time [ms]", ylabel=f"{given} [{run.unit(given)}]", xlim=(0.0, 120.0))

    return [answer, actuation]


# ---- Sensors ---------------------------------------------------------------------------------------------------------


def seen(sensor: Any, motion: Any) -> tuple[Array, Array]:
    """Time [s], and what a sensor of the output angle shows of a motion."""
    looked: list[Any] = []

    def look(now: Any) -> float:
        looked.append(now)
        return 0.0

    rig = RIG.replace(sensors=sw.Sensors(output_angle=sensor))
    still = sw.scenario.constant(0.0, motion.duration)
    sw.simulate_controlled(rig, look, still, period=5e-5, dt=2.5e-5, inputs={"output_angle": motion})
    return np.array([each.time for each in looked]), np.array([each.output_angle for each in looked])


@of("sensor", "ideal")
def ramp_and_halt(sensor: Any) -> list[Draw]:
    """A shaft that turns by one radian within some milliseconds, and stops."""
    motion = sw.scenario.table([0.0, 2e-3, 7e-3, 20e-3], [0.0, 0.0, 1.0, 1.0])
    time, shown = seen(sensor, motion)

    def draw(axes: Axes) -> None:
        axes.plot(1e3 * time, np.interp(time, [0.0, 2e-3, 7e-3], [0.0, 0.0, 1.0]), color="0.6", label="angle")
        axes.plot(1e3 * time, shown, label="reading")
        axes.set(xlabel="time [ms]", ylabel="angle [rad]")

    return [draw]


# ---- Loads -----------------------------------------------------------------------------------------------------------


def load_torque(load: Any, angle: Array, speed: Array) -> Array:
    """At each angle [rad] and speed [rad/s] of the output."""
    drive = sw.Drive(gear=GEAR, motor=sw.motor.TorqueSource(), load=load)
    idle = sw.scenario.constant(0.0, duration=1e-6)
    inputs = {"brake_torque": 5.0} if signals.load_input(drive) == "brake_torque" else {}

    def at(a: float, v: float) -> float:
        start = {"output_angle": a, "output_speed": v, "twist": 0.0}
        return float(sw.simulate(drive, idle, dt=1e-6, inputs=inputs, initial=start)["load_torque"][0])

    return np.array([at(a, v) for a, v in np.broadcast(angle, speed)])


@of("loads", "inertia", "prescribed")
def over_motion(load: Any) -> list[Draw]:
    """Over angle and speed, where it depends on them."""
    # Nothing is at rest between the two smallest speeds, so that a brake slips there.
    angle, speed = np.linspace(-np.pi, np.pi, 121), np.concatenate([np.linspace(-2.0, -1e-6, 40), np.linspace(1e-6, 2.0, 40)])
    by_angle, by_speed = load_torque(load, angle, np.array([1e-9])), load_torque(load, np.zeros(1), speed)

    def over(values: Array, torque: Array, label: str) -> Draw:
        def draw(axes: Axes) -> None:
            axes.plot(values, torque)
            axes.set(xlabel=label, ylabel="torque of the load [N.m]")

        return draw

    panels = ((angle, by_angle, "output angle [rad]"), (speed, by_speed, "output speed [rad/s]"))
    return [over(*panel) for panel in panels if np.ptp(panel[1]) > 1e-6]


# ---- Heat and energy -------------------------------------------------------------------------------------------------


@of("thermal", "isothermal")
def warm_up(heating: Any) -> list[Draw]:
    """A motor that holds a locked output under 5 A, for half an hour."""
    motor = sw.motor.CurrentSource(torque_constant=0.1, inertia=100.0, resistance=0.5)  # so slow that long steps follow it
    gear = sw.Gear(stiffness=sw.stiffness.Linear(k=1e3))
    stalled = sw.Drive(gear=gear, motor=motor, load=sw.loads.Prescribed(), thermal=heating)
    held = sw.scenario.constant(5.0, duration=1800.0)
    run = sw.simulate(stalled, held, dt=0.1, sample=10.0, inputs={"output_angle": 0.0})

    def draw(axes: Axes) -> None:
        for name, label in (("winding_temperature", "winding"), ("temperature", "gear")):
            axes.plot(run.time / 60.0, run[name] - 273.15, label=label)
        axes.set(xlabel="time [min], at a loss of 12.5 W in the winding", ylabel="temperature [°C]")

    return [draw]


@of("softening")
def stiffness_over_temperature(softening: Any) -> list[Draw]:
    """That of a linear spring under a constant torque."""
    rig = RIG.replace(gear=RIG.gear.replace(softening=softening))
    temperature = np.linspace(253.15, 373.15, 13)

    def stiffness(kelvin: float) -> float:
        held = sw.scenario.constant(0.5, duration=0.2)
        run = sw.simulate(rig, held, temperature=kelvin, inputs={"output_angle": 0.0})
        return float(run["torque"][-1] / run["twist"][-1])

    def draw(axes: Axes) -> None:
        axes.plot(temperature - 273.15, [1e-3 * stiffness(kelvin) for kelvin in temperature])
        axes.set(xlabel="temperature of the gear [°C]", ylabel="stiffness [kN.m/rad]")

    return [draw]


@of("meter", "none")
def energies(meter: Any) -> list[Draw]:
    """Where the energy of one movement of a joint under gravity goes."""
    arm = sw.loads.Pendulum(inertia=0.5, gravity_torque=15.0)
    run = sw.simulate(JOINT.replace(meter=meter, load=arm), sw.scenario.step(1.0, duration=0.8, start=0.05), sample=1e-3)
    stored = sum(run[name] for name in run.names if name.startswith("stored_"))

    def draw(axes: Axes) -> None:
        axes.plot(run.time, run["energy_supplied"], color="0.4", label="supplied")
        for name in ("motor", "friction_input", "load"):
            axes.plot(run.time, run[f"energy_{name}"], label=name.replace("_", " at the "))
        axes.plot(run.time, stored, label="stored")
        axes.set(xlabel="time [s]", ylabel="energy [J]", ylim=(None, 1.6 * run["energy_supplied"].max()))

    return [draw]


# Numbers that suit the joint, for models whose example shows little.
SUITED: dict[str, dict[str, Any]] = {
    "dc": {"": sw.motor.DC(resistance=0.5, inductance=5e-4, torque_constant=0.1, back_emf=0.1)},
    "brushless_dc": {"": sw.motor.BrushlessDC(resistance=0.5, inductance=5e-4, torque_constant=0.1, supply_voltage=24.0)},
    "pmsm": {"": sw.motor.PMSM(resistance=0.3, flux_linkage=0.012, pole_pairs=7)},
    "pid": {"": sw.control.PID(proportional=5.0, derivative=0.1, limit=48.0)},
    "pi": {"": sw.control.PI(proportional=0.1, integral=3.0)},
    "position_speed": {"": sw.control.PositionSpeed(position_gain=25.0, speed_proportional=0.3, speed_integral=3.0)},
    "cascade": {
        "": sw.control.Cascade(
            position_gain=25.0,
            speed_proportional=0.3,
            speed_integral=3.0,
            current_proportional=1.0,
            current_integral=900.0,
        )
    },
    "lead_lag": {"": sw.control.LeadLag(gain=5.0, lead_numerator=0.03, lead_denominator=0.003)},
    "state_feedback": {"": sw.control.StateFeedback(input_angle=5.0, input_speed=0.1, torque=0.01)},
    "sampled": {"": sw.control.Sampled(law=sw.control.PID(proportional=5.0, derivative=0.1), period=4e-3, delay=1e-3)},
    "gain": {"": sw.sensor.Gain(gain=1.1, offset=0.05)},
    "encoder": {"": sw.sensor.Encoder(counts=64, eccentricity=0.05)},
    "sine_cosine_encoder": {"": sw.sensor.SineCosineEncoder(periods=20, sine_offset=0.2, amplitude_ratio=1.5)},
    "delayed": {"": sw.sensor.Delayed(delay=2e-3)},
    "noisy": {"": sw.sensor.Noisy(amplitude=0.02, bandwidth=2000.0, seed=7)},
    "quantised": {"": sw.sensor.Quantised(law=sw.sensor.Noisy(amplitude=0.02, bandwidth=2000.0, seed=7), resolution=0.05)},
    "heating": {
        "": sw.thermal.Heating(
            winding_capacity=120.0, winding_resistance=2.5, gear_capacity=600.0, gear_resistance=0.8, coupling=0.2
        )
    },
    "energy": {"": sw.meter.EnergyMeter()},
    "torsion_spring": {"": sw.loads.TorsionSpring(inertia=0.05, stiffness=20.0, damping=2.0)},
    "aerodynamic": {"": sw.loads.Aerodynamic(area=0.5, chord=0.3, airspeed=40.0, drag_coefficient=1.2, drag_radius=0.6)},
    "torque_table": {"": sw.loads.TorqueTable(angle=[-1.0, 0.0, 0.5, 1.0], held_torque=[-3.0, 0.0, 4.0, 5.0])},
}

PANELS = (run_up, step_response, ramp_and_halt, over_motion, warm_up, stiffness_over_temperature, energies)
