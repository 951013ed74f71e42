"""Least squares with exact derivatives: the truth comes back, and the uncertainty is what it says."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from strainwave.identification.experiments.torsion_loop import TorsionLoop
from strainwave.identification.fitting.fit import fit
from strainwave.parameters import every

SPEED = np.linspace(-60.0, 60.0, 41)[np.arange(41) != 20]
LAW = sw.friction.Coulomb(coulomb=0.03, breakaway=0.03, viscous=4e-4)
FREE = ["friction_input.coulomb", "friction_input.viscous"]


def friction_table(noise: NDArray[np.float64] | float = 0.0) -> sw.Recording:
    return sw.Recording({"speed": SPEED, "torque": LAW.steady(SPEED) + noise}, {"speed": "rad/s", "torque": "N.m"})


def gear(**changes: object) -> sw.Gear:
    return sw.Gear(friction_input=LAW.replace(coulomb=0.1, viscous=1e-5)).replace(**changes)


def drive(**changes: float) -> sw.Drive:
    return sw.Drive(
        gear=sw.Gear(
            kinematics=sw.kinematics.StrainWave(),
            stiffness=sw.stiffness.Cubic(a1=changes.get("a1", 1.5e4), a3=1e9),
            damping=5.0,
            friction_input=LAW.replace(
                coulomb=changes.get("coulomb", LAW.coulomb), viscous=changes.get("viscous", LAW.viscous)
            ),
        ),
        motor=sw.motor.DC(resistance=0.5, inductance=5e-4, torque_constant=0.1, back_emf=0.1, inertia=1e-4),
        load=sw.loads.Inertia(inertia=0.5),
    )


def drive_log(noise: float = 0.0, seed: int = 0) -> sw.Recording:
    samples = np.linspace(0.0, 1.0, 501)  # straight lines between samples, as a log has its command
    command = sw.scenario.table(samples, 6.0 * np.sin(3.0 * np.pi * samples))
    run = sw.simulate(drive(), command, sample=2e-3).select(["time", "command", "input_angle", "output_angle"])
    random = np.random.default_rng(seed)
    columns = {name: run[name] + 0.0 for name in run.names}
    columns["input_angle"] += noise * random.normal(size=len(run)) + 0.3
    columns["output_angle"] += 1e-2 * noise * random.normal(size=len(run)) - 1.0
    return sw.Recording(columns, {name: run.unit(name) for name in run.names})


def test_a_table_without_noise_gives_the_law_back() -> None:
    found = fit(gear(), friction_table(), FREE)
    assert found.gear.friction_input.coulomb == pytest.approx(LAW.coulomb, rel=1e-9)
    assert found.gear.friction_input.viscous == pytest.approx(LAW.viscous, rel=1e-9)


def test_least_squares_agrees_with_the_linear_algebra_of_the_same_problem() -> None:
    noise = 1e-3 * np.random.default_rng(1).normal(size=len(SPEED))
    found = fit(gear(), friction_table(noise), FREE)
    columns = np.column_stack((np.sign(SPEED), SPEED))
    exact = np.linalg.lstsq(columns, LAW.steady(SPEED) + noise, rcond=None)[0]
    assert [e.value for e in found.estimates] == pytest.approx(exact, rel=1e-8)


@pytest.mark.slow("identification")
def test_one_sigma_covers_two_thirds_and_three_sigma_nearly_all() -> None:
    distances = []
    for seed in range(200):
        noise = 1e-3 * np.random.default_rng(seed).normal(size=len(SPEED))
        found = fit(gear(), friction_table(noise), FREE)
        distances += [abs(e.value - truth) / e.sigma for e, truth in zip(found.estimates, (0.03, 4e-4), strict=True)]
    assert 0.62 < np.mean(np.array(distances) < 1.0) < 0.80  # a normal law has 0.68, correlation lengths above 1 add a little
    assert np.mean(np.array(distances) < 3.0) > 0.985


def test_a_drive_log_gives_friction_and_stiffness_back_whatever_the_zeros_of_its_encoders() -> None:
    start = drive(a1=1.2e4, coulomb=0.02, viscous=1e-4)
    found = sw.fit(start, drive_log(), ["gear.friction_input.coulomb", "gear.friction_input.viscous", "gear.stiffness.a1"])
    values = {e.path: e.value for e in found.estimates}
    assert values["gear.friction_input.coulomb"] == pytest.approx(0.03, rel=1e-6)
    assert values["gear.friction_input.viscous"] == pytest.approx(4e-4, rel=1e-6)
    assert values["gear.stiffness.a1"] == pytest.approx(1.5e4, rel=1e-6)
    assert values["input_angle_zero"] == pytest.approx(0.3, abs=1e-9)
    assert values["output_angle_zero"] == pytest.approx(-1.0, abs=1e-9)


DENSITIES = {
    "power": (sw.hysteresis.PowerDensity(limit=1e-3, saturation=6.0, exponent=3.0), ["limit", "saturation", "exponent"]),
    "grid": (sw.hysteresis.GridDensity(limit=1e-3, weight=[0.5, 1.0, 1.5]), ["weight"]),
}


def scattered(density: Any, free: list[str]) -> Any:
    """The density with other numbers where it is free."""
    return density.replace(**{name: (np.array(getattr(density, name)) * 1.2).tolist() for name in free})


@pytest.mark.parametrize(("density", "free"), DENSITIES.values(), ids=DENSITIES)
def test_a_density_within_preisachs_law_comes_back_from_a_loop(density: Any, free: list[str]) -> None:
    twist = 7e-4 * np.sin(np.linspace(0.0, 2.0 * np.pi, 161)) + 1e-4
    truth = sw.Gear(stiffness=sw.stiffness.Cubic(a1=1e4, a3=1e9), hysteresis=sw.hysteresis.Preisach(density=density))
    loop = TorsionLoop(twist + 2e-4, truth.trace(np.tile(twist, 2))[-len(twist) :] - 1.0)
    start = truth.replace(hysteresis=sw.hysteresis.Preisach(density=scattered(density, free)))
    found = sw.fit(start, loop, [f"hysteresis.density.{name}" for name in free])
    for name in free:
        assert getattr(found.gear.hysteresis.density, name) == pytest.approx(getattr(density, name), rel=1e-6)
    assert [e.value for e in found.estimates[-2:]] == pytest.approx([-1.0, 2e-4], rel=1e-6)


@pytest.mark.parametrize(("density", "free"), DENSITIES.values(), ids=DENSITIES)
def test_a_density_within_preisachs_law_comes_back_from_a_log(density: Any, free: list[str]) -> None:
    def with_density(changed: Any) -> sw.Drive:
        return drive().replace(gear=drive().gear.replace(hysteresis=sw.hysteresis.Preisach(density=changed)))

    samples = np.linspace(0.0, 0.3, 301)
    command = sw.scenario.table(samples, 24.0 * np.sin(20.0 * np.pi * samples))
    run = sw.simulate(with_density(density), command, sample=1e-3).select(["time", "command", "input_angle", "output_angle"])
    found = sw.fit(with_density(scattered(density, free)), run, [f"gear.hysteresis.density.{name}" for name in free])
    for name in free:
        assert getattr(found.gear.hysteresis.density, name) == pytest.approx(getattr(density, name), rel=1e-5)


def actuator(**changes: float) -> sw.Drive:
    """Document A's actuator, whose stages need steps of 37 us, measured without noise; with other numbers at paths."""
    seen = sw.load("tilt-actuator").sensors
    without_noise = seen.replace(current=seen.current.law, input_speed=seen.input_speed.law, output_angle=seen.output_angle.law)
    return sw.load("tilt-actuator").replace({"sensors": without_noise} | changes)


