"""Files of robot arms as people record them, with known truth, from plain NumPy that shares nothing with this package.

An arm of three joints, one about the vertical and two parallel ones that carry the arm, follows Fourier series or trapezoids.
Its motion is prescribed, and the torque of each motor follows from it: a robot with elastic joints is differentially flat
(De Luca 2000), so that nothing needs to be integrated but the bristles of the friction. `python -m tests.evidence.arms` writes
every file, identifies each, and prints its held-out error beside that of least squares as a specialist's script does them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

FINE = 4000.0  # Hz: rate of the motion
GRAVITY = 9.81
SLOW = 0.1  # rad/s: scripts leave out what is slower, as friction turns over there


@dataclass(frozen=True)
class Links:
    """Masses [kg], lengths [m] and inertias [kg.m2] of an arm that turns (1), lifts (2) and bends (3)."""

    base: float = 0.6
    masses: tuple[float, float] = (8.0, 4.0)
    length: float = 0.45
    centres: tuple[float, float] = (0.2, 0.18)
    inertias: tuple[float, float] = (0.16, 0.06)

    def torques(self, q: Array, dq: Array, ddq: Array) -> Array:
        """Of the joints, by Lagrange's equations in closed form, shape (3, n)."""
        (m2, m3), (r2, r3), (i2, i3), length = self.masses, self.centres, self.inertias, self.length
        lift, bend = q[1], q[1] + q[2]
        reach2, reach3 = r2 * np.cos(lift), length * np.cos(lift) + r3 * np.cos(bend)
        about = self.base + m2 * reach2**2 + i2 * np.cos(lift) ** 2 + m3 * reach3**2 + i3 * np.cos(bend) ** 2
        by_bend = -2.0 * m3 * reach3 * r3 * np.sin(bend) - i3 * np.sin(2.0 * bend)
        by_lift = -(m2 * r2**2 + i2) * np.sin(2.0 * lift) - 2.0 * m3 * reach3 * length * np.sin(lift) + by_bend
        across, own = m3 * length * r3, i3 + m3 * r3**2
        both = own + across * np.cos(q[2])
        turned = dq[0] ** 2
        first = about * ddq[0] + (by_lift * dq[1] + by_bend * dq[2]) * dq[0]
        weight = GRAVITY * m3 * r3 * np.cos(bend)
        second = (
            (i2 + m2 * r2**2 + m3 * length**2 + 2.0 * across * np.cos(q[2]) + own) * ddq[1] + both * ddq[2]
            - across * np.sin(q[2]) * (2.0 * dq[1] * dq[2] + dq[2] ** 2) - 0.5 * by_lift * turned
            + GRAVITY * (m2 * r2 + m3 * length) * np.cos(lift) + weight
        )  # fmt: skip
        third = both * ddq[1] + own * ddq[2] + across * np.sin(q[2]) * dq[1] ** 2 - 0.5 * by_bend * turned + weight
        return np.stack([first, second, third])


@dataclass(frozen=True)
class Joint:
    """Gear and motor of a joint, in SI units, friction at the motor."""

    ratio: float = 100.0
    stiffness: float = 2.0e4
    rotor: float = 4e-5
    coulomb: float = 0.06
    breakaway: float = 0.075
    stribeck_speed: float = 8.0
    viscous: float = 2.5e-4
    loss: float = 0.05  # of the torque that is transmitted
    bend: float = 0.05  # rad of the motor in which friction turns over
    ripple: Mapping[float, float] = field(default_factory=dict)  # torque at the motor by order per revolution of it
    torque_constant: float = 0.12

    def motor(self, q: Array, transmitted: Array) -> tuple[Array, Array]:
        """Angle of the motor, and its torque."""
        theta = self.ratio * (q + transmitted / self.stiffness)
        speed = np.gradient(theta, 1.0 / FINE)
        falling = self.coulomb + (self.breakaway - self.coulomb) * np.exp(-((speed / self.stribeck_speed) ** 2))
        bristles = _bristles(theta, self.bend)
        waves = sum((size * np.cos(order * theta + order) for order, size in self.ripple.items()), np.zeros_like(theta))
        lost = self.loss * np.abs(transmitted) / self.ratio * bristles
        torque = self.rotor * np.gradient(speed, 1.0 / FINE) + falling * bristles + self.viscous * speed + lost + waves
        return theta, torque + transmitted / self.ratio


