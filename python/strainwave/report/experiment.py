"""Simulated experiments in a report: the response of a model to a command, with published figures."""

from __future__ import annotations

from dataclasses import dataclass

from strainwave.files.recording import Recording


@dataclass(frozen=True)
class Figure:
    """A figure of merit of an experiment, and the published one to compare it with.

    Attributes:
        name: what it is, as "root mean square error"
        unit: its unit
        values: its value in each run, in their order
        published: the published value; None if there is none
    """

    name: str
    unit: str
    values: tuple[float, ...]
    published: float | None = None


@dataclass(frozen=True)
class SimulatedExperiment:
    """A simulated experiment: one command, run through one or more models.

    Attributes:
        name: what is done, as "sine, 1 Hz"
        remark: what the reader must know
        runs: label and recording of each run; all with the columns time, `command` and `response`
        figures: figures of merit
        source: where the published figures come from; empty if there are none
        command: column that is commanded
        response: column that answers

    Raises:
        ValueError: there is no run, a run lacks a column, or a figure has not one value for each run

    >>> import strainwave as sw
    >>> drive = sw.Drive(load=sw.loads.Inertia(inertia=0.01))
    >>> run = sw.simulate(drive, sw.scenario.step(amplitude=5.0, duration=0.1))
    >>> experiment = SimulatedExperiment("step", runs=(("gear", run),), figures=(Figure("largest speed", "rad/s", (0.3,)),))
    >>> experiment.figures[0].published is None
    True
    """

    name: str
    runs: tuple[tuple[str, Recording], ...]
    figures: tuple[Figure, ...] = ()
    remark: str = ""
    source: str = ""
    command: str = "command"
    response: str = "output_angle"

    def __post_init__(self) -> None:
        if not self.runs:
            raise ValueError(f'experiment "{self.name}" has no run')
        for label, run in self.runs:
            for column in ("time", self.command, self.response):
                if column not in run:
                    raise ValueError(f'experiment "{self.name}": run "{label}" has no column "{column}"')
        for figure in self.figures:
            if len(figure.values) != len(self.runs):
                raise ValueError(
                    f'experiment "{self.name}": {figure.name} has {len(figure.values)} values for {len(self.runs)} runs'
                )

    @property
    def comparable(self) -> bool:
        """True if command and response have one unit, so that their difference is an error."""
        first = self.runs[0][1]
        return first.unit(self.command) == first.unit(self.response)
