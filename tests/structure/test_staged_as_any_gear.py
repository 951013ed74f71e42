"""The gear in stages in what any gear takes part in: runs side by side, derivatives, files, logs, methods."""

from __future__ import annotations

from math import pi, tan
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from strainwave import _core
from strainwave.simulation.state import StateLayout, beginning_numbers

from tests.structure.staged_gear import (
    DAMPINGS,
    DRIVE,
    ERROR,
    FRICTIONS,
    GEAR,
    MISALIGNED,
    PUSHED,
    SHAKEN,
    STRUCTURE,
    everywhere,
    orientation,
    shaken,
)
from tests.structure.written_down import FIXED
from tests.support.side_by_side import side_by_side


@orientation
def test_side_by_side_it_is_what_it_is_alone(fixed: str) -> None:
    one = DRIVE.replace(gear=everywhere(GEAR.replace(kinematics=FIXED[fixed])))
    drives = [
        one.replace({"gear.structure.mesh_stiffness": k, "load.inertia": j}) for k, j in ((4e6, 0.02), (3e6, 0.03), (5e6, 0.01))
    ]
    together = side_by_side(drives, SHAKEN.scenario(0.005), 1e-5, load_torque=PUSHED.scenario(0.005), sample=1e-4)
    for number, drive in enumerate(drives):
        alone = sw.simulate(drive, SHAKEN.scenario(0.005), 1e-5, load_torque=PUSHED.scenario(0.005), sample=1e-4)
        for name in "output_angle", "torque", "mesh_force", "bearing_displacement", "wave_generator_torque":
            np.testing.assert_array_equal(together[name][number], alone[name])


@orientation
@pytest.mark.parametrize(
    ("changed", "speed", "path", "values"),
    [
        ({"friction_input": sw.friction.Coulomb(coulomb=0.1)}, 0.0, "gear.friction_input.coulomb", (0.1, 0.0, 0.3)),
        ({"friction_output": sw.friction.Coulomb(coulomb=1.0)}, 0.0, "gear.friction_output.coulomb", (1.0, 0.0, 2.0)),
        (
            {"kinematic_error": MISALIGNED.replace(combine="max")},
            1000.0,
            "gear.kinematic_error.housing_direction",
            (0.0, 0.4, 1.0),
        ),
    ],
    ids=["stops at the input", "stops at the output", "jumps of the slope of an error"],
)
def test_events_of_one_member_change_no_bit_of_the_others(
    fixed: str, changed: dict[str, Any], speed: float, path: str, values: tuple[float, ...]
) -> None:
    """Events divide the steps of a member, as jumps of the error's slope do. Those of the others keep their length."""
    drive = DRIVE.replace(gear=GEAR.replace(kinematics=FIXED[fixed], **changed))
    drives = [drive.replace({path: value}) for value in values]
    course: dict[str, Any] = {"load_torque": PUSHED.scenario(0.005), "initial": {"input_speed": speed}, "sample": 1e-4}
    together = side_by_side(drives, SHAKEN.scenario(0.005), 1e-5, **course)
    for number, one in enumerate(drives):
        alone = sw.simulate(one, SHAKEN.scenario(0.005), 1e-5, **course)
        np.testing.assert_array_equal(together["torque"][number], alone["torque"])


@orientation
def test_derivatives_by_its_numbers_are_what_differences_show(fixed: str) -> None:
    drive = DRIVE.replace(gear=everywhere(GEAR.replace(kinematics=FIXED[fixed])))
    names = [
        "gear.stiffness.k",
        "gear.damping",
        "gear.input_inertia",
        "gear.structure.coupling_stiffness",
        "gear.structure.bearing_stiffness",
        "gear.structure.bearing_damping",
        "gear.structure.mesh_stiffness",
        "gear.structure.mesh_damping",
        "gear.structure.circular_spline_stiffness",
        "gear.structure.radial_mass",
        "gear.structure.flexspline_inertia",
        "gear.structure.circular_spline_inertia",
        "gear.structure.pressure_angle",
        "gear.structure.pitch_radius",
    ]
    command, load = SHAKEN.scenario(0.004), PUSHED.scenario(0.004)
    found = sw.analysis.derivatives(drive, command, names, 1e-5, load_torque=load, sample=4e-4)
    for name in names:
        value = at(drive, name)
        step = 1e-5 * value
        more, less = (
            sw.simulate(drive.replace({name: value + change}), command, 1e-5, load_torque=load, sample=4e-4)["torque"]
            for change in (step, -step)
        )
        difference = (more - less) / (2.0 * step)
        np.testing.assert_allclose(found["torque", name], difference, rtol=0.0, atol=1e-5 * np.abs(difference).max())


