"""The torsion test rig: images of two markers and masses on pans in, the loop of a gear, its stiffness and lost motion out."""

from strainwave.rig.loop import Loop
from strainwave.rig.rig_file import load, rigs, write_rig
from strainwave.rig.setup import Camera, Masses, Rig, Value
from strainwave.rig.steps import Step
from strainwave.rig.steps_file import append_step, read_steps, write_steps
from strainwave.rig.virtual.loading import Loading, load_by_steps
from strainwave.rig.virtual.render import Scene, render
from strainwave.rig.virtual.test import VirtualTest, simulate_test

__all__ = [
    "Camera",
    "Loading",
    "Loop",
    "Masses",
    "Rig",
    "Scene",
    "Step",
    "Value",
    "VirtualTest",
    "append_step",
    "load",
    "load_by_steps",
    "read_steps",
    "render",
    "rigs",
    "simulate_test",
    "write_rig",
    "write_steps",
]
