"""The folder of a virtual test: what a real one leaves, the truth beside it, and what goes wrong when it is asked to."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from PIL import Image
from strainwave.rig import Masses, Rig, Step, Value, load, read_steps
from strainwave.rig.virtual.loading import load_by_steps
from strainwave.rig.virtual.render import Scene, render
from strainwave.rig.virtual.test import VirtualTest, simulate_test

GEAR = sw.Gear(
    stiffness=sw.stiffness.Linear(k=4e3), hysteresis=sw.hysteresis.MaxwellSlip(stiffness=[6e3, 3e3], breakaway=[2.0, 6.0])
)
MASSES = (Masses(0.1, 9, 1e-4), Masses(0.025, 16, 2.5e-5))
RIG = Rig("bench", "input", disk_radius=Value(0.1, 5e-5), masses=MASSES, pulley_torque=Value(0.002))
SCENE = Scene(size=(160, 120), radius=12.0, distance=70.0, noise=0.01)
STEPS = [Step(n, max(m, 0.0), max(-m, 0.0)) for n, m in enumerate((0.35, 0.2, 0.0, -0.2, -0.35, 0.0, 0.35), 1)]


def run(folder: Path, **given: Any) -> VirtualTest:
    return simulate_test(**{"gear": GEAR, "rig": RIG, "steps": STEPS, "scene": SCENE, "folder": folder, "seed": 3, **given})


def picture(path: Path) -> NDArray[Any]:
    with Image.open(path) as image:
        return np.asarray(image)


def test_a_folder_is_what_a_real_test_leaves(tmp_path: Path) -> None:
    test = run(tmp_path / "new" / "test")
    assert load(test.folder / "rig.toml") == RIG
    assert read_steps(test.folder) == list(test.steps)
    assert [(step.number, step.mass_positive, step.mass_negative) for step in test.steps] == [
        (step.number, step.mass_positive, step.mass_negative) for step in STEPS
    ]
    assert [step.time for step in test.steps] == [60.0 * k for k in range(7)]
    loading = load_by_steps(GEAR, RIG, STEPS)
    assert np.array_equal(test.angle, loading.angle)
    assert np.array_equal(test.shaft, loading.shaft)
    for step, angle in zip(test.steps, test.angle, strict=True):
        seen = picture(test.folder / f"step-{step.number:03}.png")
        assert seen.dtype == np.uint8
        assert np.array_equal(seen, render(SCENE, angle, np.random.default_rng([3, step.number])))


def test_the_truth_stands_beside(tmp_path: Path) -> None:
    test = run(tmp_path)
    truth = json.loads((tmp_path / "truth.json").read_text())
    assert truth["seed"] == 3
    assert truth["units"] == {name: unit for name, unit in truth["units"].items() if name in truth["steps"][0]}
    for name in truth["units"]:
        assert [step[name] for step in truth["steps"]] == getattr(test, name).tolist()
    assert np.allclose(truth["steps"][1]["markers [px]"], SCENE.centres(float(test.angle[1])))
    assert sw.load(tmp_path / "truth-1.toml") == GEAR


def test_the_rig_may_be_said_to_be_another(tmp_path: Path) -> None:
    said = replace(RIG, disk_radius=Value(0.1003, 5e-4))
    test = run(tmp_path, stated=said)
    assert load(tmp_path / "rig.toml") == said
    assert np.array_equal(test.angle, load_by_steps(GEAR, RIG, STEPS).angle)


def test_16_bits_are_kept(tmp_path: Path) -> None:
    run(tmp_path, steps=STEPS[:2], scene=replace(SCENE, bits=16))
    seen = picture(tmp_path / "step-001.png")
    assert seen.dtype == np.uint16
    assert np.array_equal(seen, render(replace(SCENE, bits=16), 0.0, np.random.default_rng([3, 1])))


def test_the_cameras_errors_are_those_of_the_rig_where_no_scene_is_given(tmp_path: Path) -> None:
    camera = sw.rig.Camera(tilt=0.2, distance=1500.0)
    run(tmp_path, steps=STEPS[:1], scene=None, rig=replace(RIG, camera=camera))
    scene = Scene(camera=camera, gradient=0.3, noise=4.0 / 255.0)
    expected = render(scene, 0.0, np.random.default_rng([3, 1]))
    assert np.array_equal(picture(tmp_path / "step-001.png"), expected)


@pytest.mark.slow("rig")
def test_masses_keep_their_errors(tmp_path: Path) -> None:
    """The same pieces lie on either pair of pans: the true total of 0.35 kg is the same thrice, with the spread of 5 pieces."""
    totals = []
    for seed in range(40):
        given = {"steps": [STEPS[0], STEPS[4], STEPS[6]], "scene": Scene(size=(40, 30), radius=4.0, distance=18.0)}
        test = run(tmp_path / str(seed), mass_errors=True, seed=seed, **given)
        assert test.mass_positive[0] == test.mass_negative[1] == test.mass_positive[2]
        assert test.applied[0] == pytest.approx(test.mass_positive[0] * RIG.gravity.value * 0.1)
        totals.append(test.mass_positive[0])
    sigma = np.hypot(np.sqrt(3.0) * 1e-4, np.sqrt(2.0) * 2.5e-5)
    assert np.std(totals) == pytest.approx(sigma, rel=0.35)  # three standard deviations of 40
    assert np.mean(totals) == pytest.approx(0.35, abs=3.0 * sigma / np.sqrt(40.0))
    assert read_steps(tmp_path / "0")[0].mass_positive == 0.35


def test_each_position_may_have_a_gear_of_its_own(tmp_path: Path) -> None:
    turned = [replace(step, number=step.number + 7, position=1.0) for step in STEPS]
    soft = GEAR.replace(stiffness=sw.stiffness.Linear(k=2e3))
    test = run(tmp_path, gear=lambda step: soft if step.position else GEAR, steps=[*STEPS, *turned])
    assert np.array_equal(test.angle[:7], load_by_steps(GEAR, RIG, STEPS).angle)
    assert np.array_equal(test.angle[7:], load_by_steps(soft, RIG, STEPS).angle)
    assert sw.load(tmp_path / "truth-2.toml") == soft


def test_an_unsettled_disk_is_photographed_where_it_is(tmp_path: Path) -> None:
    test = run(tmp_path, wait=10.0, settling=5.0)
    assert np.array_equal(test.angle, load_by_steps(GEAR, RIG, STEPS, wait=10.0, settling=5.0).seen)


@pytest.mark.slow("rig")
def test_what_goes_wrong_goes_wrong_there_alone(tmp_path: Path) -> None:
    right = run(tmp_path / "right")
    faults = {1: "blurred", 2: "over-exposed", 3: "marker missing", 4: "swapped", 6: "skipped"}
    wrong = run(tmp_path / "wrong", faults=faults)
    assert [step.number for step in read_steps(wrong.folder)] == [1, 2, 3, 4, 5, 7]
    assert [step.number for step in wrong.steps] == [1, 2, 3, 4, 5, 7]
    assert wrong.angle.tolist() == np.delete(right.angle, 5).tolist()
    assert not (wrong.folder / "step-006.png").exists()

    def of(folder: Path, number: int) -> NDArray[Any]:
        return picture(folder / f"step-{number:03}.png").astype(float)

    assert np.ptp(of(wrong.folder, 1)) < 0.5 * np.ptp(of(right.folder, 1))
    assert np.mean(of(wrong.folder, 2) == 255.0) > 0.9
    dark = [np.count_nonzero(of(folder, 3) < 100.0) for folder in (wrong.folder, right.folder)]
    assert dark[0] == pytest.approx(dark[1] / 2.0, rel=0.02)
    still = replace(SCENE, noise=0.0)
    for number, other in ((4, 5), (5, 4)):
        seen = of(wrong.folder, number) - render(still, right.angle[other - 1], np.random.default_rng(0))
        assert np.std(seen) == pytest.approx(0.01 * 255.0, rel=0.05)
    assert np.array_equal(of(wrong.folder, 7), of(right.folder, 7))
    assert {step["number"]: step.get("fault") for step in json.loads((wrong.folder / "truth.json").read_text())["steps"]} == {
        **faults, 5: None, 7: None,
    }  # fmt: skip


def test_a_folder_that_holds_a_test_is_left_alone(tmp_path: Path) -> None:
    run(tmp_path)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    with pytest.raises(ValueError, match=r"holds a test already \(rig.toml\); give another folder"):
        run(tmp_path, seed=4)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"steps": []}, "steps: a test needs one step or more"),
        ({"faults": {9: "blurred"}}, "faults: there is no step 9"),
        (
            {"faults": {1: "stolen"}},
            'faults[1] = "stolen" must be one of blurred, over-exposed, marker missing, swapped, skipped',
        ),
        ({"faults": {7: "swapped"}}, "faults[7]: the last step has no next one to be swapped with"),
        ({"seed": -1}, "seed = -1 must be 0 or more"),
    ],
)
def test_what_cannot_be_simulated_is_refused_before_anything_is_written(
    tmp_path: Path, given: dict[str, Any], said: str
) -> None:
    with pytest.raises(ValueError) as refused:  # noqa: PT011
        run(tmp_path / "test", **given)
    assert str(refused.value) == said
    assert not list(tmp_path.iterdir())


def test_a_bar_shows_how_far_it_is(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    run(tmp_path, progress=True)
    assert capfd.readouterr().out == ""  # on the other stream, and only in a terminal


def test_a_run_that_is_interrupted_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupted(*_: object) -> None:
        assert (tmp_path / "test" / "step-003.png").exists()
        raise KeyboardInterrupt

    shown = iter([render] * 3 + [interrupted])
    monkeypatch.setattr("strainwave.rig.virtual.test.render", lambda *given: next(shown)(*given))
    with pytest.raises(KeyboardInterrupt):
        run(tmp_path / "test")
    assert not list(tmp_path.iterdir())
