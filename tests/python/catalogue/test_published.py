"""Published figures of the sets, against the published tables; the slips in these are in docs/reference/catalogue.md."""

from __future__ import annotations

import csv
import re
from collections.abc import Iterator
from statistics import median
from typing import Any

import numpy as np
import pytest

from tests.python.catalogue.makers import (
    BUCKLING,
    CSG_100,
    EXACT,
    INERTIA,
    KNEES,
    RATCHETING,
    RATED,
    ROUNDING_K1,
    SETS,
    SHG_RATED,
    SIZES,
    SLOPES,
    TRANSCRIPTIONS,
    column,
    every_rated_set,
    every_set,
    figures,
    identity,
    with_transcriptions,
)
from tests.python.catalogue.torsion import Torsion
from tests.support.each import each

# --- the transcriptions, and all that is wrong or odd in them ---

RATINGS = {
    "rated_torque": "Rated torque at rated speed 2000 rpm [Nm]",
    "average_torque": "Limit for average torque [Nm]",
    "peak_torque": "Limit for repeated peak torque [Nm]",
    "momentary_torque": "Limit for momentary peak torque [Nm]",
    "maximum_input_speed": "Max. input speed [rpm]",
    "average_input_speed": "Limit for average input speed [rpm]",
}
TORQUES = tuple(RATINGS)[:4]
ENDS = ("ratcheting_torque", "buckling_torque")
MISLABELLED = {("HFUS", 50, 80): "SHG", ("HFUS", 58, 80): "SHG"}
MISPRINTED_T1 = 0.2  # of CSG size 14
LOW_SPEED: dict[int, tuple[int, set[int]]] = {
    14: (1100, {50, 100}), 17: (1100, {50, 100, 120}), 20: (1100, {100, 120, 160}), 40: (950, {100, 120, 160}),
    45: (900, {80, 120}), 50: (850, {80, 120}), 58: (800, {80, 120}),
}  # fmt: skip
# Momentary torques of CSG and SHG that differ in the maker's tables: a footnote limits CSG.
LIMITED = {
    (14, 80): (58, 61), (14, 100): (58, 70), (17, 80): (109, 113), (17, 100): (109, 143), (17, 120): (109, 112),
}  # fmt: skip


def rows(file: str) -> list[dict[str, str]]:
    with (TRANSCRIPTIONS / file).open(newline="", encoding="utf-8") as stream:
        return list(csv.DictReader(stream))


def ratings() -> dict[tuple[str, int, int], dict[str, str]]:
    """Rows by series, size and ratio, in the sizes of the catalogue, with the two wrong labels put right."""
    table = rows("hd_ratings_CSG_SHG_HFUC_HFUS.csv")
    keyed = {(row["Series"], int(row["Size"]), int(row["Ratio"])): row for row in table}
    assert len(keyed) == len(table)
    return {(MISLABELLED.get(key, key[0]), *key[1:]): row for key, row in keyed.items() if key[1] in SIZES}


def torsion_rows(series: str) -> dict[int, dict[str, str]]:
    return {int(row["Size"]): row for row in rows(f"{series}_torsional_data.csv")}


def low_speed(size: int, ratio: int) -> int | None:
    speed, ratios = LOW_SPEED.get(size, (None, set()))
    return speed if ratio in ratios else None


# --- form ---

CHOICES = {
    "kinematics": {"model": "strain_wave", "fixed": "circular_spline"}, "stiffness": {"model": "three_segment"},
    "hysteresis": {"model": "maxwell_slip"}, "kinematic_error": {"model": "fourier"},
    "friction_input": {"model": "coulomb"}, "friction_output": {"model": "viscous"}, "gear": {}, "ratings": {},
}  # fmt: skip
UNITS: dict[str, dict[str, str]] = {
    "kinematics": {"flexspline_teeth": "1", "circular_spline_teeth": "1"},
    "stiffness": {"k1": "N.m/rad", "k2": "N.m/rad", "k3": "N.m/rad", "t1": "N.m", "t2": "N.m"},
    "hysteresis": {"stiffness": "N.m/rad", "breakaway": "N.m"},
    "kinematic_error": {"order": "1", "amplitude": "rad", "phase": "rad"},
    "friction_input": {"coulomb": "N.m", "breakaway": "N.m", "viscous": "N.m.s/rad"},
    "friction_output": {"viscous": "N.m.s/rad"},
    "gear": {"damping": "N.m.s/rad", "input_inertia": "kg.m2"},
    "ratings": {key: "rpm" if key.endswith("speed") else "N.m" for key in (*RATINGS, *ENDS)},
}  # fmt: skip


