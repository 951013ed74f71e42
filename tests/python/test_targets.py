"""What a run of the benchmarks says of targets, on tables made up here."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pytest
import targets


def row(solver: str, angle: float, torque: float, seconds: float) -> dict[str, Any]:
    return {
        "solver": solver,
        "setting": f"rtol {torque:g}",
        "output_angle_error": angle,
        "torque_error": torque,
        "wall_time": seconds,
        "cpu_time": seconds,
        "compile_time": 0.0,
    }


OWN = [row("strainwave", 4e-7, 4e-3, 0.004), row("strainwave", 1e-8, 1e-4, 0.02), row("strainwave, adaptive", 1e-9, 1e-5, 0.1)]


def single(*peers: Mapping[str, Any]) -> dict[str, Any]:
    return {"run": targets.RUN, "peak_torque": 100.0, "results": [*OWN, *peers]}


def verdict(what: str, **tables: Mapping[str, Any]) -> targets.Verdict:
    (found,) = [each for each in targets.verdicts(tables) if what in each.target]
    return found


def test_the_lead_is_the_smallest_over_settings_accurate_enough_each_at_its_own_error() -> None:
    coarse = row("CVODE, Numba", 1e-5, 0.1, 0.04)  # 10 times as long, but misses the wanted accuracy
    middle = row("CVODE, Numba", 1e-6, 2e-2, 2.4)  # 600 times
    fine = row("CVODE, Numba", 1e-8, 5e-3, 10.4)  # 520 times: the first row of ours is as accurate in the torque alone
    found = verdict("sundae", single=single(coarse, middle, fine))
    assert found.measured == pytest.approx(520.0, rel=1e-12)
    assert found.reached
    assert not verdict("sundae", single=single(coarse, middle, row("CVODE, Numba", 1e-8, 5e-3, 5.8))).reached


def test_a_solver_that_never_is_accurate_enough_is_told_as_such() -> None:
    found = verdict("CVODES", single=single(row("CasADi CVODES", 1e-5, 0.1, 0.8), row("CasADi CVODES, gcc", 1e-5, 0.1, 0.6)))
    assert found.measured == pytest.approx(150.0, rel=1e-12)
    assert "misses the wanted accuracy" in found.remark


def test_what_was_not_measured_is_neither_reached_nor_missed() -> None:
    for found in targets.verdicts({"single": single({"solver": "CVODE, Numba", "setting": "rtol 1", "reason": "too long"})}):
        assert (found.measured, found.reached) == (None, None)
    coarse, fine = row("CVODE, Numba", 1e-5, 0.1, 0.04), row("CVODE, Numba", 1e-12, 1e-9, 1.0)
    more_accurate = verdict("sundae", single=single(coarse, fine))
    assert (more_accurate.reached, more_accurate.remark) == (None, "more accurate than all settings of strainwave")


def test_only_parts_that_have_a_table_are_judged_and_the_others_named() -> None:
    tables = {"stick_slip": {"run": "earlier", "costs": [cost("viscous, smooth", 1500.0), cost("Stribeck, sticks", 1000.0)]}}
    (found,) = targets.verdicts(tables)
    assert (found.measured, found.aim, found.reached) == (1.5, 1.4, False)
    assert list(targets.remarks(["single", "stick_slip"], tables)) == [
        "single was not run",
        "stick_slip is of another run, earlier",
    ]


def cost(friction: str, pack: float) -> dict[str, Any]:
    return {"friction": friction, "pack": pack, "scalar": 100.0}
