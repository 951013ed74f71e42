"""Folders of data sets: hash-equal however often workers and command are killed, and described in full."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np
import pandas
import pytest
from strainwave.dataset import runners
from strainwave.dataset.folder import DatasetFolder
from strainwave.dataset.make import make
from strainwave.dataset.plan import DatasetPlan

from tests.python.command import refused, strainwave
from tests.python.dataset.plans import SMALL, changed, population, write

MANY = changed(units=SMALL["units"] | {"number": 96}, shard_members=24, samples={"columns": ["current"], "every": 10})
MAX_WAIT = 120.0  # s


def hashes(folder: Path) -> dict[str, str]:
    files = (path for path in sorted(folder.rglob("*")) if path.is_file())
    return {f"{path.relative_to(folder)}": sha256(path.read_bytes()).hexdigest() for path in files}


def children(process: int) -> list[int]:
    """The processes that a process began, by /proc: a bare machine has no ps."""
    found = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):  # it has ended
            parent = stat.read_text().rpartition(")")[2].split()[1]
            found += [int(stat.parent.name)] if int(parent) == process else []
    return found


def start(plan: Path, folder: Path) -> subprocess.Popen[bytes]:
    flags = ["-S"] if sys.flags.no_site else []
    command = [sys.executable, *flags, "-m", "strainwave", "dataset", "make", f"{plan}", "--out", f"{folder}", "--workers", "2"]
    return subprocess.Popen(command, stderr=subprocess.PIPE, stdout=subprocess.PIPE)


def wait_for(process: subprocess.Popen[bytes], folder: Path, shards: int) -> None:
    """Wait until so many shards are there."""
    begin = time.monotonic()
    while DatasetFolder(folder).done() < shards:
        assert process.poll() is None, process.communicate()
        assert time.monotonic() - begin < MAX_WAIT
        time.sleep(0.01)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A plan, and its data set made without interruption."""
    place = tmp_path_factory.mktemp("whole")
    plan = write(place, MANY)
    return plan, make(plan, place / "set", workers=1)


@pytest.mark.slow("dataset")
def test_killed_workers_and_commands_leave_an_equal_data_set(whole: tuple[Path, Path], tmp_path: Path) -> None:
    plan, reference = whole
    folder = tmp_path / "set"
    process = start(plan, folder)
    wait_for(process, folder, 2)
    os.kill(children(process.pid)[0], signal.SIGKILL)
    wait_for(process, folder, 5)
    process.kill()
    process.communicate()
    assert not (folder / "SHA256SUMS").exists()
    process = start(plan, folder)
    wait_for(process, folder, 9)
    os.kill(children(process.pid)[-1], signal.SIGKILL)
    out, errors = process.communicate(timeout=MAX_WAIT)
    assert process.returncode == 0, errors
    assert out.decode().startswith("wrote ")
    assert hashes(folder) == hashes(reference)


@pytest.mark.whole_path("dataset")
def test_a_data_set_leaves_no_temporary_files(whole: tuple[Path, Path]) -> None:
    names = {path.name for path in whole[1].iterdir()}
    assert names == {"SHA256SUMS", "card.md", "manifest.json", "plan.toml", "samples", "shards"}
    assert (
        len(list((whole[1] / "shards").iterdir())) == len(list((whole[1] / "samples").iterdir())) == DatasetPlan.of(MANY).shards
    )


@pytest.mark.whole_path("dataset")
def test_the_sums_are_those_of_the_files(whole: tuple[Path, Path]) -> None:
    """Each line is the digest, two spaces and the name, as sha256sum writes and checks it."""
    lines = [line.split("  ", 1) for line in (whole[1] / "SHA256SUMS").read_text().splitlines()]
    assert {name: digest for digest, name in lines} == {
        name: digest for name, digest in hashes(whole[1]).items() if name != "SHA256SUMS"
    }


@pytest.mark.slow("dataset")
def test_drafts_of_killed_workers_are_removed(whole: tuple[Path, Path], tmp_path: Path) -> None:
    plan, reference = whole
    folder = tmp_path / "set"
    make(plan, folder, workers=1)
    for name in ("shards/.strainwave-left", "shards/shard-000003.parquet", "SHA256SUMS"):
        (folder / name).write_bytes(b"partial") if "left" in name else (folder / name).unlink()
    make(plan, folder, workers=1)
    assert hashes(folder) == hashes(reference)


@pytest.mark.whole_path("dataset")
def test_pandas_reads_labels_parameters_and_features(whole: tuple[Path, Path]) -> None:
    frame = pandas.read_parquet(whole[1] / "shards")
    plan = DatasetPlan.of(MANY)
    assert frame["member"].tolist() == list(range(plan.members))
    assert frame["failure"].isna().all()
    assert frame["current_rms"].notna().all()
    samples = pandas.read_parquet(whole[1] / "samples")
    assert np.stack(samples["current"].to_list()).shape == (plan.members, 6)


