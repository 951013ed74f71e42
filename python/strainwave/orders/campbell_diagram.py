"""Campbell diagram: the spectrum of a column of a recording over the speed of a shaft."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import tau
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strainwave import arguments, typeset
from strainwave.drawing import marks
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording, check_recording
from strainwave.files.units import convert
from strainwave.orders.turning import evenly
from strainwave.presentation import Pictured
from strainwave.statistics.spectrum import segment_power

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

MIN_SAMPLES = 16  # of a stretch: its spectrum has 8 frequencies
MIN_STRETCHES = 4  # of a recording
OVERLAP_SHARE = 0.75  # share of a stretch that the next one repeats
MAX_STRETCH_COUNT = 100_000  # whose spectra are computed
FIGURE_HEIGHT = 3.8  # inches
DYNAMIC_RANGE = 1e4  # largest over smallest amplitude that a colour shows
MAX_FREQUENCY_RATIO = 1.5  # of the highest eigenfrequency drawn
LABEL_SHARE = 0.97  # of the way along the line of an order, where its name stands


@dataclass(frozen=True, eq=False)
class Campbell(ComparedByFields, Pictured):
    """Spectra of a column over the speed of a shaft.

    Attributes:
        speed: mean speed of each stretch [rad/s], increasing, shape (k,)
        frequency: [Hz], shape (m,)
        amplitude: of the column, shape (k, m)
        column: its name
        unit: of the amplitude
        speed_column: name of the column of the speed
        remarks: on uneven and missing times

    >>> import numpy as np
    >>> import strainwave as sw
    >>> time = np.arange(0.0, 20.0, 1e-3)
    >>> columns = {"time": time, "input_speed": 10.0 * time, "torque": 3.0 * np.sin(10.0 * time**2)}  # order 2
    >>> diagram = sw.orders.campbell(sw.Recording(columns, {"time": "s", "input_speed": "rad/s", "torque": "N.m"}), "torque")
    >>> fast = diagram.amplitude[-1]  # of the stretch at the highest speed
    >>> round(float(diagram.speed[-1]), 1), round(float(diagram.frequency[fast.argmax()]), 1), diagram.unit
    (197.5, 62.0, 'N.m')
    """

    speed: Array
    frequency: Array
    amplitude: Array
    column: str
    unit: str
    speed_column: str
    remarks: tuple[str, ...] = ()

    def plot(self, *, orders: Sequence[float] = (), eigenfrequencies: Sequence[float] = ()) -> Figure:
        """Return the Campbell diagram: the amplitude over speed and frequency, with lines of orders and eigenfrequencies.

        Args:
            orders: of the shaft, each a line through the origin
            eigenfrequencies: [rad/s], as `modes` returns them, each a level line

        Returns:
            a matplotlib figure; a shaft is critical where a line of an order crosses an eigenfrequency

        Raises:
            TypeError, ValueError: an order or an eigenfrequency is no positive number
        """
        of_shaft = [arguments.number("orders", order, low=0.0) for order in orders]
        frequencies = [arguments.number("eigenfrequencies", speed, "rad/s", low=0.0) / tau for speed in eigenfrequencies]
        return campbell_figure(self, of_shaft, frequencies)

    def _headline(self) -> str:
        low, high = (typeset.quantity(float(end), "rad/s") for end in (self.speed[0], self.speed[-1]))
        return f"{self.column} over {low} to {high}, up to {typeset.quantity(float(self.frequency[-1]), 'Hz')}"


def campbell(recording: Recording, column: str, *, speed: str = "input_speed", stretch: float = 0.5) -> Campbell:
    """Return the spectra of a column of a run-up or run-down over the speed of a shaft.

    The recording is cut into stretches that overlap by 75 %. Each has the amplitude spectrum of its samples less their mean,
    under a Hann window, and the mean of its speed. Within a stretch the speed should change by a few percent at most: else the
    line of an order is wider than it need be.

    Args:
        recording: with `time`, the column and the speed; uneven times are put on an even clock
        column: the name of a column, as "torque"
        speed: the name of the column with the speed of the shaft
        stretch: duration of each stretch [s]; frequencies are resolved to about 2 / `stretch`

    Returns:
        Amplitudes [unit of the column] over speed [rad/s] and frequency [Hz], shape (stretches, frequencies).

    Raises:
        TypeError: `recording` is no recording, or a name is no text
        ValueError: a column or the time is missing, the recording is too short, column or speed do not change, or `stretch` has
            fewer than 16 samples

    >>> import numpy as np
    >>> import strainwave as sw
    >>> time = np.arange(0.0, 20.0, 1e-3)
    >>> columns = {"time": time, "input_speed": 10.0 * time, "torque": 3.0 * np.sin(10.0 * time**2)}  # order 2
    >>> run = sw.Recording(columns, {"time": "s", "input_speed": "rad/s", "torque": "N.m"})
    >>> diagram = sw.orders.campbell(run, "torque")
    >>> fast = np.searchsorted(diagram.speed, 150.0)
    >>> strongest = diagram.amplitude[fast].argmax()
    >>> order = 2.0 * np.pi * diagram.frequency[strongest] / diagram.speed[fast]
    >>> round(float(order), 1), round(float(diagram.amplitude[fast, strongest]))
    (2.0, 3)
    """
    check_recording("recording", recording)
    record = evenly(recording, [column, speed])
    if not record.timed:
        raise ValueError("the recording has no time: a Campbell diagram needs it")
    values, interval = record.columns[column], record.step
    turning = np.abs(convert(record.columns[speed], recording.unit(speed), "rad/s"))
    stretch = arguments.seconds("stretch", stretch)
    samples = round(stretch / interval)
    if samples < MIN_SAMPLES:
        raise ValueError(
            f"stretch = {stretch:g} s has {samples} samples of {interval:g} s; take {MIN_SAMPLES * interval:g} s or more"
        )
    repeated = int(OVERLAP_SHARE * samples)
    count = (len(values) - repeated) // (samples - repeated)
    if not MIN_STRETCHES <= count <= MAX_STRETCH_COUNT:
        raise ValueError(
            f"the recording has {max(count, 0)} stretches of {stretch:g} s, of {MIN_STRETCHES} to {MAX_STRETCH_COUNT} allowed; "
            f"take a {'shorter' if count < MIN_STRETCHES else 'longer'} stretch"
        )
    if not np.ptp(values) > 0.0:
        raise ValueError(f"{column} does not change: its spectrum is zero")
    if not np.ptp(turning) > 0.0:
        raise ValueError(f"{speed} does not change: a Campbell diagram needs a run-up or a run-down")
    frequency, power = segment_power(values, samples, repeated)
    starts = (samples - repeated) * np.arange(count)
    sums = np.concatenate(([0.0], np.cumsum(turning)))
    means = (sums[starts + samples] - sums[starts]) / samples
    order = np.argsort(means, kind="stable")
    amplitude = np.sqrt(2.0 * power[order])
    return Campbell(means[order], frequency / interval, amplitude, column, recording.unit(column), speed, record.remarks)


def campbell_figure(diagram: Any, orders: Sequence[float], eigenfrequencies: Sequence[float]) -> Figure:
    """Return the figure of a `Campbell`, as its `plot` describes it; eigenfrequencies in Hz."""
    lowest, highest = float(diagram.speed[0]), float(diagram.speed[-1])
    reached = MAX_FREQUENCY_RATIO * max(eigenfrequencies) if eigenfrequencies else max(orders, default=np.inf) * highest / tau
    top = min(float(diagram.frequency[-1]), reached)
    shown = diagram.frequency <= top
    column = diagram.column.replace("_", " ")
    dashed = f"; dashed: {'eigenfrequency' if len(eigenfrequencies) == 1 else 'eigenfrequencies'}" if eigenfrequencies else ""
    with marks.new_figure(FIGURE_HEIGHT, f"Campbell diagram of {column}{dashed}") as figure:
        axes = figure.subplots()
        largest = float(diagram.amplitude.max())
        colours = axes.pcolormesh(
            diagram.speed, diagram.frequency[shown], diagram.amplitude[:, shown].T,
            norm="log", vmin=largest / DYNAMIC_RANGE, vmax=largest, cmap="cividis", rasterized=True, shading="nearest",
        )  # fmt: skip
        axes.grid(visible=False)
        axes.set_facecolor("#00224e")  # the darkest of cividis
        bar = figure.colorbar(colours, ax=axes, location="bottom", aspect=40, pad=0.02)
        bar.set_label(f"amplitude [{typeset.unit(diagram.unit)}]" if diagram.unit != "1" else "amplitude")
        for frequency in (each for each in eigenfrequencies if each <= top):
            axes.axhline(frequency, color="white", linestyle="--", linewidth=1.0)
            label = f" {typeset.quantity(frequency, 'Hz')}"
            axes.text(1.0, frequency, label, transform=axes.get_yaxis_transform(), va="center", fontsize="small")
        for order in orders:
            end = min(highest, LABEL_SHARE * top * tau / order)
            axes.plot([lowest, end], [order * lowest / tau, order * end / tau], color="white", linestyle=":", linewidth=0.9)
            axes.text(
                end, order * end / tau, f"{order:.4g} ", color="white", ha="right", va="top" if end < highest else "bottom",
                fontsize="small",
            )  # fmt: skip
        axes.set_xlim(lowest, highest)
        axes.set_ylim(0.0, top)
        marks.label_axes(axes, "frequency", "Hz", diagram.speed_column.replace("_", " "), "rad/s")
    return figure
