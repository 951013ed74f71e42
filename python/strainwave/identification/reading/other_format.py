"""Files with the suffix of a table, but the beginning of another format."""

from __future__ import annotations

from pathlib import Path

from strainwave.number_texts import is_number

FORMAT_BY_BEGINNING = {
    b"\x89PNG": "a picture (PNG)", b"\xff\xd8\xff": "a picture (JPEG)", b"GIF8": "a picture (GIF)", b"BM": "a picture (BMP)",
    b"%PDF": "a PDF document", b"PK\x03\x04": "a ZIP archive, as spreadsheets are", b"\x1f\x8b": "packed (gzip)",
    b"\xd0\xcf\x11\xe0": "an old Excel or Word file", b"<!DOCTYPE": "a web page", b"<html": "a web page",
}  # fmt: skip
MAX_BYTES_READ = 2048  # of the beginning
TEXT_SUFFIXES = (".csv", ".txt", ".tsv", ".log", ".dat")


def other_format(path: Path) -> str | None:
    """Return what a file with the name of a table is by its first letters, and what to do; None if it may be a table."""
    if path.suffix.lower() not in TEXT_SUFFIXES or not path.is_file():
        return None
    with path.open("rb") as file:
        begin = file.read(MAX_BYTES_READ)
    if separator := _other_separator(begin):
        return f'its columns are separated by "{separator}": separate them by commas, semicolons or tabs'
    found = next((what for letters, what in FORMAT_BY_BEGINNING.items() if begin.startswith(letters)), None)
    what = f"its suffix is {path.suffix}, but it is {found}"
    return None if found is None else f"{what}: export the measurement as CSV with one header line"


def _other_separator(begin: bytes) -> str | None:
    """Return a separator that tables are not read with, if the first two lines have it equally often, the second numbers."""
    lines = [line for line in begin.decode("utf-8", "ignore").splitlines() if line.strip() and not line.startswith("#")][:2]
    if len(lines) < 2 or any(each in line for line in lines for each in ",;\t"):
        return None
    separators = [each for each in "|:^~" if lines[0].count(each) == lines[1].count(each) > 0]
    return next((each for each in separators if all(map(is_number, lines[1].split(each)))), None)
