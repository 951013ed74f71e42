"""The core of the workbench, in WebAssembly: the bits of the package, and no trap on any input."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import Phase, given, settings
from numpy.typing import NDArray
from strainwave import _core
from strainwave.rig.virtual.printed import printed_gear
from strainwave.workbench.schema import schema, values_of

from tests.python.rig.loops import TABLE, refined, vertices
from tests.python.workbench.node import doubles, in_node, needs_node, needs_page
from tests.support import strategies

pytestmark = [needs_page, needs_node, pytest.mark.slow("native")]

DRIVES = 400
OF_ARCTAN = {
    "Misalignment",
    "MultiCompliance",
}  # arctan is the C library's, whose last bit is not that of every other C library
ROUNDING_SHARE = 1e-11  # of the largest value of a row: rounding of a law with an arctan
RECORDED = [1, 2, 3, 4, 5, 6, 8, 9]  # input and output motion, twist, error, torque, friction
TWIST = np.concatenate([np.linspace(0.0, 8e-4, 30), np.linspace(7e-4, -9e-4, 40), np.linspace(-8e-4, 5e-4, 30)])
SPEED = np.linspace(-80.0, 80.0, 41)
ANGLE = np.linspace(-9.0, 9.0, 41)
INSTANTS = np.linspace(0.0, 2e-3, 21)


def random_drives(count: int) -> list[sw.Drive]:
    found: list[sw.Drive] = []

    @settings(max_examples=count, phases=[Phase.generate], database=None, deadline=None, derandomize=True)
    @given(strategies.drives)
    def collect(drive: sw.Drive) -> None:
        found.append(drive)

    collect()
    return found[:count]


@pytest.fixture(scope="module")
def drives() -> list[sw.Drive]:
    return random_drives(DRIVES)


def inputs() -> NDArray[np.float64]:
    """Inputs of a sine at start, middle and end of each step, shape (steps, 3, 6)."""
    given = np.zeros((len(INSTANTS) - 1, 3, 6))
    time = INSTANTS[:-1, None] + np.diff(INSTANTS)[:, None] * np.array([0.0, 0.5, 1.0])
    given[..., 0], given[..., 1] = 1e-3 * np.sin(900.0 * time), 0.9 * np.cos(900.0 * time)
    given[..., 4] = 293.15
    return given


def native_run(drive: sw.Drive) -> NDArray[np.float64]:
    laid_out = inputs()
    state = _core.begin(drive, drive.rest().numbers, laid_out[0, 0])
    out = np.empty((len(RECORDED), len(INSTANTS)))
    out[:, 0] = _core.now(drive, state, laid_out[0, 0])[RECORDED, 0]
    keep = np.ones(len(INSTANTS) - 1, np.uint8)
    _core.simulate(drive, state, INSTANTS, laid_out, keep, _core.Method.exponential, RECORDED, out, 1, None)
    return out


def native(drive: sw.Drive) -> dict[str, list[Any] | None]:
    """Return what the package computes; None where it refuses."""
    gear = drive.gear
    filled = [np.full(len(SPEED), value) for value in (3.0, 300.0)]
    verbs = {
        "loop": lambda: [gear.trace(TWIST)],
        "friction": lambda: [_core.differentiate_steady(gear, SPEED, ANGLE, *filled, [])[0]],
        "error": lambda: [gear.kinematic_error.error(ANGLE), gear.kinematic_error.slope(ANGLE)],
        "noise": lambda: [gear.kinematic_noise.error(ANGLE)],
        "ratio": lambda: [np.array([gear.kinematics.ratio])],
        "spring": lambda: [gear.stiffness.torque(TWIST), gear.stiffness.tangent(TWIST)],
        "run": lambda: list(native_run(drive)),
    }
    found: dict[str, list[Any] | None] = {}
    for name, verb in verbs.items():
        try:
            rows = verb()
        except ValueError:  # beyond where a law is valid
            rows = None
        found[name] = rows if rows is not None and all(np.isfinite(row).all() for row in rows) else None
    return found


def test_the_bits_are_those_of_the_package(drives: list[sw.Drive]) -> None:
    filled = {name: [value] * len(SPEED) for name, value in (("load", 3.0), ("temperature", 300.0))}
    points = {"twist": TWIST.tolist(), "speed": SPEED.tolist(), "angle": ANGLE.tolist(), **filled}
    of_run = {"instants": INSTANTS.tolist(), "inputs": inputs().ravel().tolist(), "recorded": RECORDED}
    computed = in_node("compute", core=True, schema=schema(), drives=[values_of(each) for each in drives], **points, **of_run)
    assert len(computed) == DRIVES
    compared = dict.fromkeys(computed[0], 0)
    for drive, in_page in zip(drives, computed, strict=True):
        with warnings.catch_warnings(action="ignore"):
            expected = native(drive)
        has_arctan = bool(strategies.models_of(drive) & OF_ARCTAN)
        for name, rows in expected.items():
            if rows is None:
                continue
            assert in_page[name] is not None, (name, drive)
            for row, encoded in zip(rows, in_page[name], strict=True):
                if has_arctan:
                    assert doubles(encoded) == pytest.approx(row, rel=1e-11, abs=ROUNDING_SHARE * np.abs(row).max()), (
                        name,
                        drive,
                    )
                else:
                    assert doubles(encoded).tobytes() == np.ascontiguousarray(row).tobytes(), (name, drive)
            compared[name] += not has_arctan
    assert min(compared.values()) > DRIVES // 3, compared


def test_friction_of_mesh_and_output_is_that_of_their_laws_at_their_shafts() -> None:
    lossy = sw.friction.LoadDependent(
        driving_forward=0.1, driving_reverse=0.15, backdriving_forward=0.2, backdriving_reverse=0.25
    )
    wave = sw.friction.Cyclic(law=sw.friction.Coulomb(coulomb=0.4, viscous=0.5), order=[1.0], amplitude=[0.1], phase=[0.3])
    gear = sw.load("csg-20-100").replace(friction_mesh=lossy, friction_output=wave)
    view = {"load": 0.3, "temperature": 293.15}
    drive = values_of(sw.Drive(gear=gear))
    given = {"schema": schema(), "drive": drive, "speed": SPEED.tolist(), "angle": ANGLE.tolist(), "view": view}
    found = dict(zip(("input", "mesh", "output", "sum"), in_node("places", core=True, **given), strict=True))

    def steady(law: Any, ratio: float) -> NDArray[np.float64]:
        alone = gear.replace(friction_input=law)
        conditions = np.full(len(SPEED), 0.3 * ratio), np.full(len(SPEED), 293.15)
        return _core.differentiate_steady(alone, SPEED / ratio, ANGLE / ratio, *conditions, [])[0]

    ratio = gear.kinematics.ratio
    assert ratio < 0.0  # the output turns the other way
    assert found["input"] == pytest.approx(steady(gear.friction_input, 1.0), rel=1e-14)
    assert found["mesh"] == pytest.approx(steady(lossy, -ratio), rel=1e-14)
    assert found["output"] == pytest.approx(steady(wave, -ratio), rel=1e-14)
    total = steady(gear.friction_input, 1.0) + (steady(lossy, ratio) + steady(wave, ratio)) / ratio
    assert found["sum"] == pytest.approx(total, rel=1e-14)


def test_no_set_of_numbers_ends_in_a_trap(drives: list[sw.Drive]) -> None:
    spoilt = ["NaN", "Infinity", 1e300, -1e300, 1e-300, 0.0]
    codes = in_node("spoil", core=True, schema=schema(), drives=[values_of(each) for each in drives[:12]], spoilt=spoilt)
    refused, done = 1, 0
    assert {code for value, *each in codes["number"] if value is None for code in each} == {refused}  # NaN and inf are null
    assert {code for value, *each in codes["points"] if value is None for code in each} == {refused}
    assert {code for *_, code in codes["number"]} >= {done, refused}
    for kind in ("law", "shape", "counts"):
        assert set(codes[kind]) == {refused}, kind


def loop_of_the_article() -> tuple[sw.Gear, NDArray[np.float64], NDArray[np.float64]]:
    """A gear near that of the torsional stiffness article's Table 2 at 0 degrees; twist [rad] and torque [N.m] of that loop."""
    angle, torque = refined(*vertices(TABLE[0.0]), 0.002)
    noise = np.random.default_rng(1).normal(size=len(angle))
    scale = {"positive_unloading": 1.02, "negative_loading": 0.98, "negative_unloading": 1.02, "positive_loading": 1.02}
    truth = printed_gear(0)
    start = truth.replace({f"hysteresis.{name}": by * getattr(truth.hysteresis, name) for name, by in scale.items()})
    return start, angle / 100.0 + 3e-3, 100.0 * torque + 0.2 * noise  # at the output of 1:100, with a zero of the camera


