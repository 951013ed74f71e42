"""How steps are taken: orders, tolerances kept, and which method is chosen."""

from __future__ import annotations

import json
import re
import subprocess
from fractions import Fraction
from itertools import count, pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from strainwave import _core
from strainwave.simulation import METHODS

from tests.cplusplus import INCLUDE, STRICT, compilation, compiler
from tests.laws.test_gear import DRIVE as EVERYTHING
from tests.laws.test_gear import EVERY_PART, cannot_create_energy, innermost, laws
from tests.reference_drive import DRIVE, command
from tests.tolerance import COLUMNS, difference, until, verdict

Array = NDArray[np.float64]

NO_HYSTERESIS = sw.hysteresis.MaxwellSlip(stiffness=[], breakaway=[])
SMOOTH = DRIVE.replace(gear=DRIVE.gear.replace(hysteresis=NO_HYSTERESIS, friction_input=sw.friction.Viscous(viscous=1e-4)))
STICKING = SMOOTH.replace(gear=SMOOTH.gear.replace(friction_input=sw.friction.Coulomb(coulomb=0.03, breakaway=0.045)))


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
    ],
    ids=[
        "exponential",
        "exponential, turning round",
        "exponential, sticking",
        "exponential, both sides sticking, Coulomb",
        "exponential, both sides sticking, Stribeck",
        "rosenbrock",
        "moreau_jean",
    ],
)
def test_each_method_converges_with_its_order(
    drive: sw.drives.PositionDrive, course: sw.scenario.Scenario, method: Any, order: float
) -> None:
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
def test_with_several_places_that_stick_events_lead_where_time_stepping_does(drive: sw.drives.PositionDrive) -> None:
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
    code = (INCLUDE / "strainwave" / "integrate" / "rosenbrock.hpp").read_text()
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


def on_bristles(stiffness: float) -> sw.drives.PositionDrive:
    law = DRIVE.gear.friction_input
    return DRIVE.replace(gear=DRIVE.gear.replace(friction_input=law.replace(bristle_stiffness=stiffness)))


TOO_STIFF = r"^the drive has bristles on which a shaft vibrates faster than steps of .* take dt = 6\.3e-05 s or less$"


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
        assert _core.bristle_vibration(on_bristles(stiffness)) == pytest.approx(np.sqrt(stiffness / 1e-4), rel=1e-4)
    assert _core.bristle_vibration(STICKING) == 0.0
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
    assert tuple(_core.Method.__members__) == METHODS
    with pytest.warns(sw.EnsembleWarning, match=r"^1 members have bristles .* take dt = 6\.3e-05 s or less$"):
        sw.simulate_many(stiff, command(0.01), {"load.inertia": [0.5]})
    with pytest.raises(ValueError, match=r'^method = "euler" is not known; there are exponential, moreau_jean, rosenbrock$'):
        sw.simulate(DRIVE, command(0.01), method="euler")  # type: ignore[arg-type]


def test_a_response_in_steps_too_long_for_the_bristles_is_warned_of() -> None:
    stiff, loose = on_bristles(1e5), {"tolerance": 1e9, "most_periods": 2}  # whatever comes of it
    with pytest.warns(RuntimeWarning, match=TOO_STIFF) as told:
        sw.frequency_response(stiff, [500.0, 50.0], 1e-3, **loose)
    assert [warning.filename for warning in told] == [__file__]
    sw.frequency_response(stiff, 500.0, 1e-3, **loose)  # of which 64 steps are short enough


def test_a_fit_in_steps_too_long_for_the_bristles_is_warned_of() -> None:
    stiff = on_bristles(1e5)
    log = sw.simulate(stiff, command(0.02)).select(["time", "command", "input_angle", "torque"])
    with pytest.warns(RuntimeWarning, match=TOO_STIFF) as told:
        sw.fit(stiff, log, ["gear.damping"])
    assert [warning.filename for warning in told] == [__file__]
    sw.fit(stiff, log, ["gear.damping"], dt=5e-5)


