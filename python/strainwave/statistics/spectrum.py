"""Power over the frequency in segments with Hann windows (Welch, IEEE Trans. Audio Electroacoust. 15 (1967) 70-73)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def segment_power(series: Array, samples: int, repeated: int) -> tuple[Array, Array]:
    """Return the frequencies [cycles per sample], shape (k,), and the power of each segment less its mean, shape (segments, k).

    The power of a sine over many segments is half the square of its amplitude.

    Args:
        series: shape (n,)
        samples: of a segment, 2 to n
        repeated: samples that a segment has in common with the next

    >>> frequency, power = segment_power(3.0 * np.sin(0.25 * 2.0 * np.pi * np.arange(4000.0)), 400, 200)
    >>> float(frequency[power[0].argmax()]), power.max(axis=1).round(3).tolist()[:2]
    (0.25, [4.5, 4.5])
    """
    segments = np.lib.stride_tricks.sliding_window_view(series, samples)[:: samples - repeated]
    window = hann(samples)
    lines = np.fft.rfft((segments - segments.mean(axis=1, keepdims=True)) * window) / window.sum()
    power = lines.real**2 + lines.imag**2
    power[:, 1 : (samples + 1) // 2] *= 2.0  # a line stands for its mirror image, too
    return np.asarray(np.fft.rfftfreq(samples), np.float64), power


def mean_power(series: Array, samples: int) -> tuple[Array, Array]:
    """Return the frequencies [cycles per sample] and the mean power of segments that overlap by half, both of shape (k,)."""
    frequency, power = segment_power(series, samples, samples // 2)
    return frequency, power.mean(axis=0)


def hann(samples: int) -> Array:
    """Return a Hann window of one period, shape (samples,)."""
    return 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(samples) / samples)


def bandwidth(samples: int) -> float:
    """Return the width of a line of white noise in segments with Hann windows [cycles per sample]: power over its density."""
    window = hann(samples)
    return float(window @ window) / float(window.sum()) ** 2
