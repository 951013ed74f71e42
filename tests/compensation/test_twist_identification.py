"""Identification of compliance and orders while the joint works: against batch least squares, and where it stands still."""

from __future__ import annotations

import subprocess
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from strainwave.compensation import ModelFeedforward, TwistIdentification

from tests.compensation.ideal import DAMPING, KINEMATICS, PERIOD, RATIO, STIFFNESS, state
from tests.support.cplusplus import INCLUDE_FOLDER, compiler

Array = NDArray[np.float64]

SPRING = 1e4  # N.m/rad of the model
ARM = sw.loads.Pendulum(inertia=0.01, gravity_torque=100.0)
MODEL = ModelFeedforward(
    gear=sw.Gear(kinematics=KINEMATICS, stiffness=sw.stiffness.Linear(k=SPRING)), load=ARM, motor_inertia=1e-4
)
SWING = sw.scenario.sine(0.15, 0.25, 8.0) + sw.scenario.sine(0.03, 0.7, 8.0)
EVERY = {"memory": 1e300, "min_excitation": 0.0, "min_speed": 0.0, "limit": 1e6}  # all numbers, all samples, for ever


def drive(learning: TwistIdentification, compliance: float = 1.0, **parts: Any) -> sw.Drive:
    """An arm whose input follows its command; the gear has some times the compliance of the model."""
    spring = sw.stiffness.Linear(k=SPRING / compliance)
    gear = sw.Gear(**({"kinematics": KINEMATICS, "stiffness": spring, "damping": 30.0} | parts))
    law = sw.control.PID(proportional=STIFFNESS, derivative=DAMPING, limit=1e9)
    added = sw.Compensation(feedforward=MODEL, learning=learning)
    control = sw.control.Sampled(law=law, period=PERIOD, compensation=added)
    return sw.Drive(gear=gear, motor=sw.motor.AccelerationSource(), load=ARM, control=control)


def error(*orders: tuple[float, float, float]) -> sw.kinematic_error.Fourier:
    order, amplitude, phase = zip(*orders, strict=True)
    return sw.kinematic_error.Fourier(order=list(order), amplitude=list(amplitude), phase=list(phase))


def numbers(end: sw.State, kind: str, orders: int) -> Array:
    """Compliance, offset, and the sine and cosine of each order."""
    found = state(end, "learning")
    names = ["compliance", "offset"] + [f"{wave}[{n}]" for n in range(orders) for wave in ("sine", "cosine")]
    return np.array([found[f"{kind}_{name}"] for name in names])


def correlations(end: sw.State, count: int) -> Array:
    """Of all numbers, a square."""
    found, whole = state(end, "learning"), np.eye(count)
    rows, columns = np.tril_indices(count, -1)
    whole[rows, columns] = whole[columns, rows] = [found[f"correlation[{k}]"] for k in range(rows.size)]
    return whole


def regression(run: sw.Recording, orders: list[float]) -> tuple[Array, Array]:
    """Regressors, shape (samples, numbers), and measured lead at the output [rad]: of all instants but the last."""
    command, speed = run["command"], np.append(0.0, np.diff(run["command"]))
    angle, output = run["input_angle"][:-1], run["output_angle"][:-1]
    rate = SWING.rate(run.time) if run.time[-1] == SWING.duration else speed / PERIOD
    lead = MODEL.requests(command, rate, ratio=RATIO, period=PERIOD)[0][:-1]
    waves = [wave(order * angle) for order in orders for wave in (np.sin, np.cos)]
    return np.column_stack([lead / RATIO, np.ones(angle.size), *waves]), (angle - lead) / RATIO - output


def priors(law: TwistIdentification) -> Array:
    return np.array([law.compliance_prior, law.offset_prior] + 2 * len(law.order) * [law.amplitude_prior])


