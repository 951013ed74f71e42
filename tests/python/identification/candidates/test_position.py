"""Document P's procedure recovers parameters assumed in its form."""

from __future__ import annotations

import sys

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from strainwave.identification.candidates.position import fit_position

Array = NDArray[np.float64]

S1, S2, S3 = 1.5738e-6, -3.7901e-4, 0.0720  # printed


def truth(seed: int, viscous: float = 0.0) -> tuple[Array, sw.friction.PositionDependent]:
    """The printed average, and amplitudes that fall with the order (assumed; P prints none)."""
    random = np.random.default_rng(seed)
    fall = 0.008 / np.arange(1, 11)
    cosine, sine = fall * random.normal(size=10), fall * random.normal(size=10)
    law = sw.friction.PositionDependent(
        quadratic=S1, linear=S2, constant=S3, cosine=cosine.tolist(), sine=sine.tolist(), viscous=viscous, domain_start=0.0,
        domain_end=240.82,
    )  # fmt: skip
    return np.array([S1, S2, S3, *cosine, *sine]), law


def level(numbers: Array, angle: Array) -> Array:
    """P's equations, written out."""
    s1, s2, s3 = numbers[:3]
    k = np.arange(1, 11)[:, np.newaxis]
    return np.asarray(s1 * angle**2 + s2 * angle + s3 + numbers[3:13] @ np.cos(k * angle) + numbers[13:] @ np.sin(k * angle))


def run(angle: Array, torque: Array, **more: Array) -> sw.Recording:
    units = {"angle": "rad", "torque": "N.m"} | dict.fromkeys(more, "rad/s")
    return sw.Recording({"angle": angle, "torque": torque, **more}, units)


def off(seed: int) -> Array:
    """Of a run over 19.7 turns, with noise of P's own RMSE."""
    numbers, _ = truth(seed)
    angle = np.linspace(30.0, 30.0 + 19.7 * 2.0 * np.pi, 1500)
    torque = level(numbers, angle) + 5.2e-3 * np.random.default_rng(1000 + seed).normal(size=len(angle))
    found = fit_position(run(angle, torque))
    return np.array([(each.value - value) / each.sigma for each, value in zip(found.estimates, numbers, strict=True)])


def test_the_procedure_recovers_assumed_parameters_as_well_as_it_says() -> None:
    table = np.array([off(seed) for seed in range(50)])
    assert np.mean(np.abs(table) <= 2.0) >= 0.9
    scatter = np.sqrt(np.mean(table**2, axis=0))
    assert np.all((scatter > 0.7) & (scatter < 1.4)), scatter


def test_integrals_over_whole_turns_and_least_squares_find_the_same_without_noise() -> None:
    numbers, law = truth(1)
    angle = np.linspace(0.0, 20.0 * 2.0 * np.pi, 8001)
    found = fit_position(run(angle, level(numbers, angle)))
    assert [each.value for each in found.estimates] == pytest.approx(numbers.tolist(), rel=1e-9, abs=1e-12)
    assert found.law.steady(1.0, angle=100.0) == pytest.approx(law.steady(1.0, angle=100.0), rel=1e-10)
    whole = found.integrated
    assert whole is not None
    assert [whole.quadratic, whole.linear, whole.constant] == pytest.approx([S1, S2, S3], rel=1e-3)
    assert [*whole.cosine, *whole.sine] == pytest.approx(numbers[3:].tolist(), abs=3e-5)


def test_part_of_a_turn_at_the_end_does_not_shift_least_squares() -> None:
    numbers, _ = truth(2)
    angle = np.linspace(0.0, 3.4 * 2.0 * np.pi, 2000)
    found = fit_position(run(angle, level(numbers, angle)))
    assert [each.value for each in found.estimates] == pytest.approx(numbers.tolist(), rel=1e-7, abs=1e-9)


def test_runs_at_several_speeds_tell_the_viscous_part_and_both_directions_agree() -> None:
    numbers, law = truth(3, viscous=4e-4)
    runs = []
    for v in (0.8, 20.0, -50.0):
        angle = np.linspace(0.0, 60.0, 1500)[:: int(np.sign(v))]
        torque = np.sign(v) * (level(numbers, angle) + 4e-4 * abs(v))
        runs.append(run(angle, torque, speed=np.full(1500, v)))
    found = fit_position(runs)
    assert found.estimates[-1].path == "viscous"
    assert found.law.steady([0.8, -50.0], angle=20.0) == pytest.approx(law.steady([0.8, -50.0], angle=20.0), rel=1e-8)


def test_an_encoder_that_begins_anew_with_each_turn_is_followed() -> None:
    numbers, _ = truth(4)
    angle = np.linspace(0.0, 40.0, 3000)
    wrapped = fit_position(run(np.remainder(angle, 2.0 * np.pi), level(numbers, angle)))
    assert wrapped.estimates[2].value == pytest.approx(S3, rel=1e-6)


@pytest.mark.parametrize(
    ("turns", "samples", "message"),
    [(0.8, 500, r"cover 0\.80 turns"), (30.0, 300, "300 samples over 30.0 turns do not separate 10 orders")],
)
def test_too_little_is_refused(turns: float, samples: int, message: str) -> None:
    angle = np.linspace(0.0, turns * 2.0 * np.pi, samples)
    with pytest.raises(ValueError, match=message):
        fit_position(run(angle, 0.07 + 0.0 * angle))


if __name__ == "__main__":
    table = np.array([off(seed) for seed in range(int(sys.argv[1]))])
    print(np.mean(np.abs(table) <= 2.0, axis=0).round(2), np.sqrt(np.mean(table**2, axis=0)).round(2))
