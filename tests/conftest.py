"""What holds for all tests."""

import gc
import os
import signal
import time
from collections.abc import Generator, Iterator
from pathlib import Path

import pytest
import strainwave
from _pytest.runner import runtestprotocol
from hypothesis import settings
from hypothesis.internal.conjecture import providers
from strainwave.native import kernels

# Before anything imports numpy, and for the processes of tests too: beside other workers, threads of BLAS wait for each other,
# and take up to five times the processor time of one.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# For the processes of tests too: kernels are kept between runs of the tests, and never among the user's.
os.environ.setdefault("STRAINWAVE_KERNELS", str(Path(__file__).parents[1] / "build" / "test-kernels"))

# How long an example takes says more about the machine than about the example. The examples are the same on each run, so that a
# failure tells of the change and not of the draw; `--hypothesis-profile=explore` draws others, and takes the whole of samples.
settings.register_profile("strainwave", deadline=None, derandomize=True, max_examples=40)
settings.register_profile("explore", deadline=None, derandomize=False, max_examples=100)
settings.load_profile("strainwave")

# Hypothesis also draws the constants in the sources of all modules that a process has imported. Which those are depends on the
# tests that a worker ran before, and examples would.
providers._get_local_constants = lambda: providers._local_constants


@pytest.fixture(autouse=True)
def nothing_remembered() -> Iterator[None]:
    """Each test begins as a new process does: no drive has taken a step."""
    yield
    kernels.forget_work()


@pytest.fixture
def kept_builds(monkeypatch: pytest.MonkeyPatch) -> None:
    """Shared objects that the package compiles in this process are those of an earlier run if nothing of them has changed."""
    from tests.support.kept import keep_builds

    keep_builds(monkeypatch)


def pytest_configure() -> None:
    """What is compiled to be checked must be what is imported, or the check is of nothing. Interrupts are heeded.

    A shell that runs the tests in the background lets them, and all that they start, ignore interrupts.
    """
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    wanted, found = os.environ.get("STRAINWAVE_IS_IN"), Path(strainwave.__file__)
    if wanted and not found.is_relative_to(wanted):
        raise pytest.UsageError(f"the tests are to be of the package in {wanted}, not of {found}")


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Tests and modules live as long as the process: the garbage collector looks neither while they are made nor through them.

    Each of its full passes over nine thousand tests would take 0.3 s.
    """
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()
        gc.freeze()


# ---- Two tiers of tests, by the processor time of each with the processes that it starts -----------------------------------

# A file that the main process of a run writes; workers, and pytest run by a test, find no such variable and write nothing.
TIMES = os.environ.pop("STRAINWAVE_TEST_TIMES", "")
MAX_FAST_SECONDS = 0.5  # processor time of a test without a mark, on the machine of CALIBRATION_SECONDS
MAX_SCATTER = 1.25  # time of a test over that of another run of it, on a machine that other work shares
CALIBRATION_SECONDS = 0.012  # processor time of the calibration on an AMD EPYC of 2024
MARKS = ("slow", "whole_path")  # of tests that may take longer; only those of the second kind run in the fast tier
ROOMS = (
    *("physics", "native", "simulation", "analysis", "orders", "files", "identification", "tuning", "diagnose", "dataset"),
    *("export", "rig", "report", "commands", "docs", "papers", "build"),
)
BEGIN = pytest.StashKey[float]()
spent: dict[str, float] = {}  # s


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Raise UsageError for a mark that does not name a room."""
    for item in items:
        for mark in (*item.iter_markers("slow"), *item.iter_markers("whole_path")):
            if len(mark.args) != 1 or mark.args[0] not in ROOMS:
                raise pytest.UsageError(f"{item.nodeid}: {mark.name}{mark.args} must name one of the rooms {', '.join(ROOMS)}")


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_protocol(item: pytest.Item, nextitem: pytest.Item | None) -> bool:
    """Run a test. Without a mark, one that takes too long is repeated with its fixtures, and fails if it does so again.

    The first run may have imported packages, compiled kernels or filled caches for all that follow.
    """
    item.ihook.pytest_runtest_logstart(nodeid=item.nodeid, location=item.location)
    reports = timed_reports(item, nextitem)
    if is_too_long(item, reports):
        item.session._setupstate.teardown_exact(None)
        reports = timed_reports(item, nextitem)
        if is_too_long(item, reports):
            reports[1].outcome = "failed"
            reports[1].longrepr = (
                f"takes {cost(reports):.2f} s of the processor twice, more than {MAX_FAST_SECONDS} s times {slowness():.1f} "
                "for this machine: make it cheaper, or mark it @pytest.mark.slow(ROOM)"
            )
    for report in reports:
        item.ihook.pytest_runtest_logreport(report=report)
    item.ihook.pytest_runtest_logfinish(nodeid=item.nodeid, location=item.location)
    return True


def timed_reports(item: pytest.Item, nextitem: pytest.Item | None) -> list[pytest.TestReport]:
    """Run a test and return its reports, each with the processor time since its begin."""
    item.stash[BEGIN] = processor_time()
    return runtestprotocol(item, log=False, nextitem=nextitem)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    report = yield
    report.processor_time = processor_time() - item.stash[BEGIN]  # type: ignore[attr-defined]
    return report


def is_too_long(item: pytest.Item, reports: list[pytest.TestReport]) -> bool:
    """True for a test that passes without a mark, and takes longer than the fast tier allows on this machine."""
    passed = len(reports) == 3 and all(report.passed for report in reports)
    marked = any(item.get_closest_marker(mark) for mark in MARKS)
    limit = MAX_FAST_SECONDS * MAX_SCATTER
    return passed and not marked and cost(reports) > limit and cost(reports) > limit * slowness()


def cost(reports: list[pytest.TestReport]) -> float:
    """Return the processor time of a test with its fixtures and processes [s]."""
    return max(report.processor_time for report in reports)  # type: ignore[attr-defined]


def processor_time() -> float:
    """Return the processor time of this process and of its ended children [s]."""
    return sum(os.times()[:4])


def slowness() -> float:
    """Return the time that this machine needs now over that of CALIBRATION_SECONDS; 1 if it needs less."""
    begin = time.process_time()
    sum(number * 0.5 for number in range(300_000))
    return max(1.0, (time.process_time() - begin) / CALIBRATION_SECONDS)


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    spent[report.nodeid] = getattr(report, "processor_time", 0.0)  # none of a test that ended its process


def pytest_sessionfinish() -> None:
    if TIMES:
        with open(TIMES, "a") as file:
            file.writelines(f"{seconds:.2f}\t{name}\n" for name, seconds in spent.items())
