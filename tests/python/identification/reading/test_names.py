"""Names of columns in the spellings of people, programs and robots."""

from __future__ import annotations

import pytest
from hypothesis import given, strategies as st
from strainwave.files.labels import label_of
from strainwave.identification.reading.names import QUANTITIES, SIDES, UNITS, Meaning, meaning, words_of

NAMES = {
    "Drehzahl [1/min]": Meaning("speed", unit="1/min"),
    "Reibmoment (mNm)": Meaning("torque", unit="mNm"),
    "vitesse moteur [tr/min]": Meaning("speed", "input", unit="tr/min"),
    "Abtriebswinkel (°)": Meaning("angle", "output", unit="°"),
    "Gelenkwinkel_2_Grad": Meaning("angle", "output", which="2", unit="Grad"),
    "Lagesollwert": Meaning("angle", commanded=True),
    "température moteur [°C]": Meaning("temperature", "input", unit="°C"),
    "motor_torque_output_side_Nm": Meaning("torque", "output", unit="Nm"),
    "shoulder_pan_joint.position": Meaning("angle", "output", which="shoulder_pan"),
    "joint3_vel_deg_s": Meaning("speed", "output", which="3", unit="deg/s"),
    "actual_qd_0": Meaning("speed", which="0", robot=True),
    "target_q_5": Meaning("angle", commanded=True, which="5", robot=True),
    "theta_m": Meaning("angle", "input"),
    "tau_J_1": Meaning("torque", "output", which="1", robot=True),
    "motor_counts": Meaning("angle", "input"),
    "tau_l [N.m]": Meaning("torque", "output", unit="N.m", robot=True),
    "i_q": Meaning("current"),
    "iq_ref": Meaning("current", commanded=True),
    "Temperature_T0": Meaning("temperature", which="0"),
    "T [N.m]": Meaning("torque", unit="N.m"),
    "T [degC]": Meaning("temperature", unit="degC"),
    "T_C": Meaning("temperature", unit="degC"),
    "TE [µrad]": Meaning("twist", unit="µrad"),
    "transmission error (deg)": Meaning("twist", unit="deg"),
    "ω [rad/s]": Meaning("speed", unit="rad/s"),
    "rpm": Meaning("speed", unit="rpm"),
    "mNm": Meaning("torque", unit="mNm"),
    "setpoint": Meaning("angle", commanded=True),
    "tau_J1": Meaning("torque", "output", which="1", robot=True),
    "q_2": Meaning("angle", which="2", robot=True),
    "Cur3": Meaning("current", which="3"),
    "PositionCmptd2": Meaning("angle", commanded=True, which="2"),
    "joint_temperatures_1": Meaning("temperature", "output", which="1"),
    "jtor2": Meaning("torque", "output", which="2"),
    "field.effort1": Meaning("torque", which="1", robot=True),
    "j1_vel_degps": Meaning("speed", "output", which="1", unit="degps"),
    "axisQMsr_LBR_A2": Meaning("angle", which="2", robot=True),
    "AIPos_A1": Meaning("angle", which="1"),
    "ASPos_A1": Meaning("angle", commanded=True, which="1"),
    "MACur_A1": Meaning("current", "input", which="1"),
    "joint_eff_2": Meaning("torque", "output", which="2", robot=True),
    "msrJntPos1": Meaning("angle", "output", which="1"),
    "Axis1.NcToPlc.ActVelo": Meaning("speed", which="1"),
    "joint_angles_1": Meaning("angle", "output", which="1"),
    "Position in rad": Meaning("angle", unit="rad"),
    "Strom_A": Meaning("current", unit="A"),
    "robot.arm.q_1": Meaning("angle", "output", which="1", robot=True),
    "left_arm_q2": Meaning("angle", "output", which="2", robot=True),
    "present_position_deg": Meaning("angle", unit="deg"),
    "log.t": Meaning("time", which="log"),
    "Sensor X [N.m]": Meaning("torque", which="x", unit="N.m"),
}
NO_NAMES = (
    "kp",
    "cycle",
    "Num",
    "position_error",
    "ddq",
    "pulses_N",
    "Tool_current",
    "status",
    "",
    "42",
    "x [m]",
    "friction coefficient [1]",
    "torque_rne_1",
    "estExtJntTrq0",
    "tau_ff_2",
)


@pytest.mark.parametrize("text", NAMES)
def test_a_name_contains_what_is_measured(text: str) -> None:
    assert meaning(label_of(text)) == NAMES[text]


@pytest.mark.parametrize("text", NO_NAMES)
def test_what_measures_nothing_known_is_nothing(text: str) -> None:
    assert meaning(label_of(text)) is None


words = st.sampled_from([(quantity, word) for quantity, all_of_it in QUANTITIES.items() for word in all_of_it if len(word) > 2])
sides = st.sampled_from([(side, word) for side, all_of_it in SIDES.items() for word in all_of_it if len(word) > 2])


@given(words, sides, st.sampled_from(["_", " ", "."]), st.booleans(), st.sampled_from([str.lower, str.upper, str.title]))
def test_side_and_quantity_are_found_in_any_order_and_case(
    quantity: tuple[str, str], side: tuple[str, str], between: str, first: bool, case: object
) -> None:
    both = (side[1], quantity[1]) if first else (quantity[1], side[1])
    found = meaning(label_of(f"{case(between.join(both))} [{UNITS[quantity[0]]}]"))  # type: ignore[operator, index]
    assert found is not None
    assert (found.quantity, found.side) == (quantity[0], side[0])


@given(st.text(max_size=300))
def test_any_text_is_taken_apart(text: str) -> None:
    assert all(word for word in words_of(text))
    meaning(label_of(text))
