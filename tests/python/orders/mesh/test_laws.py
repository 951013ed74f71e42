"""Laws of a gear by a table of its mesh: tables of known laws come back, and what a table does not determine is stated."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from numpy.typing import NDArray
from scipy.optimize import brentq
from strainwave.analysis.torsion_loop import series_compliance
from strainwave.files import MeshTable, ModeTable

Array = NDArray[np.float64]

TURN = np.radians(np.arange(0.0, 360.0, 5.0))
BOTH_SENSES, ONE_SENSE = [-40.0, -20.0, -5.0, 0.0, 5.0, 20.0, 40.0], [0.0, 5.0, 10.0, 20.0, 30.0, 40.0]
ERROR = sw.kinematic_error.Fourier(order=[1, 2, 4], amplitude=[2e-5, 3e-4, 4e-5], phase=[1.0, 0.5, -2.0])
SPRING = sw.stiffness.Linear(k=3e4)
VARIATION = sw.variation.Periodic(order=[2, 4], amplitude=[0.08, 0.02], phase=[0.3, -1.0])


def table(
    loads: list[float],
    *,
    angle: Array = TURN,
    fall: float = 0.0,
    spring: Any = SPRING,
    variation: Any = VARIATION,
    with_stiffness: bool = False,
    noise: float = 0.0,
) -> MeshTable:
    """The table of known laws: the error falls as 1 / (1 + fall |T|), T of the spring, which is `variation` times its mean."""
    at, torque = (each.ravel() for each in np.meshgrid(angle, np.array(loads)))
    factor = np.asarray(variation.factor(at)) if variation else np.ones_like(at)
    full = np.asarray(ERROR.error(at))
    error = np.array([at_rest(each, spring, fall, *of) for each, *of in zip(full, factor, torque, strict=True)])
    tangents = factor * np.array([spring.tangent(spring.twist(each)) for each in (torque / factor).tolist()])
    return MeshTable(
        at,
        torque,
        transmission_error=error + np.random.default_rng(0).normal(0.0, noise, len(at)),
        stiffness=tangents if with_stiffness else None,
        source="mesh.csv",
    )


def at_rest(error: float, spring: Any, fall: float, factor: float, torque: float) -> float:
    """The transmission error x at which the energy V of the spring has the slope dV/dx = torque."""

    def moved(twist: float) -> float:
        return twist + error / (1.0 + fall * abs(spring.torque(twist)))

    def missing(twist: float) -> float:
        step = 1e-9
        return factor * float(spring.torque(twist)) / ((moved(twist + step) - moved(twist - step)) / (2.0 * step)) - torque

    if fall == 0.0 or torque == 0.0:
        return moved(float(spring.twist(torque / factor)))
    near = float(spring.twist(torque / factor))
    return moved(float(brentq(missing, 0.3 * near, 3.0 * near, xtol=1e-18, rtol=1e-14)))


def same_law(fitted: Any, law: Any, rtol: float) -> bool:
    """True if both have the same waves."""
    orders = np.unique([*fitted.order, *law.order])

    def waves(of: Any) -> NDArray[np.complex128]:
        each = dict(zip(of.order, np.array(of.amplitude) * np.exp(1j * np.array(of.phase)), strict=True))
        return np.array([each.get(order, 0.0) for order in orders])

    return bool(np.abs(waves(fitted) - waves(law)).max() < rtol * np.abs(waves(law)).max())


@pytest.mark.parametrize("with_stiffness", [False, True])
def test_known_orders_and_their_fall_with_the_load_come_back(with_stiffness: bool) -> None:
    laws = sw.orders.mesh_laws(table(BOTH_SENSES, fall=0.02, with_stiffness=with_stiffness))
    assert same_law(laws.kinematic_error.law, ERROR, 1e-9)
    assert laws.kinematic_error.load_sensitivity == pytest.approx(0.02, rel=1e-6)
    assert laws.stiffness is not None
    assert laws.stiffness.k == pytest.approx(3e4, rel=1e-9)
    assert same_law(laws.stiffness_variation, VARIATION, 1e-8)
    assert laws.residual < 1e-12
    assert laws.explained_share > 1.0 - 1e-12
    assert [line.order for line in laws.orders] == [2.0, 4.0, 1.0]


def test_loads_of_one_sense_need_the_column_stiffness() -> None:
    laws = sw.orders.mesh_laws(table(ONE_SENSE, fall=0.02, with_stiffness=True))
    assert laws.kinematic_error.load_sensitivity == pytest.approx(0.02, rel=1e-6)
    assert same_law(laws.stiffness_variation, VARIATION, 1e-8)


def table_of(error: Any, loads: list[float], *, count: int, period: float = 2.0 * np.pi) -> MeshTable:
    """A table of an error over angle and load, on a straight spring."""
    at, torque = (each.ravel() for each in np.meshgrid(period * np.arange(count) / count, np.array(loads)))
    return MeshTable(at, torque, transmission_error=error(at, torque) + torque / 3e4, source="mesh.csv")


@pytest.mark.parametrize(("count", "loads"), [(6, [-30.0, 0.0, 30.0]), (8, [0.0]), (12, [-30.0, 0.0, 30.0]), (40, [0.0])])
def test_a_table_of_orders_alone_keeps_them_all(count: int, loads: list[float]) -> None:
    orders = 2.0 * np.arange(1, (count + 1) // 2)  # all that the angles determine
    law = sw.kinematic_error.Fourier(order=orders[:16], amplitude=3e-4 / orders[:16] ** 2, phase=np.cos(orders[:16]))
    laws = sw.orders.mesh_laws(table_of(lambda at, _: law.error(at), loads, count=count, period=np.pi), repeats=2)
    assert same_law(laws.kinematic_error, law, 1e-9)
    assert any(remark.startswith("the noise of the solver is not determined") for remark in laws.remarks)
    assert not any("left out" in remark for remark in laws.remarks)


@pytest.mark.parametrize("loads", [[-40.0, -20.0, 0.0, 20.0, 40.0], [0.0, 10.0, 20.0, 40.0]])
def test_standard_deviations_contain_what_the_law_leaves(loads: list[float]) -> None:
    def falling(at: Array, torque: Array) -> Array:
        noise = np.random.default_rng(0).normal(0.0, 1e-7, len(at))
        return 3e-4 * (1.0 - 0.02 * np.abs(torque)) * np.sin(2.0 * at) + 2e-6 * np.sin(30.0 * at) + noise

    laws = sw.orders.mesh_laws(table_of(falling, loads, count=72))
    second, thirtieth = laws.orders[0], laws.orders[1]
    assert (second.order, thirtieth.order) == (2.0, 30.0)
    assert abs(second.amplitude - 3e-4) < 2.0 * second.sigma  # of both senses by a fall, of one sense by a constant
    if loads[0] < 0.0:
        assert laws.sensitivity_sigma > 0.02 * laws.kinematic_error.load_sensitivity
    assert thirtieth.sigma < 0.6 * thirtieth.amplitude


def test_deviations_contain_the_form_where_the_loads_do_not_test_it() -> None:
    """An error that falls as (1 + k |T|)^-2, whatever the spring does, is none of a gear whose energy is conserved."""
    at, torque = (each.ravel() for each in np.meshgrid(TURN, [-40.0, 0.0, 40.0]))
    error = np.asarray(ERROR.error(at)) / (1.0 + 0.005 * np.abs(torque)) ** 2
    laws = sw.orders.mesh_laws(MeshTable(at, torque, transmission_error=error + torque / 3e4, source="mesh.csv"))
    assert laws.residual > 5e-8
    assert laws.orders[0].sigma > 0.25 * laws.residual
    assert laws.sensitivity_sigma * 2.0 * 40.0 * 3e-4 > 0.5 * laws.residual


def test_deviations_of_a_small_table_are_those_of_its_noise() -> None:
    law = sw.kinematic_error.Fourier(order=[2, 4, 6], amplitude=[3e-4, 5e-5, 2e-5], phase=[2.0, 4.0, 6.0])
    sigmas = []
    for seed in range(12):
        generator = np.random.default_rng(seed)

        def error(at: Array, torque: Array, generator: np.random.Generator = generator) -> Array:
            fallen = np.asarray(law.error(at)) / (1.0 + 0.01 * np.abs(torque)) ** 2
            return np.asarray(fallen + generator.normal(0.0, 9e-7, len(at)))

        laws = sw.orders.mesh_laws(table_of(error, [-30.0, 0.0, 30.0], count=12, period=np.pi), repeats=2)
        assert abs(laws.orders[0].amplitude - 3e-4) < 4.0 * laws.orders[0].sigma
        assert any(remark.startswith("between 0 and 30 N.m the form of the fall is not tested") for remark in laws.remarks)
        sigmas.append(laws.orders[0].sigma)
    assert min(sigmas) > 1e-7  # of noise 3.7e-7 at a load


def test_orders_that_fall_each_by_its_own_rate_have_no_fall_in_common() -> None:
    def error(at: Array, torque: Array) -> Array:  # as an independent ring has them: the order of the teeth changes its sign
        level = np.abs(torque) / 40.0
        noise = np.random.default_rng(0).normal(0.0, 1e-9, len(at))
        return np.asarray(
            3.4e-5 * (1.0 - 0.05 * level) * np.sin(2.0 * at) + 2e-5 * np.cos(3.0 * level) * np.sin(30.0 * at) + noise
        )

    laws = sw.orders.mesh_laws(table_of(error, [-40.0, -20.0, -10.0, 0.0, 10.0, 20.0, 40.0], count=144))
    assert isinstance(laws.kinematic_error, sw.kinematic_error.Fourier)
    second, thirtieth = laws.orders[0], laws.orders[1]
    assert abs(second.amplitude - 3.4e-5) < 2.0 * second.sigma < 4e-6
    assert abs(thirtieth.amplitude - 2e-5) < 2.0 * thirtieth.sigma
    assert any("it misses that of order 30 by a quarter" in remark for remark in laws.remarks)


def test_a_stiffness_varies_no_more_than_what_the_law_leaves_shows() -> None:
    def error(at: Array, torque: Array) -> Array:
        fallen = (2.5e-4 * np.sin(2.0 * at + 0.5) + 4e-5 * np.sin(4.0 * at)) / (1.0 + 0.01 * np.abs(torque))
        twist = torque / (3e4 * (1.0 + 0.05 * np.cos(2.0 * at))) - torque / 3e4
        return np.asarray(fallen + twist + np.random.default_rng(0).normal(0.0, 2e-8, len(at)))

    laws = sw.orders.mesh_laws(table_of(error, [-40.0, -20.0, 0.0, 20.0, 40.0], count=72))
    assert laws.stiffness_variation is not None
    assert laws.stiffness_variation.order == (2.0,)
    assert laws.stiffness_variation.amplitude[0] == pytest.approx(0.05, rel=0.01)


@pytest.mark.parametrize(("repeats", "orders"), [(2, [1.0, 2.0]), (7, [2.0]), (36, [2.0])])
def test_a_table_that_does_not_repeat_as_stated_is_refused(repeats: int, orders: list[float]) -> None:
    whole = table_of(lambda at, _: 3e-4 * sum(np.sin(order * at) for order in orders), [0.0], count=37)
    names = " and ".join(f"{order:g}" for order in orders if order % repeats)
    with pytest.raises(ValueError, match=f"order {names} .*no multiple of repeats={repeats}; give repeats=1"):
        sw.orders.mesh_laws(whole, repeats=repeats)
    pitches = table_of(
        lambda at, _: 1e-6 * np.sin(100.0 * at) + 1e-6 * np.sin(200.0 * at), [0.0], count=32, period=0.02 * np.pi
    )
    with pytest.raises(ValueError, match=r"order 100 .*no multiple of repeats=200"):
        sw.orders.mesh_laws(pitches, repeats=200)


@pytest.mark.parametrize("missing", [1, 4, 9])
def test_a_load_of_which_angles_are_missing_is_left_out(missing: int) -> None:
    whole = table_of(lambda at, _: 3e-4 * np.sin(2.0 * at) + 4e-5 * np.sin(4.0 * at), [-30.0, 0.0, 20.0, 30.0], count=36)
    kept = np.ones(len(whole.angle), bool)
    kept[np.flatnonzero(whole.torque == 20.0)[5 : 5 + missing]] = False
    assert whole.transmission_error is not None
    laws = sw.orders.mesh_laws(MeshTable(whole.angle[kept], whole.torque[kept], whole.transmission_error[kept]))
    expected = sw.kinematic_error.Fourier(order=[2, 4], amplitude=[3e-4, 4e-5], phase=[0.0, 0.0])
    assert same_law(laws.kinematic_error, expected, 1e-9)
    assert laws.stiffness is not None
    assert laws.stiffness.k == pytest.approx(3e4, rel=1e-9)
    left_out = f"at 20 N.m angles are missing over {10 * (missing + 1)} deg: this load is left out; compute its missing rows"
    assert left_out in laws.remarks


def test_laws_that_explain_less_than_half_make_no_gear() -> None:
    def error(at: Array, torque: Array) -> Array:  # of the other sign at every second load
        return np.asarray(3e-4 * np.cos(np.pi * torque / 10.0) * np.sin(2.0 * at) + 4e-5 * np.sin(4.0 * at))

    laws = sw.orders.mesh_laws(table_of(error, [-30.0, -20.0, -10.0, 0.0, 10.0, 20.0, 30.0], count=36))
    with pytest.raises(ValueError, match=r"explain .* % of the transmission error of mesh.csv alone; choose one load by load="):
        laws.applied_to("hfuc-25-100")


def test_orders_at_one_load_have_the_spring_of_all() -> None:
    given = table(ONE_SENSE, fall=0.02)
    laws = sw.orders.mesh_laws(given, load=20.0)
    rows = given.torque == 20.0
    assert given.transmission_error is not None
    left = given.transmission_error[rows] - laws.kinematic_error.error(given.angle[rows])
    assert np.ptp(left) < 1e-3 * np.ptp(given.transmission_error[rows])
    assert laws.stiffness is not None
    assert laws.stiffness.k == pytest.approx(3e4, rel=0.01)
    assert laws.stiffness_variation is None
    assert laws.explained_share > 1.0 - 1e-6
    assert any("at one load, 20 N.m" in remark for remark in laws.remarks)
    with pytest.raises(ValueError, match=r"load is 21 N.m; the table has 0, 5, 10, 20, 30, 40 N.m"):
        sw.orders.mesh_laws(given, load=21.0)


@pytest.mark.parametrize(("fall", "variation"), [(0.02, None), (0.0, VARIATION), (0.02, VARIATION)])
@pytest.mark.parametrize("noise", [0.0, 2e-7, 2e-6, 2e-5])
def test_loads_of_one_sense_give_the_right_laws_or_none(fall: float, variation: Any, noise: float) -> None:
    bending = sw.stiffness.ThreeSegment(k1=2e4, k2=4e4, k3=5e4, t1=12.0, t2=33.0)
    for spring in (SPRING, bending):
        laws = sw.orders.mesh_laws(table(ONE_SENSE, fall=fall, variation=variation, spring=spring, noise=noise))
        sensitivity = getattr(laws.kinematic_error, "load_sensitivity", 0.0)
        if sensitivity == 0.0 and laws.stiffness_variation is None:
            assert any("not separable" in remark or "no fall and no variation" in remark for remark in laws.remarks)
        else:
            assert sensitivity == pytest.approx(fall, rel=0.05, abs=3e-4 + 4.0 * laws.sensitivity_sigma)
            assert (laws.stiffness_variation is None) == (variation is None)
            if variation is not None:
                assert same_law(laws.stiffness_variation, variation, 0.15)


@pytest.mark.slow("orders")
def test_standard_deviations_are_those_of_repeated_tables() -> None:
    exact = table(BOTH_SENSES, fall=0.02, variation=None)
    assert exact.transmission_error is not None
    generator, falls, amplitudes = np.random.default_rng(7), [], []
    for _ in range(40):
        noisy = exact.transmission_error + generator.normal(0.0, 2e-5, len(exact.angle))
        laws = sw.orders.mesh_laws(MeshTable(exact.angle, exact.torque, transmission_error=noisy))
        if isinstance(laws.kinematic_error, sw.kinematic_error.Scaled):
            falls.append((laws.kinematic_error.load_sensitivity - 0.02) / laws.sensitivity_sigma)
            amplitudes.append((laws.orders[0].amplitude - 3e-4) / laws.orders[0].sigma)
    assert len(falls) > 20
    assert 0.6 < np.sqrt(np.mean(np.square(falls))) < 1.5
    assert 0.6 < np.sqrt(np.mean(np.square(amplitudes))) < 1.5


def test_a_spring_of_three_segments_whose_knees_are_loads_comes_back() -> None:
    spring = sw.stiffness.ThreeSegment(k1=2e4, k2=4e4, k3=5e4, t1=10.0, t2=30.0)
    laws = sw.orders.mesh_laws(table(ONE_SENSE, spring=spring, variation=None))
    for name in ("k1", "k2", "k3", "t1", "t2"):
        assert getattr(laws.stiffness, name) == pytest.approx(getattr(spring, name), rel=1e-9)


def test_two_loads_do_not_separate_and_one_determines_less() -> None:
    two = sw.orders.mesh_laws(table([0.0, 20.0], fall=0.02))
    assert isinstance(two.kinematic_error, sw.kinematic_error.Fourier)
    assert two.stiffness_variation is None
    assert any("two loads do not separate a fall" in remark for remark in two.remarks)
    one = sw.orders.mesh_laws(table([0.0], fall=0.02))
    assert same_law(one.kinematic_error, ERROR, 1e-12)
    assert one.stiffness is None
    assert "one load does not determine the stiffness" in one.remarks


def test_an_error_without_its_twist_has_no_stiffness() -> None:
    at, torque = (each.ravel() for each in np.meshgrid(TURN, np.array(BOTH_SENSES)))
    laws = sw.orders.mesh_laws(
        MeshTable(at, torque, transmission_error=np.asarray(ERROR.error(at)) / (1.0 + 0.02 * np.abs(torque)) ** 2)
    )
    assert laws.stiffness is None
    assert laws.kinematic_error.load_sensitivity == pytest.approx(0.02, rel=1e-6)
    assert any("the twist is not in it" in remark for remark in laws.remarks)


def test_noise_of_the_solver_makes_no_orders() -> None:
    laws = sw.orders.mesh_laws(table(BOTH_SENSES, fall=0.02, noise=2e-6))
    assert [line.order for line in laws.orders] == [2.0, 4.0, 1.0]
    for each, true in zip(sorted(laws.orders, key=lambda one: one.order), ERROR.amplitude, strict=True):
        assert abs(each.amplitude - true) < 4.0 * each.sigma
    assert any("are within the noise of the solver" in remark for remark in laws.remarks)
    silent = MeshTable(TURN, np.zeros(72), transmission_error=np.random.default_rng(3).normal(0.0, 1e-6, 72))
    assert sw.orders.mesh_laws(silent).orders == ()


def test_the_highest_order_is_below_half_the_samples_of_a_turn() -> None:
    coarse = sw.orders.mesh_laws(table([0.0], angle=np.radians(np.arange(0.0, 360.0, 45.0))))
    assert any(remark.startswith("orders up to 3 are determined (half the samples of a turn)") for remark in coarse.remarks)
    with pytest.raises(ValueError, match="order 1 needs less than 180 deg"):
        sw.orders.mesh_laws(table([0.0], angle=np.array([0.0, np.pi])))


def test_a_missing_angle_halves_the_highest_order() -> None:
    laws = sw.orders.mesh_laws(table([0.0], angle=np.delete(TURN, 20)))
    assert same_law(laws.kinematic_error, ERROR, 1e-9)
    assert any("the largest gap between angles is 10 deg, the usual one 5 deg" in remark for remark in laws.remarks)
    assert any(remark.startswith("orders up to 17 are determined") for remark in laws.remarks)


def test_part_of_a_turn_determines_what_the_user_says_repeats() -> None:
    half = TURN[:36]
    with pytest.raises(ValueError, match=r"from 0 to 175 deg, less than the 360 deg.*give repeats=2 if all repeats 2 times"):
        sw.orders.mesh_laws(table([0.0], angle=half))
    even = sw.kinematic_error.Fourier(order=[2, 4], amplitude=[3e-4, 4e-5], phase=[0.5, -2.0])
    laws = sw.orders.mesh_laws(MeshTable(half, np.zeros(36), transmission_error=even.error(half)), repeats=2)
    assert same_law(laws.kinematic_error, even, 1e-9)
    pitch = TURN / 200.0
    teeth = MeshTable(pitch, np.zeros(72), transmission_error=1e-6 * np.sin(200.0 * 2.0 * pitch))
    assert [each.order for each in sw.orders.mesh_laws(teeth, repeats=200).orders] == [400.0]


def test_columns_that_contradict_each_other_are_refused() -> None:
    right = table(BOTH_SENSES, with_stiffness=True)
    assert right.transmission_error is not None
    assert right.stiffness is not None
    with pytest.raises(ValueError, match=r"the column stiffness gives a twist of .* correct units or sides"):
        sw.orders.mesh_laws(MeshTable(right.angle, right.torque, right.transmission_error, stiffness=2.0 * right.stiffness))
    with pytest.raises(ValueError, match="change the sign of one of the two columns"):
        sw.orders.mesh_laws(MeshTable(right.angle, -right.torque, transmission_error=right.transmission_error))
    slightly = sw.orders.mesh_laws(MeshTable(right.angle, right.torque, right.transmission_error, 1.1 * right.stiffness))
    assert any("the former is in the model" in remark for remark in slightly.remarks)
    assert slightly.stiffness is not None
    assert slightly.stiffness.k == pytest.approx(3e4, rel=1e-6)


def test_angles_in_another_unit_and_torques_of_every_row_are_refused() -> None:
    with pytest.raises(
        ValueError, match="5 rad apart; angles that are more than half a turn apart are no table: check their unit"
    ):
        sw.orders.mesh_laws(MeshTable(np.degrees(TURN), np.zeros(72), transmission_error=np.zeros(72)))
    with pytest.raises(ValueError, match="the torque varies from row to row; give rows at a few loads"):
        sw.orders.mesh_laws(MeshTable(TURN, np.linspace(10.0, 10.5, 72), transmission_error=np.zeros(72)))


def test_loads_that_differ_by_the_tolerance_of_a_solver_are_one() -> None:
    exact = table(BOTH_SENSES, fall=0.02)
    off = exact.torque + np.random.default_rng(1).uniform(-0.01, 0.01, len(exact.torque))
    laws = sw.orders.mesh_laws(MeshTable(exact.angle, off, transmission_error=exact.transmission_error))
    assert laws.kinematic_error.load_sensitivity == pytest.approx(0.02, rel=0.02)


@pytest.mark.slow("orders")
def test_a_million_rows() -> None:
    angle = np.random.default_rng(0).uniform(0.0, 2.0 * np.pi, 1_000_000)
    laws = sw.orders.mesh_laws(MeshTable(angle, np.zeros(len(angle)), transmission_error=ERROR.error(angle)))
    assert same_law(laws.kinematic_error, ERROR, 1e-9)


# ---- A gear with these laws ------------------------------------------------------------------------------------------


def test_a_catalogue_gear_keeps_what_the_table_does_not_determine(tmp_path: Path) -> None:
    laws = sw.orders.mesh_laws(table(BOTH_SENSES, fall=0.02))
    before, after = sw.GearSet.read("hfuc-25-100"), laws.applied_to("hfuc-25-100")
    assert after.gear.kinematic_error == laws.kinematic_error
    assert after.gear.stiffness == laws.stiffness
    assert after.gear.replace(
        kinematic_error=before.gear.kinematic_error,
        stiffness=before.gear.stiffness,
        stiffness_variation=before.gear.stiffness_variation,
    ) == before.gear  # fmt: skip
    assert after.sources["gear.stiffness.k"].source == "computed: finite-element table mesh.csv"
    assert after.sources["gear.damping"] == before.sources["gear.damping"]
    after.save(tmp_path / "gear.toml")
    assert sw.GearSet.read(tmp_path / "gear.toml") == after


STAGES = sw.structure.Staged(
    pitch_radius=31e-3, coupling_stiffness=5e3, bearing_stiffness=5e7, mesh_stiffness=3e8, circular_spline_stiffness=2e5,
    radial_mass=0.03, flexspline_inertia=2e-5, circular_spline_inertia=3e-4,
)  # fmt: skip


def with_mesh(mesh_stiffness: float, amplitude: float = 0.1) -> MeshTable:
    without = table(BOTH_SENSES, fall=0.02)
    values = mesh_stiffness * (1.0 + amplitude * np.sin(2.0 * without.angle))
    return MeshTable(without.angle, without.torque, without.transmission_error, mesh_stiffness=values, source="mesh.csv")


def twist_of(gear: sw.Gear, torque: float) -> float:
    return float(gear.stiffness.twist(torque)) + series_compliance(gear) * torque


def held_at(gear: sw.Gear, angle: Array, torque: float) -> Array:
    """The transmission error of a gear without friction and hysteresis whose input is held at angles, under a load."""
    bare, holding = sw.Gear(), sw.friction.Coulomb(coulomb=1e6, breakaway=1e6)
    names = ("hysteresis", "friction_mesh", "friction_output")
    still = gear.replace(friction_input=holding, **{name: getattr(bare, name) for name in names})
    drive = sw.Drive(gear=still, motor=sw.motor.TorqueSource(inertia=1e-4), load=sw.loads.Inertia(inertia=0.1))
    states = (drive.rest().replace(input_angle=each) for each in angle.tolist())
    return np.array([sw.analysis.equilibrium(drive, load_torque=torque, initial=state).transmission_error for state in states])


@pytest.mark.parametrize("torque", [-40.0, 0.0, 20.0])
def test_a_gear_at_rest_has_the_transmission_error_of_its_table(torque: float) -> None:
    given = table(BOTH_SENSES, fall=0.02)
    assert given.transmission_error is not None
    gear = sw.orders.mesh_laws(given).applied_to("hfuc-25-100").gear
    rows = (given.torque == torque) & (np.round(np.degrees(given.angle)) % 45 == 0)
    np.testing.assert_allclose(held_at(gear, given.angle[rows], torque), given.transmission_error[rows], rtol=0.0, atol=1e-12)


def test_stages_leave_the_whole_compliance_as_it_is() -> None:
    laws = sw.orders.mesh_laws(with_mesh(4e8))
    assert laws.mesh_stiffness == pytest.approx(4e8, rel=1e-12)
    gear = laws.applied_to("hfuc-25-100", stages=STAGES).gear
    assert gear.structure.mesh_stiffness == pytest.approx(4e8, rel=1e-12)
    assert gear.structure.mesh_variation.amplitude == pytest.approx((0.1,), rel=1e-9)
    assert twist_of(gear, 20.0) == pytest.approx(20.0 / 3e4, rel=1e-9)


def test_a_table_of_the_mesh_alone_keeps_the_compliance_of_the_catalogue() -> None:
    of_mesh = with_mesh(4e8)
    laws = sw.orders.mesh_laws(MeshTable(of_mesh.angle, of_mesh.torque, mesh_stiffness=of_mesh.mesh_stiffness))
    before = sw.load("hfuc-25-100")
    after = laws.applied_to(before, stages=STAGES).gear
    for torque in (5.0, 20.0, 60.0):
        assert twist_of(after, torque) == pytest.approx(float(before.stiffness.twist(torque)), rel=1e-9)
    assert after.kinematic_error == before.kinematic_error


def test_the_variation_of_a_staged_gear_is_that_of_the_table() -> None:
    gear = sw.orders.mesh_laws(with_mesh(4e8)).applied_to("hfuc-25-100", stages=STAGES).gear
    stages, angle, torque = gear.structure, TURN, 20.0
    lever = stages.pitch_radius * np.cos(stages.pressure_angle)
    rest = series_compliance(gear) - 1.0 / (stages.mesh_stiffness * lever**2)
    mesh = 1.0 / (stages.mesh_stiffness * lever**2) / np.asarray(stages.mesh_variation.factor(angle))
    spring = np.asarray(gear.stiffness.twist(torque / np.asarray(gear.stiffness_variation.factor(angle)))) / torque
    whole = 1.0 / (3e4 * np.asarray(VARIATION.factor(angle)))
    assert np.abs(rest + mesh + spring - whole).max() < 0.15 * np.abs(whole - whole.mean()).max()  # to first order


MODES = ModeTable(frequency=[1850.0, 4000.0], waves=[0, 0], damping=[0.01, 0.01], mass=[0.6, 0.9], source="modes.csv")


def test_modes_of_the_ring_are_in_the_stages_and_leave_the_whole_compliance_as_it_is() -> None:
    given = table(BOTH_SENSES, variation=None)
    assert given.transmission_error is not None
    stages = STAGES.replace(coupling_damping=0.5, bearing_damping=2e3, mesh_damping=2e3, circular_spline_damping=5.0)
    after = sw.orders.mesh_laws(given).applied_to("hfuc-25-100", stages=stages, modes=MODES)
    ring = after.gear.structure.ring
    assert ring.natural_frequency == pytest.approx(2.0 * np.pi * MODES.frequency)
    assert after.sources["gear.structure.ring.mass[0]"].source == "computed: finite-element table modes.csv"
    assert after.sources["gear.structure.mesh_stiffness"].assumed
    gear = after.gear.replace(hysteresis=sw.Gear().hysteresis)
    drive = sw.Drive(gear=gear, motor=sw.motor.AccelerationSource(inertia=1e-4), load=sw.loads.Inertia(inertia=0.05))
    for angle in (0.0, np.radians(45.0)):
        start = {"input_angle": angle, "input_speed": 0.0}
        run = sw.simulate(drive, sw.scenario.constant(0.0, 0.1), dt=4e-6, load_torque=20.0, initial=start)
        expected = given.transmission_error[(given.torque == 20.0) & np.isclose(given.angle, angle)]
        # The wave generator lags behind the input by the windup of its coupling, 4e-5 rad, times the slope of the error.
        assert float(run["transmission_error"][-1]) == pytest.approx(float(expected[0]), abs=5e-8)


def test_of_more_modes_than_a_ring_has_the_most_compliant_are_taken(tmp_path: Path) -> None:
    mass = np.array([0.6, 50.0, 0.9, 2.0, 2.5])
    many = ModeTable(frequency=[1850.0, 2000.0, 4000.0, 4500.0, 5000.0], waves=np.zeros(5), damping=np.full(5, 0.01), mass=mass)
    assert many.ring.mass == (0.6, 0.9, 2.0, 2.5)
    assert many.remarks == ["a ring has 4 modes; left out: 2000 Hz, with 0.83 % of the compliance of all"]
    after = sw.orders.mesh_laws(table(BOTH_SENSES)).applied_to("hfuc-25-100", stages=STAGES, modes=many)
    assert after.note.endswith("left out: 2000 Hz, with 0.83 % of the compliance of all")
    after.save(tmp_path / "gear.toml")
    assert sw.GearSet.read(tmp_path / "gear.toml") == after


def test_modes_of_a_ring_that_no_wave_generator_holds_are_refused() -> None:
    free = ModeTable(frequency=[1056.0], waves=[2], damping=[0.014], mass=[0.028])
    with pytest.raises(ValueError, match=r"the stages alone have a compliance of .* more than .* of the whole gear"):
        sw.orders.mesh_laws(table(BOTH_SENSES)).applied_to("hfuc-25-100", stages=STAGES, modes=free)


def test_what_needs_stages_is_refused_without_them() -> None:
    laws = sw.orders.mesh_laws(with_mesh(4e8))
    with pytest.raises(ValueError, match="mesh_stiffness needs a gear of stages"):
        laws.applied_to("hfuc-25-100")
    with pytest.raises(ValueError, match="modes need a gear of stages"):
        sw.orders.mesh_laws(table(BOTH_SENSES)).applied_to("hfuc-25-100", modes=MODES)
    with pytest.raises(ValueError, match=r"the stages alone have a compliance of .*give stiffer stages"):
        laws.applied_to("hfuc-25-100", stages=STAGES.replace(circular_spline_stiffness=1e4))


@pytest.mark.parametrize("stiffness", [3e4, 3.1e4, np.inf])
def test_rounding_makes_no_order(stiffness: float) -> None:
    at, torque = (each.ravel() for each in np.meshgrid(np.radians(np.arange(360.0)), [-40.0, 0.0, 40.0]))
    for zero in (0.0, 1e-4):
        assert sw.orders.mesh_laws(MeshTable(at, torque, transmission_error=torque / stiffness + zero)).orders == ()


def test_a_variation_of_another_order_is_no_misfit() -> None:
    at, torque = (each.ravel() for each in np.meshgrid(TURN, [-40.0, -20.0, 0.0, 20.0, 40.0]))
    error = 2e-4 * np.sin(2.0 * at) + torque / (3e4 * (1.0 + 0.05 * np.cos(7.0 * at)))
    (second,) = sw.orders.mesh_laws(MeshTable(at, torque, transmission_error=error)).orders
    assert abs(second.amplitude - 2e-4) < 2.0 * second.sigma < 2e-6


def test_a_stiffness_of_other_units_is_refused() -> None:
    in_millinewton = replace(table(BOTH_SENSES), torque=1e-3 * table(BOTH_SENSES).torque)
    laws = sw.orders.mesh_laws(in_millinewton)
    with pytest.raises(ValueError, match=r"gives a stiffness of 30 N.m/rad, HFUC-25-100 has .* check the units"):
        laws.applied_to("hfuc-25-100")
    with pytest.raises(TypeError, match=r"modes must be a ModeTable, as sw.files.ModeTable.read\(...\) gives one"):
        laws.applied_to("hfuc-25-100", modes="modes.csv")  # type: ignore[arg-type]


def test_tooth_passing_orders_come_back() -> None:
    angle = 2.0 * np.pi * np.arange(1600) / 1600 + 0.003
    teeth = sw.kinematic_error.Fourier(order=[2, 200, 400], amplitude=[3e-4, 2e-6, 1e-6], phase=[0.5, 1.5, -2.5])
    laws = sw.orders.mesh_laws(MeshTable(angle, np.zeros(1600), transmission_error=teeth.error(angle)))
    assert same_law(laws.kinematic_error, teeth, 1e-9)
