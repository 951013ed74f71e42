"""One trajectory in double, in a pack and in dual numbers; and the derivatives against differences."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray
from strainwave import Drive, _core
from strainwave.files.described import parts
from strainwave.simulation.ensemble import COUNTED_NAMES
from strainwave.simulation.excitation import Excitation
from strainwave.simulation.run import differentiate
from strainwave.simulation.signals import outputs

from tests.support.joint_sized import INPUT_SIZES, OUTPUT_SIZES, joint_sized
from tests.support.reference_drive import DRIVE, command
from tests.support.samples import sample
from tests.support.side_by_side import side_by_side
from tests.support.strategies import made

Array = NDArray[np.float64]

DT, SAMPLE = 2e-4, 1e-3
COLUMNS = list(outputs(sw.Drive()))

STRIBECK = sw.friction.Stribeck(coulomb=0.03, breakaway=0.045, stribeck_speed=2.0, viscous=5e-5)
COULOMB = sw.friction.Coulomb(coulomb=3.0, breakaway=4.0, viscous=0.5)
NOISE = sw.kinematic_error.Stochastic(
    amplitude=1.5e-5, seed=11, load_sensitivity=0.02, speed_sensitivity=0.01, insertion_depth=1e-3, depth_sensitivity=50.0
)
BRISTLE = DRIVE.replace(
    gear=DRIVE.gear.replace(
        input_inertia=1e-5,
        kinematic_noise=NOISE,
        friction_input=DRIVE.gear.friction_input.replace(damping_fading=0.2),
        friction_mesh=sw.friction.Viscous(viscous=0.3),
        softening=sw.softening.ThermalSoftening(stiffness_fall=3e-4, hysteresis_fall=5e-4, reference_temperature=283.0),
    ),
    motor=DRIVE.motor.replace(resistance_rise=3.9e-3),
    control=sw.control.PID(proportional=2.0, integral=1.0, derivative=0.05),
)  # no number of it is zero, so that each can be varied by a share of itself; but that of the brushes, which suit no inductance
DRIVES = {
    "bristle": BRISTLE,
    "stribeck at the input": BRISTLE.replace(gear=BRISTLE.gear.replace(friction_input=STRIBECK)),
    "coulomb at the output": BRISTLE.replace(gear=BRISTLE.gear.replace(friction_output=COULOMB)),
    "both": BRISTLE.replace(gear=BRISTLE.gear.replace(friction_input=STRIBECK, friction_output=COULOMB)),
    "brushes": BRISTLE.replace(motor=BRISTLE.motor.replace(inductance=0.0, brush_drop=0.3, cogging_torque=2e-3)),
}
SWING = sw.scenario.sine(0.02, 3.0, 0.35)  # small and slow enough for a set-valued side to stick at its turns

every_drive = pytest.mark.parametrize("drive", DRIVES.values(), ids=DRIVES)


def numbers(drive: Drive) -> Array:
    return np.array([number for _, number, *_ in _core.parameters(drive)])


def columns(run: sw.Recording) -> Array:
    return np.stack([run[name] for name in COLUMNS])


def scales(drive: Drive, run: sw.Recording) -> Array:
    """How large the numbers in each column are; a bristle's torque is a difference of terms as large as its damping's."""
    largest = np.abs(columns(run)).max(axis=1)
    damping = getattr(drive.gear.friction_input, "bristle_damping", 0.0)
    row = COLUMNS.index("friction_input")
    largest[row] = max(largest[row], damping * np.abs(run["input_speed"]).max())
    return largest[:, None]


def scattered(drive: Drive, count: int, seed: int, whole_orders: bool) -> list[Drive]:
    """Drives that differ in every number but those that are counted, and in the orders of the error only if told."""
    factors = np.random.default_rng(seed).uniform(0.9, 1.1, (count, numbers(drive).size))
    paths = [path for path, *_ in _core.parameters(drive)]
    factors[:, [path.rpartition(".")[2] in COUNTED_NAMES or (whole_orders and ".order[" in path) for path in paths]] = 1.0
    return [_core.with_numbers(drive, numbers(drive) * factor) for factor in factors]


@every_drive
@settings(max_examples=sample(3, 8))
@given(seed=st.integers(0, 2**32 - 1), whole_orders=st.booleans(), swing=st.booleans())
def test_double_pack_and_dual_run_one_trajectory(drive: Drive, seed: int, whole_orders: bool, swing: bool) -> None:
    """Nine drives are one full pack, and one that repeats its last member."""
    course = SWING if swing else command(0.2)
    drives = scattered(drive, 9, seed, whole_orders)
    chosen = np.random.default_rng(seed).choice(numbers(drive).size, 3, replace=False)
    packed = side_by_side(drives, course, DT, sample=SAMPLE)
    for member, each in enumerate(drives):
        single = sw.simulate(each, course, DT, sample=SAMPLE)
        assert columns(packed.member(member)).tolist() == columns(single).tolist()
    dual, _ = differentiate(each, Excitation(course), chosen, DT, SAMPLE)
    assert np.all(np.abs(columns(dual) - columns(single)) <= 1e-12 * scales(each, single))


@pytest.mark.parametrize(
    ("name", "side"), [("stribeck at the input", "input"), ("coulomb at the output", "output"), ("both", "output")]
)
def test_the_swing_makes_a_set_valued_side_stick_and_slip(name: str, side: str) -> None:
    stuck = sw.simulate(DRIVES[name], SWING, DT, sample=SAMPLE)[f"{side}_speed"] == 0.0
    assert np.count_nonzero(np.diff(stuck)) >= 4


# Laws that need numbers of their own for each to act in this run.
OTHER_LAWS: dict[str, dict[str, Any]] = {
    "misalignment": {
        "kinematic_error": made(
            sw.kinematic_error.Misalignment,
            offset=1e-5,
            housing_eccentricity=2e-5,
            housing_direction=0.3,
            housing_tilt_x=1e-2,
            housing_tilt_y=2e-2,
            generator_eccentricity=1e-5,
            generator_direction=1.1,
            generator_tilt_x=1e-2,
            generator_tilt_y=3e-2,
        )
    },
    "tooth_errors": {
        "kinematic_error": made(
            sw.kinematic_error.ToothErrors,
            first_lobe=0.6,
            flexspline_amplitude=[2e-5, 1e-5],
            flexspline_phase=[0.3, 1.1],
            circular_spline_amplitude=[1e-5, 2e-5, 1e-5],
            circular_spline_phase=[0.2, -0.7, 2.1],
            flexspline_deviation=1e-5,
            circular_spline_deviation=2e-5,
            seed=7,
        )
    },
    "piecewise": {"stiffness": sw.stiffness.Piecewise(k1=8e3, k2=2e3, knee=5e-5)},
    "three_segment": {"stiffness": sw.stiffness.ThreeSegment(k1=8e3, k2=1e4, k3=1.3e4, t1=0.4, t2=0.9)},
    "scaled": {
        "kinematic_error": sw.kinematic_error.Scaled(
            law=sw.kinematic_error.Fourier(order=[1.0, 2.0], amplitude=[1e-4, 2e-4], phase=[0.3, -1.0]),
            load_sensitivity=0.02,
            insertion_depth=1e-3,
            depth_sensitivity=100.0,
        )
    },
    "temperature_dependent": {
        "kinematic_error": sw.kinematic_error.TemperatureDependent(
            law=sw.kinematic_error.Fourier(order=[1.0, 2.0], amplitude=[1e-4, 2e-4], phase=[0.3, -1.0]),
            order=[2.0, 2.02],
            change=[2e-6, 1e-6],
            phase=[0.5, 1.0],
            reference_temperature=273.15,
        )
    },
    "micro_slip": {
        "kinematic_noise": sw.kinematic_error.MicroSlip(
            excitation=0.05, friction=3.0, load_share=0.2, stiffness=5e3, lowest_order=2.0, highest_order=12.0, seed=5
        )
    },
    "generalised_maxwell": {"material": sw.material.GeneralisedMaxwell(stiffness=[2e3, 5e2], relaxation_time=[2e-3, 0.05])},
    "regimes": {
        "hysteresis": sw.hysteresis.Regimes(
            positive_unloading=4e3,
            negative_loading=1e3,
            negative_unloading=4.5e3,
            positive_loading=1.5e3,
            onset=0.05,
            lost_motion=1e-4,
        )
    },
    "position_dependent": {
        "friction_input": sw.friction.PositionDependent(
            quadratic=1e-4,
            linear=1e-3,
            constant=0.02,
            cosine=[0.002],
            sine=[0.003],
            static_ratio=1.2,
            speed_factor=0.3,
            reference_speed=1.0,
            viscous=5e-5,
            domain_start=-20.0,
            domain_end=20.0,
        )
    },
    "load_dependent": {
        "friction_mesh": sw.friction.LoadDependent(
            driving_forward=0.2, driving_reverse=0.25, backdriving_forward=0.3, backdriving_reverse=0.35
        )
    },
    "torque_efficiency": {
        "friction_mesh": sw.friction.TorqueEfficiency(average_loss=0.2, difference_loss=0.05, presliding=1e-3, viscous=0.1)
    },
    "mixed_lubrication": {
        "friction_input": sw.friction.MixedLubrication(
            coulomb=0.02,
            breakaway=0.03,
            stribeck_speed=2.0,
            viscous=5e-5,
            viscosity_fall=0.02,
            load_sensitivity=0.03,
            reference_temperature=280.0,
        )
    },
    "maxwell_slip_friction": {
        "friction_input": sw.friction.MaxwellSlipFriction(
            stiffness=[2.0, 1.0],
            share=[0.6, 0.4],
            coulomb=0.02,
            breakaway=0.03,
            stribeck_speed=2.0,
            attraction=0.5,
            viscous=5e-5,
        )
    },
    "curved_viscous": {
        "friction_input": sw.friction.CurvedViscous(
            coulomb=0.02, breakaway=0.03, stribeck_speed=2.0, viscous_torque=0.02, exponent=0.6, reference_speed=50.0
        )
    },
    "angle_speed_map": {
        "friction_input": sw.friction.AngleSpeedMap(
            speed=[1.0, 10.0, 60.0], level=[0.02, 0.025, 0.018, 0.03, 0.033, 0.029, 0.04, 0.045, 0.042], static_ratio=1.1
        )
    },
    "thermal": {
        "friction_input": sw.friction.Thermal(
            law=BRISTLE.gear.friction_input, dry_fall=0.01, viscous_fall=0.02, reference_temperature=300.0
        )
    },
}


PART_OF_FAMILY = {"friction": "friction_input"} | {
    name: name for name in ("kinematics", "kinematic_error", "stiffness", "hysteresis", "softening")
}
IN_DRIVES = {getattr(drive.gear, part.name).name for drive in DRIVES.values() for part in parts(sw.Gear)} | {"strain_wave"}
SIZED = {  # by name, of each law that is not listed: its part of a gear, and its class
    name: (part, kind)
    for family, part in PART_OF_FAMILY.items()
    for name, kind in _core.families[family].items()
    if name not in IN_DRIVES | set(OTHER_LAWS)
}


def law_of(name: str) -> dict[str, Any]:
    """Return a law as a part of a gear: one listed, or one with numbers of the size of the joint."""
    if name in OTHER_LAWS:
        return OTHER_LAWS[name]
    part, kind = SIZED[name]
    is_friction = part.startswith("friction")
    sizes = INPUT_SIZES if is_friction else OUTPUT_SIZES
    return {part: joint_sized(kind, sizes, within=BRISTLE.gear.friction_input if is_friction else None)}


@pytest.mark.parametrize("name", [*OTHER_LAWS, *SIZED])
def test_derivatives_by_the_numbers_of_every_law_are_what_differences_show(name: str) -> None:
    """Through stick, slip and reversals, to a part in 1e5 of the largest of each output: kinks let differences show no more."""
    law = law_of(name)
    drive = BRISTLE.replace(gear=BRISTLE.gear.replace(**law))
    (part,) = law
    base, known = numbers(drive), [path for path, *_ in _core.parameters(drive)]
    fixed = (
        ".domain_start",
        ".domain_end",
        ".seed",
        ".reduction",
        ".temperature",
    )  # the ratio of the gear, and that of the run
    own = [i for i, path in enumerate(known) if path.startswith(f"gear.{part}.") and not path.endswith(fixed)]
    run, slopes = differentiate(drive, Excitation(SWING), own, DT, SAMPLE)
    for i, slope in zip(own, slopes, strict=True):
        h = 2e-6 * abs(base[i])  # so small that a kink seldom lies within
        pair = []
        for sign in (1.0, -1.0):
            varied = base.copy()
            varied[i] += sign * h
            pair.append(columns(sw.simulate(_core.with_numbers(drive, varied), SWING, DT, sample=SAMPLE)))
        shown = (pair[0] - pair[1]) / (2.0 * h)
        size, rounding = np.abs(slope).max(axis=1), 1e-12 * scales(drive, run)[:, 0] / h
        assert np.any(size > 1e3 * rounding), f"{known[i]} changes nothing here: list {name} in OTHER_LAWS with numbers that do"
        assert np.all(np.abs(slope - shown) <= (1e-5 * size + rounding)[:, None]), known[i]


@pytest.mark.slow("physics")
@every_drive
def test_derivatives_are_what_differences_show(drive: Drive) -> None:
    """At every sample, stick-slip included: the times of its events move with the numbers.

    By every number, of a drive on bristles or of one with stick on both sides. Of all but the first, by the numbers of what
    sets them apart; of the others, by every fourth of those that they share with it.

    Central differences over h and h / 2, extrapolated, are as good as a run's rounding over h, and as their agreement:
    where a Maxwell element starts to slip within h at one sample and beyond it at the next, they disagree.
    """
    base, paths = numbers(drive), [path for path, *_ in _core.parameters(drive)]
    known = {path: number for path, number, *_ in _core.parameters(BRISTLE)}
    first, every = {id(BRISTLE): (0, 2), id(DRIVES["both"]): (1, 2)}.get(id(drive), (0, 4))
    chosen = [i for i, path in enumerate(paths) if base[i] != known.get(path) or i % every == first]
    run, slopes = differentiate(drive, Excitation(SWING), chosen, DT, SAMPLE)

    def difference(i: int, h: float) -> Array:
        up, down = base.copy(), base.copy()
        up[i] += h
        down[i] -= h
        pair = (sw.simulate(_core.with_numbers(drive, varied), SWING, DT, sample=SAMPLE) for varied in (up, down))
        return np.subtract(*map(columns, pair)) / (up[i] - down[i])

    for i, slope in zip(chosen, slopes, strict=True):
        if base[i] == 0.0:  # the inductance, or the brushes: another drive has it
            continue
        h = 1e-5 * abs(base[i])
        wide, narrow = difference(i, h), difference(i, 0.5 * h)
        allowed = 1e-6 * np.abs(slope) + 1e-13 * scales(drive, run) / h + 2.0 * np.abs(wide - narrow)
        resolution, size = allowed.max(axis=1), np.abs(slope).max(axis=1)
        assert np.all(np.abs(slope - (4.0 * narrow - wide) / 3.0) <= resolution[:, None]), paths[i]
        assert np.any(resolution < 1e-3 * size) or not size.any(), paths[i]  # the differences do show something
