"""Drives of a small joint, with any part of any list: all have numbers under which the joint moves."""

from __future__ import annotations

from typing import Any

import numpy as np
import strainwave as sw
from strainwave import _core
from strainwave.simulation.signals import load_input

from tests.support.joint_sized import INPUT_SIZES, OUTPUT_SIZES, joint_sized
from tests.support.strategies import made

NOISE = sw.kinematic_error.Stochastic(amplitude=2e-5, seed=3, load_sensitivity=0.05, speed_sensitivity=0.01)
SLIP = sw.kinematic_error.MicroSlip(excitation=0.02, friction=2.0, load_share=0.3, stiffness=1e4, seed=3)
FOURIER = sw.kinematic_error.Fourier(order=[2.0, 4.0], amplitude=[1e-4, 3e-5], phase=[0.3, -1.1])
SOFTENING = sw.softening.ThermalSoftening(stiffness_fall=3e-3, hysteresis_fall=5e-3)
HEATING = sw.thermal.Heating(
    winding_capacity=0.5,
    winding_resistance=2.0,
    gear_capacity=1.0,
    gear_resistance=1.0,
    coupling=0.3,
    initial_temperature=300.0,
)

# Of each list every model, with numbers of a small joint.
STRIBECK = sw.friction.Stribeck(coulomb=0.02, breakaway=0.03, stribeck_speed=2.0, viscous=5e-5)
FRICTIONS: list[Any] = [
    sw.friction.Viscous(viscous=1e-4),
    sw.friction.Coulomb(coulomb=0.02, breakaway=0.03, viscous=1e-4),
    STRIBECK,
    sw.friction.PositionDependent(
        constant=0.03,
        cosine=[2e-3],
        sine=[1e-3],
        static_ratio=1.1,
        viscous=1e-4,
        domain_start=0.0,
        domain_end=2.0 * np.pi,
        outside="periodic",
    ),
    sw.friction.LuGre(
        coulomb=0.02, breakaway=0.03, stribeck_speed=2.0, bristle_stiffness=50.0, bristle_damping=5e-3, viscous=5e-3
    ),
    sw.friction.MaxwellSlipFriction(
        stiffness=[20.0, 10.0], share=[0.6, 0.4], coulomb=0.02, breakaway=0.02, stribeck_speed=2.0, attraction=0.5, viscous=1e-4
    ),
    sw.friction.LoadDependent(driving_forward=0.1, driving_reverse=0.15, backdriving_forward=0.2, backdriving_reverse=0.25),
    sw.friction.TorqueEfficiency(average_loss=0.1, difference_loss=0.02, presliding=1e-3, viscous=1e-4),
    sw.friction.MixedLubrication(
        coulomb=0.02, breakaway=0.03, stribeck_speed=2.0, viscous=1e-4, viscosity_fall=0.03, load_sensitivity=0.03
    ),
    sw.friction.Cyclic(law=STRIBECK, order=[2.0], amplitude=[0.3], phase=[0.3]),
    sw.friction.Thermal(law=STRIBECK, dry_fall=0.01, viscous_fall=0.03),
    sw.friction.Asymmetric(law=STRIBECK, dry_asymmetry=0.1, viscous_asymmetry=0.05),
    sw.friction.CurvedViscous(coulomb=0.02, breakaway=0.03, viscous_torque=0.02, exponent=0.7, reference_speed=100.0),
    sw.friction.AngleSpeedMap(speed=[1.0, 100.0], level=[0.02, 0.03, 0.03, 0.04], static_ratio=1.2),
]
GEAR_PARTS: dict[str, list[Any]] = {
    "kinematics": [sw.kinematics.StrainWave(), sw.kinematics.PlainRatio(reduction=100.0)],
    "kinematic_error": [
        FOURIER,
        made(sw.kinematic_error.Misalignment, offset=4e-3, housing_tilt_x=2e-3, generator_tilt_y=2e-3),
        made(sw.kinematic_error.ToothErrors, flexspline_deviation=1.5e-5, circular_spline_deviation=1.5e-5, seed=1),
    ],
    "kinematic_noise": [NOISE, SLIP],
    "stiffness": [
        sw.stiffness.Linear(k=1.2e4),
        sw.stiffness.Piecewise(k1=1e4, k2=5e3, knee=1e-4),
        sw.stiffness.ThreeSegment(k1=1e4, k2=1.3e4, k3=1.6e4, t1=0.5, t2=1.5),
        sw.stiffness.Cubic(a1=1.2e4, a3=1e9),
        sw.stiffness.MultiCompliance(
            flexspline_stiffness=1.5e4,
            flexspline_hardening=0.02,
            wave_generator_stiffness=8.0,
            wave_generator_hardening=0.5,
            reduction=100.0,
        ),
        sw.stiffness.Backlash(law=sw.stiffness.Cubic(a1=1.2e4, a3=1e9), clearance=5e-5),
    ],
    "hysteresis": [
        sw.hysteresis.MaxwellSlip(stiffness=[2e3, 1e3], breakaway=[0.3, 0.6]),
        sw.hysteresis.FadingMemory(stiffness=[2e3], forgetting=[2e3]),
        sw.hysteresis.BoucWen(stiffness=2e3, saturation=0.5, sharpness=1.5, shape=0.6),
        sw.hysteresis.Preisach(density=sw.hysteresis.PowerDensity(limit=1e-3, saturation=0.5, exponent=1.5)),
        sw.hysteresis.Regimes(
            positive_unloading=4e3,
            negative_loading=1e3,
            negative_unloading=4.5e3,
            positive_loading=1.5e3,
            onset=0.05,
            lost_motion=1e-4,
        ),
        sw.hysteresis.FrictionalWindup(
            springs=sw.stiffness.MultiCompliance(
                flexspline_stiffness=8e3,
                flexspline_hardening=0.02,
                wave_generator_stiffness=1.0,
                wave_generator_hardening=1.5,
                reduction=100.0,
            ),
            friction=0.3,
        ),
    ],
    "friction_input": FRICTIONS,
    "friction_mesh": FRICTIONS,
    "friction_output": FRICTIONS,
    "softening": [SOFTENING],
    "material": [sw.material.Elastic(), sw.material.GeneralisedMaxwell(stiffness=[2e3, 800.0], relaxation_time=[1e-3, 0.02])],
}

