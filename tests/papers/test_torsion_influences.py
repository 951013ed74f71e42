"""The torsion article's Table 3: sweeps against closed forms and the printed catalogue, and what is said of each entry."""

from __future__ import annotations

import re
import sys
from math import exp
from pathlib import Path

import influence_claims as claims
import numpy as np
import pytest
import strainwave as sw
import torsion_influences as study
from influence_claims import CONFIRMED, CONTRADICTED, IN_PART, SPEAKS, UNDECIDABLE
from influence_page import page, summary, tables, write_page
from strainwave.rig import Series, cycle_to
from torsion_influences import (
    OWN,
    SPECIMEN,
    Influence,
    catalogue_rows,
    compliance_shares,
    held_at_rest,
    influence,
    lossless_torque,
    over_torque,
    rates_of,
)

pytestmark = pytest.mark.slow("papers")  # an article's study runs for seconds


@pytest.fixture(scope="module")
def found() -> Influence:
    return influence(sw.GearSet.read("csg-25-100"))


def linear(**parts: object) -> sw.GearSet:
    gear = sw.Gear(stiffness=sw.stiffness.Linear(k=1e4), **parts)  # type: ignore[arg-type]
    return sw.GearSet.of(gear, name="linear", source="assumed")


def test_area_over_torque_is_the_closed_form_of_one_element() -> None:
    """4 F ((T - F)/k - F/k_1) above the slip at F (k + k_1)/k_1, nothing below it, so linear in the twist far above."""
    k, other, slip = 1e4, 5e3, 2.0
    gear = linear(hysteresis=sw.hysteresis.MaxwellSlip(stiffness=[other], breakaway=[slip])).gear
    sweep = over_torque(gear, 100.0)
    expected = 4.0 * slip * ((sweep.levels - slip) / k - slip / other)
    assert sweep["area"] == pytest.approx(np.where(sweep.levels > slip * (k + other) / other, expected, 0.0), rel=1e-4)
    above = sweep.levels > 10.0
    line = np.polyfit((sweep.levels[above] - slip) / k, sweep["area"][above], 1)
    assert line[0] == pytest.approx(4.0 * slip, rel=1e-4)
    assert sweep.local_exponents("area")[-1] == pytest.approx(1.0, abs=0.1)


def test_stiffness_of_linear_springs_goes_with_the_modulus() -> None:
    found = influence(linear(), 50.0)
    assert found.material.exponent("stiffness").value == pytest.approx(1.0, rel=1e-12)


def test_the_catalogue_is_that_of_the_printed_table() -> None:
    """Size 25: 31, 50, 57 at ratio 100 and 10, 13, 21 at ratio 30, in kN.m/rad; T1 is 14 N.m."""
    rows = {(row.size, row.ratio): row for row in catalogue_rows()}
    high, low = rows[25, 100], rows[25, 30]
    assert [high.k1, high.k2, high.k3, high.t1] == pytest.approx([31e3, 50e3, 57e3, 14.0], rel=1e-5)
    assert [low.k1, low.k2, low.k3, low.t1] == pytest.approx([10e3, 13e3, 21e3, 14.0], rel=1e-5)
    assert np.degrees(high.width) * 60.0 == pytest.approx(0.5, rel=1e-3)
    assert np.degrees(low.width) * 60.0 == pytest.approx(1.5, rel=1e-3)


def test_no_higher_ratio_is_softer_at_the_output() -> None:
    """By the printed tables of ratio 30, 50 and above 50: 5 sizes have all three, 4 have two; none is compared with itself."""
    assert claims.steps_and_falls(tuple(catalogue_rows())) == (3 * (5 * 2 + 4), 0)


def test_shares_of_the_staged_gear_are_those_of_its_static_compliance() -> None:
    """1/K_out = 1/12195.12195 without the circular spline (number 7.10), of which 1/2e4 is the flexspline's; K_CS = 2e5."""
    shares, whole = compliance_shares(), 1.0 / 12195.12195121951 + 1.0 / 2e5
    assert shares["flexspline"] == pytest.approx(1.0 / 2e4 / whole, rel=1e-9)
    assert shares["circular spline"] == pytest.approx(1.0 / 2e5 / whole, rel=1e-9)
    assert sum(shares.values()) == pytest.approx(1.0, rel=1e-12)


