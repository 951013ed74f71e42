"""Models, parameters and units as JSON: what the page knows of them, from the fields of the models themselves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from inspect import cleandoc
from typing import Any

from strainwave import Drive, control, motor
from strainwave.files.gear_file import optional_tables
from strainwave.files.units import base_exponents, convert
from strainwave.simulation.signals import command_unit

UNITS = {  # of the menus of the page, SI first
    "angle": ("rad", "mrad", "deg", "arcmin", "arcsec"),
    "speed": ("rad/s", "deg/s", "rpm"),
    "torque": ("N.m", "mN.m", "kgf.m", "kgf.cm"),
}


SYMBOLS = (  # of units that the page reads in gear files; the package reads more
    *("s", "ms", "us", "min", "h", "Hz", "m", "mm", "um", "cm", "kg", "g", "A", "mA", "K", "rad", "mrad", "deg", "arcmin"),
    *(
        "arcsec",
        "rev",
        "rpm",
        "N",
        "mN",
        "kN",
        "kgf",
        "J",
        "mJ",
        "W",
        "kW",
        "V",
        "mV",
        "Ohm",
        "mOhm",
        "H",
        "mH",
        "uH",
        "Wb",
        "mWb",
    ),
)


def values_of(model: Any) -> dict[str, Any]:
    """Return the parameters of a model as nested dictionaries, in the form of a gear file.

    >>> values_of(Drive().gear.stiffness)
    {'k': 10000.0}
    """
    return {field["name"]: _value(getattr(model, field["name"]), field) for field in model.fields}


def _value(value: Any, field: Mapping[str, Any]) -> Any:
    if field["kind"] == "part":
        return ({"model": value.name} if field["options"] else {}) | values_of(value)
    return list(value) if field["kind"] == "sequence" else value


def model_of(kind: type[Any], values: Mapping[str, Any]) -> Any:
    """Return the model that `values_of` returned the parameters of.

    >>> model_of(Drive, values_of(Drive())) == Drive()
    True
    """
    given = {}
    for field in kind.fields:
        value = values[field["name"]]
        if field["kind"] == "part":
            of = field["options"][value["model"]] if field["options"] else type(field["default"])
            value = model_of(of, value)
        given[field["name"]] = value
    return kind(**given)


def schema() -> dict[str, Any]:
    """Return all models that a drive may contain, by their names in Python, symbols of units, and the page's menus of units.

    The fields of a model are in the order in which the compiled core takes a set of parameters apart.

    >>> schema()["models"]["friction.Viscous"]["fields"][0]["unit"]
    'N.m.s/rad'
    """
    models: dict[str, Any] = {}
    _describe(Drive, models)
    return {
        "models": models,
        "symbols": {symbol: base_exponents(symbol) for symbol in SYMBOLS},
        "units": {of: {name: convert(1.0, name, names[0]) for name in names} for of, names in UNITS.items()},
    }


def python_name(kind: type[Any]) -> str:
    """Return the name of a class of models behind `sw.`, as friction.Viscous."""
    module = kind.__module__.removeprefix("strainwave.")
    return kind.__name__ if module.startswith(("_core", "strainwave")) else f"{module}.{kind.__name__}"


def _describe(kind: type[Any], models: dict[str, Any]) -> str:
    """Add a class of models and those of its parts. Return its name."""
    name = python_name(kind)
    if name not in models:
        models[name] = {}
        text = cleandoc(kind.__doc__ or "").partition("\n\nParameters\n")[0].partition("\n\n>>>")[0]
        if text.endswith(":"):  # the words before an example
            text = text.rpartition("\n\n")[0]
        models[name] |= {
            "name": getattr(kind, "name", ""),
            "doc": text,
            "source": getattr(kind, "source", ""),
            "fields": [_field(field, models) | _optional_part(kind, field["name"]) for field in kind.fields],
            "command": _command_unit(kind),
        }
    return name


def _optional_part(kind: type[Any], name: str) -> dict[str, bool]:
    """Return a mark of a part whose table a gear file may leave out; nothing for any other member."""
    return {"absent": True} if name in optional_tables(kind) else {}


def _command_unit(kind: type[Any]) -> str:
    """Return the unit of the command of a controller, or of a motor in open loop; empty if a part decides it."""
    if kind.__module__ == motor.__name__:
        return command_unit(Drive(motor=kind()))
    if kind.__module__ != control.__name__ or kind in (control.OpenLoop, control.Sampled):
        return ""
    return command_unit(Drive(motor=motor.DC(inductance=1e-3), control=kind()))


def _field(field: Mapping[str, Any], models: dict[str, Any]) -> dict[str, Any]:
    default, kind = field["default"], field["kind"]
    keys = ("name", "unit", "doc", "min", "max", "open", "required", "optional", "follows")
    entry = {key: field[key] for key in keys if field[key] is not None and field[key] is not False}
    if kind == "part":
        options: Sequence[type[Any]] = list((field["options"] or {"": type(default)}).values())
        entry |= {"options": [_describe(each, models) for each in options], "chosen": bool(field["options"])}
    elif kind == "choice":
        entry["options"] = list(field["options"])
    elif kind == "count" and isinstance(default, int):  # stored among the whole numbers; any other count is a number
        kind = "whole"
    return entry | {"kind": kind, "default": _value(default, field)}