# Tolerances


@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize("drive", [SMOOTH, STICKING, DRIVE], ids=["smooth", "sticking", "reference"])
def test_the_adaptive_method_keeps_its_tolerance_and_wastes_little(drive: sw.drives.PositionDrive, rtol: float) -> None:
    exact = sw.simulate_adaptively(drive, command(0.3), rtol=1e-11)
    error = difference(sw.simulate_adaptively(drive, command(0.3), rtol=rtol), exact)
    assert 1e-4 * rtol < error < 10.0 * rtol


def steps_taken(run: sw.Run) -> int:
    return int(run.method.rpartition(": ")[2].split()[0])


@pytest.mark.parametrize("drive", [SMOOTH, STICKING, DRIVE], ids=["smooth", "sticking", "reference"])
def test_what_is_tolerated_besides_is_kept_and_saves_steps(drive: sw.drives.PositionDrive) -> None:
    """Each angle, speed and torque within `rtol` of its largest plus `atol` in its own unit."""
    exact = sw.simulate_adaptively(drive, command(0.2), rtol=1e-10)
    runs = {atol: sw.simulate_adaptively(drive, command(0.2), rtol=1e-8, atol=atol) for atol in (1e-12, 1e-6, 1e-4, 1e-2)}
    for atol, run in runs.items():
        tolerated = {name: 1e-8 * np.abs(exact[name]).max() + atol for name in COLUMNS}
        errors = [np.abs(run[name] - exact[name]).max() / tolerated[name] for name in COLUMNS]
        assert 1e-3 < max(errors) < 10.0, atol
    steps = [steps_taken(run) for run in runs.values()]
    assert all(fewer < 0.75 * more for more, fewer in pairwise(steps))


def resolvable(drive: sw.drives.PositionDrive, rtol: float, voltage: float = 12.0) -> sw.Run:
    try:
        return sw.simulate_adaptively(drive, sw.scenario.sine(voltage, 50.0, 0.02), rtol=rtol, load_torque=2.0)
    except (ValueError, FloatingPointError) as error:  # said, and not this test's matter
        assume("lies outside of" not in str(error) and "no step is short enough" not in str(error))
        raise


def check_tolerance(drive: sw.drives.PositionDrive) -> None:
    """The error is ten times the tolerance at most, or ten times what a change of the voltage by as much makes.

    A drive that is about to lock or to break away magnifies both.
    """
    assume(cannot_create_energy(drive.gear))
    assume(max(_core.vibration(drive, 1e-3), _core.bristle_vibration(drive)) < 1e4)
    exact = resolvable(drive, 1e-8)
    magnified = max(difference(resolvable(drive, 1e-8, 12.0 * (1.0 + change)), exact) for change in (-1e-5, 1e-5))
    assert difference(resolvable(drive, 1e-5), exact) < 10.0 * max(1e-5, magnified)


@pytest.mark.parametrize(("part", "model"), EVERY_PART)
@settings(max_examples=3, derandomize=True, suppress_health_check=[HealthCheck.filter_too_much])
@given(data=st.data())
def test_the_tolerance_is_kept_with_any_law_at_any_place(part: str, model: Any, data: st.DataObject) -> None:
    law = data.draw(laws(part, model))
    # Friction that changes within 0.01 rad/s or a microradian by more than drives the shaft makes every run a matter of chance.
    assume(getattr(innermost(law), "stribeck_speed", 1.0) >= 1.0)
    assume(getattr(innermost(law), "presliding", 1.0) > 1e-4)
    check_tolerance(EVERYTHING.replace(gear=EVERYTHING.gear.replace(**{part: law})))


