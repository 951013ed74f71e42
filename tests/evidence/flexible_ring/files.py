"""Files of an experiment as engineers write them: CSV with units in the header, HDF5, MAT, and the truth as JSON."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from scipy.io import savemat

from tests.evidence.flexible_ring.records import UNITS, Experiment
from tests.evidence.flexible_ring.ring import Array
from tests.evidence.flexible_ring.tables import Table, mesh_table, modes_table

ANGLES_PER_PITCH = 8  # of the mesh table, over one revolution


def write_csv(path: Path, table: Table) -> None:
    """Write a table, names with units as header."""
    np.savetxt(path, np.column_stack(list(table.values())), "%.10g", ",", header=",".join(table), comments="")


def as_grid(table: Table) -> dict[str, Array]:
    """Return a mesh table as axes and arrays over torque and angle, names without units."""
    angle, torque = np.unique(table["wave_generator_angle [rad]"]), np.unique(table["torque [N.m]"])
    names = {name.split(" ")[0]: values for name, values in table.items()}
    return {
        name: angle if name == "wave_generator_angle" else torque if name == "torque" else values.reshape(len(torque), -1)
        for name, values in names.items()
    }


def truth(experiment: Experiment) -> dict[str, Any]:
    """Return what is true of an experiment, in plain numbers."""
    gear, lines = experiment.gear, experiment.lines
    middle = len(lines.speed) // 2
    shown = np.flatnonzero(np.maximum(lines.of_teeth, lines.of_balls).max(axis=0) > 0.2)
    return {
        "ratio": gear.ratio,
        "flexspline_teeth": gear.teeth,
        "circular_spline_teeth": gear.teeth + 2,
        "pitch_radius": gear.wall.radius,
        "pressure_angle": gear.pressure_angle,
        "output_inertia": gear.output_inertia,
        "output_stiffness": gear.output_stiffness,
        "balls": gear.balls,
        "ball_diameter": gear.ball_diameter,
        "pitch_diameter": gear.pitch_diameter,
        "ball_order": gear.ball_order,
        "cage_order": gear.cage_share,
        "tooth_order": gear.teeth,
        "torque": experiment.torque,
        "lines": [
            {
                "natural_frequency": lines.natural_frequency[middle, line],
                "slope": [lines.slope[place, line] for place in (2, middle, -3)],
                "damping": lines.damping[middle, line],
                "waves_of_shape": lines.waves[middle, line],
                "peak_by_teeth": lines.of_teeth[middle, line],
                "peak_by_balls": lines.of_balls[middle, line],
            }
            for line in shown
        ],
        "gear": asdict(gear),
    }


def write(experiment: Experiment, folder: Path, *, records: bool = True) -> None:
    """Write mesh and modes as CSV, HDF5 and MAT, the truth, and the records."""
    folder.mkdir(parents=True, exist_ok=True)
    gear = experiment.gear
    angles = ANGLES_PER_PITCH * gear.teeth
    mesh = mesh_table(gear, 2.0 * np.pi * np.arange(angles) / angles, gear.rated_torque * np.array([0.0, 0.25, 0.5, 1.0]))
    modes = modes_table(gear, experiment.torque)
    write_csv(folder / "mesh.csv", mesh)
    write_csv(folder / "modes.csv", modes)
    grid, plain = as_grid(mesh), {name.split(" ")[0]: values for name, values in modes.items()}
    units = {name.split(" ")[0]: name.split("[")[1].rstrip("]") for name in (*mesh, *modes)}
    with h5py.File(folder / "gear.h5", "w") as file:
        for group, table in (("mesh", grid), ("modes", plain)):
            for name, values in table.items():
                file.create_dataset(f"{group}/{name}", data=values).attrs["unit"] = units[name]
    savemat(folder / "gear.mat", {"mesh": grid, "modes": plain})
    (folder / "truth.json").write_text(json.dumps(truth(experiment), indent=1, default=_plain))
    for place, record in enumerate(experiment.records if records else ()):
        write_csv(folder / f"record{place:02d}.csv", {f"{name} [{UNITS[name]}]": values for name, values in record.items()})


def _plain(value: Any) -> Any:
    return value.tolist() if isinstance(value, np.ndarray | np.generic) else str(value)
