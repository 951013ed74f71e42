"""Gear sets: a gear with the source of each of its numbers, its ratings and the other parts of its drive.

The models describe their own numbers; none is named here. `gear_file` reads and writes the files.
"""

from __future__ import annotations

import dataclasses
import difflib
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import partial
from math import isfinite, nan
from operator import attrgetter
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Protocol, TypeVar, overload, runtime_checkable

from strainwave import Drive, arguments, motor as motors
from strainwave._core import Gear
from strainwave.files import datasheet, gear_file, harmonic_drive
from strainwave.files.described import all_paths, default_of, is_required, parts
from strainwave.files.entries import NOT_GIVEN, Entry, Quantity, check_line
from strainwave.files.identified_tables import Covariance, Validation, check_identified
from strainwave.files.tables import FORMATS
from strainwave.messages import in_a_sentence, quoted, shortened, unquoted
from strainwave.presentation import Pictured, Row

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Kind = TypeVar("Kind", bound=Entry)
_DRIVE_PARTS = [field["name"] for field in Drive.fields]

DRIVES_FOLDER = Path(__file__).parents[1] / "catalogue" / "drives"
BASE_KEY = "base"  # of a file: the set of the catalogue whose tables it has where it has none of its own


class Estimated(Protocol):
    """A fitted number: its path in the model, and its standard deviation, infinite if the data do not determine it."""

    @property
    def path(self) -> str: ...
    @property
    def sigma(self) -> float: ...


@runtime_checkable
class FittedModel(Protocol):
    """A model with fitted numbers, as `sw.fit` gives it. Estimates that are no numbers of the model are of no concern here."""

    @property
    def model(self) -> Any: ...
    @property
    def estimates(self) -> Iterable[Estimated]: ...


GEAR_FILE = "gear.toml"  # of a folder with the results of identify


