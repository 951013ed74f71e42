"""Friction tables: what steady torques tell, and what they do not."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
import strainwave as sw
from strainwave.identification.candidates.friction import cost_of, fit_friction, innermost, plain_error
from strainwave.identification.experiments.friction_table import FrictionTable

from tests.support.strategies import made

# Document P, Table 2, measured column; its least-squares line as physics computes it independently.
TABLE_2 = FrictionTable(np.array([0.1, 0.5, 1.0, 2.0, 5.0]), np.array([0.012, 0.028, 0.045, 0.078, 0.165]))
LINE = (0.012554434963, 0.030840444789)


LUGRE = made(sw.friction.LuGre, viscous=5e-5)


@pytest.mark.parametrize("law", [sw.friction.Viscous(), sw.friction.Coulomb(), made(sw.friction.Stribeck), LUGRE])
def test_the_published_table_gives_its_line_whatever_the_law(law: object) -> None:
    found = fit_friction(TABLE_2, sw.Gear(friction_input=law))[0].fit.gear.friction_input
    assert (found.coulomb, found.viscous) == pytest.approx(LINE, rel=1e-9)
    assert found.steady(TABLE_2.speed) == pytest.approx(LINE[0] + LINE[1] * TABLE_2.speed)


def test_plain_least_squares_are_coulomb_and_viscous_friction_on_the_same_parts() -> None:
    """The published table is best as that law, so that both errors agree; a fall towards low speed is beyond it."""
    everything = np.ones(len(TABLE_2.speed), bool)
    assert plain_error(TABLE_2, everything) == pytest.approx(fit_friction(TABLE_2, sw.Gear())[0].error, rel=1e-6)
    falling = made(sw.friction.Stribeck, coulomb=0.03, breakaway=0.06, stribeck_speed=3.0)
    speed = np.geomspace(0.1, 100.0, 40)
    fallen = FrictionTable(speed, falling.steady(speed))
    assert plain_error(fallen, np.ones(40, bool)) > 100.0 * fit_friction(fallen, sw.Gear())[0].error


def test_plain_least_squares_leave_out_the_outliers_and_know_a_zero_error_and_a_loss_under_load() -> None:
    speed, load = np.tile([-20.0, -5.0, 5.0, 10.0, 20.0, 40.0], 2), np.repeat([0.0, 2.0], 6)
    torque = np.sign(speed) * (0.05 + 0.1 * load) + 1e-3 * speed + 0.02
    trusted = np.arange(12) != 3
    assert plain_error(FrictionTable(speed, torque + 5.0 * ~trusted, load=load), trusted) < 1e-12


def test_the_ratio_of_breakaway_is_kept_where_the_table_is_silent() -> None:
    law = sw.friction.Coulomb(coulomb=0.072, breakaway=1.0388 * 0.072, viscous=4e-4)
    found = fit_friction(TABLE_2, sw.Gear(friction_input=law))[0].fit.gear.friction_input
    assert found.breakaway / found.coulomb == pytest.approx(1.0388, rel=1e-12)


@pytest.mark.parametrize("law", [sw.friction.Viscous, sw.friction.Coulomb, sw.friction.Stribeck, sw.friction.LuGre])
def test_a_fall_at_low_speed_is_found_where_there_is_one(law: type[sw.friction.LuGre]) -> None:
    truth = sw.friction.Stribeck(coulomb=0.03, breakaway=0.05, stribeck_speed=3.0, viscous=2e-4)
    speed = np.geomspace(0.1, 300.0, 60)
    noise = 3e-4 * np.random.default_rng(1).normal(size=len(speed))
    best, *others = fit_friction(
        FrictionTable(speed, truth.steady(speed) + noise), sw.Gear(friction_input=made(law, viscous=5e-5))
    )
    assert best.name == "with a fall at low speed"
    (line,) = (other for other in others if other.name == "Coulomb and viscous")
    assert best.error < 0.2 * line.error
    for estimate, value in zip(best.fit.estimates, (0.03, 0.05, 3.0, 2e-4), strict=True):
        assert abs(estimate.value - value) < 4.0 * estimate.sigma


@pytest.mark.slow("identification")
def test_no_fall_is_made_up_from_noise() -> None:
    truth = sw.friction.Coulomb(coulomb=0.03, breakaway=0.03, viscous=2e-4)
    speed = np.geomspace(0.1, 300.0, 40)
    names = []
    for seed in range(5):
        noise = 1e-3 * np.random.default_rng(seed).normal(size=len(speed))
        table = FrictionTable(speed, truth.steady(speed) + noise)
        names.append(fit_friction(table, sw.Gear(friction_input=LUGRE))[0].name)
    assert names.count("Coulomb and viscous") >= 4


def test_laws_tried_on_the_way_give_no_warning_of_passivity() -> None:
    """The law of the gear and the one found are passive; a fast fall of the same bristle would not be."""
    law = LUGRE.replace(coulomb=0.09, breakaway=0.095, bristle_damping=8e-3, viscous=7e-4)
    with pytest.warns(sw.PassivityWarning):
        law.replace(coulomb=0.02)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        found = fit_friction(TABLE_2, sw.Gear(friction_input=law))[0].fit.gear.friction_input
        found.check()


@pytest.mark.parametrize(
    "law",
    [made(sw.friction.TorqueEfficiency), sw.friction.LoadDependent(), sw.friction.Thermal(), sw.friction.Cyclic()],
    ids=lambda law: law.name,
)
def test_a_law_that_a_table_cannot_tell_is_refused(law: sw.friction.Thermal) -> None:
    message = f"^a friction table cannot be fitted to {law.name} friction; it can to viscous, coulomb, stribeck, lugre, "
    with pytest.raises(ValueError, match=message):
        fit_friction(TABLE_2, sw.Gear(friction_input=law))


def test_error_is_that_of_speeds_left_out() -> None:
    # the line through the other four, by hand, at 5 rad/s
    slope, intercept = np.polyfit(TABLE_2.speed[:4], TABLE_2.torque[:4], 1)
    best = fit_friction(TABLE_2, sw.Gear())[0]
    assert best.held_out[4] == pytest.approx(intercept + 5.0 * slope, rel=1e-8)
    assert best.error == pytest.approx(np.sqrt(np.mean((TABLE_2.torque - best.held_out) ** 2)))


def test_magnitudes_over_speeds_of_both_signs_are_understood() -> None:
    recording = sw.Recording(
        {"speed": [-2.0, -1.0, 1.0, 2.0], "torque": [0.2, 0.1, 0.1, 0.2]}, {"speed": "rad/s", "torque": "N.m"}
    )
    assert FrictionTable.of(recording).torque == pytest.approx([-0.2, -0.1, 0.1, 0.2])


@pytest.mark.slow("identification")
def test_a_law_chosen_by_a_hair_makes_its_numbers_no_surer_than_the_laws_beside_it() -> None:
    truth = sw.friction.Stribeck(coulomb=0.0380, breakaway=0.0433, stribeck_speed=2.6, viscous=4.5e-4)
    speed = np.pi / 30.0 * np.array([5, 10, 20, 30, 50, 100, 200, 400, 800, 1200, 1800, 2500, 3000.0])
    both = np.concatenate((speed, -speed))
    distances, hairs = [], 0
    for seed in range(5, 9):  # of the first ten, other laws are more likely in 5 and 8
        random = np.random.default_rng(seed)
        noise = 0.01 * truth.steady(both) * random.normal(size=26) + 1.5e-3 * random.normal(size=26)
        best, *others = fit_friction(FrictionTable(both, truth.steady(both) + noise), sw.Gear())
        coulomb = best.fit.estimates[0]
        distances.append((coulomb.value - truth.coulomb) / coulomb.sigma)
        hairs += best.name != "with a fall at low speed"
        for other in others:
            if other.information < best.information:  # more likely, so it has half of the weight
                assert coulomb.sigma > 0.5 * abs(other.coulomb - coulomb.value)
    assert hairs > 0
    assert np.max(np.abs(distances)) < 2.5


def test_three_speeds_are_too_few_and_four_are_enough() -> None:
    speed = np.array([1.0, 2.0, 5.0, 10.0])
    with pytest.raises(ValueError, match="at least 4 speeds, one of them to validate; this one has 3"):
        fit_friction(FrictionTable(speed[:3], 0.1 + 0.01 * speed[:3]), sw.Gear())
    assert fit_friction(FrictionTable(speed, 0.1 + 0.01 * speed), sw.Gear())[0].coulomb == pytest.approx(0.1)


@pytest.mark.parametrize(
    ("speed", "torque", "message"),
    [
        ([0.0, 1.0, 2.0, 3.0], [0.1, 0.2, 0.3, 0.4], "sample 0 has speed 0"),
        ([1.0, 2.0, 3.0], [-0.1, -0.2, -0.3], "drives the motion instead of opposing it"),
    ],
)
def test_what_is_no_table_of_steady_friction_is_refused(speed: list[float], torque: list[float], message: str) -> None:
    recording = sw.Recording({"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})
    with pytest.raises(ValueError, match=message):
        FrictionTable.of(recording)


BOTH_WAYS = np.concatenate([-np.geomspace(0.3, 300.0, 20), np.geomspace(0.3, 300.0, 20)])
TRUTHS = {
    "Coulomb and viscous": sw.friction.Coulomb(coulomb=0.03, viscous=2e-4),
    "with a fall at low speed": sw.friction.Stribeck(coulomb=0.03, breakaway=0.05, stribeck_speed=3.0, viscous=2e-4),
    "curved viscous": sw.friction.CurvedViscous(coulomb=0.03, viscous_torque=0.04, exponent=0.6, reference_speed=300.0),
    "with a fall at low speed, asymmetric": sw.friction.Asymmetric(
        law=sw.friction.Stribeck(coulomb=0.03, breakaway=0.05, stribeck_speed=3.0, viscous=2e-4), dry_asymmetry=0.05
    ),
}


@pytest.mark.slow("identification")
@pytest.mark.parametrize("name", TRUTHS)
def test_the_law_that_the_torque_follows_is_ranked_first(name: str) -> None:
    """What is more than the truth, as asymmetry, is not taken from noise alone."""
    truth, first = TRUTHS[name].steady(BOTH_WAYS), []
    for seed in range(3):
        noise = 0.01 * np.abs(truth).max() * np.random.default_rng(seed).normal(size=len(truth))
        first.append(fit_friction(FrictionTable(BOTH_WAYS, truth + noise), sw.Gear())[0].name)
    assert first == 3 * [name]


@pytest.mark.slow("identification")
def test_a_curved_law_leaves_bristles_out_and_an_asymmetric_one_holds_them() -> None:
    for name, kind in (
        ("curved viscous", sw.friction.CurvedViscous),
        ("with a fall at low speed, asymmetric", sw.friction.LuGre),
    ):
        best = fit_friction(FrictionTable(BOTH_WAYS, TRUTHS[name].steady(BOTH_WAYS)), sw.Gear(friction_input=LUGRE))[0]
        assert type(innermost(best.law)) is kind
        assert best.law.steady(BOTH_WAYS) == pytest.approx(TRUTHS[name].steady(BOTH_WAYS), rel=1e-5)


def test_all_laws_are_ranked_by_what_speaks_for_them() -> None:
    noise = 3e-4 * np.random.default_rng(1).normal(size=len(BOTH_WAYS))
    table = FrictionTable(BOTH_WAYS, TRUTHS["with a fall at low speed"].steady(BOTH_WAYS) + noise)
    found = fit_friction(table, sw.Gear())
    assert found[0].law.name == "stribeck"
    assert {each.name for each in found} >= {"Coulomb and viscous", "curved viscous", "with a fall at low speed, asymmetric"}
    (plain,) = (each for each in found if each.name == "Coulomb and viscous")
    assert plain.parameters == 2
    assert found[0].information < plain.information - 20.0
    assert found[0].error == pytest.approx(3e-4, rel=0.3)
    assert all(0.0 < each.error_sigma < 0.5 * each.error and 0.001 < cost_of(each.law) < 100.0 for each in found)


def test_a_table_over_the_temperature_tells_how_friction_falls() -> None:
    law = sw.friction.Thermal(
        law=TRUTHS["with a fall at low speed"], dry_fall=0.015, viscous_fall=0.03, reference_temperature=300.0
    )
    speed, temperature = np.tile(BOTH_WAYS, 3), np.repeat([290.0, 305.0, 320.0], len(BOTH_WAYS))
    torque = law.steady(speed, temperature=temperature)
    noise = 3e-4 * np.random.default_rng(1).normal(size=len(speed))
    recording = sw.Recording(
        {"speed": speed, "torque": torque + noise, "temperature": temperature - 273.15},
        {"speed": "rad/s", "torque": "N.m", "temperature": "degC"},
    )
    best = fit_friction(FrictionTable.of(recording), sw.Gear())[0]
    assert best.name == "with a fall at low speed, over the temperature"
    fall = {estimate.path.rpartition(".")[2]: estimate for estimate in best.fit.estimates}
    for name, truth in (("dry_fall", 0.015), ("viscous_fall", 0.03)):
        low, high = fall[name].interval(0.99)
        assert low < truth < high
        assert fall[name].sigma < 0.1 * truth


@pytest.mark.slow("identification")
def test_a_table_under_load_tells_how_friction_grows_with_it() -> None:
    """In both directions, and where one of them has more friction, too."""
    mixed = sw.friction.MixedLubrication(coulomb=0.03, breakaway=0.05, stribeck_speed=3.0, viscous=2e-4, load_sensitivity=2.0)
    speed, load = np.tile(BOTH_WAYS, 3), np.repeat([0.0, 0.15, -0.3], len(BOTH_WAYS))
    for law in (mixed, sw.friction.Asymmetric(law=mixed, dry_asymmetry=0.1)):
        noise = 3e-4 * np.random.default_rng(2).normal(size=len(speed))
        best = fit_friction(FrictionTable(speed, law.steady(speed, load=load) + noise, load=load), sw.Gear())[0]
        assert best.name.endswith("over the load")
        (found,) = (each for each in best.fit.estimates if each.path.endswith("load_sensitivity"))
        low, high = found.interval(0.99)
        assert low < 2.0 < high
        assert found.sigma < 0.1


RUNS = np.repeat([2.0, 10.0, 40.0, -2.0, -10.0, -40.0], 50)
PLACES = np.random.default_rng(3).uniform(0.0, 300.0, len(RUNS))


def test_friction_over_the_turn_is_told_by_its_orders() -> None:
    law = sw.friction.Cyclic(
        law=sw.friction.Coulomb(coulomb=0.03, viscous=2e-4), order=[2, 4], amplitude=[0.2, 0.1], phase=[0.3, 1.0]
    )
    noise = 1e-3 * np.random.default_rng(4).normal(size=len(RUNS))
    best = fit_friction(FrictionTable(RUNS, law.steady(RUNS, angle=PLACES) + noise, angle=PLACES), sw.Gear())[0]
    assert best.name == "Coulomb and viscous, over the angle"
    assert (best.law.order, best.law.amplitude) == (pytest.approx([2, 4]), pytest.approx([0.2, 0.1], abs=0.02))


def test_what_no_order_describes_is_told_by_a_map() -> None:
    """Torques at twelve angles that differ from speed to speed."""
    level = np.random.default_rng(5).uniform(0.02, 0.05, 36)
    law = sw.friction.AngleSpeedMap(speed=[2.0, 10.0, 40.0], level=level.tolist())
    noise = 3e-4 * np.random.default_rng(6).normal(size=len(RUNS))
    best = fit_friction(FrictionTable(RUNS, law.steady(RUNS, angle=PLACES) + noise, angle=PLACES), sw.Gear())[0]
    assert best.name == "map over angle and speed"
    off = [(estimate.value - truth) / estimate.sigma for estimate, truth in zip(best.fit.estimates, level, strict=True)]
    assert np.mean(np.abs(off) <= 2.0) >= 0.9
    assert best.coulomb == pytest.approx(level[:12].mean(), rel=0.01)


@pytest.mark.slow("identification")
def test_rows_that_lie_far_off_are_named_and_left_out() -> None:
    truth = TRUTHS["with a fall at low speed"].steady(BOTH_WAYS)
    torque = truth + 5e-4 * np.random.default_rng(7).normal(size=len(truth))
    torque[[3, 25]] *= [3.0, -1.0]
    with pytest.warns(RuntimeWarning, match=r"2 of 40 rows .* left out: row 3, .*; row 25, .*Measure them again"):
        best = fit_friction(FrictionTable(BOTH_WAYS, torque), sw.Gear())[0]
    assert best.name == "with a fall at low speed"
    assert np.flatnonzero(~best.fit.training).tolist() == [3, 25]
    assert best.error == pytest.approx(5e-4, rel=0.3)
    for estimate, value in zip(best.fit.estimates, (0.03, 0.05, 3.0, 2e-4), strict=True):
        assert abs(estimate.value - value) < 3.0 * estimate.sigma


@pytest.mark.slow("identification")
def test_nothing_is_left_out_of_noise() -> None:
    truth = TRUTHS["curved viscous"].steady(BOTH_WAYS)
    for seed in range(3):
        torque = truth + 1e-3 * np.random.default_rng(seed).standard_t(5, size=len(truth))
        assert fit_friction(FrictionTable(BOTH_WAYS, torque), sw.Gear())[0].fit.training.all()


@pytest.mark.slow("identification")
def test_a_torque_without_any_noise_is_told_by_the_simplest_law() -> None:
    best = fit_friction(FrictionTable(BOTH_WAYS, 0.05 * np.sign(BOTH_WAYS)), sw.Gear())[0]
    assert (best.name, best.coulomb, best.viscous) == (
        "Coulomb and viscous",
        pytest.approx(0.05),
        pytest.approx(0.0, abs=1e-10),
    )
