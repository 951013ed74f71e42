"""The tuned cascade: against the closed forms of its loops."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from strainwave.tuning.cascade import PHASE_OF_DELAY, POSITION_SHARE, Plant, Setting, line_of_friction, model_of, tuned_law

GEAR = sw.Gear(
    kinematics=sw.kinematics.PlainRatio(reduction=100.0),
    stiffness=sw.stiffness.Linear(k=3e4),
    friction_input=sw.friction.Coulomb(coulomb=0.03, viscous=2e-4),
    friction_mesh=sw.friction.Coulomb(coulomb=1.0),
    input_inertia=2e-5,
)
ARM = sw.loads.Inertia(inertia=0.6)
FAST = Setting(sharpness=1.0, feedback="input", observer_share=0.0)


def plant_of(motor: object, period: float = 1e-3, delay: float = 5e-4) -> Plant:
    drive = sw.Drive(gear=GEAR, motor=motor, load=ARM)
    return Plant.of(sw.GearSet.of(drive, name="joint", source="stated"), period, delay)


def test_the_line_of_friction_is_that_of_all_places_at_the_input() -> None:
    """A Coulomb torque of the mesh counts over the ratio."""
    assert line_of_friction(GEAR) == pytest.approx((0.03 + 1.0 / 100.0, 2e-4))


def test_the_speed_loop_loses_half_a_radian_to_the_delay_where_it_crosses_over() -> None:
    plant = plant_of(sw.motor.CurrentSource(torque_constant=0.1, inertia=8e-5))
    law = tuned_law(plant, FAST)
    crossover = law.speed_proportional * 0.1 / 1e-4  # on the inertia of rotor and wave generator
    assert crossover * (5e-4 + 0.5e-3) == pytest.approx(PHASE_OF_DELAY)
    bandwidth = law.speed_proportional * 0.1 / (1e-4 + 0.6 / 100.0**2)
    assert law.position_gain == pytest.approx(POSITION_SHARE * bandwidth)
    assert tuned_law(plant, Setting(0.5, "input", 0.0)).speed_proportional == pytest.approx(0.5 * law.speed_proportional)


@pytest.mark.parametrize(
    ("motor", "constant"),
    [
        (sw.motor.CurrentSource(torque_constant=0.1, inertia=1e-4), 0.1),
        (sw.motor.DC(torque_constant=0.07, inertia=1e-4), 0.07),
        (sw.motor.TorqueSource(inertia=1e-4), 1.0),
        (
            sw.motor.PMSM(
                resistance=0.5, direct_inductance=1e-3, quadrature_inductance=1e-3, flux_linkage=0.01, pole_pairs=5,
                inertia=1e-4, supply_voltage=48.0, current_limit=10.0,
            ),
            1.5 * 5 * 0.01,
        ),
    ],
)  # fmt: skip
def test_its_gains_are_those_of_the_torque_whatever_the_motor_takes(motor: object, constant: float) -> None:
    plant, torque = plant_of(motor), plant_of(sw.motor.TorqueSource(inertia=1e-4))
    assert plant.actuation_per_torque == pytest.approx(1.0 / constant)
    assert tuned_law(plant, FAST).speed_proportional * constant == pytest.approx(tuned_law(torque, FAST).speed_proportional)


def test_it_holds_a_step_of_the_load() -> None:
    """The integral takes all of it: the position comes back."""
    plant = plant_of(sw.motor.CurrentSource(torque_constant=0.1, inertia=8e-5))
    drive = plant.controlled(tuned_law(plant, Setting(0.5, "input", 0.0)), sw.Compensation())
    run = sw.simulate(drive, sw.scenario.constant(0.0, 3.0), load_torque=sw.scenario.step(5.0, 3.0, start=0.1), sample=1e-3)
    assert np.abs(run["input_angle"]).max() > 1e-3
    assert np.abs(run["input_angle"][-500:]).max() < 0.05 * np.abs(run["input_angle"]).max()


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        ({"motor": sw.motor.AccelerationSource()}, "takes AccelerationSource"),
        ({"load": sw.loads.Prescribed()}, "prescribes the motion"),
    ],
)
def test_what_cannot_be_compensated_is_refused(parts: dict[str, object], words: str) -> None:
    drive = sw.Drive(**({"gear": GEAR, "motor": sw.motor.TorqueSource(inertia=1e-4), "load": ARM} | parts))
    with pytest.raises(ValueError, match=words):
        Plant.of(sw.GearSet.of(drive, name="joint", source="stated"), 1e-3, 0.0)


def test_a_load_without_inertia_is_refused() -> None:
    """A log at constant speed determines no inertia, and `identify` writes 1e-12 kg.m2."""
    drive = sw.Drive(gear=GEAR, motor=sw.motor.TorqueSource(inertia=1e-4), load=sw.loads.Inertia(inertia=1e-12))
    with pytest.raises(ValueError, match=r"joint: load and gear vibrate at up to 1\.73e\+08 rad/s.*inertia is 1e-12 kg\.m2"):
        Plant.of(sw.GearSet.of(drive, name="joint", source="stated"), 1e-3, 0.0)


def test_a_model_has_the_temperature_at_which_the_drive_starts() -> None:
    """The file of the pointing joint states -20 degC; the robot joint of the catalogue starts in a room of 20 degC."""
    for name, celsius in (("space-pointing-joint", -20.0), ("robot-joint", 20.0)):
        plant = Plant.of(sw.GearSet.read(name), 1e-3, 0.0)
        assert model_of(plant, plant.drive.gear).temperature == pytest.approx(273.15 + celsius)
    plant = Plant.of(sw.GearSet.of(plant.drive.replace(thermal=sw.thermal.Isothermal()), name="x", source="x"), 1e-3, 0.0)
    assert model_of(plant, plant.drive.gear).temperature == sw.Gear().softening.reference_temperature