def test_without_forgetting_it_is_least_squares_with_the_priors() -> None:
    """All samples at once, by NumPy: estimates, standard deviations and correlations, of ten numbers."""
    orders = [1.0, 2.0, 2.5, 4.0]
    law = TwistIdentification(order=orders, noise=1e-4, noise_time=0.02, **EVERY)
    one = drive(law, compliance=1.2, kinematic_error=error((1.0, 1e-4, 0.3), (2.0, 2e-4, -1.0), (4.0, 5e-5, 2.0)))
    run = sw.simulate(one, SWING, sample=PERIOD)
    columns, lead = regression(run, orders)
    weight = 1.0 / (law.noise * np.sqrt(law.noise_time / PERIOD))
    whole = np.vstack([weight * columns, np.diag(1.0 / priors(law))])
    wanted = np.linalg.lstsq(whole, np.append(weight * lead, np.zeros(10)), rcond=None)[0]
    covariance = np.linalg.inv(whole.T @ whole)
    deviation = np.sqrt(np.diag(covariance))
    assert numbers(run.end, "value", 4) == pytest.approx(wanted, abs=1e-9 * np.abs(wanted).max(), rel=1e-9)
    assert numbers(run.end, "deviation", 4) == pytest.approx(deviation, rel=1e-9)
    assert correlations(run.end, 10) == pytest.approx(covariance / np.outer(deviation, deviation), abs=1e-9)


def test_its_forgetting_is_least_squares_over_numbers_that_wander() -> None:
    """Numbers of every sample at once, each near the one before and all near their priors: the last is the estimate."""
    orders, samples = [2.0], 60
    law = TwistIdentification(order=orders, noise=1e-4, noise_time=PERIOD, **(EVERY | {"memory": 0.02}))
    one = drive(law, compliance=1.2, kinematic_error=error((2.0, 2e-4, -1.0)))
    motion = sw.scenario.sine(0.05, 20.0, samples * PERIOD)
    run = sw.simulate(one, motion, sample=PERIOD)
    command = motion.value(run.time)
    lead = MODEL.requests(command, motion.rate(run.time), ratio=RATIO, period=PERIOD)[0][:-1]
    angle, output, prior = run["input_angle"][:-1], run["output_angle"][:-1], priors(law)
    columns = np.column_stack([lead / RATIO, np.ones(samples), np.sin(2.0 * angle), np.cos(2.0 * angle)])
    kept = 1.0 / np.sqrt(1.0 + 2.0 * PERIOD / law.memory)
    rows = [np.kron(np.eye(samples)[0], np.diag(1.0 / prior))]
    for k in range(1, samples):
        change = np.kron(np.eye(samples)[k] - kept * np.eye(samples)[k - 1], np.diag(1.0 / prior))
        rows.append(change / np.sqrt(1.0 - kept**2))
    measured = np.vstack([np.kron(np.eye(samples)[k], columns[k]) for k in range(samples)])
    whole = np.vstack([*rows, measured / law.noise])
    right = np.append(np.zeros(4 * samples), ((angle - lead) / RATIO - output) / law.noise)
    wanted = np.linalg.lstsq(whole, right, rcond=None)[0][-4:]
    deviation = np.sqrt(np.diag(np.linalg.inv(whole.T @ whole)))[-4:]
    assert numbers(run.end, "value", 1) == pytest.approx(wanted, abs=1e-9 * np.abs(wanted).max(), rel=1e-9)
    assert numbers(run.end, "deviation", 1) == pytest.approx(deviation, rel=1e-9)


@pytest.mark.parametrize("seed", range(4))
def test_it_recovers_a_drawn_gear_within_the_deviations_that_it_states(seed: int) -> None:
    """Under noise of the output encoder."""
    orders, drawn = [1.0, 2.0], np.random.default_rng(seed).standard_normal(5)
    waves = [(order, 3e-4 * np.hypot(*pair), np.arctan2(pair[1], pair[0]))
             for order, pair in zip(orders, drawn[1:].reshape(2, 2), strict=True)]  # fmt: skip
    law = TwistIdentification(order=orders, compliance_prior=0.1, noise=3e-4, noise_time=PERIOD, memory=1e6)
    one = drive(law, compliance=1.0 + 0.1 * drawn[0], kinematic_error=error(*waves))
    noise = sw.sensor.Noisy(law=sw.sensor.Ideal(), amplitude=3e-4, bandwidth=0.5 / PERIOD, seed=seed + 1)
    run = sw.simulate(one.replace(sensors=sw.Sensors(output_angle=noise)), SWING, sample=PERIOD)
    true = np.array([0.1 * drawn[0], 0.0, *(3e-4 * drawn[1:])])
    value, deviation = (numbers(run.end, kind, 2) for kind in ("value", "deviation"))
    assert (np.abs(value - true) < 3.0 * deviation).all()
    assert (deviation < 0.3 * priors(law)).all()  # the motion determines each number
    assert state(run.end, "learning")["residual"] == pytest.approx(3e-4, rel=0.1)


