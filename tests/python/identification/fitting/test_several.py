"""Several records in one fit, what each has for itself, and what is known before."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, settings, strategies as st
from numpy.typing import NDArray
from strainwave.files.entries import Entry, Quantity
from strainwave.identification.experiments.torsion_loop import TorsionLoop

from tests.support.samples import sample

LAW = sw.friction.Coulomb(coulomb=0.03, breakaway=0.03, viscous=4e-4)
COULOMB, VISCOUS = "friction_input.coulomb", "friction_input.viscous"
FREE = [COULOMB, VISCOUS]
SPEED = np.linspace(1.0, 60.0, 30)
START = sw.Gear(friction_input=LAW.replace(coulomb=0.1, viscous=1e-5))


def table(seed: int, law: Any = LAW, speed: NDArray[np.float64] = SPEED, noise: float = 1e-3) -> sw.Recording:
    torque = law.steady(speed) + noise * np.random.default_rng(seed).normal(size=len(speed))
    return sw.Recording({"speed": speed, "torque": torque}, {"speed": "rad/s", "torque": "N.m"})


def drive(load: float = 0.5, coulomb: float = 0.03, inertia: float = 1e-4) -> sw.Drive:
    return sw.Drive(
        gear=sw.Gear(
            kinematics=sw.kinematics.StrainWave(),
            stiffness=sw.stiffness.Linear(k=2e4),
            damping=5.0,
            friction_input=LAW.replace(coulomb=coulomb),
        ),
        motor=sw.motor.DC(resistance=0.5, inductance=5e-4, torque_constant=0.1, back_emf=0.1, inertia=inertia),
        load=sw.loads.Inertia(inertia=load),
    )


def log(load: float, seed: int = 0) -> sw.Recording:
    samples = np.linspace(0.0, 0.6, 301)
    command = sw.scenario.table(samples, 6.0 * np.sin(5.0 * np.pi * samples))
    run = sw.simulate(drive(load), command, sample=2e-3).select(["time", "command", "input_angle"])
    columns = {name: run[name] + 0.0 for name in run.names}
    columns["input_angle"] += 1e-3 * np.random.default_rng(seed).normal(size=len(run)) + seed
    return sw.Recording(columns, {name: run.unit(name) for name in run.names})


def values(found: sw.identification.Fit) -> dict[str, float]:
    return {each.path: each.value for each in found.estimates}


def sigmas(found: sw.identification.Fit) -> dict[str, float]:
    return {each.path: each.sigma for each in found.estimates}


def of_linear_algebra(*tables: sw.Recording) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    speed, torque = (np.concatenate([each[name] for each in tables]) for name in ("speed", "torque"))
    return np.column_stack((np.ones_like(speed), speed)), torque


@given(st.integers(0, 10**6), st.floats(0.2, 5.0))
@settings(max_examples=sample(8, 20), deadline=None)
def test_the_same_data_in_two_records_are_one_record_twice_as_long(seed: int, factor: float) -> None:
    once = table(seed, speed=np.linspace(1.0, 60.0, 200), noise=1e-3 * factor)
    longer = sw.Recording({name: np.tile(once[name], 2) for name in once.names}, {name: once.unit(name) for name in once.names})
    one, two = sw.fit(START, longer, FREE), sw.fit(START, [once, once], FREE)
    assert values(two) == pytest.approx(values(one), rel=1e-8)
    ratio = np.array(list(sigmas(two).values())) / list(sigmas(one).values())
    assert ratio == pytest.approx(np.ones(2), rel=0.25)  # what hangs together is told of each record by itself


@given(st.integers(0, 10**6))
@settings(max_examples=10, deadline=None)
def test_a_parameter_of_each_of_two_identical_records_is_the_same_twice(seed: int) -> None:
    found = sw.fit(START, {"cold": table(seed), "warm": table(seed)}, FREE, per_record=[VISCOUS])
    told = values(found)
    assert list(told) == [COULOMB, f"{VISCOUS} @ cold", f"{VISCOUS} @ warm"]
    assert told[f"{VISCOUS} @ cold"] == pytest.approx(told[f"{VISCOUS} @ warm"], rel=1e-7)
    assert told[COULOMB] == pytest.approx(values(sw.fit(START, table(seed), FREE))[COULOMB], rel=1e-6)


def test_what_each_record_has_for_itself_is_in_its_own_model() -> None:
    cold, warm = LAW.replace(viscous=9e-4), LAW
    found = sw.fit(START, [table(0, cold, noise=0.0), table(0, warm, noise=0.0)], FREE, per_record=[VISCOUS])
    assert [part.model.friction_input.viscous for part in found.parts] == pytest.approx([9e-4, 4e-4], rel=1e-6)
    assert found.model == found.parts[0].model
    assert [part.name for part in found.parts] == ["record 1", "record 2"]
    assert "rms of torque @ record 2" in str(found)
    with pytest.raises(ValueError, match="the fit is to 2 records; take it from one of its parts"):
        _ = found.predicted


@pytest.mark.slow("identification")
def test_two_loads_tell_the_inertia_of_the_motor_from_that_of_the_load() -> None:
    logs = {"light": log(0.2, 1), "heavy": log(1.0, 2)}
    free = ["gear.friction_input.coulomb", "motor.inertia", "load.inertia"]
    found = sw.fit(drive(0.5, 0.02, 2e-4), logs, free, per_record=["load.inertia"])
    told = {each.path: each for each in found.estimates}
    assert list(told)[2:4] == ["load.inertia @ light", "load.inertia @ heavy"]
    assert told["input_angle_zero @ light"].value == pytest.approx(1.0, abs=1e-3)
    truth = {"gear.friction_input.coulomb": 0.03}
    known = sw.fit(drive(0.5, 0.02, 2e-4), logs, free[:2], fixed={"load.inertia @ light": 0.2, "load.inertia @ heavy": 1.0})
    assert [part.model.load.inertia for part in known.parts] == [0.2, 1.0]
    truth["motor.inertia"] = 1e-4
    for each in known.estimates[:2]:
        assert abs(each.value - truth[each.path]) < 4.0 * each.sigma
        assert each.sigma < 0.02 * each.value


def test_a_table_and_a_loop_of_the_gear_are_fitted_beside_a_log_of_its_drive() -> None:
    twist = 1e-3 * np.sin(np.linspace(0.0, 2.0 * np.pi, 81))
    loop = TorsionLoop(twist, 2e4 * twist + 0.3, twist_zero=0.0)
    start = drive(0.4, 0.05).replace({"gear.stiffness.k": 1e4})
    free = ["gear.friction_input.coulomb", "gear.stiffness.k", "load.inertia"]
    found = sw.fit(start, [log(0.5), table(3), loop], free)
    told = {each.path: each for each in found.estimates}
    assert told["gear.stiffness.k"].value == pytest.approx(2e4, rel=1e-9)
    assert told["torque_zero @ record 3"].value == pytest.approx(0.3, rel=1e-9)
    assert abs(told["load.inertia"].value - 0.5) < 4.0 * told["load.inertia"].sigma
    assert told["gear.friction_input.coulomb"].sigma < 3e-4
    assert [part.experiment.channels for part in found.parts] == [("input_angle",), ("torque",), ("torque",)]


def test_a_prior_and_data_weigh_as_bayes_says() -> None:
    """Of a linear model with normal noise: Gelman et al., Bayesian Data Analysis (2013), section 14.8."""
    recording = table(4, speed=np.linspace(1.0, 60.0, 2000))
    prior = {COULOMB: (0.0301, 3e-5), VISCOUS: (3.9e-4, 1e-6)}
    found = sw.fit(START, recording, FREE, priors=prior)
    columns, torque = of_linear_algebra(recording)
    precision = columns.T @ columns / 1e-6 + np.diag([1.0 / sigma**2 for _, sigma in prior.values()])
    covariance = np.linalg.inv(precision)
    mean = covariance @ (columns.T @ torque / 1e-6 + [value / sigma**2 for value, sigma in prior.values()])
    assert np.abs(np.array([e.value for e in found.estimates]) - mean) / np.sqrt(np.diag(covariance)) == pytest.approx(
        0.0, abs=0.1
    )
    assert np.sqrt(np.diag(found.covariance)) == pytest.approx(np.sqrt(np.diag(covariance)), rel=0.1)


@given(st.integers(0, 10**6), st.floats(0.02, 0.04))
@settings(max_examples=sample(8, 20), deadline=None)
def test_a_prior_without_doubt_is_a_fixed_value(seed: int, value: float) -> None:
    sure = sw.fit(START, table(seed), FREE, priors={COULOMB: (value, 1e-9)})
    fixed = sw.fit(START, table(seed), [VISCOUS], fixed={COULOMB: value})
    assert values(sure)[COULOMB] == pytest.approx(value, rel=1e-6)
    assert values(sure)[VISCOUS] == pytest.approx(values(fixed)[VISCOUS], rel=1e-4)
    assert fixed.gear.friction_input.coulomb == value


def test_a_parameter_that_only_a_prior_tells_is_as_sure_as_the_prior() -> None:
    found = sw.fit(START, table(0), [*FREE, "damping"], priors={"damping": (3.0, 0.5)})
    damping = found.estimates[0]
    assert (damping.path, damping.value, damping.sigma) == ("damping", pytest.approx(3.0), pytest.approx(0.5))
    low, high = damping.interval(0.95)
    assert high - low == pytest.approx(2.0 * 1.959964 * 0.5, rel=1e-3)  # normally distributed, though the samples are few


def test_a_prior_may_come_from_a_catalogue() -> None:
    start = START.replace(damping=2.0)
    relative = sw.fit(start, table(0), [VISCOUS, "damping", COULOMB], priors={"damping": Entry("catalogue", spread=0.3)})
    assert relative.estimates[0].sigma == pytest.approx(0.3 * start.damping)
    quantity = Quantity(value=4.0, unit="N.m.s/rad", source="rig", uncertainty=0.1)
    assert sw.fit(start, table(0), [VISCOUS, "damping"], priors={"damping": quantity}).estimates[0].value == pytest.approx(4.0)


@given(st.integers(0, 10**6), st.floats(0.5, 3.0))
@settings(max_examples=sample(8, 20), deadline=None)
def test_a_tied_parameter_follows_by_its_factor(seed: int, factor: float) -> None:
    """Breakaway is of no concern for steady sliding: the free one is found as without it."""
    tied = sw.fit(START, table(seed), FREE, ties={"friction_mesh.viscous": (VISCOUS, factor)})
    told = values(tied)
    assert told["friction_mesh.viscous"] == pytest.approx(factor * told[VISCOUS], rel=1e-12)
    assert tied.gear.friction_mesh.viscous == pytest.approx(factor * tied.gear.friction_input.viscous, rel=1e-12)
    assert sigmas(tied)["friction_mesh.viscous"] == pytest.approx(factor * sigmas(tied)[VISCOUS], rel=1e-12)
    assert tied.correlation[1, 2] == pytest.approx(1.0)


def test_the_derivative_of_a_tied_parameter_counts() -> None:
    """Both springs of a loop follow one number: half of it each."""
    twist = 1e-3 * np.sin(np.linspace(0.0, 2.0 * np.pi, 81))
    spring = sw.stiffness.ThreeSegment(k1=3e4, k2=6e4, k3=9e4, t1=5.0, t2=20.0)
    loop = sw.Recording({"twist": twist, "torque": spring.torque(twist)}, {"twist": "rad", "torque": "N.m"})
    start = sw.Gear(stiffness=spring.replace(k1=2e4))
    found = sw.fit(
        start, loop, ["stiffness.k1"], ties={"stiffness.k2": ("stiffness.k1", 2.0), "stiffness.k3": ("stiffness.k1", 3.0)}
    )
    assert found.gear.stiffness == spring.replace(
        k1=found.gear.stiffness.k1, k2=found.gear.stiffness.k2, k3=found.gear.stiffness.k3
    )
    assert [getattr(found.gear.stiffness, name) for name in ("k1", "k2", "k3")] == pytest.approx([3e4, 6e4, 9e4], rel=1e-9)


def test_a_bound_stops_a_parameter_and_a_start_out_of_it_is_moved() -> None:
    with pytest.warns(
        RuntimeWarning, match=r"^friction_input.coulomb starts at 0.05 N.m: its value 0.1 N.m lies out of its bounds$"
    ):
        found = sw.fit(START, table(0), FREE, bounds={COULOMB: (0.04, 0.05)})
    assert found.estimates[0].at_limit
    assert found.estimates[0].value == pytest.approx(0.04)
    assert found.estimates[0].start == 0.1


def test_each_record_has_its_own_samples_held_out() -> None:
    spoilt = table(1, noise=0.0).with_column("torque", np.where(SPEED > 30.0, 5.0, LAW.steady(SPEED)), "N.m")
    for training in ([None, SPEED <= 30.0], {"b": SPEED <= 30.0}):
        found = sw.fit(START, {"a": table(0, noise=0.0), "b": spoilt}, FREE, training=training)
        assert found.gear.friction_input.coulomb == pytest.approx(LAW.coulomb, rel=1e-8)
        assert np.isnan(found.parts[0].rms(held_out=True)[0])
        assert found.parts[1].rms(held_out=True)[0] > 1.0


@pytest.mark.parametrize(
    ("given", "error", "message"),
    [
        ({"recordings": []}, ValueError, r"^recordings is empty; give at least one$"),
        ({"recordings": [table(0), 3]}, TypeError, r"^recordings must be Recordings, or experiments made of them, not 3$"),
        ({"training": [None]}, ValueError, r"^training must be a list with one mask or None for each of the 2 records$"),
        ({"training": {"c": None}}, ValueError, r'^training names record "c"; the records are a, b$'),
        ({"training": [None, np.zeros(30, bool)]}, ValueError, r"^training leaves no sample of b; leave the record out$"),
        ({"per_record": ["damping"]}, ValueError, r"^per_record names damping, which is not free; name it in free too$"),
        ({"per_record": ["dampin"]}, ValueError, r'^the model has no parameter "dampin"; near it are damping'),
        (
            {"fixed": {COULOMB: 0.03}},
            ValueError,
            r"^friction_input.coulomb is both free and fixed; take it out of one of the two$",
        ),
        ({"fixed": {"damping": -3.0}}, ValueError, r'^fixed\["damping"\] = -3.0 N.m.s/rad must lie in \[0, '),
        ({"fixed": {"damping @ c": 3.0}}, ValueError, r'^fixed names record "c"; the records are a, b$'),
        ({"fixed": [3.0]}, TypeError, r"^fixed must be a mapping, as in "),
        (
            {"ties": {COULOMB: VISCOUS}},
            ValueError,
            r"^friction_input.coulomb is both free and tied to friction_input.viscous; ",
        ),
        (
            {"ties": {"damping": "input_inertia"}},
            ValueError,
            r"^damping is tied to input_inertia, which is not free; free it, or ",
        ),
        (
            {"ties": {"damping": (COULOMB, 0.0)}},
            ValueError,
            r'^the factor of ties\["damping"\] is 0; to make damping zero, name ',
        ),
        (
            {"ties": {"damping": 3.0}},
            TypeError,
            r'^ties\["damping"\] must be a path, or a path and a factor as \(path, 2.0\), not',
        ),
        ({"ties": {"damping": (COULOMB, -1.0)}}, ValueError, r'^ties\["damping"\] leaves friction_input.coulomb no value: it '),
        (
            {"bounds": {"damping": (0.0, 1.0)}},
            ValueError,
            r"^bounds names damping, which is not free; name it in free, or leave ",
        ),
        (
            {"bounds": {COULOMB: (2.0, 1.0)}},
            ValueError,
            r'^bounds\["friction_input.coulomb"\] = \(2, 1\) must have the lower end',
        ),
        (
            {"bounds": {COULOMB: (-2.0, -1.0)}},
            ValueError,
            r'^bounds\["friction_input.coulomb"\] leaves friction_input.coulomb no ',
        ),
        (
            {"bounds": {COULOMB: 3.0}},
            TypeError,
            r'^bounds\["friction_input.coulomb"\] must be two numbers, as \(low, high\), not 3',
        ),
        (
            {"bounds": {f"{COULOMB} @ a": (0, 1)}},
            ValueError,
            r'^bounds names friction_input.coulomb of record "a", but all share ',
        ),
        (
            {"priors": {COULOMB: (0.03, 0.0)}},
            ValueError,
            r'^the sigma of priors\["friction_input.coulomb"\] = 0.0 N.m must lie ',
        ),
        ({"priors": {COULOMB: (0.03, "1 N.m")}}, TypeError, r"^the sigma of priors.* must be a number, not '1 N.m'$"),
        ({"priors": {COULOMB: 0.03}}, TypeError, r'^priors\["friction_input.coulomb"\] must be \(value, sigma\), or an Entry '),
        (
            {"priors": {COULOMB: Entry("guess")}},
            ValueError,
            r"its source has neither uncertainty, nor spread of a value that is not 0; give ",
        ),
        (
            {"priors": {"damping": (1.0, 1.0)}},
            ValueError,
            r"^priors names damping, which is not free; name it in free, or leave",
        ),
    ],
)
def test_what_makes_no_sense_is_refused(given: dict[str, Any], error: type[Exception], message: str) -> None:
    arguments: dict[str, Any] = {"model": START, "recordings": {"a": table(0), "b": table(1)}, "free": FREE}
    with pytest.raises(error, match=message):
        sw.fit(**arguments | given)
