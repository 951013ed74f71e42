"""Every script of `examples/` runs without a warning, draws its picture, and finds what it says it shows."""

from __future__ import annotations

import ast
import shutil
import tomllib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import drawn as pictures
import gallery as pages
import numpy as np
import pytest
import strainwave as sw
from run_script import read
from scipy import signal
from strainwave import _core

ROOT = Path(__file__).resolve().parents[2] / "examples"
SCRIPTS = sorted(ROOT.glob("*.py"))
DRIVES = sorted((ROOT / "drives").glob("*.toml"))
pytestmark = pytest.mark.slow("docs")  # an example runs for seconds, unless the pages were built


@pytest.fixture(scope="module")
def gallery() -> Callable[[str], dict[str, Any]]:
    """Returns the values of the example of a number, by name, and its folder. The pages show the pictures of the same run."""

    @cache
    def of(number: str) -> dict[str, Any]:
        folder = drawn(number)
        return read(folder / pictures.VALUES) | {"folder": folder}

    return of


def drawn(number: str) -> Path:
    """Returns the folder of the example of a number."""
    (script,) = ROOT.glob(f"{number}_*.py")
    return pictures.drawn(script.stem, script.read_text(encoding="utf-8"))


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_an_example_says_what_it_shows_and_draws_it(script: Path) -> None:
    text = script.read_text(encoding="utf-8")
    assert len(ast.get_docstring(ast.parse(text)) or "") > 100
    assert 20 <= len(text.splitlines()) <= 80
    folder = drawn(script.stem[:2])
    assert (folder / pictures.PRINTED).read_text(encoding="utf-8")  # its numbers
    assert (folder / pictures.WARNINGS).read_text(encoding="utf-8") == ""
    assert [path.stat().st_size > 10_000 for path in folder.glob("*.png")] == [True]


def test_a_compensated_joint_has_less_error_also_if_the_model_is_ten_percent_wrong() -> None:
    printed = (drawn("17") / pictures.PRINTED).read_text(encoding="utf-8")
    cascade, compensated = (
        [float(each) for each in line.split("]")[1].split()] for line in printed.splitlines() if "error [urad]" in line
    )
    assert len(cascade) == len(compensated) == 5
    assert max(compensated[1:4]) < 0.75 * min(cascade[1:4])


def test_examples_are_numbered_and_have_a_picture_and_a_page_each(tmp_path: Path) -> None:
    assert [script.stem[:2] for script in SCRIPTS] == [f"{number:02}" for number in range(1, len(SCRIPTS) + 1)]
    docs = ROOT.parent / "docs"
    shutil.copy(docs / "gallery.md", tmp_path)
    pages.write(tmp_path)
    text = (tmp_path / "gallery.md").read_text(encoding="utf-8")
    for script in SCRIPTS:
        assert text.count(f"drawn/{script.stem}/") == 1
        page = (tmp_path / "gallery" / f"{script.stem}.md").read_text(encoding="utf-8")
        assert pages.example_of(script).code in page
    assert set(pages.PAGES) <= {script.stem[:2] for script in SCRIPTS}
    papers = {f"validation/{page.parent.name}.md" for page in (ROOT.parent / "papers").glob("*/README.md")}
    named = {path.partition("#")[0] for paths in pages.PAGES.values() for path in paths}
    assert [path for path in named - papers if not (docs / path).is_file()] == []


def lines_of_code(text: str) -> int:
    """Lines that hold code: neither docstring nor comment nor blank nor import."""
    tree = ast.parse(text)
    body = [node for node in tree.body[1:] if not isinstance(node, ast.Import | ast.ImportFrom)]
    used = {line for node in body for line in range(node.lineno, (node.end_lineno or node.lineno) + 1)}
    lines = text.splitlines()
    return sum(1 for line in used if lines[line - 1].strip() and not lines[line - 1].strip().startswith("#"))


def test_a_drive_of_no_document_takes_under_twenty_lines() -> None:
    """Two frictions, a load, a controller, the run, its numbers and its picture."""
    (script,) = ROOT.glob("03_*.py")
    assert lines_of_code(script.read_text(encoding="utf-8")) < 20


