"""What every compensator obeys: it rests with the drive, is odd as its drive is, and is one in every kind of run."""

from __future__ import annotations

import subprocess
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import HealthCheck, assume, given, reject, settings, strategies as st
from numpy.typing import NDArray
from strainwave import _core, compensation
from strainwave.files.gear_set import load, save
from strainwave.native import kernels
from strainwave.native.cache import find_kernel, make_kernel
from strainwave.native.kernel import Kernel
from strainwave.native.static_type import in_words, static_type

from tests.support.cplusplus import INCLUDE_FOLDER, ROOT, compiler
from tests.support.samples import sample
from tests.support.strategies import built

Array = NDArray[np.float64]

PERIOD = 1e-3  # s
KINEMATICS = sw.kinematics.StrainWave(flexspline_teeth=200, circular_spline_teeth=202, fixed="circular_spline")
# Every effect that a feed-forward knows, each odd: the opposite command has the opposite motion.
GEAR = sw.Gear(
    kinematics=KINEMATICS,
    kinematic_error=sw.kinematic_error.Fourier(order=[1.0, 2.0], amplitude=[1e-4, 3e-4], phase=[0.0, 0.0]),
    stiffness=sw.stiffness.Cubic(a1=8000.0, a3=4e7),
    hysteresis=sw.hysteresis.MaxwellSlip(stiffness=[1000.0, 600.0], breakaway=[0.5, 0.9]),
    damping=5.0,
    friction_input=sw.friction.LuGre(
        coulomb=0.05, breakaway=0.07, stribeck_speed=3.0, bristle_stiffness=5.0, bristle_damping=2e-3, viscous=1e-3
    ),
    friction_mesh=sw.friction.Coulomb(coulomb=0.4, breakaway=0.4),
    input_inertia=1e-4,
)
ARM = sw.loads.Pendulum(inertia=0.05, gravity_torque=8.0)
ROTOR = 5e-5  # kg.m2
USED: dict[str, Any] = {
    "model_feedforward": compensation.ModelFeedforward(gear=GEAR, load=ARM, motor_inertia=ROTOR, friction_share=0.9),
    "lost_motion_map": compensation.LostMotionMap(
        angle=[-0.1, 0.0, 0.1], forward=[3e-4, 2e-4, 1e-4], backward=[-1e-4, -2e-4, -3e-4], reach=0.01
    ),
    "adaptive_fourier": compensation.AdaptiveFourier(order=[1.0, 2.0, 2.02], gain=10.0, lag=0.01, max_frequency=130.0),
    "repetitive": compensation.Repetitive(gain=20.0, smoothing=1.0, lag=0.01, max_speed=100.0),
    "iterative_learning": compensation.IterativeLearning(
        low=-0.1, high=0.1, reach=0.01, gain=20.0, smoothing=1.0, lag=0.01, max_speed=200.0
    ),
    "twist_identification": compensation.TwistIdentification(order=[1.0, 2.0], noise=1e-4, memory=5.0, min_excitation=0.01),
    "disturbance_observer": compensation.DisturbanceObserver(inertia=1.6e-4, bandwidth=120.0, limit=0.3),
    "friction_scale": compensation.FrictionScale(gain=3.0),
    "bristle_observer": compensation.BristleObserver(
        friction=GEAR.friction_input, friction_share=0.9, bristle_gain=0.2, gain=3.0, max_scale=1.2
    ),
    "dither": compensation.Dither(amplitude=0.02, frequency=37.0),
}
PLACES = ("feedforward", "learning", "observer", "dither")
LISTED = [(place, name) for place in PLACES for name in _core.families[place]]
# What suits each other: a friction is scaled that a model has.
TOGETHER = {"feedforward": "model_feedforward", "learning": "adaptive_fourier", "observer": "friction_scale"}
COMMAND = sw.scenario.sine(0.12, 2.0, 0.4)


def part_of(place: str, name: str) -> Any:
    """A compensator with numbers that suit the drive; another has those that it has by default."""
    return USED[name] if name in USED else _core.families[place][name]()


def drive_of(chosen: dict[str, str]) -> sw.Drive:
    part = sw.Compensation(**{place: part_of(place, name) for place, name in chosen.items()})
    law = sw.control.PID(proportional=0.55, derivative=0.018, limit=2.0)
    control = sw.control.Sampled(law=law, period=PERIOD, delay=2e-4, compensation=part)
    return sw.Drive(gear=GEAR, motor=sw.motor.TorqueSource(inertia=ROTOR), load=ARM, control=control)


def drive_with(part: sw.Compensation, law: sw.control.PID) -> sw.Drive:
    """A drive with any compensation, and with the ratio of its model."""
    model: Any = part.feedforward
    gear = GEAR.replace(kinematics=model.gear.kinematics) if isinstance(model, compensation.ModelFeedforward) else GEAR
    control = sw.control.Sampled(law=law, compensation=part)
    return sw.Drive(gear=gear, motor=sw.motor.TorqueSource(inertia=ROTOR), load=ARM, control=control)


