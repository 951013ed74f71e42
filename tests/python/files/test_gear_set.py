"""Gear sets: what a set holds and refuses, the catalogue, and how a set is found."""

from __future__ import annotations

import copy
import hashlib
import json
import math
import pickle
import re
import shutil
from collections.abc import Iterator
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, settings
from strainwave import _core
from strainwave.files import harmonic_drive
from strainwave.files.entries import Entry, Quantity
from strainwave.files.gear_set import GearSet, catalogue, load, save
from strainwave.files.identified_tables import Covariance, Validation

from tests.support.samples import sample
from tests.support.strategies import drives, made

# Of the contents of all sets of the catalogue.
SETS_DIGEST = "c5608cbf541c125fc833181fdf41519ad7dcf9f3dd40ca6d2c4d196346709fd0"


def exactly(message: str) -> str:
    return f"^{re.escape(message)}$"


# The value


def test_every_number_has_a_source_and_every_source_a_number() -> None:
    gear_set = GearSet.read("hfuc-25-100")
    sources = dict(gear_set.sources)
    del sources["gear.stiffness.k2"]
    with pytest.raises(ValueError, match=exactly("HFUC-25-100: gear.stiffness.k2 has no source")):
        gear_set.replace(sources=sources)
    with pytest.raises(ValueError, match=exactly("HFUC-25-100: sources name gear.x, which is no number of the set")):
        gear_set.replace(sources={**gear_set.sources, "gear.x": Entry("x")})
    with pytest.raises(ValueError, match=exactly("HFUC-25-100: gear.stiffness.k has no source")):
        gear_set.replace(gear=gear_set.gear.replace(stiffness=sw.stiffness.Linear(k=1.0)))


def counted(part: Any, path: str = "") -> Iterator[str]:
    """What a part and its parts count, by path: that is no number of a fit."""
    for field in part.fields:
        name = f"{path}{field['name']}"
        if field["kind"] == "count":
            yield name
        elif field["kind"] == "part":
            yield from counted(getattr(part, field["name"]), f"{name}.")


@settings(max_examples=sample(6, 20))  # each of them has a hundred numbers
@given(drives)
def test_the_paths_are_those_of_the_drives_parameters_and_its_counts(drive: sw.Drive) -> None:
    counts = set(counted(drive))
    numbers = {path for path, *_ in _core.parameters(drive)}
    assert GearSet.of(drive, name="x", source="x").sources.keys() == numbers | counts


def test_a_set_is_frozen_hashable_and_survives_pickling_and_copying() -> None:
    gear_set = GearSet.read("csg-20-100")
    for twin in (pickle.loads(pickle.dumps(gear_set)), copy.deepcopy(gear_set)):
        assert twin == gear_set
        assert hash(twin) == hash(gear_set)
    with pytest.raises(TypeError, match="does not support item assignment"):
        gear_set.sources["gear.damping"] = Entry("x")  # type: ignore[index]
    assert gear_set.replace(note="other") != gear_set


def test_a_file_without_motor_or_load_is_loaded_as_its_gear(tmp_path: Path) -> None:
    whole = whole_set()
    for part in ("motor", "load"):
        sources = {path: entry for path, entry in whole.sources.items() if not path.startswith(f"{part}.")}
        whole.replace(**{part: None}, sources=sources).save(tmp_path / "part.toml")
        assert load(tmp_path / "part.toml") == whole.gear


# Where numbers come from

COGGING = {"motor.cogging_torque": 0.0, "motor.cogging_order": 24.0}
PHASES = {"motor.phase_resistance_excess": 0.0, "motor.dead_time_voltage": 0.0, "motor.dead_time_current": 0.1}
# What a file may leave out of a motor, and what holds then.
LOST_SETS = {"motor.open_share": 0.0, "motor.shorted_share": 0.0}
WITHOUT_EFFECT: dict[Any, dict[str, float]] = {
    sw.motor.DC: COGGING,
    sw.motor.BrushlessDC: COGGING | LOST_SETS,
    sw.motor.PMSM: PHASES | LOST_SETS,
}


