"""Whatever the input holds, a message of it is one short line."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, strategies as st
from strainwave.messages import listed, one_line, quoted, shortened, unquoted

# Any code point, surrogates too, as a file or an argument may hold them.
anything = st.text(alphabet=st.characters(), max_size=50).flatmap(lambda text: st.sampled_from([text, 100 * text]))


@given(anything, st.sampled_from([one_line, quoted, unquoted, shortened, lambda text: listed([text, text])]))
def test_any_text_is_told_in_one_short_line(text: str, told: Callable[[str], str]) -> None:
    assert told(text).isprintable()
    assert len(told(text)) <= 970


@given(anything)
def test_a_short_text_that_can_be_printed_is_told_as_it_is(text: str) -> None:
    if text.isprintable() and len(text) <= 60:
        assert (one_line(text), quoted(text), unquoted(text), listed([text])) == (text, f'"{text}"', text, text)


def test_control_characters_are_shown_not_obeyed() -> None:
    assert quoted("\x1b[31mred\n\u202e") == r'"\x1b[31mred\n\u202e"'


def test_a_long_text_shows_its_beginning_and_a_long_message_both_ends() -> None:
    assert quoted(61 * "x") == f'"{60 * "x"}…"'
    assert one_line("a" + 2000 * "x" + "b") == f"a{479 * 'x'} … {479 * 'x'}b"


def test_of_many_names_the_first_ones_are_listed() -> None:
    assert listed(map(str, range(20))).endswith("18, 19")
    assert listed(map(str, range(22))).endswith("18, 19 and 2 more")


@pytest.mark.parametrize("value", [10**5000, [10**5000], np.zeros((9, 9)), 1000 * "x\n", {"a": 10**5000}], ids=range(5))
def test_any_value_is_told_in_one_short_line(value: object) -> None:
    assert shortened(value).isprintable()
    assert len(shortened(value)) < 100
