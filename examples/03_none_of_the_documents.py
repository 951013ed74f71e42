"""A drive that no document describes, in under twenty lines besides imports: two frictions, a load and a controller of its own.

The wave generator has the friction of bristles, the teeth lose in proportion to their load. The load is a toggle clamp: a
torque measured over the angle. The controller is a function of Python, called every millisecond, that contains the torque
table of the clamp. Look at the current: it rises and falls with the torque of the clamp at once, before an error of the angle
builds up.
"""

import numpy as np
import strainwave as sw

bristles = sw.friction.LuGre(
    coulomb=0.04, breakaway=0.06, stribeck_speed=5.0, bristle_stiffness=60.0, bristle_damping=1e-4, viscous=2e-4
)
teeth = sw.friction.LoadDependent(driving_forward=0.2, driving_reverse=0.2, backdriving_forward=0.25, backdriving_reverse=0.25)
gear = sw.load("csg-20-100").replace(friction_input=bristles, friction_mesh=teeth)
clamp = sw.loads.TorqueTable(inertia=0.3, angle=[0.0, 0.4, 0.7, 0.9, 1.2], held_torque=[0.0, 5.0, 30.0, -8.0, 0.0])
drive = sw.Drive(gear=gear, motor=sw.motor.CurrentSource(torque_constant=0.06, inertia=2e-5), load=clamp)
ratio, reach = gear.kinematics.ratio, gear.kinematics.ratio * 0.06  # N.m at the output per A


def controller(seen: sw.simulation.Observation) -> float:
    error = ratio * seen.command - seen.input_angle
    error_rate = ratio * seen.command_rate - seen.input_speed
    known = np.interp(seen.output_angle, clamp.angle, clamp.held_torque) / reach
    return float(np.clip(known + 2.0 * error + 0.06 * error_rate, -12.0, 12.0))


command = sw.scenario.table([0.0, 0.2, 1.7, 2.0], [0.0, 0.0, 1.2, 1.2])
run = sw.simulate_controlled(drive, controller, command, sample=1e-3, period=1e-3, delay=2e-4)
print(f"largest error {np.abs(run['command'] - run['output_angle']).max() * 1e3:.1f} mrad")
print(f"largest current {np.abs(run['current']).max():.2f} A")
run.plot(["command", "output_angle", "load_torque", "torque", "current"]).savefig("none_of_the_documents.png", dpi=120)