def numbers(name: str) -> Iterator[tuple[str, str, dict[str, Any]]]:
    """Table, key and entry of every number of a set."""
    for table in UNITS.keys() & SETS[name].keys():
        for key in UNITS[table].keys() & SETS[name][table].keys():
            yield table, key, SETS[name][table][key]


@every_set
def test_a_set_has_exactly_the_tables_and_keys_of_a_gear(name: str) -> None:
    assert SETS[name].keys() - {"note", "ratings"} == {"name", "maker"} | UNITS.keys() - {"ratings"}
    assert SETS[name].get("ratings", {}).keys() in ({"peak_torque"}, set(RATINGS), {"peak_torque", *ENDS})
    for table in UNITS.keys() & SETS[name].keys() - {"ratings"}:
        assert SETS[name][table].keys() == UNITS[table].keys() | CHOICES[table].keys()
        assert CHOICES[table].items() <= SETS[name][table].items()


@every_set
def test_a_set_has_its_name_and_notes_missing_ratings(name: str) -> None:
    note = SETS[name].get("note", "None.")
    assert (name in RATED) != ("Without published ratings" in note)
    assert (SETS[name]["name"], SETS[name]["maker"]) == (name.upper(), "Harmonic Drive")
    assert note[0].isupper()
    assert note.endswith(".")


@every_set
def test_every_number_has_its_unit_and_a_source_and_only_the_spring_a_spread(name: str) -> None:
    for table, key, entry in numbers(name):
        expected = {"unit": UNITS[table][key]}
        spread = {"spread": 0.3} if key in {"k1", "k2", "k3", "t1", "t2"} else {}
        assert {k: entry[k] for k in entry.keys() - {"value", "source"}} == expected | spread, (table, key)
        assert len(entry["source"]) > 20
        assert np.all(np.isfinite(entry["value"]))


@every_set
def test_a_figure_that_is_not_published_says_assumed(name: str) -> None:
    borrowed = name.startswith("hfuc-45-")  # the tables have no HFUC of this size
    for table, key, entry in numbers(name):
        if table != "kinematics":
            derived = key == "peak_torque" and "over 1.3" in entry["source"]  # from CSG, where the table of HFUC has none
            published = not (borrowed or derived) and (table == "stiffness" or key in {*RATINGS, "input_inertia"})
            assert entry["source"].startswith("Harmonic Drive AG catalogue, " if published else "assumed: "), (
                table,
                key,
            )


@every_set
def test_teeth_give_the_nominal_ratio_reversed_with_the_circular_spline_fixed(name: str) -> None:
    flexspline, circular_spline = figures(name, "kinematics", "flexspline_teeth", "circular_spline_teeth")
    assert type(flexspline) is type(circular_spline) is int
    assert circular_spline - flexspline == 2
    assert flexspline / (flexspline - circular_spline) == -identity(name)[2]


# --- published figures ---


@with_transcriptions
def test_the_sets_are_those_of_the_ratings_table_and_hfuc_at_the_ratios_of_csg() -> None:
    listed = {key for key in ratings() if key[0] in {"CSG", "SHG", "HFUC"}}
    assert {identity(name) for name in RATED} == listed
    assert {identity(name) for name in SETS} == listed | {("HFUC", *key[1:]) for key in listed if key[0] == "CSG"}


