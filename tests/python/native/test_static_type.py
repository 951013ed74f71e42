"""The static type of a drive is C++ that compiles, whatever models it has."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from strainwave.native.static_type import in_words, parameters, static_type

from tests.evidence.stress import model
from tests.support.cplusplus import HEADERS, checker, compilation
from tests.support.strategies import made

# Its state is made, so that every member of the compiled drive has a complete type.
USE = "inline auto started_{number}() {{ return {drive}{{}}.compile().initial_state(); }}\n"


def laws(kind: Any) -> Iterator[Any]:
    """A law of usual numbers with each law in turn that it may hold; of a gear in it, the usual ones."""
    yield made(kind)
    for field in kind.fields:
        name, options = field["name"], field["options"]
        if field["kind"] == "part" and options:
            for option in options.values():
                for law in laws(option):
                    with suppress(ValueError):  # parts that do not go together, as a feed-forward and a prescribed load
                        yield made(kind, **{name: law})
        elif field["kind"] == "part" and type(field["default"]) is not sw.Gear:
            law = {"law": sw.control.PID()}  # which follows an angle, as a compensation needs it
            yield from (made(kind, **law, **{name: part}) for part in with_part(type(field["default"]), field["default"]))


def with_part(kind: Any, base: Any) -> Iterator[Any]:
    """A drive or its gear or sensors with every law in turn at every place."""
    for name in parameters(kind):
        (options,) = (field["options"] for field in kind.fields if field["name"] == name)
        if options is None:
            yield from (base.replace(**{name: part}) for part in with_part(type(getattr(base, name)), getattr(base, name)))
        else:
            yield from (base.replace(**{name: law}) for option in options.values() for law in laws(option))


def compiles(drives: list[Any], folder: Path) -> tuple[int, str]:
    types = dict.fromkeys(static_type(drive, "double") for drive in drives)
    uses = "".join(USE.format(number=number, drive=drive) for number, drive in enumerate(types))
    return compilation(checker("g++"), folder, {"types.cpp": HEADERS + uses})


@pytest.mark.slow("native")
def test_every_law_at_every_place_has_a_type_that_compiles(tmp_path: Path) -> None:
    winding = made(sw.motor.DC, inductance=1e-3)
    drives = list(with_part(sw.Drive, sw.Drive(gear=sw.Gear(input_inertia=1e-5), motor=winding)))
    names = "".join(map(static_type, drives))
    assert all(f"::{kind.__name__}<" in names for family in sw._core.families.values() for kind in family.values())
    assert len(drives) > 500
    assert compiles(drives, tmp_path) == (0, "")


@pytest.mark.slow("native")
def test_drives_of_any_laws_have_types_that_compile(tmp_path: Path) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        drives = [model(sw.Drive, np.random.default_rng(number)) for number in range(100)]
    assert compiles(drives, tmp_path) == (0, "")


def test_the_type_is_that_of_the_laws() -> None:
    drive = sw.Drive(
        control=sw.control.Sampled(law=sw.control.PID(), period=1e-3),
        gear=sw.Gear(friction_input=sw.friction.Thermal(law=made(sw.friction.LuGre)), hysteresis=sw.hysteresis.Preisach()),
        load=sw.loads.Pendulum(),
        meter=sw.meter.EnergyMeter(),
    )
    assert static_type(drive, "float") == (
        "strainwave::Drive<float, strainwave::control::Sampled<float, strainwave::control::PID<float>, "
        "strainwave::Compensation<float, strainwave::compensation::NoFeedforward<float>, "
        "strainwave::compensation::NoLearning<float>, strainwave::compensation::NoObserver<float>, "
        "strainwave::compensation::NoDither<float>>>, "
        "strainwave::motor::DC<float>, strainwave::Gear<float, strainwave::kinematics::StrainWave<float>, "
        "strainwave::kinematic_error::Fourier<float>, strainwave::kinematic_error::Stochastic<float>, "
        "strainwave::stiffness::Linear<float>, "
        "strainwave::hysteresis::Preisach<float, strainwave::hysteresis::PowerDensity<float>>, "
        "strainwave::friction::Thermal<float, strainwave::friction::LuGre<float>>, strainwave::friction::Viscous<float>, "
        "strainwave::friction::Viscous<float>, strainwave::softening::ThermalSoftening<float>, "
        "strainwave::structure::Lumped<float>, strainwave::variation::Constant<float>, strainwave::material::Elastic<float>>, "
        "strainwave::load::Pendulum<float>, "
        "strainwave::Sensors<float, strainwave::sensor::Ideal<float>>, strainwave::thermal::Isothermal<float>, "
        "strainwave::meter::EnergyMeter<float>>"
    )


def test_numbers_are_no_part_of_the_type() -> None:
    assert static_type(sw.Drive(load=sw.loads.Inertia(inertia=1.0))) == static_type(sw.Drive())


def test_laws_of_one_role_are_named_once_if_they_are_alike() -> None:
    ideal, gain = "strainwave::sensor::Ideal<S>", "strainwave::sensor::Gain<S>"
    sensors = {"torque": sw.sensor.Gain()}
    assert static_type(sw.Sensors()) == f"strainwave::Sensors<S, {ideal}>"
    assert static_type(sw.Sensors(**sensors)) == f"strainwave::Sensors<S, {', '.join([*5 * [ideal], gain])}>"
    periodic, constant = "strainwave::variation::Periodic<S>", "strainwave::variation::Constant<S>"
    rigid = "strainwave::ring::Rigid<S>"
    staged = made(sw.structure.Staged, coupling_variation=made(sw.variation.Periodic))
    assert static_type(staged) == f"strainwave::structure::Staged<S, {', '.join([rigid, periodic, *3 * [constant]])}>"


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({}, "default laws"),
        ({"load": sw.loads.Pendulum(), "control": sw.control.PID()}, "control PID, load Pendulum"),
        ({"control": sw.control.Sampled(law=sw.control.PID(), period=1e-3)}, "control Sampled(PID)"),
        ({"gear": sw.Gear(friction_mesh=sw.friction.Cyclic(law=sw.friction.Asymmetric()))},
         "friction_mesh Cyclic(Asymmetric(Viscous))"),
        ({"sensors": sw.Sensors(current=sw.sensor.Gain())}, "current Gain"),
    ],
)  # fmt: skip
def test_a_drive_in_words_is_what_differs_from_the_usual_laws(changed: dict[str, Any], words: str) -> None:
    assert in_words(sw.Drive(**changed)) == words
