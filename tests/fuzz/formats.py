"""MAT, MDF and bag files with bytes changed, and text tables that may be measurements of any kind."""

from __future__ import annotations

import io
import tempfile
from functools import cache
from pathlib import Path

import numpy as np
import strainwave as sw
from numpy.random import Generator
from strainwave.files.tables import open_table
from strainwave.identification.reading.mapping import FileMapping
from strainwave.identification.reading.recognise import Recognised, recognise

from tests.fuzz.laws import Case, described, finite
from tests.fuzz.mutation import encoded, mutated, mutated_bytes, picked

WORDS = (
    "time [s]", "t", "Zeit (ms)", "speed [rpm]", "Drehzahl [1/min]", "torque [N.m]", "tau", "q", "dq", "q1", "q2", "rpm",
    "counts", "motor_angle [deg]", "link_angle [deg]", "current [A]", "voltage [V]", "command [deg]", "twist [arcmin]", "J3",
    "position", "1970-01-01T00:00:00Z", "2026-02-31 25:00", "nan", "", "1e300", "-1e300", "1e-320", "360", "16384", "# t q",
)  # fmt: skip
HEADERS = (
    "time [s],command [deg],current [A],motor_angle [deg]", "t,q,dq,tau", "rpm,torque [mNm]", "twist [arcmin],torque [N.m]",
    "Zeit,Drehzahl [1/min],Strom [A]", "input_angle [deg],input_torque [N.m]", "motor [deg],link [deg]", "time_s,torque_Nm",
    "time [s],q1,q2,tau1,tau2", "1,2,3", "t [ms],theta_m,i", "1,2,3,4,5,6,7", "t [ms],q [deg],t [ms],tau [Nm]",
    "Name,Joint.ActPos,Joint.ActTorque\nSampleTime[ms],1,1\nUnit,deg,Nm", "time [s],q [inc],torque [‰]",
    "speed [rpm],torque [Nm],output torque [Nm]", "t,Position1,Velocity1,Torque1,TorqueCur1,Cur1",
    "time [s],motor_angle,link_angle,motor_torque",
)  # fmt: skip
PAIRS = (("t", "q", "tau"), ("time", "position", "velocity", "effort"), ("speed", "current", "i_max"), ("t", "t", "q"), ("q",))
LAYOUTS = (  # of a pair, what stands between pairs, and around a sample
    ("{}: {:.6g}", ", ", "", ""), ("{} = {:.4g} rad", "; ", "7, ", ""), ('"{}": {:.9g}', ", ", "{", "}"),
    ("{}:\n- {:.5g}", "\n", "header:\n  seq: 3\n", "\n---"), ("{}={:.3g}", " ", "[INFO] ", ""),
)  # fmt: skip
PAIR_WORDS = (
    *WORDS,
    "---",
    "name:\n- elbow",
    "{",
    "}",
    ":",
    "=",
    "t: 1, t: 2",
    '"q": [1, 2]',
    "inf",
    "q: rad",
    "[INFO]",
    "1:2:3",
)
SCALES = (*8 * (1.0,), 1e-300, 1e-3, 1e3, 1e150, 1e300)
SUFFIXES = ("mat", "73.mat", "mf4", "bag", "mcap")


