"""What a fit leaves unexplained, and the mistakes that would explain it."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest
import strainwave as sw
from strainwave.demo import torsion_rig
from strainwave.files.entries import Entry
from strainwave.files.gear_set import GearSet
from strainwave.identification.checks.unexplained import (
    MAX_SHARE_OF_SHAPE,
    OVER_OUTPUT,
    OVER_SPEED,
    OVER_TURN,
    SHAPE_OF_RESIDUALS,
    causes,
    has_shape,
    judged_shape,
    largest_shape,
    left,
)
from strainwave.report.identify import identify_report

from tests.evidence import shapes

TEETH = {"flexspline_teeth": 100, "circular_spline_teeth": 102}
GEAR = sw.Gear(
    kinematics=sw.kinematics.StrainWave(**TEETH),
    stiffness=sw.stiffness.Linear(k=1.2e4),
    damping=5.0,
    friction_input=sw.friction.Coulomb(coulomb=0.03, breakaway=0.03, viscous=4e-4),
)
MOTOR = sw.motor.DC(resistance=0.5, inductance=5e-4, torque_constant=0.1, back_emf=0.1, inertia=1e-4)
ANGLE = np.linspace(0.0, 200.0, 4000)
NOISE = 0.1 * np.random.default_rng(5).normal(size=len(ANGLE))


def drive(gear: sw.Gear = GEAR, inertia: float = 0.3) -> sw.Drive:
    return sw.Drive(gear=gear, motor=MOTOR, load=sw.loads.Inertia(inertia=inertia))


@cache
def log() -> sw.Recording:
    time = np.linspace(0.0, 0.4, 201)
    voltage = 8.0 * np.sin(4.0 * np.pi * time) * np.minimum(1.0, 10.0 * time)
    run = sw.simulate(drive(), sw.scenario.table(time, voltage), sample=2e-3)
    return run.select(["time", "command", "input_angle", "output_angle"])


def start(**changes: object) -> GearSet:
    begun = drive(GEAR.replace(stiffness=sw.stiffness.Linear(k=1e4), **changes))
    return GearSet.of(begun, name="start", source="assumed")


def scaled(name: str, factor: float) -> sw.Recording:
    return log().with_column(name, factor * log()[name], log().unit(name))


MISTAKES = {
    "none": (log, {}, ""),
    "sign": (lambda: scaled("output_angle", -1.0), {}, 'the sign of "output_angle" is reversed'),
    "unit": (lambda: scaled("input_angle", 180.0 / np.pi), {}, '"input_angle" is in deg, not in rad'),
    "command": (lambda: scaled("command", -1.0), {}, 'the sign of "command" is reversed'),
    "ratio": (
        log,
        {"kinematics": sw.kinematics.StrainWave(flexspline_teeth=80, circular_spline_teeth=82)},
        "the ratio of the gear is about 49.8, not 40",
    ),
    "side": (
        lambda: sw.Recording(
            {
                "time": log().time,
                "command": log()["command"],
                "input_angle": log()["output_angle"],
                "output_angle": log()["input_angle"],
            },
            log().units,
        ),
        {},
        "the columns of angle are swapped",
    ),
}


@pytest.mark.slow("identification")
@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_named_and_nothing_identified(mistake: str) -> None:
    recording, changes, cause = MISTAKES[mistake]
    found = sw.identify(start(**changes), {"run": recording()})
    if not cause:
        assert found.failed == ()
        return
    (check,) = found.failed
    assert cause[1:] in check.message
    assert check.message.startswith("the model does not explain it")
    assert check.remedy
    assert check.value > check.limit
    assert not [state for state in found.states if state.state.startswith("identified")]
    assert found.parameters == ()


def test_the_cause_that_comes_nearest_comes_first() -> None:
    first, *_ = causes(scaled("output_angle", -1.0), drive(), {})
    assert first.what == 'the sign of "output_angle" is reversed'
    assert first.recording == log()


def test_noise_explains_itself() -> None:
    time = np.linspace(0.0, 10.0, 5000)
    signal = np.sin(time)
    noisy = signal + 0.5 * np.random.default_rng(0).normal(size=len(time))
    assert left(noisy[np.newaxis], signal[np.newaxis])[0] < 0.15
    half = np.sqrt(np.mean(signal**2)) / np.std(signal)  # the sine is not quite of mean zero over the record
    assert left(signal[np.newaxis], 0.8 * signal[np.newaxis])[0] == pytest.approx(0.2 * half, rel=1e-3)
    assert left(np.ones((1, 9)), np.ones((1, 9)))[0] == 0.0


@pytest.mark.slow("identification")
def test_a_kept_parameter_that_the_run_contradicts_is_named() -> None:
    """A load a third too heavy; everything else is well known."""
    wrong = drive(GEAR.replace(stiffness=sw.stiffness.Linear(k=1e4)), inertia=0.4)
    gear_set = GearSet.of(wrong, name="start", source="assumed")
    known = {path: Entry("measured", spread=1e-3) for path in gear_set.sources if path.startswith(("motor.", "load."))}
    known["load.inertia"] = Entry("weighed", spread=0.05)
    gear_set = gear_set.replace(sources={**gear_set.sources, **known})
    found = sw.identify(gear_set, {"run": log()})
    (remark,) = (remark for remark in found.files[0].remarks if "contradicts what was kept" in remark)
    assert "load.inertia = 0.4 kg.m2" in remark
    stiffness = next(estimate for estimate in found.files[0].estimates if estimate.path == "gear.stiffness.k")
    assert abs(stiffness.value / 1.2e4 - 1.0) < 0.1 or stiffness.state == "not identified"


def judged(size: float):  # type: ignore[no-untyped-def]
    wave = size * np.sqrt(2.0) * np.sin(ANGLE)
    return judged_shape(NOISE + wave, {OVER_TURN: np.mod(ANGLE, 2.0 * np.pi), OVER_SPEED: np.cos(ANGLE)}, 1.0, "A", "log.csv")


def test_white_residuals_pass_without_a_remark() -> None:
    (check,), remarks = judged(0.0)
    assert (check.name, check.value, check.failed, remarks) == (SHAPE_OF_RESIDUALS, 0.0, False, ())


def test_a_small_shape_is_a_remark_with_its_size() -> None:
    (check,), (remark,) = judged(0.05)
    assert has_shape(check)
    assert remark.startswith("the residual has a shape over the turn of the input: RMS ")
    assert remark.endswith(f"{100.0 * check.value:.2g} % of the signal")
    assert check.value == pytest.approx(0.05, abs=0.005)


def test_a_large_shape_fails() -> None:
    (check,), remarks = judged(0.35)
    assert check.failed
    assert check.limit == MAX_SHARE_OF_SHAPE
    assert "over the turn" in check.message
    assert not remarks


@pytest.mark.parametrize("numbers", [[], ["load.gravity_torque"]])
def test_a_large_shape_fails_if_it_moves_a_number_beyond_its_uncertainty(numbers: list[str]) -> None:
    asked = list[str]()

    def biased(over: str) -> list[str]:
        asked.append(over)
        return numbers

    wave = 0.35 * np.sqrt(2.0) * np.sin(ANGLE)
    (check,), remarks = judged_shape(NOISE + wave, {OVER_TURN: np.mod(ANGLE, 2.0 * np.pi)}, 1.0, "A", "log.csv", biased=biased)
    assert asked == [OVER_TURN]
    assert check.failed == bool(numbers)
    (words,) = remarks or (check.message,)
    assert "the model lacks a ripple over the turn of the input" in words
    assert ("moves load.gravity_torque by more than the uncertainty" in words) == bool(numbers)
    assert has_shape(check) != bool(numbers)


@pytest.mark.slow("identification")
@pytest.mark.parametrize("size", [0.0, 2.0, 8.0])
def test_gravity_is_as_uncertain_as_a_second_load_that_the_model_lacks(size: float) -> None:
    """A cable pulls at twice the angle of the output: over a part of a turn a model without it takes it for gravity."""
    time = np.arange(0.0, 30.0, 0.01)
    angle = 0.5 + 0.7 * np.sin(0.9 * time) + 0.2 * np.sin(2.3 * time)
    speed, rise = (np.gradient(angle, time), np.gradient(np.gradient(angle, time), time))
    torque = 1.2 * rise + 6.0 * np.sin(angle) + 3.0 * np.sign(speed) + 2.0 * speed + size * np.cos(2.0 * angle)
    torque += 0.1 * np.random.default_rng(0).standard_normal(len(time))
    log = sw.Recording(
        {"time": time, "output_angle": angle, "joint_torque": torque},
        {"time": "s", "output_angle": "rad", "joint_torque": "N.m"},
    )
    (file,) = sw.identify("csg-20-100", {"log": log}, accept=True).files
    estimates = {each.path: each for each in file.estimates}
    gravity = estimates["load.gravity_torque"]
    assert abs(gravity.value - 6.0) < 2.0 * gravity.sigma
    assert bool(gravity.why) == (size > 0.0)
    assert bool(estimates["load.gravity_phase"].why) == (size > 0.0)
    assert any("has a shape over the angle of the output" in each for each in file.remarks) == (size > 0.0)
    for path, truth in {"gear.friction_input.coulomb": 0.03, "gear.friction_input.viscous": 2e-4}.items():
        assert abs(estimates[path].value - truth) < 2.0 * estimates[path].sigma < 0.3 * truth


@pytest.mark.slow("identification")
def test_a_log_with_a_second_load_that_makes_its_inertia_wrong_fails() -> None:
    """A torque at 3.8 times the angle, 70 % of the others: the inertia of 16 kg.m2 came out as 26 with nearly no error."""
    time = np.arange(0.0, 30.0, 0.01)
    angle = 0.7 + 0.8 * np.sin(1.4 * time) + 0.35 * np.sin(2.0 * time)
    speed, rise = (np.gradient(angle, time), np.gradient(np.gradient(angle, time), time))
    torque = 16.0 * rise + 20.0 * np.sin(angle) + 2.6 * np.sign(speed) + 1.4 * speed
    torque += 0.7 * np.std(torque) * np.sqrt(2.0) * np.cos(3.8 * angle + 2.0)
    torque += 0.3 * np.random.default_rng(0).standard_normal(len(time))
    log = sw.Recording(
        {"time": time, "output_angle": angle, "joint_torque": torque},
        {"time": "s", "output_angle": "rad", "joint_torque": "N.m"},
    )
    failed = {check.name: check.message for check in sw.identify("csg-20-100", {"log": log}).failed}
    assert "moves load.inertia by more than the uncertainty" in failed[SHAPE_OF_RESIDUALS]


@pytest.mark.parametrize(
    ("over", "share", "counts"), [(OVER_OUTPUT, 0.05, True), (OVER_SPEED, 0.05, False), (OVER_SPEED, 0.35, True)]
)
def test_a_small_shape_over_the_speed_makes_no_number_less_certain(over: str, share: float, counts: bool) -> None:
    """Torques over the speed resemble friction: an arbitrary one made right friction of EMPS five times as uncertain."""
    residual = 0.1 * NOISE + share * np.sqrt(2.0) * np.sin(ANGLE)
    assert largest_shape(residual, {over: np.mod(ANGLE, 2.0 * np.pi)}, 1.0) == (over if counts else "")


def test_few_samples_have_no_check() -> None:
    assert judged_shape(NOISE[:20], {OVER_SPEED: ANGLE[:20]}, 1.0, "A", "log.csv", ordered=True) == ((), ())


@pytest.mark.slow("identification")
def test_the_saw_tooth_of_the_torsion_article_stands_in_the_verdict() -> None:
    found = torsion_rig()
    (check,) = (each for each in found.checks if each.name == SHAPE_OF_RESIDUALS)
    assert not check.failed
    assert check.value == pytest.approx(0.82, abs=0.05)  # N.m
    page = identify_report(found)
    assert "all 5 checks passed; the residual has a shape of RMS 0.824 N·m." in page.replace("\N{NO-BREAK SPACE}", " ")


@pytest.mark.slow("identification")
@pytest.mark.parametrize("draw", [shapes.table, shapes.loop, shapes.log])
def test_right_records_with_white_noise_have_no_shape(draw: Callable[[np.random.Generator], shapes.Drawn]) -> None:
    """A few of `python -m tests.evidence.shapes`, which draws 200 of each."""
    assert shapes.named(draw, 3) == (3, 0, 0)