def named(table: dict[str, Any]) -> set[str]:
    """Names of the models that a table of a file and those in it name."""
    inside = [named(each) for each in table.values() if isinstance(each, dict)]
    return {table["model"]}.union(*inside) if "model" in table else set().union(*inside)


def test_the_ten_drives_have_every_model_between_them() -> None:
    """Models are counted where a file names them: what a drive has without being told does not count."""
    assert len(DRIVES) == 10
    used = set().union(*(named(tomllib.loads(path.read_text(encoding="utf-8"))) for path in DRIVES))
    families = [sw.motor, sw.control, sw.loads, sw.sensor, sw.thermal, sw.softening, sw.meter, sw.friction]
    families += [sw.hysteresis, sw.stiffness, sw.kinematic_error, sw.kinematics]
    models = [
        each for family in families for each in vars(family).values() if isinstance(each, type) and hasattr(each, "fields")
    ]
    # What a sensor is untold, another density, an inverse, laws that contain a second gear (see docs/how-to/control.md), and
    # errors beside those of the drives.
    aside = {"ideal", "grid_density", "prandtl_ishlinskii", "feedback_linearisation", "kinematic_error_tracking"}
    aside |= {"micro_slip", "sine_cosine_encoder"}
    wanted = {model.name for model in models} - aside
    assert sorted(wanted - used) == []
    drives = [sw.GearSet.read(path).drive for path in DRIVES]
    combinations = {tuple(type(getattr(drive, part)).__name__ for part in ("motor", "control", "load")) for drive in drives}
    assert len(combinations) == 10


def test_the_ten_drives_run(gallery: Callable[[str], dict[str, Any]]) -> None:
    runs = gallery("04")["runs"]
    assert list(runs) == [path.stem for path in DRIVES]
    for run in runs.values():
        assert run["torque"].any()
        assert np.isfinite(run["torque"]).all()


LOADS: dict[str, tuple[float, Callable[[Any, Any], Any]]] = {  # inertia, and what the load takes at an angle and a speed
    "01-rotary-table": (0.2, lambda angle, speed: 0.0 * angle),
    "02-solar-array": (1.5, lambda angle, speed: 6.0 * (angle + 0.2) + 1.0 * speed),
    "04-welding-arm": (0.4, lambda angle, speed: 25.0 * np.sin(angle)),
    "05-toggle-clamp": (0.3, lambda angle, speed: np.interp(angle, [0.0, 0.4, 0.7, 0.9, 1.2], [0.0, 5.0, 20.0, -6.0, 0.0])),
    "08-exoskeleton": (0.5, lambda angle, speed: 20.0 * np.sin(angle)),
    "09-telescope": (4.0, lambda angle, speed: 30.0 * angle),
    "10-conveyor": (0.6, lambda angle, speed: 0.0 * angle),
}


@pytest.mark.parametrize("name", LOADS)
def test_the_torque_of_a_drive_carries_and_accelerates_its_load(gallery: Callable[[str], dict[str, Any]], name: str) -> None:
    """Over the whole run the torque of the gear has the impulse of load and friction, and that of the change of speed."""
    run, (inertia, taken) = gallery("04")["runs"][name], LOADS[name]
    against = taken(run["output_angle"], run["output_speed"]) + run["friction_output"]
    impulse = np.trapezoid(against, run.time) + inertia * (run["output_speed"][-1] - run["output_speed"][0])
    size = np.trapezoid(np.abs(run["torque"]), run.time)
    assert np.trapezoid(run["torque"], run.time) == pytest.approx(impulse, abs=2e-4 * size)


def test_the_brake_of_the_rig_holds_up_to_its_breakaway_torque(gallery: Callable[[str], dict[str, Any]]) -> None:
    """20 N.m, and 1.3 times that at rest."""
    run = gallery("04")["runs"]["06-brake-rig"]
    held = run["output_speed"] == 0.0
    assert 25.0 < run["load_torque"][held].max() <= 26.0
    assert run["load_torque"][run["output_speed"] > 0.0] == pytest.approx(20.0, rel=1e-9)