# Each moves under a command of 0.02 rad, or rad/s: voltages for motors that take them, and a share of it for the others.
INERTIA = 1e-4
MOTORS: list[tuple[Any, float]] = [
    (
        sw.motor.DC(resistance=0.5, inductance=5e-4, torque_constant=0.1, back_emf=0.11, inertia=INERTIA, resistance_rise=4e-3),
        1.0,
    ),
    (sw.motor.DC(resistance=0.5, torque_constant=0.1, back_emf=0.1, inertia=INERTIA, brush_drop=0.5), 1.0),
    (
        sw.motor.BrushlessDC(
            resistance=0.5,
            inductance=5e-4,
            torque_constant=0.1,
            inertia=INERTIA,
            supply_voltage=15.0,
            current_limit=6.0,
            resistance_rise=4e-3,
        ),
        1.0,
    ),
    (
        sw.motor.PMSM(
            resistance=0.5,
            direct_inductance=4e-4,
            quadrature_inductance=8e-4,
            flux_linkage=0.012,
            pole_pairs=5,
            inertia=INERTIA,
            supply_voltage=20.0,
            current_limit=8.0,
            direct_current=-1.0,
            cogging_torque=5e-3,
            cogging_order=12,
            current_offset=0.1,
            resistance_rise=4e-3,
        ),
        1.0,
    ),
    (sw.motor.TorqueSource(inertia=INERTIA), 0.03),
    (sw.motor.CurrentSource(torque_constant=0.1, inertia=INERTIA, resistance=0.5), 0.3),
    (sw.motor.AccelerationSource(inertia=INERTIA), 300.0),
]
LOADS = [
    sw.loads.Inertia(inertia=0.05),
    sw.loads.Pendulum(inertia=0.05, gravity_torque=5.0),
    sw.loads.TorsionSpring(inertia=0.05, stiffness=200.0, damping=0.5, rest_angle=0.01),
    sw.loads.Aerodynamic(
        inertia=0.05, area=0.5, airspeed=40.0, moment_coefficient=0.01, moment_slope=0.5, drag_coefficient=1.0, drag_radius=0.5
    ),
    sw.loads.TorqueTable(inertia=0.05, angle=[-0.1, 0.0, 0.2], held_torque=[-2.0, 0.5, 4.0]),
    sw.loads.Brake(inertia=0.05, breakaway_ratio=1.2),
    sw.loads.Prescribed(),
]
SENSORS = [
    sw.sensor.Ideal(),
    sw.sensor.Gain(gain=0.98, offset=1e-3),
    sw.sensor.FirstOrder(time_constant=1e-3),
    sw.sensor.SecondOrder(natural_frequency=2e3, damping_ratio=0.7),
    sw.sensor.Encoder(counts=4096, offset=1e-3),
    sw.sensor.SineCosineEncoder(periods=64, sine_offset=0.02, converter_step=2e-3),
    sw.sensor.Delayed(law=sw.sensor.FirstOrder(time_constant=1e-3), delay=4e-3),
    sw.sensor.Noisy(law=sw.sensor.Gain(gain=0.98), amplitude=1e-4, bandwidth=500.0, seed=3),
    sw.sensor.Quantised(law=sw.sensor.FirstOrder(time_constant=1e-3), resolution=1e-3),
]


