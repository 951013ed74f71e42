"""Sets and comparisons in words, for a terminal: every number with its unit and its source, modes and ratings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import chain, combinations
from math import inf, tau

import numpy as np

from strainwave import Drive, arguments, typeset
from strainwave.analysis.compare import Agreement, Difference
from strainwave.analysis.error_bounds import positioning_error
from strainwave.analysis.linear import linearise, modes
from strainwave.analysis.strokes import stroke_within, strokes_apart
from strainwave.files.described import parameters, parts
from strainwave.files.entries import NOT_GIVEN
from strainwave.files.gear_file import at_rest
from strainwave.files.gear_set import GearSet
from strainwave.files.ratings import RatingCheck, check_ratings
from strainwave.files.recording import Recording
from strainwave.messages import one_line, shortened
from strainwave.presentation import PAGE_WIDTH

Row = Sequence[str]
RAD_PER_ARCSEC = tau / 360.0 / 3600.0
STROKE_COUNT = 12  # moves of growing stroke
MIN_STROKE_SHARE = 1e-2  # of the largest stroke [1]: the smallest
MIN_CORRELATION = 0.5  # smaller ones are not listed
NO_FREQUENCY = 1e-7  # relative frequency or damping ratio [1] that counts as none: double zeros have the root of the rounding
ROUNDING_SHARE = 1e-12  # of the largest value of a column [1]: smaller values are rounding


def listing(gear_set: GearSet, runs: Mapping[str, Recording] | None = None) -> str:
    """Return a set as text: its name, every number, its modes, its ratings, and where runs exceeded them.

    Args:
        gear_set: the set
        runs: recordings to compare with the ratings, by their names in the text

    >>> print(listing(GearSet.read("csg-25-100")).splitlines()[0])
    CSG-25-100, Harmonic Drive
    """
    if not isinstance(gear_set, GearSet):
        raise TypeError(f"gear_set = {shortened(gear_set)} must be a gear set, as sw.GearSet.read(name) returns it")
    lines = [", ".join(filter(None, (gear_set.name, gear_set.maker)))]
    if gear_set.note:
        lines.append(_printable(gear_set.note))
    for part in parts(Drive()):
        if (model := getattr(gear_set, part.name)) is not None:
            lines += ["", *_numbers(gear_set, part.name, model)]
    lines += [*_covariance(gear_set), *_validation(gear_set)]
    return "\n".join([*lines, *_vibration(gear_set), *_ratings(gear_set), *_checks(gear_set, runs or {})])


def positioning_table(gear_set: GearSet, load: float) -> str:
    """Return the positioning error of the output that a gear makes under a load, in arc seconds.

    >>> positioning_table(GearSet.read("csg-20-100"), 20.0).splitlines()[2].split()[5:7]  # typical, and the bound
    ['24', '48']
    """
    rows: list[Row] = [("", "typical", "bound", "why")]
    rows += [
        (each.name, f"{each.typical / RAD_PER_ARCSEC:.3g}", f"{each.bound / RAD_PER_ARCSEC:.3g}", each.why)
        for each in positioning_error(gear_set, load=load)
    ]
    return "\n".join(["positioning error at the output [arcsec]", *aligned(rows, "<>><")])


def agreement_table(found: Sequence[Agreement]) -> str:
    """Return how far columns of two recordings agree, one to a line.

    >>> print(agreement_table([Agreement("torque", "N.m", rms=0.05, largest=0.1, time=2.0, correlation=0.99, samples=200)]))
            unit   rms  largest  at t [s]  correlation
    torque  N.m   0.05      0.1         2         0.99
    """
    rows = [("", "unit", "rms", "largest", "at t [s]", "correlation")]
    for each in found:
        related = "one is constant" if each.correlation is None else f"{each.correlation:.6f}".rstrip("0").rstrip(".")
        rows.append((each.name, each.unit, f"{each.rms:.4g}", f"{each.largest:.4g}", f"{each.time:.6g}", related))
    return "\n".join(aligned(rows, "<<>>>>"))


def difference_table(found: Sequence[Difference]) -> str:
    """Return the places where two models differ, one to a line; differences in standard deviations where both sets state them.

    Names for which the width of a page has no room have a line of their own.

    >>> print(difference_table([Difference("gear.damping", 4.0, 5.0, "N.m.s/rad", 0.5), Difference("motor", None, "dc")]))
                    first  second  unit       change    σ
    gear.damping        4       5  N.m.s/rad   +25 %  2.0
    motor         nothing      dc
    """
    rows = [("", "first", "second", "unit", "change", "σ")]
    for each in found:
        change = "" if each.change is None else f"{100.0 * each.change:+.3g} %"
        apart = "" if each.deviations is None else f"{abs(each.deviations):.1f}"
        rows.append((each.path, *each.texts, "" if each.unit == "1" else each.unit, change, apart))
    columns = 6 if any(apart for *_, apart in rows[1:]) else 5
    cells, sides = [row[:columns] for row in rows], "<>><>>"[:columns]
    left = PAGE_WIDTH - max(map(len, aligned([("", *row[1:]) for row in cells], sides)))
    names = [_printable(name) if len(name) > left else "" for name, *_ in cells]
    lines = aligned([("" if name else row[0], *row[1:]) for name, row in zip(names, cells, strict=True)], sides)
    return "\n".join(chain.from_iterable([name, line] if name else [line] for name, line in zip(names, lines, strict=True)))


def stroke_table(first: Drive, second: Drive, stroke: float, tolerance: float) -> str:
    """Return the difference of two drives over moves of growing stroke, and the stroke at which it exceeds a tolerance.

    Args:
        first, second: two models of a drive
        stroke: the largest, of the output [deg]
        tolerance: root mean square of the difference of the output angle [mrad]

    >>> from strainwave import load
    >>> print(stroke_table(*map(load, ("position-drive-full-friction", "position-drive")), 100.0, 0.1).splitlines()[-1])
    the output differs by less than 0.1 mrad rms up to a stroke of 3.48 rad of the motor, 2 deg of the output
    """
    ratio = abs(float(second.gear.kinematics.ratio))
    tolerance = arguments.number("tolerance", tolerance, "mrad", low=0.0)
    largest = ratio * np.radians(arguments.number("stroke", stroke, "deg", low=0.0))
    apart = strokes_apart(first, second, np.geomspace(MIN_STROKE_SHARE * largest, largest, STROKE_COUNT).tolist())
    rows: list[Row] = [("stroke [rad]", "output angle, rms [mrad]", *(["current, rms [A]"] if "current" in apart else []))]
    rows += [
        (f"{row[0]:.4g}", f"{1e3 * row[1]:.3g}", *(f"{each:.3g}" for each in row[2:3]))
        for row in zip(*(apart[name] for name in apart.names), strict=True)
    ]
    allowed = f"the output differs by less than {tolerance:g} mrad rms"
    if (reach := stroke_within(apart, 1e-3 * tolerance)) == inf:
        verdict = f"{allowed} at every stroke up to {largest:.3g} rad of the motor"
    elif reach <= float(apart["stroke"][0]):
        verdict = f"the output differs by {tolerance:g} mrad rms or more at every stroke"
    else:
        verdict = f"{allowed} up to a stroke of {reach:.3g} rad of the motor, {np.degrees(reach / ratio):.3g} deg of the output"
    return "\n".join([*aligned(rows, ">>>"[: len(rows[0])]), verdict])


def range_table(recording: Recording) -> str:
    """Return the range of each column of a recording, one to a line.

    >>> print(range_table(Recording({"time": [0.0, 1.0], "torque": [2.0, 0.5]}, {"time": "s", "torque": "N.m"})))
            unit  smallest  largest  at the end
    torque  N.m        0.5        2         0.5
    """
    rows: list[Row] = [("", "unit", "smallest", "largest", "at the end")]
    for name in recording.names:
        if name != "time":
            values = recording[name]
            noise = ROUNDING_SHARE * np.abs(values).max()
            shown = (f"{0.0 if abs(each) < noise else each:.5g}" for each in (values.min(), values.max(), values[-1]))
            rows.append((name, recording.unit(name), *shown))
    return "\n".join(aligned(rows, "<<>>>"))


def aligned(rows: Sequence[Row], sides: str) -> Iterator[str]:
    """Yield rows as lines, each column as wide as its longest cell, set to the left (<) or to the right (>).

    >>> print(*aligned([("torque", "2"), ("mass", "10")], "<>"), sep="\\n")
    torque   2
    mass    10
    """
    rows = [[_printable(cell) for cell in row] for row in rows]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    for row in rows:
        yield "  ".join(f"{cell:{side}{width}}" for cell, side, width in zip(row, sides, widths, strict=True)).rstrip()


def _printable(text: str) -> str:
    """Return a text of a file without control characters, which a terminal would obey."""
    return "".join(each if each.isprintable() else " " for each in text)


def _indented(lines: Iterator[str]) -> Iterator[str]:
    yield from (f"  {line}" for line in lines)


def _numbers(gear_set: GearSet, path: str, model: object) -> Iterator[str]:
    """Yield the numbers of a part, then those of the parts in it; a part that does nothing is listed as not given."""
    name = model.name  # type: ignore[attr-defined]
    if path in gear_set.left_out:
        yield f"[{path}] not given"
    else:
        yield f"[{path}]" if path == name else f"[{path}] {name}"
        yield from _indented(aligned(list(_rows(gear_set, path, model)), "<><<"))
    if any(entry.source != NOT_GIVEN for inner, entry in gear_set.sources.items() if inner.startswith(f"{path}.")):
        for part in parts(model):
            yield from _numbers(gear_set, f"{path}.{part.name}", getattr(model, part.name))


def _rows(gear_set: GearSet, path: str, model: object) -> Iterator[Row]:
    for field in parameters(model):
        value = getattr(model, field.name)
        if field.kind == "choice":
            yield field.name, str(value), "", ""
            continue
        several = field.kind == "sequence"
        is_given = bool(value) if several else gear_set.sources[f"{path}.{field.name}"].source != NOT_GIVEN
        if field.name in at_rest(model) and not is_given:
            continue
        for i, number in enumerate(value if several else [value]):
            name = f"{field.name}[{i}]" if several else field.name
            entry = gear_set.sources[f"{path}.{name}"]
            spread = "" if entry.spread is None else f", spread {100.0 * entry.spread:g} %"
            words = f"{number:.6g}" if entry.uncertainty is None else typeset.uncertain(number, entry.uncertainty)
            yield name, words, "" if field.unit == "1" else field.unit, f"{entry.source}{spread}"


def _covariance(gear_set: GearSet) -> Iterator[str]:
    """Yield the larger correlations of identified numbers, the largest first."""
    if gear_set.covariance is None:
        return
    paths = gear_set.covariance.paths
    pairs = {(one, other): gear_set.covariance.correlation(one, other) for one, other in combinations(paths, 2)}
    large = sorted((pair for pair in pairs if abs(pairs[pair]) > MIN_CORRELATION), key=lambda pair: -abs(pairs[pair]))
    yield from ["", f"[covariance] of {len(paths)} numbers; correlations beyond {MIN_CORRELATION:g}:"]
    yield from _indented(aligned([(*pair, f"{pairs[pair]:+.2f}") for pair in large], "<<>") if large else iter(["none"]))


def _validation(gear_set: GearSet) -> Iterator[str]:
    """Yield the errors of a set on the files that it was identified from."""
    if not gear_set.validation:
        return
    rows: list[Row] = [("", "kind", "channel", "unit", "error", "held out", "of the signal")]
    for each in gear_set.validation:
        share = f"{100.0 * each.relative:.3g} %"
        rows.append((each.file, each.kind, each.channel, each.unit, f"{each.error:.3g}", f"{each.held_out:.3g}", share))
    yield from ["", "[validation] root mean square errors on the files that it was identified from"]
    yield from _indented(aligned(rows, "<<<<>>>"))


def _vibration(gear_set: GearSet) -> Iterator[str]:
    """Yield the modes of a whole drive."""
    if gear_set.motor is None or gear_set.load is None:
        return
    yield from ("", "modes")
    try:
        rows = [(f"{name}, undamped", _frequencies(found.tolist()), "") for name, found in modes(gear_set.drive).items()]
    except ValueError as error:
        yield f"  not determined: {error}"
        return
    yield from _indented(aligned([*rows, _closed_loop(gear_set.drive)], "<<<"))


def _closed_loop(drive: Drive) -> Row:
    """Return how the drive vibrates about its rest, with its controller, friction and damping."""
    name = "at rest, under its controller"
    try:
        linear = linearise(drive)
    except ValueError as error:
        return name, f"not determined: {error}", ""
    stuck = " and ".join(side for side in ("input", "output") if f"{side}_speed" not in linear.states)
    fastest = max((abs(pole) for pole in linear.poles.tolist()), default=0.0)
    pairs = [pole for pole in linear.poles.tolist() if pole.imag > NO_FREQUENCY * fastest]
    damping = ", ".join(f"{_rounded(-pole.real / abs(pole)):.3g}" for pole in pairs)
    notes = [note for note in linear.notes if not note.startswith(("meter", "thermal"))]  # which are not seen in a vibration
    remarks = (f"damping ratio {damping}" * bool(pairs), f"friction holds {stuck}" * bool(stuck), *notes)
    return name, _frequencies([abs(pole) for pole in pairs]), "; ".join(filter(None, remarks))


def _rounded(ratio: float) -> float:
    return 0.0 if abs(ratio) < NO_FREQUENCY else ratio


def _frequencies(rates: Sequence[float]) -> str:
    return ", ".join(f"{rate:.6g} rad/s ({rate / tau:.4g} Hz)" for rate in rates) or "none"


def _ratings(gear_set: GearSet) -> Iterator[str]:
    if gear_set.ratings:
        yield from ("", "ratings")
        rows = [(name, f"{each.value:g}", each.unit, each.source) for name, each in gear_set.ratings.items()]
        yield from _indented(aligned(rows, "<><<"))


def _checks(gear_set: GearSet, runs: Mapping[str, Recording]) -> Iterator[str]:
    for name, recording in runs.items():
        yield from ("", one_line(name))
        rows = [_check(each) for each in check_ratings(gear_set, recording)]
        yield from _indented(aligned(rows, "<><<"))
        if not rows:
            yield f"  cannot be compared: {gear_set.name} has no ratings of torque or speed, or the recording no such column"


def _check(check: RatingCheck) -> Row:
    share = check.reached / check.limit.value if check.limit.value > 0.0 else float("inf")
    when = "" if check.time is None else f", first at t = {check.time:.6g} s"
    beyond = f"exceeds the limit by {100.0 * (share - 1.0):.3g} %{when}"
    return (
        check.name,
        f"{check.reached:.4g}",
        check.limit.unit,
        beyond if check.exceeded else f"{100.0 * share:.3g} % of the limit",
    )
