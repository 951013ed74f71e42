"""Friction over the temperature, of a drive that warms up in a long log."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from strainwave import friction
from strainwave.files.recording import Recording
from strainwave.identification.candidates.steady_friction import MIN_MOVING_SPEED, Warming, friction_over_temperature
from strainwave.identification.candidates.steady_shapes import MIN_TEMPERATURE_SPAN
from strainwave.identification.checks.unexplained import MAX_SHARE_OF_TORQUE, Left, error_left, only_if_explained
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.results.file_result import FileEstimate, FileResult
from strainwave.identification.results.gear_so_far import GearSoFar
from strainwave.identification.results.pictures import Picture
from strainwave.statistics.residuals import rms

Array = NDArray[np.float64]

EFFORT_CHANNELS = ("joint_torque", "input_torque", "current")
MIN_CHANGE_SIGMA = 2.0  # beyond which friction changes with the temperature
TEMPERATURE_CLASSES = 24  # in the figure
MIN_SAMPLES_PER_CLASS = 10
ONE_WAY_FALL = "it moves one way only: a weight and an offset are in its friction, and its relative fall is not determined"


def warmed(file: Recognised) -> tuple[FileResult, Warming] | None:
    """Return friction over the temperature, and how it changes; None if a log does not determine it."""
    recording = file.recording
    effort = next((name for name in EFFORT_CHANNELS if name in recording), None)
    if effort is None or "temperature" not in recording or np.ptp(recording["temperature"]) < MIN_TEMPERATURE_SPAN:
        return None
    speed = _speed(recording)
    if speed is None:
        return None
    series = Recording(
        {"speed": speed, "temperature": recording.values("temperature", "K"), effort: recording[effort]},
        {"speed": "rad/s", "temperature": "K", effort: recording.unit(effort)},
    )
    try:
        warming = friction_over_temperature(series, effort)
    except ValueError:
        return None
    fall, slope, level = warming.fall, warming.slope, warming.friction
    sure = abs(fall.value) > MIN_CHANGE_SIGMA * fall.sigma
    why = "" if sure else "the friction does not change with the temperature beyond chance"
    why = ONE_WAY_FALL if sure and warming.one_way else why
    low, high = slope.interval(0.95)
    remarks: tuple[str, ...] = (
        f"friction over the temperature, of {effort.replace('_', ' ')}: {level.value:.4g} ± {level.sigma:.2g} {level.unit} at "
        f"{_celsius(warming.reference_temperature)}; it changes by {slope.value:.3g} {slope.unit}, "
        f"with 95 % between {low:.3g} and {high:.3g}",
        "the log does not separate temperature from other changes in the same time, as wear-in or another task",
    )
    if warming.one_way:
        remarks = (*remarks, ONE_WAY_FALL)
    estimates = (FileEstimate("gear.friction_input.dry_fall", "1/K", fall.value, fall.sigma, "thermal", why),)
    curves = _curves(series, effort, warming)
    means = curves[f"friction_of_{effort}"]
    left = Left(rms(means - curves["modelled"]), rms(means), level.unit, MAX_SHARE_OF_TORQUE)
    whole = error_left({"friction over the temperature": left}, file.path.name)
    return FileResult(
        file.path.name, file, "friction over the temperature", only_if_explained(estimates, whole), remarks, (whole,),
        pictures=(Picture(curves, "means"),),
    ), warming  # fmt: skip


def with_fall(known: GearSoFar, found: Warming, result: FileResult) -> tuple[GearSoFar, tuple[str, ...]]:
    """Return the gear with the fall of friction over the temperature, and what was assumed for it."""
    law: Any = known.gear_set.gear.friction_input
    (estimate,) = result.estimates
    if estimate.why or estimate.value <= 0.0 or law.name == "thermal":
        return known, ()
    warmer = friction.Thermal(
        law=law, dry_fall=estimate.value, viscous_fall=estimate.value, reference_temperature=found.reference_temperature
    )
    at = _celsius(found.reference_temperature)
    assumed = f"the friction of the gear is taken to hold at {at}, its dry and viscous part to fall alike"
    return known.with_parts({"friction_input": warmer}, {estimate.path: estimate.sigma}, result.name), (assumed,)


def _celsius(temperature: float) -> str:
    return f"{temperature - 273.15:.3g} °C"


def _speed(recording: Recording) -> Array | None:
    for side in ("input", "output"):
        if f"{side}_speed" in recording:
            return recording.values(f"{side}_speed", "rad/s")
        if f"{side}_angle" in recording:
            return np.gradient(recording.values(f"{side}_angle", "rad"), recording.time)
    return None


def _curves(series: Recording, effort: str, found: Warming) -> Recording:
    """Return means of the effort against the motion, of classes of the temperature."""
    speed, temperature = series["speed"], series["temperature"]
    moving = np.abs(speed) > MIN_MOVING_SPEED * np.abs(speed).max()
    temperature, way, force = temperature[moving], np.sign(speed[moving]), series[effort][moving]
    edges = np.quantile(temperature, np.linspace(0.0, 1.0, TEMPERATURE_CLASSES + 1))
    place = np.clip(np.searchsorted(edges, temperature, "right") - 1, 0, TEMPERATURE_CLASSES - 1)
    rows, ways = [], np.unique(way)
    for each in range(TEMPERATURE_CLASSES):
        there = place == each
        of_ways = [force[there & (way == sign)] for sign in ways]
        if min(map(len, of_ways)) >= MIN_SAMPLES_PER_CLASS:
            level = np.mean([sign * values.mean() for sign, values in zip(ways, of_ways, strict=True)])
            rows.append((float(temperature[there].mean()), float(level)))
    where, level = np.array(rows).reshape(-1, 2).T
    line = found.friction.value + found.slope.value * (where - found.reference_temperature)
    unit = series.unit(effort)
    return Recording(
        {"temperature": where, f"friction_of_{effort}": level, "modelled": line},
        {"temperature": "K", f"friction_of_{effort}": unit, "modelled": unit},
    )
