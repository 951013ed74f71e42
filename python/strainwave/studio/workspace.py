"""The folder of a studio: files opened from the command line, uploads, and results. A page knows their names alone."""

from __future__ import annotations

import os
import re
import secrets
from collections.abc import AsyncIterator, Sequence
from pathlib import Path

from strainwave.files.folder import inside
from strainwave.files.gear_set import GearSet
from strainwave.files.writing import replacing
from strainwave.messages import quoted

MAX_UPLOAD = 2**31  # bytes of one file
MAX_UPLOADS = 2**33  # bytes of all files together
MAX_FILES = 1000
NAME = re.compile(r"[^\W_][\w .,()+@=-]{0,119}")
SETTINGS = (".toml",)  # of gears and mappings
TOKEN_FILE = "token"


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
        for each in (folder, self.uploads, self.results):
            each.mkdir(mode=0o700, parents=True, exist_ok=True)
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
        return {**uploads, **gears, **self.opened}

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
        folder = self.results / job
        path = inside(folder, name) if re.fullmatch(r"\d{1,6}-[a-z-]{1,40}", job) else folder
        if not path.is_file():
            raise ValueError(f"{quoted(f'{job}/{name}')} is not there")
        return path

    async def upload(self, name: str, content: AsyncIterator[bytes]) -> str:
        """Write a file from a page, whole or not at all. Return its name: another one, if this one is taken.

        Raises:
            ValueError: the name is none of a file, or the file is too large
        """
        if not NAME.fullmatch(name):
            raise ValueError(
                f"{quoted(name)} is no name of a file here: begin with a letter or digit, then letters, digits, _ - . , + = ( )"
            )
        files = list(self.uploads.iterdir())
        room = MAX_UPLOADS - sum(path.stat().st_size for path in files)
        if len(files) >= MAX_FILES:
            raise ValueError(f"this studio has {MAX_FILES} files; remove some from {self.uploads}")
        taken, stem, suffix = self.files, Path(name).stem, Path(name).suffix
        free = next(
            each for each in (name, *(f"{stem}-{count}{suffix}" for count in range(2, MAX_FILES + 2))) if each not in taken
        )
        size = 0
        with replacing(self.uploads / free) as file:
            async for part in content:
                size += len(part)
                if size > min(MAX_UPLOAD, room):
                    raise ValueError(
                        f"{quoted(name)} is larger than {min(MAX_UPLOAD, room) / 1e6:.0f} MB; open it from the command line"
                    )
                file.write(part)
        return free

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
        if not path.exists():
            descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
            with open(descriptor, "w") as file:
                file.write(secrets.token_urlsafe(24))
        return path.read_text().strip()


def first_gear(opened: Sequence[Path]) -> GearSet | None:
    """Return the gear of the first gear file among these; None if there is none.

    Raises:
        ValueError: it cannot be read
    """
    gears = [path for path in opened if path.suffix in SETTINGS]
    return GearSet.read(gears[0]) if gears else None