def recognised_case(random: Generator, folder: Path) -> Case:
    """A text table with words of measurements, and perhaps something said of it."""
    header = picked(random, HEADERS)
    count, rows = header.split("\n")[0].count(",") + 1, int(random.integers(1, 60))
    table = np.cumsum(random.normal(size=(rows, count)), axis=0) * picked(random, SCALES)
    table[:, 0] = picked(random, (np.arange(rows) * 0.01, table[:, 0], np.round(table[:, 0], 1), np.zeros(rows)))
    text = "\n".join([header, *(",".join(f"{value:.{random.integers(2, 10)}g}" for value in row) for row in table)])
    data = encoded(mutated(text, random, WORDS), random)
    path = folder / f"{picked(random, ('log', 'joint_1', 'q2_run', 'tau_20rpm'))}{picked(random, ('.csv', '.txt', '.t'))}"
    path.write_bytes(data)
    said = picked(
        random,
        (
            FileMapping(),
            FileMapping(side="output"),
            FileMapping(constants={"rate": 100.0}),
            FileMapping(joint="1"),
            FileMapping(kind="friction"),
            FileMapping(columns={"joint_torque": "block3"}),
            FileMapping(units={"torque": "permille of 0.4 N.m", "angle": "counts/4096"}),
            FileMapping(kind="log", columns={"time": "1", "input_angle": "2", "current": "3"}),
            FileMapping(units={"time": "ms"}),
        ),
    )
    return Case(f"{said} {described(data)}", lambda: recognise(path, said), lambda found: _check(found, path, said))


def pairs_case(random: Generator, folder: Path) -> Case:
    """A text of pairs of a name and a number: a line of them for each sample, JSON lines, or blocks of an echoed topic."""
    names, rows = picked(random, PAIRS), int(random.integers(1, 40))
    table = np.cumsum(random.normal(size=(rows, len(names))), axis=0) * picked(random, SCALES)
    table[:, 0] = np.arange(rows) * 0.01
    form, between, begin, end = picked(random, LAYOUTS)
    lines = [begin + between.join(form.format(*pair) for pair in zip(names, row, strict=True)) + end for row in table]
    data = encoded(mutated("\n".join(lines), random, PAIR_WORDS), random)
    path = folder / f"log{picked(random, ('.txt', '.log', '.csv'))}"
    path.write_bytes(data)
    said = picked(random, (FileMapping(), FileMapping(units={"joint_torque": "N.m"}), FileMapping(constants={"rate": 100.0})))
    return Case(f"{said} {described(data)}", lambda: recognise(path, said), lambda found: _check(found, path, said))


def formats_case(random: Generator, folder: Path) -> Case:
    """A file of a format that is read by a library, with some bytes changed."""
    suffix = picked(random, SUFFIXES)
    data = mutated_bytes(_whole(suffix), random)
    path = folder / f"log.{suffix}"
    path.write_bytes(data)

    def attempt() -> sw.Recording | Recognised:
        open_table(path)
        return recognise(path, FileMapping(units={"t": "s"} if "mat" in suffix else {}))

    return Case(f"{suffix} {described(data)}", attempt, lambda found: _check(found, path, None))


def _check(found: Recognised, path: Path, said: FileMapping | None) -> None:
    assert finite(found.recording), "a number that is not finite"
    known = {*found.columns, *found.neighbours.values(), "time"}
    assert known >= set(found.recording.names), "a channel of no column"
    assert found.why, "no word of why"
    assert all(line.isprintable() for line in (*found.why, *found.remarks)), "words that a terminal would obey"
    if said is not None:
        assert recognise(path, said).recording == found.recording, "the same file gives another recording"


@cache
def _whole(suffix: str) -> bytes:
    """A file as it should be, as bytes."""
    from scipy.io import savemat

    from tests.python.files.test_formats import save_bag, save_hdf5, save_mdf

    time = np.arange(60) * 0.01
    series = {"t": time, "q": np.sin(time), "tau": np.cos(time)}
    if suffix == "mat":
        buffer = io.BytesIO()
        savemat(buffer, {"data": series, "kp": 3.0}, do_compression=True)
        return buffer.getvalue()
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "log")
        if suffix == "73.mat":
            save_hdf5(path, series)
        elif suffix == "mf4":
            save_mdf(path.with_suffix(".mf4"), {"q": (series["q"], "rad"), "tau": (series["tau"], "Nm")}, times=[time])
            path = path.with_suffix(".mf4")
        elif suffix == "bag":
            save_bag(path, "rosbag", time, series["q"])
        else:
            (path,) = save_bag(path, "mcap", time, series["q"]).glob("*.mcap")
        return path.read_bytes()
