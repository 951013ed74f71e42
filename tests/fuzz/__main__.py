"""Hostile input, thrown at all that users can reach.

    python -m tests.fuzz                              ten thousand cases of all kinds, some minutes
    python -m tests.fuzz --cases 100000 --processes 2
    python -m tests.fuzz --kind csv --first 123 --cases 1

Each case must end in a result that makes sense, or be refused: by one of the errors that are documented, whose message is
one line that a terminal shows as it is. Nothing else may appear on the terminal, no process may end or hang, no file may be
half written. What is read must be finite, and the same when it is written and read again. Case n of a kind is the same on
every machine.
"""

from __future__ import annotations

import argparse
import os
import time
from collections import Counter, defaultdict
from collections.abc import Iterable

from tests.fuzz.laws import Outcome
from tests.fuzz.run import Task, outcomes


def tell(found: dict[str, list[tuple[Task, Outcome]]], seconds: float, longest: int) -> None:
    """What was tried of each kind, then what is wrong, once for each sort of it."""
    print(f"\n{'kind':14}{'tried':>8}{'accepted':>10}{'refused':>9}{'wrong':>7}{'ms each':>9}{'slowest':>9}")
    for kind, each in sorted(found.items()):
        count = Counter(outcome.verdict for _, outcome in each)
        took = [outcome.took for _, outcome in each]
        print(
            f"{kind:14}{len(each):8d}{count['accepted']:10d}{count['refused']:9d}{count['wrong']:7d}"
            f"{1e3 * sum(took) / len(took):9.1f}{max(took):7.2f} s"
        )
    print(f"{seconds:.0f} s")
    for kind, each in sorted(found.items()):
        for sort, those in sorted(_sorts(each).items(), key=lambda item: -len(item[1])):
            task, outcome = min(those, key=lambda one: one[0].number)
            print(f"\n{len(those)} x {kind}: {_visible(sort)}")
            print(f"    said   {_visible(outcome.words)[:longest]}")
            print(f"    input  {_visible(outcome.what)[:longest]}")
            print(f"    again  python -m tests.fuzz --kind {kind} --first {task.number} --cases 1")


def _sorts(each: Iterable[tuple[Task, Outcome]]) -> dict[str, list[tuple[Task, Outcome]]]:
    """What is wrong, by its sort."""
    sorts = defaultdict(list)
    for task, outcome in each:
        if outcome.verdict == "wrong":
            sorts[outcome.fault].append((task, outcome))
    return sorts


def _visible(text: str) -> str:
    return "".join(character if character.isprintable() else repr(character)[1:-1] for character in text)


def main() -> None:
    from tests.fuzz.kinds import KINDS, kind_of

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=int, default=10_000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--kind", choices=sorted(KINDS), action="append", help="this kind only; may be given again")
    parser.add_argument("--processes", type=int, default=os.cpu_count())
    parser.add_argument("--longest", type=int, default=400, help="characters to show of an input or a message")
    options = parser.parse_args()
    numbers = range(options.first, options.first + options.cases)
    chosen = sorted(set(options.kind or ()))
    tasks = (Task(chosen[n % len(chosen)] if chosen else kind_of(n), n) for n in numbers)
    found: dict[str, list[tuple[Task, Outcome]]] = defaultdict(list)
    began = time.perf_counter()
    try:
        for done, (task, outcome) in enumerate(outcomes(tasks, options.processes), start=1):
            found[task.kind].append((task, outcome))
            if done % max(options.cases // 20, 1) == 0:
                wrong = sum(one.verdict == "wrong" for each in found.values() for _, one in each)
                print(f"{done} cases, {wrong} wrong, {time.perf_counter() - began:.0f} s", flush=True)
    finally:
        tell(found, time.perf_counter() - began, options.longest)
    raise SystemExit(any(one.verdict == "wrong" for each in found.values() for _, one in each))


if __name__ == "__main__":
    main()
