"""Fading memory: its branches, its energy, and the closed forms of its cycles."""

from __future__ import annotations

import math
from collections.abc import Sequence
from decimal import Decimal, localcontext

import numpy as np
import pytest
from hypothesis import given, strategies as st
from numpy.typing import NDArray
from scipy.integrate import quad
from strainwave.hysteresis import FadingMemory

from tests.support.strategies import log_uniform

Array = NDArray[np.float64]

stiffnesses = log_uniform(1e1, 1e5)
rates = log_uniform(1e1, 1e4)
branches = st.lists(st.tuples(stiffnesses, rates), min_size=1, max_size=8)
travels = st.lists(st.floats(-3.0, 3.0), min_size=1, max_size=8)


def law_of(pairs: Sequence[tuple[float, float]]) -> FadingMemory:
    return FadingMemory(stiffness=[a for a, _ in pairs], forgetting=[b for _, b in pairs])


def saturation(pairs: Sequence[tuple[float, float]]) -> float:
    return sum(a / b for a, b in pairs)


def path_of(pairs: Sequence[tuple[float, float]], travel: Sequence[float]) -> Array:
    """From rest, scaled by how fast the fastest branch forgets."""
    return np.append(0.0, np.cumsum(travel)) / max(b for _, b in pairs)


@given(stiffnesses, rates, log_uniform(1e-2, 1e1))
def test_a_steady_cycle_has_the_height_and_the_loss_of_its_closed_form(stiffness: float, rate: float, far: float) -> None:
    """T_max = (A / alpha) tanh(alpha X), loss (4 A / alpha) (X - tanh(alpha X) / alpha)."""
    law, limit, amplitude = FadingMemory(stiffness=stiffness, forgetting=rate), stiffness / rate, far / rate
    cycles = round(40.0 / far) + 1
    path = np.append(0.0, np.tile([amplitude, -amplitude], cycles))
    torque, work = law.trace(path), law.work(path)
    assert torque[-2:] == pytest.approx([limit * math.tanh(far), -limit * math.tanh(far)], rel=1e-13 * cycles)
    loss = 4.0 * limit * (amplitude - math.tanh(far) / rate)
    assert work[-1] - work[-3] == pytest.approx(loss, rel=0.0, abs=1e-14 * work[-1] + 1e-14 * limit * amplitude * cycles)


@given(branches, travels)
def test_branches_add_up(pairs: list[tuple[float, float]], travel: list[float]) -> None:
    path = path_of(pairs, travel)
    alone = [FadingMemory(stiffness=a, forgetting=b) for a, b in pairs]
    law = law_of(pairs)
    for verb in ("trace", "work", "stored"):
        together = sum(getattr(one, verb)(path) for one in alone)
        scale = float(np.abs([getattr(one, verb)(path) for one in alone]).sum(axis=0).max())
        np.testing.assert_allclose(getattr(law, verb)(path), together, rtol=0.0, atol=1e-14 * scale)


@given(stiffnesses, rates, st.floats(-0.999, 0.999), log_uniform(1e-12, 1e3))
def test_torque_and_work_keep_their_digits_on_steps_of_any_size(
    stiffness: float, rate: float, share: float, far: float
) -> None:
    """Against forty digits. Written as 1 - exp(-x), the work of a short step from rest would have none."""
    law, held, step = FadingMemory(stiffness=stiffness, forgetting=rate), share * stiffness / rate, far / rate
    with localcontext() as context:
        context.prec = 60
        a, b, start, x = (Decimal(number) for number in (stiffness, rate, held, step))
        left = (-b * x).exp()
        torque = a / b + (start - a / b) * left
        work = a / b * x + (start - a / b) * (1 - left) / b
        virgin_work = a / b * (x - (1 - left) / b)
    state = FadingMemory.State(held=[held] + [0.0] * 7)
    assert law.trace([0.0, step], state=state)[-1] == pytest.approx(float(torque), rel=0.0, abs=1e-15 * stiffness / rate)
    assert law.work([0.0, step], state=state)[-1] == pytest.approx(float(work), rel=0.0, abs=1e-15 * stiffness / rate * step)
    assert law.work([0.0, step])[-1] == pytest.approx(float(virgin_work), rel=3e-15)


