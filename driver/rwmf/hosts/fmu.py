"""Functional mock-up units (FMI 3.0, co-simulation) of the building of a case."""

from __future__ import annotations

import ctypes
import functools
import hashlib
import io
import re
import tempfile
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import files
from itertools import product
from pathlib import Path
from xml.etree import ElementTree as Xml

from rwmf.case import Case
from rwmf.case.namelist import compose
from rwmf.errors import InputError
from rwmf.kernel import tables
from rwmf.kernel.files import write_bytes
from rwmf.kernel.names import xml_text
from rwmf.run.quantities import find
from rwmf.run.simulation import NO_ACCURACY, start

# numbers that an instance cannot change: of files, of sweeps, and those that decide on sizes
_NOT_PARAMETERS = {
    "motion.dt", "vertical.dt", "storeys.n", "solver.accuracy", "solver.verify", "solver.t_end",
}  # fmt: skip
_NO_PARAMETER_GROUPS = {"output", "spectrum", "sensitivity", "design"}
_TYPES = {"real": "f", "real list": "f", "integer": "i", "logical": "b", "int": "i"}
# variables that a step can change; the others are known before it, or tell of the computation
_FOUND = {"row", "peak", "time", "end", "count", "whether"}


@dataclass(frozen=True)
class Variable:
    """A variable; its value reference is its place in the list of all, from 1.

    Attributes
    ----------
    kind : str
        'p' number of the case, 's' other parameter, 'i' input, 'o' output of the table of
        quantities, 'r' other output: the letters of ``src/bindings/fmi/model.h``.
    type : str
        'f' real, 'i' integer, 'b' logical.
    key : str
        Its name; for a value of a list, that of the list.
    unit : str
        Unit, '' without one.
    meaning : str
        Description.
    start : float
        Start value of a parameter or an input.
    count : int
        Number of values of the list that it belongs to.
    place : int
        Number in this list from 1, 0 outside of a list.
    """

    kind: str
    type: str
    key: str
    unit: str
    meaning: str
    start: float = 0.0
    count: int = 1
    place: int = 0

    @property
    def name(self) -> str:
        """Name in the model description."""
        return f"{self.key}[{self.place}]" if self.place else self.key

    @property
    def is_output(self) -> bool:
        """True if the unit computes it."""
        return self.kind in "or"

    def line(self) -> str:
        """Return its line of ``variables.txt``."""
        return f"{self.kind} {self.type} {self.key} {self.count} {self.start!r}\n"


def variables_of(case: Case, link: bool) -> list[Variable]:
    """List the variables of a unit."""
    force = "N"
    if case.wall is None or case.wall.get("m_w") is None:
        force = "N/kg"
    fixed = _link_variables(force) if link else _ground_variables(case, force)
    return [*fixed, *([] if link else _outputs(case)), *_parameters(case)]


def _ground_variables(case: Case, force: str) -> list[Variable]:
    found = [
        Variable("i", "f", "ground_acceleration", "m/s2", "ground acceleration in the next step"),
        Variable(
            "i", "f", "ground_acceleration_end", "m/s2",
            "ground acceleration at the end of the next step, with ground_is_linear",
        ),
        Variable(
            "s", "b", "ground_is_linear", "",
            "a straight line to ground_acceleration_end; otherwise the acceleration is constant",
        ),
        Variable(
            "s", "f", "peak_ground_acceleration", "m/s2",
            "expected peak, for the absolute tolerance; 0: that of the case, or g/10",
        ),
        Variable("r", "f", "u_s_ddot_m_s2", "m/s2", "acceleration of the frame over the ground"),
        Variable("r", "f", "link_force", force, "force from the wall on the frame"),
        Variable("r", "f", "frame_shear", force, "force of the frame's spring and damper"),
        Variable("r", "f", "cable_tension", force, "tension of the cable"),
        Variable("r", "b", "at_rest", "", "the wall rests on both corners"),
    ]  # fmt: skip
    if case.motion is not None:
        meaning = "the ground follows the motion of the case, and the inputs have no effect"
        found.insert(2, Variable("s", "b", "own_motion", "", meaning, 1.0))
    return found


def _link_variables(force: str) -> list[Variable]:
    per = force.removeprefix("N")
    return [
        Variable("i", "f", "u", "m", "displacement of the link relative to the ground"),
        Variable("i", "f", "u_dot", "m/s", "velocity of the link"),
        Variable("i", "f", "u_ddot", "m/s2", "acceleration of the link"),
        Variable("i", "f", "ground_acceleration", "m/s2", "ground acceleration"),
        Variable("i", "f", "push", force, "force of the importer's frame on the resting wall"),
        Variable("s", "i", "start_side", "", "side of the wall at first: 1, -1, or 0: that of u"),
        Variable(
            "s", "f", "host_mass", "kg" + per,
            "mass of the importer's frame at the link, for the end of chatter",
        ),
        Variable("r", "f", "force", force, "resisting force of the wall on the link"),
        Variable("r", "f", "stiffness", "N/m" + per, "derivative of the force by u"),
        Variable("r", "f", "damping", "N s/m" + per, "derivative of the force by u_dot"),
        Variable("r", "f", "mass", "kg" + per, "derivative of the force by u_ddot"),
        Variable("r", "f", "theta", "rad", "rotation of the wall"),
        Variable("r", "f", "theta_dot", "rad/s", "angular velocity of the wall"),
        Variable("r", "f", "theta_ddot", "rad/s2", "angular acceleration of the wall"),
        Variable("r", "f", "cable_tension", force, "tension of the cable"),
        Variable("r", "f", "velocity_factor", "", "factor on the velocity at an impact"),
        Variable("r", "i", "side", "", "1 or -1 while the wall rocks, 0 at rest"),
        Variable("r", "i", "impacts", "", "number of impacts"),
        Variable("r", "i", "lift_offs", "", "number of uplifts"),
    ]  # fmt: skip


