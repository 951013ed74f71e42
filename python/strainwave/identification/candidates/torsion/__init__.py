"""Torsion loops: spring and hysteresis from torque over twist; kinds of both, tried and ranked."""

from strainwave.identification.candidates.torsion.candidate import TorsionCandidate, fit_loop
from strainwave.identification.candidates.torsion.dissipation import InputFriction, Nothing
from strainwave.identification.candidates.torsion.ranking import RankedCandidate, held_out_blocks, plain_error, rank_loop

__all__ = [
    "InputFriction",
    "Nothing",
    "RankedCandidate",
    "TorsionCandidate",
    "fit_loop",
    "held_out_blocks",
    "plain_error",
    "rank_loop",
]
