"""Change of estimates with what was kept, and sums, products and ratios that the data determine."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import strainwave as sw
from strainwave.files.entries import Entry
from strainwave.identification.experiments.torsion_loop import TorsionLoop
from strainwave.identification.fitting.fit import fit
from strainwave.identification.fitting.influence import InfluenceOfKept, combinations, influence, uncertainty
from strainwave.parameters import Parameter

ELEMENTS = sw.hysteresis.MaxwellSlip(stiffness=[8e3, 4e3], breakaway=[0.8, 1.2])
GEAR = sw.Gear(stiffness=sw.stiffness.Cubic(a1=1.5e4, a3=6e9), hysteresis=ELEMENTS)
FREE = ["stiffness.a1", "stiffness.a3"]
SPEED = np.linspace(1.0, 60.0, 100)
LAW = sw.friction.Coulomb(coulomb=0.03, breakaway=0.03, viscous=4e-4)


def loop() -> TorsionLoop:
    quarter = np.linspace(0.0, 1.5e-3, 100)
    twist = np.concatenate((quarter[::-1], -quarter[1:], -quarter[-2::-1], quarter[1:]))
    torque = GEAR.trace(np.concatenate((twist, twist)))[-len(twist) :]
    return TorsionLoop(twist, torque + 0.05 * np.random.default_rng(0).normal(size=len(twist)))


def kept(breakaway: float) -> sw.Gear:
    return GEAR.replace(hysteresis=ELEMENTS.replace(breakaway=[0.8, breakaway]))


def test_estimates_move_as_a_fit_with_another_kept_value_finds() -> None:
    step = 0.01
    found = influence(fit(kept(1.2), loop(), FREE))
    place = [each.path for each in found.kept].index("hysteresis.breakaway[1]")
    ends = [[e.value for e in fit(kept(1.2 + sign * step), loop(), FREE).estimates] for sign in (-1.0, 1.0)]
    slope = (np.array(ends[1]) - np.array(ends[0])) / (2.0 * step)
    assert found.slopes[:, place] == pytest.approx(slope, rel=0.02, abs=1e-3 * np.abs(slope).max())


def test_a_wrong_kept_value_is_pulled_to_the_true_one() -> None:
    found = influence(fit(kept(1.6), loop(), FREE))
    place = [each.path for each in found.kept].index("hysteresis.breakaway[1]")
    assert 1.6 + found.shift_if_free[place] == pytest.approx(1.2, abs=0.1)
    assert found.explained_share[place] > 0.8
    assert place in found.suspects({"hysteresis.breakaway[1]": Entry("guessed", uncertainty=0.1)})
    assert found.suspects({each.path: Entry("guessed", spread=1.0) for each in found.kept}) == []


def test_only_a_value_that_a_parameter_may_have_is_suspected_least_certain_first() -> None:
    kept = tuple(
        Parameter(n, name, "kg.m2", 1.0, 0.0, np.inf) for n, name in enumerate(("impossible", "sure", "unsure", "idle"))
    )
    found = InfluenceOfKept(
        kept, np.ones((1, 4)), np.ones(4), np.array([-1.5, -0.5, -0.6, -0.5]), np.array([0.9, 0.7, 0.6, 0.4])
    )
    known = {
        name: Entry("measured", uncertainty=sigma) for name, sigma in {"impossible": 0.1, "sure": 0.01, "unsure": 0.3}.items()
    }
    assert [kept[place].path for place in found.suspects(known)] == ["unsure", "sure"]


def test_right_kept_values_are_suspected_of_nothing() -> None:
    found = influence(fit(kept(1.2), loop(), FREE))
    assert found.suspects({}) == []
    assert InfluenceOfKept.none(2).suspects({}) == []
    assert InfluenceOfKept.none(2).shifts(0, {}) == {}


def test_the_measurement_bounds_the_shift_by_a_kept_parameter() -> None:
    found = influence(fit(kept(1.2), loop(), FREE))
    place = [each.path for each in found.kept].index("hysteresis.breakaway[1]")
    loose = found.shifts(0, {"hysteresis.breakaway[1]": Entry("guessed", uncertainty=1e6)})["hysteresis.breakaway[1]"]
    assert loose == pytest.approx(abs(found.slopes[0, place]) * found.bounds[place], rel=1e-6)
    exact = found.shifts(0, {"hysteresis.breakaway[1]": Entry("measured", uncertainty=0.0)})["hysteresis.breakaway[1]"]
    assert exact == 0.0


def test_a_kept_value_without_uncertainty_is_known_to_10_percent_and_an_assumed_one_to_50() -> None:
    assert uncertainty(-5.0, None) == uncertainty(-5.0, Entry("somebody")) == 0.5
    assert uncertainty(-5.0, Entry("assumed: a guess")) == 2.5
    assert uncertainty(5.0, Entry("catalogue", spread=0.3, uncertainty=2.0)) == pytest.approx(2.5)


class FileEstimate:
    """An experiment on a gear that tells a formula of its damping a, its input inertia b and its viscous friction c only."""

    channels, units, nuisances = ("torque",), ("N.m",), ()
    places = ("damping", "input_inertia", "friction_input.viscous")

    def __init__(self, formula: Any, noise: float = 1e-4) -> None:
        self.formula = formula
        model = gear()
        self.measured = self._of(model)[np.newaxis] + noise * np.random.default_rng(0).normal(size=len(SPEED))

    def _of(self, model: sw.Gear, **moved: float) -> Any:
        values = [model.damping, model.input_inertia, model.friction_input.viscous]
        return self.formula(*values) * SPEED / 60.0

    def predict(self, model: sw.Gear, numbers: Any, nuisances: Any) -> Any:
        from strainwave import _core

        described = _core.parameters(model)
        slopes = []
        for number in numbers:
            values = [each[1] for each in described]
            step = 1e-6 * values[number]
            up, down = (
                self._of(_core.with_numbers(model, [*values[:number], values[number] + sense * step, *values[number + 1 :]]))
                for sense in (1.0, -1.0)
            )
            slopes.append((up - down) / (2.0 * step))
        return self._of(model)[np.newaxis], np.array(slopes)[:, np.newaxis]


def gear() -> sw.Gear:
    return sw.Gear(damping=2.0, input_inertia=4.0, friction_input=sw.friction.Viscous(viscous=0.5))


@pytest.mark.parametrize(
    ("formula", "free", "words", "value"),
    [
        (lambda a, b, c: a + 0.25 * c, ["damping", FileEstimate.places[2]], f"damping + 0.25 {FileEstimate.places[2]}", 2.125),
        (lambda a, b, c: a - c, ["damping", FileEstimate.places[2]], f"damping - {FileEstimate.places[2]}", 1.5),
        (lambda a, b, c: a * b, ["damping", "input_inertia"], "damping * input_inertia", 8.0),
        (lambda a, b, c: a / b**2, ["damping", "input_inertia"], "damping / input_inertia^2", 2.0 / 16.0),
        (lambda a, b, c: a / c, ["damping", FileEstimate.places[2]], f"damping / {FileEstimate.places[2]}", 4.0),
    ],
)
def test_a_formula_of_two_parameters_is_written_out(formula: Any, free: list[str], words: str, value: float) -> None:
    found = combinations(fit(gear(), FileEstimate(formula), free))
    assert len(found) == 1
    turned = " / ".join(reversed(words.split(" / ")))
    assert found[0].formula in (words, turned, " * ".join(reversed(words.split(" * "))), "input_inertia / damping^0.5")
    if found[0].formula == words:
        assert found[0].value == pytest.approx(value, rel=1e-3)
        slope = SPEED / 60.0
        exact = 1e-4 / np.sqrt(np.sum(slope**2))  # of the factor of a line through zero
        assert found[0].sigma == pytest.approx(exact, rel=0.35)
    assert found[0].relative > 100.0  # a change of a hundred times its size tells nothing
    assert str(found[0]).startswith("of ")


def test_three_parameters_are_described_by_their_common_change() -> None:
    found = combinations(fit(gear(), FileEstimate(lambda a, b, c: a * b * c), list(FileEstimate.places)))
    assert len(found) == 2  # of three relative changes one is determined
    for each in found:
        assert abs(sum(each.open)) < 5e-3  # the product stays
    assert str(found[0]).startswith("3 parameters are determined only together: the prediction hardly changes with ")


def test_a_determined_parameter_is_no_combination() -> None:
    torque = LAW.steady(SPEED) + 1e-5 * np.random.default_rng(0).normal(size=len(SPEED))
    table = sw.Recording({"speed": SPEED, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})
    free = ["friction_input.coulomb", "friction_input.viscous"]
    assert combinations(fit(sw.Gear(friction_input=LAW), table, free)) == ()


def test_one_load_determines_only_the_sum_of_the_inertias() -> None:
    """A stiff drive whose input alone is watched: the load counts there by the square of the ratio."""
    drive = sw.Drive(
        gear=sw.Gear(
            kinematics=sw.kinematics.StrainWave(), stiffness=sw.stiffness.Linear(k=2e5), damping=50.0, friction_input=LAW
        ),
        motor=sw.motor.DC(resistance=0.5, inductance=5e-4, torque_constant=0.1, back_emf=0.1, inertia=1e-4),
        load=sw.loads.Inertia(inertia=1.0),
    )
    samples = np.linspace(0.0, 0.6, 301)
    run = sw.simulate(drive, sw.scenario.table(samples, 6.0 * np.sin(5.0 * np.pi * samples)), sample=2e-3)
    log = run.select(["time", "command", "input_angle"])
    log = log.with_column("input_angle", log["input_angle"] + 1e-2 * np.random.default_rng(0).normal(size=len(log)), "rad")
    ratio = drive.gear.kinematics.ratio
    found = combinations(sw.fit(drive, log, ["motor.inertia", "load.inertia"]))
    assert len(found) == 1
    assert set(found[0].paths) == {"motor.inertia", "load.inertia"}
    first, plus, factor, second = found[0].formula.split()
    assert (first, plus, second) == ("motor.inertia", "+", "load.inertia")
    assert float(factor) == pytest.approx(1.0 / ratio**2, rel=0.2)
    assert abs(found[0].value - (1e-4 + float(factor))) < 4.0 * found[0].sigma + 0.02 * found[0].value
    assert found[0].sigma < 0.02 * found[0].value
