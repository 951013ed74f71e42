"""The torsion test rig: images of two markers and masses on pans in, the loop of a gear, its stiffness and lost motion out."""

from strainwave.rig.loop import Loop
from strainwave.rig.rig_file import load, rigs, write_rig
from strainwave.rig.setup import Camera, Masses, Rig, Value
from strainwave.rig.steps import Step
from strainwave.rig.steps_file import append_step, read_steps, write_steps

__all__ = [
    "Camera",
    "Loop",
    "Masses",
    "Rig",
    "Step",
    "Value",
    "append_step",
    "load",
    "read_steps",
    "rigs",
    "write_rig",
    "write_steps",
]
