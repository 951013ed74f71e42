"""Spectra of the residual of a log and of its measurement."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strainwave.drawing import marks
from strainwave.drawing.style import LIGHT
from strainwave.statistics.spectrum import mean_power

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from strainwave.identification.fitting.fit import RecordFit

Array = NDArray[np.float64]
MAX_SEGMENT = 4096  # samples, of which spectra are averaged
MIN_SAMPLES = 32
HEAD_HEIGHT, PANEL_HEIGHT = 1.0, 2.4  # inches


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
    if len(time) < MIN_SAMPLES:
        raise ValueError(f"the record has {len(time)} samples; a spectrum needs {MIN_SAMPLES} or more")
    even = np.linspace(time[0], time[-1], len(time))
    rate = (len(time) - 1) / (time[-1] - time[0])
    samples = min(len(time), MAX_SEGMENT)
    powers = [mean_power(np.interp(even, time, values), samples)[1] for values in series]
    return rate * np.fft.rfftfreq(samples)[1:], *(np.sqrt(2.0 * power[1:]) for power in powers)


def spectrum_figure(part: RecordFit, title: str) -> Figure:
    """Return the figure of each channel, as `Fit.plot_residual_spectrum` describes it."""
    log: Any = part.experiment
    if not hasattr(log, "time"):
        raise ValueError("the record has no time: only a log has a spectrum; `plot` shows the residual of a table or a loop")
    with marks.new_figure(HEAD_HEIGHT + PANEL_HEIGHT * len(log.channels), title) as figure:
        axes = figure.subplots(len(log.channels), 1, sharex=True, squeeze=False)[:, 0]
        channels = zip(axes, log.channels, log.units, log.measured, part.residuals, strict=True)
        for axis, channel, unit, measured, residual in channels:
            frequency, *spectra = amplitude_spectra(log.time, measured, residual)
            for label, colour, amplitude in zip(("measured", "residual"), ("measured", "model"), spectra, strict=True):
                axis.loglog(frequency, amplitude, color=LIGHT[colour], linewidth=1.0, label=label)
            marks.label_axes(axis, f"amplitude of {channel.replace('_', ' ')}", unit)
        marks.label_abscissa(axes[-1], "frequency", "Hz")
        marks.legend(figure, axes[0], below=True)
    return figure
