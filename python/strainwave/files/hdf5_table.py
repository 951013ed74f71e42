"""Variables in HDF5 files, those of MAT 7.3 among them, by h5py; data that stand in other files are refused."""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from contextlib import suppress
from math import prod
from pathlib import Path
from typing import Any

import numpy as np

from strainwave.files.array_table import (
    IN_THE_NAME,
    MAX_MATRIX_COLUMNS,
    MAX_NESTING,
    ArrayTable,
    Unreadable,
    object_of_matlab,
    table_of,
)
from strainwave.files.budget import ReadBudget, RefusedFile, budget_of
from strainwave.files.labels import read_by_others
from strainwave.files.table_format import Format
from strainwave.messages import one_line, quoted

MAX_ATTRIBUTE = 1000  # bytes of the name of a class
MAX_SOFT_LINKS = 16  # one after the other
MAX_DEFLATE = 1032  # times that a packed byte may expand
CHECKSUM_BYTES = 4  # bytes that a filter may add to a chunk
MISSING_VALUE = Unreadable("a link that leads nowhere; the data are not in this file")
CYCLE_MARK = Unreadable("a group or reference that contains itself")


def open_hdf5(path: str | Path) -> ArrayTable:
    """The series of an HDF5 file; of a group its own, as `data.q`."""
    with read_by_others(path, "HDF5"):
        budget = budget_of(path)
    return table_of(one_line(str(path)), hdf5_variables(Path(path), "HDF5", budget), budget)


def hdf5_variables(path: Path, kind: str, budget: ReadBudget) -> Iterator[tuple[str, Any]]:
    """Return the variables of a file by their names, groups as mappings.

    Raises:
        ImportError: h5py is not installed
        ValueError: the file is damaged, refers to other files, or would expand to more than it may
    """
    try:
        import h5py
    except ImportError:
        raise ImportError(f"{path.name}: HDF5, as of MAT 7.3, is read by h5py: pip install 'strainwave[formats]'") from None
    with read_by_others(path, kind), h5py.File(path, "r") as opened:
        variables = _Walk(opened, budget).root()
    yield from variables.items()


class _Walk:
    """Reads what a file contains, each group and dataset once."""

    def __init__(self, opened: Any, budget: ReadBudget) -> None:
        self.opened = opened
        self.budget = budget
        self.known: dict[tuple[int, int], Any] = {}  # by address in the file and depth
        self.begun: set[int] = set()  # addresses of what contains the node that is read

    def root(self) -> dict[str, Any]:
        """Return what the file contains, by names."""
        import h5py

        self.begun.add(h5py.h5o.get_info(self.opened.id).addr)
        return self._members(self.opened, MAX_NESTING + 1)

    def content(self, node: Any, depth: int) -> Any:
        """Return the content of a group or dataset, nothing beyond the depth."""
        import h5py

        self.budget.take_node()
        address = h5py.h5o.get_info(node.id).addr
        if address in self.begun:
            return CYCLE_MARK
        if (address, depth) not in self.known:
            self.begun.add(address)
            read = self._group if isinstance(node, h5py.Group) else self._dataset
            self.known[address, depth] = read(node, depth)
            self.begun.remove(address)
        return self.known[address, depth]

    def _group(self, group: Any, depth: int) -> Any:
        """Return what a group contains: a list of structures if each name in it stands for as many values."""
        members = self._members(group, depth)
        lists = [each for each in members.values() if isinstance(each, list)]
        if members and len(lists) == len(members) and len({len(each) for each in lists}) == 1:
            return [dict(zip(members, each, strict=True)) for each in zip(*lists, strict=True)]
        return members

    def _members(self, group: Any, depth: int) -> dict[str, Any]:
        """Return what a group contains, by names; what begins with # is MATLAB's own."""
        members = {}
        for name in group if depth else ():
            if not name.startswith("#"):
                node = self._followed(group, name, MAX_SOFT_LINKS)
                members[name] = MISSING_VALUE if node is None else self.content(node, depth - 1)
        return members

    def _followed(self, group: Any, name: str, links: int) -> Any:
        """Return the node of this name in a group; None if a soft link leads nowhere."""
        import h5py

        self.budget.take_node()
        link = group.get(name, getlink=True)
        if isinstance(link, h5py.ExternalLink):
            raise RefusedFile(f"{_place(group, name)} is a link into another file, {quoted(link.filename)}; copy its data here")
        if not isinstance(link, h5py.SoftLink):
            return None if link is None else _opened(group, name)
        node = self.opened if link.path.startswith("/") else group
        for part in link.path.split("/"):
            if part not in ("", "."):
                node = self._followed(node, part, links - 1) if links and isinstance(node, h5py.Group) else None
        return node

    def _dataset(self, node: Any, depth: int) -> Any:
        """Return the numbers or the text of a dataset, or the content of each reference in it."""
        import h5py

        if not isinstance(node, h5py.Dataset):  # a type
            return {}
        _check_storage(node)
        kind = _class(node)
        if "MATLAB_object_decode" in node.attrs:
            return object_of_matlab(kind)
        if kind == "char" and node.dtype.kind == "u":
            return "".join(map(chr, np.ravel(self._values(node))))
        if h5py.check_ref_dtype(node.dtype) is h5py.Reference:
            references = np.ravel(self._values(node))[:MAX_MATRIX_COLUMNS] if depth else ()
            contents = [self.content(self.opened[each], depth - 1) for each in references if each]
            return CYCLE_MARK if contents and all(each is CYCLE_MARK for each in contents) else contents
        shape = node.shape or ()
        is_series = len(shape) < 2 or (len(shape) == 2 and min(shape) <= MAX_MATRIX_COLUMNS)
        return self._values(node) if is_series and node.dtype.kind in "fiub" else []

    def _values(self, node: Any) -> Any:
        """Return the content of a dataset, if it fits into the budget: the file alone claims how much that is."""
        if node.shape is None:
            return np.array([])
        what = f"dataset {node.name}"
        self.budget.take_bytes(prod(node.shape) * (node.dtype.itemsize + 8), what)
        if node.chunks is not None:
            size = prod(node.chunks) * node.dtype.itemsize
            self.budget.take_bytes(size, f"a chunk of {what}")
            _check_packing(node, size, self.budget.allowed_bytes - self.budget.expanded_bytes)
        return node[()]