@pytest.mark.slow("physics")
def test_the_error_of_the_output_falls_by_nine_tenths() -> None:
    one = drive(TwistIdentification(order=[2.0], noise_time=0.01), compliance=1.2, kinematic_error=error((2.0, 2e-4, -1.0)))
    run = sw.simulate(one, SWING, sample=PERIOD)
    off = drive(TwistIdentification(order=[2.0], limit=0.0), compliance=1.2, kinematic_error=error((2.0, 2e-4, -1.0)))
    without = sw.simulate(off, SWING, sample=PERIOD)
    ideal = drive(TwistIdentification(limit=0.0))
    best = sw.simulate(ideal, SWING, sample=PERIOD)
    late = run.time > 2.0
    with_it, plain = ((each["output_angle"] - best["output_angle"])[late] for each in (run, without))
    assert np.sqrt(np.mean(with_it**2)) < 0.1 * np.sqrt(np.mean(plain**2))


@pytest.mark.slow("physics")
def test_it_follows_a_stiffness_that_falls_by_a_fifth() -> None:
    """Over 41 s; the estimate, at the end of a swing, is late by less than 1 %."""
    duration, fall, warmer = 41.0, 0.005, 44.6
    law = TwistIdentification(order=[], offset_prior=1e-4, memory=300.0)
    soft = sw.softening.ThermalSoftening(stiffness_fall=fall)
    motion = sw.scenario.sine(0.15, 0.25, duration)
    warm = sw.scenario.ramp(warmer / duration, duration) + sw.scenario.constant(
        sw.softening.ThermalSoftening().reference_temperature, duration
    )
    run = sw.simulate(drive(law, softening=soft), motion, sample=PERIOD, temperature=warm)
    compliance = numbers(run.end, "value", 0)[0]
    true = np.exp(fall * warmer) - 1.0
    assert 1.0 / (1.0 + true) == pytest.approx(0.8, abs=1e-3)
    assert compliance == pytest.approx(true, abs=0.01)
    assert abs(compliance - true) < 3.0 * numbers(run.end, "deviation", 0)[0]


def test_what_the_motion_does_not_excite_is_kept() -> None:
    """At constant speed without a load: the orders are found, compliance and its deviation stay at the prior, to the bit."""
    light = sw.loads.Inertia(inertia=1e-2)
    law = TwistIdentification(order=[2.0], noise_time=0.01)
    one = drive(law, compliance=1.5, kinematic_error=error((2.0, 2e-4, -1.0)))
    control = one.control.replace({"compensation.feedforward": MODEL.replace(load=light)})
    one = one.replace(load=light, control=control)
    run = sw.simulate(one, sw.scenario.ramp(0.3, 5.0), sample=PERIOD, initial={"input_speed": -30.0, "output_speed": 0.3})
    value, deviation = numbers(run.end, "value", 1), numbers(run.end, "deviation", 1)
    assert value[0] == 0.0
    assert deviation[0] == law.compliance_prior
    assert np.hypot(*value[2:]) == pytest.approx(2e-4, rel=0.05)
    assert deviation[2:].max() < 0.1 * law.amplitude_prior
    assert numbers(run.end, "excitation", 1)[0] < law.min_excitation < numbers(run.end, "excitation", 1)[2:].min()


@pytest.mark.parametrize(("min_speed", "learns"), [(60.0, False), (1.0, True)])
def test_below_min_speed_nothing_changes(min_speed: float, learns: bool) -> None:
    """The input turns at 50 rad/s at most."""
    one = drive(TwistIdentification(order=[2.0], min_speed=min_speed), kinematic_error=error((2.0, 2e-4, -1.0)))
    run = sw.simulate(one, sw.scenario.sine(0.15, 0.5, 1.0), sample=PERIOD)
    assert numbers(run.end, "value", 1).any() == learns
    start, end = (state(each, "learning") for each in (one.rest(), run.end))
    moved = {name for name in start if start[name] != end[name]}
    assert learns or moved == {"torsion", "torsion_rate", "begun"}


