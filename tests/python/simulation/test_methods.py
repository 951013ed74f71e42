"""How steps are taken: their orders, which method is chosen, and what events make of them."""

from __future__ import annotations

import json
import re
import subprocess
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from strainwave import _core
from strainwave.simulation.run import METHOD_WORDS

from tests.evidence.tolerance import difference
from tests.support.cplusplus import INCLUDE_FOLDER, STRICT, compilation, compiler
from tests.support.reference_drive import DRIVE, SMOOTH, STICKING, command

Array = NDArray[np.float64]

COULOMBS = STICKING.replace(
    gear=STICKING.gear.replace(friction_output=sw.friction.Coulomb(coulomb=3.0, breakaway=4.0, viscous=0.5))
)
STRIBECKS = SMOOTH.replace(
    gear=SMOOTH.gear.replace(
        friction_input=sw.friction.Stribeck(coulomb=0.03, breakaway=0.045, stribeck_speed=2.0, viscous=5e-5),
        friction_output=sw.friction.Stribeck(coulomb=3.0, breakaway=4.0, stribeck_speed=0.2, viscous=0.5),
    )
)


# Orders

RISE = command(0.2)
SWING = sw.scenario.sine(0.02, 3.0, 0.35)  # small and slow enough for what can stick to rest at its turns


@pytest.mark.parametrize(
    ("drive", "course", "method", "order"),
    [
        (SMOOTH, RISE, "exponential", 4.0),
        (STICKING, RISE, "exponential", 4.0),
        (STICKING, SWING, "exponential", 4.0),
        (COULOMBS, SWING, "exponential", 4.0),
        (STRIBECKS, SWING, "exponential", 4.0),
        (SMOOTH, RISE, "rosenbrock", 3.0),
        (SMOOTH, RISE, "moreau_jean", 2.0),
        (STRIBECKS, SWING, "moreau_jean", 2.0),
    ],
    ids=[
        "exponential",
        "exponential, turning round",
        "exponential, sticking",
        "exponential, both sides sticking, Coulomb",
        "exponential, both sides sticking, Stribeck",
        "rosenbrock",
        "moreau_jean",
        "moreau_jean, both sides sticking, Stribeck",
    ],
)
def test_each_method_converges_with_its_order(drive: sw.Drive, course: sw.scenario.Scenario, method: Any, order: float) -> None:
    """Halving the step twice, from where the asymptotic range has been reached."""
    exact = sw.simulate(drive, course, 2e-6, sample=1e-3)
    coarse = {"exponential": 1e-4, "rosenbrock": 5e-5, "moreau_jean": 2.5e-5}[method]
    errors = [difference(sw.simulate(drive, course, coarse / n, sample=1e-3, method=method), exact) for n in (1, 2, 4)]
    assert np.log2(errors[0] / errors[2]) / 2.0 == pytest.approx(order, abs=0.35)


def rests(speed: Array) -> int:
    """How often a side stops, after it has set off, for two samples or more."""
    still = (speed[:-1] == 0.0) & (speed[1:] == 0.0)
    return int(np.count_nonzero(~still[:-1] & still[1:]))


def test_where_orders_are_told_what_can_stick_does() -> None:
    """The rise sets off and turns round once, without a rest; the swing rests at its turns."""
    rising = sw.simulate(STICKING, RISE, 2e-5)["input_speed"]
    assert np.count_nonzero(rising[1:-1] * rising[2:] < 0.0) == 1
    for drive, sides in ((STICKING, ["input"]), (COULOMBS, ["input", "output"]), (STRIBECKS, ["input", "output"])):
        run = sw.simulate(drive, SWING, 2e-5)
        for side in sides:
            assert rests(run[f"{side}_speed"]) >= 2, side


@pytest.mark.parametrize("drive", [COULOMBS, STRIBECKS], ids=["Coulomb", "Stribeck"])
def test_with_several_places_that_stick_events_lead_where_time_stepping_does(drive: sw.Drive) -> None:
    """Which looks for no events, and misses each by as much as a step: of first order across them."""
    located = sw.simulate(drive, SWING, 1e-4, sample=1e-3)
    stepped = [sw.simulate(drive, SWING, dt, sample=1e-3, method="moreau_jean") for dt in (5e-5, 1.25e-5, 3.125e-6)]
    errors = [difference(run, located) for run in stepped]
    assert errors[2] < 5e-5
    assert np.log2(errors[0] / errors[2]) / 4.0 > 0.7