def _opened(group: Any, name: str) -> Any:
    try:
        return group[name]
    except (KeyError, OSError):
        where = "it is damaged, or virtual, with its data in other files"
        raise RefusedFile(f"{_place(group, name)} cannot be opened: {where}") from None


def _place(group: Any, name: str) -> str:
    return f"{(group.name or '').rstrip('/')}/{name}"


def _check_storage(node: Any) -> None:
    """Refuse a dataset whose values stand in other files. Nothing else may be asked of a virtual one: it would open them."""
    import h5py

    creation = node.id.get_create_plist()
    if creation.get_layout() == h5py.h5d.VIRTUAL:
        raise RefusedFile(f"{node.name} is a virtual dataset, whose values stand in other files; copy them here")
    if creation.get_external_count():
        name = creation.get_external(0)[0].decode(errors="replace")
        raise RefusedFile(f"{node.name} has its values in another file, {quoted(name)}; copy them here")


def _check_packing(node: Any, chunk_bytes: int, left: int) -> None:
    """Refuse a chunk that unpacks to more than it claims, if that may be more than is `left` [bytes]; HDF5 has no bound."""
    import h5py

    creation = node.id.get_create_plist()
    filters = [creation.get_filter(place)[0] for place in range(creation.get_nfilters())]
    if filters.count(h5py.h5z.FILTER_DEFLATE) > 1:
        raise RefusedFile(f"dataset {node.name} is packed more than once")
    if h5py.h5z.FILTER_DEFLATE not in filters:
        return
    large: list[tuple[int, ...]] = []
    node.id.chunk_iter(lambda chunk: large.append(chunk.chunk_offset) if chunk.size * MAX_DEFLATE > left else None)
    for place in large:
        _, packed = node.id.read_direct_chunk(place)
        with suppress(zlib.error):  # which HDF5 reports
            if len(zlib.decompressobj().decompress(packed, chunk_bytes + CHECKSUM_BYTES + 1)) > chunk_bytes + CHECKSUM_BYTES:
                raise RefusedFile(f"a chunk of dataset {node.name} unpacks to more than the {chunk_bytes} bytes that it claims")


def _class(node: Any) -> str:
    """Return the class that MATLAB gave to a dataset."""
    if "MATLAB_class" not in node.attrs or node.attrs.get_id("MATLAB_class").get_storage_size() > MAX_ATTRIBUTE:
        return ""
    value = node.attrs["MATLAB_class"]
    return value.decode("latin-1") if isinstance(value, bytes) else str(value)


FORMAT: Format = Format(
    (".h5", ".hdf5"),
    open_hdf5,
    "HDF5",
    IN_THE_NAME,
    about="series, matrices and lengths as in MAT files. They need h5py: `pip install 'strainwave[formats]'`.",
)