def test_orders_peak_at_the_eigenfrequency_over_the_order(gallery: Callable[[str], dict[str, Any]]) -> None:
    """Free shafts on a linear spring: omega^2 = k (1 / J_out + 1 / (i^2 J_in)), here of 8000, 0.05 and 1.5e-4."""
    found = gallery("05")
    mode = np.sqrt(8000.0 * (1.0 / 0.05 + 1.0 / (100.0**2 * 1.5e-4)))
    assert found["mode"] == pytest.approx(mode, rel=1e-9)
    assert found["observed"] == pytest.approx(mode / np.array([1.0, 2.0, 4.0, 11.5 * (1.0 - 5.5 / 45.0) * 1.01]), rel=0.02)


def test_torque_over_speed_is_the_linear_response_to_the_kinematic_error(gallery: Callable[[str], dict[str, Any]]) -> None:
    """An error e shakes the spring by e Z (k + c s) / (Z + k + c s), 1/Z = 1/Z_out + 1/Z_in, motor and its loop in Z_in.

    The gear is not linear: reaction and error of two orders mix. Order 2 is the largest by far and hardly sees the others.
    """
    found = gallery("05")
    s = 1j * np.outer(found["speed"], found["orders"])
    spring, output = 8000.0 + s, 0.05 * s**2
    input_ = 100.0**2 * (1.5e-4 * s**2 + (0.05 * 0.05 + 1e-4) * s + 0.2 * 0.05)
    impedance = 1.0 / (1.0 / output + 1.0 / input_)
    expected = np.abs(impedance * spring / (spring + impedance)) * [8e-5, 3e-4, 5e-5, 2e-6]
    assert found["torque"].max(axis=0)[:3] == pytest.approx(expected.max(axis=0)[:3], rel=0.02)
    steady = np.abs(np.abs(s[:, 1]) / found["mode"] - 1.0) > 0.1  # near resonance it rings while the speed goes on
    off = np.abs(found["torque"][steady, 1] / expected[steady, 1] - 1.0)
    assert np.median(off) < 2e-3
    assert off.max() < 0.04


def test_the_places_lose_what_a_loop_loses(gallery: Callable[[str], dict[str, Any]]) -> None:
    for study in gallery("06")["studies"].values():
        for _, (_, area, taken) in study:
            assert taken.sum() == pytest.approx(area, rel=2e-3)
            assert (taken > -1e-9).all()


def test_shares_of_a_loop_change_as_the_page_says(gallery: Callable[[str], dict[str, Any]]) -> None:
    shares = {
        quantity: np.array([taken / taken.sum() for _, (_, _, taken) in study])
        for quantity, study in gallery("06")["studies"].items()
    }
    generator, teeth, bearing, _, _ = shares["torque [N.m]"].T
    assert bearing[0] == max(shares["torque [N.m]"][0])
    assert (np.diff(teeth) > 0.0).all()
    assert shares["frequency [Hz]"][-1, 0] > shares["frequency [Hz]"][0, 0]
    assert (np.diff(shares["8 Hz, at [°C]"][:, 0]) < 0.0).all()
    assert generator[0] == 0.0  # a small torque does not break it away


def test_current_shows_the_kinematic_error_as_the_closed_form_says(gallery: Callable[[str], dict[str, Any]]) -> None:
    """At 20 N.m 32, 240 and 80 mA where the speed is held ideally; a loop has |T_c| times as much."""
    found = gallery("08")
    assert found["measured"] == pytest.approx(found["predicted"], rel=2e-3, abs=1e-5)
    (at,) = np.flatnonzero(found["loads"] == 20.0)
    assert found["measured"][at] == pytest.approx([0.032, 0.240, 0.080], rel=0.02)


def test_a_move_of_the_joint_is_held_against_the_ratings(gallery: Callable[[str], dict[str, Any]]) -> None:
    """The file that the example saves holds the whole joint; its last move, the hasty one, exceeds the peak torque alone."""
    found = gallery("02")
    saved = sw.GearSet.read(found["folder"] / "my_joint.toml")
    assert saved == found["joint"]
    assert [check.name for check in sw.check_ratings(saved, found["run"]) if check.exceeded] == ["peak_torque"]


def test_falling_friction_sticks_and_slips_only_at_creep_speed(gallery: Callable[[str], dict[str, Any]]) -> None:
    rest = gallery("07")["rest"]
    assert rest["falling", 0.2] > rest["falling", 0.8] > 0.5
    assert rest["falling", 3.0] == 0.0
    assert {rest["level", speed] for speed in (0.2, 0.8, 3.0)} == {0.0}


