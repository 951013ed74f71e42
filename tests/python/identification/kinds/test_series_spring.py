"""A spring behind the gear, as of a series elastic actuator, whose torque is computed from its twist."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from strainwave.identification.identify import identify
from strainwave.identification.results.file_result import ASSUMED_BY_RECORDER
from strainwave.report.first_screen import is_start_set, next_commands

STIFFNESS = 130.0  # N.m/rad
TIME = np.arange(0.0, 8.0, 0.005)


def written(path: Path, columns: dict[str, np.ndarray]) -> Path:
    np.savetxt(path, np.column_stack(list(columns.values())), "%.9g", ",", header=",".join(columns), comments="")
    return path


@pytest.mark.parametrize("without", ["", "deflection"])
def test_the_spring_is_stated_beside_what_its_torque_does_not_check(tmp_path: Path, without: str) -> None:
    noise = np.random.default_rng(0).normal(0.0, 1.0, (3, len(TIME)))
    joint = 0.4 * np.sin(1.3 * TIME) + 0.15 * np.sin(3.1 * TIME)
    twist = 0.01 * np.sin(1.3 * TIME + 0.7) + 1e-5 * noise[0]
    effort = -STIFFNESS * twist + 5e-3 * noise[1]
    current = 0.1 * np.cos(1.3 * TIME) + 0.01 * noise[2]
    columns = {"time": TIME, "position": joint, "motorPosition": joint + twist, "deflection": twist, "effort": effort}
    columns = {name: values for name, values in columns.items() if name != without}
    found = identify("csg-20-100", [written(tmp_path / "sea.csv", {**columns, "motorCurrent": current})])
    assert found.parameters == ()
    assert not found.failed
    (file,) = found.files
    (spring,) = file.estimates
    assert spring.path == "series_stiffness"
    assert spring.value == pytest.approx(STIFFNESS, abs=0.2)
    assert spring.why == ASSUMED_BY_RECORDER
    assert not np.isfinite(spring.sigma)
    assert found.unchecked["series stiffness"].endswith(" N·m/rad, which the recorder assumed and did not measure")
    assert is_start_set(found)
    assert [command.split()[1] for _, command in next_commands(found, tmp_path)] == ["show"]
    assert any("checks neither it nor effort" in remark for remark in file.remarks)
