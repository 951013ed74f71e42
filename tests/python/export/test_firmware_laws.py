"""Laws of a gear as firmware: every law of every list gives the numbers of its Python class."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from strainwave import _core
from strainwave.export.firmware import FLAGS

from tests.support.cplusplus import checker
from tests.support.firmware import NO_LIBRARY, Loaded, check_bad_samples, library, written
from tests.support.strategies import made, suited

PERIOD = 2.0**-10  # s; its multiples are exact
KINEMATICS = sw.load("csg-20-100").kinematics
LUGRE = made(sw.friction.LuGre, viscous=1e-3)
HARMONICS = {"order": [1.0, 2.0], "amplitude": [1e-4, 3e-4], "phase": [0.0, 0.5]}
# Of laws that do nothing by their usual numbers.
CHANGED: dict[str, dict[str, Any]] = {
    "viscous": {"viscous": 1e-3},
    "coulomb": {"coulomb": 0.03, "breakaway": 0.04, "viscous": 1e-3},
    "maxwell_slip_friction": {"stiffness": [20.0, 40.0], "share": [0.4, 0.6]},
    "load_dependent": {
        "driving_forward": 0.1, "driving_reverse": 0.12, "backdriving_forward": 0.2, "backdriving_reverse": 0.25
    },
    "angle_speed_map": {"speed": [0.0, 1.0, 2.0], "level": [0.04, 0.03, 0.05]},
    "asymmetric": {"law": LUGRE, "dry_asymmetry": 0.2, "viscous_asymmetry": -0.1},
    "cyclic": {"law": LUGRE, "order": [2.0], "amplitude": [0.3], "phase": [0.5]},
    "thermal": {"law": LUGRE, "dry_fall": 0.01, "viscous_fall": 0.02},
    "maxwell_slip": {"stiffness": [1e3, 3e3], "breakaway": [0.1, 0.5]},
    "preisach": {"density": sw.hysteresis.PowerDensity(limit=2e-3, saturation=5.0)},
    "fading_memory": {"stiffness": [1e3, 3e3], "forgetting": [1e3, 5e3]},
    "fourier": HARMONICS,
    "misalignment": {"offset": 1e-4, "housing_tilt_x": 1e-3, "generator_eccentricity": 2e-5},
    "tooth_errors": {"flexspline_amplitude": [1e-5], "flexspline_phase": [0.0], "circular_spline_deviation": 1e-6},
    "temperature_dependent": {"law": sw.kinematic_error.Fourier(**HARMONICS)},
    "scaled": {"law": sw.kinematic_error.Fourier(**HARMONICS)},
    "micro_slip": {"excitation": 0.1, "friction": 2.0, "load_share": 0.3},
    "stochastic": {"amplitude": 2e-5, "load_sensitivity": 0.1, "speed_sensitivity": 0.01},
}  # fmt: skip
PLACES = {
    "friction": "friction_input", "stiffness": "stiffness", "hysteresis": "hysteresis", "kinematic_error": "kinematic_error",
    "kinematic_noise": "kinematic_noise",
}  # fmt: skip
LAWS = [(family, name) for family in PLACES for name in _core.families[family]]


def law_of(family: str, name: str) -> Any:
    return suited(made(_core.families[family][name], **CHANGED.get(name, {})), KINEMATICS)


def friction(firmware: Loaded, law: Any) -> tuple[Any, ...]:
    """Torque along a motion that reverses and rests, and the most that a law holds at rest."""
    time = PERIOD * np.arange(1000)
    speed = 3.0 * np.sin(10.0 * time) * (np.abs(time - 0.5) > 0.05)
    angle = np.cumsum(np.concatenate([[0.5], (0.5 * speed[:-1] + 0.5 * speed[1:]) * PERIOD]))
    found = firmware.run(speed=speed, angle=angle, load=0.7, temperature=300.0)
    pairs = [found["torque"], law.trace(time, speed, angle=0.5, load=0.7, temperature=300.0)]
    if law.set_valued:
        for sense, side in ((1.0, "forward"), (-1.0, "backward")):
            pairs += [found[f"hold_{side}"], law.hold(sense, angle=angle, load=0.7, temperature=300.0)]
    return tuple(pairs)


def stiffness(firmware: Loaded, law: Any) -> tuple[Any, ...]:
    twist = np.linspace(-2e-3, 2e-3, 201)
    found = firmware.run(twist=twist)
    return found["torque"], law.torque(twist), found["tangent"], law.tangent(twist)


def hysteresis(firmware: Loaded, law: Any) -> tuple[Any, ...]:
    twist = 1e-3 * np.cumsum(np.random.default_rng(1).uniform(-1.0, 1.0, 300))
    return firmware.run(twist=twist)["torque"], law.trace(twist)


def kinematic_error(firmware: Loaded, law: Any) -> tuple[Any, ...]:
    angle = np.linspace(-50.0, 50.0, 301)
    found = firmware.run(input_angle=angle)
    return found["error"], law.error(angle), found["slope"], law.slope(angle)


def kinematic_noise(firmware: Loaded, law: Any) -> tuple[Any, ...]:
    angle = np.linspace(-50.0, 50.0, 301)
    found, at = firmware.run(input_angle=angle, torque=3.0, input_speed=20.0), {"torque": 3.0, "speed": 20.0}
    return found["error"], law.error(angle, **at), found["slope"], law.slope(angle, **at)


COMPARED: dict[str, Callable[[Loaded, Any], tuple[Any, ...]]] = {
    each.__name__: each for each in (friction, stiffness, hysteresis, kinematic_error, kinematic_noise)
}


@pytest.fixture(scope="module")
def programs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Loaded]:
    """Firmware of every law, in one program."""
    folder, gear = tmp_path_factory.mktemp("laws"), sw.Gear(kinematics=KINEMATICS)
    firmware = {}
    for family, name in LAWS:
        period = PERIOD if family == "friction" else None
        whole = gear.replace(**{PLACES[family]: law_of(family, name)})
        firmware[name] = written(whole, folder, "double", name=f"own_{name}", part=f"gear.{PLACES[family]}", period=period)
    shared = library(folder, list(firmware.values()), "-O0")
    return {name: Loaded(each, shared) for name, each in firmware.items()}


@pytest.mark.whole_path("export")
@pytest.mark.parametrize(("family", "name"), LAWS)
def test_firmware_of_a_law_has_its_bits(family: str, name: str, programs: dict[str, Loaded]) -> None:
    found = COMPARED[family](programs[name], law_of(family, name))
    assert np.ptp(found[1]) > 0.0
    for firmware, expected in zip(found[::2], found[1::2], strict=True):
        assert np.array_equal(firmware, expected)


@pytest.mark.whole_path("export")
@pytest.mark.parametrize(("family", "name"), [each for each in LAWS if not each[1].startswith("no_")])
def test_a_bad_sample_is_held_and_counted(family: str, name: str, programs: dict[str, Loaded]) -> None:
    scale, time = {"twist": 1e-3, "input_angle": 30.0}, PERIOD * np.arange(40)
    inputs = {each: scale.get(each, 0.3) * np.cos(99.0 * time + i) for i, each in enumerate(programs[name].firmware.inputs)}
    check_bad_samples(programs[name], inputs | {"temperature": 300.0 + time} if family == "friction" else inputs)


@pytest.mark.slow("export")
def test_headers_of_laws_stand_side_by_side_in_clang(programs: dict[str, Loaded]) -> None:
    folder = next(iter(programs.values())).firmware.header.parent
    subprocess.run([*checker("clang++"), *FLAGS.split(), *NO_LIBRARY, "all.cpp"], cwd=folder, check=True)


def test_a_law_without_time_takes_no_period(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"gear.stiffness does not depend on time; leave out period = 0.001 s"):
        sw.export.firmware(sw.Gear(), tmp_path, part="gear.stiffness", period=1e-3)
