"""The folder of a studio: files opened from the command line, uploads, and results. A page knows their names alone."""

from __future__ import annotations

import os
import re
import secrets
import unicodedata
from collections.abc import AsyncIterator, Sequence
from contextlib import suppress
from pathlib import Path

from strainwave.files.folder import inside
from strainwave.files.gear_set import GearSet
from strainwave.files.writing import DRAFT_PREFIX, replacing
from strainwave.messages import quoted

MAX_UPLOAD = 2**31  # bytes of one file
MAX_UPLOADS = 2**33  # bytes of all files together
MAX_FILES = 1000
NAME = re.compile(r"[^\W_](?:[\w .,()+@=-]{0,118}[\w)])?")
NAMES_OF_WINDOWS = {"con", "prn", "aux", "nul", *(f"{port}{number}" for port in ("com", "lpt") for number in range(10))}
TOKEN_FILE = "token"
TOKEN = re.compile(r"[\w-]{32}")


class Workspace:
    """The files that the pages of a studio may name.

    Args:
        folder: of uploads and results; made if it is not there, for this user alone
        opened: files and folders that the command line names; they stay where they are

    Raises:
        FileNotFoundError: a file is not there
    """

    def __init__(self, folder: Path, opened: Sequence[Path] = ()) -> None:
        self.folder = folder
        self.uploads, self.results = folder / "uploads", folder / "results"
        self._sizes: dict[str, int] = {}  # of uploads that are being written [bytes]
        for each in (folder, self.uploads, self.results):
            each.mkdir(mode=0o700, parents=True, exist_ok=True)
            each.chmod(0o700)
        for draft in self.uploads.glob(f"{DRAFT_PREFIX}*"):  # of a server that was killed
            draft.unlink()
        for path in opened:
            if not path.exists():
                raise FileNotFoundError(f"{path} is not there")
        names = [path.name or str(path) for path in opened]
        self.opened = {
            name if names.count(name) == 1 else str(path): path.resolve() for name, path in zip(names, opened, strict=True)
        }

    @property
    def files(self) -> dict[str, Path]:
        """Paths of the files by their names, those of the command line first."""
        uploads = {path.name: path for path in sorted(self.uploads.iterdir()) if NAME.fullmatch(path.name)}
        gears = {f"{path.parent.name}/{path.name}": path for path in sorted(self.results.glob("*/*.toml"))}
        own = {name: path for name, path in {**uploads, **gears}.items() if self._is_own(path)}
        return {**own, **self.opened}

    def _is_own(self, path: Path) -> bool:
        """True for a regular file of the folder that no link leads out of."""
        return path.is_file() and path.resolve().is_relative_to(self.folder.resolve())

    def path_of(self, name: str) -> Path:
        """Return the path of a file by its name.

        Raises:
            ValueError: there is no file of this name
        """
        if (path := self.files.get(name)) is None:
            raise ValueError(f"{quoted(name)} is not among the files of this studio: open it, or drop it on the page")
        return path

    def result(self, job: str, name: str) -> Path:
        """Return the path of a file that a job wrote.

        Raises:
            ValueError: there is no such file
        """
        path = inside(self.results / job, name) if re.fullmatch(r"\d{1,6}-[a-z-]{1,40}", job) else self.results
        if not self._is_own(path):
            raise ValueError(f"{quoted(f'{job}/{name}')} is not there")
        return path

    async def upload(self, name: str, content: AsyncIterator[bytes]) -> str:
        """Write a file from a page, whole or not at all. Return its name: another one, if this one is taken.

        Raises:
            ValueError: the name is none of a file, or the file is too large
        """
        free = self._free(unicodedata.normalize("NFC", name))
        self._sizes[free] = 0
        try:
            with replacing(self.uploads / free) as file:
                async for part in content:
                    self._sizes[free] += len(part)
                    if self._sizes[free] > MAX_UPLOAD or self._uploaded() > MAX_UPLOADS:
                        raise ValueError(f"{quoted(name)} is too large for this studio; open it from the command line")
                    file.write(part)
        finally:
            del self._sizes[free]
        return free

    def _free(self, name: str) -> str:
        """Return the name under which a file is kept: this one, or with a number, if it is taken or about to be.

        Raises:
            ValueError: it is none of a file, or there are too many files
        """
        stem, suffix = Path(name).stem, Path(name).suffix
        if not NAME.fullmatch(name) or stem.casefold() in NAMES_OF_WINDOWS:
            raise ValueError(
                f"{quoted(name)} is no name of a file here: a letter or digit, then these, blanks and _ - . , + = @ ( )"
            )
        taken = {each.casefold() for each in (*self.files, *self._sizes)}
        if len(taken) >= MAX_FILES:
            raise ValueError(f"this studio has {MAX_FILES} files; remove some from {self.uploads}")
        names = (name, *(f"{stem}-{count}{suffix}" for count in range(2, MAX_FILES + 2)))
        return next(each for each in names if each.casefold() not in taken)

    def _uploaded(self) -> int:
        """Return the size of all uploads, those that are being written too [bytes]."""
        return sum(path.lstat().st_size for path in self.uploads.iterdir()) + sum(self._sizes.values())

    def remove(self, name: str) -> None:
        """Remove a file that a page uploaded.

        Raises:
            ValueError: there is no such file
        """
        path = self.path_of(name)
        if path.parent != self.uploads:
            raise ValueError(f"{quoted(name)} was not uploaded; it stays")
        path.unlink()

    def token(self) -> str:
        """Return the secret of this studio's addresses, which a later server of the same folder keeps."""
        path = self.folder / TOKEN_FILE
        kept = path.read_text().strip() if path.is_file() else ""
        if not TOKEN.fullmatch(kept):
            kept = secrets.token_urlsafe(24)
            path.unlink(missing_ok=True)
            with open(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w") as file:
                file.write(kept)
        return kept


def first_gear(opened: Sequence[Path]) -> GearSet | None:
    """Return the gear of the first gear file among these; None if there is none."""
    for path in opened:
        if path.suffix == ".toml":
            with suppress(ValueError):  # a mapping, or another file of settings
                return GearSet.read(path)
    return None