def test_a_turn_of_the_twist_within_a_step_is_remembered() -> None:
    """A spring and Maxwell elements swung past their turning points: errors fall with more than the second power."""
    drive = SMOOTH.replace(gear=SMOOTH.gear.replace(hysteresis=DRIVE.gear.hysteresis))
    exact = sw.simulate(drive, command(0.2), 2e-6, sample=1e-3)
    errors = [difference(sw.simulate(drive, command(0.2), dt, sample=1e-3), exact) for dt in (2e-4, 2.5e-5)]
    assert errors[0] < 2e-6  # 6e-6 where turning points are looked for at the ends of steps only
    assert np.log2(errors[0] / errors[1]) / 3.0 > 1.5


def coefficients() -> dict[str, Any]:
    """The numbers of the method as the code has them; rows filled up with zeros."""
    code = (INCLUDE_FOLDER / "strainwave" / "integrate" / "rosenbrock.hpp").read_text()
    found: dict[str, Any] = {}
    for name, numbers in re.findall(r"static constexpr double (\w+)(?:\[stages\])* =\s*([^;]+);", code):
        found[name] = json.loads(numbers.replace("{", "[").replace("}", "]"), parse_float=Fraction)
    for name in ("argument", "coupling"):
        found[name] = [row + [Fraction(0)] * (4 - len(row)) for row in found[name]]
    return found


def order_conditions() -> dict[str, tuple[Fraction, Fraction]]:
    """Left and right sides of those for a W-method of third order (Hairer and Wanner 1996, IV.7), in exact arithmetic.

    With sums over j < i in beta = argument + coupling, gamma on the diagonal of beta.
    """
    method = coefficients()
    argument, b = method["argument"], method["weight"]
    coupling = [
        [method["gamma"] if i == j else value for j, value in enumerate(row)] for i, row in enumerate(method["coupling"])
    ]
    stages = range(4)

    def along(matrix: list[Any], vector: list[Any]) -> list[Fraction]:
        return [sum((Fraction(matrix[i][j]) * vector[j] for j in stages), Fraction(0)) for i in stages]

    def weighed(vector: list[Any]) -> Fraction:
        return sum((b[i] * vector[i] for i in stages), Fraction(0))

    one = [Fraction(1)] * 4
    a, c = along(argument, one), along(coupling, one)
    return {
        "order 1": (weighed(one), Fraction(1)),
        "order 2": (weighed(a), Fraction(1, 2)),
        "order 2, any matrix": (weighed(c), Fraction(0)),
        "order 3, squares": (weighed([x * x for x in a]), Fraction(1, 3)),
        "order 3": (weighed(along(argument, a)), Fraction(1, 6)),
        "order 3, matrix inside": (weighed(along(argument, c)), Fraction(0)),
        "order 3, matrix outside": (weighed(along(coupling, a)), Fraction(0)),
        "order 3, matrix twice": (weighed(along(coupling, c)), Fraction(0)),
    }


@pytest.mark.parametrize("name", order_conditions())
def test_the_rosenbrock_method_is_of_third_order_with_any_matrix(name: str) -> None:
    left, right = order_conditions()[name]
    assert abs(left - right) < Fraction(1, 10**14)


def test_the_coefficients_of_the_rosenbrock_method_are_read_out_of_the_code() -> None:
    """Four stages, each of the ones before; the last is at the end of the step with the weights of the whole: L-stable."""
    method = coefficients()
    assert set(method) == {"gamma", "argument", "coupling", "weight"}
    for name in ("argument", "coupling"):
        assert [len(row) for row in method[name]] == [4] * 4
        assert all(method[name][i][j] == 0 for i in range(4) for j in range(i, 4))
    last = [a + c for a, c in zip(method["argument"][3], method["coupling"][3], strict=True)]
    last[3] += method["gamma"]
    assert all(abs(one - other) < Fraction(1, 10**15) for one, other in zip(last, method["weight"], strict=True))


# Stiff bristles


@pytest.mark.parametrize("stiffer", [10.0, 100.0, 1000.0])
def test_bristles_of_any_stiffness_are_followed_as_chosen(stiffer: float) -> None:
    """Against a smaller tolerance; while it is dragged to and fro the shaft comes to rest on its bristles."""
    law = DRIVE.gear.friction_input
    drive = DRIVE.replace(
        gear=DRIVE.gear.replace(friction_input=law.replace(bristle_stiffness=stiffer * law.bristle_stiffness))
    )
    to_and_fro = sw.scenario.sine(0.05, 4.0, 0.2)
    exact = sw.simulate_adaptively(drive, to_and_fro, rtol=1e-8)
    assert difference(sw.simulate(drive, to_and_fro, 2e-4, sample=1e-3), exact) < 1e-3


