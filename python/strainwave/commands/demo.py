"""The command `strainwave demo`: gears from published measurements, and published experiments simulated with one of them."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer


def demo(out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("out/demo")) -> None:
    """Identify two gears from published measurements, and simulate published experiments with one of them."""
    from rich.console import Console

    from strainwave.commands.identify import files_to_write, summary
    from strainwave.demo import PUBLISHED, experiments, position_drive, torsion_rig
    from strainwave.files.writing import write_folder
    from strainwave.report.provenance import Provenance

    with Console(stderr=True).status("reading") as status:
        for name, identify in (("torsion-rig", torsion_rig), ("position-drive", position_drive)):
            status.update(name.replace("-", " "))
            found = identify()
            runs = experiments(found) if name == "position-drive" else []
            published = PUBLISHED.glob(f"{'torsional' if name == 'torsion-rig' else 'position'}*")
            provenance = Provenance.of_this_command(published)
            write_folder(out / name, files_to_write(found, provenance, accept=True, experiments=runs))
            print("\n".join(summary(found)))
            print(f"wrote {out / name / 'gear.toml'} and {out / name / 'report.html'}")
