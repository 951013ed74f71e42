"""The channels of each kind of measurement: their names here, what they measure, and on which side."""

from __future__ import annotations

from typing import NamedTuple

from strainwave.identification.reading.names import UNITS, Quantity, Side


class Channel(NamedTuple):
    """A measured quantity of a shaft.

    Args:
        quantity: what is measured
        side: of which shaft; None if the kind of measurement or the other columns determine it
        commanded: True for a reference
        modelled: True for the output of a model
        reflected: True for a motion of the input that is counted at the output: divided by the ratio
        loading: True for the torque that loads a gear while its friction is measured
    """

    quantity: Quantity
    side: Side | None = None
    commanded: bool = False
    modelled: bool = False
    reflected: bool = False
    loading: bool = False

    @property
    def measured(self) -> bool:
        return not (self.commanded or self.modelled or self.loading)

    @property
    def unit(self) -> str:
        return UNITS[self.quantity]


# All channels by name. If a name contains no side, the kind of measurement or the other columns determine it.
CHANNELS: dict[str, Channel] = {
    "time": Channel("time"),
    "command": Channel("angle", commanded=True),
    "voltage": Channel("voltage"),
    "current": Channel("current"),
    "input_torque": Channel("torque", "input"),  # of the motor, at its shaft
    "joint_torque": Channel("torque", "output"),  # of the motor, counted at the output; or of a sensor there
    "rigid_torque": Channel("torque", "output", modelled=True),  # of gravity and of arms that move together, as a model has it
    "input_angle": Channel("angle", "input"),
    "input_speed": Channel("speed", "input"),
    "reflected_angle": Channel("angle", "input", reflected=True),  # of the motor, divided by the ratio, as robots export it
    "reflected_speed": Channel("speed", "input", reflected=True),
    "output_angle": Channel("angle", "output"),
    "output_speed": Channel("speed", "output"),
    "other_angles": Channel("angle", "output"),  # of joints that move too, as numbers or names of columns with commas
    "regressors": Channel("torque", "output", modelled=True),  # of a model of the arm, each per one of its parameters, as above
    "load_torque": Channel("torque", loading=True),  # of a friction table: what loads the gear, counted where the table is
    "twist": Channel("twist"),
    "temperature": Channel("temperature"),
    "vibration": Channel("vibration"),  # of an accelerometer on the housing
    "torque": Channel("torque"),
    "speed": Channel("speed"),
    "angle": Channel("angle"),
}
# Other names that people may give.
CHANNEL_ALIASES = {"position": "angle", "output_torque": "joint_torque", "velocity": "speed"}
