"""What this library is to reach, and what the tables of a run say of it.

Reads what the parts have written to build/benchmarks/. A ratio to a solver is the smallest among its settings that reach the
wanted accuracy: time over that of strainwave's cheapest setting with errors no larger, as in the tables.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import ensemble
import single
from measure import Result
from report import RUN, Column, circumstances, print_table, saved, three_digits, write_json
from rich.console import Console
from strainwave import _core

Content = Mapping[str, Any]  # of the JSON file of a part
LEAD_OVER_PRANGE = 12 if _core.instruction_set() == "avx512" else 8

COLUMNS = (
    Column("target", words=True),
    Column("aim"),
    Column("measured"),
    Column("reached", words=True),
    Column("remark", words=True, long=True),
)


@dataclass(frozen=True)
class Found:
    """A measured number, if there is one, and what is to be said of it."""

    value: float | None
    remark: str = ""


@dataclass(frozen=True)
class Target:
    """What; which part's table tells, and how it is found there; the aim, and whether it is the most that it may be."""

    what: str
    part: str
    aim: float
    most: bool
    found: Callable[[Content], Found]

    def reached(self, value: float | None) -> bool | None:
        """None where nothing was measured."""
        if value is None:
            return None
        return value <= self.aim if self.most else value >= self.aim


def lead(rows: Sequence[tuple[str, bool, float | None]]) -> Found:
    """The smallest of the ratios of (setting, accurate, ratio), of those accurate if there are any."""
    accurate = [row for row in rows if row[1]]
    known = [(ratio, setting) for setting, _, ratio in accurate or rows if ratio is not None]
    if not known:
        return Found(None, "more accurate than all settings of strainwave" if rows else "not measured")
    ratio, setting = min(known)
    return Found(ratio, setting if accurate else f"{setting}; misses the wanted accuracy, as all its settings")


def results(content: Content) -> list[Result]:
    return [Result(**row) for row in content["results"] if "reason" not in row]


def ahead_of(*solvers: str) -> Callable[[Content], Found]:
    """Lead over these solvers, one trajectory."""

    def found(content: Content) -> Found:
        all_results = results(content)
        return lead(
            [
                (f"{each.solver}, {each.setting}", each.accurate, single.ratio(each, all_results, lambda one: one.wall_time))
                for each in all_results
                if each.solver in solvers
            ]
        )

    return found


def rates(content: Content) -> list[ensemble.Rate]:
    return [ensemble.Rate(Result(**row["first"]), row["members"], row["threads"]) for row in content["results"]]


def label(rate: ensemble.Rate) -> str:
    return f"{rate.first.solver}, {rate.first.setting}, {rate.threads} thread{'s' * (rate.threads > 1)}"


def many_ahead_of(solver: str) -> Callable[[Content], Found]:
    """Lead over this solver of many trajectories."""

    def found(content: Content) -> Found:
        all_rates = rates(content)
        return lead(
            [
                (label(each), each.first.accurate, ensemble.ratio(each, all_rates, lambda rate: rate.trajectories))
                for each in all_rates
                if each.first.solver == solver
            ]
        )

    return found


def two_threads(content: Content) -> Found:
    """Of the fastest instruction set; the smallest over its settings."""
    own = [rate for rate in rates(content) if rate.first.solver.startswith(ensemble.BASELINE)]
    if not own:
        return Found(None, "not measured")
    solver = max(own, key=lambda rate: rate.trajectories).first.solver
    speeds = {(rate.threads, rate.first.setting): rate.trajectories for rate in own if rate.first.solver == solver}
    gains = [(two / speeds[1, setting], setting) for (threads, setting), two in speeds.items() if threads == 2]
    return Found(min(gains)[0], f"{solver}, {min(gains)[1]}") if gains else Found(None, "not measured")


def beside(compare: Callable[[float, float], float], *words: str) -> Callable[[Content], Found]:
    """Times without and with something, compared."""

    def found(content: Content) -> Found:
        for extra in content["results"]:
            if all(word in extra["what"] for word in words):
                return Found(compare(extra["without"], extra["including"]), extra["what"])
        return Found(None, "not measured")

    return found


def sticking_over_smooth(content: Content) -> Found:
    packs = {cost["friction"]: cost["pack"] for cost in content["costs"]}
    return Found(packs["viscous, smooth"] / packs["Stribeck, sticks"])


def of_angles(value: Callable[[Content], float]) -> Callable[[Content], Found]:
    """A number of the angles by this package."""

    def found(content: Content) -> Found:
        own = next(row for row in content["results"] if row["method"] == "strainwave")
        return Found(value(own), f"{own['frames']} frames")

    return found


def fit_ahead_of_integrators(content: Content) -> Found:
    """Lead over the fastest of SciPy's integrators."""
    own, *others = content["results"]
    around = [row for row in others if "solve_ivp" in row["name"]]
    fastest = min(around, key=lambda row: float(row["cpu_time"]))
    return Found(fastest["cpu_time"] / own["cpu_time"], f"{fastest['name']}, CPU time")


