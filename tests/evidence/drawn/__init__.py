"""Records drawn at random whose truth is known, one module a kind: `python -m tests.evidence.drawn --help`."""