@pytest.mark.parametrize("rtol", [1e-4, 4.6e-5, 2.2e-5, 1e-5, 4.6e-6, 2.2e-6, 1e-6])
def test_the_tolerance_is_kept_where_the_torque_turns_over_within_a_step(rtol: float) -> None:
    """A hysteresis of an ounce-inch turns over within a microradian, a hundredth of what the twist moves in a step."""
    sudden = sw.hysteresis.BoucWen(stiffness=2.8e5, saturation=0.1, sharpness=60.0)
    check = SMOOTH.replace(gear=SMOOTH.gear.replace(hysteresis=sudden))
    exact, run = (sw.simulate_adaptively(check, command(0.1), rtol=share * rtol, atol=1e-15) for share in (1e-4, 1.0))
    assert difference(run, exact) < 10.0 * rtol


@pytest.mark.parametrize("rtol", [3e-5, 1e-5, 3e-6, 1e-6])
def test_what_slips_for_a_moment_where_the_torque_turns_over_is_not_missed(rtol: float) -> None:
    """A gear that locks itself holds nothing while it bears nothing: each time, its load moves on by half a nanoradian."""
    locking = sw.friction.LoadDependent(
        driving_forward=100.0, driving_reverse=100.0, backdriving_forward=100.0, backdriving_reverse=100.0
    )
    gear = sw.Gear(friction_input=sw.friction.Viscous(viscous=1e-4), friction_output=locking, damping=4.0)
    drive = sw.drives.PositionDrive(gear=gear, load=sw.loads.Inertia(inertia=0.1))
    swing = sw.scenario.sine(24.0, 30.0, 0.06)
    exact, run = (
        sw.simulate_adaptively(drive, swing, rtol=each, atol=1e-15, load_torque=-6.0)["output_angle"] for each in (1e-10, rtol)
    )
    assert np.unique(exact.round(13)).size >= 5
    assert np.abs(run - exact).max() < 10.0 * rtol * np.abs(exact).max()


@pytest.mark.parametrize("first", range(0, 500, 100))
def test_the_tolerance_is_kept_with_random_laws_at_all_places(first: int) -> None:
    """By four drives from each; `python -m tests.tolerance` takes two hundred, and says what is set aside and why."""
    verdicts = until(4, map(verdict, count(first)))
    assert [one for one in verdicts if one.missed] == []


@pytest.mark.parametrize("sample", [1e-3, 7e-5, 0.03])
def test_samples_lie_anywhere_within_steps(sample: float) -> None:
    """Between the ends of steps a sample is as exact as at them."""
    exact = sw.simulate(SMOOTH, command(0.15), 5e-6, sample=sample)
    run = sw.simulate_adaptively(SMOOTH, command(0.15), rtol=1e-8, sample=sample)
    assert np.array_equal(run["time"], exact["time"])
    assert difference(run, exact) < 1e-7


def test_an_input_that_varies_within_a_step_is_followed() -> None:
    """A load of 200 Hz, and one that jumps."""
    load = sw.scenario.sine(20.0, 200.0, 0.1) + sw.scenario.step(5.0, 0.1, start=0.0333)
    exact = sw.simulate(SMOOTH, command(0.1), 2e-6, sample=1e-3, load_torque=load)
    assert difference(sw.simulate_adaptively(SMOOTH, command(0.1), rtol=1e-7, load_torque=load), exact) < 1e-6


def test_what_cannot_be_a_tolerance_is_refused() -> None:
    for rtol in (0.0, 1e-12, 0.1, float("nan")):
        with pytest.raises(ValueError, match=r"^rtol = .* must lie in \[1e-11, 0\.01\]$"):
            sw.simulate_adaptively(DRIVE, command(0.1), rtol=rtol)
    with pytest.raises(ValueError, match=r"^atol = 0\.0 must lie in \(0, inf\)$"):
        sw.simulate_adaptively(DRIVE, command(0.1), atol=0.0)


