"""Predictive control: the regulator where no limit acts, the limits where they do, and the same in C."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
import strainwave as sw

pytest.importorskip("osqp")

RATIO = -100.0
ERROR, EFFORT, LIMIT = 1e-3, 0.5, 20.0  # rad, N.m of the motor, N.m of the gear
STEP = sw.scenario.step(0.1, 0.5)


def joint(**parts: object) -> sw.Drive:
    gear = sw.Gear(stiffness=sw.stiffness.Linear(k=1e4), damping=5.0, **parts)  # type: ignore[arg-type]
    return sw.Drive(gear=gear, motor=sw.motor.TorqueSource(inertia=1e-4), load=sw.loads.Inertia(inertia=0.5))


def moved(
    controller: sw.tuning.PredictiveController, command: sw.scenario.Scenario, push: sw.scenario.Scenario | float = 0.0
) -> sw.Run:
    timing = {"period": controller.period, "delay": controller.delay}
    return sw.simulate_controlled(controller.drive, controller, command, load_torque=push, **timing)


@pytest.mark.parametrize("horizon", [1, 40])
def test_without_limits_it_is_the_regulator(horizon: int) -> None:
    """The end of the horizon costs what the regulator costs from there on, so both have the same gains, at any horizon."""
    drive, small = joint(), sw.scenario.step(1e-3, 0.2)
    law = sw.tuning.lqg(drive, error=ERROR, effort=EFFORT)
    controller = sw.tuning.mpc(drive, horizon=horizon, error=ERROR, effort=EFFORT, bandwidth=0.0)
    run = moved(controller, small)
    expected = sw.simulate(drive.replace(control=sw.control.Sampled(law=law, period=1e-3)), small)
    for name, size in (("output_angle", 1e-3), ("motor_torque", np.abs(expected["motor_torque"]).max())):
        assert np.abs(run[name] - expected[name]).max() < 1e-4 * size


def test_with_a_delay_its_gains_are_those_of_a_drive_that_remembers_its_actuation() -> None:
    """By iteration of the Riccati difference equation, with the actuation before among the states."""
    controller = sw.tuning.mpc(joint(), delay=7e-4, error=ERROR, effort=EFFORT)
    linear = sw.linearise(controller.drive)
    a, b = linear.A, linear.B[:, linear.inputs.index("command")]
    pieces = 2000  # forward steps of the exact transition, in place of the matrix exponential
    step, before, after = np.eye(4), np.zeros(4), np.zeros(4)
    fine = np.eye(4) + a * (1e-3 / pieces) + a @ a * (0.5 * (1e-3 / pieces) ** 2)
    by_input = (np.eye(4) + a * (0.5e-3 / pieces)) @ b * (1e-3 / pieces)
    for piece in range(pieces):
        late = piece < 0.7 * pieces
        step, before, after = fine @ step, fine @ before + late * by_input, fine @ after + (not late) * by_input
    whole = np.block([[step, before[:, np.newaxis]], [np.zeros((1, 5))]])
    held, value = np.append(after, 1.0), np.zeros((5, 5))
    weight = np.zeros((5, 5))
    output = np.array([{"input_angle": 1.0 / RATIO, "transmission_error": -1.0}.get(name, 0.0) for name in controller.states])
    weight[:4, :4] = np.outer(output, output) / ERROR**2
    gains = np.zeros(5)
    for _ in range(5000):
        gains = held @ value @ whole / (1.0 / EFFORT**2 + held @ value @ held)
        value = weight + whole.T @ value @ (whole - np.outer(held, gains))
    assert controller.gains == pytest.approx(gains, rel=1e-4)


def test_it_keeps_its_limits() -> None:
    """Within 2 %, as they are soft and those of a controller that samples. Without them the torque is six times as large."""
    free = moved(sw.tuning.mpc(joint(), error=ERROR, effort=EFFORT), STEP)
    assert np.abs(free["torque"]).max() > 5.0 * LIMIT
    assert np.abs(free["input_speed"]).max() > 200.0
    controller = sw.tuning.mpc(joint(), error=ERROR, effort=EFFORT, torque_limit=LIMIT, speed_limit=60.0)
    run = moved(controller, STEP)
    assert controller.unsolved == 0
    assert 0.95 * LIMIT < np.abs(run["torque"]).max() < 1.02 * LIMIT
    assert 59.0 < np.abs(run["input_speed"]).max() < 60.6
    assert run["output_angle"][-1] == pytest.approx(0.1, abs=1e-6)
    assert run["output_angle"].max() < 0.1 + 1e-3
    assert np.abs(run["motor_torque"]).max() == pytest.approx(1.5, rel=1e-6)  # 1e4 rad/s2 of 1.5e-4 kg.m2, as in `compensate`


def test_a_push_beyond_the_limit_leaves_it_in_hand() -> None:
    """No actuation keeps the torque then; afterwards the limit holds again."""
    push = sw.scenario.step(60.0, 0.5, start=0.25) - sw.scenario.step(60.0, 0.5, start=0.27)
    controller = sw.tuning.mpc(joint(), error=ERROR, effort=EFFORT, torque_limit=LIMIT)
    run = moved(controller, STEP, push)
    assert np.abs(run["torque"]).max() > 1.2 * LIMIT
    assert np.abs(run.between(0.4, 0.5)["torque"]).max() < 1.02 * LIMIT
    assert run["output_angle"][-1] == pytest.approx(0.1, abs=1e-4)
    assert controller.unsolved == 0


def test_friction_and_load_leave_no_error_where_the_bias_is_estimated() -> None:
    """Without it the regulator gives way until its gain holds the load: K_theta theta_in + K_delta delta = T / i."""
    drive = joint(friction_input=sw.friction.Stribeck(coulomb=0.03, breakaway=0.05, stribeck_speed=2.0, viscous=5e-4))
    command = sw.scenario.step(0.02, 1.0)
    held = moved(sw.tuning.mpc(drive, error=ERROR, effort=EFFORT), command, push=10.0)
    assert abs(held["output_angle"][-1] - 0.02) < 2e-5
    controller = sw.tuning.mpc(joint(), error=ERROR, effort=EFFORT, bandwidth=0.0)
    gave = moved(controller, command, push=10.0)
    gains = dict(zip(controller.states, controller.gains[:-1], strict=True))
    twist = 10.0 / 1e4
    input_angle = (-10.0 / RATIO - gains["transmission_error"] * twist) / gains["input_angle"]
    assert gave["output_angle"][-1] - 0.02 == pytest.approx(input_angle / RATIO - twist, rel=1e-3)


def test_a_command_that_is_known_beforehand_is_followed_before_it_turns() -> None:
    command = sw.scenario.sine(0.02, 4.0, 1.0, phase=-0.5 * np.pi, offset=0.02)
    options = {"error": ERROR, "effort": EFFORT}
    runs = [moved(sw.tuning.mpc(joint(), preview=preview, **options), command) for preview in (None, command)]
    error = [np.sqrt(np.mean((run["command"] - run["output_angle"])[2500:] ** 2)) for run in runs]
    assert error[1] < 0.5 * error[0]


@pytest.mark.parametrize("bad", [np.nan, -np.inf, 3e38])
def test_a_bad_sample_is_held_and_counted(bad: float) -> None:
    def pushed(fifth: float) -> tuple[list[float], int]:
        controller = sw.tuning.mpc(joint(), error=ERROR, effort=EFFORT)
        angles = 0.1 * np.sin(0.3 * np.arange(9))
        angles[5] = angles[4] if fifth == 0.0 else fifth
        return [
            controller(sw.simulation.Observation(1e-3 * k, 0.01, 0.0, 5.0, 0.0, float(angle), 0.0, 0.0, 0.0, -2.0, 2.0))
            for k, angle in enumerate(angles)
        ], controller.bad_samples

    held, count = pushed(0.0)
    assert pushed(bad) == (held, 1)
    assert count == 0


def test_a_second_run_begins_anew() -> None:
    controller = sw.tuning.mpc(joint(), error=ERROR, effort=EFFORT)
    first, second = moved(controller, STEP, push=5.0), moved(controller, STEP, push=5.0)
    assert np.abs(first["output_angle"] - second["output_angle"]).max() < 1e-7


MAIN = """
#include <stdio.h>
#include "predictive.h"
int main(void) {
    predictive_measured m;
    double angle[PREDICTIVE_HORIZON], rate[PREDICTIVE_HORIZON], command;
    int i;
    predictive_reset();
    while (scanf("%lf %lf %lf %lf %lf", &m.input_angle, &m.input_speed, &m.output_angle, &m.output_speed, &command) == 5) {
        for (i = 0; i < PREDICTIVE_HORIZON; ++i) {
            angle[i] = command;
            rate[i] = 0.0;
        }
        printf("%.17g\\n", predictive_step(&m, angle, rate));
    }
    return predictive_unsolved + (predictive_bad_samples != BAD);
}
"""


@pytest.mark.slow("tuning")
@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")
def test_its_c_gives_the_same_actuation(tmp_path: Path) -> None:
    """Within what the solver leaves open: its step size adapts in Python, and not in C."""
    controller = sw.tuning.mpc(joint(), delay=5e-4, error=ERROR, effort=EFFORT, torque_limit=LIMIT)
    lines: list[str] = []
    given: list[float] = []

    def recorded(seen: sw.simulation.Observation) -> float:
        known = (seen.input_angle, seen.input_speed, seen.output_angle, seen.output_speed, seen.command)
        lines.append(" ".join(map(repr, known)))
        given.append(controller(seen))
        return given[-1]

    def spoilt(seen: sw.simulation.Observation) -> float:
        """A sample in a hundred is lost."""
        return recorded(seen if round(seen.time / 1e-3) % 100 != 7 else seen._replace(output_speed=np.nan))

    sw.simulate_controlled(controller.drive, spoilt, STEP, period=1e-3, delay=5e-4, load_torque=3.0)
    folder = controller.generate_c(tmp_path / "predictive")
    (folder / "main.c").write_text(MAIN.replace("BAD", str(controller.bad_samples)), encoding="utf-8")
    sources = ["main.c", "predictive.c", "workspace.c", *(str(each) for each in (folder / "src").glob("*.c"))]
    include = ["-I.", "-Iinc/public", "-Iinc/private"]
    warned = subprocess.run(
        ["cc", "-std=c99", "-Wall", "-Wextra", "-pedantic", *include, "-c", "predictive.c", "-o", "predictive.o"],
        cwd=folder, capture_output=True, text=True, check=True,
    )  # fmt: skip
    assert "predictive.c" not in warned.stderr
    subprocess.run(["cc", "-O1", "-w", "-std=c99", *include, *sources, "-lm", "-o", "control"], cwd=folder, check=True)
    run = subprocess.run(["./control"], cwd=folder, input="\n".join(lines), capture_output=True, text=True, check=True)
    actuation = np.array(run.stdout.split(), dtype=float)
    assert actuation == pytest.approx(np.array(given), abs=0.01 * EFFORT)
    assert controller.bad_samples > 0


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"horizon": 0}, "horizon"),
        ({"torque_limit": 0.0}, "torque_limit"),
        ({"bandwidth": -1.0}, "bandwidth"),
        ({"delay": 2e-3}, "exceeds the period"),
    ],
)
def test_what_it_refuses(changes: dict[str, float], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        sw.tuning.mpc(joint(), **changes)  # type: ignore[arg-type]


def test_what_is_known_beforehand_is_a_scenario() -> None:
    with pytest.raises(TypeError, match=r"preview must be a scenario.*not 3\.0"):
        sw.tuning.mpc(joint(), preview=3.0)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"^preview: the scenario is in N\.m, and rad is expected"):
        sw.tuning.mpc(joint(), preview=sw.scenario.step("1 N.m", 1.0))


def test_a_run_with_another_period_than_that_of_the_design_is_refused() -> None:
    controller = sw.tuning.mpc(joint(), error=ERROR, effort=EFFORT)
    with pytest.raises(
        ValueError, match=r"called 0\.002 s after the last call.*a period of 0\.001 s; simulate it with period="
    ):
        sw.simulate_controlled(controller.drive, controller, STEP, period=2e-3)


def test_a_gear_with_bodies_of_its_own_is_refused() -> None:
    with pytest.raises(ValueError, match=r"structure\.windup.*take the lumped gear"):
        sw.tuning.mpc("tilt-actuator")
