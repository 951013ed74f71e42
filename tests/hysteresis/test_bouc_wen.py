"""Bouc-Wen against its closed forms, against its differential equation, and against the laws it contains."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given, strategies as st
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.special import hyp2f1
from strainwave.hysteresis import BoucWen, FadingMemory, MaxwellSlip

from tests.support.strategies import log_uniform, made

Array = NDArray[np.float64]

laws = st.builds(
    BoucWen,
    stiffness=log_uniform(1e1, 1e5),
    saturation=log_uniform(1e-2, 1e2),
    sharpness=st.sampled_from([1.0, 2.0, 3.0]) | log_uniform(1.0, 1e3),
    shape=st.sampled_from([0.5, 1.0]) | st.floats(0.5, 1.0),
)
# In units of the twist saturation / stiffness.
travels = st.lists(st.floats(-4.0, 4.0), min_size=1, max_size=8)


def reach(law: BoucWen) -> float:
    return law.saturation / law.stiffness


def path_of(law: BoucWen, travel: Sequence[float]) -> Array:
    return np.append(0.0, np.cumsum(travel)) * reach(law)


def slope(law: BoucWen, torque: float, sense: float) -> float:
    """dT / d delta as Bouc and Wen write it."""
    n = law.sharpness
    beta = law.shape * law.stiffness / law.saturation**n
    gamma = (1.0 - law.shape) * law.stiffness / law.saturation**n
    return law.stiffness - beta * sense * abs(torque) ** (n - 1.0) * torque - gamma * abs(torque) ** n


@pytest.mark.parametrize("sharpness", [1.0, 1.3, 2.0, 5.0, 30.0])
@pytest.mark.parametrize("shape", [0.5, 0.8, 1.0])
def test_it_solves_the_equation_of_bouc_and_wen(sharpness: float, shape: float) -> None:
    law = BoucWen(stiffness=1000.0, saturation=0.5, sharpness=sharpness, shape=shape)
    path = [0.0, 0.0004, 0.0001, 0.0009, -0.0007, -0.0002, 0.0]
    torque, work, expected = [0.0], [0.0], (0.0, 0.0)
    for start, end in pairwise(path):
        sense = math.copysign(1.0, end - start)
        solution = solve_ivp(
            lambda x, y, sense=sense: (slope(law, y[0], sense), y[0]),
            (start, end),
            expected,
            method="DOP853",
            rtol=1e-13,
            atol=1e-16,
            max_step=1e-6,
        )
        expected = tuple(solution.y[:, -1])
        torque.append(expected[0])
        work.append(expected[1])
    assert law.trace(path) == pytest.approx(torque, rel=0.0, abs=1e-11 * law.saturation)
    assert law.work(path) == pytest.approx(work, rel=0.0, abs=1e-11 * law.saturation * reach(law))


@given(laws, st.floats(0.01, 0.98))
def test_the_virgin_curve_is_the_inverse_of_a_hypergeometric_function(law: BoucWen, share: float) -> None:
    """A delta / T_s = v F(1, 1/n; 1 + 1/n; v^n), and twice the work likewise with 2/n, v^2."""
    n, z = law.sharpness, share**law.sharpness
    twist = reach(law) * share * hyp2f1(1.0, 1.0 / n, 1.0 + 1.0 / n, z)
    work = law.saturation * reach(law) * share**2 / 2.0 * hyp2f1(1.0, 2.0 / n, 1.0 + 2.0 / n, z)
    assert law.trace([0.0, twist])[-1] == pytest.approx(share * law.saturation, rel=2e-13)
    assert law.work([0.0, twist])[-1] == pytest.approx(work, rel=4e-13)


@given(laws, st.floats(0.01, 0.99), st.floats(0.01, 0.99))
def test_unloading_follows_the_hypergeometric_function_of_the_other_sign(law: BoucWen, start: float, end: float) -> None:
    n, reversal = law.sharpness, 2.0 * law.shape - 1.0
    start, end = max(start, end), min(start, end)

    def travelled(v: float) -> float:
        return v * hyp2f1(1.0, 1.0 / n, 1.0 + 1.0 / n, -reversal * v**n) * reach(law)

    back = travelled(start) - travelled(end)
    state = BoucWen.State(held=start * law.saturation)
    assert law.trace([0.0, -back], state=state)[-1] == pytest.approx(end * law.saturation, abs=1e-13 * law.saturation)


def test_sharpness_two_is_a_hyperbolic_tangent_and_a_tangent() -> None:
    law = BoucWen(stiffness=1000.0, saturation=0.5, sharpness=2.0, shape=1.0)
    assert law.trace([0.0, 0.0005])[-1] == pytest.approx(0.5 * math.tanh(1.0), rel=1e-15)
    assert law.work([0.0, 0.0005])[-1] == pytest.approx(0.5 * 0.0005 * math.log(math.cosh(1.0)), rel=1e-14)
    back = law.trace([0.0, 0.0005, 0.0002])[-1]
    assert back == pytest.approx(0.5 * math.tan(math.atan(math.tanh(1.0)) - 0.6), rel=1e-14)
    beyond = law.trace([0.0, 0.0005, -0.0005])[-1]
    assert beyond == pytest.approx(-0.5 * math.tanh(2.0 - math.atan(math.tanh(1.0))), rel=1e-14)


@given(log_uniform(1e1, 1e5), log_uniform(1e-2, 1e2), travels)
def test_sharpness_one_with_shape_one_is_fading_memory(stiffness: float, saturation: float, travel: list[float]) -> None:
    law = BoucWen(stiffness=stiffness, saturation=saturation, sharpness=1.0, shape=1.0)
    fading, path = FadingMemory(stiffness=stiffness, forgetting=stiffness / saturation), path_of(law, travel)
    energy = saturation * reach(law)
    np.testing.assert_allclose(law.trace(path), fading.trace(path), rtol=0.0, atol=1e-12 * saturation)
    np.testing.assert_allclose(law.work(path), fading.work(path), rtol=0.0, atol=1e-12 * energy)
    np.testing.assert_allclose(law.stored(path), fading.stored(path), rtol=0.0, atol=1e-12 * energy)


@given(log_uniform(1e1, 1e5), log_uniform(1e-2, 1e2), st.floats(0.5, 1.0), travels)
def test_a_sharp_knee_is_one_element_of_maxwell_slip(
    stiffness: float, saturation: float, shape: float, travel: list[float]
) -> None:
    slip = MaxwellSlip(stiffness=stiffness, breakaway=saturation)
    for sharpness, distance in ((1e6, 1e-4), (1e10, 1e-8), (1e18, 1e-13), (1e300, 1e-13)):
        law = BoucWen(stiffness=stiffness, saturation=saturation, sharpness=sharpness, shape=shape)
        path = path_of(law, travel)
        np.testing.assert_allclose(law.trace(path), slip.trace(path), rtol=0.0, atol=distance * saturation)
        np.testing.assert_allclose(law.work(path), slip.work(path), rtol=0.0, atol=10.0 * distance * saturation * reach(law))


@given(laws, travels, st.integers(2, 100))
def test_a_step_may_be_divided(law: BoucWen, travel: list[float], parts: int) -> None:
    path = path_of(law, travel)
    fine = np.append((path[:-1, None] + np.diff(path)[:, None] * (np.arange(parts) / parts)).ravel(), path[-1])
    slack = 1e-15 * len(fine) + 2e-15 * float(np.abs(path).max()) / reach(law)
    energy = law.saturation * float(reach(law) + np.abs(np.diff(path)).sum())
    np.testing.assert_allclose(law.trace(fine)[::parts], law.trace(path), rtol=0.0, atol=slack * law.saturation)
    np.testing.assert_allclose(law.work(fine)[::parts], law.work(path), rtol=0.0, atol=slack * energy)


@given(laws, travels, st.floats(-2.0, 2.0))
def test_work_is_the_torque_integrated(law: BoucWen, travel: list[float], last: float) -> None:
    assume(abs(last) > 1e-3 and law.sharpness <= 30.0)
    state, step = law.advance(path_of(law, travel)), last * reach(law)
    nodes, weights = np.polynomial.legendre.leggauss(20)
    edges = np.linspace(0.0, step, 401)  # fine beside the knee of the sharpest law
    points = (edges[:-1, None] + 0.5 * np.diff(edges)[:, None] * (1.0 + nodes)).ravel()
    held = law.trace(np.concatenate(([0.0], points)), state=state)[1:]
    torque = 0.5 * (edges[1] - edges[0]) * float(held @ np.tile(weights, 400))
    assert law.work([0.0, step], state=state)[-1] == pytest.approx(torque, rel=0.0, abs=1e-9 * law.saturation * abs(step))


@given(laws, travels)
def test_what_is_lost_never_comes_back(law: BoucWen, travel: list[float]) -> None:
    path = path_of(law, travel)
    stored = law.stored(path)
    assert stored == pytest.approx(law.trace(path) ** 2 / (2.0 * law.stiffness), rel=1e-15)
    assert np.diff(law.work(path) - stored).min() >= -4e-15 * law.saturation * reach(law)


@given(laws, travels, log_uniform(1e2, 1e150))
def test_no_motion_leads_beyond_the_saturation_and_a_long_one_there(law: BoucWen, travel: list[float], far: float) -> None:
    path = path_of(law, travel)
    assert np.abs(law.trace(path)).max() <= law.saturation
    end = law.trace(np.append(path, [path[-1] + far * reach(law), path[-1]]))
    assert end[-2] == pytest.approx(law.saturation, rel=4e-16)
    assert end[-1] == pytest.approx(-law.saturation, rel=4e-16)


@given(laws, travels)
def test_at_rest_nothing_changes(law: BoucWen, travel: list[float]) -> None:
    path = path_of(law, travel)
    resting = np.append(path, np.full(5, path[-1]))
    assert len(set(law.trace(resting)[len(path) - 1 :].tolist())) == 1
    assert len(set(law.work(resting)[len(path) - 1 :].tolist())) == 1


def test_a_torque_beyond_the_saturation_is_none_a_gear_can_hold() -> None:
    law = BoucWen(stiffness=1000.0, saturation=0.5, sharpness=2.0, shape=0.5)
    assert law.trace([0.0, 1e-4], state=BoucWen.State(held=0.7))[-1] == 0.5


@pytest.mark.parametrize("shape", [0.5, 1.0])
def test_minor_loops_do_not_close(shape: float) -> None:
    """Back by 0.6 and forth again, sharpness 2, from T_s tanh 1: by the closed forms tan (or a line), then tanh."""
    law = BoucWen(stiffness=1000.0, saturation=0.5, sharpness=2.0, shape=shape)
    top = math.tanh(1.0)
    low = math.tan(math.atan(top) - 0.6) if shape == 1.0 else top - 0.6
    again = math.tanh(math.atanh(low) + 0.6)
    torque = law.trace([0.0, 0.0005, 0.0002, 0.0005])
    assert torque[3] - torque[1] == pytest.approx(0.5 * (again - top), rel=1e-12)
    assert abs(again - top) > 0.05


@pytest.mark.parametrize(("field", "value"), [("sharpness", 0.99), ("shape", 0.49), ("shape", 1.01), ("saturation", 0.0)])
def test_what_is_no_bouc_wen_or_not_passive_is_refused(field: str, value: float) -> None:
    with pytest.raises(ValueError, match=field):
        made(BoucWen, **{field: value})