def _bristles(theta: Array, bend: float) -> Array:
    """Friction over its level by Dahl's model: -1 to 1, with the angle behind each reversal."""
    found, now = np.empty_like(theta), 0.0
    for place, step in enumerate(np.diff(theta, prepend=theta[0]).tolist()):
        aim = 1.0 if step > 0.0 else -1.0
        now = aim + (now - aim) * np.exp(-abs(step) / bend) if step else now
        found[place] = now
    return found


@dataclass(frozen=True)
class Run:
    """What an arm did, on a fine grid: angles of joints and motors, torques of motors, and those that the gears transmit."""

    time: Array
    q: Array
    transmitted: Array
    theta: Array
    torque: Array
    joints: tuple[Joint, ...]


def run(joints: tuple[Joint, ...], command: Array, links: Links | None = None) -> Run:
    """An arm that follows commanded angles, shape (3, n), as a loop of 8 Hz does."""
    from scipy import signal

    q = signal.sosfiltfilt(signal.bessel(2, 8.0, fs=FINE, output="sos", norm="mag"), command, axis=-1)
    dq = np.gradient(q, 1.0 / FINE, axis=-1)
    transmitted = (links or Links()).torques(q, dq, np.gradient(dq, 1.0 / FINE, axis=-1))
    motors = [joint.motor(own, torque) for joint, own, torque in zip(joints, q, transmitted, strict=True)]
    return Run(
        np.arange(q.shape[1]) / FINE, q, transmitted, np.stack([m[0] for m in motors]), np.stack([m[1] for m in motors]), joints
    )


# ---- Motions ---------------------------------------------------------------------------------------------------------


def resting(seconds: float, at: tuple[float, float, float] = (0.3, -0.8, 0.9)) -> Array:
    return np.repeat(np.array(at)[:, np.newaxis], int(seconds * FINE), axis=1)


def fourier(seconds: float, moving: tuple[int, ...], seed: int, size: float = 0.9) -> Array:
    """Fourier series of five harmonics of a tenth of a hertz, as for the excitation of arms."""
    random, command = np.random.default_rng(seed), resting(seconds)
    time = np.arange(command.shape[1]) / FINE
    for joint in moving:
        shape = np.zeros_like(time)
        for harmonic in range(1, 6):
            shape += random.normal() / harmonic * np.sin(2.0 * np.pi * 0.1 * harmonic * time + random.uniform(0.0, 2.0 * np.pi))
        command[joint] += size * shape / np.abs(shape).max()
    return command


