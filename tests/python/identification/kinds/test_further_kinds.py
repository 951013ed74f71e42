"""Friction at rest, at constant speed, over the angle and over a warm-up: each is known for what it is, and tells the truth."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from strainwave.identification.identify import Identified, identify
from strainwave.identification.kinds.kind import rank
from strainwave.identification.reading.mapping import FileMapping, MappingFile
from strainwave.identification.reading.recognise import recognise

from tests.python.identification.candidates.test_motion import TRUTH, record

START = "hfuc-20-80"
SPEEDS = (1.0, 3.0, 10.0, 30.0, 100.0, 250.0)  # rad/s
COULOMB, VISCOUS = 0.05, 3e-4
TURNS = (0.0, 4.0, -4.0, 2.0, -2.0, 3.0, -4.0, 4.0, -3.0, 3.0)  # mrad


def write(path: Path, columns: Mapping[str, object], units: Mapping[str, str]) -> Path:
    path.parent.mkdir(exist_ok=True)
    sw.Recording({name: np.asarray(each, float) for name, each in columns.items()}, units).to_csv(path)
    return path


def table(path: Path) -> Path:
    speed = np.array([*SPEEDS, *(-each for each in SPEEDS)])
    torque = np.sign(speed) * (COULOMB + VISCOUS * np.abs(speed))
    torque += 3e-4 * np.random.default_rng(5).standard_normal(len(speed))
    return write(path, {"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})


def loop(path: Path, *, timed: bool, noise: float = 5e-4) -> Path:
    """A bristle of 40 N·m/rad that breaks away at 0.05 N·m, moved slowly to and fro at rest."""
    angle = 1e-3 * np.interp(np.arange(0.0, len(TURNS) - 1, 0.02), np.arange(len(TURNS)), TURNS)
    law = sw.friction.LuGre(
        coulomb=COULOMB, breakaway=COULOMB, bristle_stiffness=40.0, bristle_damping=0.01, stribeck_speed=1.0
    )
    torque = law.quasistatic(angle) + noise * np.random.default_rng(1).standard_normal(len(angle))
    columns = {"time": 0.1 * np.arange(len(angle))} if timed else {}
    units = {"time": "s"} if timed else {}
    columns |= {"input_angle": angle, "input_torque": torque}
    return write(path, columns, units | {"input_angle": "rad", "input_torque": "N.m"})


def ramps(path: Path, level: float = 0.06, asymmetry: float = 0.0) -> Path:
    """Ramps of torque, both ways, of which forward needs more by a share; behind each the shaft runs on, and rests."""
    random, time, torque, angle = np.random.default_rng(2), [], [], []
    place, clock = 0.0, 0.0
    for ramp in range(8):
        way = (-1.0) ** ramp
        breaks = level * (1.0 + asymmetry * way + 0.01 * random.standard_normal())
        rising = np.arange(0.0, 4.0, 0.01)
        size = 0.02 * rising
        free = np.maximum(rising - breaks / 0.02, 0.0)
        time += list(clock + rising)
        torque += list(way * size)
        angle += list(place + way * (size / 300.0 + 2.0 * free**2))
        place = angle[-1] - way * size[-1] / 300.0
        rest = np.arange(0.0, 1.0, 0.01)
        time += list(clock + 4.0 + rest)
        torque += [0.0] * len(rest)
        angle += [place] * len(rest)
        clock += 5.0
    noisy = np.array(angle) + 1e-5 * random.standard_normal(len(angle))
    columns = {"time": time, "input_angle": noisy, "input_torque": torque}
    return write(path, columns, {"time": "s", "input_angle": "rad", "input_torque": "N.m"})


def run(path: Path, speed: float, *, angle: bool = False, named: bool = True, count: int = 3000, current: bool = False) -> Path:
    """A record at one speed: torque with a wave of the second order of the turn."""
    random = np.random.default_rng(abs(round(speed)) + count)
    turned = 8.0 * np.pi / count * np.arange(count) * np.sign(speed)
    torque = np.sign(speed) * (COULOMB + VISCOUS * abs(speed) + 0.01 * np.cos(2.0 * turned - 0.4))
    torque += 1e-3 * random.standard_normal(count)
    name, unit = ("current", "A") if current else ("torque", "N.m")
    columns: dict[str, object] = {name: torque / 0.08 if current else torque}
    units = {name: unit}
    if named:
        columns["speed"], units["speed"] = speed * (1.0 + 1e-3 * random.standard_normal(count)), "rad/s"
    if angle:
        columns["angle"], units["angle"] = turned, "rad"
    return write(path, columns, units)


def told(found: Identified, name: str) -> tuple[float, float]:
    number = next(each.estimate for each in found.parameters if each.estimate.path == f"gear.friction_input.{name}")
    return number.value, number.sigma


def both_ways(folder: Path, **how: bool) -> list[Path]:
    return [run(folder / f"run_{speed:+04.0f}.csv", speed, **how) for each in SPEEDS for speed in (each, -each)]


@pytest.mark.parametrize("timed", [False, True])
def test_a_small_motion_at_rest_is_a_presliding_loop_and_gives_the_gear_bristles(tmp_path: Path, timed: bool) -> None:
    found = identify(START, [loop(tmp_path / "small.csv", timed=timed), table(tmp_path / "table.csv")])
    small = found.files[0]
    assert small.recognised is not None
    assert small.recognised.kind == "presliding"
    assert "mrad in all" in small.recognised.why[0]
    assert small.pictures
    stiffness, sigma = told(found, "bristle_stiffness")
    assert abs(stiffness - 40.0) < 3.0 * sigma
    assert abs(told(found, "breakaway")[0] - COULOMB) < 3.0 * told(found, "breakaway")[1]
    law: Any = found.gear_set.gear.friction_input
    assert law.name == "lugre"
    assert law.bristle_stiffness == stiffness
    assert law.viscous == pytest.approx(VISCOUS, rel=0.05)
    sources = found.gear_set.sources
    assert "small.csv" in sources["gear.friction_input.bristle_stiffness"].source
    assert "table.csv" in sources["gear.friction_input.viscous"].source


def test_rank_compares_what_a_presliding_loop_may_be(tmp_path: Path) -> None:
    ranked = rank(sw.GearSet.read(START), recognise(loop(tmp_path / "small.csv", timed=True)))
    assert ranked[0].name == "bristle"
    assert len(ranked) > 1


def test_a_loop_that_never_slides_tells_stiffness_alone(tmp_path: Path) -> None:
    angle = 1e-4 * np.interp(np.arange(0.0, len(TURNS) - 1, 0.02), np.arange(len(TURNS)), TURNS)
    law = sw.friction.LuGre(
        coulomb=COULOMB, breakaway=COULOMB, bristle_stiffness=40.0, bristle_damping=0.01, stribeck_speed=1.0
    )
    torque = law.quasistatic(angle) + 1e-4 * np.random.default_rng(1).standard_normal(len(angle))
    path = write(
        tmp_path / "tiny.csv", {"input_angle": angle, "input_torque": torque}, {"input_angle": "rad", "input_torque": "N.m"}
    )
    found = identify(START, [path])
    assert "the torque from below only" in " ".join(found.files[0].remarks)
    assert any(each.why for each in found.files[0].estimates)
    assert found.gear_set.gear.friction_input == sw.GearSet.read(START).gear.friction_input


def test_ramps_of_torque_tell_the_breakaway(tmp_path: Path) -> None:
    found = identify(START, [ramps(tmp_path / "ramps.csv"), table(tmp_path / "table.csv")])
    assert found.files[0].recognised is not None
    assert found.files[0].recognised.kind == "breakaway"
    value, sigma = told(found, "breakaway")
    assert abs(value - 0.06) < max(3.0 * sigma, 0.002)
    law: Any = found.gear_set.gear.friction_input
    assert law.breakaway == value


def test_directions_that_break_away_apart_make_the_mean_less_sure(tmp_path: Path) -> None:
    found = identify(START, [ramps(tmp_path / "ramps.csv", asymmetry=0.2), table(tmp_path / "table.csv")])
    value, sigma = told(found, "breakaway")
    assert abs(value - 0.06) < 0.002
    assert 0.01 < sigma < 0.014  # 0.072 one way and 0.048 the other: half of the difference is 0.012


@pytest.mark.slow("identification")
def test_records_of_one_speed_each_are_one_table(tmp_path: Path) -> None:
    found = identify(START, both_ways(tmp_path))
    assert [each.part_of for each in found.files[:-1]] == [found.files[-1].name] * (2 * len(SPEEDS))
    assert found.files[-1].recognised is not None
    assert "one table" in found.files[-1].recognised.why[0]
    for name, truth in (("coulomb", COULOMB), ("viscous", VISCOUS)):
        value, sigma = told(found, name)
        assert abs(value - truth) < 3.0 * sigma
        assert getattr(found.gear_set.gear.friction_input, name) == value


@pytest.mark.slow("identification")
def test_the_speed_may_stand_in_the_mapping_file(tmp_path: Path) -> None:
    files = both_ways(tmp_path, named=False, current=True)
    lines = [f'["{path.name}"]\nconstants.speed = "{float(path.stem[4:])} rad/s"' for path in files]
    (tmp_path / "columns.toml").write_text("[constants]\ntorque_constant = 0.08\n" + "\n".join(lines))
    found = identify(START, files, mapping=MappingFile.read(tmp_path / "columns.toml").of)
    assert told(found, "coulomb")[0] == pytest.approx(COULOMB, rel=0.02)


def test_too_few_speeds_give_the_friction_at_each_and_what_to_record(tmp_path: Path) -> None:
    found = identify(START, [run(tmp_path / "slow.csv", 10.0), run(tmp_path / "fast.csv", 100.0)])
    for each, speed in zip(found.parameters, (10.0, 100.0), strict=True):
        assert each.estimate.law == f"at {speed:g} rad/s of the input"
        assert abs(each.estimate.value - COULOMB - VISCOUS * speed) < 4.0 * each.estimate.sigma
    assert found.gear_set.gear == sw.load(START)
    assert "record 4 speeds or more" in " ".join(found.files[-1].remarks)


def one_way(path: Path, *, gravity: float, drift: float, with_speed: bool) -> Path:
    """A joint that turns one way at 0.4 rad/s between two rests, under friction that drifts along the way."""
    random, time = np.random.default_rng(8), np.arange(0.0, 8.0, 0.005)
    speed = 0.4 * np.clip(np.minimum(time - 0.5, 7.5 - time) / 0.3, 0.0, 1.0)
    angle = np.cumsum(speed) * 0.005 - 1.4
    torque = np.sign(speed) * (4.0 + drift * np.sin(3.0 * time)) + gravity * np.sin(angle) + 0.1 * random.normal(size=len(time))
    columns = {"time": time, "joint_angle": angle, "joint_torque": torque}
    units = {"time": "s", "joint_angle": "rad", "joint_torque": "N.m"}
    if with_speed:
        columns["joint_speed"], units["joint_speed"] = speed + 3e-4 * random.normal(size=len(time)), "rad/s"
    return write(path, columns, units)


@pytest.mark.parametrize("with_speed", [True, False])
def test_a_record_one_way_at_one_speed_determines_friction_there_with_a_speed_column_and_without(
    tmp_path: Path, with_speed: bool
) -> None:
    found = identify(START, [one_way(tmp_path / "log.csv", gravity=0.0, drift=0.3, with_speed=with_speed)])
    (friction,) = (each.estimate for each in found.parameters if each.estimate.path == "steady_friction")
    assert friction.law == "at 0.4 rad/s of the output"
    assert friction.value == pytest.approx(4.0, rel=0.05)
    assert not found.failed


@pytest.mark.slow("identification")
@pytest.mark.parametrize("with_speed", [True, False])
def test_a_record_one_way_at_one_speed_that_gravity_explains_is_a_log(tmp_path: Path, with_speed: bool) -> None:
    found = identify(START, [one_way(tmp_path / "log.csv", gravity=9.0, drift=0.0, with_speed=with_speed)])
    values = {each.estimate.path: each.estimate.value for each in found.parameters}
    assert values["load.gravity_torque"] == pytest.approx(9.0, rel=0.02)
    assert found.files[0].held_out is not None


@pytest.mark.slow("identification")
def test_friction_over_the_angle_gives_waves_around_the_table(tmp_path: Path) -> None:
    files = [*both_ways(tmp_path), run(tmp_path / "turns.csv", 10.0, angle=True, count=3200)]
    found = identify(START, files)
    position = found.files[-1]
    assert "ten orders" in position.model
    cosine, sine = told(found, "cosine[1]")[0], told(found, "sine[1]")[0]
    assert (cosine, sine) == pytest.approx((0.01 * np.cos(0.4), 0.01 * np.sin(0.4)), abs=2e-4)
    law: Any = found.gear_set.gear.friction_input
    assert law.name == "cyclic"
    assert law.order == (2.0,)
    mean = COULOMB + 10.0 * VISCOUS
    assert law.amplitude[0] == pytest.approx(0.01 / mean, rel=0.02)
    angle = np.linspace(0.0, 2.0 * np.pi, 7)
    assert np.array([law.steady(10.0, angle=float(each)) for each in angle]) == pytest.approx(
        mean + 0.01 * np.cos(2.0 * angle - 0.4), rel=0.02
    )


def warm_up(path: Path, seed: int = 3) -> Path:
    """An axis that swings, whose friction falls by 1 % a kelvin while it warms up by 10 K."""
    time = np.arange(0.0, 2400.0, 0.25)
    temperature = 303.15 + 10.0 * (1.0 - np.exp(-time / 800.0))
    speed = 20.0 * np.sin(0.7 * time)
    torque = 0.05 * np.sign(speed) * (1.0 - 0.01 * (temperature - 308.15))
    torque += 0.002 * np.random.default_rng(seed).standard_normal(len(time)) + 0.01 * np.sin(0.11 * time)
    columns = {"time": time, "input_speed": speed, "temperature": temperature, "input_torque": torque}
    return write(path, columns, {"time": "s", "input_speed": "rad/s", "temperature": "K", "input_torque": "N.m"})


@pytest.mark.slow("identification")
def test_a_warm_up_tells_how_friction_falls(tmp_path: Path) -> None:
    found = identify(START, [warm_up(tmp_path / "warm.csv")])
    value, sigma = told(found, "dry_fall")
    assert abs(value - 0.01) < 3.0 * sigma
    assert sigma < 0.004
    law: Any = found.gear_set.gear.friction_input
    assert law.name == "thermal"
    assert law.dry_fall == value
    assert "°C" in " ".join(found.files[0].remarks)


def test_a_ratio_that_is_said_is_used(tmp_path: Path) -> None:
    speed = np.array([*SPEEDS, *(-each for each in SPEEDS)]) / 50.0
    torque = np.sign(speed) * (COULOMB + VISCOUS * 50.0 * np.abs(speed)) * 50.0
    path = write(tmp_path / "joint.csv", {"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})
    found = identify(START, [path], mapping=lambda _: FileMapping(side="output", constants={"ratio": 50.0}))
    assert found.gear_set.gear.kinematics.ratio == -50.0
    assert told(found, "coulomb")[0] == pytest.approx(COULOMB, rel=1e-6)
    assert any("given" in each.source for path, each in found.gear_set.sources.items() if "kinematics" in path)


def test_a_constant_torque_at_the_output_is_taken_off_a_table(tmp_path: Path) -> None:
    speed = np.array([*SPEEDS, *(-each for each in SPEEDS)])
    torque = np.sign(speed) * (COULOMB + VISCOUS * np.abs(speed)) + 1.6 / -80.0
    path = write(tmp_path / "loaded.csv", {"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})
    found = identify(START, [path], mapping=lambda _: FileMapping(constants={"load_torque": 1.6}))
    assert told(found, "coulomb")[0] == pytest.approx(COULOMB, rel=1e-6)


@pytest.mark.slow("identification")
def test_an_inertia_of_the_load_that_is_said_is_not_fitted(tmp_path: Path) -> None:
    record(TRUTH, 0.05, 3).to_csv(tmp_path / "log.csv")
    motor = {"torque_constant": 0.08, "motor_inertia": 1e-4 - sw.load(START).input_inertia}

    def found_with(load: dict[str, float]) -> Identified:
        return identify(START, [tmp_path / "log.csv"], mapping=lambda _: FileMapping(constants=motor | load))

    free, held = found_with({}), found_with({"load_inertia": TRUTH["inertia"]})
    wrong = found_with({"load_inertia": 1.5 * TRUTH["inertia"]})
    assert "load.inertia" in {each.estimate.path for each in free.parameters}
    assert "load.inertia" not in {each.estimate.path for each in held.parameters}
    assert told(held, "viscous")[1] <= 1.3 * told(free, "viscous")[1]  # both with the spread between laws of friction
    assert not held.failed
    assert "given inertia of the load" in {check.name for check in wrong.failed}


@pytest.mark.slow("identification")
def test_a_recording_by_its_kind_determines_what_its_file_does(tmp_path: Path) -> None:
    path = table(tmp_path / "table.csv")
    alone = identify(START, [path]).gear_set.gear
    assert identify(START, {"friction": path}).gear_set.gear == alone
    assert identify(START, {"friction": sw.Recording.read(path)}).gear_set.gear == alone


@pytest.mark.slow("identification")
def test_records_with_an_angle_are_averaged_over_whole_turns(tmp_path: Path) -> None:
    """1.25 turns of a wave of the second order: over all of them the mean is off by the wave's last quarter."""
    files = []
    for each in SPEEDS:
        for speed in (each, -each):
            time = np.linspace(0.0, 1.2501 * 2.0 * np.pi / each, 1000)
            torque = np.sign(speed) * (COULOMB + VISCOUS * each + 0.02 * np.sin(2.0 * each * time))
            columns = {"time": time, "input_angle": speed * time, "input_torque": torque}
            path = tmp_path / f"turn_{speed:+.0f}.csv"
            files.append(write(path, columns, {"time": "s", "input_angle": "rad", "input_torque": "N.m"}))
    found = identify(START, files)
    assert told(found, "coulomb")[0] == pytest.approx(COULOMB, rel=2e-3)
    assert len(found.files) == len(files) + 2  # the table, and friction over the angle