@pytest.mark.parametrize("name", ["tilt-actuator", "robot-joint"])
def test_a_file_may_leave_out_numbers_of_faults_and_keeps_those_that_it_has(name: str, tmp_path: Path) -> None:
    gear_set = GearSet.read(name)
    path = tmp_path / "drive.toml"
    motor = gear_set.motor
    for number, value in WITHOUT_EFFECT[type(motor)].items():
        assert getattr(motor, number.rpartition(".")[2]) == value
        assert gear_set.sources[number] == Entry("not given")
    gear_set.save(path)
    assert not [number for number in WITHOUT_EFFECT[type(motor)] if number.rpartition(".")[2] in path.read_text()]
    assert GearSet.read(path) == gear_set
    number = next(iter(WITHOUT_EFFECT[type(motor)]))
    short = number.rpartition(".")[2]
    sources = dict(gear_set.sources) | {number: Entry("measured")}
    gear_set.replace(motor=motor.replace(**{short: 0.3}), sources=sources).save(path)
    assert f"{short} = {{value = 0.3" in path.read_text().replace("{ ", "{")
    again = GearSet.read(path)
    assert (getattr(again.motor, short), again.sources[number]) == (0.3, Entry("measured"))


@pytest.mark.slow("files")
@settings(max_examples=sample(6, 20))  # each of them has a hundred numbers
@given(drives)
def test_of_a_drive_each_number_has_the_source_given_or_says_that_it_may_be_none(drive: sw.Drive) -> None:
    """No number that nobody gave has the source: it does nothing, or equals its default."""
    gear_set = GearSet.of(drive, name="x", source="measured")
    default = {path: value for path, value, *_ in _core.parameters(sw.Drive())}
    paths = [path for path, *_ in _core.parameters(drive)]
    for path, value, *_ in _core.parameters(drive):
        source = gear_set.sources[path].source
        if path in WITHOUT_EFFECT.get(type(drive.motor), {}) and value == WITHOUT_EFFECT[type(drive.motor)][path]:
            assert source == "not given"
            continue
        assert source in ("measured", "not given", "assumed: the default, unless given by: measured")
        if path.startswith("motor.") and type(drive.motor) is sw.motor.DC:
            assert (source == "measured") == (value != default[path])
    for path, entry in gear_set.sources.items():
        owner = path.rpartition(".")[0]
        number = WITHOUT_EFFECT.get(type(drive.motor), {}).get(path)
        at_rest = number is not None and _core.parameters(drive)[paths.index(path)][1] == number
        assert (entry == Entry("not given")) == (owner in gear_set.left_out or at_rest)


def test_an_element_of_a_sequence_is_a_default_only_where_the_default_has_it() -> None:
    gear = sw.Gear(hysteresis=sw.hysteresis.MaxwellSlip(stiffness=[5e3], breakaway=[0.5]))
    sources = GearSet.of(gear, name="x", source="loop").sources
    assert sources["gear.hysteresis.stiffness[0]"] == sources["gear.hysteresis.breakaway[0]"] == Entry("loop")


def test_a_source_may_be_named_for_a_number_a_sequence_or_a_part_and_the_longer_name_counts() -> None:
    named = {
        "gear.kinematics": Entry("counted"),
        "gear.friction_input.coulomb": Entry("run", uncertainty=1e-3),
        "gear.friction_input": Entry("data sheet"),
        "gear.hysteresis.stiffness": Entry("loop"),
    }
    sources = GearSet.of(load("csg-20-80"), name="x", source="rest", sources=named).sources
    assert sources["gear.kinematics.flexspline_teeth"] == Entry("counted")
    assert sources["gear.friction_input.coulomb"] == Entry("run", uncertainty=1e-3)
    assert sources["gear.friction_input.breakaway"] == Entry("data sheet")
    assert sources["gear.hysteresis.stiffness[2]"] == Entry("loop")
    assert sources["gear.hysteresis.breakaway[2]"] == Entry("rest")


