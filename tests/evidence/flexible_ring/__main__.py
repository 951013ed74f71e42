"""Write the files of drawn gears: `python -m tests.evidence.flexible_ring FOLDER --seed 3 --speeds 48`."""

from __future__ import annotations

import argparse
from pathlib import Path

from tests.evidence.flexible_ring.files import write
from tests.evidence.flexible_ring.records import drawn_experiment

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--speeds", type=int, default=48)
    parser.add_argument("--tables-only", action="store_true")
    options = parser.parse_args()
    write(drawn_experiment(options.seed, options.speeds), options.folder, records=not options.tables_only)