@dataclass(frozen=True)
class GearSet(Pictured):
    """A gear, the source of each of its numbers, its ratings and the other parts of its drive.

    Two sets are equal if all members are, sources and ratings too. Their gears are equal if models and numbers are: as the
    published tables give HFUC-20-80 and CSG-20-80 the same stiffness and inertia, their gears are equal, the sets are not.

    Args:
        name: what the gear is called, one line of text
        gear: its model
        sources: where each number of the models comes from, by path: "gear.stiffness.k1", "motor.resistance",
            "gear.hysteresis.stiffness[0]"
        maker: who makes it
        note: free text
        ratings: what the maker allows, by name; no part of the model
        motor, control, load, sensors, thermal, meter: the rest of a drive, models of `sw.motor`, `sw.control`, `sw.loads`,
            `sw.thermal` and `sw.meter`, and `sw.Sensors`; None if not known
        covariance: of the numbers that were identified; None if not known
        validation: errors of the model on the files that it was identified from

    Raises:
        ValueError: a number has no source, a source has no number, a covariance is of other numbers, or name or maker is no
            line of text
        TypeError: a text is none, a model is of the wrong family, or a source or rating not of its type

    >>> gear_set = GearSet.read("csg-20-100")
    >>> gear_set.gear.stiffness.k2, gear_set.sources["gear.stiffness.k2"].spread
    (25000.0, 0.3)
    >>> gear_set.ratings["rated_torque"].value
    52.0
    """

    name: str
    gear: Gear
    sources: Mapping[str, Entry] = field(repr=False, hash=False)
    maker: str = ""
    note: str = ""
    ratings: Mapping[str, Quantity] = field(default_factory=dict, repr=False, hash=False)
    motor: Any = None
    control: Any = None
    load: Any = None
    sensors: Any = None
    thermal: Any = None
    meter: Any = None
    covariance: Covariance | None = field(default=None, repr=False)
    validation: tuple[Validation, ...] = field(default=(), repr=False)

    def __post_init__(self) -> None:
        check_line("name", self.name)
        if arguments.text("maker", self.maker):
            check_line("maker", self.maker)
        arguments.text("note", self.note)
        _drive(vars(self))  # refuses what is no model of its family
        arguments.mapping("sources", self.sources, '{"gear.damping": Entry("assumed")}')
        arguments.mapping("ratings", self.ratings, '{"peak_torque": Quantity(…)}')
        paths = list(_paths(vars(self)))
        if bare := [path for path in paths if path not in self.sources]:
            raise ValueError(f"{self.name}: {bare[0]} has no source")
        if extra := self.sources.keys() - set(paths):
            raise ValueError(f"{self.name}: sources name {unquoted(min(extra))}, which is no number of the set")
        check_identified(self.covariance, self.validation, paths)
        object.__setattr__(self, "sources", _frozen(self.sources, Entry))
        object.__setattr__(self, "ratings", _frozen(self.ratings, Quantity))

    def __reduce__(self) -> tuple[partial[GearSet], tuple[()]]:
        return partial(GearSet, **vars(self) | {"sources": dict(self.sources), "ratings": dict(self.ratings)}), ()

    @property
    def drive(self) -> Drive:
        """The drive that the set describes; open loop where it has no control.

        Raises:
            ValueError: the set has no motor or no load.
        """
        if missing := [name for name in ("motor", "load") if getattr(self, name) is None]:
            missing_parts = f"no [{'] and no ['.join(missing)}]"
            raise ValueError(
                f"{self.name} has {missing_parts}; a drive needs a motor and a load; strainwave list drives lists whole drives"
            )
        return _drive(vars(self))

    @property
    def origins(self) -> list[str]:
        """Lines that state which numbers were identified, with ±, the others, and where; empty if none was."""
        return gear_file.origins(self)

    @property
    def measured_ranges(self) -> list[str]:
        """Range of speed, torque, angle and temperature of each file that it was identified from, in words."""
        return gear_file.measured_ranges(self)

    @property
    def left_out(self) -> frozenset[str]:
        """Tables that a file of the set does without, by path: parts that do nothing, of whose numbers no source is given.

        >>> sorted(GearSet.read("hfuc-25-100").left_out)[:4]
        ['gear.friction_mesh', 'gear.kinematic_noise', 'gear.material', 'gear.softening']
        """
        return gear_file.left_out(self)

    @classmethod
    def of(
        cls, model: Gear | Drive | FittedModel, *, name: str, source: str, sources: Mapping[str, Entry] | None = None
    ) -> GearSet:
        """The set of a model, or of a fit.

        A model does not remember which of its numbers were given. So a part that does nothing is "not given", and the
        source of a number that equals its default states that.

        Args:
            model: a gear, a whole drive, or a fit of one
            name: what the gear is called, one line of text
            source: where the numbers come from, one line of text; of a fit, where the fitted ones come from
            sources: other sources of some numbers, by path: of one number as "gear.stiffness.k1", of all numbers of a
                part as "gear.stiffness"; the longer path counts. A fitted number keeps the source of the fit.

        Returns:
            The set. Fitted numbers have their standard deviation as `uncertainty`.

        Raises:
            ValueError: `sources` names what the model does not have, or a text is no line of text
            TypeError: the model is none, or a source is no `Entry`

        >>> import strainwave as sw
        >>> gear = sw.Gear(stiffness=sw.stiffness.Linear(k=800.0), damping=3.0)
        >>> printed = GearSet.of(gear, name="printed", source="torsion loop", sources={"gear.damping": Entry("assumed")})
        >>> for path in ("stiffness.k", "damping", "input_inertia", "friction_input.viscous"):
        ...     print(path, "=", printed.sources[f"gear.{path}"].source)
        stiffness.k = torsion loop
        damping = assumed
        input_inertia = assumed: the default, unless given by: torsion loop
        friction_input.viscous = not given
        """
        if sources is not None:
            arguments.mapping("sources", sources, '{"gear.damping": Entry("assumed")}')
        whole = model.model if isinstance(model, FittedModel) else model
        models = _models(whole)
        _drive(models)  # refuses what is no gear
        rest = Entry("assumed: kept by the fit, its source is not given" if isinstance(model, FittedModel) else source)
        alike = cls(name=name, sources=dict.fromkeys(_paths(models), rest), **models)
        entries = {path: _unless_default(alike, path) for path in alike.sources}
        entries |= {path: Entry(NOT_GIVEN) for path in gear_file.idle(alike)}
        entries |= _named(alike, sources or {})
        if isinstance(model, FittedModel):
            entries |= _estimated(alike, model, source)
        return alike.replace(sources=entries)

    @staticmethod
    def read(name_or_path: str | Path) -> GearSet:
        """Read a set of the catalogue by name, or a gear file by path.

        Args:
            name_or_path: a name in `catalogue()` or `catalogue("drives")`, or a path: what ends in .toml or has a folder.
                A file with a table [datasheet] contains figures of a maker, as `from_datasheet` takes them; one with base =
                "csg-25-100" has the tables of that set where it has none of its own

        Returns:
            The set, in SI units. A table left out is the part that does nothing, its sources are "not given".

        Raises:
            ValueError: no such name or file, or what is wrong in it, with file, table and key.

        >>> import strainwave as sw
        >>> gear_set = sw.GearSet.read("hfuc-25-100")
        >>> round(gear_set.gear.stiffness.k1), gear_set.motor  # N.m/rad; a catalogue of gears has no motors
        (26700, None)
        """
        place = _place(name_or_path)
        with gear_file.at(f"{place}"):
            content = _content(place)
            return _of_sheet(datasheet.read(content)) if "datasheet" in content else GearSet(**gear_file.read(content))

    @staticmethod
    def from_datasheet(ratio: float, **figures: Any) -> GearSet:
        """Return the set of a gear in no catalogue, from its maker's data sheet.

        Args:
            ratio: that with the circular spline held, signed, or with `fixed`
            figures: as k1="31e3 N.m/rad", starting_torque="3.4 cN.m", size=25; all are described at
                `strainwave.files.datasheet.from_datasheet`

        Raises:
            TypeError, ValueError: as there

        >>> printed = GearSet.from_datasheet(ratio=-80, rated_torque="44 N.m", starting_torque="0.5 N.m")
        >>> printed.sources["gear.friction_input.breakaway"].source
        'data sheet, starting torque'
        """
        return _of_sheet(datasheet.from_datasheet(ratio, **figures))

    def replace(self, **changes: Any) -> GearSet:
        """The same with the named members changed; `sources` and `ratings` are replaced as a whole.

        Raises:
            TypeError, ValueError: as the class

        >>> found = Entry("fitted to a friction table", uncertainty=2e-3)
        >>> gear_set = GearSet.read("hfuc-25-100")
        >>> changed = gear_set.replace(
        ...     gear=gear_set.gear.replace(damping=5.0), sources={**gear_set.sources, "gear.damping": found}
        ... )
        >>> changed.sources["gear.damping"].uncertainty
        0.002
        """
        return dataclasses.replace(self, **changes)

    def with_parts(
        self,
        *,
        source: str,
        motor: Any = None,
        control: Any = None,
        load: Any = None,
        sensors: Any = None,
        thermal: Any = None,
        meter: Any = None,
    ) -> GearSet:
        """The same with these parts of a drive, whose numbers come from one source.

        Args:
            source: where they come from, one line of text; a number that equals its default has another one, as in `of`
            motor, control, load, sensors, thermal, meter: as the set has them; what is not given stays

        Raises:
            TypeError: a part is of another family
            ValueError: `source` is no line of text

        >>> import strainwave as sw
        >>> disc = sw.loads.Inertia(inertia=2.0)
        >>> whole = GearSet.read("hfuc-25-100").with_parts(motor=sw.motor.DC(resistance=0.3), load=disc, source="data sheet")
        >>> whole.sources["motor.resistance"].source, whole.drive.load.inertia
        ('data sheet', 2.0)
        """
        models = (motor, control, load, sensors, thermal, meter)
        names = ("motor", "control", "load", "sensors", "thermal", "meter")
        added = {name: part for name, part in zip(names, models, strict=True) if part is not None}
        old = tuple(f"{name}." for name in added)
        kept = {path: entry for path, entry in self.sources.items() if not path.startswith(old)}
        _drive({"gear": self.gear} | added)  # refuses what is no model of its family
        paths = list(_paths(added))
        covariance = None if self.covariance is None else self.covariance.among(kept)
        alike = self.replace(**added, sources=kept | dict.fromkeys(paths, Entry(source)), covariance=covariance)
        return alike.replace(sources=kept | {path: _unless_default(alike, path) for path in paths})

    def save(self, path: str | Path) -> None:
        """Write a gear file that `read` reads back equal, bit for bit.

        Args:
            path: the file, which must end in .toml

        Raises:
            ValueError: the path does not end in .toml.
            OSError: the file cannot be written

        >>> import tempfile
        >>> gear_set = GearSet.read("hfuc-25-100")
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     gear_set.save(f"{folder}/mine.toml")
        ...     GearSet.read(f"{folder}/mine.toml") == gear_set
        True
        """
        gear_file.write(self, Path(path))

    def _headline(self) -> str:
        maker = f", {self.maker}" if self.maker else ""
        others = [name for name in _DRIVE_PARTS if name != "gear" and getattr(self, name) is not None]
        parts = f", with {in_a_sentence(others)}" if others else ""
        return f"{self.name}{maker}{parts}: {self.gear._headline()}"

    def _rows(self) -> Iterator[Row]:
        idle = set(gear_file.idle(self))
        for name in _DRIVE_PARTS:
            if (model := getattr(self, name)) is not None:
                for row in model._rows():
                    path = f"{name}.{row.name}"
                    entry = self.sources.get(path)
                    if path not in idle:
                        sigma = None if entry is None or not isinstance(row.value, float) else entry.sigma(row.value)
                        source = row.note if entry is None else entry.source
                        yield Row(path, row.value, row.unit, nan if sigma is None else sigma, source)
        for name, rating in self.ratings.items():
            yield Row(f"ratings.{name}", rating.value, rating.unit, note=rating.source)

    def _remarks(self) -> Iterator[str]:
        return iter([self.note] if self.note else [])

    def plot(self) -> Figure:
        """Return a figure of the gear: twist over torque, and friction over speed."""
        from strainwave.files.plots import gear_figure

        return gear_figure(self.gear, self.name)


