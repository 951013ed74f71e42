"""The command `strainwave` from its very start: an interrupt ends it in one line, also while it is imported."""

from __future__ import annotations

import signal
import sys
from types import FrameType

INTERRUPTED = 128 + signal.SIGINT  # exit code, as shells give it


class _Interrupted(BaseException):
    """Ctrl-C. Not a KeyboardInterrupt, which typer would catch and end without a word."""


def _interrupt(number: int, frame: FrameType | None) -> None:
    raise _Interrupted


def main() -> None:
    """Runs the command, as the shell knows it."""
    try:
        if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # else whoever started it wants it to go on
            signal.signal(signal.SIGINT, _interrupt)
        from strainwave import cli

        cli.main()
    except _Interrupted:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        print("strainwave: interrupted; nothing written", file=sys.stderr)
        sys.exit(INTERRUPTED)


if __name__ == "__main__":
    main()
