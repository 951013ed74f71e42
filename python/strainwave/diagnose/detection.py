r"""Statistics of detection: significance of a line in noise of unknown level, its interval, and the amplitude that is needed.

The amplitudes of the sine and the cosine of an order are found by least squares under Gaussian noise. The generalised
likelihood ratio test for a line compares their size with that of the noise around the order (Kay1998, linear model of unknown
variance):

.. math:: F = \frac{|a|^2}{p \, \sigma^2}

with a the p = 2 amplitudes, each of standard deviation :math:`\sigma`, estimated with :math:`\nu` degrees of freedom. Noise
alone makes it follow :math:`F(p, \nu)`; a line of amplitude A the non-central F with :math:`\lambda = A^2 / \sigma^2`.
Several orders tested together share the stated rate of false alarms (Bonferroni's bound).
"""

from __future__ import annotations

from math import inf, isfinite, sqrt

MAX_SIGNAL_TO_NOISE = 1e6  # amplitude over standard deviation: beyond it noise does not matter
CONFIDENCE_LEVEL = 0.95  # of intervals
FALSE_ALARM = 1e-3  # probability over all tests of a recording, if none is stated
DETECTION_PROBABILITY = 0.9  # of a line at the smallest amplitude that a recording shows


def false_alarm_of(evidence: float, parts: int, freedom: float, tests: int = 1) -> float:
    """Return the probability that noise alone gives as much in any of some tests.

    Args:
        evidence: F of a test [1]
        parts: amplitudes in it, two for each line [1]
        freedom: degrees of freedom of the level of the noise [1]; inf if the level is known

    >>> round(false_alarm_of(6.9078, 2, inf), 6)  # exp(-F) for a known level
    0.001
    """
    from scipy.stats import chi2, f

    single = f.sf(evidence, parts, freedom) if isfinite(freedom) else chi2.sf(parts * evidence, parts)
    return min(1.0, tests * float(single))


def threshold_of(false_alarm: float, parts: int, freedom: float, tests: int = 1) -> float:
    """Return the F that noise alone exceeds with this probability in any of some tests.

    >>> round(threshold_of(1e-3, 2, inf), 4)
    6.9078
    """
    from scipy.stats import chi2, f

    single = false_alarm / tests
    return float(f.isf(single, parts, freedom)) if isfinite(freedom) else float(chi2.isf(single, parts)) / parts


def power_of(signal_to_noise: float, false_alarm: float, freedom: float, tests: int = 1) -> float:
    """Return the probability that a line is detected, at a ratio of its amplitude to the standard deviation of a part [1].

    The probability of a false alarm is that over all tests.

    >>> round(power_of(0.0, 1e-3, 60.0), 6), round(power_of(5.0, 1e-3, inf), 3)
    (0.001, 0.919)
    """
    from scipy.stats import ncf, ncx2

    if signal_to_noise == 0.0:
        return false_alarm / tests
    threshold, shift = threshold_of(false_alarm, 2, freedom, tests), signal_to_noise**2
    return float(ncf.sf(threshold, 2, freedom, shift) if isfinite(freedom) else ncx2.sf(2.0 * threshold, 2, shift))


def needed_signal_to_noise(probability: float, false_alarm: float, freedom: float, tests: int = 1) -> float:
    """Return the amplitude over its standard deviation that is detected with a probability.

    >>> round(needed_signal_to_noise(0.9, 1e-3, inf), 3)
    4.88
    """
    from scipy.optimize import brentq

    if probability <= false_alarm / tests:
        return 0.0
    high = 1.0
    while power_of(high, false_alarm, freedom, tests) < probability and high < MAX_SIGNAL_TO_NOISE:
        high *= 2.0
    return float(brentq(lambda size: power_of(size, false_alarm, freedom, tests) - probability, 0.0, high, xtol=1e-9))


def detectable_change(probability: float, false_alarm: float, freedom: float) -> float:
    """Return the change over its standard deviation that a two-sided test by Student's distribution finds with a probability.

    >>> round(detectable_change(0.9, 1e-3, 1e6), 3)  # 3.291 + 1.282
    4.572
    """
    from scipy.optimize import brentq
    from scipy.stats import nct, t as student

    threshold = float(student.isf(0.5 * false_alarm, freedom))
    high = threshold
    while nct.sf(threshold, freedom, high) < probability:
        high *= 2.0
    return float(brentq(lambda size: nct.sf(threshold, freedom, size) - probability, 0.0, high, xtol=1e-9))


def amplitude_interval(
    amplitude: float, sigma: float, freedom: float = inf, confidence: float = CONFIDENCE_LEVEL
) -> tuple[float, float]:
    """Return the confidence interval of the amplitude of a line.

    It inverts the distribution of the amplitude found, that of Rice for a known level of the noise. So it covers the true
    amplitude with the stated confidence at every amplitude. A symmetric interval does not do so near zero. Its lower end is
    zero if noise alone may give as much.

    Args:
        amplitude: in any unit
        sigma: standard deviation of each of its two parts, in that unit
        freedom: degrees of freedom of the level of the noise

    >>> low, high = amplitude_interval(1.0, 0.1)
    >>> round(low, 3), round(high, 3)
    (0.798, 1.191)
    >>> amplitude_interval(0.1, 0.1)[0]
    0.0
    """
    from scipy.optimize import brentq

    from strainwave import arguments

    outside = 0.5 * (1.0 - arguments.probability("confidence", confidence))
    if not sigma > 0.0 or (size := amplitude / sigma) > MAX_SIGNAL_TO_NOISE:
        return amplitude, amplitude
    margin = 4.0 * sqrt(max(1.0, size)) + 0.5 * size * (8.0 / sqrt(freedom) if isfinite(freedom) else 0.0) + 8.0

    def bound(tail: float) -> float:
        """Return the true amplitude of which one as small as that found is seen with the probability of the tail."""
        if _below(size, 0.0, freedom) <= tail:
            return 0.0
        return float(brentq(lambda true: _below(size, true, freedom) - tail, 0.0, size + margin, xtol=1e-9))

    return sigma * bound(1.0 - outside), sigma * bound(outside)


def _below(size: float, true: float, freedom: float) -> float:
    """Return the probability of an amplitude below that found, over sigma, for a true one."""
    from scipy.stats import chi2, f, ncf, ncx2

    if isfinite(freedom):
        law = f.cdf(0.5 * size**2, 2, freedom) if true == 0.0 else ncf.cdf(0.5 * size**2, 2, freedom, true**2)
    else:
        law = chi2.cdf(size**2, 2) if true == 0.0 else ncx2.cdf(size**2, 2, true**2)
    return float(law)
