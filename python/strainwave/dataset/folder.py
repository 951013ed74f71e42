"""The folder of a data set, which is also the queue of its shards: what is there is done, what is locked is in work."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, suppress
from dataclasses import dataclass
from functools import cached_property
from hashlib import sha256
from pathlib import Path

from strainwave.dataset.plan import DatasetPlan
from strainwave.files.writing import making, remove_drafts, replacing
from strainwave.messages import one_line
from strainwave.operating_system import lock_bytes
from strainwave.presentation import Presented

PLAN, MANIFEST, CARD, SUMS, LOCKS = "plan.toml", "manifest.json", "card.md", "SHA256SUMS", ".work.lock"
READ_BYTES = 1 << 20


@dataclass(frozen=True)
class DatasetFolder(Presented):
    """The files of a data set."""

    path: Path

    @cached_property
    def plan(self) -> DatasetPlan:
        if not (self.path / PLAN).exists():
            raise ValueError(one_line(f"{self.path} is no data set: it has no {PLAN}"))
        return DatasetPlan.read(self.path / PLAN)

    def shard(self, number: int, kind: str = "shards") -> Path:
        return self.path / kind / f"shard-{number:06d}.parquet"

    def has(self, number: int) -> bool:
        """True if a shard is complete: it is renamed into place, after its samples."""
        return self.shard(number).exists()

    def done(self) -> int:
        """Return how many shards are complete."""
        with suppress(FileNotFoundError, NotADirectoryError):  # `begin` refuses a file in place of the folder
            return sum(entry.name.startswith("shard-") for entry in os.scandir(self.path / "shards"))
        return 0

    @property
    def is_finished(self) -> bool:
        return (self.path / SUMS).exists()

    def begin(self, plan: DatasetPlan, text: bytes, manifest: str, card: str) -> None:
        """Write what describes the data set, or check that the folder has the same plan."""
        with making(self.path):
            if (self.path / PLAN).exists():
                if self.plan.digest != plan.digest:
                    raise FileExistsError(
                        one_line(f"{self.path} has the data set of another plan ({self.plan.name}); take another folder")
                    )
                if (self.path / MANIFEST).exists() and (self.path / MANIFEST).read_text("utf-8") != manifest:
                    raise FileExistsError(
                        one_line(
                            f"{self.path / MANIFEST} is of another version of strainwave, or of another gear set; "
                            "take another folder, so that all shards are made alike"
                        )
                    )
            elif any(each.name != LOCKS for each in self.path.iterdir()):
                raise FileExistsError(one_line(f"{self.path} is not empty; take another folder, or move what is there"))
            for folder in ("shards", *(["samples"] if plan.samples else [])):
                (self.path / folder).mkdir(exist_ok=True)
            for name, content in ((CARD, card.encode()), (MANIFEST, manifest.encode()), (PLAN, text)):
                with replacing(self.path / name) as file:
                    file.write(content)

    # Locks are of bytes of one file: that of a shard's number. They end with the process, however it ends.

    def lock(self, number: int) -> AbstractContextManager[bool]:
        """Lock a shard; yields False if another process works on it."""
        return self._locked(number, 1)

    def remove_drafts(self) -> None:
        """Remove what killed workers left, unless a worker is at work."""
        with self._locked(0, 0) as is_mine:
            if is_mine:
                self._remove_drafts()

    def finish(self) -> bool:
        """Write the hashes of all files and remove what is temporary; True if all shards are there and nobody is at work."""
        if self.done() < self.plan.shards:
            return False
        with self._locked(0, 0) as is_mine:
            if not is_mine:
                return False
            self._remove_drafts()
            names = [PLAN, MANIFEST, CARD]
            names += [path.relative_to(self.path).as_posix() for path in sorted(self.path.glob("s*/shard-*.parquet"))]
            with replacing(self.path / SUMS) as file:
                for name in names:
                    file.write(f"{_hash(self.path / name)}  {name}\n".encode())
            with suppress(PermissionError):  # Windows removes no open file: there it stays
                (self.path / LOCKS).unlink(missing_ok=True)
        return True

    def _remove_drafts(self) -> None:
        for folder in (self.path, self.path / "shards", self.path / "samples"):
            remove_drafts(folder)

    @contextmanager
    def _locked(self, start: int, length: int) -> Iterator[bool]:
        """Lock bytes of the file of locks, of length 0 all; yields False if another process has locked some of them."""
        descriptor = os.open(self.path / LOCKS, os.O_RDWR | os.O_CREAT, 0o644)
        try:
            yield lock_bytes(descriptor, start, length)
        finally:
            os.close(descriptor)

    def _headline(self) -> str:
        return str(self.path)


def _hash(path: Path) -> str:
    digest = sha256()
    with path.open("rb") as file:
        while block := file.read(READ_BYTES):
            digest.update(block)
    return digest.hexdigest()
