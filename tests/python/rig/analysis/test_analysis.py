"""What a whole analysis says beside its numbers, and the catalogue beside it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import strainwave as sw
from strainwave.rig import Loop, Value, analyse, referred, table, without_friction
from strainwave.rig.analysis.catalogue_check import CatalogueCheck, published
from strainwave.rig.analysis.cycle import cycle_to
from strainwave.rig.analysis.result import Result

from tests.python.catalogue.torsion import Torsion
from tests.python.rig.loops import loop_of_table

ARCMIN = np.pi / 180.0 / 60.0


def of_set(name: str, peak: float, side: str = "output") -> Loop:
    """The loop of a set's own model."""
    found = cycle_to(sw.load(name), peak, side=side)  # type: ignore[arg-type]
    return Loop(found.angle, found.torque, side=side, name=name, angle_sigma=1e-9)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", ["csg-20-100", "csg-25-80", "shg-32-80"])
def test_the_model_of_a_set_is_what_its_catalogue_says(name: str) -> None:
    gear_set = sw.GearSet.read(name)
    torsion, rated = Torsion.of(name), gear_set.ratings["rated_torque"].value
    found = analyse(of_set(name, rated), gear_set=gear_set)
    checks = {each.name: each for each in found.catalogue}
    (k1, k2, k3), (t1, t2) = torsion.published_slopes(), torsion.published_knees()
    figures = published(gear_set, "output")
    assert figures is not None
    assert [figures[key] for key in ("K1", "K2", "K3", "T1", "T2")] == pytest.approx([k1, k2, k3, t1, t2], rel=1e-3)
    for key, known in {"K1": k1, "K2": k2, "K3": k3}.items():
        measured = checks[key].measured
        assert measured is not None
        assert measured.value == pytest.approx(known, rel=2e-3)
        assert checks[key].within
    assert found.hysteresis_loss is not None
    assert found.hysteresis_loss.value == pytest.approx(torsion.width(), rel=1e-3)
    assert found.lost_motion is not None
    assert checks["lost motion"].measured == found.lost_motion
    assert checks["lost motion"].stated == pytest.approx(found.lost_motion.value, rel=1e-3)
    assert 0.0 < found.lost_motion.value <= torsion.width() * 1.01
    width = checks["width at zero torque"]
    assert width.measured is not None
    assert width.measured.value == pytest.approx(width.stated, rel=1e-3)


def test_a_gear_far_from_its_catalogue_is_told() -> None:
    gear_set = sw.GearSet.read("csg-20-100")
    loop = of_set("csg-20-100", 52.0)
    soft = Loop(2.0 * loop.angle, loop.torque, side="output", name="soft", angle_sigma=1e-9)
    checks = {each.name: each for each in analyse(soft, gear_set=gear_set).catalogue}
    assert checks["K2"].within is False
    assert "50 % of the 2.5e+04 N.m/rad of the set, beyond the spread of units" in str(checks["K2"])