def test_a_loop_inside_the_stiction_of_a_table_gives_the_stiffness_and_no_breakaway(tmp_path: Path) -> None:
    """Its torque flattens below the torque that a table shows, so its plateau is no breakaway."""
    law = sw.friction.LuGre(
        coulomb=0.5 * COULOMB, breakaway=0.5 * COULOMB, bristle_stiffness=40.0, bristle_damping=0.01, stribeck_speed=1.0
    )
    angle = 5e-3 * np.interp(np.arange(0.0, len(TURNS) - 1, 0.02), np.arange(len(TURNS)), TURNS)
    torque = law.quasistatic(angle) + 1e-4 * np.random.default_rng(1).standard_normal(len(angle))
    units = {"input_angle": "rad", "input_torque": "N.m"}
    small = write(tmp_path / "small.csv", {"input_angle": angle, "input_torque": torque}, units)
    found = identify(START, [small, table(tmp_path / "table.csv")])
    assert "stays below" in " ".join(found.files[0].remarks)
    determined = [each.path for each in found.files[0].estimates if not each.why]
    assert determined == ["gear.friction_input.bristle_stiffness"]
    sliding: Any = found.gear_set.gear.friction_input
    assert sliding.breakaway == pytest.approx(COULOMB, rel=0.05)
    assert sliding.coulomb == pytest.approx(COULOMB, rel=0.05)


def test_a_zero_of_the_torque_is_no_asymmetry_of_friction() -> None:
    speed = np.geomspace(2.0, 230.0, 10)
    torque = np.concatenate([0.055 + 3.5e-4 * speed, -0.055 - 3.5e-4 * speed])
    torque += 0.02 + 3e-4 * np.random.default_rng(5).standard_normal(20)  # an offset of the sensor of 20 mN.m
    table = sw.Recording({"speed": np.concatenate([speed, -speed]), "torque": torque}, {"speed": "rad/s", "torque": "N.m"})
    (file,) = sw.identify(START, {"friction": table}).files
    estimates = {each.path.rpartition(".")[2]: each for each in file.estimates}
    assert estimates["coulomb"].value == pytest.approx(0.055, abs=3.0 * estimates["coulomb"].sigma)
    asymmetry = estimates["dry_asymmetry"]
    assert asymmetry.state == "identified in combination"
    assert "a zero of the torque looks the same: both make 19.89" in asymmetry.why