def actuator_log() -> sw.Recording:
    """A ramp with jerks of 0.4 ms, recorded every 0.04 ms, with noise; integrated adaptively."""
    time = np.linspace(0.0, 0.05, 1251)
    jerk = (np.abs(time - 0.02023) < 2e-4) | (np.abs(time - 0.03531) < 2e-4)
    run = sw.simulate_adaptively(actuator(), sw.scenario.table(time, 0.3 * time + 4e-3 * jerk), rtol=1e-9, sample=4e-5)
    run = run.select(["time", "command", *ACTUATOR_NOISE])
    random = np.random.default_rng(0)
    columns = {name: run[name] + ACTUATOR_NOISE.get(name, 0.0) * random.normal(size=len(run)) for name in run.names}
    return sw.Recording(columns, {name: run.unit(name) for name in run.names})


ACTUATOR_NOISE = {"input_angle": 1e-5, "output_angle": 1e-6, "torque": 5e-3}  # rad, rad, N.m


@pytest.mark.slow("identification")
def test_jerks_as_short_as_two_usual_steps_tell_spring_and_load_of_a_drive_with_fast_stages() -> None:
    truth = {"gear.stiffness.k": 2e4, "load.inertia": 0.6}
    found = sw.fit(actuator(**{path: 1.1 * value for path, value in truth.items()}), actuator_log(), list(truth))
    assert found.rms() == pytest.approx(list(ACTUATOR_NOISE.values()), rel=0.1)
    for estimate in found.estimates[:2]:
        low, high = estimate.interval(0.95)
        assert low < truth[estimate.path] < high
        assert high - low < 0.05 * truth[estimate.path]