def test_friction_at_rest_is_the_breakaway() -> None:
    assert held_at_rest(sw.load("csg-25-100")) == pytest.approx(0.09005, rel=1e-9)
    bristles = sw.friction.LuGre(coulomb=0.05, breakaway=0.05, stribeck_speed=1.0, bristle_stiffness=500.0, bristle_damping=0.0)
    assert held_at_rest(sw.Gear(friction_input=bristles)) == pytest.approx(0.05, rel=1e-3)
    assert held_at_rest(sw.Gear()) == 0.0


def test_a_gear_that_knows_its_temperature_is_taken_at_its_word() -> None:
    law = sw.friction.Thermal(law=sw.friction.Coulomb(coulomb=0.02), dry_fall=0.01)
    soft = sw.softening.ThermalSoftening(stiffness_fall=2e-4, hysteresis_fall=1e-3)
    rates = rates_of(sw.Gear(friction_input=law, softening=soft))
    assert [rates.stiffness, rates.hysteresis, rates.friction] == pytest.approx([2e-4, 1e-3, 0.01], rel=1e-9)
    assert rates.factors(303.15, 293.15).friction == pytest.approx(exp(-0.1))


def test_steel_and_a_joint_stand_in_where_the_gear_knows_nothing(found: Influence) -> None:
    """203.4 to 198.6 GPa over 72 K are 3.3e-4 per kelvin; 8.27 of 354 mA are 2.3 % per kelvin."""
    assert found.rates.stiffness == pytest.approx(3.3e-4, rel=0.01)
    assert found.rates.friction == pytest.approx(0.0234, rel=0.01)


def test_the_gear_of_the_article_loses_nothing_in_small_loops_and_no_more_beyond_its_stops(found: Influence) -> None:
    """The branches give way once the soft twists at both ends, (T - T0)/H, add up to w; the area ends at that of row 0."""
    sweep = found.amplitude[SPECIMEN]
    rising, falling = (stiff * soft / (stiff - soft) for stiff, soft in ((4.51, 0.30), (4.85, 0.31)))
    onset = 0.03 + 0.8813912722571364 / (1.0 / rising + 1.0 / falling)
    assert ((sweep["area"] == 0.0) == (sweep.levels < onset)).all()
    assert found.lossless[SPECIMEN] == pytest.approx(onset, rel=1e-6)
    assert sweep["area"][-1] == pytest.approx(0.3063483432, rel=1e-5)
    assert sweep["area"][-2] == pytest.approx(0.3063483432, rel=1e-4)


def test_the_torque_without_loss_is_where_the_first_element_slips(found: Influence) -> None:
    """All three elements of csg-25-100 hold 0.64724 N.m; the stiffest slips first, with K1 and the others beside it."""
    gear = found.gear_set.gear
    elements, first = gear.hysteresis.stiffness, gear.hysteresis.breakaway[0]
    onset = (gear.stiffness.k1 + sum(elements)) * first / max(elements)
    assert found.lossless[OWN] == pytest.approx(onset, rel=1e-6)
    assert onset == pytest.approx(2.1036, abs=1e-4)
    answer = next(
        each.answer for each in claims.entries(found) if (each.parameter, each.regime) == (claims.TORQUE, claims.HYSTERESIS)
    )
    assert answer.startswith("Nothing is lost up to 2.104 N·m; the area grows with the power 0.86")
    assert "the article’s gear loses nothing up to 0.1738 N·m" in answer


def test_a_gear_that_never_loses_or_always_has_the_ends_as_its_threshold() -> None:
    assert lossless_torque(linear().gear, 50.0) == 50.0
    smooth = sw.hysteresis.BoucWen(stiffness=5e3, saturation=2.0)
    assert lossless_torque(linear(hysteresis=smooth).gear, 50.0) == 0.0


def test_friction_at_the_input_acts_under_a_given_torque_as_a_spring_with_friction_does() -> None:
    """4 F (T - F) i^2/k at each level of friction."""
    set_ = linear(friction_input=sw.friction.Coulomb(coulomb=0.02))
    found = influence(set_, 20.0)
    assert found.preload is not None
    torque, ratio = found.input_torque, 100.0
    friction = 0.02 * found.preload.levels
    assert found.preload["area"] == pytest.approx(4.0 * friction * (torque - friction) * ratio**2 / 1e4, rel=1e-6)


