"""Gears in the hosts of others, as a table: `python -m tests.hosts [--gear NAME] [--host WORD]`.

Each gear is a file. The first command is the one of the host's page. The host then moves the gear as its user would: a command
to and fro, in open loop for MJCF. Agreement is the RMS difference to `sw.simulate` over the range of the quantity; of BAM and
URDF that of the friction over speeds. Steps per second of processor time on this machine are communication steps of FMPy,
timesteps of MuJoCo, calls of firmware, joints times steps of Newton. Nothing is written by hand.
"""

from __future__ import annotations

import argparse
import math
import tempfile
from pathlib import Path

import strainwave as sw

from tests.hosts.gears import gear_files
from tests.hosts.hosts import HOSTS, Compared, Outcome, outcome
from tests.hosts.robot import UR10E, robots

MAX_LOST = 110  # characters of what is lost


def row(gear: str, host: str, found: Outcome) -> str:
    """Return a row of the table."""
    compared, rate = str(found.compared), "-"
    if isinstance(found.compared, Compared):
        compared = f"{found.compared.share:.1e} of the {found.compared.quantity}"
        rate = "-" if math.isnan(found.compared.rate) else f"{found.compared.rate:.2g}"
    lost = "; ".join(each.partition(";")[0].partition(":")[0] for each in found.lost) or "-"
    if len(lost) > MAX_LOST:
        lost = lost[:MAX_LOST].rpartition(";")[0] + "; …"
    return f"| {host} | {gear} | {found.works} | {compared} | {rate} | {lost} |"


def main() -> None:
    """Print the table, row by row."""
    parser = argparse.ArgumentParser(prog="python -m tests.hosts", description="Gears in the hosts of others, as a table.")
    parser.add_argument("--gear", default="", help="a word of its name: hysteresis, LuGre, staged, identified")
    parser.add_argument("--host", default="", help="a word of its name")
    chosen = parser.parse_args()
    print("| host | gear | first command works | agreement | steps/s | lost |\n|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        files = [(name, path) for name, path in gear_files(folder) if chosen.gear in name]
        for number, host in enumerate(each for each in HOSTS if chosen.host.lower() in each.name.lower()):
            for name, path in files:
                print(row(name, host.name, outcome(host, sw.GearSet.read(path), folder / f"{number}_{name}")), flush=True)
        if chosen.host.lower() in "mujoco, robots":
            for name, host_name, found in robots(folder):
                print(row(name, host_name, found), flush=True)
            if not UR10E.exists():
                print(f"| MuJoCo, UR10e | - | not tried: {UR10E.name} is not there | - | - | - |")


if __name__ == "__main__":
    main()