@pytest.mark.slow("identification")
def test_a_drive_that_turns_out_faster_than_its_start_is_followed() -> None:
    """The soft mesh of the start allows steps of 0.1 ms, those of the truth must be a quarter as long."""
    found = sw.fit(actuator(**{"gear.structure.mesh_stiffness": 8e6}), actuator_log(), ["gear.structure.mesh_stiffness"])
    low, high = found.estimates[0].interval(0.95)
    assert low < 1e8 < high
    assert high - low < 0.05 * 1e8


def test_noise_in_two_channels_of_different_size_is_weighed_by_itself() -> None:
    found = sw.fit(drive(a1=1.2e4), drive_log(noise=1e-3), ["gear.stiffness.a1", "gear.friction_input.coulomb"])
    assert found.rms() == pytest.approx([1e-3, 1e-5], rel=0.1)
    for estimate, truth in zip(found.estimates, (1.5e4, 0.03), strict=False):
        assert abs(estimate.value - truth) < 4.0 * estimate.sigma


def test_a_parameter_the_data_do_not_touch_has_no_finite_sigma() -> None:
    twist = np.concatenate((np.linspace(0.0, 1e-4, 30), np.linspace(1e-4, -1e-4, 60), np.linspace(-1e-4, 0.0, 30)))
    spring = sw.stiffness.ThreeSegment(k1=3e4, k2=5e4, k3=6e4, t1=14.0, t2=48.0)
    loop = TorsionLoop(twist, spring.torque(twist))
    found = fit(sw.Gear(stiffness=spring.replace(k1=2e4)), loop, ["stiffness.k1", "stiffness.k3"])
    k1, k3, *_ = found.estimates
    assert k1.value == pytest.approx(3e4, rel=1e-6)
    assert np.isfinite(k1.sigma)
    assert np.isinf(k3.sigma)
    assert "3 not determined" in repr(found)
    assert found.to_dict()["rows"]["stiffness.k3"]["note"].endswith("not determined by the data")


@pytest.mark.parametrize("seed", range(3))
def test_a_knee_that_a_long_step_takes_beyond_the_largest_torque_comes_back(seed: int) -> None:
    """From the residual of the start, 60 times the noise, the first full step moved the second knee out of reach for good."""
    start = sw.load("hfuc-25-100")
    truth = start.replace({"stiffness.k1": 3e4, "stiffness.k2": 4e4})
    ends = 1.4e-3 * np.array([1.0, -1.0, 1.0, -0.5, 0.5, -0.25, 1.0])
    twist = np.concatenate([np.linspace(begin, end, 200, endpoint=False) for begin, end in pairwise(ends)])
    torque = truth.trace(np.concatenate([[0.0], twist, twist]))[-len(twist) :] - 1.5
    torque += 0.05 * np.random.default_rng(seed).normal(size=len(twist))
    loop = sw.Recording({"twist": twist + 1e-4, "torque": torque}, {"twist": "rad", "torque": "N.m"})
    free = [path for path in every(start) if path.startswith(("stiffness.", "hysteresis."))]
    found, from_truth = (fit(model, loop, free) for model in (start, truth))
    assert found.rms()[0] == pytest.approx(from_truth.rms()[0], rel=1e-6)
    assert found.rms()[0] == pytest.approx(0.05, rel=0.05)
    assert all(np.isfinite(each.sigma) for each in found.estimates)


def test_samples_left_out_do_not_take_part() -> None:
    training = SPEED > 0.0
    spoilt = friction_table(np.where(training, 0.0, -1.0))
    found = fit(gear(), spoilt, FREE, training=training)
    assert found.gear.friction_input.coulomb == pytest.approx(LAW.coulomb, rel=1e-8)
    assert found.rms(held_out=True)[0] == pytest.approx(1.0, rel=1e-6)


def test_soft_loss_forgives_an_outlier() -> None:
    noise = 1e-4 * np.random.default_rng(3).normal(size=len(SPEED))
    noise[5] = 0.2
    strict = fit(gear(), friction_table(noise), FREE)
    soft = fit(gear(), friction_table(noise), FREE, loss="soft_l1")
    error = [abs(f.gear.friction_input.coulomb - LAW.coulomb) for f in (strict, soft)]
    assert error[1] < 0.5 * error[0]


