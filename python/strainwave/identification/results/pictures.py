"""Measurements against their models: curves of a fit, their drawing with the residual below, spectra of the residual."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from strainwave.drawing import marks
from strainwave.drawing.style import LIGHT
from strainwave.equality import ComparedByFields
from strainwave.files.recording import Recording
from strainwave.identification.experiments.experiment import Experiment
from strainwave.statistics.spectrum import mean_power

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure, SubFigure

Array = NDArray[np.float64]

FIGURE_HEIGHT = 4.3  # inches
SIGMA_OF_95_PERCENT = 1.959963984540054  # standard deviations about the mean that contain 95 % of a normal distribution
MAX_LOOP_POINTS = 600  # of a loop that are drawn
MAX_INTERVALS = 2.5  # median intervals between two samples that a line joins
MAX_BAND_BLOCKS = 200  # stretches of a band over time
ANGLE_NAMES = {"small_angle": "angle of the input"}  # of loops, in words
MAX_SEGMENT_SAMPLES = 4096  # samples, of which spectra are averaged
MIN_SPECTRUM_SAMPLES = 32
SPECTRUM_HEAD_HEIGHT, SPECTRUM_PANEL_HEIGHT = 1.0, 2.4  # inches
Look = Literal["table", "loop", "series", "means", "records", "turn"]
OVER_TEMPERATURE = {"means": ("means of classes", "line through all samples"), "records": ("records", "line")}  # by look
Subject = Literal["torque", "friction", "twist", "error", ""]
UNITS_OF_EFFORT = ("N.m", "A", "V")


@dataclass(frozen=True, eq=False)
class Picture(ComparedByFields):
    """Measured against modelled, to be drawn.

    Attributes:
        curves: the abscissa, the channel measured, and `modelled`, as `Fit.curves` returns them
        look: style of the drawing
        label: of the channel in words; its name if not given
        title: of the picture, if a file has several
        model: in words, if it is not that of the file
        orders: of an error over a turn, each with its amplitude and the standard deviation of that
    """

    curves: Recording
    look: Look = "series"
    label: str = ""
    title: str = ""
    model: str = ""
    orders: tuple[tuple[float, float, float], ...] = ()

    @property
    def subject(self) -> Subject:
        """Pictures of the first screen: torque over time, friction over speed, twist over torque, error over a turn."""
        if self.look == "turn":
            return "error"
        if self.look == "loop":
            return "twist" if "twist" in self.curves else ""
        if self.look == "table":
            return "friction"
        return "torque" if self.look == "series" and self.curves.unit(self.curves.names[1]) in UNITS_OF_EFFORT else ""


def picture_of(curves: Recording) -> Picture:
    """Return the picture of a channel of a fit, as `Fit.curves` returns its curves."""
    look: Look = {"speed": "table", "twist": "loop"}.get(curves.names[0], "series")  # type: ignore[assignment]
    return Picture(curves, look)


def pictures_of_run(channels: Iterable[Recording]) -> tuple[Picture, ...]:
    """Return a picture over time of each channel of a run, by its curves."""
    return tuple(Picture(curves, title=curves.names[1].replace("_", " ")) for curves in channels)


def draw_picture(figure: Figure | SubFigure, picture: Picture) -> Axes:
    """Draw measured and modelled, and below the residual with two bands of 95 %: of the model, and of the residuals.

    Returns:
        the upper axes, which have the labels of a legend
    """
    if picture.look == "turn":
        return draw_measured(figure, picture)
    shared = picture.look != "loop"
    whole: Axes
    whole, left = figure.subplots(2, 1, sharex=shared, height_ratios=(2.2, 1.0))
    _MEASURED[picture.look](whole, picture)
    if shared:
        whole.set_xlabel("")
    _draw_residual(left, picture)
    if "held_out" in picture.curves:
        x = picture.curves[picture.curves.names[0]] if shared else np.arange(1.0, len(picture.curves) + 1.0)
        for axes in (whole, left) if shared else (left,):
            marks.shade(axes, x, picture.curves["held_out"] > 0.0)
    return whole


def draw_measured(figure: Figure | SubFigure, picture: Picture) -> Axes:
    """Draw measured and modelled alone; of an error over a turn its orders, too. Return axes with labels."""
    if picture.look == "turn":
        return _turn(figure, picture)
    axes: Axes = figure.subplots()
    _MEASURED[picture.look](axes, picture)
    return axes


def pictures_figure(pictures: Sequence[Picture], title: str) -> Figure:
    """Return the figure of one picture or several, below each other."""
    with marks.new_figure(FIGURE_HEIGHT * len(pictures), title) as figure:
        parts = np.atleast_1d(np.array(figure.subfigures(len(pictures), 1)))
        for part, picture in zip(parts, pictures, strict=True):
            marks.legend(part, draw_picture(part, picture))
    return figure


def residual_of(curves: Recording) -> Array:
    """Return what is left of a file: measured less modelled, or what neither orders nor loads explain."""
    return np.asarray(curves["residual"] if "residual" in curves else curves[curves.names[1]] - curves["modelled"])


def picture_label(picture: Picture) -> str:
    """Return the name of what was measured."""
    return picture.label or picture.curves.names[1].replace("_", " ")


def _table(axes: Axes, picture: Picture) -> None:
    """Draw torque over speed."""
    torque = picture.curves.names[1]
    table_points(axes, picture.curves)
    marks.label_axes(axes, picture_label(picture), picture.curves.unit(torque), "input speed", "rad/s")


def table_points(axes: Axes, curves: Recording) -> None:
    """Draw the rows of a table and the law, each direction by itself."""
    order = np.argsort(curves["speed"], kind="stable")
    speed = curves["speed"][order]
    axes.plot(speed, curves[curves.names[1]][order], "o", color=LIGHT["measured"], label="measured", zorder=3)
    modelled = curves["modelled"][order]
    if np.any((np.diff(speed) == 0.0) & (np.diff(modelled) != 0.0)):  # of several loads at one speed, which no line shows
        axes.plot(speed, modelled, "_", color=LIGHT["model"], markersize=11.0, markeredgewidth=1.6, label="model", zorder=4)
    else:
        for side in (speed < 0.0, speed > 0.0):
            axes.plot(speed[side], modelled[side], color=LIGHT["model"], label="model" if side[-1] else "")
    marks.speed_axis(axes, speed)


def loop_points(axes: Axes, curves: Recording) -> None:
    """Draw the measured points of a loop over its torque, and the fitted loop in the order measured."""
    rows = np.unique(np.linspace(0, len(curves) - 1, MAX_LOOP_POINTS).astype(int))
    over, channel, modelled = (curves[name][rows] for name in (*curves.names[:2], "modelled"))
    points, lines = ((over, channel), (over, modelled)) if curves.names[0] == "torque" else ((channel, over), (modelled, over))
    axes.plot(*points, "o", color=LIGHT["measured"], markersize=3.0, alpha=0.5, label="measured")
    axes.plot(*lines, color=LIGHT["model"], linewidth=0.9, label="model")


def _loop(axes: Axes, picture: Picture) -> None:
    """Draw the angle over the torque."""
    loop_points(axes, picture.curves)
    torque, angle = sorted(picture.curves.names[:2], key=lambda name: picture.curves.unit(name) == "rad")
    side = picture_label(picture).removeprefix("torque").removeprefix("twist")
    name = ANGLE_NAMES.get(angle, angle.replace("_", " "))
    marks.label_axes(axes, f"{name}{side}", "rad", torque, picture.curves.unit(torque))


def _means(axes: Axes, picture: Picture) -> None:
    """Draw means of the friction, or numbers of records, over the temperature, and their line."""
    points, line = OVER_TEMPERATURE[picture.look]
    over, channel = picture.curves.names[:2]
    celsius = picture.curves.values(over, "degC")
    axes.plot(celsius, picture.curves[channel], "o", color=LIGHT["measured"], label=points)
    axes.plot(celsius, picture.curves["modelled"], color=LIGHT["model"], label=line)
    marks.label_axes(axes, picture_label(picture), picture.curves.unit(channel), "temperature", "degC")


def _series(axes: Axes, picture: Picture) -> None:
    """Draw a channel over time, or over the angle if there is no time."""
    curves = picture.curves
    over, channel = curves.names[:2]
    x, measured, modelled = _broken(curves[over], curves[channel], curves["modelled"])
    marks.curve(axes, x, measured, color=LIGHT["measured"], linewidth=2.4, alpha=0.6, label="measured")
    label = "orders found" if "residual" in curves else "model"
    marks.curve(axes, x, modelled, color=LIGHT["model"], linewidth=0.9, label=label)
    marks.label_axes(axes, picture_label(picture), curves.unit(channel), over.replace("_", " "), curves.unit(over))


def _turn(figure: Figure | SubFigure, picture: Picture) -> Axes:
    """Draw an error over a turn, and beside it the amplitude of each order with its interval of 95 %."""
    curves = picture.curves
    whole, bars = figure.subplots(1, 2, width_ratios=(1.4, 1.0))
    over, channel = curves.names[:2]
    degrees = np.rad2deg(curves[over])
    whole.plot(degrees, curves[channel], "o", color=LIGHT["measured"], markersize=2.6, label="measured")
    whole.plot(degrees, curves["modelled"], color=LIGHT["model"], label="model: its orders")
    whole.set_xticks([0, 90, 180, 270, 360])
    marks.label_axes(whole, "error", curves.unit(channel), "input angle", "deg")
    order, amplitude, sigma = np.array(picture.orders).T
    place = np.arange(len(order))
    bars.bar(place, amplitude, color=LIGHT["model"], width=0.7)
    bars.errorbar(place, amplitude, SIGMA_OF_95_PERCENT * sigma, fmt="none", ecolor=LIGHT["ink"], elinewidth=0.9)
    bars.set_xticks(place, [f"{each:g}" for each in order])
    marks.label_axes(bars, "orders", curves.unit(channel))
    bars.set_xlabel("order")
    return whole  # type: ignore[no-any-return]


_MEASURED: dict[Look, Callable[[Axes, Picture], None]] = {
    "table": _table, "loop": _loop, "means": _means, "records": _means, "series": _series,
}  # fmt: skip


def _draw_residual(axes: Axes, picture: Picture) -> None:
    """Draw what is left, with its bands, over the abscissa of a picture; of a loop in the order measured."""
    curves, look = picture.curves, picture.look
    over, channel = curves.names[:2]
    x, residual, sigma = curves[over], residual_of(curves), None
    if "sigma" in curves:
        sigma = curves["sigma"]
    label, x_label, x_unit = "measured − modelled", over.replace("_", " "), curves.unit(over)
    if look == "table":
        order = np.argsort(x, kind="stable")
        x, residual, sigma = x[order], residual[order], None if sigma is None else sigma[order]
        x_label, x_unit = "input speed", "rad/s"
    elif look == "loop":
        x, x_label, x_unit = np.arange(1.0, len(curves) + 1.0), "point compared, in the order measured", "1"
    elif look in OVER_TEMPERATURE:
        x, sigma, label = curves.values(over, "degC"), None, f"{look} − line"
        x_label, x_unit = "temperature", "degC"
    elif "residual" in curves:
        label = "left by orders and loads"
    place, left = _broken(x, residual) if look == "series" else (x, residual)
    marks.residual_curve(axes, place, left, LIGHT["ink"])
    _bands(axes, x, residual, sigma)
    marks.label_axes(axes, label, curves.unit(channel), x_label, x_unit)


def _broken(x: Array, *series: Array) -> tuple[Array, ...]:
    """Return series with a gap where samples were left out; those with so many samples that extremes are drawn, unchanged."""
    gaps = (
        np.flatnonzero(np.abs(np.diff(x)) > MAX_INTERVALS * np.median(np.abs(np.diff(x)))) + 1
        if len(x) > 1
        else np.zeros(0, int)
    )
    if len(x) + len(gaps) > 4 * marks.MAX_CURVE_STRETCHES:
        return x, *series
    return np.insert(x, gaps, x[gaps]), *(np.insert(each, gaps, np.nan) for each in series)


def _bands(axes: Axes, x: Array, residual: Array, sigma: Array | None) -> None:
    """Draw the limits of 95 % of the residuals, if they are normal, and the interval of the model."""
    level = SIGMA_OF_95_PERCENT * float(np.sqrt(np.mean(residual**2)))
    for side in (-level, level):
        axes.axhline(side, color=LIGHT["earlier"], linestyle="--", linewidth=0.9)
    if sigma is not None:
        blocks = np.array_split(np.arange(len(x)), min(len(x), MAX_BAND_BLOCKS))
        band = np.array([float(np.max(SIGMA_OF_95_PERCENT * sigma[rows])) for rows in blocks])
        axes.fill_between(
            [float(np.mean(x[rows])) for rows in blocks], -band, band, facecolor=LIGHT["model"], alpha=0.35, linewidth=0.0
        )


# ---- Spectra of the residual -----------------------------------------------------------------------------------------


def amplitude_spectra(time: Array, *series: Array) -> tuple[Array, ...]:
    """Return the frequencies [Hz] and the amplitude spectrum of each series, averaged over segments with Hann windows.

    Args:
        time: [s], shape (n,); uneven time is put on an even clock by interpolation
        series: shape (n,)

    >>> time = np.arange(0.0, 10.0, 0.01)
    >>> frequency, amplitude = amplitude_spectra(time, 0.3 * np.sin(2.0 * np.pi * 5.0 * time))
    >>> round(float(frequency[amplitude.argmax()]), 1), round(float(amplitude.max()), 2)
    (5.0, 0.3)
    """
    if len(time) < MIN_SPECTRUM_SAMPLES:
        raise ValueError(f"the record has {len(time)} samples; a spectrum needs {MIN_SPECTRUM_SAMPLES} or more")
    even = np.linspace(time[0], time[-1], len(time))
    rate = (len(time) - 1) / (time[-1] - time[0])
    samples = min(len(time), MAX_SEGMENT_SAMPLES)
    powers = [mean_power(np.interp(even, time, values), samples)[1] for values in series]
    return rate * np.fft.rfftfreq(samples)[1:], *(np.sqrt(2.0 * power[1:]) for power in powers)


def spectrum_figure(experiment: Experiment, residuals: Array, title: str) -> Figure:
    """Return the figure of each channel, as `Fit.plot_residual_spectrum` describes it."""
    log: Any = experiment
    if not hasattr(log, "time"):
        raise ValueError("the record has no time: only a log has a spectrum; `plot` shows the residual of a table or a loop")
    with marks.new_figure(SPECTRUM_HEAD_HEIGHT + SPECTRUM_PANEL_HEIGHT * len(log.channels), title) as figure:
        axes = figure.subplots(len(log.channels), 1, sharex=True, squeeze=False)[:, 0]
        channels = zip(axes, log.channels, log.units, log.measured, residuals, strict=True)
        for axis, channel, unit, measured, residual in channels:
            frequency, *spectra = amplitude_spectra(log.time, measured, residual)
            for label, colour, amplitude in zip(("measured", "residual"), ("measured", "model"), spectra, strict=True):
                axis.loglog(frequency, amplitude, color=LIGHT[colour], linewidth=1.0, label=label)
            marks.label_axes(axis, f"amplitude of {channel.replace('_', ' ')}", unit)
        marks.label_abscissa(axes[-1], "frequency", "Hz")
        marks.legend(figure, axes[0])
    return figure