def _outputs(case: Case) -> list[Variable]:
    """List the columns and numbers of a run that a step can change, from a run of one row."""
    row = 1e-3
    short = case.replace(
        output={"dt": row, "reactions": True, "conditioning": False},
        solver={"t_end": row, **NO_ACCURACY},
    )
    with start(short) as run:
        keys = [*run.history()[0], *run.summary()]
    found = []
    for key in dict.fromkeys(keys):
        quantity = find(key)
        if quantity.found in _FOUND and quantity.kind in _TYPES and key != "t_s":
            unit = "" if quantity.unit == "1" else quantity.unit
            found.append(Variable("o", _TYPES[quantity.kind], key, unit, quantity.meaning))
    return found


def _parameters(case: Case) -> list[Variable]:
    """List the numbers of the case, given or by default."""
    found = []
    rows = tables.rows_of_keys()
    for group, values in case.groups.items():
        if group in _NO_PARAMETER_GROUPS:
            continue
        given = values.as_given()
        for key, value in {**values, **given}.items():
            row = rows[group, key]
            name = f"{group}.{key}"
            kind = row.kind.removesuffix("s")
            if kind not in _TYPES or value is None or name in _NOT_PARAMETERS:
                continue
            if key in values.derived and key not in given:
                continue
            numbers = value if isinstance(value, tuple) else (value,)
            unit = "" if row.unit == "-" else row.unit
            for i, number in enumerate(numbers, 1):
                size = (len(numbers), i if len(numbers) > 1 else 0)
                facts = (_TYPES[kind], name, unit, row.meaning, float(number))
                found.append(Variable("p", *facts, *size))
    return found


# name of the shared library
IDENTIFIER = "rwmf"
_FMI_TYPES = {"f": "Float64", "i": "Int64", "b": "Boolean"}
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
    root = Xml.fromstring(files("rwmf.hosts").joinpath("fmu_description.xml").read_text("utf-8"))
    root.attrib.update(
        modelName=name,
        instantiationToken=token,
        description="Scene with " + ", ".join(case.kernel.inventory()["effects"]),
        generationTool=f"rwmf {tables.version()}",
    )
    _units(_part(root, "UnitDefinitions"), variables)
    _experiment(_part(root, "DefaultExperiment"), case)
    _variables(_part(root, "ModelVariables"), variables)
    outputs = [str(i) for i, variable in enumerate(variables, 1) if variable.is_output]
    for kind, reference in product(("Output", "InitialUnknown"), outputs):
        Xml.SubElement(_part(root, "ModelStructure"), kind, valueReference=reference)
    Xml.indent(root)
    text: bytes = Xml.tostring(root, encoding="utf-8", xml_declaration=True)
    return text + b"\n"


def _part(root: Xml.Element, name: str) -> Xml.Element:
    (found,) = root.findall(name)
    return found


def _units(definitions: Xml.Element, variables: list[Variable]) -> None:
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


def _experiment(experiment: Xml.Element, case: Case) -> None:
    if case.solver is not None and case.solver.t_end is not None:
        experiment.set("stopTime", repr(float(case.solver.t_end)))
    step = None if case.motion is None else case.motion.get("dt")
    if step is not None:
        experiment.set("stepSize", repr(float(str(step))))


def _variables(listed: Xml.Element, variables: list[Variable]) -> None:
    for reference, variable in enumerate(variables, 1):
        facts = {
            "name": variable.name,
            "valueReference": str(reference),
            "description": variable.meaning,
        }
        varies = "continuous" if variable.type == "f" else "discrete"
        if variable.is_output:
            facts |= {"causality": "output", "initial": "calculated", "intermediateUpdate": "true"}
        else:
            varies = varies if variable.kind == "i" else "fixed"
            facts["causality"] = "input" if variable.kind == "i" else "parameter"
            facts["start"] = _start(variable)
        facts["variability"] = varies
        if variable.unit and variable.type == "f":
            facts["unit"] = variable.unit
        Xml.SubElement(listed, _FMI_TYPES[variable.type], facts)


def _start(variable: Variable) -> str:
    if variable.type == "b":
        return "true" if variable.start else "false"
    return str(int(variable.start)) if variable.type == "i" else repr(variable.start)


