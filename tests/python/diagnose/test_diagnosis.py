"""Rows and texts of a diagnosis: the threshold of a row is that of all its amplitudes, and no text is printed twice."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from math import sqrt, tau

import numpy as np
import pytest
import strainwave as sw
from strainwave.diagnose.detection import FALSE_ALARM, threshold_of
from strainwave.diagnose.diagnosis import Diagnosis, Question, RunDiagnosis, diagnosed
from strainwave.diagnose.geometry import Geometry, Sensitivity
from strainwave.diagnose.inversion import MisalignmentEstimate
from strainwave.diagnose.possible_drives import CurrentPerError
from strainwave.diagnose.refusals import JointRecording, usable
from strainwave.report.diagnose import diagnose_summary

UNITS = {"time": "s", "input_angle": "rad", "current": "A"}


def slow_forth_fast_back(seed: int, question: Question, refused: Mapping[str, str] | None = None) -> Diagnosis:
    """A motor that turns 20 revolutions forth in 30 s and back in 10 s: fewer samples have more noise."""
    time = np.arange(0.0, 40.0, 0.01)
    angle = 20.0 * tau * np.interp(time, [0.0, 30.0, 40.0], [0.0, 1.0, 0.0])
    noise = np.random.default_rng(seed).normal(0.0, 0.05, len(time))
    current = 0.4 * np.where(time < 30.0, 1.0, -1.0) + 0.01 * np.cos(2.0 * angle) + noise
    run = usable(sw.Recording({"time": time, "input_angle": angle, "current": current}, UNITS), "run", ratio=100.0)
    return diagnosed([run], question, refused=refused)


def test_a_row_is_within_noise_if_no_amplitude_is_above_the_threshold_that_it_states() -> None:
    found = [each for seed in range(6) for each in slow_forth_fast_back(seed, Question(ratio=100.0)).runs[0].orders]
    for row in found:
        cells = [cell for cell in (row.forward, row.backward) if cell is not None]
        own = [cell.sigma * sqrt(2.0 * threshold_of(FALSE_ALARM, 2, cell.freedom, 6)) for cell in cells]
        assert len(own) == 2
        assert max(own) > 1.2 * min(own)
        assert row.threshold == max(own)
        assert row.detected == (max(cell.amplitude for cell in cells) > row.threshold)
    assert {row.detected for row in found} == {True, False}


def test_an_order_that_is_asked_for_has_no_error_that_would_be_seen() -> None:
    """Its cause is not known: the ball of a bearing changes friction, which is no kinematic error."""
    run = slow_forth_fast_back(0, Question(ratio=100.0, orders=(3.5,))).runs[0]
    rows = {row.order.per_input: row for row in run.orders}
    assert np.isfinite(rows[2.0].error)
    assert np.isnan(rows[3.5].error)


def test_the_reason_of_a_refusal_has_the_name_of_the_recording_once(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(run: JointRecording, *_: object) -> RunDiagnosis:
        raise ValueError(f"{run.name}: too uneven")

    monkeypatch.setattr("strainwave.diagnose.diagnosis._run", refuse)
    with pytest.raises(ValueError, match=r"^rest.csv: at rest; run: too uneven$"):
        slow_forth_fast_back(0, Question(), {"rest.csv": "at rest"})


def test_a_doubt_of_the_misalignment_is_printed_once() -> None:
    found = slow_forth_fast_back(0, Question(ratio=100.0))
    doubt = "The current contradicts the drives of this set"
    estimate = MisalignmentEstimate("current", "mean", (1e-6, 0.0), 1e-14 * np.eye(2), 10, 1.0)
    none = np.zeros(4, dtype=complex)
    parts = CurrentPerError(np.arange(1.0, 5.0), none, none, 1.0)
    sensitivity = Sensitivity(3e-4, 2.0, 1e-3, 1e-4, 1.0, 1.0)
    geometry = Geometry(estimate, np.zeros(2), np.eye(2), {}, 1e-5, False, sensitivity, parts, 0.01, (doubt,))
    text = diagnose_summary([replace(found, runs=(replace(found.runs[0], geometry=geometry),))])
    assert " ".join(text.split()).count(doubt) == 1
