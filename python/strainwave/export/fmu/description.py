"""Descriptions of an FMU in XML: of its variables for tools that import it, and of its sources for those that compile it."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from importlib import metadata
from xml.etree import ElementTree

from strainwave.export.fmu.source import Variable, nominal
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
    """Content of the description of an FMU that both versions of FMI have.

    Attributes:
        name, identifier: of the model, and of its files
        token: that ties a binary to its description
        text: one line on the drive
        step: default communication step [s]
        variables: in the order of the value references
        states: of model exchange: states, their derivatives, and an event indicator; empty for co-simulation
        has_events: whether the event indicator is used
    """

    name: str
    identifier: str
    token: str
    text: str
    step: float
    variables: list[Variable]
    states: list[Variable]
    has_events: bool

    @property
    def state_count(self) -> int:
        """Number of continuous states."""
        return len(self.states) // 2


NEEDS_STEPS = "needsCompletedIntegratorStep"


def model_description(about: Description, version: int) -> bytes:
    """Return the file modelDescription.xml of an FMU for version 2 or 3 of FMI."""
    root = Element("fmiModelDescription", fmiVersion=f"{version}.0", modelName=about.name)
    root.set("guid" if version == 2 else "instantiationToken", about.token)
    root.set("description", about.text)
    root.set("generationTool", f"strainwave {metadata.version('strainwave')}")
    root.set("variableNamingConvention", "structured")
    if version == 2 and about.states:
        root.set("numberOfEventIndicators", str(int(about.has_events)))
    root.append(_interface(about, version))
    root.append(_unit_definitions({each.unit for each in (*about.variables, *about.states)} | {"s"}))
    categories = ElementTree.SubElement(root, "LogCategories")
    ElementTree.SubElement(categories, "Category", name="logStatusError", description="Errors")
    experiment = {"startTime": "0.0", "stopTime": repr(STOP_TIME), "stepSize": repr(about.step)}
    ElementTree.SubElement(root, "DefaultExperiment", experiment)
    listed = ElementTree.SubElement(root, "ModelVariables")
    if version == 2:
        listed.extend(_variable_2(each) for each in about.variables)
        listed.extend(_state_2(about, i) for i in range(2 * about.state_count))
    else:
        time = {"name": "time", "valueReference": "0", "causality": "independent", "variability": "continuous", "unit": "s"}
        ElementTree.SubElement(listed, "Float64", time)
        listed.extend(Element("Float64", _common(each) | _real(each)) for each in about.variables)
        listed.extend(_state_3(about, i) for i in range(2 * about.state_count + about.has_events))
    root.append(_structure_2(about) if version == 2 else _structure_3(about))
    return _xml(root)


# Terminals of FMI 3.0: which variables belong to which connection. All are signals: a load torque acts against the motion,
# while the torque of a flange flows in.
TERMINALS = {
    "input_shaft": ("input_angle", "input_speed"),
    "output_shaft": ("output_angle", "output_speed", "load_torque", "brake_torque"),
    "electrical": ("voltage", "current"),
}


def terminals(about: Description) -> bytes:
    """Return the file terminalsAndIcons.xml of an FMU for version 3 of FMI."""
    root = Element("fmiTerminalsAndIcons", fmiVersion="3.0")
    listed = ElementTree.SubElement(root, "Terminals")
    known = {each.name for each in about.variables}
    for name, members in TERMINALS.items():
        if present := [each for each in members if each in known]:
            terminal = ElementTree.SubElement(listed, "Terminal", name=name, matchingRule="none")
            for each in present:
                ElementTree.SubElement(
                    terminal, "TerminalMemberVariable", variableName=each, memberName=each, variableKind="signal"
                )
    return _xml(root)


def build_description(about: Description, version: int) -> bytes:
    """Return the file buildDescription.xml of the sources."""
    root = Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = ElementTree.SubElement(root, "BuildConfiguration", modelIdentifier=about.identifier)
    files = ElementTree.SubElement(configuration, "SourceFileSet", language="C++20", compilerOptions="-ffp-contract=off")
    ElementTree.SubElement(files, "SourceFile", name=f"fmi{version}.cpp")
    ElementTree.SubElement(files, "IncludeDirectory", name=".")
    return _xml(root)


def _interface(about: Description, version: int) -> Element:
    names = {
        2: ("canGetAndSetFMUstate", "canSerializeFMUstate", "canNotUseMemoryManagementFunctions", "canInterpolateInputs"),
        3: ("canGetAndSetFMUState", "canSerializeFMUState"),
    }
    abilities = names[version] if about.states else ("canHandleVariableCommunicationStepSize", *names[version])
    chosen = [each for each in abilities if not (about.states and each == "canInterpolateInputs")]
    if about.states:
        # Hysteresis is committed in completedIntegratorStep. FMI 2 calls it by default, FMI 3 on request.
        chosen += ["providesDirectionalDerivative"] if version == 2 else ["providesDirectionalDerivatives", NEEDS_STEPS]
    kind = "ModelExchange" if about.states else "CoSimulation"
    found = Element(kind, {"modelIdentifier": about.identifier} | dict.fromkeys(chosen, "true"))
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


def _state_2(about: Description, i: int) -> Element:
    """Return the variable of a continuous state, or of the derivative of one."""
    found = Element("ScalarVariable", _common(about.states[i]))
    real = _real(about.states[i]) | _nominal(about, i)
    if i >= about.state_count:
        real["derivative"] = str(1 + len(about.variables) + i - about.state_count)
    ElementTree.SubElement(found, "Real", real)
    return found


def _nominal(about: Description, i: int) -> dict[str, str]:
    """Return the nominal value of a continuous state, nothing for other variables."""
    return {"nominal": repr(nominal(about.states[i].name.removeprefix("state.")))} if i < about.state_count else {}


def _state_3(about: Description, i: int) -> Element:
    """Return the variable of a continuous state, of the derivative of one, or of the event indicator."""
    found = _common(about.states[i]) | _real(about.states[i]) | _nominal(about, i)
    if about.state_count <= i < 2 * about.state_count:
        found["derivative"] = str(about.states[i - about.state_count].reference)
    return Element("Float64", found)


def _structure_2(about: Description) -> Element:
    found = Element("ModelStructure")
    outputs = ElementTree.SubElement(found, "Outputs")
    derivatives = ElementTree.SubElement(found, "Derivatives") if about.states else None
    unknown = ElementTree.SubElement(found, "InitialUnknowns")
    for place, each in enumerate(about.variables, 1):
        if each.causality == "output":
            ElementTree.SubElement(outputs, "Unknown", {"index": str(place)} | _dependencies(about))
            ElementTree.SubElement(unknown, "Unknown", index=str(place))
    for i in range(2 * about.state_count):
        index = str(1 + len(about.variables) + i)
        ElementTree.SubElement(unknown, "Unknown", index=index)
        if derivatives is not None and i >= about.state_count:
            ElementTree.SubElement(derivatives, "Unknown", index=index)
    return found


def _structure_3(about: Description) -> Element:
    found = Element("ModelStructure")
    outputs = [str(each.reference) for each in about.variables if each.causality == "output"]
    states = [str(each.reference) for each in about.states]
    derivatives = states[about.state_count : 2 * about.state_count]
    for reference in outputs:
        ElementTree.SubElement(found, "Output", {"valueReference": reference} | _dependencies(about))
    for reference in derivatives:
        ElementTree.SubElement(found, "ContinuousStateDerivative", valueReference=reference)
    indicators = states[-1:] if about.has_events else []
    for reference in [*outputs, *states[: about.state_count], *derivatives]:
        ElementTree.SubElement(found, "InitialUnknown", valueReference=reference)
    for reference in indicators:
        ElementTree.SubElement(found, "EventIndicator", valueReference=reference)
    return found


def _dependencies(about: Description) -> dict[str, str]:
    """Return that an output of co-simulation depends on no input of the same instant; else it may depend on all."""
    return {} if about.states else {"dependencies": ""}


def _xml(root: Element) -> bytes:
    ElementTree.indent(root)
    text: bytes = ElementTree.tostring(root, encoding="UTF-8", xml_declaration=True)
    return text
