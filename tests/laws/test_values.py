"""What every model of every list is: described, documented, checked, frozen, a value."""

from __future__ import annotations

import copy
import doctest
import math
import pickle
import re
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import strainwave as sw
from hypothesis import given, strategies as st
from strainwave import _core
from strainwave.files import units
from strainwave.presentation import MAX_REPR

from tests.support.each import each
from tests.support.strategies import Field, drives, fitting, gears, models, usual

FAMILIES = [*_core.families.values(), *_core.fault_families.values()]
LISTED = [model for family in FAMILIES for model in family.values()]
COMPOSED = [sw.Gear, sw.Drive]
EVERY_MODEL = [*LISTED, *COMPOSED]
EVERY_FIELD = [
    pytest.param(model, field, id=f"{model.name}.{field['name']}") for model in EVERY_MODEL for field in model.fields
]
EVERY_NUMBER = [case for case in EVERY_FIELD if case.values[1]["kind"] in ("number", "sequence", "count")]
EVERY_PART = [case for case in EVERY_FIELD if case.values[1]["kind"] == "part"]
EVERY_CHOICE = [case for case in EVERY_FIELD if case.values[1]["kind"] == "choice"]

any_numbers = st.one_of(
    [models(family) for family in ("friction", "stiffness", "hysteresis", "kinematic_error", "kinematic_noise")]
    + [gears, drives]
)
any_value = st.one_of([models(family) for family in _core.families] + [gears, drives])
every_model = each("model", EVERY_MODEL)


def shown(model: type, field: Field, value: float) -> str:
    """How a message names a number: model, field, place, value, unit."""
    place = "[0]" if field["kind"] == "sequence" else ""
    unit = "" if field["unit"] == "1" else f" {field['unit']}"
    return f"{model.name}.{field['name']}{place} = {repr(float(value)).removesuffix('.0')}{unit}"


def refusal(model: Any, field: Field, value: object) -> str:
    """What a model says to one value of a field; nothing if it takes it."""
    try:
        with warnings.catch_warnings(action="ignore", category=_core.PassivityWarning):
            model(**(usual(model) | {field["name"]: [value] if field["kind"] == "sequence" else value}))
    except (TypeError, ValueError) as error:
        return str(error)
    return ""


# Described and documented


@every_model
def test_a_model_names_its_source(model: type) -> None:
    assert re.search(r"[A-Za-z]{4}", model.source)


@every_model
def test_the_documentation_has_an_example_that_runs(model: type) -> None:
    example = doctest.DocTestParser().get_doctest(model.__doc__, {}, model.__name__, None, None)
    assert example.examples
    assert doctest.DocTestRunner(optionflags=doctest.FAIL_FAST).run(example) == (0, len(example.examples))


@every_model
def test_the_documentation_has_its_equation_and_every_symbol_of_its_fields(model: type) -> None:
    text, parameters = model.__doc__.split("Parameters\n----------\n")
    assert ".. math::" in text
    for field in model.fields:
        assert f"\n{field['name']}: {field['doc']}" in "\n" + parameters


@each(("model", "field"), EVERY_FIELD)
def test_a_field_has_a_name_a_text_and_a_unit_in_standard_spelling(model: type, field: Field) -> None:
    assert field["name"].isidentifier()
    assert re.match(r"[A-Z\d]", field["doc"])
    assert field["unit"] == "" if field["kind"] == "part" else units.check(field["unit"]) == field["unit"]


def test_no_two_models_of_a_family_share_a_name() -> None:
    for family in FAMILIES:
        assert {model.name for model in family.values()} == set(family)


# Checked


@each(("model", "field"), EVERY_NUMBER)
@each("sense", [-1.0, 1.0])
def test_a_number_out_of_its_range_is_refused_with_its_limits(model: type, field: Field, sense: float) -> None:
    limit = field["min"] if sense < 0.0 else field["max"]
    beyond = sense * math.inf if limit is None else limit + sense
    message = re.escape(shown(model, field, beyond)) + r" must lie in [\[(](\S+), (\S+)[\])]"
    found = re.fullmatch(message, refusal(model, field, beyond))
    assert found
    low, high = map(float, found.groups())
    assert low == (-math.inf if field["min"] is None else field["min"])
    assert high == (math.inf if field["max"] is None else field["max"])


