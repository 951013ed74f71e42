"""A gear by the table of an independent finite-element ring has the orders of that ring's own motion.

The ring shares no law and no function with the package. Its bearing has single balls, its table has none. The gear below has
one body, the inertia of the output.
"""

from __future__ import annotations

import numpy as np
import pytest
import strainwave as sw
from strainwave.files import MeshTable

from tests.evidence.flexible_ring.gear import Gear
from tests.evidence.flexible_ring.motion import move
from tests.evidence.flexible_ring.records import drawn_experiment
from tests.evidence.flexible_ring.tables import mesh_table

ANGLES_PER_TOOTH = 8
DAMPING_RATIO = 0.02  # of the output on the stiffness of the gear; the ring's own is 0.019


def table_at(ring: Gear, torque: float) -> MeshTable:
    """The table of a ring at one load: its error is output - input / ratio."""
    count = ANGLES_PER_TOOTH * ring.teeth
    found = mesh_table(ring, 2.0 * np.pi * np.arange(count) / count, np.array([torque]))
    columns = {name.split(" ")[0]: values for name, values in found.items()}
    return MeshTable(
        columns["wave_generator_angle"],
        columns["torque"],
        transmission_error=-columns["transmission_error"],
        stiffness=columns["stiffness"],
        source="mesh.csv",
    )


def gear_of(ring: Gear, laws: sw.orders.MeshLaws) -> sw.Gear:
    """A gear of this ring's teeth with the laws, and a damping of the output."""
    assert laws.stiffness is not None
    kinematics = sw.kinematics.StrainWave(flexspline_teeth=ring.teeth, circular_spline_teeth=ring.teeth + 2, fixed="flexspline")
    damping = 2.0 * DAMPING_RATIO * np.sqrt(laws.stiffness.k * ring.output_inertia)
    return laws.applied_to(sw.Gear(kinematics=kinematics, damping=damping)).gear


@pytest.mark.slow("orders")
def test_orders_of_lobes_and_teeth_over_the_speed_are_those_of_the_ring() -> None:
    experiment = drawn_experiment(4)
    ring, torque, orders = experiment.gear, experiment.torque, [2.0, 4.0, float(experiment.gear.teeth)]
    laws = sw.orders.mesh_laws(table_at(ring, torque))
    assert laws.explained_share > 0.9999
    drive = sw.Drive(
        gear=gear_of(ring, laws),
        motor=sw.motor.AccelerationSource(inertia=1e-4),
        load=sw.loads.Inertia(inertia=ring.output_inertia),
    )
    speeds = 2.0 * np.pi * np.array([8.0, 12.0])  # the teeth pass at 1.2 and 1.8 times the resonance of the output
    motion = move(ring, speeds, speeds, torque, revolutions=1.05)  # the splines have turned against each other after more
    units = {"input_angle": "rad", "transmission_error": "rad"}
    for place, speed in enumerate(speeds.tolist()):
        measured = sw.Recording({"input_angle": motion.angle, "transmission_error": -motion.error[:, place]}, units)
        command, start = sw.scenario.constant(0.0, 4.0 * 2.0 * np.pi / speed), {"input_speed": speed}
        run = sw.simulate(drive, command, dt=5e-6, sample=2e-5, load_torque=torque, initial=start)
        found, true = (sw.orders.order_amplitudes(each, "transmission_error", orders) for each in (run, measured))
        assert (np.abs(found.amplitude / true.amplitude - 1.0) < [0.02, 0.02, 0.1]).all()


def test_a_table_whose_error_has_the_other_sign_is_refused() -> None:
    ring = drawn_experiment(4).gear
    found = mesh_table(ring, np.radians(np.arange(0.0, 360.0, 30.0)), ring.rated_torque * np.array([0.0, 0.5, 1.0]))
    columns = {name.split(" ")[0]: values for name, values in found.items()}
    table = MeshTable(
        columns["wave_generator_angle"], columns["torque"], transmission_error=columns["transmission_error"], source="mesh.csv"
    )
    with pytest.raises(ValueError, match="change the sign of one of the two columns"):
        sw.orders.mesh_laws(table)