@pytest.mark.parametrize(
    ("free", "message"),
    [
        (["friction_input.columb"], r'no parameter "friction_input.columb"; near it are friction_input.coulomb'),
        (["stiffness.a1"], r'no parameter "stiffness.a1"'),
    ],
)
def test_an_unknown_parameter_is_refused_with_its_neighbours(free: list[str], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        fit(gear(), friction_table(), free)


def test_columns_that_are_no_experiment_are_refused() -> None:
    recording = sw.Recording({"speed": SPEED}, {"speed": "rad/s"})
    with pytest.raises(ValueError, match="are no experiment on a gear"):
        fit(gear(), recording, FREE)
    with pytest.raises(ValueError, match='needs a column "time"'):
        fit(drive(), recording, ["gear.stiffness.a1"])


@pytest.mark.parametrize(
    ("given", "error", "message"),
    [
        ({"model": 3}, TypeError, r"^model must be a Gear or a drive, not 3$"),
        ({"recordings": "log.csv"}, TypeError, r"^recordings must be Recordings, or experiments made of them, not 'log.csv'$"),
        ({"free": "gear.damping"}, TypeError, r"^free must be a list of names, not 'gear.damping'$"),
        ({"channels": "torque"}, TypeError, r"^channels must be a list of names, not 'torque'$"),
        ({"dt": "1 N"}, ValueError, r'^dt: cannot convert "N" to "s"; write a number and its unit, as "1.2 s"$'),
        ({"training": [0, 1, 2]}, TypeError, r"^training must have True or False for each sample, not int64$"),
        ({"loss": "cauchy"}, ValueError, r'^loss = "cauchy" must be one of linear, soft_l1$'),
        (
            {"model": gear(), "recordings": friction_table(), "free": []},
            ValueError,
            r"^free must name at least one parameter: nothing else of ",
        ),
    ],
)
def test_what_makes_no_sense_is_refused(given: dict[str, Any], error: type[Exception], message: str) -> None:
    arguments: dict[str, Any] = {"model": drive(), "recordings": drive_log(noise=0.0), "free": ["gear.damping"]}
    with pytest.raises(error, match=message):
        sw.fit(**arguments | given)


def test_derivatives_beyond_all_numbers_are_told_in_words() -> None:
    class Endless(TorsionLoop):
        def predict(self, *given: Any) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
            predicted, slopes = super().predict(*given)
            return predicted, np.full_like(slopes, np.nan)

    with pytest.raises(FloatingPointError, match=r"^what the model predicts, or its derivatives, grow beyond all numbers"):
        fit(scaled(1.0), Endless(near_the_bound().twist, near_the_bound().torque), ["stiffness.flexspline_stiffness"])


def test_fewer_samples_than_unknowns_are_refused() -> None:
    with pytest.raises(ValueError, match="too few for 2 unknowns"):
        fit(gear(), friction_table(), FREE, training=np.arange(len(SPEED)) < 2)


COMPLIANCE = sw.stiffness.MultiCompliance(
    flexspline_stiffness=8e3,
    flexspline_hardening=0.02,
    wave_generator_stiffness=2.0,
    wave_generator_hardening=1.5,
    reduction=100.0,
)


def near_the_bound() -> TorsionLoop:
    """A loop of that spring up to 95 % of the twist it can have, 0.0132 rad."""
    twist = 0.0125 * np.sin(np.linspace(0.3, 0.3 + 2.0 * np.pi, 121))
    return TorsionLoop(twist, COMPLIANCE.torque(twist))


def scaled(*factors: float) -> sw.Gear:
    """A gear with that spring, its numbers multiplied."""
    names = [field["name"] for field in COMPLIANCE.fields]
    changed = {name: factor * getattr(COMPLIANCE, name) for name, factor in zip(names, factors, strict=False)}
    return sw.Gear(stiffness=COMPLIANCE.replace(**changed))


@pytest.mark.parametrize("factors", [(0.76, 1.15, 1.07, 0.75), (0.87, 0.86, 1.26, 0.85)])
def test_a_step_to_where_the_model_is_not_valid_is_taken_back(factors: tuple[float, ...]) -> None:
    """From here the first step asks a spring for more twist than it can have."""
    free = [f"stiffness.{field['name']}" for field in COMPLIANCE.fields if field["name"] != "reduction"]
    found = fit(scaled(*factors), near_the_bound(), free)
    for name in free:
        name = name.removeprefix("stiffness.")
        assert getattr(found.gear.stiffness, name) == pytest.approx(getattr(COMPLIANCE, name), rel=1e-6)


def test_a_model_that_is_not_valid_from_the_start_is_refused() -> None:
    stiffer = scaled(1.2, 1.2, 1.2, 1.2)
    with pytest.raises(ValueError, match=r"gear.stiffness: twist = 0\.0.* rad lies outside of"):
        fit(stiffer, near_the_bound(), ["stiffness.flexspline_stiffness"])


def few(seed: int) -> sw.Recording:
    speed = np.array([1.0, 5.0, 10.0, 20.0, 40.0])
    noise = 1e-3 * np.random.default_rng(seed).normal(size=5)
    return sw.Recording({"speed": speed, "torque": LAW.steady(speed) + noise}, {"speed": "rad/s", "torque": "N.m"})


@pytest.mark.slow("identification")
def test_the_intervals_of_few_samples_hold_the_truth_as_often_as_they_say() -> None:
    """Five samples, three degrees of freedom: three normal standard deviations would hold it in 94 %, not in 99.7 %."""
    held = {0.6826894921370859: 0, 0.95: 0, 0.9973: 0}
    for seed in range(400):
        for estimate, truth in zip(fit(gear(), few(seed), FREE).estimates, (LAW.coulomb, LAW.viscous), strict=True):
            for confidence in held:
                low, high = estimate.interval(confidence)
                held[confidence] += low <= truth <= high
    for confidence, count in held.items():
        assert count / 800 > confidence - 3.0 * np.sqrt(confidence * (1.0 - confidence) / 800)
    estimate = fit(gear(), few(0), FREE).estimates[0]
    assert estimate.freedom == pytest.approx(3.0)
    assert estimate.interval(0.6826894921370859) == pytest.approx(
        (estimate.value - estimate.sigma, estimate.value + estimate.sigma)
    )


@pytest.mark.slow("identification")
def test_noise_that_grows_with_the_torque_widens_what_it_spoils() -> None:
    """A pump's noise at high speed: the viscous coefficient is as unsure as it scatters."""
    speed = np.geomspace(1.0, 300.0, 40)
    found = []
    for seed in range(150):
        noise = 1e-5 * speed * np.random.default_rng(seed).normal(size=len(speed))
        table = sw.Recording({"speed": speed, "torque": LAW.steady(speed) + noise}, {"speed": "rad/s", "torque": "N.m"})
        found.append(fit(gear(), table, FREE).estimates[1])
    scatter = np.std([estimate.value for estimate in found])
    assert np.sqrt(np.mean([estimate.sigma**2 for estimate in found])) == pytest.approx(scatter, rel=0.25)
    assert np.median([estimate.freedom for estimate in found]) < 15.0  # few samples count
    held = [low < LAW.viscous < high for low, high in (estimate.interval() for estimate in found)]
    assert np.mean(held) > 0.85


def test_a_model_that_never_moves_is_refused_and_not_given_back() -> None:
    stuck = drive(coulomb=5.0)
    stuck = stuck.replace(gear=stuck.gear.replace(friction_input=sw.friction.Coulomb(coulomb=5.0, breakaway=5.0)))
    with pytest.raises(ValueError, match=r"^the model does not move under this command, though the drive did"):
        sw.fit(stuck, drive_log(), ["gear.friction_input.coulomb"])


def test_a_log_that_does_not_start_at_rest_is_refused_here_too() -> None:
    with pytest.raises(ValueError, match=r"must start at rest: input_angle starts at .* cut it to begin where"):
        sw.fit(drive(), drive_log().between(0.1, 0.9), ["gear.friction_input.coulomb"])


@pytest.mark.parametrize("scale", [1e12, 1e-12, 1e300])
def test_what_no_instrument_reads_is_refused_with_its_unit(scale: float) -> None:
    table = friction_table()
    table = table.with_column("torque", scale * table["torque"], "N.m")
    with pytest.raises(ValueError, match=r'^column "torque" goes up to .* N.m; what is measured .* taken to be N.m$'):
        sw.fit(gear(), table, FREE)


def test_what_a_fit_found_equals_its_copy() -> None:
    from copy import deepcopy

    found = fit(gear(), friction_table(1e-3), FREE)
    assert found == deepcopy(found)
    assert found != fit(gear(), friction_table(2e-3), FREE)
