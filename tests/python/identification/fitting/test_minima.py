"""Minima: of a drive that all but sticks there are several, of a linear model one; and what a fit doubts by itself."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
import strainwave as sw
from strainwave.identification.fitting.minima import Minima, minima

LAW = sw.friction.Coulomb(coulomb=0.03, breakaway=0.03, viscous=4e-4)
FREE = ["gear.stiffness.k", "load.inertia"]
TRUTH = (1.5e4, 0.5)


def drive(stiffness: float, inertia: float) -> sw.Drive:
    return sw.Drive(
        gear=sw.Gear(
            kinematics=sw.kinematics.StrainWave(),
            stiffness=sw.stiffness.Linear(k=stiffness),
            damping=5.0,
            friction_input=LAW,
        ),
        motor=sw.motor.DC(resistance=0.5, inductance=5e-4, torque_constant=0.1, back_emf=0.1, inertia=1e-4),
        load=sw.loads.Inertia(inertia=inertia),
    )


@cache
def fitted(volts: float, seed: int, start: tuple[float, float], *channels: str) -> sw.identification.Fit:
    """To a log of a drive whose torque is hardly more than its friction, 0.15 V, with one percent noise."""
    time = np.linspace(0.0, 1.0, 501)
    run = sw.simulate(drive(*TRUTH), sw.scenario.table(time, volts * np.sin(3.0 * np.pi * time)), sample=2e-3)
    random = np.random.default_rng(seed)
    columns = {"time": run.time, "command": run["command"]}
    columns |= {name: run[name] + 0.01 * np.ptp(run[name]) * random.normal(size=len(run.time)) for name in channels}
    return sw.fit(drive(*start), sw.Recording(columns, {name: run.unit(name) for name in columns}), FREE)


def off(found: sw.identification.Fit) -> float:
    return max(abs(each.value - truth) / each.sigma for each, truth in zip(found.estimates, TRUTH, strict=False))


@pytest.mark.slow("identification")
@pytest.mark.parametrize(("volts", "seed"), [(0.16, 3), (0.2, 3), (0.2, 7)])
def test_a_fit_that_ended_at_the_wrong_minimum_is_led_to_the_truth(volts: float, seed: int) -> None:
    found = fitted(volts, seed, (1.95e4, 0.375), "input_angle", "output_angle")
    assert off(found) > 7.0
    told = minima(found)
    assert told.lower
    assert off(told.best) < 3.0
    assert "it had ended at a minimum that explains less" in " ".join(told.to_dict()["remarks"])
    assert told.ends[0].values["gear.stiffness.k"] == pytest.approx(TRUTH[0], rel=0.1)


@pytest.mark.slow("identification")
def test_another_minimum_that_explains_as_much_is_named() -> None:
    told = minima(fitted(0.2, 3, (1.95e4, 0.375), "input_speed", "current"))
    (rival,) = told.rivals
    assert rival.values["gear.stiffness.k"] > 1.4 * TRUTH[0]
    assert "the data do not separate the two" in " ".join(told.to_dict()["remarks"])


@pytest.mark.slow("identification")
def test_a_drive_that_moves_has_one_minimum() -> None:
    found = fitted(6.0, 3, (1.95e4, 0.375), "input_speed", "output_angle")
    told = minima(found)
    assert not told.lower
    assert not told.rivals
    assert told.best is found
    assert off(found) < 3.0


def table(seed: int, law: sw.friction.Coulomb | sw.friction.Stribeck, noise: float) -> sw.Recording:
    speed = np.linspace(0.5, 60.0, 60)
    torque = law.steady(speed) + noise * np.random.default_rng(seed).normal(size=60)
    return sw.Recording({"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})


def of_table(law: sw.friction.Coulomb | sw.friction.Stribeck, noise: float, seed: int = 0) -> sw.identification.Fit:
    free = ["friction_input.coulomb", "friction_input.viscous"]
    return sw.fit(sw.Gear(friction_input=LAW), table(seed, law, noise), free)


@pytest.mark.parametrize("seed", range(5))
def test_of_a_linear_model_all_starts_end_at_one_place(seed: int) -> None:
    told: Minima = minima(of_table(LAW, 1e-3, seed), 5, seed=seed)
    (end,) = told.ends
    assert (end.starts, told.lower) == (6, False)


def test_what_shows_no_fault_is_not_doubted() -> None:
    assert sum(bool(of_table(LAW, 1e-3, seed).doubts) for seed in range(50)) <= 2


def test_residuals_that_hang_together_are_doubted() -> None:
    falling = sw.friction.Stribeck(coulomb=0.03, breakaway=0.06, stribeck_speed=8.0, viscous=4e-4)
    found = of_table(falling, 2e-4)
    doubt = found.doubts[-1]
    assert doubt.startswith("the residuals of torque correlate over")
    assert doubt in found.to_dict()["remarks"]


def test_what_is_known_loosely_is_doubted() -> None:
    found = of_table(LAW, 0.03)
    doubt, *_ = found.doubts
    assert doubt.startswith("friction_input.coulomb is known to")
    assert 'sw.identification.profile(fit, "friction_input.coulomb") gives it' in doubt


def test_what_makes_no_sense_is_refused() -> None:
    found = of_table(LAW, 1e-3)
    with pytest.raises(ValueError, match="starts"):
        minima(found, 0)
    with pytest.raises(ValueError, match=r"^starts = 1000000000 must be 10000 or less$"):
        minima(found, 10**9)
    with pytest.raises(TypeError, match="must be a Fit"):
        minima(3)  # type: ignore[arg-type]