def test_an_hour_warms_the_joint_as_its_thermal_resistances_say(gallery: Callable[[str], dict[str, Any]]) -> None:
    """In the steady state, with the heat of the last ten minutes: two bodies to the air and to each other."""
    run = gallery("09")["run"]
    last = run.between(3000.0, 3600.0)

    def heat(*places: str) -> float:
        return float(sum(last[f"energy_{place}"][-1] - last[f"energy_{place}"][0] for place in places)) / 600.0

    flows = np.array([heat("motor"), heat("friction_input", "friction_mesh", "friction_output", "damping", "hysteresis")])
    coupling = 0.5
    conductance = np.array([[1.0 / 2.0 + coupling, -coupling], [-coupling, 1.0 / 2.5 + coupling]])
    rises = np.linalg.solve(conductance, flows)
    assert last["winding_temperature"].mean() - 293.15 == pytest.approx(rises[0], rel=0.01)
    assert last["temperature"].mean() - 293.15 == pytest.approx(rises[1], rel=0.01)
    largest = 0.05 * np.exp(-0.004 * rises[1]) + 8e-4 * np.abs(last["input_speed"]).max() * np.exp(-0.025 * rises[1])
    assert np.abs(last["friction_input"]).max() == pytest.approx(largest, rel=0.005)


def test_what_the_joint_takes_in_an_hour_is_lost_or_stored(gallery: Callable[[str], dict[str, Any]]) -> None:
    run = gallery("09")["run"]
    lost = sum(
        run[f"energy_{place}"][-1] for place in ("motor", "friction_input", "hysteresis", "damping", "softening", "load")
    )
    stored = sum(run[name][-1] - run[name][0] for name in run.names if name.startswith("stored_"))
    assert run["energy_supplied"][-1] == pytest.approx(lost + stored, rel=1e-6)  # as the script prints it


def test_a_sampled_joint_swings_without_end_beyond_its_delay_margin(gallery: Callable[[str], dict[str, Any]]) -> None:
    """No lateness lies within 6 % of the margin; the mean lateness stands for the held samples up to such a difference."""
    found = gallery("10")
    assert (found["still"] == (found["lateness"] < found["margin"])).all()
    assert 3 <= (found["still"] == 0.0).sum() < found["still"].size / 2
    assert np.abs(found["lateness"] / found["margin"] - 1.0).min() > 0.06


def test_a_python_controller_keeps_the_clamp_in_hand(gallery: Callable[[str], dict[str, Any]]) -> None:
    run = gallery("03")["run"]
    assert np.abs(run["command"] - run["output_angle"]).max() < 0.015
    assert run["load_torque"].max() > 29.0


def test_efficiency_is_what_its_losses_leave(gallery: Callable[[str], dict[str, Any]]) -> None:
    """Load over load, losses of the teeth and friction of the bearing by its Hersey number, referred to the output."""
    found = gallery("11")
    for celsius, shown in found["maps"].items():
        speed, load = np.meshgrid(found["speeds"], found["torques"])
        viscosity, pressure = np.exp(-0.03 * (celsius - 20.0)), 1.0 + 0.3 * load / 100.0
        hersey = viscosity * speed / (20.0 * pressure)
        friction = pressure * (0.03 + 0.05 * np.exp(-(hersey**2))) + 6e-4 * viscosity * speed
        assert shown == pytest.approx(load / (1.08 * load + 100.0 * friction), rel=1e-4)


def test_resonance_shapes_what_an_encoder_pair_sees(gallery: Callable[[str], dict[str, Any]]) -> None:
    """An error e shows as e (k + c s) / (k + c s + Z), 1/Z = 1/Z_out + 1/Z_in; the loop of the speed belongs to Z_in."""
    found = gallery("12")
    for speed in (15.0, 60.0):
        s = 1j * speed * np.array(found["orders"])
        spring, output, input_ = 8000.0 + s, 0.05 * s**2, 100.0**2 * (1.5e-4 * s**2 + 0.1 * s + 2.0)
        shown = np.abs(spring / (spring + 1.0 / (1.0 / output + 1.0 / input_))) * found["amplitudes"]
        line = np.sqrt(2.0 / 32.0) * 3e-6  # of 32 lines of noise that have 3e-6 rad together, root mean square
        leak = line / (np.pi * 20.0 * 0.1)  # 0.1 from an order, over 20 revolutions
        assert found["found"][speed].amplitude == pytest.approx(shown, rel=0.005, abs=leak)
    rest = [found["found"][speed].residual for speed in (15.0, 60.0, 190.0)]
    assert rest[0] > 5.0 * rest[1] > 25.0 * rest[2]


