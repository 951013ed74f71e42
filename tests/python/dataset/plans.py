"""Plans for tests: small, and quick to run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import tomlkit
from strainwave.dataset.members import Population
from strainwave.dataset.plan import DatasetPlan
from strainwave.dataset.shards import Shards

SMALL: dict[str, Any] = {
    "name": "Small",
    "drive": "tilt-actuator-lumped",
    "seed": 5,
    "shard_members": 8,
    "simulation": {"duration": 0.1, "dt": 5e-4, "sample": 2e-3},
    "units": {"number": 12, "spread": {"motor.resistance": {"relative": 0.1}, "load.inertia": {"low": 0.5, "high": 0.7}}},
    "conditions": [
        {"profile": "constant_speed", "number": 2, "numbers": {"speed": {"low": 0.5, "high": 1.0}}},
        {"profile": "random", "number": 2, "numbers": {"amplitude": 0.1, "bandwidth": 2.0}, "load_torque": 1.0},
    ],
    "features": {"noise": {"current": 0.02, "tracking_error": 1e-5}},
}


def changed(**changes: Any) -> dict[str, Any]:
    """The small plan with other tables."""
    return SMALL | changes


def write(folder: Path, content: dict[str, Any] = SMALL) -> Path:
    path = folder / "plan.toml"
    path.write_text(tomlkit.dumps(content))
    return path


def population(content: dict[str, Any] = SMALL) -> Population:
    return Population(DatasetPlan.of(content))


def shards(content: dict[str, Any] = SMALL) -> Shards:
    return Shards(population(content))
