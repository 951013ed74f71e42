"""The report of a twin: measured against modelled, what is known, what is not, and what contradicts what."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from importlib import metadata
from operator import attrgetter
from typing import TYPE_CHECKING, Any, NamedTuple, get_args

import numpy as np

from strainwave.analysis.branches import SAMPLES
from strainwave.files.entries import Entry
from strainwave.files.gear_set import GearSet
from strainwave.identification.evidence.evidence import Evidence
from strainwave.identification.evidence.verdict import State, Verdict, estimated, numbers
from strainwave.identification.experiments.drive_log import DriveLog
from strainwave.identification.experiments.friction_table import FrictionTable
from strainwave.identification.experiments.torsion_loop import TorsionLoop
from strainwave.identification.fitting.fit import Fit
from strainwave.identification.twin import Contradiction, Twin
from strainwave.report import figures
from strainwave.report.experiment import SimulatedExperiment
from strainwave.report.page import render
from strainwave.report.provenance import Provenance
from strainwave.report.typeset import number, quantity, uncertain, unit

if TYPE_CHECKING:
    from markupsafe import Markup


class ParameterRow(NamedTuple):
    """A row of a table: a number of the twin and what is known of it, ready to print."""

    path: str
    name: str
    unit: str
    value: str
    start: str
    state: str
    why: str


class Part(NamedTuple):
    """A part of the drive with its law and its parameters."""

    name: str
    law: str
    source: str
    parameters: list[ParameterRow]

    @property
    def absent(self) -> bool:
        """Whether the model does without it."""
        return [parameter.state for parameter in self.parameters] == ["absent"]


def twin_report(twin: Twin, experiments: Sequence[SimulatedExperiment] = (), provenance: Provenance | None = None) -> str:
    """The report of a twin, as one HTML file that needs nothing else.

    Args:
        twin: what was found
        experiments: what was simulated with it
        provenance: how the report came to be, if that is to be shown

    Returns:
        HTML; the same for the same arguments

    >>> import numpy as np, strainwave as sw
    >>> speed = np.array([1.0, 2.0, 5.0, 10.0, 20.0, 50.0])
    >>> table = sw.Recording({"speed": speed, "torque": 0.02 + 3e-4 * speed}, {"speed": "rad/s", "torque": "N.m"})
    >>> html = twin_report(sw.twin(sw.GearSet.read("hfuc-25-100"), friction=table))
    >>> html.startswith("<!doctype html>")
    True
    """
    parts = list(_parts(twin))
    return render(
        "twin.html.jinja",
        {
            "twin": twin,
            "measurements": [_measurement(twin, evidence) for evidence in twin.evidence],
            "parts": parts,
            "unknown": list(_brief(twin, parts)),
            "gaps": list(_gaps(twin, parts)),
            "fitted": _fitted(parts),
            "contradictions": [_contradiction(twin, contradiction) for contradiction in twin.contradictions],
            "two_laws": _two_laws(twin),
            "exceeded": [check for check in twin.ratings if check.exceeded],
            "experiments": list(_experiments(experiments)),
            "sources": _sources(twin.gear_set),
            "provenance": provenance or Provenance(),
            "version": metadata.version("strainwave"),
            "light": figures.variables(figures.LIGHT),
            "dark": figures.variables(figures.DARK),
        },
    )


# ---- Measurements ----------------------------------------------------------------------------------------------------


def _measurement(twin: Twin, evidence: Evidence) -> dict[str, Any]:
    experiment = evidence.fit.experiment
    return {
        "title": _title(evidence),
        "evidence": evidence,
        "span": _span(evidence),
        "held_out": _held_out(evidence),
        "errors": [
            (figures.output_name(name).capitalize(), quantity(error, of), _share(error, measured))
            for name, of, error, measured in zip(
                experiment.channels, experiment.units, evidence.error, experiment.measured, strict=True
            )
        ],
        "estimates": list(_estimates(twin, evidence)),
        "candidates": [(name, quantity(error, experiment.units[0])) for name, error in evidence.candidates],
        "plates": list(_plates(evidence)),
    }


def _estimates(twin: Twin, evidence: Evidence) -> Iterator[ParameterRow]:
    """What was fitted to a measurement; a verdict is that of the last measurement that a parameter was fitted to."""
    verdicts, last, before = {v.path: v for v in twin.verdicts}, estimated(twin.evidence), numbers(twin.start.gear)
    free = len(evidence.fit.estimates) - len(evidence.fit.experiment.nuisances)
    for position, estimate in enumerate(evidence.fit.estimates):
        path, value, of = evidence.path(estimate), uncertain(estimate.value, estimate.sigma), unit(estimate.unit)
        if position >= free:
            yield ParameterRow("", estimate.path.replace("_", " "), of, value, "", "of the measurement", "")
        elif path in verdicts and last[path][0] is evidence:
            start = _start(verdicts[path])
            yield ParameterRow(path, _name(evidence.fit, path), of, value, start, verdicts[path].state, "")
        else:
            start = number(before[path][0]) if path in before else ""
            yield ParameterRow(path, _name(evidence.fit, path), of, value, start, "replaced by a later measurement", "")


def _title(evidence: Evidence) -> str:
    if isinstance(evidence.fit.experiment, TorsionLoop):
        return "Torsion branch" if evidence.fit.experiment.single_branch else "Torsion loop"
    return {"friction": "Friction table", "log": "Drive log"}[evidence.kind]


def _span(evidence: Evidence) -> str:
    """What was measured, in a few words."""
    experiment = evidence.fit.experiment
    assert isinstance(experiment, FrictionTable | TorsionLoop | DriveLog)
    compared = experiment.measured.shape[1]
    samples = f"{max(experiment.samples, compared)} samples"
    if experiment.samples > compared:
        samples += f", compared in {compared} points"
    if isinstance(experiment, FrictionTable):
        low, high = np.abs(experiment.speed).min(), np.abs(experiment.speed).max()
        return f"{samples}, from {number(low, 3)} to {number(high, 3)} rad/s at the input"
    if isinstance(experiment, TorsionLoop):
        torque = quantity(float(np.abs(experiment.torque).max()), "N.m")
        place = "at the output" if experiment.input_ratio is None else "referred to the output"
        return f"{samples}, up to {torque}, over {quantity(float(np.ptp(experiment.twist)), 'rad')} {place}"
    return f"{samples}, over {quantity(float(np.ptp(experiment.time)), 's')}"


def _held_out(evidence: Evidence) -> str:
    """How the model was put to the test."""
    training = evidence.fit.training
    if evidence.kind == "friction":
        return "each measurement predicted from the others"
    return f"{int(np.sum(~training))} of {len(training)} points held out from the fit"


def _share(error: float, measured: figures.Array) -> str:
    extent = float(np.ptp(measured))
    return f"{number(100.0 * error / extent, 2)} % of the range measured" if extent > 0.0 else ""


def _plates(evidence: Evidence) -> Iterator[tuple[Markup, str]]:
    """The figures of a measurement, each with its caption."""
    from markupsafe import Markup

    experiment = evidence.fit.experiment
    if isinstance(experiment, FrictionTable):
        yield (
            Markup(figures.friction_table(evidence)),
            "Above: measured friction torque and the model fitted to all of it. "
            "Below: each measurement less what a fit to the others predicts at its speed.",
        )
    elif isinstance(experiment, TorsionLoop):
        yield Markup(figures.torsion_loop(evidence)), " ".join(_torsion_caption(experiment))
    else:
        for channel, name in enumerate(experiment.channels):
            words = "measured and modelled, and their difference; shaded, what was held out."
            yield Markup(figures.drive_log(evidence, channel)), f"{figures.output_name(name)}, {words}"


def _torsion_caption(loop: TorsionLoop) -> Iterator[str]:
    """What the figure of a loop shows, sentence by sentence."""
    path = "branch" if loop.single_branch else "loop"
    yield f"Above: the measured {path}, the parts of it that were held out, and the model fitted to the rest."
    yield f"Below: measured less modelled along the {path}; shaded, what was held out."
    if loop.input_ratio is not None:
        yield (
            "Measured at the input with the output locked, and referred to the output: angles divided by the ratio, torques "
            f"multiplied by it. Friction of the wave generator is inside the measured {path}, and inside the model's curve too."
        )
    if figures.gaps(loop):
        yield (
            "The samples just behind each reversal are left out (gaps above, dotted lines below): there friction changes its "
            f"sense over a distance that no {path} tells."
        )
    if loop.samples > SAMPLES:
        yield "Each point is the mean of neighbouring samples."


# ---- Parameters ------------------------------------------------------------------------------------------------------


def _parts(twin: Twin) -> Iterator[Part]:
    """Every part, in the order of the gear and then the drive."""
    gear_set = twin.gear_set
    verdicts = {verdict.path: verdict for verdict in twin.verdicts}
    places: dict[str, list[str]] = {part: [] for part in _part_paths(gear_set)}
    for path in gear_set.sources:
        places[path.rpartition(".")[0]].append(path)
    absent = _absent_parts(gear_set)
    for part, paths in places.items():
        model = attrgetter(part)(gear_set)
        if part in absent:
            yield Part(_words(part), "", "", [_absent(gear_set, part)])
        elif model is not None:
            law = (type(model).__doc__ or "").partition("\n")[0] if part != "gear" else ""
            parameters = [_parameter(gear_set, path, verdicts.get(path)) for path in paths]
            yield Part(_words(part), law, model.source, parameters)


def _absent_parts(gear_set: GearSet) -> set[str]:
    """Parts of the gear that it does without: nothing is said of them, or there is no number to say."""
    numbered = {part for path in gear_set.sources for part in _around(path)}
    return {part for part in _inside("gear", gear_set.gear) if part not in numbered or part in gear_set.left_out}


def _around(path: str) -> Iterator[str]:
    """The parts that a number is in, from the innermost outwards."""
    while path := path.rpartition(".")[0]:
        yield path


def _part_paths(gear_set: GearSet) -> list[str]:
    rest = [path for part in ("motor", "control", "load") for path in (part, *_inside(part, getattr(gear_set, part)))]
    return [*_inside("gear", gear_set.gear), "gear", *rest]


def _inside(path: str, model: Any) -> Iterator[str]:
    """Paths of the parts of a model, each followed by those of its own parts."""
    for member in model.fields if model is not None else ():
        if member["kind"] == "part":
            inner = f"{path}.{member['name']}"
            yield inner
            yield from _inside(inner, getattr(model, member["name"]))


def _parameter(gear_set: GearSet, path: str, verdict: Verdict | None) -> ParameterRow:
    entry, member = gear_set.sources[path], _member(gear_set, path)
    name, of, value = _name(gear_set, path), unit(member["unit"]), _value(gear_set, path)
    if verdict is None:
        return ParameterRow(path, name, of, _known(value, entry), "", "given", entry.source)
    start = _start(verdict)
    if verdict.state != "kept":
        return ParameterRow(path, name, of, uncertain(value, verdict.sigma), start, verdict.state, verdict.why)
    if value != verdict.start:
        return ParameterRow(path, name, of, number(value), start, "follows", verdict.why)
    return ParameterRow(path, name, of, _known(value, entry), start, "kept", verdict.why)


def _absent(gear_set: GearSet, part: str) -> ParameterRow:
    """What stands for the numbers of a part that the gear does without."""
    why = "not in the model; no measurement given tells it"
    return ParameterRow(part, _name(gear_set, part), "", "none", "", "absent", why)


def _start(verdict: Verdict) -> str:
    """The value in the initial model; nothing where that has no such parameter."""
    return "" if np.isnan(verdict.start) else number(verdict.start)


def _known(value: float, entry: Entry) -> str:
    """A number that no fit has touched, with what its source says of its uncertainty."""
    if entry.spread is not None:
        return f"{number(value)} ± {number(100.0 * entry.spread, 2)} %"
    return number(value) if entry.uncertainty is None else uncertain(value, entry.uncertainty)


def _split(path: str) -> tuple[str, str, int | None]:
    """Part, name and, of an element, its place."""
    part, _, name = path.rpartition(".")
    name, _, place = name.removesuffix("]").partition("[")
    return part, name, int(place) if place else None


def _member(owner: GearSet | Fit, path: str) -> dict[str, Any]:
    part, name, _ = _split(path)
    found: dict[str, Any] = next(m for m in attrgetter(part)(owner).fields if m["name"] == name)
    return found


def _value(gear_set: GearSet, path: str) -> float:
    part, name, place = _split(path)
    value = getattr(attrgetter(part)(gear_set), name)
    return float(value if place is None else value[place])


def _name(owner: GearSet | Fit, path: str) -> str:
    """What a parameter is, in words."""
    place = _split(path)[2]
    words: str = _member(owner, path)["doc"]
    return words if place is None else f"{words}, no. {place + 1}"


def _words(part: str) -> str:
    """What a part is called: "Friction input, law" of gear.friction_input.law."""
    return part.removeprefix("gear.").replace(".", ", ").replace("_", " ").capitalize()


# ---- What is not known, and what contradicts what --------------------------------------------------------------------


MANY = 3  # parameters of a part that are not listed where all of them share a fate
UNKNOWN = {
    "identified in combination": "Fitted, but determined only together with another parameter",
    "not identified": "Fitted, but not determined by the data",
    "kept": "Not measured, kept from the initial model",
    "follows": "Not measured, set by a rule from what was fitted",
    "absent": "Not measured, and not in the model",
}


def _fitted(parts: list[Part]) -> str:
    """How many of the fitted parameters are known, and how: "9 identified, 4 not identified"."""
    states = [parameter.state for part in parts for parameter in part.parameters]
    counts = {state: states.count(state) for state in get_args(State) if state != "kept"}
    return ", ".join(f"{count} {state}" for state, count in counts.items() if count) or "none"


class Gap(NamedTuple):
    """What is not known of a part of the gear, for one reason."""

    part: str
    parameters: str
    state: str
    why: str


def _gaps(twin: Twin, parts: list[Part]) -> Iterator[Gap]:
    """What is not known, part by part."""
    for part in parts:
        reasons: dict[tuple[str, str], list[str]] = {}
        for parameter in part.parameters:
            if parameter.state in UNKNOWN:
                reasons.setdefault((parameter.state, parameter.why), []).append(parameter.path)
        for (state, why), paths in reasons.items():
            yield Gap(part.name, _names(twin.gear_set, paths), state, why)


def _brief(twin: Twin, parts: list[Part]) -> Iterator[tuple[str, list[str]]]:
    """What is not known, in brief: how it is not known, and the parts with their parameters unless these are many."""
    for state, words in UNKNOWN.items():
        found = []
        for part in parts:
            paths = [parameter.path for parameter in part.parameters if parameter.state == state]
            if (state == "absent" and paths) or len(paths) == len(part.parameters) > MANY:
                found.append(part.name)
            elif paths:
                found.append(f"{part.name} ({_names(twin.gear_set, paths)})")
        if found:
            yield words, found


def _names(gear_set: GearSet, paths: list[str]) -> str:
    """Parameters in words, the elements of a sequence in one."""
    elements: dict[str, list[str]] = {}
    for path in paths:
        place = _split(path)[2]
        elements.setdefault(_member(gear_set, path)["doc"], []).extend([] if place is None else [str(place + 1)])
    return ", ".join(words + (f" (no. {', '.join(which)})" if which else "") for words, which in elements.items())


def _contradiction(twin: Twin, found: Contradiction) -> dict[str, str]:
    part, name = _words(_split(found.path)[0]), _name(twin.gear_set, found.path)
    return {
        "title": name if name.startswith(part) else f"{part}: {name}",
        "path": found.path,
        "unit": unit(found.unit),
        "earlier": _known(found.earlier, found.known),
        "earlier_source": found.earlier_source,
        "measured": uncertain(found.measured, found.sigma),
        "source": found.source,
        "distance": number(found.distance, 3),
    }


def _two_laws(twin: Twin) -> Markup | None:
    """Both data sets on one axis, where the friction table contradicts the law of the initial model."""
    from markupsafe import Markup

    contradicted = any(found.path.startswith("gear.friction_input.") for found in twin.contradictions)
    tables = [evidence for evidence in twin.evidence if evidence.kind == "friction"]
    return Markup(figures.two_friction_laws(twin, tables[0])) if contradicted and tables else None


# ---- Experiments and sources -----------------------------------------------------------------------------------------


def _experiments(experiments: Sequence[SimulatedExperiment]) -> Iterator[dict[str, Any]]:
    """Experiments with their figures; a remark that they share stands with the first."""
    from markupsafe import Markup

    said = ""
    for position, experiment in enumerate(experiments):
        below = "how far it is from the command" if experiment.comparable else "the command"
        yield {
            "experiment": experiment,
            "remark": "" if experiment.remark == said else experiment.remark,
            "figure": Markup(figures.experiment(experiment, f"experiment-{position}")),
            "caption": f"{figures.output_name(experiment.response)} over time, and {below}.",
        }
        said = experiment.remark


def _sources(gear_set: GearSet) -> dict[str, list[str]]:
    """Every source with the numbers that rest on it; what a gear does without needs none."""
    sources: dict[str, list[str]] = {}
    absent = _absent_parts(gear_set)
    for path, entry in gear_set.sources.items():
        if absent.isdisjoint(_around(path)):
            sources.setdefault(entry.source, []).append(path)
    return sources
