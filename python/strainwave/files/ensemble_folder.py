"""An ensemble in a folder: first its plan, then part by part the results.

The plan contains the members and their parameters, so that missing ones are known. Every part names its plan and contains a
digest of its values, so that a damaged, renamed or foreign file is refused.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from strainwave.equality import ComparedByFields
from strainwave.files.parquet_table import read_columns
from strainwave.files.writing import remove_drafts, replacing
from strainwave.messages import one_line

if TYPE_CHECKING:
    import pyarrow

Array = NDArray[np.float64]
PLAN_FILE = "plan.parquet"
MAX_SHOWN_CHARACTERS = 40  # of a value in a message


class FolderPart(NamedTuple):
    """Members from `first` up to `last`, not included, and the name of their files."""

    name: str
    first: int
    last: int

    @property
    def members(self) -> NDArray[np.int64]:
        return np.arange(self.first, self.last)


@dataclass(frozen=True, eq=False)
class EnsembleFolder(ComparedByFields):
    """The plan of an ensemble, and the place of its files.

    Args:
        path: the folder
        asked: what was asked for, by name, each as `fingerprint` gives it
        parameters: what the members differ in, each of shape (members,)
        units: the outputs recorded, each with its unit
        size: how many members a part holds; the last may hold fewer
    """

    path: Path
    asked: Mapping[str, str]
    parameters: Mapping[str, Array]
    units: Mapping[str, str]
    size: int

    @staticmethod
    def open(path: Path) -> EnsembleFolder:
        """The plan that stands in a folder.

        Raises:
            ValueError: there is none, or it is damaged
        """
        if not (path / PLAN_FILE).exists():
            raise ValueError(one_line(f"{path} holds no ensemble: there is no {PLAN_FILE}"))
        table = _read(path / PLAN_FILE)
        sound = False
        with suppress(KeyError, TypeError, ValueError, RecursionError):
            plan = json.loads(table.schema.metadata[b"plan"])
            parameters = {name: table[name].to_numpy() for name in table.column_names}
            folder = EnsembleFolder(path, plan["asked"], parameters, plan["units"], plan["size"])
            sound = table.schema.metadata[b"identity"] == folder.identity and type(folder.size) is int and folder.size > 0
        if not sound:
            raise ValueError(one_line(f"{path / PLAN_FILE} is damaged; the parts of its folder cannot be checked without it"))
        return folder

    def begin(self) -> EnsembleFolder:
        """The plan that stands in the folder from now on: this one, or an equal one that was begun earlier.

        Raises:
            FileExistsError: another plan stands there, or other files
        """
        for folder in (self.path, self.path / "samples", self.path / "members"):
            remove_drafts(folder)
        if (self.path / PLAN_FILE).exists():
            begun = EnsembleFolder.open(self.path)
            differing = [name for name in {**self.asked, **begun.asked} if self.asked.get(name) != begun.asked.get(name)]
            if differing:
                both = "; ".join(f"{name} is {begun.asked.get(name)} there, {self.asked.get(name)} here" for name in differing)
                raise FileExistsError(one_line(f"{self.path} holds another ensemble: {both}; take another folder"))
            return begun
        if any(self.path.iterdir()):
            raise FileExistsError(one_line(f"{self.path} is not empty; take another folder, or move what is there"))
        plan = json.dumps({"asked": dict(self.asked), "units": dict(self.units), "size": self.size})
        _write(self.path / PLAN_FILE, dict(self.parameters), {}, {"plan": plan, "identity": self.identity})
        return self

    @cached_property
    def identity(self) -> bytes:
        """Return a digest that identifies this plan."""
        content = [self.asked, self.units, self.size, self.parameters]
        return sha256(_text(content).encode()).hexdigest().encode()

    @property
    def members(self) -> int:
        return len(next(iter(self.parameters.values())))

    def parts(self) -> Iterator[FolderPart]:
        for number, first in enumerate(range(0, self.members, self.size)):
            yield FolderPart(f"part-{number:06d}.parquet", first, min(first + self.size, self.members))

    def has(self, part: FolderPart) -> bool:
        """True if a part was run. Its members are written last."""
        return all((self.path / kind / part.name).exists() for kind in ("samples", "members"))

    def write(self, part: FolderPart, time: Array, columns: Mapping[str, Array], failures: Mapping[int, str]) -> None:
        """One part: outputs of shape (members, samples), and failures by the number of the member."""
        samples = {"member": np.repeat(part.members, len(time)), "time": np.tile(time, len(part.members))}
        series = {name: values.reshape(-1) for name, values in columns.items()}
        _write(self.path / "samples" / part.name, samples | series, {"time": "s"} | dict(self.units), self._proof)
        parameters = {name: values[part.first : part.last] for name, values in self.parameters.items()}
        reasons = {"failure": [failures.get(member) for member in part.members.tolist()]}
        _write(self.path / "members" / part.name, {"member": part.members} | parameters | reasons, {}, self._proof)

    def samples(self, part: FolderPart) -> tuple[Array, dict[str, Array]]:
        """Time, and outputs of shape (members, samples)."""
        table = self._checked("samples", part)
        columns = {name: table[name].to_numpy().reshape(len(part.members), -1) for name in ("time", *self.units)}
        return columns["time"][0], {name: columns[name] for name in self.units}

    def failures(self, part: FolderPart) -> dict[int, str]:
        """Return for each member of a part without a result the reason."""
        reasons = self._checked("members", part)["failure"].to_pylist()
        return {part.first + number: reason for number, reason in enumerate(reasons) if reason is not None}

    @property
    def _proof(self) -> dict[str, str | bytes]:
        return {"plan": self.identity}

    def _checked(self, kind: str, part: FolderPart) -> pyarrow.Table:
        """The table of a part, if it is what was written for it."""
        path = self.path / kind / part.name
        table = _read(path)
        if table.schema.metadata.get(b"plan") != self.identity:
            raise ValueError(one_line(f"{path} belongs to another ensemble than {self.path / PLAN_FILE}; {_PLAN_REMEDY}"))
        if not np.array_equal(np.unique(table["member"].to_numpy()), part.members):
            raise ValueError(
                one_line(f"{path} holds other members than {part.first} to {part.last - 1}, so it was renamed; {_PLAN_REMEDY}")
            )
        return table


def fingerprint(value: object) -> str:
    """A value as text, where that is short, else the digest of this text: equal for values that do not differ in any bit.

    >>> fingerprint(2e-4), fingerprint(["torque", "output_angle"])
    ('0.0002', '["torque", "output_angle"]')
    >>> fingerprint([0.1] * 100)
    'sha256 4f98773821eaf6dd'
    """
    text = _text(value)
    return text if len(text) <= MAX_SHOWN_CHARACTERS else f"sha256 {sha256(text.encode()).hexdigest()[:16]}"


def _text(value: object) -> str:
    """Numbers, arrays, models, scenarios and what is made up of them, taken apart as pickle does it."""
    return json.dumps(value, default=_apart)


def _apart(value: Any) -> object:
    if isinstance(value, np.ndarray):
        return [str(value.dtype), list(value.shape), sha256(np.ascontiguousarray(value).data).hexdigest()]
    if isinstance(value, Mapping):
        return dict(value)
    return value.__qualname__ if hasattr(value, "__qualname__") else value.__reduce_ex__(2)


_PLAN_REMEDY = "delete it, and simulate_to runs its members anew"


def _write(path: Path, columns: Mapping[str, Any], units: Mapping[str, str], metadata: Mapping[str, str | bytes]) -> None:
    """A Parquet file with the digest of its values."""
    import pyarrow
    from pyarrow.parquet import write_table

    values = {name: pyarrow.array(column, pyarrow.string() if name == "failure" else None) for name, column in columns.items()}
    fields = [
        pyarrow.field(name, column.type, metadata={"unit": units[name]} if name in units else None)
        for name, column in values.items()
    ]
    table = pyarrow.table(values, schema=pyarrow.schema(fields))
    table = table.replace_schema_metadata({**metadata, "digest": _digest(table)})
    floats = [name for name, column in values.items() if column.type == pyarrow.float64() and name != "time"]
    path.parent.mkdir(exist_ok=True)
    with replacing(path) as file:
        write_table(
            table,
            file,
            compression="zstd",
            use_dictionary=[name for name in table.column_names if name not in floats],
            column_encoding=dict.fromkeys(floats, "BYTE_STREAM_SPLIT"),
            write_page_checksum=True,
        )


def _read(path: Path) -> pyarrow.Table:
    """The table in a file; `ValueError` in one line where it is not what was written."""
    import pyarrow

    try:
        table = read_columns(path)
        sound = (table.schema.metadata or {}).get(b"digest") == _digest(table)
    except (ValueError, pyarrow.ArrowException) as error:
        raise ValueError(f"{error}; {_PLAN_REMEDY}") from None
    if not sound:
        raise ValueError(one_line(f"{path} is damaged: its values are not those of its digest; {_PLAN_REMEDY}"))
    return table


def _digest(table: pyarrow.Table) -> bytes:
    """Return a digest of names, types and values."""
    columns = {name: table[name].to_pylist() if name == "failure" else table[name].to_numpy() for name in table.column_names}
    return sha256(_text(columns).encode()).hexdigest().encode()