@pytest.mark.slow("rig")
def test_errors_of_the_torque_spread_a_figure_as_its_interval_says() -> None:
    """Torques of 0.1 N.m each: at most what is stated, and not much less, since a point between two readings errs less."""
    random, gear_set, plain = np.random.default_rng(4), sw.GearSet.read("csg-20-100"), of_set("csg-20-100", 52.0)
    rows = np.unique(np.r_[np.arange(0, len(plain), max(1, len(plain) // 80)), int(np.argmin(plain.torque)), len(plain) - 1])
    found: dict[str, list[Result]] = {"K2": [], "K3": []}
    for _ in range(60):
        torque = plain.torque[rows] + 0.1 * random.standard_normal(len(rows))
        loop = Loop(plain.angle[rows], torque, side="output", name="noisy", angle_sigma=1e-9, torque_sigma=0.1)
        for each in analyse(loop, gear_set=gear_set).catalogue:
            if each.name in found and each.measured is not None:
                found[each.name].append(each.measured)
    for name, results in found.items():
        scatter = float(np.std([each.value for each in results]))
        assert 0.4 < scatter / float(np.median([each.random for each in results])) < 1.2, name


def test_figures_beyond_the_loop_are_not_compared() -> None:
    checks = {each.name: each for each in analyse(of_set("csg-20-100", 10.0), gear_set=sw.GearSet.read("csg-20-100")).catalogue}
    assert checks["K1"].measured is not None
    assert checks["K2"].measured is None
    assert "the loop ends at 10 N.m, the figure is for 7 to 25 N.m" in str(checks["K2"])


def test_at_the_input_the_figures_are_those_of_the_input() -> None:
    gear_set = sw.GearSet.read("csg-20-100")
    found = analyse(of_set("csg-20-100", 0.52, side="input"), gear_set=gear_set)
    assert found.rated_torque == pytest.approx(0.52)
    assert next(each for each in found.catalogue if each.name == "K2").stated == pytest.approx(25e3 / 100**2)
    assert any("divided by the ratio and its square" in remark for remark in found.remarks)


@pytest.mark.parametrize("name", ["csg-20-100", "csg-25-100"])
def test_at_the_input_friction_is_taken_out_before_the_catalogue_is_compared(name: str) -> None:
    """With it, the catalogue's own gear would show four times its K1: F is two thirds of T1 over the ratio."""
    gear_set = sw.GearSet.read(name)
    rated = gear_set.ratings["rated_torque"].value / 100.0
    loop = of_set(name, rated, side="input")
    within = {each.name: each for each in analyse(loop, gear_set=gear_set).catalogue}
    assert [within[key].measured for key in ("K1", "K2", "K3")] == [None] * 3
    assert "friction of the wave generator is in the loop" in str(within["K1"])
    assert (width := within["width at zero torque"]).measured is not None
    assert width.measured.value == pytest.approx(width.stated, rel=1e-3)
    held = Value(float(gear_set.gear.friction_input.coulomb))  # type: ignore[attr-defined]
    for each in analyse(without_friction(loop, held), gear_set=gear_set).catalogue:
        assert each.measured is not None
        assert each.measured.value == pytest.approx(each.stated, rel=5e-3)
    at_output = analyse(referred(loop, 100.0, "output"), gear_set=gear_set)
    assert [each.measured for each in at_output.catalogue] == [None] * 3
    assert any("friction of the wave generator is inside the loop" in each for each in at_output.remarks)


def test_friction_of_the_pulleys_spreads_k1_as_its_interval_says() -> None:
    """Branches shifted apart in torque by an error of 0.3 N.m: what K1 then is, against the shared part of its error."""
    gear_set, plain = sw.GearSet.read("csg-20-100"), of_set("csg-20-100", 52.0)
    sense = np.where(np.arange(len(plain)) < len(plain) // 2, 1.0, -1.0)
    shown = []
    for error in (0.0, 0.3, -0.3):  # T1 is a knee: backwards, the branch is softer
        loop = replace(plain, torque=plain.torque + error * sense, friction_sigma=0.3)
        found = next(each.measured for each in analyse(loop, gear_set=gear_set).catalogue if each.name == "K1")
        assert found is not None
        shown.append(found)
    changes = [abs(1.0 / each.value - 1.0 / shown[0].value) for each in shown[1:]]
    assert max(changes) == pytest.approx(shown[0].shared / shown[0].value ** 2, rel=0.02)


def test_a_set_without_such_figures_says_so() -> None:
    gear = sw.Gear(stiffness=sw.stiffness.Linear(k=7e3))
    gear_set = sw.GearSet.of(gear, name="plain", source="assumed")
    found = analyse(loop_of_table(), gear_set=gear_set)
    assert any("has no K1, K2 and K3 to compare with" in remark for remark in found.remarks)
    assert found.rated_torque is None


def test_a_set_whose_friction_holds_all_of_the_torque_says_so() -> None:
    held = sw.GearSet.read("hfuc-58-160")
    loop = loop_of_table()
    found = analyse(Loop(loop.angle, 0.1 * loop.torque, side="input", name="weak"), gear_set=held)
    assert any("does not turn the input: its friction holds as much" in remark for remark in found.remarks)


def test_a_cycle_that_is_not_complete_is_not_compared() -> None:
    loop = loop_of_table()
    found = analyse(Loop(loop.angle[:50], loop.torque[:50], side="input", name="part"), gear_set=sw.GearSet.read("csg-20-100"))
    assert found.catalogue == ()
    assert "the cycle is not complete: it is not compared with the catalogue" in found.remarks


def test_the_remarks_of_the_loop_come_first() -> None:
    loop = loop_of_table()
    found = analyse(Loop(loop.angle, loop.torque, side="input", name="x", remarks=("the lamp flickered",)))
    assert found.remarks[0] == "the lamp flickered"
    assert any("no errors were stated" in remark for remark in found.remarks)
    assert any("no rated torque is known (--rated-torque" in remark for remark in found.remarks)


def test_a_table_has_gaps_where_a_loop_has_none() -> None:
    loop = loop_of_table()
    (row,) = table([analyse(Loop(loop.angle[:50], loop.torque[:50], side="input", name="part", unit="A"))])
    assert row.unit == "A"
    assert row.positive_loading is None
    assert row.hysteresis is None
    assert row.negative_loading is not None


def test_few_points_without_errors_have_no_intervals() -> None:
    found = analyse(Loop([0.0, -0.08, -1.03, -0.95, 0.0], [0.36, 0.0, -0.36, 0.0, 0.36], side="input", name="five"))
    secant = found.stiffnesses[0].secant
    assert secant is not None
    assert secant.value == pytest.approx(4.5)
    assert "uncertainty unknown" in str(found.stiffnesses[0].regression)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"loop": "loop.csv"}, "loop must be a Loop"),
        ({"gear_set": "csg-20-100"}, "gear_set must be a GearSet"),
        ({"rated_torque": [1.0]}, "rated_torque must be a number"),
    ],
)
def test_what_is_of_the_wrong_kind_is_refused(arguments: dict[str, object], message: str) -> None:
    with pytest.raises(TypeError, match=message):
        analyse(**{"loop": loop_of_table(), **arguments})  # type: ignore[arg-type]


def test_a_rated_torque_is_positive() -> None:
    with pytest.raises(ValueError, match=r"rated_torque = 0\.0 N\.m must lie in \(0, inf\)"):
        analyse(loop_of_table(), rated_torque=0.0)


@pytest.mark.slow("rig")
def test_many_points_take_no_more_than_their_share() -> None:
    """A loop logged at a high rate: 40 000 points, whose numbers are those of the corners."""
    found = analyse(loop_of_table(step=0.36 / 10_000))
    assert len(found.loop) > 39_000
    assert found.area is not None
    assert found.area.value == pytest.approx(0.3063483432, rel=1e-9)
    assert found.stiffnesses[1].softest.value == pytest.approx(0.31, rel=1e-6)
    assert len(found.stiffnesses[1].local.torque) <= 400


def test_a_figure_of_zero_in_a_set_has_no_share() -> None:
    check = CatalogueCheck("lost motion", Result(0.5, "rad", 0.1, 0.0, 0.3, 0.7), 0.0, "rad", None, "example")
    assert str(check).endswith(", the set has 0 rad")


@pytest.mark.slow("rig")
def test_of_a_log_of_millions_of_points_the_means_of_stretches_are_evaluated() -> None:
    """Noise of 1e-3 rad on every point: a stretch of ten and more has less by the root of their number."""
    plain = loop_of_table(step=0.36 / 300_000)
    angle = plain.angle + 1e-3 * np.random.default_rng(1).standard_normal(len(plain))
    found = analyse(Loop(angle, plain.torque, side="input", name="log", angle_sigma=1e-3))
    assert len(found.loop) == 100_000
    assert f"{len(plain)} points are evaluated as the means of 100000 stretches" in found.loop.corrections
    assert found.area is not None
    assert found.area.value == pytest.approx(0.3063483432, rel=1e-4)
    soft = found.stiffnesses[1].softest
    assert soft.low < 0.31 < soft.high
    assert soft.random < 1e-4
