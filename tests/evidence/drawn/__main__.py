"""Count the records of each kind that come out right, refused and wrong: `python -m tests.evidence.drawn KIND --count 200`.

Each module of this folder with a function `outcome(seed) -> Outcome` is a kind: it draws a record by a program that shares
nothing with the package but formats, and compares what `orders` or `identify` make of it with the truth. At least 95 % must be
right within 2.5 standard deviations or refused in words.
"""

from __future__ import annotations

import argparse
import importlib
import pkgutil
import sys
import time
import warnings
from collections import Counter
from pathlib import Path

MAX_WRONG_SHARE = 0.05  # of the records of a kind
KINDS = sorted(
    each.name
    for each in pkgutil.iter_modules([str(Path(__file__).parent)])
    if each.name not in ("__main__", "outcome", "joint")
)


def counted(kind: str, count: int, first: int) -> Counter[str]:
    """Return how many records of a kind have each verdict; print those that are wrong."""
    module = importlib.import_module(f"tests.evidence.drawn.{kind}")
    verdicts = Counter[str]()
    for seed in range(first, first + count):
        with warnings.catch_warnings(action="ignore"):
            outcome = module.outcome(seed)
        verdicts[outcome.verdict] += 1
        if outcome.verdict == "wrong":
            print(f"  {kind} {seed}: {outcome.message}", flush=True)
    return verdicts


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("kinds", nargs="*", choices=[*KINDS, []], default=KINDS, metavar="KIND", help=", ".join(KINDS))
    parser.add_argument("--count", type=int, default=200, help="records of each kind")
    parser.add_argument("--first", type=int, default=0, help="seed of the first record")
    options = parser.parse_args()
    failed = False
    for kind in options.kinds:
        begun = time.process_time()
        verdicts = counted(kind, options.count, options.first)
        failed |= verdicts["wrong"] > MAX_WRONG_SHARE * options.count
        words = ", ".join(f"{verdicts[verdict]} {verdict}" for verdict in ("right", "refused", "wrong"))
        print(
            f"{kind}: {words}; {(time.process_time() - begun) / max(options.count, 1):.2f} s of the processor each", flush=True
        )
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
