"""Claims of the actuator paper, each in its words, with the answer of the study."""

from __future__ import annotations

from math import degrees, hypot
from typing import NamedTuple

import misalignment as study
import numpy as np
import strainwave as sw
from misalignment import INPUT, OUTPUT, MisalignmentStudy, Recovery
from strainwave.typeset import ARCMIN_PER_RADIAN, fixed, number, quantity, uncertain

CONFIRMED, IN_PART, CORRECTED = "confirmed", "confirmed in part", "corrected"
E1_LEVEL = 1  # index into the sweep of e_1: 20 um


class Claim(NamedTuple):
    """A claim of the paper, the verdict, and the reason."""

    words: str
    verdict: str
    answer: str


def claims(found: MisalignmentStudy) -> list[Claim]:
    """All claims, in the order in which the paper makes them."""
    return [
        _detected(found),
        _radial(found),
        _constant(found),
        _inputs(found),
        _figure_3a(found),
        _steady(found),
        _flap(found),
        _noisy(found),
        _figure_3b(found),
        _level(found),
        _eccentricity(found),
        _greater(found),
    ]


def arcmin(angle: float, digits: int = 2) -> str:
    """An angle [rad] in minutes of arc."""
    return f"{number(ARCMIN_PER_RADIAN * angle, digits)}′"


def microns(length: float, digits: int = 3) -> str:
    """A length [m] in micrometres."""
    return f"{number(length / study.M_PER_MICRON, digits)} µm"


def percent(share: float, digits: int = 2) -> str:
    """A share in per cent."""
    return f"{number(100.0 * share, digits)} %"


def recovery_of(found: MisalignmentStudy, column: str, combine: str) -> Recovery:
    """Return the recovery from a column, with a `combine`."""
    return next(each for each in found.recoveries if each.column == column and each.law.combine == combine)


def share_at(found: MisalignmentStudy, loop: str, order: float = 2.0) -> float:
    """The share of the error at an order that the output has, with the drive's own gain and the time of the study."""
    table = found.passing[loop].table
    chosen = (
        (table["order"] == order)
        & np.isclose(table["position_gain"], found.ramp.gain)
        & np.isclose(table["duration"], found.ramp.duration)
    )
    return float(table["share"][chosen][0])


def slowest_and_tightest(found: MisalignmentStudy, loop: str) -> float:
    """The share of order 2 that the output has in the slowest ramp with the largest gain."""
    table = found.passing[loop].table
    chosen = (
        (table["order"] == 2.0)
        & (table["position_gain"] == table["position_gain"].max())
        & (table["duration"] == table["duration"].max())
    )
    return float(table["share"][chosen][0])


def frequency(found: MisalignmentStudy, order: float = 2.0) -> float:
    """Return the frequency of an order in the study [Hz]."""
    return order * found.ramp.turning / (2.0 * np.pi)


def ripple(spectrum: sw.Recording) -> float:
    """Root mean square of what is faster than the load over the stroke, of a spectrum through a Hann window."""
    counted = spectrum["order"] > study.MIN_ORDER
    return float(np.sqrt(np.sum(spectrum["amplitude"][counted] ** 2) / 3.0))


def speed_swing(found: MisalignmentStudy) -> float:
    """Half of the swing of the output speed with the shown tilt, over its mean."""
    speed = found.ramp.settled(found.shown[OUTPUT][study.SHOWN_TILT])["output_speed"]
    return sw.diagnose.swing(speed) / abs(float(speed.mean()))


def same_size(found: MisalignmentStudy, column: str) -> float:
    """The effect of a tilt over that of an eccentricity of the same size of m."""
    levels = found.levels[study.USUAL, OUTPUT]
    sizes = levels.column("e1", "housing_eccentricity")
    tilted = float(found.law.offset) * np.tan(levels.column("beta", "housing_tilt_x")[E1_LEVEL])
    there = np.exp(np.interp(np.log(tilted), np.log(sizes), np.log(levels.column("e1", column))))
    return float(levels.column("beta", column)[E1_LEVEL] / there)


def largest_ratio(found: MisalignmentStudy) -> float:
    """Return the largest change of the torque by the shown tilt, over the torque at that moment [1]."""
    runs = [found.ramp.settled(found.shown[OUTPUT][tilt])["torque"] for tilt in (0.0, study.SHOWN_TILT)]
    return float(np.max(np.abs(runs[1] - runs[0]) / np.maximum(np.abs(runs[0]), 1e-3 * np.abs(runs[0]).max())))