def on_bristles(stiffness: float) -> sw.Drive:
    law = DRIVE.gear.friction_input
    return DRIVE.replace(gear=DRIVE.gear.replace(friction_input=law.replace(bristle_stiffness=stiffness)))


TOO_STIFF = r"^the drive has bristles on which a shaft vibrates faster than steps of .* take dt = 6\.3e-05 s or less$"


@pytest.mark.slow("simulation")
@pytest.mark.filterwarnings("ignore:the drive has bristles:RuntimeWarning")  # asked for
def test_a_shaft_that_rests_on_stiff_bristles_and_slides_off_is_followed_by_the_rosenbrock_method() -> None:
    """A voltage that rises from nothing: with its order, in steps with which the exponential method loses the shaft."""
    law = DRIVE.gear.friction_input
    drive = on_bristles(1000.0 * law.bristle_stiffness).replace(control=sw.control.OpenLoop())
    rising = sw.scenario.ramp(5.0, 0.2)
    exact = sw.simulate_adaptively(drive, rising, rtol=1e-8)
    assert exact["input_speed"].min() >= 0.0
    assert exact["input_angle"][20] < 1e-6  # it rests
    assert exact["input_angle"][-1] > 0.1  # it slid
    errors = [difference(sw.simulate(drive, rising, dt, sample=1e-3, method="rosenbrock"), exact) for dt in (4e-4, 2e-4, 1e-4)]
    assert np.log2(errors[0] / errors[2]) / 2.0 == pytest.approx(3.0, abs=0.35)
    assert difference(sw.simulate(drive, rising, 2e-4, sample=1e-3, method="exponential"), exact) > 1000.0 * errors[1]


def test_the_method_is_chosen_by_the_bristles_and_said() -> None:
    stiff = on_bristles(1e5)
    for stiffness in (0.5, 50.0, 1e5, 1e7):
        assert _core.bristle_frequency(on_bristles(stiffness)) == pytest.approx(np.sqrt(stiffness / 1e-4), rel=1e-4)
    assert _core.bristle_frequency(STICKING) == 0.0
    assert sw.simulate(stiff, command(0.01)).method.startswith("exponential Runge-Kutta, adaptive, rtol 1e-06")
    with pytest.warns(RuntimeWarning, match=TOO_STIFF):
        run = sw.simulate(stiff, command(0.01), method="rosenbrock")
    assert run.method == "Rosenbrock W-method, steps of 0.0002 s"
    assert run.title == f"simulation: {run.method}"
    assert sw.simulate(DRIVE, command(0.01)).method == "exponential Runge-Kutta, steps of 0.0002 s"
    assert sw.simulate(STICKING, command(0.01)).method == "exponential Runge-Kutta, cut at events, steps of 0.0002 s"
    assert sw.simulate_adaptively(STICKING, command(0.01)).method.startswith(
        "exponential Runge-Kutta, cut at events, adaptive, "
    )
    assert tuple(_core.Method.__members__) == tuple(METHOD_WORDS)
    with pytest.warns(sw.simulation.EnsembleWarning, match=r"^1 members have bristles .* take dt = 6\.3e-05 s or less$"):
        sw.simulate_many(stiff, command(0.01), {"load.inertia": [0.5]})
    with pytest.raises(ValueError, match=r'^method = "euler" must be one of exponential, moreau_jean, rosenbrock$'):
        sw.simulate(DRIVE, command(0.01), method="euler")  # type: ignore[arg-type]


def test_a_response_in_steps_too_long_for_the_bristles_is_warned_of() -> None:
    stiff, loose = on_bristles(1e5), {"tolerance": 1e9, "max_periods": 2}  # whatever comes of it
    with pytest.warns(RuntimeWarning, match=TOO_STIFF) as told:
        sw.analysis.frequency_response(stiff, [500.0, 50.0], 1e-3, **loose)
    assert [warning.filename for warning in told] == [__file__]
    sw.analysis.frequency_response(stiff, 500.0, 1e-3, **loose)  # of which 64 steps are short enough


