"""Tests over long lists as one item each: pytest takes longer to collect ten thousand cheap cases than to run them."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterable, Sequence
from typing import Any

import pytest

MAX_NAMED = 5  # further values that fail, named in a note


def each(names: str | Sequence[str], values: Iterable[Any]) -> Callable[[Callable[..., None]], Any]:
    """Run a test for every value, as `pytest.mark.parametrize` does, but as one item; the values that fail are named.

    Fixtures are made once for all values.
    """
    names = [names] if isinstance(names, str) else list(names)
    cases = [_case(names, value) for value in values]

    def decorated(test: Callable[..., None]) -> Any:
        @functools.wraps(test)
        def every(**fixtures: Any) -> None:
            assert cases, "no value to test"
            failed: list[BaseException] = []
            for case in cases:
                try:
                    test(**case, **fixtures)
                except (Exception, pytest.fail.Exception) as error:
                    if len(failed) < MAX_NAMED:
                        error.add_note(", ".join(f"{name} = {value!r:.200}" for name, value in case.items()))
                    failed.append(error)
            if failed:
                failed[0].add_note(f"{len(failed)} of {len(cases)} values fail")
                for error in failed[1:MAX_NAMED]:
                    failed[0].add_note(f"also for {error.__notes__[0]}: {type(error).__name__}: {error!s:.200}")
                raise failed[0]

        parameters = inspect.signature(test).parameters
        every.__signature__ = inspect.Signature([p for name, p in parameters.items() if name not in names])  # type: ignore[attr-defined]
        return every

    return decorated


def _case(names: Sequence[str], value: Any) -> dict[str, Any]:
    """The arguments of one value, which may be a `pytest.param`."""
    given = value.values if isinstance(value, type(pytest.param())) else value if len(names) > 1 else (value,)
    return dict(zip(names, given, strict=True))