@given(branches, travels, st.integers(2, 200))
def test_a_step_may_be_divided(pairs: list[tuple[float, float]], travel: list[float], parts: int) -> None:
    law, path = law_of(pairs), path_of(pairs, travel)
    shares = np.arange(parts) / parts
    fine = np.append((path[:-1, None] + np.diff(path)[:, None] * shares).ravel(), path[-1])
    slack = 1e-15 * len(fine) + 4e-16 * sum(a for a, _ in pairs) * float(np.abs(path).max()) / saturation(pairs)
    np.testing.assert_allclose(law.trace(fine)[::parts], law.trace(path), rtol=0.0, atol=slack * saturation(pairs))
    reach = float(np.abs(np.diff(path)).sum())
    np.testing.assert_allclose(law.work(fine)[::parts], law.work(path), rtol=0.0, atol=slack * saturation(pairs) * reach)


@given(branches, travels)
def test_the_energy_held_is_that_of_the_branches_and_the_rest_is_lost(
    pairs: list[tuple[float, float]], travel: list[float]
) -> None:
    """Lost per twist travelled: sum of alpha T^2 / A, by quadrature."""
    law, path = law_of(pairs), path_of(pairs, travel)
    work, stored = law.work(path), law.stored(path)
    scale = 1e-13 * saturation(pairs) * float(np.abs(np.diff(path)).sum())
    assert np.diff(work - stored).min() >= -scale
    state = law.advance(path[:-1])
    held, last = np.array(state.held)[: len(pairs)], float(path[-1] - path[-2])
    assert law.stored(path)[-2] == pytest.approx(sum(t**2 / (2.0 * a) for t, (a, _) in zip(held, pairs, strict=True)))

    def lost(u: float) -> float:
        settled = [math.copysign(a / b, last) for a, b in pairs]
        along = [s + (t - s) * math.exp(-b * u) for s, t, (_, b) in zip(settled, held, pairs, strict=True)]
        return sum(b * t**2 / a for t, (a, b) in zip(along, pairs, strict=True))

    expected = quad(lost, 0.0, abs(last), epsabs=scale, epsrel=1e-12, limit=200)[0]
    assert np.diff(work - stored)[-1] == pytest.approx(expected, rel=1e-10, abs=10.0 * scale)


@given(branches, travels)
def test_what_happened_long_ago_is_forgotten(pairs: list[tuple[float, float]], travel: list[float]) -> None:
    history, far = path_of(pairs, travel), 50.0 / min(b for _, b in pairs)
    torque = law_of(pairs).trace(np.append(history, history[-1] + far))
    assert torque[-1] == pytest.approx(saturation(pairs), rel=1e-14)


def test_two_branches_leave_the_torque_of_their_kernel() -> None:
    """Phi(u) = 1000 e^(-2000 u) + 300 e^(-50 u), integrated over the path with the sign of its motion."""
    law = FadingMemory(stiffness=[1000.0, 300.0], forgetting=[2000.0, 50.0])

    def kernel(u: float) -> float:
        return 1000.0 * math.exp(-2000.0 * u) + 300.0 * math.exp(-50.0 * u)

    forth, back = 0.002, 0.0005
    recent = quad(kernel, 0.0, back, epsrel=1e-13)[0]
    older = quad(kernel, back, back + forth, epsrel=1e-13)[0]
    assert law.trace([0.0, forth, forth - back])[-1] == pytest.approx(older - recent, rel=1e-12)


def test_without_branches_there_is_no_hysteresis() -> None:
    law = FadingMemory()
    assert law.trace([0.0, 1.0, -1.0]).tolist() == [0.0, 0.0, 0.0]
    assert law.work([0.0, 1.0, -1.0]).tolist() == [0.0, 0.0, 0.0]


def test_every_branch_needs_both_numbers() -> None:
    with pytest.raises(ValueError, match="equally many"):
        FadingMemory(stiffness=[1000.0, 300.0], forgetting=[2000.0])
