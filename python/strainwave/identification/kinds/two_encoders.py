"""A record of two encoders: orders of the kinematic error."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, cast

import numpy as np
from numpy.typing import NDArray

from strainwave.files.entries import Entry
from strainwave.files.recording import Recording
from strainwave.identification.candidates.steady_shapes import MIN_TEMPERATURE_SPAN
from strainwave.identification.kinds.kind import Kind
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.reading.roles import Column, ColumnRoles, first, measured, names_of, pair, sides_of_angles
from strainwave.identification.results.file_result import FileEstimate, FileResult
from strainwave.identification.results.gear_so_far import ERROR_AMPLITUDE, GearSoFar, is_of
from strainwave.identification.results.pictures import Picture
from strainwave.messages import listed
from strainwave.orders.over_temperature import ErrorOverTemperature, error_over_temperature
from strainwave.orders.two_encoders import WHY_AMPLITUDES_CHANGE, TransmissionError, transmission_error
from strainwave.questions import QuestionError

if TYPE_CHECKING:
    from strainwave import kinematic_error

Array = NDArray[np.float64]
OVER_TEMPERATURE = "kinematic error over the temperature"
RATIO_OPTION = "--constant ratio=NUMBER"
TEMPERATURE_UNITS = {"temperature": "K", "amplitude": "rad", "modelled": "rad"}
MAX_DRAWN_ORDERS = 2  # over the temperature
TURN_BINS = 72  # parts of a turn of the input: order 8 has nine of them


class TwoEncoders(Kind):
    """Angles of input and output, without torque or current."""

    needs = "two angles"
    time = "used"

    def recognises(self, columns: Sequence[Column], mapping: FileMapping) -> bool:
        """True for several angles without torque or current."""
        return len(measured(columns, "angle")) > 1 and not measured(columns, "torque", "current")

    def roles(self, columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
        angles = measured(columns, "angle")
        if len(angles) != 2:
            more = "; leave the others out, with --column unused=PLACE, by the place in the file"
            there = f"it has {names_of(columns)}{more if len(angles) > 2 else ''}"
            raise QuestionError(f"a record of two encoders needs two angles; {there}")
        fast, slow, why_side = sides_of_angles(angles)
        why = f"its columns are {pair(*angles)}, and no torque or current: {self.title}"
        by_channel = {**first(columns, "time"), "input_angle": fast, "output_angle": slow, **first(columns, "temperature")}
        return ColumnRoles(self.name, by_channel, None, tuple(filter(None, (why, why_side))))

    def fit(self, file: Recognised, known: GearSoFar) -> tuple[FileResult, GearSoFar]:
        """Fit the orders of the kinematic error."""
        given = file.constants.get("ratio")
        errors = transmission_error(file.recording, ratio=given, ratio_option=RATIO_OPTION)
        name = file.path.name
        remarks, pictures = (*file.remarks, *errors.remarks), (picture_of_turn(errors), Picture(curves_of_orders(errors)))
        estimates = tuple(_at_its_temperature(file, errors))
        result = FileResult(name, file, "orders of the input", estimates, remarks, pictures=pictures)
        return result, with_error(known, errors, name)

    def fit_together(self, files: Sequence[Recognised], known: GearSoFar) -> tuple[tuple[FileResult, ...], GearSoFar]:
        """Fit the kinematic error over the temperature, if the temperatures of the files differ enough."""
        measured_at = list[tuple[Recognised, float, TransmissionError]]()
        for file in files:
            if np.isfinite(temperature := file.temperature):
                with suppress(ValueError):  # one that cannot be used, as its own result states
                    errors = transmission_error(file.recording, ratio=file.constants.get("ratio"), ratio_option=RATIO_OPTION)
                    measured_at.append((file, temperature, errors))
        temperatures = [at for _, at, _ in measured_at]
        if not temperatures or np.ptp(temperatures) < MIN_TEMPERATURE_SPAN:
            return (), known
        found = error_over_temperature([errors for *_, errors in measured_at], temperatures)
        names = [file.path.name for file, *_ in measured_at]
        determined_by = {file for path, file in known.determined_by.items() if is_of(path, {"kinematic_error"})}
        is_own = bool(found.orders) and determined_by <= set(names)
        after = with_error_over_temperature(known, found, names) if is_own else known
        pictures = tuple(_pictures_over_temperature(found, [errors for *_, errors in measured_at]))
        return (replace(result_over_temperature(found, names), pictures=pictures),), after


def with_error(known: GearSoFar, found: TransmissionError, name: str) -> GearSoFar:
    """Return the set with a kinematic error, unless an earlier file determined it."""
    law = found.law
    if "kinematic_error" in known.determined or not law.order:
        return known
    by_order = {each.order: each for each in found.orders if each.significant and each.shaft != "output"}
    sigmas = {f"{ERROR_AMPLITUDE}[{i}]": by_order[order].amplitude_sigma for i, order in enumerate(law.order)}
    sigmas |= {f"gear.kinematic_error.phase[{i}]": by_order[order].phase_sigma for i, order in enumerate(law.order)}
    if not found.vibrates:
        return known.with_parts({"kinematic_error": law}, sigmas, f"{name}, at {found.speeds}" if found.speeds else name)
    entries = {path: Entry(f"identified in combination: {_why(found)}", uncertainty=sigma) for path, sigma in sigmas.items()}
    return known.with_sums({"kinematic_error": law}, entries, name)


def with_error_over_temperature(known: GearSoFar, found: ErrorOverTemperature, names: Sequence[str]) -> GearSoFar:
    """Return the set with a kinematic error that depends on the temperature, or its mean if no order changes."""
    whole, mean = found.law, cast("kinematic_error.Fourier", found.law.law)
    law, inner = (whole, "law.") if whole.order else (mean, "")
    by_order = {each.order: each for each in found.orders}
    sigmas = {}
    for i, order in enumerate(mean.order):
        sigmas[f"gear.kinematic_error.{inner}amplitude[{i}]"] = by_order[order].amplitude_sigma
        sigmas[f"gear.kinematic_error.{inner}phase[{i}]"] = by_order[order].phase_sigma
    for i, (order, change) in enumerate(zip(whole.order, whole.change, strict=True)):
        sigmas[f"gear.kinematic_error.change[{i}]"] = by_order[order].change_sigma
        sigmas[f"gear.kinematic_error.phase[{i}]"] = by_order[order].change_sigma / change
    return known.with_parts({"kinematic_error": law}, sigmas, listed(names))


def result_over_temperature(found: ErrorOverTemperature, names: Sequence[str]) -> FileResult:
    """Return the changes of the orders over the temperature as a result of all files."""
    columns = {"temperature": np.array(found.temperatures)}
    why = (f"{listed(names)} are records of two encoders at several temperatures",)
    file = Recognised(Path(OVER_TEMPERATURE), "encoders", {}, {}, None, why, (), {}, Recording(columns, {"temperature": "K"}))
    estimates = tuple(
        FileEstimate(
            f"gear.kinematic_error.change of order {each.order:g}",
            "rad/K",
            each.change,
            each.change_sigma,
            "temperature_dependent",
            "" if each.significant else f"noise alone gives as much with a probability of {each.false_alarm:.2g}",
        )
        for each in found.orders
    )
    what = "orders of records at several temperatures"
    return FileResult(OVER_TEMPERATURE, file, "straight lines", estimates, found.remarks, what=what)


def _pictures_over_temperature(found: ErrorOverTemperature, errors: Sequence[TransmissionError]) -> Iterator[Picture]:
    """Yield the amplitude of the strongest orders that change over the temperature, with their lines."""
    temperature = np.array(found.temperatures)
    changing = sorted((each for each in found.orders if each.significant), key=lambda each: -each.amplitude)
    for order in changing[:MAX_DRAWN_ORDERS]:
        amplitude = [next((each.amplitude for each in error.orders if each.order == order.order), np.nan) for error in errors]
        line = order.amplitude + order.amplitude_rate * (temperature - found.reference_temperature)
        columns = {"temperature": temperature, "amplitude": np.array(amplitude), "modelled": line}
        rows = np.isfinite(columns["amplitude"])
        curves = Recording({name: values[rows] for name, values in columns.items()}, TEMPERATURE_UNITS)
        yield Picture(curves, "records", f"amplitude of order {order.order:g}", f"order {order.order:g}")


def _at_its_temperature(file: Recognised, found: TransmissionError) -> Iterator[FileEstimate]:
    """Yield the orders of a file; those at different temperatures are not compared."""
    degrees = file.temperature
    for each in orders_of(found):
        yield replace(each, law=f"at {degrees:.0f} K") if np.isfinite(degrees) else each


def orders_of(found: TransmissionError) -> Iterator[FileEstimate]:
    """Yield the orders of the kinematic error that stand out."""
    for each in found.orders:
        if each.shaft == "input" and each.significant:
            yield FileEstimate(
                f"{ERROR_AMPLITUDE} of order {each.order:g}",
                "rad",
                each.amplitude,
                each.amplitude_sigma,
                "fourier",
                _why(found),
                in_combination=found.vibrates,
            )


def _why(found: TransmissionError) -> str:
    """Return why amplitudes are not those of the gear alone; empty if they are."""
    return f"amplitudes are those measured at {found.speeds}: {WHY_AMPLITUDES_CHANGE}" if found.vibrates else ""


def curves_of_orders(found: TransmissionError) -> Recording:
    """Return the transmission error and its significant orders.

    Returns:
        time, or the input angle if there is no time; `transmission_error`; `modelled`, its significant orders; `residual`,
        left by orders and loads; and `sigma`, the standard deviation of `modelled` by amplitudes and phases of the
        input's orders, taken as independent
    """
    curves = found.curves
    over = "time" if "time" in curves else "input_angle"
    error, angle = curves["transmission_error"], curves["input_angle"]
    variance = np.zeros_like(angle)
    for each in found.orders:
        if each.significant and each.shaft == "input":
            phase = each.order * angle + each.phase
            variance += (each.amplitude_sigma * np.sin(phase)) ** 2
            variance += (each.amplitude * each.phase_sigma * np.cos(phase)) ** 2
    columns = {over: curves[over], "transmission_error": error, "modelled": curves["kinematic_error"]}
    columns |= {"residual": curves["residual"], "sigma": np.sqrt(variance)}
    units = dict.fromkeys(columns, "rad") | {over: curves.unit(over)}
    return Recording(columns, units)


def picture_of_turn(found: TransmissionError) -> Picture:
    """Return the picture of the transmission error over a turn of the input, its mean in each part of the turn.

    Torque, direction and orders of the output are taken out, as far as the record determines them.
    """
    angle = np.mod(found.curves["input_angle"], 2.0 * np.pi)
    measured = sum(_waves(found, found.curves["input_angle"]), found.curves["residual"])
    place = (angle / (2.0 * np.pi) * TURN_BINS).astype(int) % TURN_BINS
    filled = np.unique(place)
    middle = (filled + 0.5) * 2.0 * np.pi / TURN_BINS
    means = np.array([measured[place == each].mean() for each in filled])
    columns = {
        "input_angle": middle,
        "transmission_error": means,
        "modelled": sum(_waves(found, middle), np.zeros_like(middle)),
    }
    orders = tuple((each.order, each.amplitude, each.amplitude_sigma) for each in found.orders if each.shaft == "input")
    title = "transmission error over a turn of the input"
    return Picture(Recording(columns, dict.fromkeys(columns, "rad")), "turn", "transmission error", title, "", orders)


def _waves(found: TransmissionError, angle: Array) -> list[Array]:
    """Return the significant orders of the input at an angle of it."""
    own = [each for each in found.orders if each.significant and each.shaft == "input"]
    return [each.amplitude * np.sin(each.order * angle + each.phase) for each in own]