def time_of_fit(content: Content) -> Found:
    own = content["results"][0]
    return Found(own["wall_time"], f"{own['runs']} runs; {own['cpu_time']:.1f} s of all cores")


def more(without: float, including: float) -> float:
    return including / without - 1.0


def times(without: float, including: float) -> float:
    return including / without


def whole(without: float, including: float) -> float:
    return including


def milliseconds(without: float, including: float) -> float:
    return 1e3 * (including - without)


TARGETS = (
    Target("one trajectory: lead over Numba with the same algorithm", "single", 1.5, False, ahead_of("Numba exponential")),
    Target("plain LSODA or Radau", "single", 1000, False, ahead_of("SciPy LSODA, Numba", "SciPy Radau, Numba")),
    Target("CasADi CVODES", "single", 100, False, ahead_of("CasADi CVODES", "CasADi CVODES, gcc")),
    Target("scikit-sundae CVODE", "single", 300, False, ahead_of("CVODE, Numba")),
    Target(
        "tilt actuator, staged gear: lead over CVODES", "actuator", 50, False, ahead_of("CasADi CVODES", "CasADi CVODES, gcc")
    ),
    Target("ensemble: lead over Numba prange", "ensemble", LEAD_OVER_PRANGE, False, many_ahead_of("Numba prange, exponential")),
    Target("diffrax vmap", "ensemble", 1000, False, many_ahead_of("diffrax vmap, Tsit5")),
    Target("two threads over one", "ensemble", 1.9, False, two_threads),
    Target("sticking over smooth, packs", "stick_slip", 1.4, True, sticking_over_smooth),
    Target("a call [ms]", "overhead", 0.2, True, beside(milliseconds, "a call")),
    Target("storing, one", "overhead", 0.05, True, beside(more, "storing all", "simulate")),
    Target("storing, many, all outputs", "overhead", 0.05, True, beside(more, "storing all", "simulate_many")),
    Target("storing, many, 4 outputs", "overhead", 0.05, True, beside(more, "storing 4")),
    Target("12 derivatives [runs]", "overhead", 6, True, beside(times, "12 derivatives")),
    Target("a cascade at 1 kHz over a continuous one", "overhead", 1.5, True, beside(times, "cascade", "delay of 0.3 ms")),
    Target("import of the package [s]", "overhead", 0.3, True, beside(whole, "import strainwave")),
    Target("strainwave --help [s]", "overhead", 0.3, True, beside(whole, "strainwave --help")),
    Target("fit of a whole drive: lead over solve_ivp", "drive_fit", 50, False, fit_ahead_of_integrators),
    Target("its time [s]", "drive_fit", 3, True, time_of_fit),
    Target("angle of a target: rms error [µrad]", "marker_angle", 26, True, of_angles(lambda own: 1e6 * own["rms"])),
    Target("its bias [µrad]", "marker_angle", 2, True, of_angles(lambda own: 1e6 * abs(own["bias"]))),
    Target("CPU time of a frame of 640 x 480 [ms]", "marker_angle", 5, True, of_angles(lambda own: 1e3 * own["cpu_time"])),
)


@dataclass(frozen=True)
class Verdict:
    """On a target: as in the table."""

    target: str
    part: str
    aim: float
    at_most: bool
    measured: float | None
    reached: bool | None
    remark: str


def verdicts(tables: Mapping[str, Content]) -> Iterator[Verdict]:
    """On all targets of these parts."""
    for target in TARGETS:
        if target.part in tables:
            found = target.found(tables[target.part])
            reached = target.reached(found.value)
            yield Verdict(target.what, target.part, target.aim, target.most, found.value, reached, found.remark)


def run(console: Console) -> None:
    """Prints the targets of all parts whose tables are there, and writes them."""
    parts = dict.fromkeys(target.part for target in TARGETS)
    tables = {part: content for part in parts if (content := saved(part)) is not None}
    judged = list(verdicts(tables))
    print_table(console, "Targets", COLUMNS, [row(each) for each in judged], "; ".join(remarks(parts, tables)))
    runs = {part: content["run"] for part, content in tables.items()}
    write_json("targets", circumstances() | {"runs": runs, "results": [vars(each) for each in judged]})


def remarks(parts: Iterable[str], tables: Mapping[str, Content]) -> Iterator[str]:
    """What is missing, and what is not of this run."""
    for part in parts:
        if part not in tables:
            yield f"{part} was not run"
            continue
        if tables[part]["run"] != RUN:
            yield f"{part} is of another run, {tables[part]['run']}"
        if tables[part].get("quick"):
            yield f"{part} took one run each"


def row(each: Verdict) -> list[str]:
    measured = "-" if each.measured is None else three_digits(each.measured)
    said = {None: "-", True: "yes", False: "no"}[each.reached]
    return [each.target, f"{'<=' if each.at_most else '>='} {each.aim:g}", measured, said, each.remark]
