"""Profiles, draws and minima: as the theory of linear models has them, and what refitting finds of others."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray
from scipy.signal import lfilter
from strainwave.identification.experiments.torsion_loop import TorsionLoop
from strainwave.identification.fitting.confidence import Minima, bootstrap, minima, profile

LAW = sw.friction.Coulomb(coulomb=0.03, breakaway=0.03, viscous=4e-4)
FREE = ["friction_input.coulomb", "friction_input.viscous"]
SPEED = np.linspace(1.0, 60.0, 40)
LONG_SPEED = np.linspace(1.0, 60.0, 800)
START = sw.Gear(friction_input=LAW)
FREE_OF_DRIVE = ["gear.stiffness.k", "load.inertia"]
TRUTH = (1.5e4, 0.5)


def table(seed: int, law: Any = LAW) -> sw.Recording:
    torque = law.steady(SPEED) + 1e-3 * np.random.default_rng(seed).normal(size=len(SPEED))
    return sw.Recording({"speed": SPEED, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})


@given(st.integers(0, 10**6), st.sampled_from(FREE), st.sampled_from([0.5, 0.9, 0.99]))
@settings(max_examples=10, deadline=None)
def test_of_a_linear_model_it_is_the_interval_of_the_estimate(seed: int, path: str, confidence: float) -> None:
    found = sw.fit(sw.Gear(friction_input=LAW), table(seed), FREE)
    estimate = found.estimates[FREE.index(path)]
    drawn = profile(found, path, confidence=confidence)
    width = 2.0 * estimate.sigma
    assert drawn.interval == pytest.approx(estimate.interval(confidence), abs=0.02 * width)
    distance = ((drawn.values - estimate.value) / estimate.sigma) ** 2
    assert drawn.cost == pytest.approx(distance, rel=0.01, abs=1e-6)
    assert not drawn.open_below
    assert not drawn.open_above


def test_a_prior_bounds_what_the_data_do_not() -> None:
    gear = sw.Gear(friction_input=LAW, damping=3.0)
    drawn = profile(sw.fit(gear, table(0), [*FREE, "damping"], priors={"damping": (3.0, 0.5)}), "damping")
    assert drawn.interval == pytest.approx((3.0 - 1.96 * 0.5, 3.0 + 1.96 * 0.5), abs=0.02)


def test_what_the_data_do_not_touch_is_open_to_both_sides() -> None:
    drawn = profile(sw.fit(sw.Gear(friction_input=LAW, damping=3.0), table(0), [*FREE, "damping"]), "damping")
    assert (drawn.open_below, drawn.open_above, drawn.interval) == (True, True, (0.0, np.inf))
    assert drawn.to_dict()["summary"] == "damping is not determined: the data bound it to neither side"


def test_a_slip_that_the_twist_never_reaches_is_open_above() -> None:
    """Of an element that has not slipped the breakaway is at least what it carried; how much more, nothing tells."""
    twist = np.concatenate((np.linspace(0.0, 1e-3, 60), np.linspace(1e-3, -1e-3, 120), np.linspace(-1e-3, 1e-3, 120)))
    truth = sw.Gear(
        stiffness=sw.stiffness.Linear(k=1e4), hysteresis=sw.hysteresis.MaxwellSlip(stiffness=[5e3], breakaway=[2.0])
    )
    torque = truth.trace(twist) + 0.05 * np.random.default_rng(0).normal(size=len(twist))
    loop = TorsionLoop(twist, torque, history="virgin", twist_zero=0.0)
    reached = profile(sw.fit(truth, loop, ["hysteresis.breakaway", "stiffness.k"]), "hysteresis.breakaway[0]")
    assert not reached.open_above
    assert reached.interval[0] < 2.0 < reached.interval[1]
    stuck = truth.replace(hysteresis=sw.hysteresis.MaxwellSlip(stiffness=[5e3], breakaway=[30.0]))
    torque = stuck.trace(twist) + 0.05 * np.random.default_rng(0).normal(size=len(twist))
    loop = TorsionLoop(twist, torque, history="virgin", twist_zero=0.0)
    never = profile(sw.fit(stuck, loop, ["hysteresis.breakaway", "stiffness.k"]), "hysteresis.breakaway[0]")
    assert never.open_above
    assert not never.open_below
    assert 4.0 < never.interval[0] < 11.0  # it carries up to 10 N.m along this path, without slip
    assert "the data do not determine how large it is" in never.to_dict()["summary"]


def test_an_unknown_that_the_fit_does_not_have_is_refused() -> None:
    found = sw.fit(sw.Gear(friction_input=LAW), table(0), FREE)
    with pytest.raises(ValueError, match=r'^the fit has no unknown "damping"; it has friction_input.coulomb, '):
        profile(found, "damping")


@pytest.mark.parametrize(
    "verb", [lambda x: sw.identification.profile(x, "damping"), sw.identification.bootstrap, sw.identification.combinations]
)
@pytest.mark.parametrize("other", [np.zeros(3), sw.Gear(), None], ids=["array", "gear", "nothing"])
def test_what_is_no_fit_is_refused(verb: Any, other: Any) -> None:
    with pytest.raises(TypeError, match=r"^found must be a Fit, which sw\.fit returns, not "):
        verb(other)


def noisy_table(noise: NDArray[np.float64]) -> sw.Recording:
    return sw.Recording({"speed": LONG_SPEED, "torque": LAW.steady(LONG_SPEED) + noise}, {"speed": "rad/s", "torque": "N.m"})


@pytest.mark.parametrize("by", [0.0, 0.8])
def test_draws_scatter_as_the_noise_says(by: float) -> None:
    """Exactly: W cov(e) W' with W the pseudo-inverse of the columns, cov(e) that of the autoregression."""
    noise = lfilter([1.0], [1.0, -by], np.random.default_rng(3).normal(size=2000))[-800:] * 1e-3
    drawn = bootstrap(sw.fit(START, noisy_table(noise), FREE), 100, seed=1)
    weights = np.linalg.pinv(np.column_stack((np.ones(800), LONG_SPEED)))
    lags = np.abs(np.subtract.outer(np.arange(800), np.arange(800)))
    exact = np.sqrt(np.diag(weights @ (1e-6 * by**lags / (1.0 - by**2)) @ weights.T))
    assert drawn.sigma == pytest.approx(exact, rel=0.35)
    low, high = drawn.interval(FREE[0])
    assert high - low == pytest.approx(3.92 * drawn.sigma[0], rel=0.25)
    assert drawn.failed == 0