def catalogue(of: str = "gears") -> list[str]:
    """Return the names of the sets that come with the package, in order.

    Args:
        of: "gears", those of makers' catalogues, or "drives", whole ones with motor and load

    Raises:
        ValueError: `of` is neither

    >>> len(catalogue()), catalogue()[0]
    (127, 'csg-14-100')
    >>> catalogue("drives")[:3]
    ['position-drive', 'position-drive-full-friction', 'position-drive-printed']
    """
    if arguments.one_of("of", of, ("gears", "drives")) == "gears":
        return sorted(harmonic_drive.gears())
    return sorted(file.stem for file in DRIVES_FOLDER.glob("*.toml"))


def gear_set_of(model: GearSet | Drive | Gear | str | Path) -> GearSet:
    """Return the set of a drive or a gear, or that of a file by its name or path.

    Raises:
        TypeError: it is none of these
        ValueError: there is no such file, or what is wrong in it
    """
    if isinstance(model, GearSet):
        return model
    if isinstance(model, Drive | Gear):
        return GearSet.of(model, name=f"the {type(model).__name__.lower()}", source="given")
    if not isinstance(model, str | Path):
        raise TypeError(f"drive must be a gear, a drive, a set of one, a name or a path, not {shortened(model)}")
    return GearSet.read(model)