@each("name", [name for name in SETS if identity(name)[1] in KNEES])
def test_stiffness_is_that_of_the_makers_table(name: str) -> None:
    size = identity(name)[1]
    torsion = Torsion.of(name)
    assert torsion.published_slopes() == pytest.approx(np.array(SLOPES[column(name)][size]) * 1e3, rel=ROUNDING_K1)
    assert torsion.published_knees() == pytest.approx(KNEES[size], rel=EXACT)


@with_transcriptions
@every_set
def test_stiffness_is_that_of_the_transcription_of_its_series(name: str) -> None:
    series, size, ratio = identity(name)
    row = torsion_rows("shg" if series == "SHG" else "csg")[size]
    slopes = [1e4 * float(row[f"K{part}_i{min(ratio, 80)} [x10^4 Nm/rad]"]) for part in (1, 2, 3)]
    t1, t2 = float(row["T1 [Nm]"]), float(row["T2 [Nm]"])
    if series != "SHG" and size == 14:
        assert t1 == MISPRINTED_T1
        t1 = KNEES[size][0]
    torsion = Torsion.of(name)
    assert torsion.published_slopes() == pytest.approx(slopes, rel=ROUNDING_K1)
    assert torsion.published_knees() == pytest.approx((t1, t2), rel=EXACT)


@every_set
def test_the_source_of_each_spring_figure_names_the_published_one(name: str) -> None:
    torsion = Torsion.of(name)
    published = dict(zip(("k1", "t1", "t2"), (torsion.published_slopes()[0], *torsion.published_knees()), strict=True))
    for key, figure in published.items():
        named = re.search(rf"{key.upper()} = (\S+) ", SETS[name]["stiffness"][key]["source"])
        assert named is not None
        assert float(named.group(1)) == pytest.approx(figure, rel=ROUNDING_K1)


@with_transcriptions
@every_rated_set
def test_ratings_are_those_of_the_transcription_but_for_the_low_speeds(name: str) -> None:
    _, size, ratio = key = identity(name)
    transcribed = {rating: float(ratings()[key][heading]) for rating, heading in RATINGS.items()}
    if key[0] == "SHG" and (low := low_speed(size, ratio)):
        assert transcribed["average_input_speed"] == low
        (transcribed["average_input_speed"],) = figures(f"csg-{size}-{ratio}", "ratings", "average_input_speed")
        assert f"transcribed as {low}" in SETS[name]["ratings"]["average_input_speed"]["source"]
    assert figures(name, "ratings", *RATINGS) == tuple(transcribed.values())


@each("size", CSG_100)
def test_csg_ratings_at_ratio_100_are_those_of_the_maker(size: int) -> None:
    assert figures(f"csg-{size}-100", "ratings", *TORQUES) == CSG_100[size]


@each("name", [name for name in SETS if name not in RATED])
def test_an_assumed_peak_torque_of_hfuc_is_that_of_csg_over_13(name: str) -> None:
    (peak,), (of_csg,) = (figures(each, "ratings", "peak_torque") for each in (name, name.replace("hfuc", "csg")))
    assert peak == pytest.approx(of_csg / 1.3, rel=2e-3)
    assert "assumed" in SETS[name]["ratings"]["peak_torque"]["source"]


def test_ratcheting_and_buckling_torques_of_hfuc_are_those_published_for_csf() -> None:
    """They lie above the repeated peak torque of the standard class."""
    published = {
        f"hfuc-{size}-{ratio}": (torque, BUCKLING[size])
        for size, torques in RATCHETING.items()
        for ratio, torque in zip((50, 80, 100), torques, strict=True)
    }
    assert {name: figures(name, "ratings", *ENDS) for name in SETS if ENDS[0] in SETS[name].get("ratings", {})} == published
    for name, (ratcheting, buckling) in published.items():
        (peak,) = figures(name, "ratings", "peak_torque")
        assert peak < ratcheting < buckling


@each("size", SIZES)
def test_shg_exists_at_the_ratios_and_rated_torques_of_the_makers_own_table(size: int) -> None:
    found = {identity(name)[2]: name for name in SETS if identity(name)[:2] == ("SHG", size)}
    assert {ratio: figures(name, "ratings", "rated_torque")[0] for ratio, name in found.items()} == SHG_RATED[size]