@pytest.mark.whole_path("dataset")
def test_the_manifest_has_unit_and_role_of_each_column_and_the_source_of_each_parameter(whole: tuple[Path, Path]) -> None:
    content = json.loads((whole[1] / "manifest.json").read_text())
    frame = pandas.read_parquet(whole[1] / "shards")
    columns = {column["name"]: column for column in content["columns"]}
    assert list(columns) == list(frame.columns)
    assert columns["motor.resistance"]["unit"] == "Ohm"
    assert "maxon" in columns["motor.resistance"]["source"]
    assert columns["current_rms"]["unit"] == "A"
    assert columns["split_unit"]["role"] == "split"
    assert content["plan_digest"] == DatasetPlan.of(MANY).digest
    assert {"strainwave", "numpy", "scipy", "pyarrow", "python"} <= set(content["versions"])


@pytest.mark.whole_path("dataset")
def test_the_card_names_every_column_and_what_limits_the_data(whole: tuple[Path, Path]) -> None:
    text = (whole[1] / "card.md").read_text()
    for name in pandas.read_parquet(whole[1] / "shards").columns:
        assert f"| `{name}` |" in text
    assert "Licence: not stated." in text
    assert "No run was measured." in text


@pytest.mark.whole_path("dataset")
def test_another_plan_is_refused_in_the_same_folder(whole: tuple[Path, Path], tmp_path: Path) -> None:
    before = hashes(whole[1])
    with pytest.raises(FileExistsError, match=r"has the data set of another plan \(Small\); take another folder"):
        make(write(tmp_path, MANY | {"seed": 6}), whole[1])
    assert hashes(whole[1]) == before


def test_a_file_in_place_of_the_folder_is_refused(tmp_path: Path) -> None:
    (tmp_path / "data").write_text("mine")
    with pytest.raises(FileExistsError, match="data is a file where a folder is to be made; give another name"):
        make(write(tmp_path, SMALL), tmp_path / "data")
    assert (tmp_path / "data").read_text() == "mine"


def test_a_folder_with_other_files_is_refused(tmp_path: Path) -> None:
    plan = write(tmp_path, SMALL)
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "mine.txt").write_text("mine")
    with pytest.raises(FileExistsError, match="is not empty"):
        make(plan, tmp_path / "other")
    assert hashes(tmp_path / "other").keys() == {"mine.txt"}


def test_a_shard_is_locked_while_another_makes_it(tmp_path: Path) -> None:
    """Locks are of processes, so another process tries."""
    code = "import sys; from pathlib import Path; from strainwave.dataset.folder import DatasetFolder\n"
    code += "for number in (3, 4):\n    with DatasetFolder(Path(sys.argv[1])).lock(number) as mine: print(mine)"
    flags = ["-S"] if sys.flags.no_site else []
    with DatasetFolder(tmp_path).lock(3) as mine:
        done = subprocess.run([sys.executable, *flags, "-c", code, f"{tmp_path}"], capture_output=True, text=True)
    assert mine
    assert done.stdout.split() == ["False", "True"], done.stderr


def test_workers_that_die_again_and_again_end_the_command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(runners, "worker_command", lambda path: [sys.executable, "-c", "import os; os.kill(os.getpid(), 9)"])
    with pytest.raises(RuntimeError, match="6 workers ended in succession without a shard, the last with code -9"):
        make(write(tmp_path), tmp_path / "set", workers=1)


