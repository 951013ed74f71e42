"""Gears, drives and laws for a person: the forms of `presentation`, given to the classes of the compiled core."""

from __future__ import annotations

import re
from collections.abc import Iterator
from types import ModuleType
from typing import TYPE_CHECKING, Any

from strainwave import _core
from strainwave.presentation import MAX_REPR, Presented, Row, counted

if TYPE_CHECKING:
    from matplotlib.figure import Figure

FORMS = ("__str__", "_repr_html_", "to_dict", "to_frame", "_remarks", "_picture")


class Model(Presented):
    """A model of the core: its numbers by their paths, and its parts by their names."""

    def _headline(self: Any) -> str:
        from strainwave.files.described import default_of, parts

        chosen = [part.name for part in parts(self) if part.options is not None and part.name != "kinematics"]
        own = [name for name in chosen if getattr(self, name) != default_of(self, name)]
        laws = [f"{name.replace('_', ' ')} {type(getattr(self, name)).__name__}" for name in own]
        gear = getattr(self, "gear", self)
        ratio = [f"ratio {float(gear.kinematics.ratio):g}"] if hasattr(gear, "kinematics") else []
        if hasattr(self, "motor") and "motor" not in own:
            laws.insert(0, f"motor {type(self.motor).__name__} by default")
        return ", ".join([*ratio, *laws]) or counted(len(_core.parameters(self)), "number")

    def _rows(self: Any) -> Iterator[Row]:
        return _numbers(self, "", noted=True)

    def __repr__(self: Any) -> str:
        """Return the Python expression of the model if it has at most 120 characters; else its laws, or its first numbers."""
        from strainwave.files.described import parts

        whole = str(_constructors[type(self)](self))
        if len(whole) <= MAX_REPR and "=<" not in whole:
            return whole
        name = type(self).__name__
        numbers = whole[len(name) + 1 : -1]
        ends = [end.start() for end in _NEXT_NUMBER.finditer(numbers) if len(f"<{name}: , …>") + end.start() <= MAX_REPR]
        return Presented.__repr__(self) if parts(self) or not ends else f"<{name}: {numbers[: ends[-1]]}, …>"

    def plot(self: Any) -> Figure:
        """Return a figure of a gear, or of that of a drive: twist over torque, and friction over speed.

        >>> import strainwave as sw
        >>> sw.load("hfuc-25-100").plot().get_suptitle()
        'Gear of ratio −100'
        """
        from strainwave.files.plots import gear_figure

        gear = getattr(self, "gear", self)
        return gear_figure(gear, f"Gear of ratio {gear.kinematics.ratio:g}".replace("-", "−"))


_NEXT_NUMBER = re.compile(r", (?=\w+=)")  # in the text of a constructor
_constructors: dict[type, Any] = {}


def _numbers(model: Any, path: str, noted: bool = False) -> Iterator[Row]:
    """Yield each number of a model, then its parts: the law of each, and its numbers unless it is the default."""
    from strainwave.files.described import default_of, parts
    from strainwave.presentation import rows_of

    has_parts = bool(parts(model))
    for field in model.fields:
        name, value = field["name"], getattr(model, field["name"])
        if field["kind"] != "part":
            for row in rows_of(f"{path}{name}", value, field["unit"] or ""):
                yield row if has_parts or not noted else row._replace(note=field["doc"])
    for part in parts(model):
        inner = getattr(model, part.name)
        if inner == default_of(model, part.name):
            yield Row(f"{path}{part.name}", type(inner).__name__, note="as by default")
        else:
            yield Row(f"{path}{part.name}", type(inner).__name__)
            yield from _numbers(inner, f"{path}{part.name}.")


def present() -> None:
    """Give every class of the core its forms."""
    families = [member for member in vars(_core).values() if isinstance(member, ModuleType)]
    models = [_core.Gear, _core.Drive, _core.Compensation, _core.Sensors]
    classes = [*models, *(each for family in families for each in vars(family).values() if isinstance(each, type))]
    for each in classes:
        if not hasattr(each, "fields") or each in _constructors:
            continue
        _constructors[each] = each.__repr__
        each.__repr__ = Model.__repr__  # type: ignore[method-assign,assignment]
        for form in (*FORMS, "_headline", "_rows"):
            setattr(each, form, getattr(Model, form))
    for each in (_core.Gear, _core.Drive):
        each.plot = Model.plot  # type: ignore[method-assign]
