"""The command `strainwave demo`: two gears from published measurements."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from strainwave.commands.progress import progress

EXPECTED = (
    "This failed check is part of the demonstration: the friction table of document P contradicts the friction in its other "
    "tables (errata E-P6 and E-P7). Of your own measurements identify would write no gear."
)


def demo(out: Annotated[Path, typer.Option(help="Folder for the results.")] = Path("out/demo")) -> None:
    """Identify two gears from published measurements, and write a gear file and a report of each."""
    from strainwave.demo import PUBLISHED, position_drive, torsion_rig
    from strainwave.files.writing import write_folder
    from strainwave.report.identify_files import identify_files, identify_summary
    from strainwave.report.provenance import Provenance

    with progress() as turn:
        for name, identify in (("torsion-rig", torsion_rig), ("position-drive", position_drive)):
            turn(name.replace("-", " "))
            found = identify()
            published = PUBLISHED.glob(f"{'torsional' if name == 'torsion-rig' else 'position'}*")
            provenance = Provenance.of_this_command(published)
            write_folder(out / name, identify_files(found, provenance, accepted=True))
            print("\n".join(identify_summary(found)))
            if found.failed and name == "position-drive":
                print(EXPECTED)
            print(f"wrote {out / name / 'gear.toml'} and {out / name / 'report.html'}")
