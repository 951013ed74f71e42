"""A measured run from rest, and drives under its command."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from strainwave import Drive
from strainwave.analysis.compare import Agreement, compare
from strainwave.files.recording import Recording
from strainwave.presentation import Pictured, Row
from strainwave.simulation.run import Run, simulate
from strainwave.simulation.scenario import table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SAMPLE_TIME = 1e-3  # s
MIN_ROWS = 2  # of a run: its command is a line between them


@dataclass(frozen=True)
class MeasuredCommand(Pictured):
    """A measured run of a drive from rest under a command of the output angle.

    Attributes:
        recording: time, from 0 on, command and output_angle [rad]

    >>> import tempfile
    >>> import strainwave as sw
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder, "run.csv")
    ...     _ = path.write_text("time [s],command [rad],output_angle [mrad]\\n5,0,0\\n5.1,0.01,0\\n5.5,0.01,9.5\\n")
    ...     run = sw.analysis.MeasuredCommand.read(path)
    >>> round(1e3 * run.agreement(sw.load("position-drive")).rms, 1)  # mrad
    2.9
    """

    recording: Recording

    @classmethod
    def read(cls, path: str | Path) -> MeasuredCommand:
        """Read a file with time, command and output_angle.

        Raises:
            ValueError: the file cannot be read, lacks a column, has fewer than two rows, or a column is no angle
        """
        names = ("time", "command", "output_angle")
        recording = Recording.read(path, columns={name: name for name in names})
        if len(recording) < MIN_ROWS:
            raise ValueError(f"{path} has {len(recording)} rows; a run needs {MIN_ROWS} or more")
        columns = {"time": recording.time - recording.time[0]} | {name: recording.values(name, "rad") for name in names[1:]}
        return cls(Recording(columns, {"time": "s", "command": "rad", "output_angle": "rad"}, title=Path(path).name))

    def run(self, drive: Drive) -> Run:
        """Return the run of a drive under the measured command, from rest at the first measured angle."""
        command = table(self.recording.time, self.recording["command"])
        return simulate(drive, command, sample=SAMPLE_TIME, initial={"output_angle": float(self.recording["output_angle"][0])})

    def agreement(self, drive: Drive) -> Agreement:
        """Return how far the output angle of a drive is from the measured one."""
        return compare(self.recording.select(["time", "output_angle"]), self.run(drive))[0]

    def _headline(self) -> str:
        return self.recording._headline()

    def _rows(self) -> Iterable[Row]:
        return self.recording._rows()

    def plot(self) -> Figure:
        """Return the figure of its recording."""
        return self.recording.plot()
