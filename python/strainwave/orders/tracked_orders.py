"""Order tracks: the amplitude of orders of a shaft over its speed, with the critical speeds of a drive."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from strainwave import arguments, typeset
from strainwave.drawing import marks
from strainwave.drawing.style import LIGHT
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording, check_recording
from strainwave.messages import listed
from strainwave.orders.orders_over_speed import orders_over_speed, turning_one_way
from strainwave.presentation import Pictured, Row

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

PANEL_HEIGHT = 1.7  # inches of an order
MAX_DRAWN_ORDERS = 6


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
        return tracks_figure(self, [arguments.number("eigenfrequencies", each, "rad/s", low=0.0) for each in eigenfrequencies])

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
    given = [recordings] if isinstance(recordings, Recording) else list(recordings)
    if not given:
        raise ValueError("recordings has none; give one run-up, or several at constant speeds")
    for recording in given:
        check_recording("recordings", recording)
    wanted = arguments.positive_series("orders", orders)
    turning = [turning_one_way(each, arguments.text("column", column), arguments.text("angle", angle)) for each in given]
    found = orders_over_speed(turning, wanted.tolist())
    followed = np.isfinite(found.amplitude).any(axis=1)
    if not followed.any():
        why = "; ".join(found.remarks) or "there is no stretch of enough turns and samples"
        raise ValueError(f"no order can be followed: {why}; record longer, or faster")
    remarks = list(dict.fromkeys([*(remark for each in turning for remark in each.remarks), *found.remarks]))
    if not followed.all():
        remarks.append(f"the samples are too far apart for order {listed(f'{order:g}' for order in found.orders[~followed])}")
    place = np.argsort(found.speed, kind="stable")
    amplitude = np.abs(found.amplitude[followed][:, place])
    unit = given[0].unit(column)
    return OrderTracks(found.orders[followed], found.speed[place], amplitude, column, unit, tuple(remarks))


def tracks_figure(tracks: OrderTracks, eigenfrequencies: Sequence[float]) -> Figure:
    """Return the figure of an `OrderTracks`, as its `plot` describes it."""
    strongest = np.argsort(-np.nanmax(tracks.amplitude, axis=1))[:MAX_DRAWN_ORDERS]
    drawn = sorted(strongest.tolist(), key=lambda place: tracks.order[place])
    title = f"Orders of {tracks.column.replace('_', ' ')} over the speed"
    critical = "; dashed: critical speeds" if eigenfrequencies else ""
    with marks.new_figure(0.8 + PANEL_HEIGHT * len(drawn), title + critical) as figure:
        panels = figure.subplots(len(drawn), 1, sharex=True, squeeze=False)[:, 0]
        for axes, place in zip(panels, drawn, strict=True):
            marks.curve(axes, tracks.speed, tracks.amplitude[place], color=LIGHT["measured"])
            for frequency in eigenfrequencies:
                if tracks.speed[0] < frequency / tracks.order[place] < tracks.speed[-1]:
                    axes.axvline(frequency / tracks.order[place], color=LIGHT["muted"], linestyle="--", linewidth=0.8)
            axes.set_ylim(bottom=0.0)
            marks.label_axes(axes, f"order {tracks.order[place]:.5g}", tracks.unit)
        marks.label_abscissa(panels[-1], "speed", "rad/s")
    return figure
