"""Drive logs: a simulated drive with known gear comes back from its log, as far as its encoders let it."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from strainwave.identification.candidates.drive_log import fit_log, free_parameters, prepared
from strainwave.identification.experiments.drive_log import DriveLog

TRUTH = sw.Gear(
    kinematics=sw.kinematics.StrainWave(flexspline_teeth=100, circular_spline_teeth=102),
    kinematic_error=sw.kinematic_error.Fourier(order=[1, 2, 4], amplitude=[5e-5, 3e-4, 4e-5], phase=[0.4, -1.0, 2.0]),
    stiffness=sw.stiffness.Linear(k=1.2e4),
    damping=5.0,
    friction_input=sw.friction.Coulomb(coulomb=0.03, breakaway=0.03, viscous=4e-4),
)


def drive(gear: sw.Gear) -> sw.Drive:
    return sw.Drive(
        gear=gear,
        motor=sw.motor.DC(resistance=0.5, inductance=5e-4, torque_constant=0.1, back_emf=0.1, inertia=1e-4),
        load=sw.loads.Pendulum(inertia=0.3, gravity_torque=8.0),
    )


def recording(columns: list[str], noise: float = 0.0, gear: sw.Gear = TRUTH) -> sw.Recording:
    time = np.linspace(0.0, 2.0, 1001)
    command = sw.scenario.table(time, 5.0 * np.sin(2.0 * np.pi * time) * np.minimum(1.0, 5.0 * time))
    run = sw.simulate(drive(gear), command, sample=2e-3).select(["time", "command", *columns])
    random = np.random.default_rng(7)
    scale = {"input_angle": 1.0, "output_angle": 1e-2, "current": 10.0}
    return sw.Recording(
        {name: run[name] + noise * scale.get(name, 0.0) * random.normal(size=len(run)) for name in run.names},
        {name: run.unit(name) for name in run.names},
    )


START = TRUTH.replace(
    kinematic_error=sw.kinematic_error.Fourier(),
    stiffness=sw.stiffness.Linear(k=9e3),
    friction_input=sw.friction.Coulomb(coulomb=0.02, breakaway=0.02, viscous=2e-4),
)


@pytest.mark.slow("identification")
def test_two_encoders_tell_friction_stiffness_and_kinematic_error() -> None:
    start = drive(START)
    log = DriveLog.of(recording(["input_angle", "output_angle"], noise=1e-3), start)
    start = prepared(log, start, friction_known=False)
    found = fit_log(log, start, free_parameters(log, start, friction_known=False, torsion_known=False))
    gear = found.fit.gear
    assert gear.friction_input.coulomb == pytest.approx(0.03, rel=0.02)
    assert gear.friction_input.viscous == pytest.approx(4e-4, rel=0.02)
    assert gear.stiffness.k == pytest.approx(1.2e4, rel=0.02)
    assert gear.kinematic_error.amplitude == pytest.approx((5e-5, 3e-4, 4e-5), abs=3e-6)
    assert found.error == pytest.approx([1e-3, 1e-5], rel=0.15)  # nothing but the noise is left where it was not fitted


def modulated(law: object) -> sw.Gear:
    """The gear with a friction that varies over the turn, and with the temperature."""
    cyclic = sw.friction.Cyclic(law=law, order=[2.0], amplitude=[0.3], phase=[0.4])
    thermal = sw.friction.Thermal(law=cyclic, dry_fall=0.01, viscous_fall=0.03, reference_temperature=303.15)
    return TRUTH.replace(friction_input=thermal)


@pytest.mark.slow("identification")
@pytest.mark.parametrize("start", [START.friction_input, sw.friction.Viscous(viscous=2e-4)])
def test_friction_within_other_laws_comes_back(start: object) -> None:
    recorded = recording(["input_angle"], gear=modulated(TRUTH.friction_input))
    begun = drive(modulated(start))
    log = DriveLog.of(recorded, begun)
    begun = prepared(log, begun, friction_known=False)
    free = free_parameters(log, begun, friction_known=False, torsion_known=True)
    assert free == ["gear.friction_input.law.law.coulomb", "gear.friction_input.law.law.viscous"]
    law = fit_log(log, begun, free).fit.gear.friction_input.law.law
    assert (law.coulomb, law.viscous) == pytest.approx((0.03, 4e-4), rel=1e-6)


def test_one_encoder_tells_friction_alone() -> None:
    start = drive(START)
    log = DriveLog.of(recording(["input_angle", "current"]), start)
    free = free_parameters(log, prepared(log, start, friction_known=False), friction_known=False, torsion_known=False)
    assert free == ["gear.friction_input.coulomb", "gear.friction_input.viscous"]


def test_what_a_better_measurement_gave_is_left_alone() -> None:
    start = drive(START)
    log = DriveLog.of(recording(["input_angle", "output_angle"]), start)
    free = free_parameters(log, prepared(log, start, friction_known=False), friction_known=True, torsion_known=True)
    assert free == ["gear.kinematic_error.amplitude", "gear.kinematic_error.phase"]


def test_a_log_that_starts_in_motion_is_refused() -> None:
    moving = recording(["input_angle"]).between(0.35, 2.0)
    level = drive(START).replace(load=sw.loads.Inertia(inertia=0.3))
    with pytest.raises(ValueError, match="must start at rest: input_angle starts at"):
        fit_log(DriveLog.of(moving, level), level, ["gear.friction_input.coulomb"])


def test_a_log_without_a_measured_column_is_refused() -> None:
    only = recording(["input_angle"]).select(["time", "command"])
    with pytest.raises(ValueError, match="needs a measured column to compare"):
        DriveLog.of(only, drive(START))


def test_a_coarse_log_that_starts_at_rest_is_accepted() -> None:
    time = np.linspace(0.0, 1.0, 201)
    run = sw.simulate(drive(TRUTH), sw.scenario.table(time, 5.0 * np.sin(6.0 * time)), sample=5e-3)
    log = DriveLog.of(run.select(["time", "command", "input_angle"]), drive(START))
    assert fit_log(log, drive(START), ["gear.friction_input.coulomb"]).fit.gear.friction_input.coulomb > 0.0


def test_a_log_under_gravity_that_does_not_start_hanging_is_refused() -> None:
    raised = recording(["output_angle"])
    raised = raised.with_column("output_angle", raised["output_angle"] + 0.9, "rad")
    with pytest.raises(ValueError, match=r"arm hanging.*output_angle it starts at 0.9"):
        DriveLog.of(raised, drive(START))