def test_the_tilt_actuator_shows_its_misalignment_as_the_closed_forms_say(gallery: Callable[[str], dict[str, Any]]) -> None:
    """e = max of two lobes, m |cos|: its order 2 has 4 m / 3 pi tan(alpha) / r, with m = e_1 + h beta_2 = 13.5 um.

    The current has 2 e times load over torque constant, as far as the reaction of the error goes; what the inertia of the
    nacelle asks for besides is less. The peak of the torque grows by a few percent, no more.
    """
    found = gallery("13")["found"]
    moment = 10e-6 + 4e-3 * np.radians(0.05)
    for name, times in (("misaligned", 1.0), ("twice as much", 2.0)):
        error = times * 4.0 * moment / (3.0 * np.pi) * np.tan(np.radians(30.0)) / 0.025
        assert found[name]["error"] == pytest.approx(error, rel=2e-3)
        assert found[name]["current"] == pytest.approx(2.0 * 24.7 * error / 0.0919, rel=0.1)
        assert found[name]["end"] == pytest.approx(90.0, abs=0.03)
        assert 1.0 < found[name]["peak"] < 1.05
    assert found["aligned"]["current"] < 1e-3


def test_a_soft_reversal_swings_a_loop_on_the_output_alone(gallery: Callable[[str], dict[str, Any]]) -> None:
    """After small steps all rest; after large ones the loop on the arm swings, with the soft gear only, whatever the step."""
    found = gallery("14")
    swings, large = found["swings"], found["steps"] >= 0.4
    soft = swings["the article's gear"]
    assert (soft[~large, 0] < 1e-9).all()
    assert np.ptp(soft[large], axis=0) == pytest.approx([0.0, 0.0], abs=5e-3)
    assert soft[large, 0].min() > np.radians(0.5)
    assert all((each[:, 0] < 1e-9).all() for name, each in swings.items() if name != "the article's gear")


def test_the_limit_cycle_is_about_that_of_the_describing_function(gallery: Callable[[str], dict[str, Any]]) -> None:
    """A describing function leaves harmonics out: a tenth of amplitude and frequency is what it is usually good for."""
    found = gallery("14")
    run = found["runs"]["the article's gear"][-1][0].between(4.0, 6.0)
    twist, rate = 0.5 * np.degrees(np.ptp(run["twist"])), found["swings"]["the article's gear"][-1, 1]
    assert found["foretold"] == pytest.approx([twist, rate], rel=0.12)


def test_small_commands_meet_a_stiff_gear(gallery: Callable[[str], dict[str, Any]]) -> None:
    """Before its soft range begins the law is a spring, as `linearise` has it; large commands fall off no more."""
    found = gallery("14")
    answers = {size: np.abs(answer["output_angle"]) for size, answer in found["answers"].items()}
    linear = np.abs(sw.linearise(found["slower"]).response(found["frequency"]))
    assert answers[0.1] == pytest.approx(linear, rel=0.02)
    assert (answers[1.0] > 0.99 * answers[0.1]).all()
    assert answers[0.5].max() > 1.2


def test_a_gear_comes_back_from_its_photographs(gallery: Callable[[str], dict[str, Any]]) -> None:
    """Dry friction takes its torque times the angle that the input slides, no more, from the loop."""
    found = gallery("15")
    model, gear = found["model"], found["gear"]
    assert found["held"]["found"] == pytest.approx(found["held"]["true"], rel=0.01)
    for stiffness in ("k1", "k2", "k3"):
        assert getattr(model.stiffness, stiffness) == pytest.approx(getattr(gear.stiffness, stiffness), rel=0.01)
    measured, clean = (sw.rig.analyse(found[name]).area.value for name in ("loop", "clean"))
    slid = 2.0 * np.ptp(found["loop"].angle)  # once to each end; where it turns back it rests
    assert measured - clean == pytest.approx(0.02 * slid, rel=0.02)