@pytest.mark.parametrize(
    ("sources", "error", "message"),
    [
        (
            {"gear.frictoin": Entry("x")},
            ValueError,
            "x: sources name gear.frictoin, which is no number or part of the model; near it are "
            "gear.friction_input.viscous, gear.friction_mesh.viscous, gear.friction_output.viscous",
        ),
        ({"gear.stiff": Entry("x")}, ValueError, None),
        (
            {"\x1b[2J": Entry("x")},
            ValueError,
            "x: sources name \\x1b[2J, which is no number or part of the model; near it are "
            "gear.stiffness.k, gear.softening.stiffness_fall, gear.softening.reference_temperature",
        ),
        ({"gear": "x"}, TypeError, "gear must have a strainwave.files.Entry, not 'x'"),
        (3, TypeError, 'sources must be a mapping, as in {"gear.damping": Entry("assumed")}, not 3'),
        (np.zeros(2), TypeError, 'sources must be a mapping, as in {"gear.damping": Entry("assumed")}, not array([0., 0.])'),
    ],
)
def test_a_source_that_fits_nothing_is_refused(sources: Any, error: type[Exception], message: str | None) -> None:
    with pytest.raises(error, match=message and exactly(message)):
        GearSet.of(sw.Gear(), name="x", source="x", sources=sources)


