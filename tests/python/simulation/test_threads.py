"""Calls side by side: what they return, what ends them, and derivatives by more numbers than one run of the core takes."""

from __future__ import annotations

import time
from concurrent.futures import ThreadPoolExecutor
from threading import Barrier, Thread

import numpy as np
import pytest
import strainwave as sw
from strainwave.simulation import threads
from strainwave.simulation.threads import StepCounter, one_thread_of_algebra, side_by_side
from threadpoolctl import ThreadpoolController


@pytest.mark.parametrize("available", [1, 2, 5])
def test_what_calls_return_stands_in_their_order(available: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(threads, "available_threads", lambda: available)
    assert side_by_side([lambda _, i=i: i**2 for i in range(7)]) == [i**2 for i in range(7)]


def test_a_call_that_fails_ends_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(threads, "available_threads", lambda: 3)
    ended: list[str] = []

    def lasting(told: StepCounter) -> None:
        try:
            for _ in range(20_000):
                told(0)
                time.sleep(1e-3)
            ended.append("by itself")
        except InterruptedError:
            ended.append("by the other")
            raise

    def failing(told: StepCounter) -> None:
        time.sleep(0.1)
        raise FloatingPointError("diverged")

    with pytest.raises(FloatingPointError, match="diverged"):
        side_by_side([failing, lasting, lasting])
    assert ended == ["by the other", "by the other"]


def test_derivatives_by_many_numbers_are_those_by_each_alone() -> None:
    motor = sw.motor.DC(inertia=1e-4, inductance=1e-3, resistance=0.5, torque_constant=0.1)
    drive = sw.Drive(gear=sw.load("hfuc-20-100"), motor=motor)
    command = sw.scenario.sine(2.0, 3.0, 0.2)
    names = [
        "motor.inertia", "motor.resistance", "motor.inductance", "motor.torque_constant", "load.inertia", "gear.damping",
        "gear.stiffness.k1", "gear.stiffness.k2", "gear.stiffness.t1", "gear.input_inertia",
    ]  # fmt: skip
    together = sw.analysis.derivatives(drive, command, names, 1e-4, sample=1e-2)
    for name in names:
        alone = sw.analysis.derivatives(drive, command, [name], 1e-4, sample=1e-2)
        for column in ("input_angle", "torque"):
            assert np.array_equal(together[column, name], alone[column, name])


@pytest.mark.parametrize("ends_first", [0, 1])
def test_algebra_has_one_thread_until_the_last_of_the_calls_that_overlap_has_ended(ends_first: int) -> None:
    both_within, one_ended = Barrier(2), Barrier(2)
    blas = ThreadpoolController().select(user_api="blas")

    def counts() -> set[int]:
        return {library["num_threads"] for library in blas.info()}

    def call(place: int) -> None:
        with one_thread_of_algebra:
            both_within.wait(10.0)
            if place != ends_first:
                one_ended.wait(10.0)
                assert counts() == {1}
        if place == ends_first:
            one_ended.wait(10.0)

    def allow(threads: int) -> None:  # in a thread that ends, as threadpoolctl lets a living one alone change its limit
        setting = Thread(target=lambda: blas.limit(limits=threads))
        setting.start()
        setting.join()

    before = counts()
    allow(2)
    try:
        with ThreadPoolExecutor(2) as pool:
            list(pool.map(call, range(2)))
        assert counts() == {2}
    finally:
        allow(max(before))