def alone(place: str, name: str) -> sw.Drive:
    """A drive with this compensator, and with a model where it needs one."""
    model = {"feedforward": "model_feedforward"} if name in ("friction_scale", "twist_identification") else {}
    return drive_of(model | {place: name})


every_compensator = pytest.mark.parametrize(("place", "name"), LISTED, ids=[f"{place}={name}" for place, name in LISTED])


@every_compensator
def test_a_drive_at_rest_with_command_zero_stays_at_rest(place: str, name: str) -> None:
    run = sw.simulate(alone(place, name), sw.scenario.constant(0.0, 0.02), sample=PERIOD)
    for column in run.names:
        if column not in ("time", "temperature"):
            assert not run[column].any(), column


@every_compensator
def test_the_opposite_command_gives_the_opposite_motion(place: str, name: str) -> None:
    """To the bit; but for tables that are summed up from the other end."""
    one = alone(place, name)
    forth, back = (sw.simulate(one, sense * COMMAND, sample=PERIOD) for sense in (1.0, -1.0))
    for column in ("input_angle", "input_speed", "output_angle", "torque"):
        if name in ("repetitive", "iterative_learning", "lost_motion_map"):
            assert forth[column] == pytest.approx(-back[column], abs=1e-9 * np.abs(forth[column]).max())
        else:
            assert np.array_equal(forth[column], -back[column])


@every_compensator
def test_it_changes_what_the_motor_is_given(place: str, name: str) -> None:
    """So that the other tests are of something."""
    with_it, without = (sw.simulate(one, COMMAND, sample=PERIOD)["motor_torque"] for one in (alone(place, name), drive_of({})))
    assert np.array_equal(with_it, without) == name.startswith("no_")


@every_compensator
def test_members_of_an_ensemble_are_runs_alone_to_the_bit(place: str, name: str) -> None:
    one = alone(place, name)
    inertias = np.linspace(0.04, 0.06, 11)
    many = sw.simulate_many(one, COMMAND, {"load.inertia": inertias}, sample=PERIOD, record=["output_angle", "torque"])
    for k in (0, 7, 10):
        single = sw.simulate(one.replace({"load.inertia": float(inertias[k])}), COMMAND, sample=PERIOD, method="exponential")
        assert np.array_equal(many["output_angle"][k], single["output_angle"])
        assert np.array_equal(many["torque"][k], single["torque"])


# Numbers that a run follows smoothly; limits and bounds are met or not, and orders are kept.
VARIED = {
    "model_feedforward": [
        *("friction_share", "motor_inertia", "gear.stiffness.a1", "gear.hysteresis.stiffness[0]"),
        *("gear.friction_input.coulomb", "gear.kinematic_error.amplitude[1]", "load.gravity_torque"),
    ],
    "lost_motion_map": ["forward[1]", "backward[0]", "reach"],
    "adaptive_fourier": ["gain", "lag"],
    "repetitive": ["gain", "smoothing", "lag"],
    "iterative_learning": ["reach", "gain", "smoothing", "lag"],
    "twist_identification": ["amplitude_prior", "offset_prior", "noise", "noise_time", "memory"],
    "disturbance_observer": ["inertia", "bandwidth"],
    "friction_scale": ["gain", "position_gain"],
    "bristle_observer": ["friction.coulomb", "friction_share", "bristle_gain", "position_gain", "gain"],
    "dither": ["amplitude", "frequency"],
}


@every_compensator
def test_its_numbers_may_differ_from_member_to_member(place: str, name: str) -> None:
    one = alone(place, name)
    for field in VARIED.get(name, []):
        path = f"control.compensation.{place}.{field}"
        value = next(number for found, number, *_ in _core.parameters(one) if found == path)
        numbers = value * np.array([0.9, 1.0, 1.1])
        many = sw.simulate_many(one, COMMAND, {path: numbers}, sample=PERIOD)
        assert not np.array_equal(many["output_angle"][0], many["output_angle"][2]), field
        for number, row in zip(numbers, many["output_angle"], strict=True):
            member = one.replace({path: float(number)})
            assert np.array_equal(row, sw.simulate(member, COMMAND, sample=PERIOD, method="exponential")["output_angle"]), field


