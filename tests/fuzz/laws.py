"""What holds whatever is thrown at the package: a result that makes sense, or a refusal that people can read."""

from __future__ import annotations

import os
import re
import time
import traceback
import unicodedata
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
import strainwave as sw
from strainwave.questions import QuestionError

Verdict = Literal["accepted", "refused", "wrong"]

# Exactly these, and any OSError.
REFUSALS = (ValueError, QuestionError, TypeError, MemoryError, FloatingPointError, RuntimeError)
PACKAGE = f"{Path(sw.__file__).parent}{os.sep}"
LONGEST = 1000  # characters of a message
_CONTROL = {"Cc", "Cs", "Zl", "Zp"}  # what moves a terminal, ends a line, or cannot be written at all

# Words of libraries, which say nothing of what was given: where they come through, a check is missing.
_FOREIGN = re.compile(
    r"not supported between instances|unsupported operand|bad operand type|object is not (iterable|subscriptable|callable)"
    r"|object does not support|object cannot be interpreted|has no len\(\)|has no attribute|unhashable type"
    r"|must be real number|argument must be a string or|can only concatenate|could not convert|cannot convert float"
    r"|ufunc '|setting an array element|zero-size array|could not be broadcast|inhomogeneous|truth value of an array"
    r"|incompatible function arguments|nanobind|std::|Unable to allocate|not enough values to unpack|too many values to unpack"
    r"|Maximum allowed size|index out of range|out of bounds|array must not contain|SVD did not converge|Singular matrix"
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
    """What came of a case.

    Args:
        verdict: accepted, refused or wrong
        fault: what is wrong, the same for all cases of one sort
        words: what was said
        what: the input
        took: how long it took [s of the processor]
    """

    verdict: Verdict
    fault: str
    words: str
    what: str
    took: float


def judged(case: Case, slowest: float) -> Outcome:
    """Tries a case, which may take the processor for `slowest` [s]."""
    began = time.process_time()
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        refused, fault, words = _tried(case)
    took = time.process_time() - began
    for one in warned:
        if not fault and (fault := _warning_fault(one)):
            words = f"{one.category.__name__}: {one.message}"
    if not fault and took > slowest:
        fault, words = "takes long", f"{took:.1f} s"
    return Outcome("wrong" if fault else "refused" if refused else "accepted", fault, words, case.what, took)


def _tried(case: Case) -> tuple[bool, str, str]:
    """Whether a case is refused, what is wrong with that or with the result, and what was said."""
    try:
        result = case.attempt()
    except AssertionError as broken:
        return True, str(broken).partition(": ")[0], str(broken)
    except Exception as error:
        fault = refusal_fault(error)
        return True, f"{fault}, from {_place(error)}" if fault else "", f"{type(error).__name__}: {error}"
    try:
        case.check(result)
    except AssertionError as broken:
        return False, str(broken).partition(": ")[0], str(broken)
    except Exception as error:
        return False, f"what was accepted fails in {_place(error)}", f"{type(error).__name__}: {error}"
    return False, "", ""


def _place(error: Exception) -> str:
    """The function of the package that an error comes from, or that calls what it comes from."""
    frames = [frame for frame, _ in traceback.walk_tb(error.__traceback__) if frame.f_code.co_filename.startswith(PACKAGE)]
    if not frames:
        return "compiled code"
    code = frames[-1].f_code
    return f"{code.co_filename.removeprefix(PACKAGE)} {code.co_qualname}"


def refusal_fault(error: Exception) -> str:
    """What is wrong with the way something is refused, if anything."""
    if type(error) not in REFUSALS and not (isinstance(error, OSError) and type(error).__module__ == "builtins"):
        return f"{type(error).__name__}, which is not documented"
    named_path = isinstance(error, OSError) and error.strerror  # which Python adds as it likes
    return message_fault(named_path or str(error))


def message_fault(text: str) -> str:
    """What is wrong with a message, if anything."""
    if not text:
        return "no message"
    if _FOREIGN.search(text):
        return "a library's words"
    if any(unicodedata.category(character) in _CONTROL for character in text):
        return "more than one line, or control characters"
    if len(text) > LONGEST:
        return f"a message of more than {LONGEST} characters"
    return ""


def _warning_fault(warned: warnings.WarningMessage) -> str:
    """What is wrong with a warning, if anything."""
    if warned.category not in (sw.PassivityWarning, sw.simulation.EnsembleWarning, RuntimeWarning):
        fault = f"{warned.category.__name__}, which is not documented"
    else:
        fault = message_fault(str(warned.message))
    return f"{fault}, in a warning from {warned.filename.removeprefix(PACKAGE)} line {warned.lineno}" if fault else ""


def within_memory(attempt: Callable[[], Any]) -> Callable[[], Any]:
    """The same attempt, where running out of memory breaks a law: a file must be refused before it takes so much."""

    def within() -> Any:
        try:
            return attempt()
        except MemoryError:
            raise AssertionError("a file takes more memory than it may") from None

    return within


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
