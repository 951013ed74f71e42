"""What all parts of the benchmark say in the same way: the machine, the versions, the date; tables, figures, files."""

from __future__ import annotations

import json
import os
import platform
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any

from reference import FOLDER
from rich.box import SIMPLE_HEAD
from rich.markup import escape
from rich.table import Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DISTRIBUTIONS = ("strainwave", "numpy", "scipy", "numba", "casadi", "scikit-sundae", "diffrax", "jax")


@dataclass(frozen=True)
class Column:
    """Of a table: its heading, and whether it holds words rather than numbers."""

    heading: str
    words: bool = False


def installed(distribution: str) -> bool:
    """Whether pip knows it here."""
    try:
        metadata.version(distribution)
    except metadata.PackageNotFoundError:
        return False
    return True


def three_digits(value: float) -> str:
    """At least three significant digits, without exponent."""
    return f"{value:.3g}" if value < 1000.0 else f"{value:.0f}"


def table(title: str, columns: Sequence[Column], rows: Sequence[Sequence[str]], caption: str = "") -> Table:
    """Words on the left, numbers on the right."""
    view = Table(title=title, caption=caption or None, box=SIMPLE_HEAD, padding=(0, 1, 0, 0), show_edge=False)
    for column in columns:
        view.add_column(escape(column.heading), justify="left" if column.words else "right", no_wrap=column.words)
    for row in rows:
        view.add_row(*row)
    return view


def processor() -> str:
    """As Linux tells it, else as Python does."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.exists() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor()


def circumstances() -> dict[str, Any]:
    """What the figures depend on besides the code."""
    versions = {name: metadata.version(name) for name in DISTRIBUTIONS if installed(name)}
    return {
        "date": datetime.now(UTC).date().isoformat(),
        "machine": {"platform": platform.platform(), "processor": processor(), "cores": os.cpu_count()},
        "versions": {"python": platform.python_version(), **versions},
    }


def save(part: str, results: Sequence[Any], **others: Any) -> None:
    """Writes the results, dataclasses, of a part to its JSON file, with what they depend on."""
    content = circumstances() | others | {"results": [asdict(result) for result in results]}
    FOLDER.mkdir(parents=True, exist_ok=True)
    partial = FOLDER / f"{part}.json.partial"
    partial.write_text(json.dumps(content, indent=1, allow_nan=False))
    os.replace(partial, FOLDER / f"{part}.json")


def figure(width: float = 7.0, height: float = 5.0) -> Figure:
    """An empty one [inch]."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def save_figure(part: str, drawn: Figure) -> None:
    """Writes a figure as SVG, with machine, versions and date below."""
    told = circumstances()
    machine = told["machine"]
    versions = ", ".join(f"{name} {version}" for name, version in told["versions"].items())
    drawn.supxlabel(f"{machine['processor']}, {machine['cores']} cores, {told['date']}\n{versions}", fontsize=6)
    FOLDER.mkdir(parents=True, exist_ok=True)
    partial = FOLDER / f"{part}.partial.svg"
    drawn.savefig(partial)
    os.replace(partial, FOLDER / f"{part}.svg")