@every_compensator
def test_its_derivatives_are_those_of_differences(place: str, name: str) -> None:
    """Central differences, of a run that is the run alone to the bit."""
    one = alone(place, name)
    paths = [f"control.compensation.{place}.{field}" for field in VARIED.get(name, [])]
    found = sw.analysis.derivatives(one, COMMAND, paths or ["load.inertia"], sample=1e-2)
    single = sw.simulate(one, COMMAND, sample=1e-2, method="exponential")
    assert np.array_equal(found.run["output_angle"], single["output_angle"])
    for path in paths:
        value = next(number for known, number, *_ in _core.parameters(one) if known == path)
        step = 1e-5 * value
        near = [sw.simulate(one.replace({path: value + by}), COMMAND, sample=1e-2)["output_angle"] for by in (-step, step)]
        slope = found["output_angle", path]
        assert np.abs(slope).max() > 0.0, path
        assert slope == pytest.approx((near[1] - near[0]) / (2.0 * step), abs=1e-3 * np.abs(slope).max()), path


@every_compensator
@pytest.mark.parametrize("at", [0.2, 0.1503])
def test_it_goes_on_where_a_run_ended(place: str, name: str, at: float) -> None:
    """At an instant, and between two."""
    one = alone(place, name)
    level = sw.scenario.ramp(0.5, 0.4)
    whole = sw.simulate(one, level, 1e-4, sample=1e-4)
    first = sw.simulate(one, sw.scenario.ramp(0.5, at), 1e-4, sample=1e-4)
    rest = sw.scenario.constant(0.5 * at, 0.4 - at) + sw.scenario.ramp(0.5, 0.4 - at)
    second = sw.simulate(one, rest, 1e-4, sample=1e-4, initial=first.end)
    for column in ("input_angle", "output_angle"):
        assert second[column][-1] == pytest.approx(whole[column][-1], abs=1e-7 * np.abs(whole[column]).max())
    for number in whole.end:
        if number.startswith("control.compensation."):
            assert second.end[number] == pytest.approx(whole.end[number], rel=1e-4, abs=1e-7)


@every_compensator
def test_all_numbers_of_its_state_have_names_of_their_own(place: str, name: str) -> None:
    names = [each for each, _, _ in _core.state(drive_of(TOGETHER | {place: name}))[0]]
    assert len(set(names)) == len(names)
    own = [each for each in names if each.startswith(f"control.compensation.{place}.")]
    assert bool(own) == (not name.startswith("no_"))


@settings(max_examples=sample(15, 60), suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much])
@given(built(sw.Compensation))
def test_of_any_compensation_all_names_differ_and_begin_alike(part: sw.Compensation) -> None:
    one = drive_with(part, sw.control.PID())
    names = [each for each, _, _ in _core.state(one)[0]]
    assert len(set(names)) == len(names)
    assert all(np.isfinite(number) for number in one.rest().values())


@every_compensator
def test_written_to_a_file_and_read_it_is_the_same(tmp_path: Path, place: str, name: str) -> None:
    one = drive_of(TOGETHER | {place: name})
    save(one, tmp_path / "drive.toml", name="x", source="x")
    assert load(tmp_path / "drive.toml") == one


@pytest.mark.slow("physics")
@settings(max_examples=sample(10, 40), suppress_health_check=[*HealthCheck])
@given(part=built(sw.Compensation))
def test_so_is_any_other(tmp_path: Path, part: sw.Compensation) -> None:
    one = drive_with(part, sw.control.PID())
    save(one, tmp_path / "drive.toml", name="x", source="x")
    assert load(tmp_path / "drive.toml") == one


COMPILED = [
    TOGETHER,
    {"feedforward": "lost_motion_map", "learning": "repetitive", "observer": "disturbance_observer"},
    {"feedforward": "lost_motion_map", "learning": "iterative_learning", "observer": "bristle_observer", "dither": "dither"},
    {"feedforward": "model_feedforward", "learning": "twist_identification", "observer": "disturbance_observer"},
]


@pytest.mark.slow("physics")
@pytest.mark.parametrize("chosen", COMPILED, ids=lambda chosen: "+".join(chosen.values()))
def test_a_compiled_kernel_gives_the_bits_of_the_general_drive(chosen: dict[str, str]) -> None:
    one = drive_of(chosen)
    _core.forget_kernels(one)
    general = sw.simulate(one, COMMAND, sample=PERIOD, method="exponential")
    kernel = Kernel(kernels.source(one, ["simulate"]), "simulate", in_words(one))
    try:
        kernels.use(one, find_kernel(kernel) or make_kernel(kernel))
        assert _core.loaded_jobs(one) == ["simulate"]
        compiled = sw.simulate(one, COMMAND, sample=PERIOD, method="exponential")
    finally:
        _core.forget_kernels(one)
    assert all(np.array_equal(compiled[column], general[column]) for column in general.names)
    assert np.array_equal(compiled.end.numbers, general.end.numbers)


