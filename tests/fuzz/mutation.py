"""Texts and bytes, changed a little or a lot."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeVar

from numpy.random import Generator

T = TypeVar("T")

NUMBERS = (
    "nan", "inf", "-inf", "Infinity", "NaN", "1e999", "-1e999", "1e-999", "5e-324", "1e308", "1e309", "-0.0", "0", "00",
    "1_000", "1__0", "0x10", "0b1", "1e", "e5", "1e+", "+", "-", ".", "1.", ".5", "1.5.2", "1,5", "1.000,5", "１２", "٣", "−1",
    "1e400", "9" * 400, "0." + "0" * 400 + "1", "1" * 25, "true", "null", "None", "1979-05-27", "1d5", "1f", "1j", "(1)",
    "=1+1", "$1", "1%", "2**63", "18446744073709551616", "-9223372036854775809",
)  # fmt: skip
TEXTS = (
    "", " ", "\t", "\n", "\r", "\r\n", "\x00", "\x1b[31m", "\x85", "\u2028", "\ufeff", "\u200b", "\xa0", "\ud800", "é",
    "e\u0301", "Ω", "°", "😀", '"', '""', "'", '"""', "'''", "\\", "\\n", "\\u0000", ",", ";", ":", "#", "[", "]", "[[", "{",
    "}", "(", ")", "=", "/", "*", "..", "%s", "{0}", "<script>", "&amp;", "..\\..", "../..", "NUL", "x" * 3000, "," * 500,
    "[" * 500, "{" * 500,
)  # fmt: skip


def picked(random: Generator, options: Sequence[T]) -> T:
    return options[int(random.integers(len(options)))]


def mutated(text: str, random: Generator, words: Sequence[str]) -> str:
    """A text changed in up to four places, mostly in one, by what may stand there and by what may not."""
    for _ in range(picked(random, (0, 1, 1, 1, 1, 2, 3, 4))):
        text = picked(random, _CHANGES)(text, random, (*words, *NUMBERS, *TEXTS))
    return text


def encoded(text: str, random: Generator) -> bytes:
    """The text as bytes, now and then not as UTF-8 or with some of them changed."""
    encoding = picked(random, ("utf-8",) * 8 + ("utf-8-sig", "utf-16", "latin-1", "utf-16-le"))
    data = text.encode(encoding, errors="surrogatepass" if encoding.startswith("utf") else "replace")
    return mutated_bytes(data, random) if random.random() < 0.1 else data


def mutated_bytes(data: bytes, random: Generator) -> bytes:
    """Bytes changed in up to four places, mostly in one."""
    for _ in range(picked(random, (0, 1, 1, 1, 1, 2, 3, 4))):
        data = picked(random, _BYTE_CHANGES)(data, random)
    return data


def _insert(text: str, random: Generator, words: Sequence[str]) -> str:
    place = int(random.integers(len(text) + 1))
    return text[:place] + picked(random, words) + text[place:]


def _cut(text: str, random: Generator, words: Sequence[str]) -> str:
    start = int(random.integers(len(text) + 1))
    return text[:start] + text[start + int(random.integers(1, 12)) :]


def _truncate(text: str, random: Generator, words: Sequence[str]) -> str:
    return text[: int(random.integers(len(text) + 1))]


def _replace_word(text: str, random: Generator, words: Sequence[str]) -> str:
    """One of the words that are in the text by another."""
    here = [word for word in {*text.replace(",", " ").replace(";", " ").replace("=", " ").split()} if word]
    if not here:
        return picked(random, words)
    return text.replace(picked(random, sorted(here)), picked(random, words), int(random.integers(1, 4)))


def _double_line(text: str, random: Generator, words: Sequence[str]) -> str:
    lines = text.split("\n")
    lines.insert(int(random.integers(len(lines) + 1)), picked(random, lines))
    return "\n".join(lines)


def _drop_line(text: str, random: Generator, words: Sequence[str]) -> str:
    lines = text.split("\n")
    del lines[int(random.integers(len(lines)))]
    return "\n".join(lines)


def _other_line_ends(text: str, random: Generator, words: Sequence[str]) -> str:
    return text.replace("\n", picked(random, ("\r\n", "\r", "\n\n", " \n", "\n ", "\v\n")))


_CHANGES: tuple[Callable[[str, Generator, Sequence[str]], str], ...] = (
    _insert, _insert, _cut, _truncate, _replace_word, _replace_word, _replace_word, _replace_word, _double_line, _drop_line,
    _other_line_ends,
)  # fmt: skip


def _flip(data: bytes, random: Generator) -> bytes:
    if not data:
        return b"\x00"
    place = int(random.integers(len(data)))
    return data[:place] + bytes([int(random.integers(256))]) + data[place + 1 :]


def _zero(data: bytes, random: Generator) -> bytes:
    start = int(random.integers(len(data) + 1))
    length = min(int(random.integers(1, 64)), len(data) - start)
    return data[:start] + bytes(length) + data[start + length :]


def _shorten(data: bytes, random: Generator) -> bytes:
    return data[: int(random.integers(len(data) + 1))]


def _move(data: bytes, random: Generator) -> bytes:
    start, length = int(random.integers(len(data) + 1)), int(random.integers(1, 64))
    place = int(random.integers(len(data) + 1))
    return data[:place] + data[start : start + length] + data[place:]


_BYTE_CHANGES: tuple[Callable[[bytes, Generator], bytes], ...] = (_flip, _flip, _flip, _flip, _zero, _shorten, _move)
