"""Order tracks: the amplitude of orders of a shaft over its speed, with the critical speeds of a drive."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave import arguments, typeset
from strainwave.drawing import marks
from strainwave.drawing.simple import Series
from strainwave.drawing.style import LIGHT
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording
from strainwave.messages import listed
from strainwave.orders.orders_over_speed import orders_over_speed, turning_of
from strainwave.presentation import Pictured, Row

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

PANEL_HEIGHT, MARGIN_HEIGHT = 1.7, 0.8  # inches
MAX_PANELS = 6  # of the strongest orders


@dataclass(frozen=True, eq=False)
class OrderTracks(ComparedByFields, Pictured):
    """Amplitude of orders of a shaft over its speed.

    Attributes:
        order: periods per turn [1], shape (q,)
        speed: mean of each stretch [rad/s], increasing, shape (k,)
        amplitude: in the unit of the column, shape (q, k); not a number where the samples are too far apart for the order
        column: its name
        unit: of the amplitude
        remarks: what was left out
    """

    order: Array
    speed: Array
    amplitude: Array
    column: str
    unit: str
    remarks: tuple[str, ...] = ()

    def plot(self, *, eigenfrequencies: Sequence[float] = ()) -> Figure:
        """Return a figure of each order over the speed.

        Args:
            eigenfrequencies: of the drive [rad/s], as `sw.analysis.modes` returns them: an order is critical at the speed
                eigenfrequency / order, a dashed line

        Raises:
            TypeError, ValueError: an eigenfrequency is no positive number
        """
        frequencies = [arguments.number("eigenfrequencies", frequency, "rad/s", low=0.0) for frequency in eigenfrequencies]
        critical = [[frequency / order for frequency in frequencies] for order in self.order.tolist()]
        inside = [[speed for speed in speeds if self.speed[0] < speed < self.speed[-1]] for speeds in critical]
        dashed = "; dashed: critical speeds" if frequencies else ""
        with marks.new_figure(PANEL_HEIGHT, f"Orders of {self.column.replace('_', ' ')} over the speed{dashed}") as figure:
            draw_orders(figure, self, Series("speed", "rad/s", self.speed), inside)
        return figure

    def _headline(self) -> str:
        low, high = (typeset.quantity(float(end), "rad/s") for end in (self.speed[0], self.speed[-1]))
        return f"{self.column.replace('_', ' ')} from {low} to {high}"

    def _rows(self) -> Iterator[Row]:
        for order, amplitude in zip(self.order.tolist(), self.amplitude, strict=True):
            ends = float(np.nanmin(amplitude)), float(np.nanmax(amplitude))
            largest = typeset.quantity(float(self.speed[int(np.nanargmax(amplitude))]), "rad/s")
            yield Row(f"order {order:.5g}", ends, self.unit, note=f"largest at {largest}")


def order_tracks(
    recordings: Recording | Sequence[Recording], column: str, orders: ArrayLike, *, angle: str = "input_angle"
) -> OrderTracks:
    """Return the amplitude of orders in a column over the speed of a shaft.

    Stretches of a few turns are each fitted with all orders together and a smooth trend of the angle, so that neither a ratio
    nor a drift need be known.

    Args:
        recordings: one run-up or run-down, or several recordings, of which each may be at constant speed; with `time`
        column: in which orders are followed
        orders: of the shaft [1], shape (n,)
        angle: column of the angle of the shaft

    Raises:
        TypeError: an argument is not of its kind
        ValueError: a column or the time is missing, the shaft does not turn, or the recordings are too short

    >>> import numpy as np
    >>> import strainwave as sw
    >>> time = np.arange(0.0, 20.0, 1e-3)
    >>> theta, speed = 20.0 * time + 5.0 * time**2, 20.0 + 10.0 * time
    >>> torque = 3.0 / (1.0 + (speed / 100.0 - 1.0) ** 2) * np.sin(2.0 * theta)
    >>> units = {"time": "s", "input_angle": "rad", "torque": "N.m"}
    >>> run_up = sw.Recording({"time": time, "input_angle": theta, "torque": torque}, units)
    >>> tracks = sw.orders.order_tracks(run_up, "torque", [2.0])
    >>> largest = tracks.amplitude[0].argmax()
    >>> round(float(tracks.speed[largest]), -1), round(float(tracks.amplitude[0, largest]), 1)
    (100.0, 3.0)
    """
    wanted = arguments.positive_series("orders", orders)
    turning, unit = turning_of(recordings, column, angle)
    spectrum = orders_over_speed(turning, wanted.tolist())
    followed = np.isfinite(spectrum.amplitude).any(axis=1)
    if not followed.any():
        why = "; ".join(spectrum.remarks) or "there is no stretch of enough turns and samples"
        raise ValueError(f"no order can be followed: {why}; record longer, or faster")
    remarks = list(dict.fromkeys([*(remark for record in turning for remark in record.remarks), *spectrum.remarks]))
    if not followed.all():
        remarks.append(
            f"the samples are too far apart for order {listed(f'{order:g}' for order in spectrum.orders[~followed])}"
        )
    place = np.argsort(spectrum.speed, kind="stable")
    amplitude = np.abs(spectrum.amplitude[followed][:, place])
    return OrderTracks(spectrum.orders[followed], spectrum.speed[place], amplitude, column, unit, tuple(remarks))


def draw_orders(
    figure: Figure, tracks: OrderTracks, speed: Series, dashed: Sequence[Sequence[float]], model: Array | None = None
) -> None:
    """Draw the strongest orders over the speed, with dashed lines at speeds of each, and the amplitude of a model, if any."""
    strongest = np.argsort(-np.nanmax(tracks.amplitude, axis=1))[:MAX_PANELS]
    figure.set_figheight(MARGIN_HEIGHT + PANEL_HEIGHT * len(strongest))
    panels = figure.subplots(len(strongest), 1, sharex=True, squeeze=False)[:, 0]
    for axes, place in zip(panels, sorted(strongest.tolist(), key=lambda place: tracks.order[place]), strict=True):
        style = {} if model is None else {"linestyle": "", "marker": ".", "markersize": 3.0}
        marks.curve(axes, speed.values, tracks.amplitude[place], color=LIGHT["measured"], label="measured", **style)
        if model is not None:
            marks.curve(axes, speed.values, model[place], color=LIGHT["model"], linewidth=1.0, label="model")
        for line in dashed[place]:
            axes.axvline(line, color=LIGHT["muted"], linestyle="--", linewidth=0.8)
        axes.set_ylim(bottom=0.0)
        marks.label_axes(axes, f"order {typeset.number(tracks.order[place], 5)}", tracks.unit)
    marks.label_abscissa(panels[-1], speed.name, speed.unit)
    if model is not None:
        marks.legend(figure, panels[0])