# part of every FMU that the build of this package makes (src/bindings/fmi)
_COMMON = "fmu.zip"
# time stamp of all entries: the same case gives the same bytes
_EPOCH = (1980, 1, 1, 0, 0, 0)


def export_fmu(case: Case, path: Path, link: bool = False) -> list[Variable]:
    """Write a case as a functional mock-up unit."""
    if link and case.wall is None:
        raise InputError("no FMU of this case: an element needs the group &wall")
    kind = "ground"
    if link:
        kind = "hinge" if case.wall.base == "pinned" else "link"
    variables = variables_of(case, link)
    resources = _resources(case)
    table = "".join(variable.line() for variable in variables)
    token = hashlib.sha256(repr((kind, table, sorted(resources.items()))).encode()).hexdigest()[:32]
    resources["variables.txt"] = f"{token} {kind} {len(variables)}\n{table}".encode()
    _try_out(resources, token)
    whole = io.BytesIO(_common())
    with zipfile.ZipFile(whole, "a", zipfile.ZIP_DEFLATED) as archive:
        entries = {f"resources/{name}": content for name, content in resources.items()}
        entries["modelDescription.xml"] = model_description(case, variables, token)
        for name, content in entries.items():
            entry = zipfile.ZipInfo(name, _EPOCH)
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, content, zipfile.ZIP_DEFLATED)
    write_bytes(path, whole.getvalue())
    return variables


def _resources(case: Case) -> dict[str, bytes]:
    """Return the namelist of the unit and its records, which lie beside it."""
    groups = {name: dict(group.as_given()) for name, group in case.groups.items()}
    found: dict[str, bytes] = {}
    # in the order of the groups, after the namelist
    records = iter(case.inputs[case.source is not None :])
    with tempfile.TemporaryDirectory() as folder:
        for name in [group for group, values in groups.items() if values.get("file") is not None]:
            motion = case.motions.get(name)
            source = next(records) if motion is None else Path(folder, f"{name}.txt")
            if motion is not None:
                motion.write(source)
            file = name + re.sub(r"[^.A-Za-z0-9]", "", source.suffix)
            found[file] = source.read_bytes()
            groups[name]["file"] = file
    # neither sweeps nor files belong to a unit; its demands need the requests of `reactions`
    output = {
        k: v for k, v in groups.get("output", {}).items() if k in ("energy", "friction_limit")
    }
    groups = {name: keys for name, keys in groups.items() if name not in _NO_PARAMETER_GROUPS}
    groups["output"] = output | {"reactions": True}
    return {"case.nml": compose(groups).encode("utf-8", "surrogateescape"), **found}


def _try_out(resources: dict[str, bytes], token: str) -> None:
    """Initialize an instance, so that a case that cannot step is an error of the export."""
    library = _unit_library()
    messages: list[str] = []

    def log(_: int | None, _status: int, _category: bytes, message: bytes) -> None:
        messages.append(message.decode("utf-8", "replace"))

    callback = _LOG(log)
    with tempfile.TemporaryDirectory() as folder:
        for name, content in resources.items():
            Path(folder, name).write_bytes(content)
        instance = library.fmi3InstantiateCoSimulation(
            b"", token.encode(), f"{folder}/".encode(), *[False] * 4, None, 0, None, callback, None
        )
        if instance:
            if library.fmi3EnterInitializationMode(instance, False, 0.0, 0.0, False, 0.0) == 0:
                library.fmi3ExitInitializationMode(instance)
            library.fmi3FreeInstance(instance)
        if messages:
            text = messages[0].split(": ", 2)[-1].replace(f"{folder}/case.nml: ", "")
            raise InputError(f"no FMU of this case: {text}")


_LOG = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p)


def _common() -> bytes:
    """Return the part of every unit."""
    path = files("rwmf.hosts").joinpath(_COMMON)
    if not path.is_file():
        raise InputError("no FMU: this build of rwmf had no static SUNDIALS to put into it")
    return path.read_bytes()


@functools.cache
def _unit_library() -> ctypes.CDLL:
    """Load the library of the units, once."""
    with tempfile.TemporaryDirectory() as folder:
        with zipfile.ZipFile(io.BytesIO(_common())) as zipped:
            zipped.extractall(folder)
        library = ctypes.CDLL(str(next(Path(folder).glob(f"binaries/*/{IDENTIFIER}.so"))))
    text, flag, real, address = ctypes.c_char_p, ctypes.c_bool, ctypes.c_double, ctypes.c_void_p
    library.fmi3InstantiateCoSimulation.restype = address
    library.fmi3InstantiateCoSimulation.argtypes = [
        text, text, text, flag, flag, flag, flag, address, ctypes.c_size_t, address, _LOG, address,
    ]  # fmt: skip
    library.fmi3EnterInitializationMode.argtypes = [address, flag, real, real, flag, real]
    library.fmi3ExitInitializationMode.argtypes = [address]
    library.fmi3FreeInstance.argtypes = [address]
    return library