@each(("model", "field"), [case for case in EVERY_NUMBER if case.values[1]["min"] is not None])
def test_a_lower_limit_is_taken_just_if_its_bracket_says_so(model: type, field: Field) -> None:
    closed = "must lie in [" in refusal(model, field, field["min"] - 1.0)
    assert ("must lie in" not in refusal(model, field, field["min"])) == closed
    assert closed != field["open"]


@each(("model", "field"), EVERY_NUMBER)
def test_not_a_number_is_refused(model: type, field: Field) -> None:
    assert shown(model, field, math.nan) in refusal(model, field, math.nan)


@each(("model", "field"), EVERY_NUMBER)
@each("value", [None, True, 1j, object, np.complex128(1j), np.ma.masked, np.array(1j), np.array(True)])
def test_what_is_no_number_is_refused(model: type, field: Field, value: object) -> None:
    given = [value] if field["kind"] == "sequence" else value
    with pytest.raises(TypeError, match=rf"^{model.name}\.{field['name']} must be a number, not "):
        model(**(usual(model) | {field["name"]: given}))


@each(("model", "field"), EVERY_NUMBER)
def test_a_text_with_a_unit_is_the_number_and_is_refused_without(model: type, field: Field) -> None:
    name, unit = field["name"], field["unit"]
    made = model(**usual(model))
    value = getattr(made, name)
    if unit in ("", "1"):
        assert re.search(rf"{name} must be a (whole )?number, not '1 rad'$", refusal(model, field, "1 rad"))
        return
    text = [f"{each!r} {unit}" for each in value] if field["kind"] == "sequence" else f"{value!r} {unit}"
    assert model(**(usual(model) | {name: text})) == made
    assert refusal(model, field, "1").endswith(
        f'{name}{"[0]" * (field["kind"] == "sequence")} = "1" has no unit; write a number and its unit, as "1.2 {unit}"'
    )
    assert refusal(model, field, "1 kg.s").endswith(
        f'cannot convert "kg.s" to "{unit}"; write a number and its unit, as "1.2 {unit}"'
    )


@each(("model", "field"), EVERY_CHOICE)
def test_a_choice_is_one_of_its_options(model: type, field: Field) -> None:
    assert len(field["options"]) > 1
    for option in field["options"]:
        assert getattr(model(**usual(model)).replace(**{field["name"]: option}), field["name"]) == option
    assert refusal(model, field, "neither").endswith("not 'neither'")


@each(("model", "field"), EVERY_PART)
@each("value", [None, 1.0, "lugre"])
def test_a_part_is_a_model_of_its_family(model: type, field: Field, value: object) -> None:
    with pytest.raises(TypeError, match=rf"^{model.name}\.{field['name']} must be "):
        model(**(usual(model) | {field["name"]: value}))


@every_model
def test_an_unknown_parameter_is_refused_and_the_known_ones_are_named(model: type) -> None:
    names = ", ".join(field["name"] for field in model.fields)
    message = f"^{model.name} has no parameter 'unheard_of'; it has {names}$"
    with pytest.raises(TypeError, match=message):
        model(**usual(model), unheard_of=1.0)
    with pytest.raises(TypeError, match=message):
        model(**usual(model)).replace(unheard_of=1.0)


@every_model
def test_sequences_that_belong_together_are_equally_long_and_not_too_long(model: type) -> None:
    sequences = [field for field in model.fields if field["kind"] == "sequence"]
    for field in sequences:
        too_long = 1000 * [fitting(field)]
        with pytest.raises(ValueError, match=rf"^{model.name}\.{field['name']} holds at most \d+ elements$"):
            model(**(usual(model) | {field["name"]: too_long}))
    # a series may have sines alone, a map has a torque for each speed and angle, and matrices have rows
    if len(sequences) > 1 and model not in (sw.friction.PositionDependent, sw.friction.AngleSpeedMap, sw.control.StateSpace):
        with pytest.raises(ValueError, match=rf"^{model.name}: .* must have equally many elements$"):
            model(**(usual(model) | {sequences[0]["name"]: [fitting(sequences[0])]}))


# Required and following


@every_model
def test_what_is_required_is_named_where_it_is_missing_and_nothing_else(model: Any) -> None:
    required = [field["name"] for field in model.fields if field["required"]]
    if not required:
        model()
        return
    with pytest.raises(TypeError, match=rf"^{model.name} needs {', '.join(required)}: no default suits most gears$"):
        model()
    for name in required:
        with pytest.raises(TypeError, match=rf"^{model.name} needs {name}: "):
            model(**{other: value for other, value in usual(model).items() if other != name})