def test_levels_at_which_friction_holds_the_shaft_are_left_out() -> None:
    found = influence(linear(friction_input=sw.friction.Coulomb(coulomb=0.09)), 15.0)
    assert found.preload is not None
    assert found.preload.levels.max() == 1.5
    assert found.temperature.levels.min() == 273.15  # at -20 degC friction is 2.5 times as large


@pytest.mark.parametrize(
    ("coulomb", "torque", "message"),
    [
        (0.0, None, "linear has no rated torque; give the torque"),
        (0.2, 10.0, "torque = 10 N.m at the output is 0.1 N.m at the input, where friction holds 0.2 N.m"),
        (0.0, -1.0, "torque = -1.0 N.m must be positive"),
    ],
)
def test_what_cannot_be_varied_is_refused(coulomb: float, torque: float | None, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        influence(linear(friction_input=sw.friction.Coulomb(coulomb=coulomb)), torque)


def test_each_entry_has_a_verdict_a_number_and_words(found: Influence) -> None:
    entries = claims.entries(found)
    assert len(entries) == 16
    assert {(each.parameter, each.regime) for each in entries} == set(SPEAKS) | {
        (claims.MATERIAL, claims.LOW),
        (claims.MATERIAL, claims.HYSTERESIS),
    }
    for each in entries:
        assert any(letter.isdigit() for letter in each.answer), each.answer
        assert each.answer.endswith(".")
        assert "nan" not in each.answer
        assert "—" not in each.answer  # no number


def test_the_verdicts_of_a_catalogue_gear(found: Influence) -> None:
    """Row by row: the torque's, the ratio's, the material's, the preload's, the temperature's."""
    assert [each.verdict for each in claims.entries(found)] == [
        *(CONFIRMED, IN_PART, CONFIRMED),
        *(CONTRADICTED, CONFIRMED, UNDECIDABLE),
        *(CONFIRMED, CONTRADICTED, UNDECIDABLE, UNDECIDABLE),
        *(IN_PART, CONFIRMED, CONFIRMED),
        *(CONFIRMED, CONFIRMED, IN_PART),
    ]


def test_of_a_gear_that_loses_nothing_its_losses_are_undecidable() -> None:
    entries = {(each.parameter, each.regime): each for each in claims.entries(influence(linear(), 50.0))}
    for row in (claims.TORQUE, claims.PRELOAD, claims.TEMPERATURE):
        assert entries[row, claims.HYSTERESIS].verdict == UNDECIDABLE
    assert entries[claims.PRELOAD, claims.LOW].verdict == UNDECIDABLE
    assert "would decide" in entries[claims.PRELOAD, claims.LOW].answer


def measured(effect: float, seed: int) -> Series:
    """Areas of loops of a gear at four torques and three temperatures, friction falling with the temperature, 1 % noise."""
    random, gear = np.random.default_rng(seed), sw.load("csg-25-100")
    torque, warm = (each.ravel() for each in np.meshgrid([30.0, 45.0, 60.0, 87.0], [283.0, 293.0, 303.0]))
    loops = {level: cycle_to(gear, level) for level in sorted(set(torque.tolist()))}
    noise = np.exp(0.01 * random.normal(size=(2, len(torque))))
    area = np.array([loops[level].area for level in torque]) * np.exp(-effect * (warm - 293.0)) * noise[0]
    stiffness = np.array([loops[level].stiffness for level in torque]) * noise[1]
    return Series({"torque_max": torque, "temperature": warm}, {"area": area, "stiffness": stiffness}, name="made")


def test_a_measured_series_speaks_to_the_entries_it_can(found: Influence) -> None:
    with_series = influence(found.gear_set, series=measured(0.02, 1))
    entries = {(each.parameter, each.regime): each for each in claims.entries(with_series) if each.measured}
    verdicts = {key: each.measured_verdict for key, each in entries.items()}
    assert verdicts == {
        (claims.TORQUE, claims.HIGH): CONFIRMED,
        (claims.TORQUE, claims.HYSTERESIS): CONFIRMED,
        (claims.TEMPERATURE, claims.HIGH): UNDECIDABLE,
        (claims.TEMPERATURE, claims.HYSTERESIS): CONFIRMED,
    }
    (rate,) = [each for each in with_series.trends if (each.factor, each.quantity) == ("temperature", "area")]
    assert rate.interval[0] < -0.02 < rate.interval[1]
    (power,) = [each for each in with_series.trends if (each.factor, each.quantity) == ("torque_max", "area")]
    own = found.amplitude[OWN].exponent("area", 0.34 * 87.0).value
    assert power.slope.value == pytest.approx(own, abs=0.05)


def test_stiffness_that_rises_with_temperature_contradicts(found: Influence) -> None:
    series = Series({"temperature": [280.0, 290.0, 300.0, 310.0]}, {"stiffness": [1.0, 1.1, 1.21, 1.33]})
    entries = claims.entries(influence(found.gear_set, series=series))
    (warm,) = [each for each in entries if each.measured]
    assert (warm.regime, warm.measured_verdict) == (claims.HIGH, CONTRADICTED)
    assert "changes by 9.98 % per 10 K" in warm.measured[0]


def test_what_was_varied_together_decides_nothing(found: Influence) -> None:
    series = Series(
        {"temperature": [280.0, 290.0, 300.0, 310.0, 320.0], "hours": [0.0, 10.0, 20.0, 30.0, 40.0]},
        {"area": [1.0, 1.2, 1.4, 1.7, 2.0]},
    )
    with_series = influence(found.gear_set, series=series)
    (area,) = [each for each in claims.entries(with_series) if each.measured]
    assert area.measured_verdict == UNDECIDABLE
    assert "cannot be separated" in area.measured[0]


def test_the_life_of_a_unit_has_a_line_of_its_own(found: Influence) -> None:
    assert claims.life(found) is None
    cycles = np.arange(8) * 1e6
    series = Series({"cycles": cycles}, {"width": 1.0 * np.exp(0.05 * cycles / 1e6), "area": np.full(8, 1.0) + [0.0, 0.01] * 4})
    entry = claims.life(influence(found.gear_set, series=series))
    assert entry is not None
    assert entry.measured_verdict == CONFIRMED
    assert "5.13 % per a million cycles" in entry.measured[0]


def test_the_page_and_the_lines_have_every_entry(found: Influence, tmp_path: Path) -> None:
    with_series = influence(found.gear_set, series=measured(0.02, 1))
    text, lines = page(with_series), summary(with_series)
    for each in claims.entries(with_series):
        assert each.words in text
        assert each.answer in text
        assert each.words.split()[0] in lines
        assert all(sentence in text for sentence in each.measured)
    assert "made, 12 loops" in text
    assert max(map(len, lines.splitlines())) <= 110
    write_page(with_series, tmp_path)
    shown = re.findall(r"\]\((\S+\.svg)\)", text)
    assert sorted(shown) == sorted(path.name for path in tmp_path.glob("*.svg"))
    assert len(shown) == 7


def test_the_script_writes_a_page_and_the_sweeps(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["torsion_influences.py", "csg-25-100", "--out", str(tmp_path / "new")])
    study.main()
    written = {path.name for path in (tmp_path / "new").iterdir() if path.suffix != ".svg"}
    assert written == {
        "page.md",
        *(f"{name}.csv" for name in ("modulus", "preload", "temperature", "torque-level", "torque-level-article")),
    }
    assert "8 confirmed, 3 confirmed in part, 2 contradicted, 3 undecidable" in capsys.readouterr().out
    sweep = sw.Recording.read(tmp_path / "new" / "torque-level.csv")
    assert np.all(np.diff(sweep["area"]) >= 0.0)


def test_the_tables_hold_the_sweeps(found: Influence) -> None:
    held = tables(found)
    assert list(held) == ["torque-level", "torque-level-article", "modulus", "temperature", "preload"]
    assert held["torque-level"].unit("area") == "J"
    assert held["preload"]["preload"].tolist() == [0.5, 0.7, 0.85, 1.0, 1.15, 1.3, 1.5, 2.0]
