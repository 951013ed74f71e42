"""Descriptions of an FMU in XML: of its variables for tools that import it, and of its sources for those that compile it."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from importlib import metadata
from xml.etree import ElementTree

from strainwave.export.fmu.variables import Variable
from strainwave.files.units import base_exponents

Element = ElementTree.Element
STOP_TIME = 1.0  # s, of the default experiment
# Display units of a unit: a value in the display unit is factor times the value plus offset.
DISPLAY_UNITS = {
    "rad": (("deg", 180.0 / math.pi, 0.0), ("arcmin", 10_800.0 / math.pi, 0.0), ("mrad", 1e3, 0.0)),
    "rad/s": (("rpm", 30.0 / math.pi, 0.0), ("deg/s", 180.0 / math.pi, 0.0)),
    "K": (("degC", 1.0, -273.15),),
}


@dataclass(frozen=True)
class Description:
    """What both versions of FMI describe of an FMU.

    Attributes:
        name, identifier: of the model, and of its files
        token: that ties a binary to its description
        text: one line on the drive
        step: default communication step [s]
        variables: in the order of the value references
    """

    name: str
    identifier: str
    token: str
    text: str
    step: float
    variables: list[Variable]


def model_description(about: Description, version: int) -> bytes:
    """Return the file modelDescription.xml of an FMU for version 2 or 3 of FMI."""
    root = Element("fmiModelDescription", fmiVersion=f"{version}.0", modelName=about.name)
    root.set("guid" if version == 2 else "instantiationToken", about.token)
    root.set("description", about.text)
    root.set("generationTool", f"strainwave {metadata.version('strainwave')}")
    root.set("variableNamingConvention", "structured")
    root.append(_co_simulation(about, version))
    root.append(_unit_definitions({each.unit for each in about.variables} | {"s"}))
    categories = ElementTree.SubElement(root, "LogCategories")
    ElementTree.SubElement(categories, "Category", name="logStatusError", description="Errors")
    experiment = {"startTime": "0.0", "stopTime": repr(STOP_TIME), "stepSize": repr(about.step)}
    ElementTree.SubElement(root, "DefaultExperiment", experiment)
    listed = ElementTree.SubElement(root, "ModelVariables")
    if version == 2:
        listed.extend(_variable_2(each) for each in about.variables)
    else:
        time = {"name": "time", "valueReference": "0", "causality": "independent", "variability": "continuous", "unit": "s"}
        ElementTree.SubElement(listed, "Float64", time)
        listed.extend(_variable_3(each) for each in about.variables)
    root.append(_structure_2(about.variables) if version == 2 else _structure_3(about.variables))
    return _xml(root)


def build_description(about: Description, version: int) -> bytes:
    """Return the file buildDescription.xml of the sources."""
    root = Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = ElementTree.SubElement(root, "BuildConfiguration", modelIdentifier=about.identifier)
    files = ElementTree.SubElement(configuration, "SourceFileSet", language="C++20", compilerOptions="-ffp-contract=off")
    ElementTree.SubElement(files, "SourceFile", name=f"fmi{version}.cpp")
    ElementTree.SubElement(files, "IncludeDirectory", name=".")
    return _xml(root)


def _co_simulation(about: Description, version: int) -> Element:
    names = {
        2: ("canGetAndSetFMUstate", "canSerializeFMUstate", "canNotUseMemoryManagementFunctions", "canInterpolateInputs"),
        3: ("canGetAndSetFMUState", "canSerializeFMUState"),
    }
    abilities = dict.fromkeys(("canHandleVariableCommunicationStepSize", *names[version]), "true")
    found = Element("CoSimulation", {"modelIdentifier": about.identifier} | abilities)
    if version == 2:
        ElementTree.SubElement(ElementTree.SubElement(found, "SourceFiles"), "File", name="fmi2.cpp")
    return found


def _unit_definitions(units: Iterable[str]) -> Element:
    found = Element("UnitDefinitions")
    for unit in sorted(units):
        definition = ElementTree.SubElement(found, "Unit", name=unit)
        factor, exponents = base_exponents(unit)
        base = {name: str(power) for name, power in exponents.items()}
        if factor != 1.0:
            base["factor"] = repr(factor)
        ElementTree.SubElement(definition, "BaseUnit", base)
        for name, scale, offset in DISPLAY_UNITS.get(unit, ()):
            shown = {"name": name, "factor": repr(scale)} | ({"offset": repr(offset)} if offset else {})
            ElementTree.SubElement(definition, "DisplayUnit", shown)
    return found


def _common(variable: Variable) -> dict[str, str]:
    found = {
        "name": variable.name,
        "valueReference": str(variable.reference),
        "description": variable.description,
        "causality": variable.causality,
        "variability": "fixed" if variable.causality == "parameter" else "continuous",
    }
    if variable.causality != "input":
        found["initial"] = "exact" if variable.causality == "parameter" else "calculated"
    return found


def _real(variable: Variable) -> dict[str, str]:
    found = {"unit": variable.unit}
    if variable.display_unit:
        found["displayUnit"] = variable.display_unit
    if math.isfinite(variable.low):
        found["min"] = repr(variable.low)
    if math.isfinite(variable.high):
        found["max"] = repr(variable.high)
    if variable.start is not None:
        found["start"] = repr(variable.start)
    return found


def _variable_2(variable: Variable) -> Element:
    found = Element("ScalarVariable", _common(variable))
    ElementTree.SubElement(found, "Real", _real(variable))
    return found


def _variable_3(variable: Variable) -> Element:
    return Element("Float64", _common(variable) | _real(variable))


def _structure_2(variables: list[Variable]) -> Element:
    found = Element("ModelStructure")
    places = [str(1 + i) for i, each in enumerate(variables) if each.causality == "output"]
    outputs, unknown = ElementTree.SubElement(found, "Outputs"), ElementTree.SubElement(found, "InitialUnknowns")
    for place in places:
        ElementTree.SubElement(outputs, "Unknown", index=place, dependencies="")
        ElementTree.SubElement(unknown, "Unknown", index=place)
    return found


def _structure_3(variables: list[Variable]) -> Element:
    found = Element("ModelStructure")
    references = [str(each.reference) for each in variables if each.causality == "output"]
    for reference in references:
        ElementTree.SubElement(found, "Output", valueReference=reference, dependencies="")
    for reference in references:
        ElementTree.SubElement(found, "InitialUnknown", valueReference=reference)
    return found


def _xml(root: Element) -> bytes:
    ElementTree.indent(root)
    text: bytes = ElementTree.tostring(root, encoding="UTF-8", xml_declaration=True)
    return text
