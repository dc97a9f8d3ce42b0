"""Functional mock-up units (FMI 3.0, co-simulation) of the building of a case."""

from __future__ import annotations

import ctypes
import functools
import hashlib
import io
import re
import tempfile
import zipfile
from importlib.resources import files
from pathlib import Path

from rwmf._files.files import write_bytes
from rwmf.case import Case
from rwmf.case.namelist import compose
from rwmf.errors import InputError
from rwmf.export.fmu_description import IDENTIFIER, model_description
from rwmf.export.fmu_variables import Variable, variables_of

__all__ = ["export_fmu"]

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
    for name in ("spectrum", "sensitivity", "design"):
        groups.pop(name, None)
    output = {
        k: v for k, v in groups.pop("output", {}).items() if k in ("energy", "friction_limit")
    }
    groups["output"] = output | {"reactions": True}
    return {"case.nml": compose(groups).encode("utf-8", "surrogateescape"), **found}


def _try_out(resources: dict[str, bytes], token: str) -> None:
    """Initialize an instance, so that a case that cannot step is an error of the export."""
    library = _library()
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
    path = files("rwmf.export").joinpath(_COMMON)
    if not path.is_file():
        raise InputError("no FMU: this build of rwmf had no static SUNDIALS to put into it")
    return path.read_bytes()


@functools.cache
def _library() -> ctypes.CDLL:
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
