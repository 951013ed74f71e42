"""A few of the random drives of tests/evidence/stress.py, which runs them by the thousand."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from strainwave import _core
from strainwave.simulation.excitation import Excitation

from tests.evidence.stress import WRONG, check, model, outcome, outcomes
from tests.support.strategies import models_of
from tests.support.workers import HANGS


@pytest.mark.parametrize("number", [*range(10), 64311])
def test_a_random_drive_ends_in_numbers_or_with_a_reason_and_is_in_a_pack_what_it_is_alone(number: int) -> None:
    """In 64311 the noise grows with the speed, so that a trial step goes further than an angle has digits."""
    found = outcome(number)
    assert not found.wrong, found.said


@pytest.mark.slow("physics")
def test_random_drives_hold_every_model_of_every_list_between_them() -> None:
    found = set().union(*(models_of(model(sw.Drive, np.random.default_rng(number))) for number in range(400)))
    assert {one.__name__ for models in _core.families.values() for one in models.values()} - found == set()


@pytest.mark.slow("physics")
def test_a_drive_that_takes_too_long_is_given_up_and_the_next_begun() -> None:
    """Here all do: a process that is no more answers for its drive."""
    assert [(one.number, one.said, one.wrong) for one in outcomes([3, 4], processes=1, limit=1e-3)] == [
        (number, {"any": WRONG + HANGS}, True) for number in (3, 4)
    ]


def test_outcomes_from_other_processes_are_those_of_their_drives() -> None:
    assert {one.number: one.said for one in outcomes(range(3), processes=1)} == {n: outcome(n).said for n in range(3)}


FRICTION = sw.friction.Coulomb(coulomb=0.01, breakaway=0.02)
SLIDING = sw.Drive(gear=sw.Gear(friction_input=FRICTION))


@pytest.mark.parametrize(
    ("column", "said"),
    [
        ("current", "current at the end is not that of the state"),
        ("twist", "angles do not add up"),
        ("friction_input", "friction_input drives"),
    ],
)
def test_a_recording_that_contradicts_itself_is_told(column: str, said: str) -> None:
    """A run that is right, and the same with a column turned round; its end too but where the end is looked at."""
    volts = Excitation(sw.scenario.constant(1.0, 0.01))
    run = sw.simulate(SLIDING, volts.command, 1e-4)
    inputs = volts.over(volts.time_grid(1e-4, None).instants)[-1, -1]
    check(SLIDING, run, inputs)
    turned = {name: -run[name] if name == column else run[name].copy() for name in run.names}
    if column != "current":
        turned[column][-1] = run[column][-1]
    with pytest.raises(AssertionError, match=f"^WRONG: {said}$"):
        check(SLIDING, sw.Run(turned, run.units, run.end, run.method), inputs)


@pytest.mark.parametrize(
    ("column", "said"),
    [
        ("power_friction_input", "friction_input has another power"),
        ("energy_motor", "energy_motor at the start"),
        ("power_damping", "power_damping is negative"),
        ("stored_output", "stored_output is negative"),
    ],
)
def test_powers_and_energies_that_cannot_be_are_told(column: str, said: str) -> None:
    """A run that is right, and the same with a column less than it was; its end left as it is."""
    metered = SLIDING.replace(gear=SLIDING.gear.replace(damping=1.0), meter=sw.meter.EnergyMeter())
    volts = Excitation(sw.scenario.constant(1.0, 0.01))
    run = sw.simulate(metered, volts.command, 1e-4)
    inputs = volts.over(volts.time_grid(1e-4, None).instants)[-1, -1]
    check(metered, run, inputs)
    changed = {name: run[name].copy() for name in run.names}
    changed[column][:-1] -= 1e-3
    with pytest.raises(AssertionError, match=f"^WRONG: {said}$"):
        check(metered, sw.Run(changed, run.units, run.end, run.method), inputs)


def test_what_sticks_and_moves_is_told() -> None:
    volts = Excitation(sw.scenario.constant(1.0, 0.01))
    run = sw.simulate(SLIDING, volts.command, 1e-4)
    held = sw.Run({name: run[name] for name in run.names}, run.units, run.end.replace(input_slip_direction=0.0), run.method)
    with pytest.raises(AssertionError, match=r"^WRONG: the input sticks and moves$"):
        check(SLIDING, held, volts.over(volts.time_grid(1e-4, None).instants)[-1, -1])


def test_a_number_that_nobody_records_and_that_diverges_is_told() -> None:
    """A delay no number is as short as: only the state of the sensor shows it."""
    late = sw.sensor.Delayed(law=sw.sensor.Ideal(), delay=1.2e-38)
    drive = SLIDING.replace(sensors=sw.Sensors(input_angle=late))
    with pytest.raises(FloatingPointError):
        sw.simulate_adaptively(drive, sw.scenario.constant(1.0, 0.01), 1e-4)
