"""A gear with the laws of a table of its mesh: what the tables determine is replaced, the rest is kept."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from strainwave import Gear, stiffness, structure, typeset, variation
from strainwave.analysis.torsion_loop import series_compliance
from strainwave.files.described import all_paths
from strainwave.files.entries import Entry
from strainwave.files.gear_set import GearSet
from strainwave.files.mesh_table import ModeTable
from strainwave.messages import shortened
from strainwave.orders.mesh.error import StiffnessVariation

if TYPE_CHECKING:
    from strainwave.orders.mesh.laws import MeshLaws

MIN_EXPLAINED_SHARE = 0.5  # of the squares of the varying transmission error, by laws that a gear may have


def applied(laws: MeshLaws, before: GearSet, stages: Any, modes: ModeTable | None) -> GearSet:
    """Return a set with laws of a table, stages and modes; see `MeshLaws.applied_to`."""
    if laws.orders and laws.explained_share < MIN_EXPLAINED_SHARE:
        share = typeset.percent(laws.explained_share)
        raise ValueError(
            f"the laws explain {share} of the transmission error of {laws.source} alone; choose one load by load=, or compare "
            "the loads with each other"
        )
    return _Application(laws, before, stages, modes).gear_set()


@dataclass(frozen=True)
class _Application:
    """Laws, the set that they are put into, stages for it, and modes of its ring."""

    laws: MeshLaws
    before: GearSet
    stages: Any
    modes: ModeTable | None

    def gear_set(self) -> GearSet:
        """Return the set with the laws."""
        stages, notes = self._stages()
        changes: dict[str, Any] = {} if stages is None else {"structure": stages}
        if self.laws.kinematic_error is not None:
            changes["kinematic_error"] = self.laws.kinematic_error
        changes |= self._spring(stages)
        gear = self.before.gear.replace(**changes)
        sources = self._sources(gear, changes)
        kept = {
            path: sources[path]
            for path in self.before.sources.keys() & sources.keys()
            if sources[path] == self.before.sources[path]
        }
        covariance = None if self.before.covariance is None else self.before.covariance.among(kept)
        others = {path: entry for path, entry in self.before.sources.items() if not path.startswith("gear.")}
        others_of_set = (
            f"Numbers that {self.laws.source} does not determine, as friction and hysteresis, are those of {self.before.name}."
        )
        note = " ".join(filter(None, [self.before.note, others_of_set, *notes]))
        return self.before.replace(gear=gear, sources=sources | others, covariance=covariance, note=note)

    def _stages(self) -> tuple[Any, list[str]]:
        """Return the stages with what the tables determine, and remarks on modes joined or left out."""
        old = self.before.gear.structure
        stages = self.stages if self.stages is not None else old if isinstance(old, structure.Staged) else None
        if stages is not None and not isinstance(stages, structure.Staged):
            raise TypeError(f"stages must be a sw.structure.Staged, not {shortened(stages)}")
        if stages is None:
            needed = "mesh_stiffness needs" if self.laws.mesh_stiffness is not None else "modes need" if self.modes else ""
            if needed:
                raise ValueError(
                    f"{self.before.name}: {needed} a gear of stages, and it has none; give stages=sw.structure.Staged(...), or "
                    "leave that table out"
                )
            return None, []
        if self.laws.mesh_stiffness is not None:
            varying = self.laws.mesh_variation or variation.Constant()
            stages = stages.replace(mesh_stiffness=self.laws.mesh_stiffness, mesh_variation=varying)
        if self.modes is None:
            return stages, []
        return stages.replace(ring=self.modes.ring), self.modes.remarks

    def _spring(self, stages: Any) -> dict[str, Any]:
        """Return the spring and its variation, which with the stages in series have the whole compliance."""
        gear = self.before.gear
        law, varying = self.laws.stiffness, self.laws.stiffness_variation
        in_series = 0.0 if stages is None else series_compliance(gear.replace(structure=stages))
        before = series_compliance(gear)
        if law is None and in_series == before:
            return {} if varying is None else {"stiffness_variation": varying}
        whole, old = (law, 0.0) if law is not None else (gear.stiffness, before)
        spring = _softened(whole, in_series - old, self.before.name)
        changes: dict[str, Any] = {"stiffness": spring}
        if law is not None or varying is not None:
            changes["stiffness_variation"] = self._variation_of_spring(spring, in_series, stages) or variation.Constant()
        return changes

    def _variation_of_spring(self, spring: Any, in_series: float, stages: Any) -> Any:
        """Return the variation of the spring so that with that of the mesh in series it is that of the table."""
        varying = self.laws.stiffness_variation
        if varying is None or in_series == 0.0:
            return varying
        own = 1.0 / float(spring.tangent(0.0))
        waves = _waves(varying, (own + in_series) / own)
        if self.laws.mesh_variation is not None:
            lever = stages.pitch_radius * float(np.cos(stages.pressure_angle))
            of_mesh = 1.0 / (stages.mesh_stiffness * lever**2)
            for order, wave in _waves(self.laws.mesh_variation, of_mesh / own).items():
                waves[order] = waves.get(order, 0.0) - wave
        orders = np.array(sorted(waves))
        rest = StiffnessVariation.of_waves(
            "the stiffness less the stages", orders, np.array([waves[each] for each in orders.tolist()])
        )
        return rest.law

    def _sources(self, gear: Gear, changes: Mapping[str, Any]) -> dict[str, Entry]:
        """Return the entry of each number of the gear."""
        entries = {}
        computed = Entry(f"computed: finite-element table {self.laws.source}")
        of_modes = Entry(f"computed: finite-element table {self.modes.source}") if self.modes is not None else computed
        rest = Entry(f"{computed.source}; what the stages leave of the whole compliance")
        for path in all_paths("gear", gear):
            part = path.split(".")[1].split("[")[0]
            if part == "structure":
                entries[path] = self._source_in_stages(path, computed, of_modes)
            elif part in changes:
                entries[path] = rest if part.startswith("stiffness") and self.laws.stiffness is None else computed
            else:
                entries[path] = self.before.sources[path]
        return entries

    def _source_in_stages(self, path: str, computed: Entry, of_modes: Entry) -> Entry:
        name = path.split(".", 2)[2]
        if name.startswith("ring.") and self.modes is not None:
            return of_modes
        if name.startswith(("mesh_stiffness", "mesh_variation")) and self.laws.mesh_stiffness is not None:
            return computed
        given = Entry(f"assumed: given with the finite-element table {self.laws.source}")
        return given if self.stages is not None else self.before.sources.get(path, given)


def _waves(law: Any, factor: float) -> dict[float, complex]:
    """Return the complex amplitudes of a variation by their orders, times a factor."""
    amplitudes = zip(law.order, law.amplitude, law.phase, strict=True)
    return {order: factor * amplitude * complex(np.exp(1j * phase)) for order, amplitude, phase in amplitudes}


def _softened(law: Any, compliance: float, name: str) -> Any:
    """Return a spring without a compliance in series with it [rad/(N.m)]."""
    slopes = [each["name"] for each in law.fields if each["unit"] == "N.m/rad"]
    if not isinstance(law, stiffness.Linear | stiffness.ThreeSegment):
        raise ValueError(
            f"{name}: from a spring {type(law).__name__} the compliance of the stages cannot be taken; give the gear a Linear "
            "or ThreeSegment, or a table with the transmission error at several loads"
        )
    least = max(getattr(law, each) for each in slopes)
    if not 1.0 / least > compliance:
        whole = f"more than the {1.0 / least:.3g} rad/(N.m) of the whole gear where it is stiffest"
        raise ValueError(
            f"{name}: the stages alone have a compliance of {compliance:.3g} rad/(N.m), {whole}; give stiffer stages"
        )
    return law.replace(**{each: 1.0 / (1.0 / getattr(law, each) - compliance) for each in slopes})