def load(name_or_path: str | Path) -> Any:
    """Return the drive of a file that has a motor and a load, else the gear.

    A saved gear is loaded as a gear, a saved drive as a drive. If the type must be known beforehand, `GearSet.read(path).gear`
    is the gear of any file, and `GearSet.read(path).drive` the drive. Neither has ratings: the set has them, and `simulate`
    takes a set in place of its drive.

    Args:
        name_or_path: a name in `catalogue()` or `catalogue("drives")`, or a path: what ends in .toml or has a folder

    Returns:
        A `Gear` or a `Drive`; of a catalogue's gear a `Gear`.

    Raises:
        ValueError: as `GearSet.read`, which also gives sources and ratings.

    >>> load("hfuc-25-100").stiffness.k2, load("position-drive").motor.resistance
    (50000.0, 2.0)
    """
    gear_set = GearSet.read(name_or_path)
    return gear_set.gear if gear_set.motor is None or gear_set.load is None else gear_set.drive


@overload
def save(model: GearSet, path: str | Path) -> None: ...
@overload
def save(
    model: Gear | Drive | FittedModel,
    path: str | Path,
    *,
    name: str,
    source: str,
    sources: Mapping[str, Entry] | None = None,
) -> None: ...
def save(model: GearSet | Gear | Drive | FittedModel, path: str | Path, **naming: Any) -> None:
    """Write a gear file, which `load` reads back equal, bit for bit.

    Args:
        model: a set, a gear, a drive, or a fit: then its fitted numbers keep their standard deviation
        path: the file, which must end in .toml
        name, source, sources: as `GearSet.of`; a set has its own

    Raises:
        ValueError: the path does not end in .toml, or as `GearSet.of`
        TypeError: name and source are missing, or given for a set which has its own, or as `GearSet.of`
        OSError: the file cannot be written

    >>> import tempfile, strainwave as sw
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     save(sw.Gear(damping=0.1 + 0.2), f"{folder}/mine.toml", name="mine", source="measured on my rig")
    ...     load(f"{folder}/mine.toml").damping
    0.30000000000000004
    """
    if not isinstance(model, GearSet) and (missing := [name for name in ("name", "source") if name not in naming]):
        raise TypeError(
            f"{' and '.join(missing)} must be given: a {type(model).__name__.lower()} does not have them, as in save(gear, "
            'path, name="mine", source="measured on my rig")'
        )
    gear_set = model if isinstance(model, GearSet) else GearSet.of(model, **naming)
    if gear_set is model and naming:
        name, value = min(naming.items())
        raise TypeError(f"{name} = {shortened(value)}: a set has its own; change it by replace before it is saved")
    gear_set.save(path)