def test_a_worker_that_is_refused_ends_the_command_with_its_reason(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    code = "import sys; print('strainwave: the disk is full', file=sys.stderr); sys.exit(2)"
    monkeypatch.setattr(runners, "worker_command", lambda path: [sys.executable, "-c", code])
    with pytest.raises(OSError, match="a worker stopped: the disk is full"):
        make(write(tmp_path), tmp_path / "set", workers=1)


@pytest.mark.slow("dataset")
def test_the_script_of_a_caller_is_not_run_again(tmp_path: Path) -> None:
    """No guard of __main__: workers run nothing of the script."""
    write(tmp_path)
    script = tmp_path / "script.py"
    script.write_text("print('once')\nfrom strainwave.dataset.make import make\nmake('plan.toml', 'set', workers=2)\n")
    (tmp_path / "numpy.py").write_text("raise SystemExit('a file of the folder was imported')")  # beside the script alone
    flags = ["-S", "-P"] if sys.flags.no_site else ["-P"]
    done = subprocess.run([sys.executable, *flags, script.name], cwd=tmp_path, capture_output=True, text=True)
    assert done.stdout == "once\n", done.stderr
    assert DatasetFolder(tmp_path / "set").is_finished


# Slurm


@pytest.mark.slow("dataset")
def test_a_slurm_array_makes_an_equal_data_set(whole: tuple[Path, Path], tmp_path: Path) -> None:
    plan, reference = whole
    folder = tmp_path / "a set"
    script = make(plan, folder, runner="slurm", workers=2)
    text = script.read_text()
    assert "#SBATCH --array=0-1\n" in text
    tasks = [
        subprocess.Popen(["bash", f"{script}"], env=os.environ | {"SLURM_ARRAY_TASK_ID": f"{number}"}) for number in range(2)
    ]
    assert [task.wait(MAX_WAIT) for task in tasks] == [0, 0]
    script.unlink()
    assert hashes(folder) == hashes(reference)


# The command


def test_the_estimate_is_shown_without_a_data_set(tmp_path: Path) -> None:
    plan = write(tmp_path)
    result = strainwave("dataset", "estimate", plan, "--workers", 2, folder=tmp_path)
    assert result.returncode == 0, result.stderr
    lines = dict(line.split(maxsplit=1) for line in result.stdout.splitlines()[1:])
    assert lines["members"] == "48"
    assert lines["shards"] == "8 of at most 8 members"
    assert "bytes a member" in lines["disk"]
    assert "us a member" in lines["time"]
    assert [path.name for path in tmp_path.iterdir()] == ["plan.toml"]


def test_one_member_is_made_alone(tmp_path: Path) -> None:
    plan = write(tmp_path)
    result = strainwave("dataset", "member", plan, 17, "--out", "one.parquet", folder=tmp_path)
    assert result.returncode == 0, result.stderr
    assert "member  17\nunit  5\n" in result.stdout
    (series,) = pandas.read_parquet(tmp_path / "one.parquet")["current"]
    assert len(series) == 51


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["make"], "Missing argument 'plan'"),
        (["make", "plan.toml"], "Missing option '--out'"),
        (["make", "none.toml", "--out", "x"], "none.toml: cannot be read"),
        (["member", "plan.toml", "48"], "must lie in [0, 47]"),
        (["make", "plan.toml", "--out", "x", "--runner", "cloud"], "must be one of local, dask, slurm"),
        (["make", "plan.toml", "--out", "x", "--workers", "0"], "--workers 0 must be at least 1"),
        (["work", "none"], "has no plan.toml"),
        (["work", ".", "--part", "4/4"], "write it as --part 0/4"),
    ],
)
def test_a_wrong_command_is_refused(tmp_path: Path, arguments: list[str], said: str) -> None:
    write(tmp_path)
    refused(tmp_path, ["dataset", *arguments], said)


# Dask


@pytest.mark.slow("dataset")
def test_dask_makes_an_equal_data_set_though_workers_are_killed(whole: tuple[Path, Path], tmp_path: Path) -> None:
    distributed = pytest.importorskip("distributed")
    plan, reference = whole
    folder = tmp_path / "set"
    lines: list[str] = []
    with distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None, silence_logs=50
    ) as cluster:
        killed: set[int] = set()

        def kill(line: str, share: float) -> None:
            lines.append(line)
            if len(killed) < 2:
                alive = [nanny.pid for nanny in cluster.workers.values() if nanny.pid]  # none while a nanny starts another
                for worker in [each for each in alive if each not in killed][:1]:
                    killed.add(worker)
                    os.kill(worker, signal.SIGKILL)

        runners_seconds, runners.PROGRESS_SECONDS = runners.PROGRESS_SECONDS, 0.0
        try:
            make(plan, folder, runner="dask", scheduler=cluster.scheduler_address, progress=kill)
        finally:
            runners.PROGRESS_SECONDS = runners_seconds
    assert len(killed) == 2
    assert hashes(folder) == hashes(reference)


@pytest.mark.slow("dataset")
def test_dask_without_an_address_is_refused(tmp_path: Path) -> None:
    pytest.importorskip("distributed")
    with pytest.raises(ValueError, match="needs the address of a scheduler"):
        make(write(tmp_path), tmp_path / "set", runner="dask")


def test_the_parent_of_a_worker_is_gone_so_it_ends(tmp_path: Path) -> None:
    plan: Any = DatasetPlan.of(SMALL)
    folder = DatasetFolder(tmp_path)
    write(tmp_path)
    (tmp_path / "shards").mkdir()
    assert runners.work(tmp_path, parent=1 if os.getppid() != 1 else 2) == 0
    assert folder.done() == 0 < plan.shards
    assert population(SMALL).plan == plan