def test_a_worn_joint_contradicts_the_saved_one(gallery: Callable[[str], dict[str, Any]]) -> None:
    found = gallery("16")
    assert not found["same"].contradicts
    assert found["same"].changed == ()
    assert found["worn"].contradicts
    (dry,) = found["worn"].changed
    assert dry.name == "dry friction"
    assert abs(dry.value - 1.3) < 0.03


def test_pulses_and_paths_reach_where_friction_and_lost_motion_leave(gallery: Callable[[str], dict[str, Any]]) -> None:
    """A load that breaks away jumps by 2 (F_s - F_c) / K = 93 urad; the pulses are corrected to about half of that."""
    found = gallery("18")
    planned, measured = found["spreads"]["planned"], found["spreads"]["measured"]
    assert measured.median_error < 0.5 * 2.0 * (0.186984 - 0.18) / 150.0 < planned.median_error
    for name in ("the article's gear", "CSG-20-100"):
        assert found["apart"][name, "plain"] == pytest.approx(-1.0, abs=0.03)
        assert abs(found["apart"][name, "one side"]) < 0.002


def test_the_numbers_of_a_joint_that_warms_up_are_followed(gallery: Callable[[str], dict[str, Any]]) -> None:
    """The compliance within two stated deviations, friction within a tenth of its change; the error falls."""
    found = gallery("19")
    apart = found["compliance"] - found["true_compliance"]
    assert (np.abs(apart) < 2.0 * found["deviation"]).all()
    assert found["true_compliance"][-1] > 1.05
    assert (found["deviation"] < 0.03).all()
    assert found["friction"][-1] == pytest.approx(found["true_friction"][-1], abs=0.03)
    assert found["true_friction"][-1] < 0.7
    last = {name: result[0, -1] for name, result in found["results"].items()}
    assert last["with both scales identified"] < 0.5 * last["with a disturbance observer"]
    assert last["with both scales identified"] < 0.1 * last["model of the cold joint"]


def linear_deviation(found: dict[str, Any], torque: sw.scenario.Scenario, bandwidth: float) -> float:
    """Largest output angle [rad] by a torque at the output: two inertias on a spring, the loops, an observer or 0 for none.

    The states are the angle and speed of input and output, the integral of the speed error and the torque observed.
    """
    plant, law, surface = found["plant"], found["law"], found["surface"]
    gear, constant = plant.drive.gear, plant.drive.motor.torque_constant
    ratio, stream = 101.0, 0.5 * 1.225 * 40.0**2 * 0.4 * 0.2 * 0.4
    angle, speed, output_angle, output_speed, integral, observed = np.eye(6)
    error = -law.position_gain * ratio * output_angle - speed
    drive = constant * (law.speed_proportional * error + law.speed_integral * integral) + observed
    twisting = gear.stiffness.k * (angle / ratio - output_angle) + gear.damping * (speed / ratio - output_speed)
    rate = (drive - twisting / ratio) / plant.input_inertia
    load = gear.friction_output.viscous * output_speed + stream * output_angle
    observing = bandwidth * (drive - observed - plant.total_inertia * rate)
    a = np.array([speed, rate, output_speed, (twisting - load) / surface.inertia, error, observing])
    b = np.array([[0.0], [0.0], [0.0], [-1.0 / surface.inertia], [0.0], [0.0]])
    time = np.linspace(0.0, torque.duration, 20001)
    _, moved, _ = signal.lsim((a, b, output_angle[np.newaxis], np.zeros((1, 1))), torque.value(time), time)
    return float(np.abs(moved).max())


def test_a_gust_moves_a_surface_as_two_inertias_under_the_loop(gallery: Callable[[str], dict[str, Any]]) -> None:
    """Without the kinematic error, whose ripple of the torque is not linear in the gust; the speed keeps its sign meanwhile."""
    found = gallery("21")
    for name, bandwidth in (("cascade", 0.0), ("cascade with observer", found["observer"].bandwidth)):
        added = sw.Compensation(**found["parts"][name], actuation_per_torque=found["plant"].actuation_per_torque)
        drive = found["plant"].controlled(found["law"], added).replace({"gear.kinematic_error": sw.kinematic_error.Fourier()})
        calm = sw.simulate(drive, found["command"], sample=1e-3)["output_angle"]
        for torque in list(found["gusts"].values())[1:]:
            moved = sw.simulate(drive, found["command"], sample=1e-3, load_torque=torque)["output_angle"] - calm
            assert np.abs(moved).max() == pytest.approx(linear_deviation(found, torque, bandwidth), rel=0.05)