def test_a_run_that_needs_more_steps_than_allowed_says_how_far_they_led_and_what_is_fast() -> None:
    """The gear at rest: 1.2e4 + 3e3 N.m/rad between 0.5 kg.m2 and 1e-4 kg.m2 times 100 squared; bristles of 50 N.m/rad."""
    run = sw.simulate_adaptively(DRIVE, command(0.1))
    taken = steps_taken(run)
    assert sw.simulate_adaptively(DRIVE, command(0.1), most_steps=taken) == run
    words = (
        r"^all steps that most_steps allows lead to t = 0\.09\d* s only; .*"
        rf" the gear vibrates at {np.sqrt(1.5e4 * 3.0):.4g} rad/s at rest,"
        rf" a shaft on its bristles at {np.sqrt(50.0 / 1e-4):.4g} rad/s$"
    )
    with pytest.raises(FloatingPointError, match=words):
        sw.simulate_adaptively(DRIVE, command(0.1), most_steps=taken - 1)
    with pytest.raises(ValueError, match=r"^most_steps = 0 must be 1 or more$"):
        sw.simulate_adaptively(DRIVE, command(0.1), most_steps=0)


# Sticking

COULOMB = sw.friction.Coulomb(coulomb=0.03, breakaway=0.045)
HOLDING = {
    "coulomb": COULOMB,
    "stribeck": sw.friction.Stribeck(coulomb=0.03, breakaway=0.045, stribeck_speed=2.0),
    "position_dependent": sw.friction.PositionDependent(
        quadratic=0.0, linear=0.0, constant=0.04, cosine=[0.01], sine=[0.005], outside="clamp"
    ),
    "load_dependent": sw.friction.LoadDependent(
        driving_forward=1.5, driving_reverse=1.5, backdriving_forward=1.5, backdriving_reverse=1.5
    ),
    "cyclic": sw.friction.Cyclic(law=COULOMB, order=[2.0], amplitude=[0.2], phase=[0.3]),
    "thermal": sw.friction.Thermal(law=COULOMB, dry_fall=0.01, reference_temperature=300.0),
}  # of the input's scale
OUTPUT_SCALE = 100.0
EVERY_OUTPUT = [name for name, _, _ in _core.outputs]


def test_every_law_that_can_hold_is_among_those_held_here() -> None:
    kinds = _core.families["friction"].items()
    assert set(HOLDING) == {
        name for name, kind in kinds if kind().set_valued or any(field["kind"] == "part" for field in kind.fields)
    }
    assert all(law.set_valued for law in HOLDING.values())


def scaled(law: Any, factor: float) -> Any:
    """With all torques multiplied."""
    if hasattr(law, "law"):
        return law.replace(law=scaled(law.law, factor))
    torques = [field["name"] for field in law.fields if field["unit"] == "N.m"]
    return law.replace(**{name: factor * np.array(getattr(law, name)) for name in torques})


def held(place: str, law: Any) -> sw.drives.PositionDrive:
    """Both sides can stick, of which one by this law, with error and hysteresis; the current follows the voltage at once."""
    output = scaled(COULOMB, OUTPUT_SCALE)
    friction = {"friction_input": COULOMB if place == "friction_output" else sw.friction.Viscous(), "friction_output": output}
    friction[place] = law if place == "friction_input" else scaled(law, OUTPUT_SCALE)
    return DRIVE.replace(
        gear=DRIVE.gear.replace(**friction),
        motor=DRIVE.motor.replace(inductance=0.0),
        control=sw.control.OpenLoop(),
        load=sw.loads.Inertia(inertia=0.5),
    )


every_hold = pytest.mark.parametrize("law", HOLDING.values(), ids=HOLDING)
every_place = pytest.mark.parametrize("place", ["friction_input", "friction_mesh", "friction_output"])


def by_every_method(drive: sw.drives.PositionDrive, voltage: sw.scenario.Scenario, **others: Any) -> dict[str, sw.Recording]:
    runs: dict[str, sw.Recording] = {method: sw.simulate(drive, voltage, method=method, **others) for method in METHODS}
    runs["adaptive"] = sw.simulate_adaptively(drive, voltage, **{"sample": 2e-4} | others)
    return runs