def silence(found: MisalignmentStudy, column: str = "current_swing") -> float:
    """The largest effect of what stands on the shaft alone, over that of as large a misalignment of the housing."""
    levels = found.levels[study.USUAL, OUTPUT]
    pairs = zip(study.SILENT, ("e1", "beta"), strict=True)
    return max(float(np.max(levels.column(quiet, column) / levels.column(loud, column))) for quiet, loud in pairs)


# ---- The claims ------------------------------------------------------------------------------------------------------


def _detected(found: MisalignmentStudy) -> Claim:
    recovery = recovery_of(found, "current", study.USUAL)
    best = recovery.best
    return Claim(
        "“its presence can be detected and quantified in strain wave gears”",
        IN_PART,
        "One vector can: from the motor current of one ramp |m| = "
        f"{uncertain(best.size / study.M_PER_MICRON, best.half_widths[0] / study.M_PER_MICRON)} µm (95 %), where "
        f"{number(hypot(*recovery.m) / study.M_PER_MICRON, 4)} µm were put in. m is e₁ plus the tilt β times the offset h: the "
        "two cannot be separated. e₂ and α alone leave no trace.",
    )


def _radial(found: MisalignmentStudy) -> Claim:
    printed = study.USUAL_E1 / float(found.law.pitch_radius)
    return Claim(
        "“e_WG,mis = θ_e,mis r_g ≅ θ_e r_g”",
        CORRECTED,
        f"The displacement acts through the flank and against the output: θ_e = −tan α_t e/r_g. "
        f"{microns(study.USUAL_E1)} are {arcmin(-study.USUAL_E1 * found.per_error(), 3)}, not {arcmin(printed, 3)}.",
    )


def _constant(found: MisalignmentStudy) -> Claim:
    constant = float(np.mean(found.law.replace(generator_eccentricity=study.USUAL_E1, combine="max").error(np.zeros(1))))
    return Claim(
        "“a constant component, related to clearance, and a variable one, related to misalignment and tooth machining error”",
        IN_PART,
        f"Misalignment has a constant part, too: e₂ = {microns(study.USUAL_E1)} alone shifts the output by "
        f"{arcmin(abs(constant))} for good, and nothing that repeats. The setting of zero takes it away. "
        "That of a clearance is constant only while the torque keeps its sign.",
    )


def _inputs(found: MisalignmentStudy) -> Claim:
    return Claim(
        "“The input parameters of the kinematic error model are the eccentricity (e₁ and e₂) and the angular deviations (β "
        "and α)”",
        CORRECTED,
        "h is missing: without an offset from the centre of tilt, β acts in second order only. e₂ and α turn with the "
        "shaft, so that alone they leave a constant, and no ripple. Of the ripple of the current that e₁ or β of the "
        f"same size makes, at most {percent(silence(found), 1)} is seen; the start of the ramp makes it.",
    )


def _figure_3a(found: MisalignmentStudy) -> Claim:
    pure = found.pure
    best = pure.fits[pure.best]
    curve = "the measured curve" if pure.source else "an assumed curve, as no measured one was given,"
    return Claim(
        "“proper modelling of the other kinematic error sources, such as clearance and tooth machining error, is necessary”",
        CONFIRMED if pure.source else IN_PART,
        f"Fitted to {curve} misalignment explains {percent(best.explained)} of its variance with |m| = {microns(best.size)}. "
        f"{arcmin(best.rms)} rms are left, which clearance and tooth errors would have to explain.",
    )


def _steady(found: MisalignmentStudy) -> Claim:
    straight, tilted = (ripple(each) for each in found.spectra["torque"])
    return Claim(
        "“the speed of the actuator is constant, and the torque oscillations are primarily linked to the control logic”",
        IN_PART if tilted > straight else CONFIRMED,
        f"It holds without misalignment: the torque oscillates by {number(straight, 2)} N·m rms. With a tilt of "
        f"{number(degrees(study.SHOWN_TILT), 2)}° it oscillates by {number(tilted, 2)} N·m, and the output speed swings "
        f"by ±{percent(speed_swing(found))}.",
    )


