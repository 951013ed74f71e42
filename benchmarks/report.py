"""What all parts of the benchmark say in the same way: the machine, the versions, the date; tables, figures, files."""

from __future__ import annotations

import json
import os
import platform
import re
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Any

from reference import FOLDER
from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.markup import escape
from rich.table import Table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TABLES = FOLDER / "tables"  # as the page of the documentation has them
RUN = datetime.now(UTC).isoformat(timespec="seconds")  # which run a table is of: when its process began
DISTRIBUTIONS = ("strainwave", "numpy", "scipy", "numba", "casadi", "scikit-sundae", "diffrax", "jax", "scikit-image", "mujoco")


@dataclass(frozen=True)
class Column:
    """Of a table: its heading, and whether it holds words rather than numbers, which may take several lines."""

    heading: str
    words: bool = False
    long: bool = False


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


def print_table(
    console: Console, title: str, columns: Sequence[Column], rows: Sequence[Sequence[str]], caption: str = ""
) -> None:
    """Print a table, words left and numbers right, and keep it for the page of the documentation."""
    console.print(table(title, columns, rows, caption))
    rule = ["---" if column.words else "---:" for column in columns]
    lines = [f"| {' | '.join(cells)} |" for cells in ([column.heading for column in columns], rule, *rows)]
    TABLES.mkdir(parents=True, exist_ok=True)
    (TABLES / f"{re.sub('[^a-z]+', '_', title.lower()).strip('_')}.md").write_text("\n".join(lines) + "\n")


def table(title: str, columns: Sequence[Column], rows: Sequence[Sequence[str]], caption: str) -> Table:
    view = Table(title=title, caption=caption or None, box=SIMPLE_HEAD, padding=(0, 1, 0, 0), show_edge=False)
    for column in columns:
        view.add_column(
            escape(column.heading), justify="left" if column.words else "right", no_wrap=column.words and not column.long
        )
    for row in rows:
        view.add_row(*map(escape, row))
    return view


def processor() -> str:
    """As Linux tells it, else as Python does."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text().splitlines() if info.exists() else []
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor()


def compiler() -> str:
    """What compiled strainwave, as its binary says; else the compiler that is here."""
    from strainwave import _core

    said = re.search(rb"GCC: \([^)]*\) [\d.]+|clang version [\d.]+", Path(_core.__file__).read_bytes())
    if said:
        return said[0].decode()
    try:
        told = subprocess.run([os.environ.get("CXX", "c++"), "--version"], capture_output=True, text=True, check=True).stdout
    except OSError:
        return "unknown"
    return "here: " + told.partition("\n")[0]


@cache
def circumstances() -> dict[str, Any]:
    """What the figures depend on besides the code."""
    versions = {name: metadata.version(name) for name in DISTRIBUTIONS if installed(name)}
    return {
        "run": RUN,
        "date": RUN[:10],
        "machine": {"platform": platform.platform(), "processor": processor(), "cores": os.cpu_count()},
        "versions": {"compiler": compiler(), "python": platform.python_version(), **versions},
    }


def save(part: str, results: Sequence[Any], **others: Any) -> None:
    """Writes the results, dataclasses, of a part to its JSON file, with what they depend on."""
    write_json(part, circumstances() | others | {"results": [asdict(result) for result in results]})


def saved(part: str) -> dict[str, Any] | None:
    """What `save` has written last, if anything."""
    kept = FOLDER / f"{part}.json"
    return json.loads(kept.read_text()) if kept.exists() else None


def write_json(part: str, content: Mapping[str, Any]) -> None:
    """Beside its place and then there."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    partial = FOLDER / f"{part}.json.partial"
    partial.write_text(json.dumps(content, indent=1, allow_nan=False))
    os.replace(partial, FOLDER / f"{part}.json")


def figure(width: float = 7.0, height: float = 5.0) -> Figure:
    """An empty one [inch]."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def save_figure(part: str, drawn: Figure, told: Mapping[str, Any] | None = None, folder: Path = FOLDER) -> None:
    """Writes a figure as SVG, with machine, versions and date below: these, or those of now."""
    import matplotlib as mpl

    told = told or circumstances()
    machine, names = told["machine"], [f"{name} {version}" for name, version in told["versions"].items()]
    runs = ", one run each" if told.get("quick") else ""
    lines = [
        f"{machine['processor']}, {machine['cores']} cores, {told['date']}{runs}",
        ", ".join(names[:5]),
        ", ".join(names[5:]),
    ]
    drawn.supxlabel("\n".join(lines).strip(), fontsize=6, color="0.4")
    folder.mkdir(parents=True, exist_ok=True)
    partial = folder / f"{part}.partial.svg"
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": part, "font.sans-serif": ["DejaVu Sans", "Verdana", "Arial"]}):
        drawn.savefig(partial, metadata={"Date": None})
    os.replace(partial, folder / f"{part}.svg")
