"""Model description of a functional mock-up unit (FMI 3.0)."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import Path
from xml.etree import ElementTree as Xml

from rwmf import _library
from rwmf._files.names import xml_text
from rwmf.case import Case
from rwmf.export.fmu_variables import Variable

__all__ = ["IDENTIFIER", "model_description"]

# name of the shared library
IDENTIFIER = "rwmf"
_TYPES = {"f": "Float64", "i": "Int64", "b": "Boolean"}
# exponents of the base units of FMI
_BASE = {
    "N": {"kg": 1, "m": 1, "s": -2},
    "Pa": {"kg": 1, "m": -1, "s": -2},
    "J": {"kg": 1, "m": 2, "s": -2},
    "kg": {"kg": 1},
    "m": {"m": 1},
    "s": {"s": 1},
    "rad": {"rad": 1},
}


def model_description(case: Case, variables: list[Variable], token: str) -> bytes:
    """Write ``modelDescription.xml``."""
    name = xml_text(Path(case.source).stem) if case.source else "case"
    root = Xml.Element(
        "fmiModelDescription",
        fmiVersion="3.0",
        modelName=name,
        instantiationToken=token,
        description="Scene with " + ", ".join(case.kernel.inventory()["effects"]),
        license="BSD-3-Clause, and the licences of documentation/licenses",
        generationTool=f"rwmf {_library.version()}",
        variableNamingConvention="flat",
    )
    _co_simulation(root)
    _units(root, variables)
    categories = Xml.SubElement(root, "LogCategories")
    Xml.SubElement(categories, "Category", name="logStatusError", description="reasons of errors")
    _experiment(root, case)
    _variables(root, variables)
    _structure(root, variables)
    Xml.indent(root)
    text: bytes = Xml.tostring(root, encoding="utf-8", xml_declaration=True)
    return text + b"\n"


def _co_simulation(root: Xml.Element) -> None:
    Xml.SubElement(
        root,
        "CoSimulation",
        modelIdentifier=IDENTIFIER,
        canGetAndSetFMUState="true",
        canSerializeFMUState="false",
        canHandleVariableCommunicationStepSize="true",
        providesIntermediateUpdate="true",
        mightReturnEarlyFromDoStep="true",
        canReturnEarlyAfterIntermediateUpdate="true",
        hasEventMode="true",
    )


def _units(root: Xml.Element, variables: list[Variable]) -> None:
    definitions = Xml.SubElement(root, "UnitDefinitions")
    for unit in sorted({"s", *(v.unit for v in variables if v.unit)}):
        element = Xml.SubElement(definitions, "Unit", name=unit)
        exponents = _exponents(unit)
        if exponents is not None:
            Xml.SubElement(element, "BaseUnit", {k: str(n) for k, n in exponents.items()})


def _exponents(unit: str) -> Mapping[str, int] | None:
    """Return the exponents of the base units; None for a unit with other parts."""
    found: dict[str, int] = {}
    for i, part in enumerate(unit.split("/")):
        for word in part.split():
            match = re.fullmatch(r"([A-Za-z]+)(\d?)|1", word)
            if match is None or (match[1] and match[1] not in _BASE):
                return None
            for base, power in _BASE.get(match[1] or "", {}).items():
                times = int(match[2] or 1) * (-1 if i else 1)
                found[base] = found.get(base, 0) + times * power
    return {base: power for base, power in found.items() if power}


def _experiment(root: Xml.Element, case: Case) -> None:
    facts = {"startTime": "0"}
    if case.solver is not None and case.solver.t_end is not None:
        facts["stopTime"] = repr(float(case.solver.t_end))
    step = None if case.motion is None else case.motion.get("dt")
    if step is not None:
        facts["stepSize"] = repr(float(str(step)))
    Xml.SubElement(root, "DefaultExperiment", facts)


def _variables(root: Xml.Element, variables: list[Variable]) -> None:
    listed = Xml.SubElement(root, "ModelVariables")
    Xml.SubElement(
        listed, "Float64", name="time", valueReference="0", causality="independent",
        variability="continuous", unit="s", description="time",
    )  # fmt: skip
    for reference, variable in enumerate(variables, 1):
        facts = {
            "name": variable.name,
            "valueReference": str(reference),
            "description": variable.meaning,
        }
        if variable.is_output:
            facts["causality"] = "output"
            facts["initial"] = "calculated"
            facts["intermediateUpdate"] = "true"
        else:
            facts["causality"] = "input" if variable.kind == "i" else "parameter"
            facts["start"] = _start(variable)
        if not variable.is_output and variable.kind != "i":
            facts["variability"] = "fixed"
        else:
            facts["variability"] = "continuous" if variable.type == "f" else "discrete"
        if variable.unit and variable.type == "f":
            facts["unit"] = variable.unit
        Xml.SubElement(listed, _TYPES[variable.type], facts)


def _start(variable: Variable) -> str:
    if variable.type == "b":
        return "true" if variable.start else "false"
    return str(int(variable.start)) if variable.type == "i" else repr(variable.start)


def _structure(root: Xml.Element, variables: list[Variable]) -> None:
    structure = Xml.SubElement(root, "ModelStructure")
    references = [str(i) for i, variable in enumerate(variables, 1) if variable.is_output]
    for kind in ("Output", "InitialUnknown"):
        for reference in references:
            Xml.SubElement(structure, kind, valueReference=reference)
