"""What holds for all tests."""

import gc
import os
import signal
import sys
from collections.abc import Generator, Iterator
from pathlib import Path

import pytest
import strainwave
from hypothesis import settings
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


@pytest.fixture(autouse=True)
def nothing_remembered() -> Iterator[None]:
    """Each test begins as a new process does: no gear was loaded from a file with ratings, and no drive has taken a step."""
    yield
    kernels.forget_work()
    if ratings := sys.modules.get("strainwave.files.ratings"):
        ratings.forget()


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


# ---- Processor time of each test, with the processes that it starts ----------------------------------------------------

# A file that the main process of a run writes; workers, and pytest run by a test, find no such variable and write nothing.
TIMES = os.environ.pop("STRAINWAVE_TEST_TIMES", "")
BEGIN = pytest.StashKey[float]()
spent: dict[str, float] = {}  # s


def processor_time() -> float:
    """Returns the processor time of this process and of its ended children [s]."""
    return sum(os.times()[:4])


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Generator[None, object, object]:
    item.stash[BEGIN] = processor_time()
    return (yield)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    report = yield
    report.processor_time = processor_time() - item.stash[BEGIN]  # type: ignore[attr-defined]
    return report


def pytest_runtest_logreport(report: pytest.TestReport) -> None:
    spent[report.nodeid] = getattr(report, "processor_time", 0.0)  # none of a test that ended its process


def pytest_sessionfinish() -> None:
    if TIMES:
        Path(TIMES).write_text("".join(f"{seconds:.2f}\t{name}\n" for name, seconds in spent.items()))