# Drawn gears; then a million samples of one regressor under noise, and fewer of a motion that excites all, in both precisions.
PROGRAM = """
#include <cmath>
#include <cstdio>
#include <strainwave/compensation/twist_identification.hpp>
using namespace strainwave;
template <class S>
void run(bool moves, bool all) {
    compensation::TwistIdentification<S> law{};
    law.order.count = 2;
    law.order[0] = S(1.0);
    law.order[1] = S(2.0);
    law.noise_time = S(1e-3);
    law.memory = S(1000.0);
    if (all) law.min_excitation = S(0.0);
    auto x = law.initial_state();
    double largest = 0.0, least = 1.0, widest = 0.0;
    unsigned long long seed = 7;
    for (int k = 0; k < (moves ? 200000 : 1000000); ++k) {
        double noise = 0.0;
        for (int i = 0; i < 12; ++i) {
            seed = seed * 6364136223846793005ull + 1442695040888963407ull;
            noise += double(seed >> 40) / 16777216.0 - 0.5;
        }
        const double t = 1e-3 * k, angle = moves ? 30.0 * std::sin(0.7 * t) : 1.3;
        const double twist = 8e-4 * (moves ? std::sin(1.1 * t) : 1.0);
        const double z = 0.2 * twist + 2e-4 * std::sin(2.0 * angle) + 5e-4 + 2e-5 * noise;
        compensation::Inputs<S> inputs{};
        inputs.command = {S(0.0), S(0.5), S(-100.0)};
        inputs.measured.input_angle = S(angle);
        inputs.measured.output_angle = S(angle / -100.0 - twist - z);
        inputs.request.torsion = inputs.request.input_lead = S(-100.0 * twist);
        x = law.advance(x, inputs, law.request(x, inputs), S(0.0), S(1e-3));
        const double prior[] = {0.3, 1e-3, 3e-4, 3e-4, 3e-4, 3e-4};
        for (int j = 0; j < 6; ++j) {
            largest = std::fmax(largest, std::fabs(double(x.value[j])) / prior[j]);
            least = std::fmin(least, double(x.deviation[j]) / prior[j]);
            widest = std::fmax(widest, double(x.deviation[j]) / prior[j]);
        }
    }
    std::printf("%.9g %.9g %.9g", largest, least, widest);
    for (int j = 0; j < 6; ++j) std::printf(" %.9g %.9g", double(x.value[j]), double(x.deviation[j]));
    std::printf("\\n");
}
double seeded(unsigned long long& seed) {
    double sum = 0.0;
    for (int i = 0; i < 12; ++i) {
        seed = seed * 6364136223846793005ull + 1442695040888963407ull;
        sum += double(seed >> 40) / 16777216.0 - 0.5;
    }
    return sum;
}
// Squares of the errors over the deviations, of numbers that wander about their priors as it assumes.
void drawn(double memory) {
    compensation::TwistIdentification<double> law{};
    law.order.count = 2;
    law.order[0] = 1.0;
    law.order[1] = 2.0;
    law.noise_time = 1e-3;
    law.memory = memory;
    law.limit = 1e6;
    const double prior[] = {0.3, 1e-3, 3e-4, 3e-4, 3e-4, 3e-4}, kept = std::exp(-1e-3 / memory);
    double square[6]{};
    unsigned long long seed = 11;
    for (int member = 0; member < 200; ++member) {
        double true_value[6];
        for (int j = 0; j < 6; ++j) true_value[j] = prior[j] * seeded(seed);
        auto x = law.initial_state();
        for (int k = 0; k < 1000; ++k) {
            const double t = 1e-3 * k, angle = 30.0 * std::sin(0.7 * t + member), twist = 8e-4 * std::sin(5.0 * t + member);
            const double phi[] = {twist, 1.0, std::sin(angle), std::cos(angle), std::sin(2.0 * angle), std::cos(2.0 * angle)};
            double z = 2e-5 * seeded(seed);
            for (int j = 0; j < 6; ++j) {
                z += phi[j] * true_value[j];
                true_value[j] = kept * true_value[j] + std::sqrt(1.0 - kept * kept) * prior[j] * seeded(seed);
            }
            compensation::Inputs<double> inputs{};
            inputs.command = {0.0, 0.5, -100.0};
            inputs.measured.input_angle = angle;
            inputs.measured.output_angle = angle / -100.0 - twist - z;
            inputs.request.torsion = inputs.request.input_lead = -100.0 * twist;
            x = law.advance(x, inputs, law.request(x, inputs), 0.0, 1e-3);
        }
        for (int j = 0; j < 6; ++j) square[j] += std::pow((x.value[j] - true_value[j]) / x.deviation[j], 2) / 200.0;
    }
    for (int j = 0; j < 6; ++j) std::printf("%.9g ", square[j]);
    for (int j = 6; j < 15; ++j) std::printf("0 ");
    std::printf("\\n");
}
int main() {
    drawn(1e9);
    drawn(100.0);
    for (int moves = 0; moves < 2; ++moves)
        for (int all = 0; all < 2; ++all) run<double>(moves, all), run<float>(moves, all);
}
"""