def _paths(models: Mapping[str, Any]) -> Iterator[str]:
    """Path of every number of the parts of a drive."""
    for name in _DRIVE_PARTS:
        if models.get(name) is not None:
            yield from all_paths(name, models[name])


def _models(model: Any) -> dict[str, Any]:
    """The parts of a drive, or the gear alone."""
    return {part.name: getattr(model, part.name) for part in parts(model)} if isinstance(model, Drive) else {"gear": model}


def _unless_default(gear_set: GearSet, path: str) -> Entry:
    """Return the entry of a number; its source states if the number equals the default of its model."""
    entry, (place, _, name) = gear_set.sources[path], path.rpartition(".")
    name, _, index = name.partition("[")
    model = attrgetter(place)(gear_set)
    if is_required(model, name) and type(model) is not _default_type(gear_set, place):
        return entry
    value, default = getattr(model, name), default_of(model, name)
    if index:
        number = int(index.removesuffix("]"))
        value, default = value[number], default[number] if number < len(default) else None
    if value != default or entry.assumed:
        return entry
    return Entry(f"assumed: the default, unless given by: {entry.source}")


def _default_type(gear_set: GearSet, place: str) -> type[Any]:
    """Return the type of a part unless another one is given: that part alone has required numbers that nobody gave."""
    holder, _, name = place.rpartition(".")
    return type(default_of(attrgetter(holder)(gear_set) if holder else Drive, name))


def _named(gear_set: GearSet, sources: Mapping[str, Entry]) -> dict[str, Entry]:
    """The entries of numbers that are named by themselves or by what they are part of; the longer name counts."""
    arguments.mapping("sources", sources, '{"gear.damping": Entry("assumed")}')
    named: dict[str, Entry] = {}
    for place, entry in sorted(_frozen(sources, Entry).items(), key=lambda item: len(item[0])):
        inside = [path for path in gear_set.sources if path == place or path.startswith((f"{place}.", f"{place}["))]
        if not inside:
            near = ", ".join(difflib.get_close_matches(place, gear_set.sources, n=3, cutoff=0.0))
            raise ValueError(
                f"{gear_set.name}: sources name {unquoted(place)}, which is no number or part of the model; near it are {near}"
            )
        named |= dict.fromkeys(inside, entry)
    return named


def _estimated(gear_set: GearSet, fit: FittedModel, source: str) -> dict[str, Entry]:
    """The entries of fitted numbers; the paths of a gear's fit begin inside the gear."""
    before = "" if isinstance(fit.model, Drive) else "gear."
    entries = {}
    for estimate in fit.estimates:
        determined = isfinite(estimate.sigma)
        entry = Entry(source, uncertainty=estimate.sigma) if determined else Entry(f"not determined by: {source}")
        entries[before + estimate.path] = entry
    return {path: entry for path, entry in entries.items() if path in gear_set.sources}


