"""The command `strainwave` from its very start: an interrupt ends it in one line, also while it is imported."""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path
from types import FrameType
from typing import Any

EXIT_INTERRUPTED = 128 + signal.SIGINT  # exit code, as shells give it, and typer


def main() -> None:
    """Run the command, as the shell knows it."""
    written: list[Path] = []
    try:
        signal.signal(signal.SIGINT, _interrupt)
        from strainwave.simulation.threads import THREAD_VARIABLES

        for name in THREAD_VARIABLES:
            os.environ.setdefault(name, "1")
        from strainwave.commands import cli
        from strainwave.files import writing

        written = writing.written
        cli.main()
    except (KeyboardInterrupt, SystemExit) as end:
        if isinstance(end, SystemExit) and end.code != EXIT_INTERRUPTED:
            raise
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        print(f"strainwave: interrupted; {', '.join(map(str, written)) or 'nothing'} written", file=sys.stderr, flush=True)
        os._exit(EXIT_INTERRUPTED)  # the end of Python itself aborts if a package was being imported


def _interrupt(_: int, frame: FrameType | None) -> None:
    """Raise KeyboardInterrupt, and see to it that it reaches this package.

    Packages that are being imported swallow it or turn it into another error, as pandas and pyarrow do. The innermost frame of
    this package is therefore traced, until the interrupt arrives there.
    """
    within = frame
    while within is not None and not str(within.f_globals.get("__name__")).startswith(("strainwave", "__main__")):
        within = within.f_back
    if within is not None and within is not frame:
        within.f_trace = _arrive
        sys.settrace(lambda *_: None)  # without a trace function of the thread those of frames are not called
    raise KeyboardInterrupt


def _arrive(frame: FrameType, event: str, argument: Any) -> None:
    """Raise KeyboardInterrupt in a traced frame, unless it has arrived there."""
    sys.settrace(None)
    frame.f_trace = None
    if event != "exception" or not issubclass(argument[0], KeyboardInterrupt):
        raise KeyboardInterrupt


if __name__ == "__main__":
    main()
