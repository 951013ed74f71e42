"""Friction at rest, before a shaft slides: the columns of presliding loops and ramps of torque, and their input."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence

import numpy as np

from strainwave import friction
from strainwave.analysis.branches import turning_points
from strainwave.files.recording import Recording
from strainwave.identification.checks.sizes import MIN_RATIO
from strainwave.identification.fitting.unknowns import Estimate
from strainwave.identification.kinds.kind import Kind
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.names import Quantity
from strainwave.identification.reading.recognise import Recognised
from strainwave.identification.reading.roles import Column, ColumnRoles, first, measured, needed, needed_effort
from strainwave.identification.results.file_result import BREAKAWAY_PATH, COULOMB_PATH, FileEstimate
from strainwave.identification.results.gear_so_far import GearSoFar, with_torque
from strainwave.parameters import plain

SLIDING_LAWS = (friction.Coulomb, friction.Stribeck)  # laws whose numbers a law with bristles has, too
BRISTLE_LAWS = (friction.LuGre, friction.MaxwellSlipFriction)
WITH_BREAKAWAY = (*SLIDING_LAWS, friction.LuGre)  # laws with a torque of breakaway
MAX_PRESLIDING = 0.05  # rad of the input: what moves to and fro by less has not slid far, and hardly twists the gear


class AtRest(Kind):
    """The common base of both kinds: one angle and a torque or current."""

    def roles(self, columns: Sequence[Column], mapping: FileMapping) -> ColumnRoles:
        angle, (effort, force) = needed(columns, "angle", self.title), needed_effort(columns, self.title)
        side = mapping.side or ("output" if angle.at_joint else "input")
        time = {} if self.time == "none" else first(columns, "time")
        why = f"{self.motion(angle, force)}: {self.title}"
        return ColumnRoles(self.name, {"angle": angle, effort: force, **time}, side, (why,))

    @abstractmethod
    def motion(self, angle: Column, force: Column) -> str:
        """Return in words how the shaft moves."""


def goes_to_and_fro(columns: Sequence[Column], mapping: FileMapping) -> bool:
    """True if one angle of an input moves to and fro by little, and the file contains a torque or current."""
    if (pair := angle_and_effort(columns, mapping)) is None:
        return False
    angle, _ = pair
    is_geared = mapping.constants.get("ratio", np.inf) >= MIN_RATIO  # without a gear, motion of the output twists none
    at_output = is_geared and (angle.at_joint or mapping.side == "output")
    is_known = mapping.side is not None or angle.channel.side is not None or not is_geared
    return is_known and not at_output and bool(np.ptp(angle.si) <= MAX_PRESLIDING) and len(turning_points(angle.si)) >= 2


def angle_and_effort(columns: Sequence[Column], mapping: FileMapping) -> tuple[Column, Column] | None:
    """Return the angle and the torque or current of a record at rest; None if it has not one of both, or is a torsion loop."""
    is_twisted = measured(columns, "twist") and measured(columns, "torque")
    if is_twisted and "rate" not in mapping.constants and not measured(columns, "time"):
        return None
    angle, effort = _one(columns, "angle"), _one(columns, "torque") or _one(columns, "current")
    return None if angle is None or effort is None else (angle, effort)


def _one(columns: Sequence[Column], quantity: Quantity) -> Column | None:
    """Return the column of a quantity, of the input if there are several; None if it is not one."""
    candidates = measured(columns, quantity)
    own = [column for column in candidates if column.channel.side == "input"] or candidates
    return own[0] if len(own) == 1 else None


# ---- What both fits share --------------------------------------------------------------------------------------------


def estimate_of(each: Estimate, path: str, law: str, uncertain: float, why: str) -> FileEstimate:
    """Return an estimate of a file, which rests on a torque constant.

    Args:
        each: of the fit
        path: of the parameter
        law: that it belongs to
        uncertain: standard deviation of the torque constant over its value [1]
        why: the reason why the file does not determine it; empty if it does
    """
    estimate = FileEstimate(path, each.unit, each.value, each.sigma, law, why)
    return estimate.sharing(uncertain * abs(each.value)).unless_uncertain()


def with_breakaway(known: GearSoFar, estimate: FileEstimate, name: str) -> tuple[GearSoFar, tuple[str, ...]]:
    """Return the gear with a breakaway torque, unless a file determines it already, and a remark if its law allows none so low.

    Args:
        known: the gear before
        estimate: of the file
        name: of the file
    """
    law = known.sliding()
    is_known = any(plain(path) == BREAKAWAY_PATH for path in known.determined_by)
    if not isinstance(law, WITH_BREAKAWAY) or is_known or estimate.why:
        return known, ()
    if estimate.value >= law.coulomb:
        return known.with_sliding(law.replace(breakaway=estimate.value), {"breakaway": estimate.sigma}, name), ()
    below = f"it lies below the Coulomb torque of the gear, {law.coulomb:.3g} N·m"
    if any(plain(path) == COULOMB_PATH for path in known.determined_by):
        return known, (f"{below}, which keeps its breakaway torque",)
    lower = law.replace(coulomb=estimate.value, breakaway=estimate.value)
    return known.with_sliding(lower, {"breakaway": estimate.sigma}, name), (
        f"{below}, which no file determines: both have its value",
    )


def at_input(file: Recognised, known: GearSoFar) -> tuple[Recording, float]:
    """Return angle and torque of the input; what was measured at the output is referred to it by the ratio."""
    recording, uncertain = with_torque(file, known.gear_set)
    if file.side != "output":
        return recording, uncertain
    ratio = abs(known.gear_set.gear.kinematics.ratio)
    turned = recording.with_column("angle", ratio * recording["angle"], "rad")
    return turned.with_column("torque", recording["torque"] / ratio, "N.m"), uncertain