def trapezoids(seconds: float, joint: int, speeds: tuple[float, ...] = (0.1, 0.3, 0.7), size: float = 1.2) -> Array:
    """To and fro at one speed after another, with a rest of a second at each end."""
    command, parts = resting(seconds), [np.zeros(int(FINE))]
    place, turn = 0.0, 0
    while sum(map(len, parts)) < command.shape[1]:
        speed, way = speeds[(turn // 2) % len(speeds)], 1.0 if turn % 2 == 0 else -1.0
        parts += [place + way * np.arange(0.0, size, speed / FINE), np.full(int(FINE), place + way * size)]
        place, turn = place + way * size, turn + 1
    moved = np.concatenate(parts)[: command.shape[1]]
    width = int(0.25 * FINE)  # of a ramp of the speed
    command[joint] += np.convolve(np.pad(moved, width, mode="edge"), np.ones(width) / width, "same")[width:-width]
    return command


# ---- What is recorded ------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Recorder:
    """How it is sampled: rate [Hz], scatter of the instants [s], share of lost rows, steps of encoders [rad], delay [s]."""

    rate: float = 500.0
    jitter: float = 0.0
    lost: float = 0.0
    step: float = 5e-6
    speed_noise: float = 2e-3
    torque_noise: float = 0.03  # of its standard deviation
    delay: float = 0.0
    seed: int = 1

    def __call__(self, done: Run) -> dict[str, Array]:
        """Columns of all joints: `time`, and `q`, `dq`, `current`, `joint_torque` (of a sensor), `theta`, each (3, n)."""
        random = np.random.default_rng(self.seed)
        instants = np.arange(0.05, done.time[-1] - 0.05, 1.0 / self.rate)
        instants = instants[random.random(len(instants)) >= self.lost]
        true = np.sort(instants + self.jitter * random.uniform(-1.0, 1.0, len(instants)))

        def at(series: Array, when: Array = true) -> Array:
            return np.stack([np.interp(when, done.time, each) for each in series])

        def recorded(series: Array) -> Array:
            found = at(series, true - self.delay)
            noise = self.torque_noise * np.std(found, axis=1, keepdims=True)
            noisy: Array = found + noise * random.normal(size=found.shape)
            return noisy

        constants = np.array([joint.torque_constant for joint in done.joints])[:, np.newaxis]
        speed: Array = at(np.gradient(done.q, 1.0 / FINE, axis=-1))
        return {
            "time": true,
            "q": np.round(at(done.q) / self.step) * self.step,
            "dq": speed + self.speed_noise * random.normal(size=speed.shape),
            "current": recorded(done.torque / constants),
            "motor_torque": recorded(done.torque * np.array([joint.ratio for joint in done.joints])[:, np.newaxis]),
            "joint_torque": recorded(done.transmitted),
            "theta": at(done.theta),
        }


def _table(path: Path, header: str | None, columns: list[Array], delimiter: str = ",", form: str = "%.6f") -> None:
    np.savetxt(path, np.stack(columns, axis=1), form, delimiter, header=header or "", comments="")


def _six(series: Array) -> list[Array]:
    """Of a robot of six joints, of which the last three rest."""
    return [*series, *np.zeros_like(series)]


def rtde(path: Path, seen: Mapping[str, Array], delimiter: str = ",") -> None:
    """As Universal Robots' recorder writes: `timestamp actual_q_0 … actual_qd_0 … actual_current_0 …`."""
    names = [f"{name}_{joint}" for name in ("actual_q", "actual_qd", "actual_current", "target_q") for joint in range(6)]
    columns = [seen["time"] + 1194.987, *(each for name in ("q", "dq", "current", "q") for each in _six(seen[name]))]
    _table(path, delimiter.join(["timestamp", *names]), columns, delimiter)


def headerless(path: Path, seen: Mapping[str, Array]) -> None:
    """Time, angles, speeds, currents, commanded currents of six joints, four digits, no header."""
    columns = [seen["time"] + 1194.987, *(each for name in ("q", "dq", "current", "current") for each in _six(seen[name]))]
    _table(path, None, columns, form="%.4f")


def panda(path: Path, seen: Mapping[str, Array]) -> None:
    """As a program on libfranka writes: `time,q1,…,dq1,…,tau_J1,…,tau_J_d1`."""
    names = [f"{name}{joint}" for name in ("q", "dq", "tau_J", "tau_J_d") for joint in (1, 2, 3)]
    columns = [seen["time"], *seen["q"], *seen["dq"], *seen["motor_torque"], *seen["motor_torque"]]
    _table(path, ",".join(["time", *names]), columns)


def kinova(path: Path, seen: Mapping[str, Array]) -> None:
    """Time counted in samples; torques of a sensor, of the current and of a model; angles that are commanded."""
    names = ("Position", "Velocity", "Torque", "TorqueCur", "Temp", "Cur", "PositionCmptd")
    warm = 33.0 + 0.0 * seen["q"]
    series = (seen["q"], seen["dq"], seen["joint_torque"], seen["motor_torque"], warm, seen["current"], seen["q"])
    header = ",".join(["Time", *(f"{name}{joint}" for name in names for joint in (1, 2, 3))])
    _table(path, header, [np.arange(len(seen["time"])).astype(float), *(each for some in series for each in some)], form="%.6g")


def mat(path: Path, seen: Mapping[str, Array]) -> None:
    """Matrices by rows of joints, in radians."""
    from scipy.io import savemat

    savemat(path, {"t": seen["time"], "q": seen["q"].T, "qd": seen["dq"].T, "tau": seen["motor_torque"].T, "Ts": 0.002})


def npz(path: Path, seen: Mapping[str, Array]) -> None:
    np.savez(path, time=seen["time"], q=seen["q"].T, dq=seen["dq"].T, tau=seen["motor_torque"].T)


def npy(path: Path, seen: Mapping[str, Array]) -> None:
    """A matrix without names: time, angles, torques."""
    np.save(path, np.column_stack([seen["time"], seen["q"].T, seen["motor_torque"].T]))


def json_columns(path: Path, seen: Mapping[str, Array]) -> None:
    import json

    told = {"time": seen["time"].tolist(), "q": seen["q"].T.tolist(), "dq": seen["dq"].T.tolist()}
    path.write_text(json.dumps(told | {"tau": seen["motor_torque"].T.tolist()}))


def json_rows(path: Path, seen: Mapping[str, Array]) -> None:
    """A row for each sample, with lists of the joints."""
    import json

    rows = [
        {"timestamp": time, "position": q.tolist(), "velocity": dq.tolist(), "torque": torque.tolist()}
        for time, q, dq, torque in zip(seen["time"], seen["q"].T, seen["dq"].T, seen["motor_torque"].T, strict=True)
    ]
    path.write_text("\n".join(map(json.dumps, rows)))


def log_text(path: Path, seen: Mapping[str, Array]) -> None:
    """Comments above the header, and one of another sort."""
    names = ["t", *(f"{name}{joint}" for name in ("q", "qd", "u") for joint in (1, 2, 3))]
    rows = [seen["time"], *seen["q"], *seen["dq"], *seen["motor_torque"]]
    _table(path, " ".join(names), rows, " ")
    path.write_text("% recorded 2024-03-01, arm 7\n% u in Nm\n" + path.read_text())


def hand_driven(path: Path, seen: Mapping[str, Array]) -> None:
    """Angle of the joint in degrees, torque of the sensor, without time, as from a script on a bench."""
    from scipy.io import savemat

    savemat(path, {"angle_deg": np.degrees(seen["q"][1]), "torque": seen["joint_torque"][1], "fs": 200.0})


def constant_speed(path: Path, done: Run, joint: int, rate: float, seed: int = 3) -> None:
    """Current at one speed, with the speed but no time."""
    seen = Recorder(rate=rate, seed=seed)(done)
    _table(path, "velocity [rad/s],current [A]", [seen["dq"][joint], seen["current"][joint]])


def joint_states(path: Path, seen: Mapping[str, Array]) -> None:
    """A bag of the second version in one MCAP file, with the states of the joints."""
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    state, header, stamp = (
        store.types[name] for name in ("sensor_msgs/msg/JointState", "std_msgs/msg/Header", "builtin_interfaces/msg/Time")
    )
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        topic = writer.add_connection("/joint_states", state.__msgtype__, typestore=store)
        for when, q, dq, torque in zip(seen["time"], seen["q"].T, seen["dq"].T, seen["motor_torque"].T, strict=True):
            nanoseconds = int((1.7e9 + when) * 1e9)
            at = header(stamp=stamp(sec=nanoseconds // 10**9, nanosec=nanoseconds % 10**9), frame_id="")
            names = ["shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint"]
            message = state(header=at, name=names, position=q.copy(), velocity=dq.copy(), effort=torque.copy())
            writer.write(topic, nanoseconds, store.serialize_cdr(message, state.__msgtype__))


# ---- Least squares as a specialist's script does them ----------------------------------------------------------------


def least_squares(seen: Mapping[str, Array], joint: int, effort: str, links: bool = False) -> float:
    """Error held out over what varies, of the torque of a joint by inertia, friction and gravity in a band of 5 Hz.

    Times are made even, angles filtered without phase shift and differentiated, slow motion is left out, and every second of
    ten blocks of time held out. With `links` the lengths and axes of the arm are known, and its base parameters are fitted:
    that is what identification of whole arms does, with a model that this package has not.
    """
    from scipy import signal

    time = np.arange(seen["time"][0], seen["time"][-1], float(np.median(np.diff(seen["time"]))))
    rate = 1.0 / (time[1] - time[0])
    low_pass = signal.butter(4, 5.0, fs=rate, output="sos")

    def even(series: Array) -> Array:
        filtered: Array = signal.sosfiltfilt(low_pass, np.interp(time, seen["time"], series))
        return filtered

    q = np.stack([even(each) for each in seen["q"]])
    dq = np.gradient(q, 1.0 / rate, axis=-1)
    ddq = np.gradient(dq, 1.0 / rate, axis=-1)
    own, speed = q[joint], dq[joint]
    columns = [ddq[joint], speed, np.sign(speed), np.ones_like(own), np.sin(own), np.cos(own)]
    if links:
        none = Links(base=0.0, masses=(0.0, 0.0), inertias=(0.0, 0.0))
        units = [replace(none, base=1.0), replace(none, inertias=(1.0, 0.0)), replace(none, inertias=(0.0, 1.0))]
        units += [replace(none, masses=(1.0, 0.0)), replace(none, masses=(0.0, 1.0))]
        columns = columns[:4] + [unit.torques(q, dq, ddq)[joint] for unit in units]
    matrix = np.stack([signal.sosfiltfilt(low_pass, column) for column in columns], axis=1)
    torque = signal.sosfiltfilt(low_pass, even(seen[effort][joint]))
    block = (10.0 * np.arange(len(time)) / len(time)).astype(int)
    moves = np.abs(speed) > SLOW
    train, held = moves & (block % 2 == 0), moves & (block % 2 == 1)
    shares = np.linalg.lstsq(matrix[train], torque[train], rcond=1e-10)[0]
    return float(np.sqrt(np.mean((torque[held] - matrix[held] @ shares) ** 2)) / np.std(torque[held]))


@dataclass(frozen=True)
class Sort:
    """A sort of file: how it is written and recorded, and what a person must say to have one joint of it identified."""

    write: Callable[[Path, Mapping[str, Array]], None]
    name: str
    recorder: Recorder
    effort: str
    motion: str = "one joint"
    said: Mapping[str, Any] = field(default_factory=dict)


SECOND = {"joint": "2"}
BY_NUMBER = {"columns": {"time": "1", "output_angle": "3", "output_speed": "9", "current": "15"}}
SORTS = (
    Sort(rtde, "rtde.csv", Recorder(rate=125.0, jitter=2e-3, lost=0.01), "current", said={"joint": "1"}),
    Sort(headerless, "headerless.csv", Recorder(rate=95.0, jitter=1e-3, step=1e-4), "current", said=BY_NUMBER),
    Sort(panda, "panda.csv", Recorder(rate=1000.0), "motor_torque", said=SECOND),
    Sort(kinova, "kinova.csv", Recorder(rate=1000.0), "current", "trapezoids", SECOND | {"columns": {"current": "Cur2"}}),
    Sort(mat, "matrices.mat", Recorder(rate=500.0), "motor_torque", said=SECOND),
    Sort(hand_driven, "hand.mat", Recorder(rate=200.0), "joint_torque", said={"side": "output"}),
    Sort(json_rows, "rows.jsonl", Recorder(rate=200.0, delay=8e-3), "motor_torque", said=SECOND),
    Sort(joint_states, "bag", Recorder(rate=200.0, jitter=5e-4), "motor_torque", said={"joint": "shoulder_lift_joint"}),
    Sort(rtde, "rtde_all.csv", Recorder(rate=500.0, jitter=2e-4), "current", "all joints", {"joint": "1"}),
    Sort(panda, "panda_all.csv", Recorder(rate=1000.0), "motor_torque", "all joints", SECOND),
    Sort(headerless, "headerless_all.csv", Recorder(rate=95.0, jitter=1e-3, step=1e-4), "current", "all joints",
         {"columns": {**BY_NUMBER["columns"], "other_angles": "2,4"}}),
)  # fmt: skip


def done_by(motion: str, seconds: float, seed: int = 1) -> Run:
    """What an arm with ripple did."""
    joint = Joint(ripple={2.0: 0.006, 4.0: 0.002})
    commands = {
        "one joint": lambda: fourier(seconds, (1,), seed),
        "trapezoids": lambda: trapezoids(seconds, 1),
        "all joints": lambda: fourier(seconds, (0, 1, 2), seed),
    }
    return run((joint,) * 3, commands[motion]())


def compared(sort: Sort, folder: Path, seconds: float) -> tuple[float, float, float]:
    """Errors held out: of this package, of least squares of one joint, and of those with a model of the arm."""
    from strainwave.identification.identify import identify
    from strainwave.identification.reading.mapping import FileMapping

    seen = sort.recorder(done_by(sort.motion, seconds))
    sort.write(folder / sort.name, seen)
    (finding,) = identify("hfuc-25-100", [folder / sort.name], mapping=lambda path: FileMapping(**sort.said)).files
    in_band = float("nan") if finding.held_out is None else finding.held_out.in_band
    return in_band, least_squares(seen, 1, sort.effort), least_squares(seen, 1, sort.effort, links=True)


def main() -> None:
    import sys
    import tempfile

    print(
        f"{'file':20} {'motion':11} {'identify':>9} {'least squares':>14} {'with model':>11}   (error held out, of the signal)"
    )
    with tempfile.TemporaryDirectory() as folder:
        for sort in SORTS:
            ours, simple, arm = compared(sort, Path(folder), float(sys.argv[1]) if len(sys.argv) > 1 else 40.0)
            print(f"{sort.name:20} {sort.motion:11} {ours:9.2%} {simple:14.2%} {arm:11.2%}", flush=True)


if __name__ == "__main__":
    main()