@each("name", [name for name in SETS if identity(name)[0] != "SHG" and identity(name)[1] in INERTIA])
def test_wave_generator_inertia_is_that_of_the_maker(name: str) -> None:
    (inertia,) = figures(name, "gear", "input_inertia")
    assert inertia == pytest.approx(1e-4 * INERTIA[identity(name)[1]], rel=EXACT)


@with_transcriptions
@every_set
def test_input_inertia_is_that_of_the_transcription_where_csg_and_hfuc_share_it(name: str) -> None:
    series, size, _ = identity(name)
    donors = {("SHG", size)} if series == "SHG" else {("CSG", size), ("HFUC", size)}
    (transcribed,) = {row["Moment of inertia [x10^-4]"] for key, row in ratings().items() if key[:2] in donors}
    assert figures(name, "gear", "input_inertia") == pytest.approx((1e-4 * float(transcribed),), rel=EXACT)


def test_worked_torsion_example_of_the_catalogue() -> None:
    """Size 32, ratio 100, 60 N.m: the whole gear loaded for the first time, not its spring alone."""
    torsion = Torsion.of("csg-32-100")
    assert torsion.loaded(torsion.virgin(), 60.0).twist == pytest.approx(7.146540027137e-4, rel=ROUNDING_K1)
    assert torsion.spring_twist(60.0) > 7.5e-4


# --- the slips are all of them ---


@with_transcriptions
def test_the_stiffness_tables_of_csg_and_shg_differ_in_one_cell() -> None:
    csg, shg = torsion_rows("csg"), torsion_rows("shg")
    differing = [(size, heading) for size in SIZES for heading in csg[size] if csg[size][heading] != shg[size][heading]]
    assert differing == [(14, "T1 [Nm]")]


@with_transcriptions
def test_an_actuator_with_the_gear_of_size_14_confirms_its_knee() -> None:
    actuators = [row for row in rows("fha_c_mini.csv") if row["model"] == "FHA-14C"]
    assert len(actuators) == 3
    for row in actuators:
        expected = (float(row["T1_Nm"]), float(row["T2_Nm"]), *(1e4 * float(row[f"K{n}_1e4Nm_rad"]) for n in (1, 2)))
        torsion = Torsion.of(f"hfuc-14-{row['ratio']}")
        found = (*torsion.published_knees(), *torsion.published_slopes()[:2])
        assert found == pytest.approx(expected, rel=ROUNDING_K1)


@with_transcriptions
def test_the_ratings_of_cup_and_hat_gears_differ_only_as_listed() -> None:
    """CSG against SHG, HFUC against HFUS: a wrong label shows as a row without partner, or as a difference."""
    table, hat = ratings(), {"CSG": "SHG", "HFUC": "HFUS"}
    cups = {key for key in table if key[0] in hat}
    assert {(hat[series], size, ratio) for series, size, ratio in cups} == table.keys() - cups
    for series, size, ratio in cups:
        pair = table[series, size, ratio], table[hat[series], size, ratio]
        differing = {}
        for rating, heading in RATINGS.items():
            cup, brim = (float(row[heading]) for row in pair)
            if cup != brim:
                differing[rating] = (cup, brim)
        speed = differing.pop("average_input_speed", (None, None))[1]
        assert speed == low_speed(size, ratio)
        assert differing.get("momentary_torque") == LIMITED.get((size, ratio))
        assert differing.keys() <= {"momentary_torque"}


@with_transcriptions
@each("size", SIZES)
def test_shg_has_the_average_speed_of_csg_at_one_ratio_at_least(size: int) -> None:
    heading, table = RATINGS["average_input_speed"], ratings()
    csg, shg = ({row[heading] for key, row in table.items() if key[:2] == (series, size)} for series in ("CSG", "SHG"))
    assert len(csg) == 1
    assert csg <= shg


# --- physical plausibility ---