@pytest.fixture(scope="module")
def million(tmp_path_factory: pytest.TempPathFactory) -> dict[tuple[str, str, str], Array]:
    """By motion, numbers adapted and precision: largest value, least and largest deviation over the priors; the numbers."""
    folder = tmp_path_factory.mktemp("million")
    (folder / "million.cpp").write_text(PROGRAM)
    command = [*compiler("g++"), "-std=c++20", "-O2", "-Wno-psabi", f"-I{INCLUDE_FOLDER}", "million.cpp", "-o", "million"]
    subprocess.run(command, cwd=folder, check=True)
    printed = subprocess.run([folder / "million"], capture_output=True, text=True, check=True).stdout
    keys = [("drawn", "all", memory) for memory in ("long", "short")]
    keys += [(motion, adapted, scalar) for motion in ("one angle", "moves") for adapted in ("excited", "all")
            for scalar in ("double", "float")]  # fmt: skip
    return dict(zip(keys, np.loadtxt(printed.splitlines()), strict=True))


@pytest.mark.slow("physics")
@pytest.mark.parametrize("memory", ["long", "short"])
def test_its_deviations_are_those_of_two_hundred_drawn_gears(million: Any, memory: str) -> None:
    """Constant numbers, and numbers that wander as it assumes: squares of error over deviation have the mean 1."""
    squares = million["drawn", "all", memory][:6]
    assert squares == pytest.approx(np.ones(6), abs=3.5 * np.sqrt(2.0 / 200.0))


@pytest.mark.slow("physics")
@pytest.mark.parametrize("scalar", ["double", "float"])
def test_a_million_samples_of_one_torque_and_angle_move_the_offset_alone(million: Any, scalar: str) -> None:
    found = million["one angle", "excited", scalar]
    value, deviation = found[3::2], found[4::2]
    assert not value[[0, 2, 3, 4, 5]].any()
    assert deviation[[0, 2, 3, 4, 5]] == pytest.approx([0.3, 3e-4, 3e-4, 3e-4, 3e-4], rel=1e-6)
    total = 0.2 * 8e-4 + 2e-4 * np.sin(2.6) + 5e-4
    assert value[1] == pytest.approx(total, abs=1e-5)


@pytest.mark.slow("physics")
@pytest.mark.parametrize("scalar", ["double", "float"])
def test_neither_values_nor_deviations_grow_where_nothing_is_kept(million: Any, scalar: str) -> None:
    """One regressor for a thousand seconds: the priors hold what it leaves open."""
    largest, least, widest = million["one angle", "all", scalar][:3]
    assert largest < 1.0
    assert least > 1e-3
    assert widest < 1.0 + 1e-6


@pytest.mark.slow("physics")
@pytest.mark.parametrize("adapted", ["excited", "all"])
def test_single_precision_has_the_numbers_of_double_precision(million: Any, adapted: str) -> None:
    double, single = (million["moves", adapted, scalar][3:] for scalar in ("double", "float"))
    deviation, true = double[1::2], [0.2, 5e-4, 0.0, 0.0, 2e-4, 0.0]
    assert (np.abs(double[::2] - true) < 4.0 * deviation).all()
    assert (np.abs(single[::2] - double[::2]) < 3.0 * deviation).all()
    assert single[1::2] == pytest.approx(deviation, rel=0.02)


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"noise": 0.0}, r"twist_identification\.noise = 0 rad must lie in"),
        ({"memory": -1.0}, r"twist_identification\.memory = -1 s must lie in"),
        ({"compliance_prior": -0.1}, r"twist_identification\.compliance_prior = -0\.1"),
        ({"order": [1.0, 2.0, 3.0, 4.0, 5.0]}, "4"),
    ],
)
def test_what_is_wrong_is_refused(changed: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        TwistIdentification(**changed)