def test_the_same_seed_draws_the_same_and_progress_is_told() -> None:
    told: list[tuple[str, float]] = []
    found = sw.fit(START, noisy_table(1e-3 * np.random.default_rng(0).normal(size=800)), FREE)
    one = bootstrap(found, 20, seed=5, progress=lambda stage, share: told.append((stage, share)))
    assert one == bootstrap(found, 20, seed=5)
    assert one != bootstrap(found, 20, seed=6)
    assert told[:-1] == [("drawing measurements anew", draw / 20) for draw in range(1, 21)]


def test_what_only_a_prior_tells_scatters_as_it_and_what_is_tied_follows() -> None:
    found = sw.fit(
        START.replace(damping=3.0), noisy_table(1e-3 * np.random.default_rng(0).normal(size=800)), [*FREE, "damping"],
        priors={"damping": (3.0, 0.1)}, ties={"friction_mesh.viscous": (FREE[1], 2.0)},
    )  # fmt: skip
    drawn = bootstrap(found, 100)
    columns = dict(zip(drawn.paths, drawn.values.T, strict=True))
    assert np.std(columns["damping"]) == pytest.approx(0.1, rel=0.25)
    assert columns["friction_mesh.viscous"] == pytest.approx(2.0 * columns[FREE[1]])


def test_draws_that_make_no_sense_are_refused() -> None:
    found = sw.fit(START, noisy_table(1e-3 * np.random.default_rng(0).normal(size=800)), FREE)
    with pytest.raises(ValueError, match=r"^draws = 3 must be 20 or more$"):
        bootstrap(found, 3)
    with pytest.raises(ValueError, match=r"^draws = 1000000000 must be 100000 or less$"):
        bootstrap(found, 10**9)
    with pytest.raises(ValueError, match=r'^there is no estimate of "damping"; there are friction_input.coulomb'):
        bootstrap(found, 20).interval("damping")


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
    return sw.fit(drive(*start), sw.Recording(columns, {name: run.unit(name) for name in columns}), FREE_OF_DRIVE)


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


def table_of(seed: int, law: sw.friction.Coulomb | sw.friction.Stribeck, noise: float) -> sw.Recording:
    speed = np.linspace(0.5, 60.0, 60)
    torque = law.steady(speed) + noise * np.random.default_rng(seed).normal(size=60)
    return sw.Recording({"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})


def of_table(law: sw.friction.Coulomb | sw.friction.Stribeck, noise: float, seed: int = 0) -> sw.identification.Fit:
    free = ["friction_input.coulomb", "friction_input.viscous"]
    return sw.fit(sw.Gear(friction_input=LAW), table_of(seed, law, noise), free)


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


def test_starts_that_make_no_sense_are_refused() -> None:
    found = of_table(LAW, 1e-3)
    with pytest.raises(ValueError, match="starts"):
        minima(found, 0)
    with pytest.raises(ValueError, match=r"^starts = 1000000000 must be 10000 or less$"):
        minima(found, 10**9)
    with pytest.raises(TypeError, match="must be a Fit"):
        minima(3)  # type: ignore[arg-type]
