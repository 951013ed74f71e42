"""A model of a joint along its motion, and the parts of friction that may be added to it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from strainwave import Drive, _core, friction
from strainwave.equality import ComparedByFields
from strainwave.identification.candidates.steady_shapes import QUADRANTS
from strainwave.identification.experiments.motion_log import MotionLog

LOSSES = tuple(f"gear.friction_mesh.{name}" for name in QUADRANTS)
INPUT = "gear.friction_input."
WITHIN = f"{INPUT}law."  # where friction stands that varies over the angle
SLOPE_STEP = 0.05  # relative change of a speed, by which a law of friction is differentiated
FOLLOWS = {f"{INPUT}breakaway": f"{INPUT}coulomb"}


@dataclass(frozen=True, eq=False)
class MotionModel(ComparedByFields):
    """A model of a joint to be fitted to a log.

    Attributes:
        name: of its friction, with what was added
        log: as it is compared
        drive: from which a fit starts
        free: paths of the numbers that are fitted
        ties: numbers that follow others, by path
        one_speed: size of the speed at which alone friction was measured [rad/s]; 0 if the record has several. Only the sum of
            Coulomb and viscous friction is determined then
        of_full_band: paths of free numbers that the pass band of the log does not contain
    """

    name: str
    log: MotionLog
    drive: Drive
    free: tuple[str, ...]
    ties: Mapping[str, str]
    one_speed: float = 0.0
    of_full_band: tuple[str, ...] = ()

    @property
    def law(self) -> Any:
        """The friction at the input as it slides, without what varies it over the angle."""
        return sliding(self.drive)

    @property
    def paths(self) -> list[str]:
        """Paths of all numbers of the drive."""
        return [path for path, *_ in _core.parameters(self.drive)]

    def path_of(self, name: str) -> str:
        """Return the path of a number of the friction at the input as it slides."""
        return f"{WITHIN if isinstance(self.drive.gear.friction_input, friction.Cyclic) else INPUT}{name}"

    def having(self, what: str, law: Any, *names: str) -> MotionModel:
        """Return the same with another law of friction at the input as it slides, and further numbers of it free."""
        drive, free = with_sliding(self.drive, law), map(self.path_of, names)
        return replace(self, name=f"{self.name}, {what}", drive=drive, free=(*self.free, *free))

    def varying_over_the_angle(self) -> MotionModel:
        """Return the same with friction at the input whose dry part may vary over the angle."""
        law: Any = self.drive.gear.friction_input
        if isinstance(law, friction.Cyclic):
            return self
        drive = self.drive.replace(gear=self.drive.gear.replace(friction_input=friction.Cyclic(law=law, viscous_share=0.0)))
        ties = {_within(path): _within(other) for path, other in self.ties.items()}
        return replace(self, drive=drive, free=tuple(map(_within, self.free)), ties=ties)


def sliding(drive: Drive) -> Any:
    """Return the friction at the input of a drive, without what varies it over the angle."""
    law: Any = drive.gear.friction_input
    return law.law if isinstance(law, friction.Cyclic) else law


def with_sliding(drive: Drive, law: Any) -> Drive:
    """Return the drive with another law of friction at the input as it slides, within what varies it over the angle."""
    outer: Any = drive.gear.friction_input
    whole = outer.replace(law=law) if isinstance(outer, friction.Cyclic) else law
    return drive.replace(gear=drive.gear.replace(friction_input=whole))


def slope_of(law: Any, speed: float) -> float:
    """Return the change of a law's friction with the speed [N.m.s/rad], at a speed [rad/s]."""
    return float(law.steady((1.0 + SLOPE_STEP) * speed) - law.steady((1.0 - SLOPE_STEP) * speed)) / (2.0 * SLOPE_STEP * speed)


def _within(path: str) -> str:
    """Return the path of a number of the friction at the input that now stands inside another law."""
    return path.replace(INPUT, WITHIN) if path.startswith(INPUT) else path


