"""`strainwave diagnose misalignment`: what it prints and writes, and what it refuses."""

from __future__ import annotations

from pathlib import Path

import pytest
import strainwave as sw

from tests.python.command import refused, strainwave

LUMPED = "tilt-actuator-lumped"


@pytest.mark.slow("diagnose")
def test_the_command_prints_the_levels_and_writes_the_sweeps(tmp_path: Path) -> None:
    result = strainwave("diagnose", "misalignment", LUMPED, "--stroke", "20", "--time", "1", "--out", "found", folder=tmp_path)
    assert result.returncode == 0, result.stderr
    names = {f"levels-{combine}-{loop}.csv" for combine in sw.diagnose.COMBINE for loop in sw.diagnose.LOOPS}
    assert {path.name for path in (tmp_path / "found").iterdir()} == names
    table = sw.Recording.read(tmp_path / "found" / "levels-single-output.csv")
    assert table["housing_eccentricity"][:5].tolist() == [0.0, 10e-6, 20e-6, 40e-6, 80e-6]
    lines = result.stdout.splitlines()
    assert sum(line.startswith("loop on the output sensor") for line in lines) == 2
    row = next(line for line in lines if line.startswith("e₁ = 20 µm, one lobe carries"))
    assert float(row.split()[-3]) == pytest.approx(1e3 * table["current_swing"][2], rel=6e-3)


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ((LUMPED, "--stroke", "-5"), "stroke = -5.0 deg must lie in (0, inf)"),
        ((LUMPED, "--time", "0"), "time = 0.0 s must lie in [1e-06, 600]"),
        ((LUMPED, "--time", "1e-3"), "the drive does not follow a ramp of 90 deg in 0.001 s: its input turns by"),
        ((LUMPED, "--stroke", "1e9"), "stroke = 1e+09 deg is 2.8e+08 turns of the input; take 3.56e+04 deg or less"),
        (("position-drive",), "needs a position loop around a speed loop"),
        (("hfuc-25-100",), "a drive needs a motor and a load"),
    ],
)
def test_wrong_input_is_refused_in_one_line(words: tuple[str, ...], expected: str, tmp_path: Path) -> None:
    refused(tmp_path, ["diagnose", "misalignment", *words], expected)