def in_a_pack(drive: sw.drives.PositionDrive, voltage: sw.scenario.Scenario, **others: Any) -> dict[str, sw.Recording]:
    """Members that differ, so that the events of one fall into the rest of another."""
    inertia = {"load.inertia": np.linspace(0.4, 0.6, 11)}
    many = sw.simulate_many(drive, voltage, inertia, record=EVERY_OUTPUT, **others)
    return {f"member {member}": many.member(member) for member in range(len(many))}


def check_constant(runs: dict[str, sw.Recording]) -> None:
    for way, run in runs.items():
        for name in EVERY_OUTPUT:
            assert len(set(run[name].tolist())) == 1, (way, name)


@pytest.mark.parametrize("level", [0.0, 0.9])
def test_below_breakaway_every_state_is_constant_to_the_last_bit(level: float) -> None:
    """Both shafts held, a load and a voltage applied: nothing moves at all."""
    drive = held("friction_input", COULOMB)
    volts = level * 0.045 * drive.motor.resistance / drive.motor.torque_constant
    excited: dict[str, Any] = {"voltage": sw.scenario.constant(volts, 0.1), "load_torque": level * 4.5}
    runs = by_every_method(drive, **excited) | in_a_pack(drive, **excited)
    check_constant(runs)
    for run in runs.values():
        assert run["friction_input"][-1] == pytest.approx(level * 0.045, rel=1e-12)
        assert run["friction_output"][-1] == pytest.approx(-level * 4.5, rel=1e-12)


@every_hold
@every_place
def test_a_twist_that_is_held_stays_to_the_last_bit(place: str, law: Any) -> None:
    """The wound-up gear drives both sides; what it bears is what a load-dependent law holds with."""
    drive = held(place, law)
    rest = drive.rest()
    start = rest.replace(motion=rest.motion.replace(transmission_error=rest.motion.transmission_error + 2e-4))
    runs = by_every_method(drive, sw.scenario.constant(0.05, 0.1), start=start, load_torque=2.0)
    check_constant(runs)
    for run in runs.values():
        assert run["torque"][0] == pytest.approx(1.2e4 * 2e-4 + 1e9 * 2e-4**3 + 0.43, abs=0.1)
        assert run["friction_output"][0] == pytest.approx(run["torque"][0] - 2.0, rel=1e-12)


def to_and_fro_and_off(rest: float) -> sw.scenario.Scenario:
    """Two pulses of voltage, a while of little, and a third pulse."""
    pulses = [sw.scenario.step(height, 0.3, start=start) for height, start in ((8.0, 0.02), (-8.0, 0.05), (8.0, 0.2))]
    return sw.scenario.constant(rest, 0.3) + pulses[0] + pulses[1] + pulses[2]


@every_hold
@every_place
def test_from_sticking_to_breakaway_no_state_changes_by_a_bit(place: str, law: Any) -> None:
    """Under a load, after a motion that left the gear twisted: of a side alone its angle, of both all that is recorded."""
    arguments: dict[str, Any] = {"voltage": to_and_fro_and_off(0.05), "load_torque": 1.0}
    drive = held(place, law)
    for way, run in (by_every_method(drive, **arguments) | in_a_pack(drive, **arguments)).items():
        still = {side: run[f"{side}_speed"] == 0.0 for side in ("input", "output")}
        stays = {side: rests[:-1] & rests[1:] for side, rests in still.items()}
        both = stays["input"] & stays["output"]
        middle = slice(500, 1000)  # between the second pulse and the third
        assert np.count_nonzero(both[middle]) > 10, way
        assert np.all(np.abs(run["torque"][:-1][middle][both[middle]]) > 1e-3), way
        assert np.count_nonzero(np.diff(still["input"])) >= 3, way
        assert not np.diff(run["input_angle"])[stays["input"]].any(), way
        for name in EVERY_OUTPUT:
            assert not np.diff(run[name])[both].any(), (way, name)