def lines(axis: int, table: str, key: str) -> list[list[float]]:
    """Figures over growing size (axis 1) or ratio (axis 2), one list for each choice of the rest."""
    found: dict[tuple[Any, ...], dict[Any, float]] = {}
    for name in SETS if table != "ratings" else RATED:
        label = identity(name)
        (figure,) = figures(name, table, key)
        found.setdefault(label[:axis] + label[axis + 1 :], {})[label[axis]] = figure
    return [[line[step] for step in sorted(line)] for line in found.values()]


@each(
    ("table", "key"),
    [("stiffness", key) for key in UNITS["stiffness"]]
    + [("ratings", key) for key in TORQUES]
    + [("friction_input", "breakaway"), ("friction_input", "viscous"), ("gear", "damping"), ("gear", "input_inertia")],
)
def test_a_larger_gear_is_stiffer_stronger_and_heavier(table: str, key: str) -> None:
    assert all(np.all(np.diff(line) > 0.0) for line in lines(1, table, key))


@each("key", ["maximum_input_speed", "average_input_speed"])
def test_a_larger_gear_is_not_faster_and_the_ratio_does_not_matter(key: str) -> None:
    assert all(np.all(np.diff(line) <= 0.0) for line in lines(1, "ratings", key))
    assert all(len(set(line)) == 1 for line in lines(2, "ratings", key))


@each("key", ["k1", "k2", "k3"])
def test_a_higher_ratio_is_not_softer(key: str) -> None:
    assert all(np.all(np.diff(line) >= 0.0) for line in lines(2, "stiffness", key))


@each("key", TORQUES)
def test_a_higher_ratio_is_not_weaker_but_for_one_published_exception(key: str) -> None:
    falling = [line for line in lines(2, "ratings", key) if np.any(np.diff(line) < 0.0)]
    assert falling == ([[91.0, 113.0, 143.0, 112.0]] if key == "momentary_torque" else [])  # SHG-17, 50 to 120


@every_rated_set
def test_limits_are_ordered(name: str) -> None:
    assert np.all(np.diff(figures(name, "ratings", *TORQUES)) >= 0.0)
    assert np.all(np.diff(figures(name, "ratings", "average_input_speed", "maximum_input_speed")) > 0.0)


@every_set
def test_the_spring_stiffens_with_torque(name: str) -> None:
    assert np.all(np.diff((0.0, *figures(name, "stiffness", "k1", "k2", "k3"))) > 0.0)
    assert np.all(np.diff((0.0, *figures(name, "stiffness", "t1", "t2"))) > 0.0)


@each(("ratio", "tolerance"), [(30, 0.2), (50, 0.15), (80, 0.1)])
def test_twist_at_the_first_knee_hardly_depends_on_size(ratio: int, tolerance: float) -> None:
    """Geometric similarity: torque and stiffness both grow with the cube of the size."""
    knees = [figures(name, "stiffness", "t1", "k1") for name in SETS if identity(name)[2] == ratio]
    twist = [t1 / k1 for t1, k1 in knees]
    assert twist == pytest.approx([median(twist)] * len(twist), rel=tolerance)


@each("ratio", [30, 50, 80])
@each("key", ["k1", "k2", "k3"])
def test_stiffness_grows_with_the_cube_of_size_within_the_spread_of_units(ratio: int, key: str) -> None:
    names = [name for name in SETS if identity(name)[2] == ratio]
    scaled = [figures(name, "stiffness", key)[0] / identity(name)[1] ** 3 for name in names]
    assert scaled == pytest.approx([median(scaled)] * len(scaled), rel=0.3)


@each("name", [name for name in SETS if name.startswith("shg")])
def test_shg_has_the_stiffness_and_a_heavier_input_than_csg(name: str) -> None:
    csg = name.replace("shg", "csg")
    assert figures(name, "stiffness", *UNITS["stiffness"]) == figures(csg, "stiffness", *UNITS["stiffness"])
    assert figures(name, "gear", "input_inertia") > figures(csg, "gear", "input_inertia")