@each(("model", "field"), [case for case in EVERY_FIELD if case.values[1]["follows"]])
def test_what_follows_is_as_large_as_its_leader_unless_it_is_given(model: Any, field: Field) -> None:
    names = [each["name"] for each in model.fields]
    leader = model.fields[names.index(field["follows"])]
    assert names.index(leader["name"]) < names.index(field["name"])
    assert leader["unit"] == field["unit"]
    others = {name: value for name, value in usual(model).items() if name != field["name"]}
    assert getattr(model(**(others | {leader["name"]: 0.25})), field["name"]) == 0.25
    given = model(**(others | {leader["name"]: 0.25, field["name"]: 0.5}))
    assert getattr(given, field["name"]) == getattr(given.replace(**{leader["name"]: 0.125}), field["name"]) == 0.5


@every_model
def test_the_documentation_says_what_is_required_and_what_follows(model: Any) -> None:
    for field in model.fields:
        said = "required" if field["required"] else f"default as {field['follows']}" if field["follows"] else "default .+"
        assert re.search(rf"^{field['name']}: .*; {said}$", model.__doc__, re.MULTILINE)


@every_model
def test_nothing_can_be_derived_from_a_model(model: Any) -> None:
    with pytest.raises(TypeError, match="prohibits subclassing"):
        type("Derived", (model,), {})


@every_model
def test_a_model_that_was_never_made_is_no_part_of_another(model: Any) -> None:
    for whole in EVERY_MODEL:
        for field in whole.fields:
            if model in ([*field["options"].values()] if field["kind"] == "part" and field["options"] else []):
                with pytest.raises(TypeError, match=rf"^{whole.name}\.{field['name']} must be "):
                    whole(**(usual(whole) | {field["name"]: model.__new__(model)}))


# Values


@pytest.mark.slow("physics")
@given(any_value)
def test_what_is_printed_is_what_makes_the_same_value_if_one_line_has_room_for_it(value: Any) -> None:
    parts_last = reversed(EVERY_MODEL)  # so that a part of a drive wins over a fault or an onset of its name
    names = {model.__name__: model for model in [*parts_last, sw.Sensors, sw.Compensation, sw.Gear]}
    name, printed = type(value).__name__, repr(value)
    fields = (f"{field['name']}={getattr(value, field['name'])!r}" for field in value.fields)
    whole = f"{name}({', '.join(fields)})"
    if len(whole) > MAX_REPR or "=<" in whole:  # too long, or a part of it is
        assert printed.startswith(f"<{name}: ")
    else:
        assert eval(printed, names) == value


ways_to_copy = st.sampled_from(
    [copy.copy, copy.deepcopy]
    + [
        lambda value, protocol=protocol: pickle.loads(pickle.dumps(value, protocol))
        for protocol in range(pickle.HIGHEST_PROTOCOL + 1)
    ]
)
states = st.one_of([models(family, "State") for family in ("friction", "hysteresis")]).map(lambda law: law.State())
run_states = drives.map(lambda drive: drive.rest())


@given(any_value | states | run_states, ways_to_copy)
def test_a_value_survives_pickling_and_copying(value: Any, copied: Callable[[Any], Any]) -> None:
    twin = copied(value)
    assert twin == value
    assert type(twin) is type(value)
    assert hash(twin) == hash(value)


@given(any_value)
def test_a_value_is_made_of_its_fields(value: Any) -> None:
    members = {field["name"]: getattr(value, field["name"]) for field in value.fields}
    assert type(value)(**members) == value
    assert value.replace() == value
    assert type(value)(**usual(type(value))).replace(**members) == value


@given(any_value, any_value)
def test_values_are_equal_just_if_type_and_members_are(one: Any, other: Any) -> None:
    same = type(one) is type(other) and all(
        getattr(one, field["name"]) == getattr(other, field["name"]) for field in one.fields
    )
    assert (one == other) == same


@given(any_value)
def test_a_value_is_frozen(value: Any) -> None:
    for field in value.fields:
        with pytest.raises(AttributeError):
            setattr(value, field["name"], getattr(value, field["name"]))


@given(any_numbers)
def test_numbers_taken_out_and_put_back_make_the_same_value(value: Any) -> None:
    parameters = _core.parameters(value)
    assert _core.with_numbers(value, [number for _, number, *_ in parameters]) == value
    for path, number, unit, doc, low, high in parameters:
        assert low <= number <= high, path
        assert units.check(unit) == unit
        assert doc