def test_a_feedforward_leaves_what_a_gust_does(gallery: Callable[[str], dict[str, Any]]) -> None:
    found = gallery("21")
    tracking, deviation = found["tracking"], found["deviation"]
    for air in list(found["gusts"])[1:]:
        assert deviation["cascade with model", air] == pytest.approx(deviation["cascade", air], rel=0.01)
        assert deviation["model and observer", air] == pytest.approx(deviation["cascade with observer", air], rel=0.01)
        assert deviation["cascade with observer", air] < 0.33 * deviation["cascade", air]
    assert tracking["cascade with model", "calm"] < 0.33 * tracking["cascade", "calm"]


def test_a_slow_integral_of_the_arm_has_no_limit_cycle(gallery: Callable[[str], dict[str, Any]]) -> None:
    """At 5 1/s it is five times slower than the softest vibration, sqrt(3000 / 5) = 24 rad/s, so steps and pushes die out."""
    found = gallery("22")
    for (name, kind), swing in found["swings"].items():
        if name.startswith("loop on the arm"):
            continue
        assert swing.max() < 1e-3, (name, kind)
        if name != "loop on the motor":
            assert np.abs(found["errors"][name, kind]).max() < 1e-3, (name, kind)
    assert found["swings"]["loop on the arm", "step"].max() > 0.5
    assert found["swings"]["loop on the arm, model", "path"].max() < 1e-3
    assert found["swings"]["loop on the arm, model", "push"].max() > 0.5  # feed-forward does not change a loop
    assert np.abs(found["errors"]["loop on the motor", "step"]).max() > 0.05


def test_the_model_of_a_soft_gear_leads_also_if_its_loop_is_wide_or_narrow(gallery: Callable[[str], dict[str, Any]]) -> None:
    found = gallery("22")

    def lag(name: str) -> float:
        commands = [np.degrees(path.value(found["time"])) for path in found["paths"]]
        return max(float(np.abs(run - to).max()) for run, to in zip(found["runs"][name, "path"], commands, strict=True))

    assert lag("and model") < 0.1 * lag("motor, arm integrated")
    for name in ("20 % less lost motion", "20 % more lost motion"):
        assert lag("and model") < lag(name) < 0.33 * lag("motor, arm integrated")
    assert abs(found["apart"]["one side"]) < 0.15 * abs(found["apart"]["both sides"])


def test_friction_by_the_measured_motion_creeps_where_others_stick(gallery: Callable[[str], dict[str, Any]]) -> None:
    """At the input, at all speeds. At the output none does below the jump of friction over the root of K J."""
    example = gallery("20")
    found, cases = example["found"], example["cases"]
    at_input = {name: rows[:, 0] for name, rows in found["friction at the input"].items()}
    assert (at_input["bristle observer"] == 0.0).all()
    for name in ("cascade, disturbance observer", "friction of a model"):
        assert (at_input[name][:3] > 0.1).all()
        assert at_input[name][-1] == 0.0
    drives, speeds = cases["friction at the output, too"]
    gear, load = next(iter(drives.values())).gear, next(iter(drives.values())).load
    stiffness = gear.stiffness.k1 + sum(gear.hysteresis.stiffness)
    critical = 100.0 * (0.6 - 0.3) / np.sqrt(stiffness * load.inertia)
    for rows in found["friction at the output, too"].values():
        assert (rows[np.array(speeds) < 0.75 * critical, 0] > 0.1).all()
        assert (rows[np.array(speeds) > 1.25 * critical, 0] == 0.0).all()


def table_of(page: str, columns: int) -> list[list[str]]:
    """Return the rows of all tables of a page of validation that have so many columns."""
    text = (ROOT.parent / "docs" / "validation" / page).read_text(encoding="utf-8")
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in text.splitlines() if line.startswith("|")]
    return [row for row in rows if len(row) == columns]


