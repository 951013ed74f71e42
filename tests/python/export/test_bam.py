"""Parameters of BAM: its own formula with the numbers written is the friction of the gear at the output."""

import json
from math import exp

import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from strainwave.export.bam_parameters import bam, read_bam
from strainwave.files.gear_set import GearSet

MOTOR = sw.motor.CurrentSource(torque_constant=0.08, inertia=5e-5)
RATIO = 100.0


def written(law) -> dict:
    gear = sw.Gear(kinematics=sw.kinematics.PlainRatio(reduction=RATIO), friction_input=law, input_inertia=1e-5)
    gear_set = GearSet.of(sw.Drive(gear=gear, motor=MOTOR), name="test", source="test")
    return json.loads(bam(gear_set, max_torque=100.0).files["bam.json"])


def friction_by_bam(numbers: dict, speed: float) -> float:
    """Friction budget of models M1 and M2 (DuclusaudPassault2024, table I)."""
    dry = numbers["friction_base"]
    if numbers["model"] == "m2":
        dry += numbers["friction_stribeck"] * exp(-(abs(speed / numbers["dtheta_stribeck"]) ** numbers["alpha"]))
    return dry + numbers["friction_viscous"] * speed


laws = st.one_of(
    st.builds(sw.friction.Coulomb, coulomb=st.floats(0.01, 0.1), viscous=st.floats(0.0, 1e-3)),
    st.builds(
        sw.friction.Stribeck,
        coulomb=st.floats(0.01, 0.1),
        breakaway=st.floats(0.1, 0.2),
        stribeck_speed=st.floats(1.0, 20.0),
        viscous=st.floats(0.0, 1e-3),
    ),
)


@pytest.mark.slow("export")
@given(law=laws, speed=st.floats(0.05, 2.0))
def test_the_friction_is_that_of_the_gear_at_the_output(law, speed):
    at_input = float(law.steady(RATIO * speed))
    assert friction_by_bam(written(law), speed) == pytest.approx(RATIO * at_input, rel=1e-6)


@pytest.mark.slow("export")
@given(law=laws)
def test_what_was_written_is_read_back(law, tmp_path_factory):
    path = tmp_path_factory.mktemp("bam") / "mine.json"
    path.write_text(json.dumps(written(law)))
    found = read_bam(path, RATIO)
    for speed in (0.5, 3.0, 100.0):
        assert float(found.gear.friction_input.steady(speed)) == pytest.approx(float(law.steady(speed)), rel=1e-6)
    assert found.motor.torque_constant == pytest.approx(MOTOR.torque_constant)
    assert found.gear.input_inertia == pytest.approx(6e-5)


@pytest.mark.parametrize("resistance", [0.4, None])
def test_every_number_is_kept_there_and_back(resistance, tmp_path):
    """A motor without a resistance takes a current."""
    path, constant = tmp_path / "mine.json", {"torque_constant": 0.08, "inertia": 2e-5}
    motor = sw.motor.CurrentSource(**constant) if resistance is None else sw.motor.DC(resistance=resistance, **constant)
    joint = GearSet.read("csg-20-100").with_parts(motor=motor, source="test")
    path.write_text(bam(joint).files["bam.json"])
    numbers = json.loads(path.read_text())
    back = json.loads(bam(read_bam(path, 100.0), max_torque=100.0).files["bam.json"])
    assert numbers.get("R") == resistance
    assert {name: back[name] for name in numbers if name not in ("model", "actuator")} == pytest.approx(
        {name: value for name, value in numbers.items() if name not in ("model", "actuator")}
    )


def test_inertia_and_torque_constant_are_at_the_output():
    numbers = written(sw.friction.Coulomb(coulomb=0.05))
    assert (numbers["kt"], numbers["armature"]) == (pytest.approx(8.0), pytest.approx(0.6))


def test_terms_without_a_law_are_named(tmp_path):
    path = tmp_path / "m4.json"
    path.write_text(
        '{"kt": 4.8, "armature": 0.3, "friction_base": 3.4, "friction_stribeck": 0.1, "dtheta_stribeck": 0.3, "alpha": 1.5, '
        '"load_friction_base": 0.06, "friction_viscous": 1.2, "model": "m4", "actuator": "erob80_50"}'
    )
    note = read_bam(path, 50.0).note
    assert "load_friction_base" in note
    assert "exponent 1.5" in note


@pytest.mark.parametrize(
    "text", ["", "[]", "[1, 2]", "{}", '{"friction_base": "much"}', '{"friction_base": NaN, "friction_viscous": 1}', "[" * 9999]
)
def test_another_file_is_refused(text, tmp_path):
    path = tmp_path / "no.json"
    path.write_text(text)
    with pytest.raises(ValueError, match=r"no\.json|finite|coulomb"):
        read_bam(path, 100.0)


def test_a_gear_without_a_motor_is_refused():
    with pytest.raises(ValueError, match="add a \\[motor\\]"):
        bam(GearSet.read("csg-20-100"))