def controls(scale: float) -> list[Any]:
    """What they give is this share of a voltage."""
    laws: list[Any] = [
        sw.control.OpenLoop(gain=600.0 * scale),
        sw.control.PID(proportional=5.0 * scale, integral=20.0 * scale, derivative=0.1 * scale, limit=12.0 * scale),
        sw.control.PI(proportional=5.0 * scale, integral=20.0 * scale, limit=12.0 * scale),
        sw.control.LeadLag(gain=5.0 * scale, lead_numerator=0.02, lead_denominator=2e-3, limit=12.0 * scale),
        sw.control.StateFeedback(
            input_angle=5.0 * scale,
            input_speed=0.1 * scale,
            output_angle=10.0 * scale,
            output_speed=1.0 * scale,
            current=0.05 if scale == 1.0 else 0.0,
            torque=0.02 * scale,
            limit=12.0 * scale,
        ),
    ]
    if scale == 1.0:
        laws.append(
            sw.control.Cascade(position_gain=30.0, speed_proportional=0.1, speed_integral=1.0, current_proportional=2.0)
        )
    else:
        laws.append(sw.control.PositionSpeed(position_gain=30.0, speed_proportional=0.3 * scale, limit=12.0 * scale))
    return [*laws, *(sw.control.Sampled(law=law, period=1e-3, delay=2e-4) for law in laws[1:])]


# In tests/structure, tests/ring and tests/variation; here a gear has one spring.
BALANCED_WITH_STAGES = {"Staged", "Periodic", "Scaled", "Rigid", "Modes", "BallBearing"}
PART_OF_FAMILY = {"friction": "friction_input"} | {
    name: name for name in ("kinematic_error", "stiffness", "hysteresis", "softening")
}
UNLISTED = {  # by name, of each law of a gear that is in no list above: its part of a gear, and its class
    name: (part, kind)
    for family, part in PART_OF_FAMILY.items()
    for name, kind in _core.families[family].items()
    if kind.__name__ not in BALANCED_WITH_STAGES | {type(law).__name__ for law in GEAR_PARTS[part]}
}
SEED_OF_UNLISTED = 60  # a DC motor with a sampled control


def drawn(case: int | str) -> sw.Drive:
    """Return a joint with its energy measured: of parts drawn by a seed, each from its list, or with a law that is unlisted."""
    if isinstance(case, int):
        return drawn_by(case)
    part, kind = UNLISTED[case]
    sizes = INPUT_SIZES if part == "friction_input" else OUTPUT_SIZES
    law = joint_sized(kind, sizes, within=STRIBECK if part == "friction_input" else None)
    drive = drawn_by(SEED_OF_UNLISTED)
    return drive.replace(gear=drive.gear.replace(**{part: law}))


def drawn_by(seed: int) -> sw.Drive:
    """A joint whose parts are drawn, each from its list, with its energy measured."""
    random = np.random.default_rng(seed)

    def one_of(choices: list[Any]) -> Any:
        return choices[random.integers(len(choices))]

    motor, scale = one_of(MOTORS)
    gear = sw.Gear(damping=5.0, input_inertia=2e-5, **{name: one_of(choices) for name, choices in GEAR_PARTS.items()})
    sensors = {field["name"]: one_of([sw.sensor.Ideal(), one_of(SENSORS)]) for field in sw.Sensors.fields}
    control, load, thermal = one_of(controls(scale)), one_of(LOADS), one_of([sw.thermal.Isothermal(), HEATING])
    counts = any(
        isinstance(sensor, sw.sensor.Encoder | sw.sensor.SineCosineEncoder | sw.sensor.Quantised) for sensor in sensors.values()
    )
    if (counts or getattr(motor, "inductance", 1.0) == 0.0) and not isinstance(control, sw.control.Sampled):
        # At the edge of a step a law that acts all the time jumps without end; and none acts on a current it sets at once.
        control = sw.control.Sampled(law=control, period=1e-3)
    return sw.Drive(
        gear=gear,
        motor=motor,
        control=control,
        load=load,
        sensors=sw.Sensors(**sensors),
        thermal=thermal,
        meter=sw.meter.EnergyMeter(),
    )


DURATION = 0.02  # s
COMMAND = sw.scenario.sine(0.02, 60.0, DURATION)
ACTING = {
    "load_torque": sw.scenario.sine(3.0, 90.0, DURATION),
    "brake_torque": sw.scenario.constant(1.0, DURATION) + sw.scenario.sine(0.5, 90.0, DURATION),
    "output_angle": sw.scenario.sine(1e-3, 80.0, DURATION),
}
WARMING = sw.scenario.constant(290.0, DURATION) + sw.scenario.ramp(500.0, DURATION)  # K


def inputs(drive: sw.Drive) -> dict[str, sw.scenario.Scenario]:
    """Those besides the command, that its load takes and a temperature that rises."""
    load = load_input(drive)
    return {load: ACTING[load], "temperature": WARMING}
