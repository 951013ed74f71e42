"""The command `strainwave demo`: a joint from its log, and two gears from published measurements."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from strainwave.commands.options import folder
from strainwave.progress import in_turn

OWN_LOG = """\
Your own log: name its gear, or one of its size and ratio (strainwave list gears), and the torque constant of the motor:
  strainwave identify hfuc-20-80 YOUR-LOG.csv --constant torque_constant=0.0755
The tutorials, which begin with this log:
  strainwave docs"""


def demo(out: Annotated[Path, folder("Folder for the results.")] = Path("out/demo")) -> None:
    """Identify a robot joint and two published gears, as an example.

    Each gets a gear file and a report.

    Examples:
        strainwave demo
        strainwave demo --out shown
    """
    from strainwave.demo import DEMONSTRATIONS
    from strainwave.files.writing import write_folder
    from strainwave.report.first_screen import next_lines
    from strainwave.report.identify_files import identify_files, identify_summary
    from strainwave.report.provenance import Provenance

    with in_turn(None) as turn:
        for name, shown in DEMONSTRATIONS.items():
            turn(name.replace("-", " "))
            result, folder = shown.identified(), out / name
            provenance = Provenance.of_this_command(list(shown.files))
            write_folder(folder, identify_files(result, provenance, accepted=True, folder=folder, remark=shown.remark))
            print("\n".join([shown.heading, "", *identify_summary(result), *[shown.remark] * bool(shown.remark)]))
            print(f"wrote {folder / 'gear.toml'} and {folder / 'report.html'}")
            print("\n".join([*next_lines(result, folder), ""]))
    print(OWN_LOG)
