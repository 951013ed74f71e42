"""A gear with the laws of a table of its mesh: what the tables determine is replaced, the rest is kept."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from strainwave import stiffness, structure, typeset, variation
from strainwave.analysis.torsion_loop import series_compliance
from strainwave.files.described import all_paths
from strainwave.files.entries import Entry
from strainwave.files.gear_set import GearSet
from strainwave.files.mesh_table import ModeTable
from strainwave.messages import shortened
from strainwave.orders.mesh.error import variation_of

if TYPE_CHECKING:
    from strainwave.orders.mesh.laws import MeshLaws

MIN_EXPLAINED_SHARE = 0.5  # of the squares of the varying transmission error, by laws that a gear may have
MAX_FACTOR = 10.0  # between the stiffness of a table and that of the gear before: gears of one size differ by a third


def applied(laws: MeshLaws, before: GearSet, stages: Any, modes: ModeTable | None) -> GearSet:
    """Return a set with laws of a table, stages and modes; see `MeshLaws.applied_to`."""
    if laws.orders and laws.explained_share < MIN_EXPLAINED_SHARE:
        share = typeset.percent(laws.explained_share)
        raise ValueError(
            f"the laws explain {share} of the transmission error of {laws.source} alone; choose one load by load=, or compare "
            "the loads with each other"
        )
    whole = _stages(laws, before, stages, modes)
    changes: dict[str, Any] = {} if whole is None else {"structure": whole}
    if laws.kinematic_error is not None:
        changes["kinematic_error"] = laws.kinematic_error
    changes |= _spring(laws, before, whole)
    gear = before.gear.replace(**changes)
    named = _sources(laws, changes, stages, modes)
    sources = {path: entry for path, entry in before.sources.items() if not path.startswith("gear.")}
    for path in all_paths("gear", gear):
        new = [entry for part, entry in named.items() if f"{path}.".startswith(f"{part}.")]
        sources[path] = new[-1] if new else before.sources[path]
    kept = [path for path, entry in sources.items() if path.startswith("gear.") and entry == before.sources.get(path)]
    covariance = None if before.covariance is None else before.covariance.among(kept)
    others = f"Numbers that {laws.source} does not determine, as friction and hysteresis, are those of {before.name}."
    note = " ".join(filter(None, [before.note, others, *([] if modes is None else modes.remarks)]))
    return before.replace(gear=gear, sources=sources, covariance=covariance, note=note)


def _stages(laws: MeshLaws, before: GearSet, stages: Any, modes: ModeTable | None) -> Any:
    """Return the stages with what the tables determine; None of a gear without."""
    if not isinstance(modes, ModeTable | None):
        raise TypeError(f"modes must be a ModeTable, as sw.files.ModeTable.read(...) gives one, not {shortened(modes)}")
    if stages is None and isinstance(before.gear.structure, structure.Staged):
        stages = before.gear.structure
    changes: dict[str, Any] = {} if modes is None else {"ring": modes.ring}
    if laws.mesh_stiffness is not None:
        varying = laws.mesh_variation or variation.Constant()
        changes |= {"mesh_stiffness": laws.mesh_stiffness, "mesh_variation": varying}
    if stages is None and changes:
        needing = "modes need" if laws.mesh_stiffness is None else "mesh_stiffness needs"
        remedy = "give stages=sw.structure.Staged(...), or leave that table out"
        raise ValueError(f"{before.name}: {needing} a gear of stages, and it has none; {remedy}")
    if not isinstance(stages, structure.Staged | None):
        raise TypeError(f"stages must be a sw.structure.Staged, not {shortened(stages)}")
    return None if stages is None else stages.replace(**changes)


def _spring(laws: MeshLaws, before: GearSet, stages: Any) -> dict[str, Any]:
    """Return the spring and its variation, which with the stages in series have the whole compliance."""
    gear, law, varying = before.gear, laws.stiffness, laws.stiffness_variation
    in_series = 0.0 if stages is None else series_compliance(gear.replace(structure=stages))
    old = series_compliance(gear)
    is_known = any(not of.assumed for path, of in before.sources.items() if path.startswith("gear.stiffness."))
    if law is not None and is_known:
        whole_before = 1.0 / (1.0 / float(gear.stiffness.tangent(0.0)) + old)
        _check_size(float(law.tangent(0.0)), whole_before, laws.source, before.name)
    if law is None and in_series == old:
        return {} if varying is None else {"stiffness_variation": varying}
    spring = _softened(gear.stiffness, in_series - old, before.name) if law is None else _softened(law, in_series, before.name)
    if law is None and varying is None:
        return {"stiffness": spring}
    if varying is not None and in_series > 0.0:  # so that with that of the mesh in series it is that of the table
        own, of_mesh = 1.0 / float(spring.tangent(0.0)), laws.mesh_variation
        lever = stages.pitch_radius * float(np.cos(stages.pressure_angle))
        orders = np.union1d(varying.order, () if of_mesh is None else of_mesh.order)
        waves = _waves(varying, orders) * (own + in_series) - _waves(of_mesh, orders) / (stages.mesh_stiffness * lever**2)
        varying, _ = variation_of("the stiffness less the stages", orders, waves / own)
    return {"stiffness": spring, "stiffness_variation": varying or variation.Constant()}


def _check_size(of_table: float, of_gear: float, source: str, name: str) -> None:
    """Raise a ValueError if the stiffness of a table is none of such a gear."""
    if not 1.0 / MAX_FACTOR < of_table / of_gear < MAX_FACTOR:
        raise ValueError(
            f"{source} gives a stiffness of {of_table:.3g} N.m/rad, {name} has {of_gear:.3g} N.m/rad: check the units of "
            "torque and transmission error, the side of the torque, and the name of the gear"
        )


def _sources(laws: MeshLaws, changes: dict[str, Any], stages: Any, modes: ModeTable | None) -> dict[str, Entry]:
    """Return the entries of parts of the gear, a part of a part after the whole."""
    computed = Entry(f"computed: finite-element table {laws.source}")
    entries = {f"gear.{part}": computed for part in changes if part != "structure"}
    if laws.stiffness is None:
        rest = Entry(f"{computed.source}; what the stages leave of the whole compliance")
        entries |= {path: rest for path in entries if path.startswith("gear.stiffness")}
    if stages is not None:
        entries["gear.structure"] = Entry(f"assumed: given with the finite-element table {laws.source}")
    if laws.mesh_stiffness is not None:
        entries |= dict.fromkeys(("gear.structure.mesh_stiffness", "gear.structure.mesh_variation"), computed)
    if modes is not None:
        entries["gear.structure.ring"] = Entry(f"computed: finite-element table {modes.source}")
    return entries


def _waves(law: Any, orders: NDArray[np.float64]) -> NDArray[np.complex128]:
    """Return the complex amplitudes of a variation at orders that contain its own ones."""
    waves = np.zeros(len(orders), complex)
    if law is not None:
        waves[np.searchsorted(orders, law.order)] = np.array(law.amplitude) * np.exp(1j * np.array(law.phase))
    return waves


def _softened(law: Any, compliance: float, name: str) -> Any:
    """Return a spring without a compliance in series with it [rad/(N.m)]."""
    if not isinstance(law, stiffness.Linear | stiffness.ThreeSegment):
        raise ValueError(
            f"{name}: from a spring {type(law).__name__} the compliance of the stages cannot be taken; give the gear a Linear "
            "or ThreeSegment, or a table with the transmission error at several loads"
        )
    slopes = {field["name"]: getattr(law, field["name"]) for field in law.fields if field["unit"] == "N.m/rad"}
    if not (least := 1.0 / max(slopes.values())) > compliance:
        whole = f"more than the {least:.3g} rad/(N.m) of the whole gear where it is stiffest"
        raise ValueError(
            f"{name}: the stages alone have a compliance of {compliance:.3g} rad/(N.m), {whole}; give stiffer stages"
        )
    return law.replace(**{slope: 1.0 / (1.0 / value - compliance) for slope, value in slopes.items()})