# Compensations in both precisions along the same motion: a second of an output that lags behind its command and errs.
PROGRAM = """
#include <cmath>
#include <cstdio>
#include <kernel/assemble.hpp>
#include <strainwave/drive.hpp>
#include <strainwave/models.hpp>

using namespace strainwave;
{types}
template <class S>
struct Course {{
    double lead[1000], torque[1000];
    template <class Part>
    void run(const Part& part) {{
        auto x = part.initial_state();
        for (int k = 0; k < 1000; ++k) {{
            const double t = 1e-3 * k, late = t - 0.01, r = 0.2 * std::sin(5.0 * late), v = std::cos(5.0 * late);
            control::Command<S> command{{S(0.2 * std::sin(5.0 * t)), S(std::cos(5.0 * t)), S(-100.0)}};
            control::Measurement<S> measured{{}};
            measured.input_angle = S(-100.0 * r);
            measured.input_speed = S(-100.0 * v);
            measured.output_angle = S(r - 3e-4 * std::sin(200.0 * r));
            const auto now = part.instant(x, command, measured, S(1e-3));
            const auto asked = now.command(part);
            lead[k] = double(asked.input_lead);
            torque[k] = double(asked.feedforward);
            x = part.advance(x, now, S(0.9) * asked.feedforward + S(0.02), S(1e-3));
        }}
    }}
}};
template <template <class> class Drive, class S>
Course<S> course(const int* laws, const int* shape, const double* numbers, int count) {{
    S own[4096];
    for (int i = 0; i < count; ++i) own[i] = S(numbers[i]);
    kernel::Reader<S> from{{laws, shape, own}};
    Course<S> found{{}};
    found.run(kernel::assembled<Drive<S>>(from).control.compensation.compile());
    return found;
}}
template <template <class> class Drive>
void compare(const int* laws, const int* shape, const double* numbers, int count) {{
    const auto one = course<Drive, double>(laws, shape, numbers, count);
    const auto other = course<Drive, float>(laws, shape, numbers, count);
    for (int k = 0; k < 1000; ++k)
        std::printf("%.9g %.9g %.9g %.9g\\n", one.lead[k], other.lead[k], one.torque[k], other.torque[k]);
}}
int main() {{
{calls}
}}
"""


def in_both_precisions(drives: list[sw.Drive], folder: Path) -> Array:
    """Leads [rad] and torques [N.m], in double and in single precision, of the instants of each drive."""
    types, calls = [], []
    for number, drive in enumerate(drives):
        laws, shape, numbers = _core.parts(drive)
        types.append(f"template <class S>\nusing Drive{number} = {static_type(drive)};")
        for name, kind, values in (("laws", "int", laws), ("shape", "int", shape), ("numbers", "double", numbers.tolist())):
            types.append(f"const {kind} {name}{number}[] = {{{', '.join(map(repr, values)) or '0'}}};")
        calls.append(f"    compare<Drive{number}>(laws{number}, shape{number}, numbers{number}, {len(numbers)});")
    (folder / "both.cpp").write_text(PROGRAM.format(types="\n".join(types), calls="\n".join(calls)))
    command = [
        *compiler("g++"),
        "-std=c++20",
        "-O1",
        "-Wno-psabi",
        f"-I{INCLUDE_FOLDER}",
        f"-I{ROOT / 'src'}",
        "both.cpp",
        "-o",
        "both",
    ]
    subprocess.run(command, cwd=folder, check=True)
    printed = subprocess.run([folder / "both"], capture_output=True, text=True, check=True).stdout
    return np.loadtxt(printed.splitlines()).reshape(len(drives), -1, 4)


@pytest.mark.slow("physics")
def test_single_precision_asks_for_the_same_within_a_ten_thousandth(tmp_path: Path) -> None:
    """Of the largest lead, and of the largest torque, which has differences of speeds over a period."""
    found = in_both_precisions([drive_of(chosen) for chosen in COMPILED], tmp_path)
    for each in found:
        for double, single in (each[:, :2].T, each[:, 2:].T):
            assert np.abs(double).max() > 0.0
            assert np.abs(single - double).max() < 1e-4 * np.abs(double).max()


@settings(max_examples=sample(10, 60), suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much])
@given(built(sw.Compensation), st.floats(0.01, 1.0))
def test_whatever_its_numbers_it_gives_no_more_than_the_limit_of_its_controller(part: sw.Compensation, speed: float) -> None:
    assume(getattr(part.dither, "frequency", 0.0) < 400.0)  # of a sample rate of 1 kHz
    one = drive_with(part, sw.control.PID(limit=0.5))
    try:
        run = sw.simulate(one, sw.scenario.sine(speed / 20.0, 3.0, 0.1), 1e-4)
    except FloatingPointError:  # so fast a vibration that steps do not follow it
        reject()
    except ValueError as error:  # a law of the model is not valid there
        assume("lies outside of" not in str(error))
        raise
    assert np.abs(run["motor_torque"]).max() <= 0.5