def test_what_a_fit_found_is_saved_with_its_standard_deviation_and_the_rest_with_its_source(tmp_path: Path) -> None:
    start = GearSet.read("csg-20-80")
    speed = np.linspace(1.0, 50.0, 20)
    torque = start.gear.friction_input.steady(speed) * 1.1 + 1e-4 * np.sin(9.0 * speed)
    table = sw.Recording({"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})
    free = ["friction_input.coulomb", "friction_input.viscous"]
    fit = sw.fit(start.gear, table, free)
    save(fit, tmp_path / "mine.toml", name="mine", source="friction table", sources=start.sources)
    again = GearSet.read(tmp_path / "mine.toml")
    assert again.gear == fit.gear
    for path, estimate in zip(free, fit.estimates, strict=True):
        assert estimate.sigma > 0.0
        assert again.sources[f"gear.{path}"] == Entry("friction table", uncertainty=estimate.sigma)
    rest = [path for path in start.sources if path.removeprefix("gear.") not in free]
    assert {path: again.sources[path] for path in rest} == {path: start.sources[path] for path in rest}


def test_what_a_fit_kept_or_could_not_tell_says_so() -> None:
    """Of Coulomb's law a friction table does not tell the breakaway."""
    truth = sw.Gear(friction_input=sw.friction.Coulomb(coulomb=0.02, breakaway=0.03, viscous=3e-4), damping=2.0)
    speed = np.linspace(1.0, 50.0, 20)
    table = sw.Recording({"speed": speed, "torque": truth.friction_input.steady(speed)}, {"speed": "rad/s", "torque": "N.m"})
    fit = sw.fit(truth, table, ["friction_input.coulomb", "friction_input.breakaway"])
    sources = GearSet.of(fit, name="x", source="friction table").sources
    assert sources["gear.friction_input.coulomb"].source == "friction table"
    assert sources["gear.friction_input.breakaway"] == Entry("not determined by: friction table")
    assert sources["gear.friction_input.viscous"] == Entry("assumed: kept by the fit, its source is not given")
    assert sources["gear.friction_mesh.viscous"] == Entry("not given")


def test_the_fit_of_a_drive_keeps_its_paths() -> None:
    drive = sw.Drive(load=sw.loads.Inertia(inertia=0.01), control=sw.control.OpenLoop(gain=1.0))
    log = sw.simulate(drive, sw.scenario.sine(2.0, 3.0, 0.2), sample=1e-3).select(["time", "command", "input_speed"])
    fit = sw.fit(drive, log, ["motor.resistance"])
    gear_set = GearSet.of(fit, name="x", source="log")
    assert gear_set.drive == fit.model
    assert gear_set.sources["motor.resistance"] == Entry("log", uncertainty=fit.estimates[0].sigma)


def test_unknowns_of_the_measurement_are_no_numbers_of_the_set() -> None:
    truth = sw.Gear(stiffness=sw.stiffness.Linear(k=800.0))
    twist = 1e-3 * np.sin(np.linspace(0.0, 2.0 * np.pi, 50))
    loop = sw.Recording({"twist": twist + 1e-4, "torque": 800.0 * twist + 0.1}, {"twist": "rad", "torque": "N.m"})
    fit = sw.fit(truth, loop, ["stiffness.k"])
    assert len(fit.estimates) > 1
    sources = GearSet.of(fit, name="x", source="loop").sources
    assert sources["gear.stiffness.k"] == Entry("loop", uncertainty=fit.estimates[0].sigma)
    assert sources.keys() == GearSet.of(truth, name="x", source="x").sources.keys()


def test_a_catalogue_set_becomes_a_drive_with_the_parts_it_lacks() -> None:
    start = GearSet.read("csg-20-80")
    motor, disc = sw.motor.DC(resistance=0.3), sw.loads.Inertia(inertia=2.0)
    whole = start.with_parts(motor=motor, load=disc, source="data sheet")
    assert whole.drive == sw.Drive(gear=start.gear, motor=motor, load=disc)
    assert whole.ratings == start.ratings
    assert {path: whole.sources[path] for path in start.sources} == start.sources
    assert whole.sources["motor.resistance"] == whole.sources["load.inertia"] == Entry("data sheet")
    assert whole.sources["motor.inertia"] == Entry("assumed: the default, unless given by: data sheet")
    other = whole.with_parts(motor=motor.replace(resistance=0.4), source="measured")
    assert other.sources["motor.resistance"] == Entry("measured")
    assert other.sources["load.inertia"] == Entry("data sheet")


def test_a_number_that_had_to_be_given_has_the_source_given_though_it_equals_the_order_of_magnitude_of_its_law() -> None:
    """A gear that gives no stiffness has that of its default, whose number is required where one is given."""
    stribeck = sw.friction.Stribeck(coulomb=0.03, breakaway=0.06, stribeck_speed=2.0)
    for law, place in ((stribeck, ""), (sw.friction.Asymmetric(law=stribeck, dry_asymmetry=0.1), "law.")):
        sources = GearSet.of(sw.Gear(friction_input=law), name="x", source="measured").sources
        for name in ("coulomb", "breakaway", "stribeck_speed"):
            assert sources[f"gear.friction_input.{place}{name}"] == Entry("measured")
        assert sources[f"gear.friction_input.{place}viscous"] == Entry("assumed: the default, unless given by: measured")
        assert sources["gear.stiffness.k"] == Entry("assumed: the default, unless given by: measured")


def test_a_part_of_another_family_is_refused() -> None:
    with pytest.raises(
        TypeError,
        match=exactly(
            "drive.motor must be one of DC, BrushlessDC, PMSM, TorqueSource, CurrentSource, AccelerationSource, not 3"
        ),
    ):
        GearSet.read("csg-20-80").with_parts(motor=3, source="x")


def test_a_set_is_saved_under_its_own_name(tmp_path: Path) -> None:
    with pytest.raises(TypeError, match=exactly("name = 'y': a set has its own; change it by replace before it is saved")):
        save(whole_set(), tmp_path / "x.toml", name="y")  # type: ignore[call-overload]


@pytest.mark.parametrize(
    ("make", "error", "message"),
    [
        (lambda: Entry(""), ValueError, "source = '' must be one line of text"),
        (lambda: Entry("two\nlines"), ValueError, r"source = 'two\nlines' must be one line of text"),
        (lambda: Entry(3), TypeError, "source must be a text, not 3"),
        (lambda: Entry("x", spread=-1.0), ValueError, "spread = -1.0 must lie in [0, inf)"),
        (lambda: Entry("x", spread="1"), TypeError, "spread must be a number, not '1'"),
        (lambda: Entry("x", uncertainty=math.nan), ValueError, "uncertainty = nan must lie in [0, inf)"),
        (lambda: Entry("x", uncertainty=math.inf), ValueError, "uncertainty = inf must lie in [0, inf)"),
        (lambda: Quantity(value=math.inf, unit="N.m", source="x"), ValueError, "value = inf N.m must be finite"),
        (lambda: Quantity(value="1", unit="N.m", source="x"), TypeError, "value must be a number, not '1'"),
        (
            lambda: Quantity(value=1.0, unit="N.n", source="x"),
            ValueError,
            'unit "N.n" is not known; write it like N.m, rad/s, deg',
        ),
        (lambda: GearSet.read("hfuc-25-100").replace(maker=3), TypeError, "maker must be a text, not 3"),
        (
            lambda: GearSet.read("hfuc-25-100").replace(maker=np.zeros(2)),
            TypeError,
            "maker must be a text, not array([0., 0.])",
        ),
        (lambda: Quantity("x", value=1.0, unit="N.m").to(np.zeros(2)), TypeError, "unit must be a text, not array([0., 0.])"),
        (lambda: GearSet.read("hfuc-25-100").replace(maker="a\nb"), ValueError, r"maker = 'a\nb' must be one line of text"),
        (lambda: GearSet.read("hfuc-25-100").replace(note=3), TypeError, "note must be a text, not 3"),
        (
            lambda: GearSet.read("hfuc-25-100").replace(sources=[]),
            TypeError,
            'sources must be a mapping, as in {"gear.damping": Entry("assumed")}, not []',
        ),
        (
            lambda: GearSet.read("hfuc-25-100").replace(ratings={3: Quantity(value=4.0, unit="N.m", source="x")}),
            TypeError,
            "a number is named by a text, not 3",
        ),
        (lambda: GearSet.of(3, name="x", source="x"), TypeError, "drive.gear must be a Gear, not 3"),
        (
            lambda: GearSet.read("hfuc-25-100").replace(motor=3),
            TypeError,
            "drive.motor must be one of DC, BrushlessDC, PMSM, TorqueSource, CurrentSource, AccelerationSource, not 3",
        ),
        (
            lambda: GearSet.read("hfuc-25-100").replace(ratings={"peak_torque": 4.0}),
            TypeError,
            "peak_torque must have a strainwave.files.Quantity, not 4.0",
        ),
    ],
)
def test_a_wrong_value_is_refused(make: Any, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=exactly(message)):
        make()


def test_the_drive_needs_motor_and_load_and_runs_in_open_loop_without_control() -> None:
    bare = GearSet.of(sw.Gear(), name="bare", source="x")
    with pytest.raises(
        ValueError,
        match=exactly(
            "bare has no [motor] and no [load]; a drive needs a motor and a load; strainwave list drives lists whole drives"
        ),
    ):
        _ = bare.drive
    motor, load = sw.motor.DC(resistance=2.0), sw.loads.Inertia(inertia=3.0)
    drive = sw.Drive(gear=sw.Gear(damping=7.0), motor=motor, load=load)
    whole = GearSet.of(drive, name="whole", source="x")
    assert whole.drive == drive
    sources = {path: entry for path, entry in whole.sources.items() if not path.startswith("control.")}
    assert whole.replace(control=None, sources=sources).drive.control == sw.control.OpenLoop(gain=1.0)
    sources = {path: entry for path, entry in sources.items() if not path.startswith("load.")}
    with pytest.raises(
        ValueError,
        match=exactly("whole has no [load]; a drive needs a motor and a load; strainwave list drives lists whole drives"),
    ):
        _ = whole.replace(control=None, load=None, sources=sources).drive


def test_the_uncertainty_of_a_temperature_is_a_difference() -> None:
    kelvin = Quantity(value=20.0, unit="degC", source="x", uncertainty=0.5).to("K")
    assert (kelvin.value, kelvin.uncertainty) == (293.15, 0.5)


# Equality


def whole_set() -> GearSet:
    """A set that has every member."""
    drive = sw.Drive(gear=load("csg-20-80"), control=sw.control.OpenLoop(gain=2.0), load=sw.loads.Inertia(inertia=3.0))
    drive = drive.replace(sensors=sw.Sensors(torque=sw.sensor.FirstOrder(time_constant=1e-3)), thermal=made(sw.thermal.Heating))
    ratings = {"peak_torque": Quantity(value=1.0, unit="N.m", source="x")}
    return GearSet.of(drive, name="whole", source="x").replace(maker="x", note="x", ratings=ratings)


def changed(gear_set: GearSet, member: str) -> dict[str, Any]:
    """Another value of a member of a set."""
    known = {"gear.damping": Entry("x", uncertainty=1e-3)}
    others = {
        "gear": gear_set.gear.replace(damping=5.0),
        "sources": {**gear_set.sources, **known},
        "ratings": {"peak_torque": Quantity(value=1.0, unit="N.m", source="y")},
        "motor": gear_set.motor.replace(resistance=5.0),
        "control": sw.control.OpenLoop(gain=3.0),
        "load": sw.loads.Inertia(inertia=4.0),
        "covariance": Covariance(("gear.damping",), ((1e-6,),)),
        "validation": (Validation("log.csv", "log", "current", "A", 0.1, 0.5, 0.12, 0.4),),
    }
    without_numbers = {"sensors": sw.Sensors(), "thermal": sw.thermal.Isothermal(), "meter": sw.meter.EnergyMeter()}
    if member in without_numbers:  # and so without sources
        sources = {path: entry for path, entry in gear_set.sources.items() if not path.startswith(f"{member}.")}
        return {member: without_numbers[member], "sources": sources}
    return {member: others.get(member, "other")}


@pytest.mark.parametrize("member", [field.name for field in fields(GearSet)])
def test_sets_that_differ_in_one_member_are_different(member: str) -> None:
    whole = whole_set()
    assert whole.replace(**{member: getattr(whole, member)}) == whole
    assert whole.replace(**changed(whole, member)) != whole


def test_a_covariance_and_the_errors_on_its_files_survive_writing(tmp_path: Path) -> None:
    numbers, matrix = ("load.inertia", "gear.damping"), ((1e-4, -3e-5), (-3e-5, 0.1 + 0.2))
    validated = (
        Validation("a.csv", "log", "current", "A", 0.1, 0.5, 0.12, 0.4, -0.01, 2e-3, {"cos(2 + 3)": 1.25}),
        Validation(
            "b", "torsion", "q", "N.m", 0, 0, 0, 0, measured={"output_torque": (-3.0, 5.5), "temperature": (290.0, 290.0)}
        ),
    )
    whole = whole_set().replace(covariance=Covariance(numbers, matrix), validation=validated)
    whole.save(tmp_path / "set.toml")
    assert GearSet.read(tmp_path / "set.toml") == whole
    other_load = whole.with_parts(load=sw.loads.Inertia(inertia=1.0), source="x")
    assert other_load.covariance == Covariance(("gear.damping",), ((0.1 + 0.2,),))


@pytest.mark.parametrize(("member", "value"), [("covariance", "x"), ("validation", ["x"]), ("validation", "x")])
def test_a_covariance_and_validations_have_their_types(member: str, value: object) -> None:
    with pytest.raises(TypeError, match=f"{member} must be"):
        whole_set().replace(**{member: value})


def test_the_sets_of_the_catalogue_are_all_different_though_some_gears_are_equal() -> None:
    sets = [GearSet.read(name) for name in catalogue()]
    assert all(one != other for i, one in enumerate(sets) for other in sets[:i])
    assert load("hfuc-20-80") == load("csg-20-80")  # the published tables give both the same stiffness and inertia
    assert load("hfuc-20-80") != load("shg-20-80")


# The catalogue


@pytest.mark.parametrize("name", catalogue())
def test_a_catalogue_set_is_read_number_by_number(name: str, tmp_path: Path) -> None:
    """Against the content of its file, in SI units."""
    gear_set = GearSet.read(name)
    document = harmonic_drive.document(name)
    assert load(name) == gear_set.gear
    assert gear_set.name == document.pop("name")
    assert gear_set.maker == document.pop("maker")
    assert gear_set.note == document.pop("note", "")
    assert {key: asdict(rating) for key, rating in gear_set.ratings.items()} == {
        key: {"spread": None, "uncertainty": None, **entry} for key, entry in document.pop("ratings", {}).items()
    }
    counted = 0
    for table, content in document.items():
        model = gear_set.gear if table == "gear" else getattr(gear_set.gear, table)
        assert content.pop("model", model.name) == model.name
        for key, entry in content.items():
            member = getattr(model, key)
            value = entry if isinstance(entry, str) else entry["value"]
            assert (list(member) if isinstance(value, list) else member) == value
            places = [] if isinstance(entry, str) else [""] if not isinstance(value, list) else range(len(value))
            for place in places:
                path = f"{'' if table == 'gear' else 'gear.'}{table}.{key}" + (f"[{place}]" if place != "" else "")
                assert gear_set.sources[path] == Entry(entry["source"], entry.get("spread"))
                counted += 1
    not_given = {path.rpartition(".")[0] for path, entry in gear_set.sources.items() if entry == Entry("not given")}
    assert not_given == {"gear.kinematic_noise", "gear.friction_mesh", "gear.softening"}
    assert counted == sum(entry != Entry("not given") for entry in gear_set.sources.values())
    gear_set.save(tmp_path / "copy.toml")
    assert GearSet.read(tmp_path / "copy.toml") == gear_set


def test_no_number_and_no_source_of_the_catalogue_changes() -> None:
    """The sets are computed: a rule, a figure or a word that changes one of them must be meant."""
    contents = json.dumps([harmonic_drive.document(name) for name in catalogue()], sort_keys=True)
    assert (len(catalogue()), hashlib.sha256(contents.encode()).hexdigest()) == (127, SETS_DIGEST)


@pytest.mark.parametrize("name", ["csg-14-50", "csg-20-160", "hfuc-25-100", "hfuc-58-50", "shg-32-80", "shg-58-160"])
def test_a_catalogue_gear_turns_its_output_by_its_ratio(name: str) -> None:
    """Load and motor are matched to the wave generator, and reach their speed with a time constant of 20 ms."""
    gear = load(name)
    inertia = gear.input_inertia
    motor = sw.motor.DC(inertia=inertia, torque_constant=0.1, back_emf=0.1, resistance=0.1**2 * 0.02 / (3 * inertia))
    disc = sw.loads.Inertia(inertia=inertia * gear.kinematics.ratio**2)
    drive = sw.Drive(gear=gear, motor=motor, load=disc)
    run = sw.simulate(drive, sw.scenario.step(amplitude=20.0, duration=0.2))
    _, _, ratio = name.split("-")
    assert run["input_angle"][-1] > 2 * math.pi
    # Errors and windup of some arcmin are less than a hundredth of the way.
    assert run["output_angle"][-1] == pytest.approx(-run["input_angle"][-1] / int(ratio), rel=1e-2)


# Names and paths


@pytest.mark.parametrize(
    ("name", "near"),
    [
        ("hfuc-25-10", "; hfuc-25 has no ratio of 10, but 30, 50, 80, 100, 120, 160"),
        ("position-drvie", "; near it are position-drive, "),
        ("xyz", "; strainwave"),
    ],
)
def test_a_name_not_in_the_catalogue_is_answered_with_those_near_it(name: str, near: str) -> None:
    with pytest.raises(ValueError, match=f'^no set "{name}" in the catalogue{near}.*catalogue\\(\\) lists all'):
        load(name)


def test_a_path_is_what_has_a_folder_or_ends_in_toml(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("sub").mkdir()
    save(sw.Gear(damping=3.0), "my.toml", name="x", source="x")
    shutil.copy("my.toml", "sub/noending")
    assert load("my.toml") == load(Path("my.toml")) == load("sub/noending") == load(tmp_path / "sub" / "noending")


def test_a_file_is_saved_under_a_name_that_is_read_as_a_path() -> None:
    with pytest.raises(ValueError, match=exactly("mine: a gear file ends in .toml")):
        GearSet.read("hfuc-25-100").save("mine")


@pytest.mark.parametrize("name", ["HFUC-25-100", "hfuc_25_100", " HFUC 25 100"])
def test_a_name_is_known_as_catalogues_print_it(name: str) -> None:
    assert sw.load(name) == sw.load("hfuc-25-100")


def test_a_gear_without_its_name_and_source_is_not_saved(tmp_path: Path) -> None:
    with pytest.raises(TypeError, match=r"^name and source must be given: a gear does not have them"):
        sw.save(sw.Gear(), tmp_path / "mine.toml")
    with pytest.raises(TypeError, match=r"^source must be given"):
        sw.save(sw.Gear(), tmp_path / "mine.toml", name="mine")
