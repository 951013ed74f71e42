"""Bands of an ensemble: quantiles of the members that have a result."""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from strainwave.simulation.ensemble import Ensemble

TIME = np.linspace(0.0, 1.0, 5)
MEMBERS = np.random.default_rng(0).normal(size=(41, 1)) * np.linspace(1.0, 2.0, 5)


def ensemble(values: np.ndarray, failures: dict[int, str]) -> Ensemble:
    columns = {"torque": values, "output_angle": 1e-3 * values}
    return Ensemble(TIME, columns, {"torque": "N.m", "output_angle": "rad"}, {"load.inertia": np.ones(len(values))}, failures)


def test_bands_hold_half_and_nine_tenths_of_the_members() -> None:
    failed = np.vstack([MEMBERS, np.full((1, 5), np.nan)])
    figure = ensemble(failed, {41: "it diverged"}).plot()
    torque, angle = figure.axes
    assert [axes.get_title(loc="left") for axes in figure.axes] == ["torque [N·m]", "output angle [mrad]"]
    assert angle.get_xlabel() == "time [s]"
    assert figure.get_suptitle() == "Torque and output angle of 41 members"
    assert np.asarray(torque.lines[0].get_ydata()) == pytest.approx(np.median(MEMBERS, axis=0))
    for band, share in zip(torque.collections, (0.9, 0.5), strict=True):
        corners = band.get_paths()[0].vertices
        at_end = np.asarray(corners)[np.asarray(corners)[:, 0] == TIME[-1], 1]
        assert np.mean((MEMBERS[:, -1] >= at_end.min()) & (MEMBERS[:, -1] <= at_end.max())) == pytest.approx(share, abs=0.06)
    assert [text.get_text() for text in figure.legends[0].get_texts()] == ["90 % of members", "50 % of members", "median"]


def test_what_cannot_be_drawn_is_refused() -> None:
    with pytest.raises(ValueError, match='no column "twist" was recorded; there are torque, output_angle'):
        ensemble(MEMBERS, {}).plot(["twist"])
    with pytest.raises(ValueError, match="none of the 1 members has a result; the first failed: it diverged"):
        ensemble(np.full((1, 5), np.nan), {0: "it diverged"}).plot()
    with pytest.raises(ValueError, match="names is empty"):
        ensemble(MEMBERS, {}).plot([])


def test_a_member_is_a_recording_with_a_plot_of_its_own() -> None:
    runs = sw.simulate_many(
        sw.Drive(load=sw.loads.Inertia(inertia=0.01)), sw.scenario.step(5.0, 0.1), {"load.inertia": [0.01, 0.02]}, sample=1e-3
    )
    assert runs.member(1).plot(["torque"]).get_suptitle() == "member 1"