def at(drive: sw.Drive, path: str) -> float:
    """The number at a path."""
    whole: Any = drive
    for name in path.split("."):
        whole = getattr(whole, name)
    return float(whole)


@orientation
def test_a_file_brings_it_back_with_all_its_numbers(fixed: str, tmp_path: Path) -> None:
    drive = DRIVE.replace(gear=everywhere(GEAR.replace(kinematics=FIXED[fixed])))
    sw.save(drive, tmp_path / "staged.toml", name="staged", source="made up")
    assert sw.load(tmp_path / "staged.toml") == drive


@pytest.mark.parametrize(
    ("path", "guess"),
    [
        ("gear.structure.mesh_stiffness", 3e6),
        ("gear.structure.circular_spline_stiffness", 2.5e3),
        ("gear.structure.radial_mass", 0.1),
        ("gear.structure.bearing_damping", 10.0),
    ],
)
def test_a_number_of_a_stage_comes_back_from_a_log(path: str, guess: float) -> None:
    """Of a shaken drive whose motor angle and torque were recorded."""
    time = np.linspace(0.0, 0.03, 151)
    command = sw.scenario.table(time, [SHAKEN(each) for each in time])
    run = sw.simulate(DRIVE, command, 1e-5, sample=2e-4).select(["time", "command", "input_angle", "torque"])
    found = sw.fit(DRIVE.replace({path: guess}), run, [path], dt=1e-5)
    (estimate,) = [each for each in found.estimates if each.path == path]
    assert estimate.value == pytest.approx(at(DRIVE, path), rel=1e-5)


@pytest.mark.parametrize(
    "changed",
    [
        everywhere(GEAR),
        GEAR.replace(stiffness=sw.stiffness.Backlash(clearance=1e-3, law=sw.stiffness.Linear(k=2e3))),
        GEAR.replace(stiffness=sw.stiffness.Piecewise(k1=1e3, k2=1e3, knee=1e-3)),
        GEAR.replace(kinematic_error=sw.kinematic_error.Fourier(order=[40.0], amplitude=[2e-3], phase=[0.0])),
        GEAR.replace(damping=0.0, structure=STRUCTURE.replace(**dict.fromkeys(DAMPINGS, 0.0))),
    ],
    ids=["varying", "backlash", "piecewise", "error", "undamped"],
)
def test_what_springs_leave_to_explicit_steps_bounds_their_length(changed: sw.Gear) -> None:
    """A step that is too coarse for it is refused by its name; any that is not is right, to a hundredth of the largest."""
    drive = DRIVE.replace(gear=changed)
    command, load = SHAKEN.scenario(0.05), PUSHED.scenario(0.05)
    with pytest.raises(FloatingPointError, match="a body within its gear is as fast as a vibration of"):
        sw.simulate(drive, command, 4e-4, load_torque=load)
    longest = 0.5 / _core.max_rate(drive, 0.05)
    run = sw.simulate(drive, command, longest, load_torque=load)
    exact = sw.simulate_adaptively(drive, command, 1e-8, load_torque=load, sample=longest)
    for name in "torque", "output_speed", "bearing_displacement":
        known = np.interp(run.time, exact.time, exact[name])
        assert np.abs(run[name] - known).max() < 1e-2 * np.abs(known).max(), name


