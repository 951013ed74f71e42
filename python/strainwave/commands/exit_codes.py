"""Exit codes of the command, besides 0."""

from __future__ import annotations

REFUSED = 2  # the input cannot be used
CONTRADICTED = 3  # a check fails, a recording contradicts the saved gear, or a recording differs from the baseline