def test_a_fit_in_steps_too_long_for_the_bristles_is_warned_of() -> None:
    stiff = on_bristles(1e5)
    log = sw.simulate(stiff, command(0.02)).select(["time", "command", "input_angle", "torque"])
    with pytest.warns(RuntimeWarning, match=TOO_STIFF) as told:
        sw.fit(stiff, log, ["gear.damping"])
    assert [warning.filename for warning in told] == [__file__]
    sw.fit(stiff, log, ["gear.damping"], dt=5e-5)


# Events


def test_the_moment_of_an_event_is_found_just_behind_it_in_few_looks(tmp_path: Path) -> None:
    """Every margin falls to zero at 0.3. Secants come within 1e-12 of it in a few looks where it is smooth; where it jumps or
    is the same at first, twenty are tried in vain, and bisection takes another 40."""
    most_looks = dict.fromkeys(["jump", "jump_down", "plateau"], 60)
    *found, nowhere = told("crossing", tmp_path)
    assert len(found) == 9
    for name, moment, looks, in_a_pack, single, single_looks in found:
        assert 0.3 <= float(moment) < 0.3 + 3e-12, name
        assert int(looks) <= most_looks.get(name, 15), name
        assert in_a_pack == moment, name
        assert abs(float(single) - 0.3) < 1e-6, name
        assert int(single_looks) <= 20 + 21, name  # as many bisections as a float resolves; rounding spoils some secants
    assert nowhere == ["nowhere", "1", "0", "1", "1", "0"]


# Chattering

MOST_EVENTS = 16  # of a step, before what is left of it is time-stepping


def told(name: str, folder: Path) -> list[list[str]]:
    """The words of each line that a program beside this file prints."""
    source = Path(__file__).with_name(f"{name}.cpp")
    options = (*STRICT, "-Og", "-ffp-contract=off")
    assert compilation(compiler("g++"), folder, {source.name: source.read_text()}, *options) == (0, "")
    subprocess.run(["g++", f"{name}.o", "-o", name], cwd=folder, check=True)
    printed = subprocess.run([folder / name], capture_output=True, text=True, check=True, timeout=60).stdout
    return [line.split() for line in printed.splitlines()]


@pytest.fixture(scope="module")
def chattering(tmp_path_factory: pytest.TempPathFactory) -> list[list[float]]:
    """What the program tells that counts events: most in a step and calls of time-stepping, then the motion at the end."""
    return [[float(number) for number in line] for line in told("chattering", tmp_path_factory.mktemp("chattering"))]


@pytest.mark.slow("simulation")
def test_a_drive_without_chattering_is_never_time_stepped(chattering: list[list[float]]) -> None:
    for events, arrivals, *_ in chattering[:4]:
        assert 1 <= events < MOST_EVENTS
        assert arrivals == 0


@pytest.mark.slow("simulation")
def test_what_chattering_leaves_of_a_step_is_one_of_second_order(chattering: list[list[float]]) -> None:
    """Events that change nothing, without end where the input stands beyond a wall: as many as may be, and a right end."""
    exact, chatters = np.array(chattering[3][3:]), np.array(chattering[4:8])  # all but the current, which is no state here
    assert np.all(chatters[:, 0] == MOST_EVENTS)
    assert np.all(chatters[:, 1] == 2)  # to the middle, and to the end
    errors = np.abs(chatters[:, 3:] / exact - 1.0).max(axis=1)
    np.testing.assert_allclose(np.log2(errors[:-1] / errors[1:]), 2.0, atol=0.1)


@pytest.mark.slow("simulation")
def test_members_that_chatter_are_what_they_are_alone_and_disturb_no_other(chattering: list[list[float]]) -> None:
    """Eight, of which six chatter from different moments on; the program tells how many numbers differ."""
    assert chattering[8] == [0.0]


@pytest.mark.slow("simulation")
def test_no_adaptive_step_goes_on_after_an_event(chattering: list[list[float]]) -> None:
    """Of a drive that sticks and slips, and of four hundred that had all but settled when the inputs jumped."""
    assert chattering[9][0] == 0.0
    assert chattering[11] == [0.0]


@pytest.mark.slow("simulation")
def test_adaptive_steps_that_chatter_keep_the_tolerance_with_an_event_each(chattering: list[list[float]]) -> None:
    """Each look for an event that comes at once is one; sixteen before the first step, then one before each."""
    (_, calm_events, _, _, *exact), (_, events, accepted, rejected, *found) = chattering[9:11]
    assert calm_events < MOST_EVENTS
    assert MOST_EVENTS < events < MOST_EVENTS + accepted + rejected
    np.testing.assert_allclose(found, exact, rtol=1e-5)
