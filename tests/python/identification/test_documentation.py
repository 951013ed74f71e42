"""The numbers that the page on identification states are those of the code."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from strainwave.identification.candidates import motion_model
from strainwave.identification.checks import comparisons, logs, sizes, unexplained
from strainwave.identification.experiments import motion_log
from strainwave.identification.fitting import influence
from strainwave.identification.kinds import along_motion, torsion_loop
from strainwave.identification.results import combined_parameter, file_result, identifiability

PAGE = " ".join(Path(__file__).parents[3].joinpath("docs", "reference", "identify.md").read_text(encoding="utf-8").split())
NUMBERS = ("no", "one", "two", "three", "four", "five")


def percent(share: float) -> str:
    return f"{100.0 * share:g} %"


@pytest.mark.parametrize(
    "statement",
    [
        f"kept parameters may change it by more than {percent(identifiability.MAX_RELATIVE_SHIFT)}",
        f"kept parameters that move it by more than {percent(identifiability.MIN_SHIFT_LISTED)}",
        f"would change this one by more than {percent(identifiability.MAX_SHIFT_BY_WRONG)}",
        f"standard deviation exceeds half the value (of a phase: {identifiability.MAX_SIGMA_OF_PHASE:g} rad)",
        f"else {percent(influence.SIGMA_IF_NOT_STATED)}, and "
        f"{percent(influence.SIGMA_IF_ASSUMED)} where its source begins with",
        f"differ by more than {NUMBERS[int(combined_parameter.MAX_DISTANCE)]} standard deviations",
        f"more is left than {percent(unexplained.MAX_SHARE_OF_MOTION)} of an angle, a speed or a loop, "
        f"{percent(unexplained.MAX_SHARE_OF_TORQUE)} of a friction torque or a current, "
        f"or {percent(unexplained.MAX_SHARE_OF_PRESLIDING)} of a presliding loop on held-out data",
        f"with an RMS of more than {percent(unexplained.MAX_SHARE_OF_SHAPE)} of the signal",
        f"White noise repeats as well in 1 of {1.0 / unexplained.MAX_CHANCE_OF_SHAPE:g} records",
        f"A shape of {100.0 * unexplained.MIN_SHARE_OF_SHAPE:g} to {percent(unexplained.MAX_SHARE_OF_SHAPE)} is a remark",
        f"an error on held-out data that is at least {percent(round(1.0 - torsion_loop.MAX_ERROR_OF_RICHER, 3))} smaller",
        f"more than {percent(sizes.MAX_SHARE_OF_ONE_SIZE)} of the torques of a friction table have one size",
        f"the friction is more than {sizes.MAX_FACTOR:g} times as large or small, "
        f"in a log more than {sizes.MAX_FACTOR_OF_LOG:g}",
        f"a factor of {np.exp(3.0 * sizes.MIN_SPREAD_OF_STIFFNESS):.1f} for {percent(sizes.MIN_SPREAD_OF_STIFFNESS)}",
        f"{sizes.MIN_ROWS_OF_LOG} rows or more, and the change of speed explains half of what is left",
        "the spring of a loop carries less than a fifth of the torque",
        f"stays at its end over more than {percent(sizes.MAX_CLIPPED_SHARE)} of the range of the angle",
        f"the gravity of the load is more than {comparisons.MAX_GRAVITY_OF_RATING:g} times the largest torque in the ratings",
        f"the input would turn faster than {sizes.MAX_INPUT_SPEED:g} rad/s",
        f"with {percent(comparisons.GAIN_SIGMA)} for the gain of two sensors",
        f"increased by {percent(comparisons.RUN_TO_RUN_SPREADS['friction_input'])} of friction at the input, "
        f"{percent(comparisons.RUN_TO_RUN_SPREADS['load'])} of the load and {percent(comparisons.GAIN_SIGMA)} of other numbers",
        f"less than {percent(motion_log.MIN_SHARE_OF_A_DIRECTION)} of the samples move the other way",
        f"if less than {percent(round(0.5 - 0.5 * np.sqrt(1.0 - motion_model.MIN_OWN_SHARE**2), 3))} move the other way",
        f"a probability of {percent(motion_model.MAX_CHANCE_OF_WAVE)} at most",
        f"uncertain by {percent(motion_model.BIAS_IN_FULL_BAND)} at least",
        f"a recorded speed is more than {logs.MAX_SPEED_FACTOR:g} times the slope of its angle",
        f"differs from that of the gear by a factor of more than {logs.MAX_SWING_ON_SPRING:g} over their correlation",
        f"A factor above {logs.MAX_RATIO_FACTOR:g} is a remark: another ratio",
        f"the log shows another one, by more than {percent(along_motion.MAX_OFF_INERTIA)}",
    ],
)
def test_a_threshold_is_stated_as_it_is(statement: str) -> None:
    assert statement in PAGE


def test_thresholds_stated_in_words_are_those() -> None:
    assert unexplained.MAX_SHARE_OF_LOOP == unexplained.MAX_SHARE_OF_MOTION
    halves = (file_result.MAX_RELATIVE_SIGMA, sizes.MAX_SHARE_BY_ACCELERATION, sizes.MAX_FRICTION_SHARE)
    assert halves == (0.5, 0.5, 1.0 - 1.0 / 5.0)