def test_the_page_of_signatures_has_the_numbers_of_its_example(gallery: Callable[[str], dict[str, Any]]) -> None:
    """Each number of the table within 2 % of the example, or half of its last digit (0.05 mA, 0.005 of a severity)."""
    found = gallery("23")
    expected = []
    for name, (_, measured, orders, turns) in found["faults"].items():
        what = measured.partition(" [")[0]
        floor = found["hidden"].get(measured, found["highest"] / np.sqrt(max(turns, 1)))
        for order, values in zip(orders or [None], found["found"][name].T, strict=True):
            change = np.abs(values - values[0])
            seen = next((k for k in range(1, 4) if change[k] > floor), None)  # a line between two severities of the example
            share = None if seen is None else (floor - change[seen - 1]) / (change[seen] - change[seen - 1])
            severity = None if seen is None or share is None else np.interp(seen - 1 + share, range(4), found["severities"])
            expected.append((name, f"{what}, order {order:.4g}" if order else what, values[0], values[-1], severity))
    rows = [row for row in table_of("fault-signatures.md", 5) if row[0] in found["faults"] and "none" not in row[1]]
    assert [(row[0], row[1]) for row in rows] == [(name, what) for name, what, *_ in expected]
    for (_, _, healthy, faulty, shown), (name, what, *numbers, severity) in zip(rows, expected, strict=True):
        for text, number in zip((healthy, faulty), numbers, strict=True):
            assert float(text.split()[0]) == pytest.approx(number, rel=0.02, abs=0.05 if " mA" in text else 1e-6), (name, what)
        assert shown == "does not change" if severity is None else float(shown) == pytest.approx(severity, abs=0.006), name


def test_every_fault_of_the_package_has_a_signature(gallery: Callable[[str], dict[str, Any]]) -> None:
    shown = {type(each).__name__ for each, *_ in gallery("23")["faults"].values()}
    assert shown == {model.__name__ for model in _core.fault_families["fault"].values()}


def test_lines_of_faults_have_their_closed_forms(gallery: Callable[[str], dict[str, Any]]) -> None:
    """Order n of an error shows T n A / K_t. A bearing shows 0.2 of the friction at the input."""
    found, constant = gallery("23"), 1.5 * 4 * 0.01
    assert found["found"]["misalignment, 30 µm"][-1, 1] == pytest.approx(40e3 * 4.0 * 3.707e-5 / constant, rel=0.06)
    assert found["found"]["tooth wear, wave of 0.5′"][-1, 0] == pytest.approx(40e3 * 2.02 * 1.5e-4 / constant, rel=0.06)
    friction = 0.09005 + 25.0 * 6.821e-4
    assert found["found"]["bearing, 20 % of the friction"][-1, 0] == pytest.approx(1e3 * 0.2 * friction / constant, rel=0.03)
    for name in ("tooth wear, wave of 0.5′", "bearing, 20 % of the friction", "cogging, 5 mN·m"):
        rise = found["found"][name][:, 0] - found["found"][name][0, 0]
        assert rise == pytest.approx(rise[-1] * np.array(found["severities"]), rel=0.03, abs=0.5), name


def test_spectra_have_the_orders_of_their_faults(gallery: Callable[[str], dict[str, Any]]) -> None:
    """Lines above 1.5 times what noise reaches, besides order 2 of the healthy gear."""
    found = gallery("24")
    lines = [[round(float(found["order"][k]), 2) for k in peaks] for peaks in found["peaks"].values()]
    assert lines == [[2.0, 4.0, 6.0, 8.0], [2.0, 2.02], [2.0, 2.02, 4.04, 6.06, 8.08], [2.0, 10.41]]


def test_a_comparison_with_a_baseline_finds_a_crack_of_half_the_severity(gallery: Callable[[str], dict[str, Any]]) -> None:
    """In every unit, and no crack in a healthy one. The simple detector finds it too, with alarms of healthy units."""
    compared, simple = (np.sum(alarms, axis=0) for alarms in gallery("25")["found"].values())
    assert (compared[0], compared[-1]) == (0, 8)
    assert simple[-1] == 8
    assert simple[0] > 0  # as the page says: twelve days are too few for a threshold