def test_even_springs_are_taken_in_steps_of_many_radians() -> None:
    """Four of the fastest vibration, to a thousandth of the largest torque; set off by a step of the load."""
    drive = DRIVE.replace(gear=GEAR.replace(kinematic_error=sw.kinematic_error.Fourier()))
    assert max(sw.analysis.modes(drive)["free"]) * 4e-4 > 3.5
    coarse, fine = (
        sw.simulate(drive, SHAKEN.scenario(0.02), dt, load_torque=5.0, sample=4e-4, initial={"input_speed": 0.0})["torque"]
        for dt in (4e-4, 1e-5)
    )
    assert np.abs(coarse - fine).max() < 1e-3 * np.abs(fine).max()


@orientation
@pytest.mark.parametrize("method", ["moreau_jean", "exponential"])
def test_long_steps_by_impulses_follow_the_bodies_in_parts(fixed: str, method: Any) -> None:
    """Though the scheme is explicit; its order is the second."""
    drive = DRIVE.replace(gear=GEAR.replace(kinematics=FIXED[fixed], friction_output=FRICTIONS["sticking"]))
    exact = shaken(drive, 0.02, 1e-9)
    run = sw.simulate(drive, SHAKEN.scenario(0.02), 2.5e-4, method=method, load_torque=PUSHED.scenario(0.02), sample=5e-4)
    assert np.abs(run["torque"] - exact["torque"]).max() < 1e-2 * np.abs(exact["torque"]).max()


SCALED = sw.kinematic_error.Scaled(law=ERROR, load_sensitivity=0.1)
known = pytest.mark.parametrize(
    "initial",
    [
        {"torque": 5.0},
        {"twist": 1e-3},
        {"input_angle": 0.4},
        {"input_angle": 0.4, "output_angle": 0.4 / FIXED["flexspline"].ratio - 3e-3},
    ],
    ids="_".join,
)


@orientation
@known
def test_no_body_within_accelerates_where_a_run_begins(fixed: str, initial: dict[str, float]) -> None:
    """With an error that follows the load, springs that vary, and whatever is known: all that the joints hold balances."""
    gear = everywhere(GEAR).replace(kinematics=FIXED[fixed], kinematic_error=SCALED)
    drive = DRIVE.replace(gear=gear)
    load = np.array([0.0, 0.0, 5.0, 0.0, 293.15, 0.0])
    start = beginning_numbers(drive, initial, load)
    layout = StateLayout(drive)
    rates = dict(zip(layout.names, _core.differentiate_rates(drive, start, load)[0], strict=False))
    inertia = {"generator": 2e-5, "radial": 0.08 * (0.025 / tan(pi / 6.0)) ** 2, "held": 5e-5, "driving": 5e-5}
    for body, kg in inertia.items():
        assert abs(rates[f"structure.{body}_speed"] * kg) < 1e-9, body  # N.m, of 5


@orientation
@pytest.mark.parametrize("structure", [STRUCTURE, sw.structure.Lumped()], ids=["staged", "lumped"])
def test_a_known_torque_is_that_on_the_output_under_an_error_that_follows_it(fixed: str, structure: Any) -> None:
    gear = GEAR.replace(kinematics=FIXED[fixed], kinematic_error=SCALED, structure=structure)
    run = sw.simulate(
        DRIVE.replace(gear=gear), sw.scenario.constant(0.0, 1e-6), 1e-6, initial={"torque": 5.0, "input_angle": 0.4}
    )
    assert run["torque"][0] == pytest.approx(5.0, rel=1e-10)


@pytest.mark.parametrize("structure", [STRUCTURE, sw.structure.Lumped()], ids=["staged", "lumped"])
def test_an_error_that_gives_way_faster_than_the_spring_is_refused(structure: Any) -> None:
    error = sw.kinematic_error.Scaled(
        law=sw.kinematic_error.Fourier(order=[1.0], amplitude=[1e-3], phase=[pi / 2.0]), load_sensitivity=1.0
    )
    drive = DRIVE.replace(gear=GEAR.replace(kinematic_error=error, structure=structure))
    with pytest.raises(ValueError, match="load_sensitivity times error times stiffness"):
        sw.simulate(drive, sw.scenario.sine(1.0, 20.0, 0.05), 2e-5)