def _of_sheet(sheet: datasheet.DatasheetGear) -> GearSet:
    """Return the set of a gear by its data sheet."""
    gear_set = GearSet.of(sheet.gear, name=sheet.name, source=sheet.source, sources=sheet.sources)
    return gear_set.replace(maker=sheet.maker, note=sheet.note, ratings=sheet.ratings)


def _drive(models: Mapping[str, Any]) -> Drive:
    """The drive of these models, with the default for each that is None."""
    rest = {name: models[name] for name in _DRIVE_PARTS if name == "gear" or models.get(name) is not None}
    # Every controller can act on a brushless motor; another motor is checked once it is known.
    return Drive(**{"motor": motors.BrushlessDC()} | rest)


def _frozen(entries: Mapping[str, Kind], kind: type[Kind]) -> Mapping[str, Kind]:
    for key, entry in entries.items():
        if not isinstance(key, str):
            raise TypeError(f"a number is named by a text, not {shortened(key)}")
        if not isinstance(entry, kind):
            raise TypeError(f"{unquoted(key)} must have a strainwave.files.{kind.__name__}, not {shortened(entry)}")
    return MappingProxyType(dict(entries))


def _content(place: str | Path) -> dict[str, Any]:
    """Return the content of a gear of the catalogue, or of a file, with the tables of the set that the file is based on."""
    if isinstance(place, str):
        return harmonic_drive.document(place)
    content = gear_file.document(place)
    if BASE_KEY not in content:
        return content
    base = arguments.text(BASE_KEY, content.pop(BASE_KEY))
    of_base = _place_of_set(spelled(base))
    if of_base is None:
        raise ValueError(f"{BASE_KEY} = {quoted(base)} is no set of the catalogue, which `strainwave list` lists")
    return {key: table for key, table in _content(of_base).items() if isinstance(table, dict)} | content


def _place_of_set(name: str) -> str | Path | None:
    """Return the name of a gear of the catalogue, or the file of a drive; None if there is no set of this name."""
    if name in harmonic_drive.gears():
        return name
    return DRIVES_FOLDER / f"{name}.toml" if name in catalogue("drives") else None


def _place(name_or_path: str | Path) -> str | Path:
    """Return the name of a gear of the catalogue, or the path of a file."""
    path = Path(name_or_path)
    if path.suffix.lower() in FORMATS and path.is_file():
        if path.name == "results.json" and (gear := path.with_name(GEAR_FILE)).exists():
            raise ValueError(f"{unquoted(str(path))} is a result of identify; its gear is {gear} beside it")
        raise ValueError(
            f"{unquoted(str(path))} holds measurements, where a gear is asked for: give the name of a set, as hfuc-25-100, or "
            "a gear file, which ends in .toml"
        )
    if isinstance(name_or_path, Path) or path.name != name_or_path or path.suffix == ".toml":
        return path / GEAR_FILE if path.is_dir() else path
    name = spelled(name_or_path)
    if (of_set := _place_of_set(name)) is not None:
        return of_set
    if path.is_dir():
        return path / GEAR_FILE
    size, _, ratio = name.rpartition("-")
    ratios = sorted(int(each.rpartition("-")[2]) for each in catalogue() if each.rpartition("-")[0] == size)
    near = ", ".join(difflib.get_close_matches(name, catalogue() + catalogue("drives")))
    hint = f"; near it are {near}" if near else ""
    hint = f"; {size} has no ratio of {ratio}, but {', '.join(map(str, ratios))}" if ratios and ratio.isdigit() else hint
    raise ValueError(
        f"no set {quoted(name_or_path)} in the catalogue{hint}; "
        'strainwave.catalogue() lists all gears, catalogue("drives") all drives, and the path of a file ends in .toml'
    )


def spelled(name: str) -> str:
    """Return a name, or a part of one, as the catalogue spells it: makers print HFUC-25-100 or HFUC 25-100.

    >>> spelled("HFUC_25 100")
    'hfuc-25-100'
    """
    return re.sub(r"[\s_]+", "-", name.strip().casefold())
