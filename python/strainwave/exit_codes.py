"""Exit codes of the command, except 0."""

from __future__ import annotations

INPUT_REFUSED = 2  # the input cannot be used; a repeated run does not help
RESULT_CONTRADICTED = 3  # a check fails, a recording contradicts the saved gear, or a recording differs from the baseline