def _flap(found: MisalignmentStudy) -> Claim:
    moved = [float(found.levels[study.USUAL, side].column("e1", "output_swing")[E1_LEVEL]) for side in (OUTPUT, INPUT)]
    gain = found.ramp.gain
    ideal = percent(float(study.share_by_ideal_loop(frequency(found), gain)))
    best = [slowest_and_tightest(found, side) for side in (OUTPUT, INPUT)]
    return Claim(
        "“Because the position control loop operates to minimize the relative error the effect of the kinematic error on the "
        "flap surface angular position is negligible”",
        IN_PART,
        f"It is small: ±{arcmin(moved[0])} of {number(degrees(found.ramp.stroke), 3)}° at e₁ = {microns(study.USUAL_E1)}. The "
        f"loop has a small part in that: on the motor encoder it is ±{arcmin(moved[1])}. Order 2 comes at "
        f"{number(frequency(found), 3)} Hz, the loop reaches {number(gain / (2.0 * np.pi), 2)} Hz, and by itself would let "
        f"{ideal} pass. On average over the ramp {percent(share_at(found, OUTPUT))} pass, {percent(share_at(found, INPUT))} "
        "with the loop on the motor encoder: inertias, friction, the spring and the reaction of the error on the motor "
        "decide. Where the loop is faster than the error the claim holds for the output sensor alone: in twice the "
        f"time and with four times the gain {percent(best[0])} pass, with the loop on the motor encoder {percent(best[1])}.",
    )


def _noisy(found: MisalignmentStudy) -> Claim:
    share = study.share_of_whole_orders(found.ramp, found.shown[OUTPUT], "torque")
    return Claim(
        "“the presence of the kinematic error caused a noisy signal with several oscillations”",
        IN_PART,
        f"Oscillations yes, noise no: {percent(share, 4)} of the power of the difference lies at whole orders of the wave "
        "generator, the same in each turn but for the load. Over time it looks irregular, over the input angle it does not.",
    )


def _figure_3b(found: MisalignmentStudy) -> Claim:
    levels = found.levels[study.USUAL, OUTPUT]
    torque, error = (float(levels.column("beta", name)[E1_LEVEL]) for name in ("torque_swing", "error_swing"))
    return Claim(
        "Figure 3.b: “the differences between the nominal torque and the one in the presence only of angular deviations” in "
        "the text, “angular deviation misalignment kinematic error” in the caption",
        CORRECTED,
        f"The two are not the same quantity, so both are drawn. With a tilt of {number(degrees(study.SHOWN_TILT), 2)}° "
        f"the error swings by ±{arcmin(error)}, the torque by ±{quantity(torque, 'N.m', 2)}.",
    )


def _level(found: MisalignmentStudy) -> Claim:
    def power(combine: str) -> str:
        return fixed(study.power_of_level(found.levels[combine, OUTPUT], "e1", "torque_swing"), 2)

    return Claim(
        "“As predictable, the effect of the kinematic error increases together with the misalignment level”",
        IN_PART,
        f"In proportion where one lobe carries (the swing of the torque is as the level to the power of "
        f"{power('single')}) or the outer one ({power('max')}); with its square where both share ({power('mean')}). "
        "A tilt with h = 0 has no effect in first order; e₂ and α alone have none.",
    )


def _eccentricity(found: MisalignmentStudy) -> Claim:
    return Claim(
        "“A similar effect can be found in presence of misalignments”",
        CONFIRMED,
        "More than similar: a tilt β and an eccentricity of h tan β swing the torque alike, to a ratio of "
        f"{number(same_size(found, 'torque_swing'), 3)}.",
    )


def _greater(found: MisalignmentStudy) -> Claim:
    levels = found.levels[study.USUAL, OUTPUT]
    sizes = levels.column("e1", "housing_eccentricity")
    torque, current = (levels.column("e1", name) for name in ("torque_peak", "current_peak"))
    half = found.passing[OUTPUT].table
    fast = (half["duration"] == half["duration"].min()) & np.isclose(half["position_gain"], found.ramp.gain)
    quick = float(half["torque_swing"][fast][0] / levels.column("e1", "torque_swing")[E1_LEVEL])
    return Claim(
        "“oscillating torques which are instantaneously significantly greater than the nominal ones”",
        IN_PART,
        f"A does not state its misalignment. Here the peak is {percent(torque[E1_LEVEL] - 1.0)} above the nominal one "
        f"in torque and {percent(current[E1_LEVEL] - 1.0)} in current at e₁ = {microns(sizes[E1_LEVEL])}, "
        f"{percent(torque[-1] - 1.0)} and {percent(current[-1] - 1.0)} at {microns(sizes[-1])}. At a single moment the torque "
        f"is up to {percent(largest_ratio(found))} off with a tilt of {number(degrees(study.SHOWN_TILT), 2)}°. In half the "
        f"time the swing is {number(quick, 2)} times as large.",
    )
