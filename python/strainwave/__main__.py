"""The command `strainwave` from its very start: an interrupt ends it in one line, also while it is imported."""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path

EXIT_INTERRUPTED = 128 + signal.SIGINT  # exit code, as shells give it, and typer


def main() -> None:
    """Run the command, as the shell knows it."""
    written: list[Path] = []
    try:
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
        print(f"strainwave: interrupted; {', '.join(map(str, written)) or 'nothing'} written", file=sys.stderr)
        sys.exit(EXIT_INTERRUPTED)


if __name__ == "__main__":
    main()