def without(free: Sequence[str], name: str) -> tuple[str, ...]:
    """Return the paths but those of numbers whose names begin so."""
    return tuple(path for path in free if not path.rpartition(".")[2].startswith(name))


def with_delay(model: MotionModel, start: float = 0.0) -> MotionModel | None:
    """Return the model with a delay of the effort behind the motion, from the initial value of a fit [s]."""
    if model.log.delayed:
        return None
    log = model.log.with_delay()
    before = {each.name: each.start for each in model.log.nuisances} | {"delay": start}
    return replace(
        model, name=f"{model.name}, a delay", log=log.starting([before.get(each.name, 0.0) for each in log.nuisances])
    )


def with_curved_viscous_part(model: MotionModel) -> MotionModel | None:
    """Return the model with a viscous torque that is not linear in the speed."""
    law = model.law
    if not isinstance(law, friction.Coulomb) or model.one_speed:
        return None
    fastest = float(np.abs(model.log.motion.speed).max())
    curved = friction.CurvedViscous(
        coulomb=law.coulomb, breakaway=law.coulomb, viscous_torque=max(law.viscous * fastest, 1e-3 * law.coulomb, 1e-12),
        exponent=0.9, reference_speed=fastest,
    )  # fmt: skip
    return replace(model, free=without(model.free, "viscous")).having(
        "a curved viscous part", curved, "viscous_torque", "exponent"
    )


def with_higher_friction_at_low_speed(model: MotionModel) -> MotionModel | None:
    """Return the model with friction that falls with the speed at first; the fit may make it rise."""
    return _with_another_friction_at_low_speed(model, 1.3)


def with_lower_friction_at_low_speed(model: MotionModel) -> MotionModel | None:
    """Return the model with friction that rises with the speed at first; the fit may make it fall."""
    return _with_another_friction_at_low_speed(model, 0.7)


def _with_another_friction_at_low_speed(model: MotionModel, share: float) -> MotionModel | None:
    """Return the model with a Stribeck torque whose fit starts with a share of Coulomb's torque at rest [1]."""
    law = model.law
    if not isinstance(law, friction.Coulomb) or model.one_speed:
        return None
    falling = friction.Stribeck(coulomb=law.coulomb, breakaway=share * law.coulomb, stribeck_speed=3.0, viscous=law.viscous)
    ties = {path: other for path, other in model.ties.items() if path != model.path_of("breakaway")}
    return replace(model, ties=ties).having("another friction at low speed", falling, "breakaway", "stribeck_speed")


def with_loss_under_load(model: MotionModel) -> MotionModel | None:
    """Return the model with a loss under load, equal in all quadrants: four are not separable from inertia and gravity."""
    if LOSSES[0] in model.free:
        return None
    lossy = friction.LoadDependent(**dict.fromkeys(QUADRANTS, 0.02))
    return replace(
        model,
        name=f"{model.name}, a loss under load",
        drive=model.drive.replace(gear=model.drive.gear.replace(friction_mesh=lossy)),
        free=(*model.free, LOSSES[0]),
        ties={**model.ties, **dict.fromkeys(LOSSES[1:], LOSSES[0])},
    )


def bristled(drive: Drive, bend: float) -> Drive:
    """Return the drive with bristles that bend at reversals, where its friction at the input has a law with bristles.

    Args:
        drive: with friction that slides, of Coulomb or Stribeck
        bend: angle of the input in which they bend [rad]
    """
    law = sliding(drive)
    if not isinstance(law, friction.Coulomb | friction.Stribeck) or min(law.coulomb, law.breakaway) <= 0.0:
        return drive
    speed = law.stribeck_speed if isinstance(law, friction.Stribeck) else 1.0
    bristle = friction.LuGre(
        coulomb=law.coulomb, breakaway=law.breakaway, stribeck_speed=speed,
        bristle_stiffness=law.coulomb / bend, bristle_damping=0.0, viscous=max(law.viscous, 0.0),
    )  # fmt: skip
    return with_sliding(drive, bristle)