# Events


def test_the_moment_of_an_event_is_found_just_behind_it_in_few_looks(tmp_path: Path) -> None:
    """Every margin falls to zero at 0.3. Secants come within 1e-12 of it in a few looks where it is smooth; where it jumps or
    is the same at first, twenty are tried in vain, and bisection takes another 40."""
    most_looks = dict.fromkeys(["jump", "jump_down", "plateau"], 60)
    *found, nowhere = told("crossing", tmp_path)
    assert len(found) == 9
    for name, moment, looks, in_a_pack in found:
        assert 0.3 <= float(moment) < 0.3 + 3e-12, name
        assert int(looks) <= most_looks.get(name, 15), name
        assert in_a_pack == moment, name
    assert nowhere == ["nowhere", "1", "0", "1"]


# Chattering

MOST_EVENTS = 16  # of a step, before what is left of it is time-stepping


def told(name: str, folder: Path) -> list[list[str]]:
    """The words of each line that a program beside this file prints."""
    source = Path(__file__).with_name(f"{name}.cpp")
    options = (*STRICT, "-Og", "-ffp-contract=off")
    assert compilation(compiler("g++"), folder, {source.name: source.read_text()}, *options) == (0, "")
    subprocess.run(["g++", f"{name}.o", "-o", name], cwd=folder, check=True)
    printed = subprocess.run([folder / name], capture_output=True, text=True, check=True, timeout=30).stdout
    return [line.split() for line in printed.splitlines()]


@pytest.fixture(scope="module")
def chattering(tmp_path_factory: pytest.TempPathFactory) -> list[list[float]]:
    """What the program tells that counts events: most in a step and calls of time-stepping, then the motion at the end."""
    return [[float(number) for number in line] for line in told("chattering", tmp_path_factory.mktemp("chattering"))]


def test_a_drive_without_chattering_is_never_time_stepped(chattering: list[list[float]]) -> None:
    for events, arrivals, *_ in chattering[:4]:
        assert 1 <= events < MOST_EVENTS
        assert arrivals == 0


def test_what_chattering_leaves_of_a_step_is_one_of_second_order(chattering: list[list[float]]) -> None:
    """Events that change nothing, without end where the input stands beyond a wall: as many as may be, and a right end."""
    exact, chatters = np.array(chattering[3][3:]), np.array(chattering[4:8])  # all but the current, which is no state here
    assert np.all(chatters[:, 0] == MOST_EVENTS)
    assert np.all(chatters[:, 1] == 2)  # to the middle, and to the end
    errors = np.abs(chatters[:, 3:] / exact - 1.0).max(axis=1)
    np.testing.assert_allclose(np.log2(errors[:-1] / errors[1:]), 2.0, atol=0.1)


def test_members_that_chatter_are_what_they_are_alone_and_disturb_no_other(chattering: list[list[float]]) -> None:
    """Eight, of which six chatter from different moments on; the program tells how many numbers differ."""
    assert chattering[8] == [0.0]


def test_no_adaptive_step_goes_on_after_an_event(chattering: list[list[float]]) -> None:
    """Of a drive that sticks and slips, and of four hundred that had all but settled when the inputs jumped."""
    assert chattering[9][0] == 0.0
    assert chattering[11] == [0.0]


def test_adaptive_steps_that_chatter_keep_the_tolerance_with_an_event_each(chattering: list[list[float]]) -> None:
    """Each look for an event that comes at once is one; sixteen before the first step, then one before each."""
    (_, calm_events, _, _, *exact), (_, events, accepted, rejected, *found) = chattering[9:11]
    assert calm_events < MOST_EVENTS
    assert MOST_EVENTS < events < MOST_EVENTS + accepted + rejected
    np.testing.assert_allclose(found, exact, rtol=1e-5)