def loop_of_elements() -> tuple[sw.Gear, NDArray[np.float64], NDArray[np.float64]]:
    """A gear of three segments and three elements away from the truth; twist [rad] and torque [N.m] of loops in a loop."""
    gear = sw.load("hfuc-25-100")
    turns = 1.4e-3 * np.array([1.0, -1.0, 1.0, -0.5, 0.5, -0.25, 1.0])
    twist = np.concatenate([np.linspace(a, b, 200, endpoint=False) for a, b in pairwise(turns)])
    torque = gear.trace(np.concatenate([[0.0], twist, twist]))[-len(twist) :] - 1.5
    law = gear.hysteresis
    start = gear.replace(
        {"stiffness.k1": 0.95 * gear.stiffness.k1, "hysteresis.stiffness": [1.05 * each for each in law.stiffness]}
    )
    return start, twist + 1e-4, torque + 0.05 * np.random.default_rng(1).normal(size=len(twist))


@pytest.mark.parametrize("record", [loop_of_the_article, loop_of_elements])
def test_a_fit_of_a_loop_is_that_of_the_package(
    record: Callable[[], tuple[sw.Gear, NDArray[np.float64], NDArray[np.float64]]],
    record_property: Callable[[str, float], None],
) -> None:
    start, twist, torque = record()
    parts = ("hysteresis", "stiffness")
    is_spring = record is loop_of_elements  # the article's torque is all hysteresis: its spring has no influence
    free = [path for path, *_ in _core.parameters(start) if path.startswith(parts[: 1 + is_spring])]
    expected = sw.fit(start, sw.Recording({"twist": twist, "torque": torque}, {"twist": "rad", "torque": "N.m"}), free=free)
    given = {"schema": schema(), "drives": [values_of(sw.Drive(gear=start))], "x": twist.tolist(), "y": torque.tolist()}
    (found,) = in_node("fit", core=True, parts=parts, **given)
    record_property("seconds of the fit in the page", found["seconds"])
    assert found["rms"] == pytest.approx(expected.rms()[0], rel=1e-6)
    assert abs(found["correlation"]) < 0.2
    estimates = list(expected.estimates)
    assert [each.path for each in estimates[-2:]] == ["torque_zero", "twist_zero"]
    assert found["kept"] == (0 if is_spring else 1)
    numbers = dict(zip((path for path, *_ in _core.parameters(start) if path.startswith(parts)), found["numbers"], strict=True))
    if not is_spring:
        assert numbers["stiffness.k"] == start.stiffness.k
    numbers |= dict(zip(("torque_zero", "twist_zero"), found["zeros"], strict=True))
    for estimate in estimates:
        number = numbers[estimate.path]
        assert number == pytest.approx(estimate.value, rel=1e-9, abs=0.03 * estimate.sigma), estimate.path


def test_a_fit_that_ends_beside_the_truth_leaves_residuals_that_follow_one_another() -> None:
    start, twist, torque = loop_of_the_article()
    far = start.replace({"hysteresis.onset": 2.3, "hysteresis.lost_motion": 0.0115})
    given = {"schema": schema(), "drives": [values_of(sw.Drive(gear=far))], "x": twist.tolist(), "y": torque.tolist()}
    (found,) = in_node("fit", core=True, parts=["hysteresis"], **given)
    assert found["rms"] > 0.5
    assert found["correlation"] > 0.5
