"""What holds whatever is thrown at the package: a result that makes sense, or a refusal that people can read."""

from __future__ import annotations

import re
import time
import unicodedata
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import strainwave as sw

Verdict = Literal["accepted", "refused", "wrong"]

REFUSALS = (ValueError, TypeError, MemoryError, FloatingPointError, RuntimeError)  # exactly these, and any OSError
LONGEST = 500  # characters of a message
_CONTROL = {"Cc", "Cs", "Zl", "Zp"}  # what moves a terminal, ends a line, or cannot be written at all

# Words of libraries, which say nothing of what was given: where they come through, a check is missing.
_FOREIGN = re.compile(
    r"not supported between instances|unsupported operand|bad operand type|object is not (iterable|subscriptable|callable)"
    r"|object does not support|object cannot be interpreted|has no len\(\)|has no attribute|unhashable type"
    r"|must be real number|argument must be a string or|can only concatenate|could not convert|cannot convert float"
    r"|ufunc '|setting an array element|zero-size array|could not be broadcast|inhomogeneous|truth value of an array"
    r"|incompatible function arguments|nanobind|std::|Unable to allocate|not enough values to unpack|too many values to unpack"
    r"|Maximum allowed|index out of range|out of bounds|array must not contain|SVD did not converge|Singular matrix"
    r"|encountered in |did not converge|invalid literal"
)


@dataclass(frozen=True)
class Case:
    """Something to try.

    Args:
        what: the input, in words
        attempt: does it; raises AssertionError where a law is broken even if it is refused
        check: of what came back; whatever it raises is wrong, for what was accepted must hold
    """

    what: str
    attempt: Callable[[], Any]
    check: Callable[[Any], None] = lambda result: None


@dataclass(frozen=True)
class Outcome:
    """What came of a case: the verdict, why, the input, and how long it took [s of the processor]."""

    verdict: Verdict
    words: str
    what: str
    took: float


def judged(case: Case, slowest: float) -> Outcome:
    """Tries a case, which may take the processor for `slowest` [s]."""
    began = time.process_time()
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        verdict, words = _tried(case)
    took = time.process_time() - began
    if verdict != "wrong" and (fault := next(filter(None, (_warning_fault(one) for one in warned)), None)):
        verdict, words = "wrong", fault
    if verdict != "wrong" and took > slowest:
        verdict, words = "wrong", f"takes {took:.1f} s"
    return Outcome(verdict, words, case.what, took)


def _tried(case: Case) -> tuple[Verdict, str]:
    try:
        result = case.attempt()
    except AssertionError as broken:
        return "wrong", str(broken)
    except Exception as error:
        said = f"{type(error).__name__}: {error}"
        fault = refusal_fault(error)
        return ("wrong", f"{fault}: {said}") if fault else ("refused", said)
    try:
        case.check(result)
    except AssertionError as broken:
        return "wrong", str(broken)
    except Exception as error:
        return "wrong", f"what was accepted fails: {type(error).__name__}: {error}"
    return "accepted", ""


def refusal_fault(error: Exception) -> str | None:
    """What is wrong with the way something is refused, if anything."""
    if type(error) not in REFUSALS and not (isinstance(error, OSError) and type(error).__module__ == "builtins"):
        return "not an error that is documented"
    named_path = isinstance(error, OSError) and error.strerror  # which Python adds as it likes
    return message_fault(named_path or str(error))


def message_fault(text: str) -> str | None:
    """What is wrong with a message, if anything."""
    if not text:
        return "no message"
    if any(unicodedata.category(character) in _CONTROL for character in text):
        return "more than one line, or control characters"
    if len(text) > LONGEST:
        return f"a message of more than {LONGEST} characters"
    if _FOREIGN.search(text):
        return "a library's words"
    return None


def _warning_fault(warned: warnings.WarningMessage) -> str | None:
    """What is wrong with a warning, if anything."""
    said = f"{warned.category.__name__}: {warned.message}"
    if warned.category not in (sw.PassivityWarning, sw.EnsembleWarning, RuntimeWarning):
        return f"not a warning that is documented: {said}"
    fault = message_fault(str(warned.message))
    return f"{fault}: {said}" if fault else None


def finite(value: Any) -> bool:
    """Whether all numbers of a result are; of values of classes, as far as they are compared."""
    if isinstance(value, float | complex | np.number):
        return bool(np.isfinite(value))
    if isinstance(value, np.ndarray):
        return value.dtype.kind not in "fc" or bool(np.isfinite(value).all())
    if isinstance(value, tuple | list):
        return all(finite(each) for each in value)
    if isinstance(value, sw.Recording):
        return all(finite(value[name]) for name in value.names)
    if isinstance(fields := getattr(value, "fields", None), tuple):
        return all(finite(getattr(value, field["name"])) for field in fields)
    return True


def described(value: Any, longest: int = 200) -> str:
    """A value in words, on one line."""
    try:
        text = repr(value)
    except Exception as error:
        text = f"<{type(value).__name__} whose repr fails: {error!r}>"
    text = " ".join(text.split())
    return text if len(text) <= longest else f"{text[: longest // 2]} … {text[-longest // 2 :]}"
