"""What friction holds is constant to the last bit, by every method, alone and in a pack."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import strainwave as sw
from strainwave import _core
from strainwave.simulation.run import METHOD_WORDS
from strainwave.simulation.signals import outputs

from tests.support.joint_sized import INPUT_SIZES, joint_sized
from tests.support.reference_drive import DRIVE
from tests.support.strategies import made

COULOMB = sw.friction.Coulomb(coulomb=0.03, breakaway=0.045)
LISTED = {  # laws that need numbers of their own to hold this joint
    "coulomb": COULOMB,
    "position_dependent": sw.friction.PositionDependent(
        constant=0.04, cosine=[0.01], sine=[0.005], domain_start=0.0, domain_end=1.0, outside="clamp"
    ),
    "load_dependent": sw.friction.LoadDependent(
        driving_forward=1.5, driving_reverse=1.5, backdriving_forward=1.5, backdriving_reverse=1.5
    ),
    "angle_speed_map": sw.friction.AngleSpeedMap(speed=[1.0, 100.0], level=[0.03, 0.04, 0.04, 0.05], static_ratio=1.2),
}  # of the input's scale
HOLDING = [
    name
    for name, kind in _core.families["friction"].items()
    if made(kind).set_valued or any(field["kind"] == "part" for field in kind.fields)
]
OUTPUT_SCALE = 100.0
EVERY_OUTPUT = list(outputs(sw.Drive()))


def law_of(name: str) -> Any:
    """Return a law that can hold: one listed, or one with numbers of the size of the joint."""
    law = LISTED.get(name) or joint_sized(_core.families["friction"][name], INPUT_SIZES, within=COULOMB)
    assert law.set_valued
    return law


def scaled(law: Any, factor: float) -> Any:
    """With all torques multiplied."""
    if hasattr(law, "law"):
        return law.replace(law=scaled(law.law, factor))
    torques = [field["name"] for field in law.fields if field["unit"] == "N.m"]
    return law.replace(**{name: factor * np.array(getattr(law, name)) for name in torques})


def held(place: str, law: Any) -> sw.Drive:
    """Both sides can stick, of which one by this law, with error and hysteresis; the current follows the voltage at once."""
    output = scaled(COULOMB, OUTPUT_SCALE)
    friction = {"friction_input": COULOMB if place == "friction_output" else sw.friction.Viscous(), "friction_output": output}
    friction[place] = law if place == "friction_input" else scaled(law, OUTPUT_SCALE)
    return DRIVE.replace(
        gear=DRIVE.gear.replace(**friction),
        motor=DRIVE.motor.replace(inductance=0.0),
        control=sw.control.OpenLoop(),
        load=sw.loads.Inertia(inertia=0.5),
    )


every_hold = pytest.mark.parametrize("name", HOLDING)
every_place = pytest.mark.parametrize("place", ["friction_input", "friction_mesh", "friction_output"])


def by_every_method(drive: sw.Drive, voltage: sw.scenario.Scenario, **others: Any) -> dict[str, sw.Recording]:
    runs: dict[str, sw.Recording] = {method: sw.simulate(drive, voltage, method=method, **others) for method in METHOD_WORDS}
    runs["adaptive"] = sw.simulate_adaptively(drive, voltage, **{"sample": 2e-4} | others)
    return runs


def in_a_pack(drive: sw.Drive, voltage: sw.scenario.Scenario, **others: Any) -> dict[str, sw.Recording]:
    """Members that differ, so that the events of one fall into the rest of another."""
    inertia = {"load.inertia": np.linspace(0.4, 0.6, 11)}
    many = sw.simulate_many(drive, voltage, inertia, record=EVERY_OUTPUT, **others)
    return {f"member {member}": many.member(member) for member in range(len(many))}


def check_constant(runs: dict[str, sw.Recording]) -> None:
    for way, run in runs.items():
        for name in EVERY_OUTPUT:
            assert len(set(run[name].tolist())) == 1, (way, name)


@pytest.mark.parametrize("level", [0.0, 0.9])
def test_below_breakaway_every_state_is_constant_to_the_last_bit(level: float) -> None:
    """Both shafts held, a load and a voltage applied: nothing moves at all."""
    drive = held("friction_input", COULOMB)
    volts = level * 0.045 * drive.motor.resistance / drive.motor.torque_constant
    excited: dict[str, Any] = {"voltage": sw.scenario.constant(volts, 0.1), "load_torque": level * 4.5}
    runs = by_every_method(drive, **excited) | in_a_pack(drive, **excited)
    check_constant(runs)
    for run in runs.values():
        assert run["friction_input"][-1] == pytest.approx(level * 0.045, rel=1e-12)
        assert run["friction_output"][-1] == pytest.approx(-level * 4.5, rel=1e-12)


@every_hold
@every_place
def test_a_twist_that_is_held_stays_to_the_last_bit(place: str, name: str) -> None:
    """The wound-up gear drives both sides; what it bears is what a load-dependent law holds with."""
    drive = held(place, law_of(name))
    rest = drive.rest()
    start = rest.replace(transmission_error=rest.transmission_error + 2e-4)
    runs = by_every_method(drive, sw.scenario.constant(0.05, 0.1), initial=start, load_torque=2.0)
    check_constant(runs)
    for run in runs.values():
        assert run["torque"][0] == pytest.approx(1.2e4 * 2e-4 + 1e9 * 2e-4**3 + 0.43, abs=0.1)
        assert run["friction_output"][0] == pytest.approx(run["torque"][0] - 2.0, rel=1e-12)


def to_and_fro_and_off(rest: float) -> sw.scenario.Scenario:
    """Two pulses of voltage, a while of little, and a third pulse."""
    pulses = [sw.scenario.step(height, 0.3, start=start) for height, start in ((8.0, 0.02), (-8.0, 0.05), (8.0, 0.2))]
    return sw.scenario.constant(rest, 0.3) + pulses[0] + pulses[1] + pulses[2]


@every_hold
@every_place
def test_from_sticking_to_breakaway_no_state_changes_by_a_bit(place: str, name: str) -> None:
    """Under a load, after a motion that left the gear twisted: of a side alone its angle, of both all that is recorded."""
    arguments: dict[str, Any] = {"voltage": to_and_fro_and_off(0.05), "load_torque": 1.0}
    drive = held(place, law_of(name))
    for way, run in (by_every_method(drive, **arguments) | in_a_pack(drive, **arguments)).items():
        still = {side: run[f"{side}_speed"] == 0.0 for side in ("input", "output")}
        stays = {side: rests[:-1] & rests[1:] for side, rests in still.items()}
        both = stays["input"] & stays["output"]
        middle = slice(500, 1000)  # between the second pulse and the third
        assert np.count_nonzero(both[middle]) > 10, f"{way}: it slips all along: list {name} in LISTED with numbers that hold"
        assert np.all(np.abs(run["torque"][:-1][middle][both[middle]]) > 1e-3), way
        assert np.count_nonzero(np.diff(still["input"])) >= 3, way
        assert not np.diff(run["input_angle"])[stays["input"]].any(), way
        for output in EVERY_OUTPUT:
            assert not np.diff(run[output])[both].any(), (way, output)
