"""NetCDF file of a finished sweep, written in parts along its first dimension.

The writer is h5netcdf on h5py. Both are maintained, exist as wheels and are the ones that xarray
uses; the netCDF-C library is not needed. Neither writes a time into the file, so that equal results
give equal bytes.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from rwmf.errors import InputError
from rwmf.kernel.files import new_file
from rwmf.kernel.names import needed, readable
from rwmf.run import quantities
from rwmf.run.quantities import ORDINATES
from rwmf.sweeps.axes import POINT, Coordinate, Layout, Scenes
from rwmf.sweeps.plan import Chunk

if TYPE_CHECKING:
    from h5netcdf import File, Variable

Array = npt.NDArray[np.float64] | npt.NDArray[np.uint8]
Source = Callable[[int], Chunk]
# values per compressed block of the file
_BLOCK = 65536
# runs assembled at once: 9 bytes each, and 8 for every further quantity
_TOGETHER = 2**21
_LEVEL = 4


def check_package() -> None:
    """Check for missing packages before the computation."""
    with needed("netcdf", "a NetCDF file needs h5netcdf and h5py"):
        import h5netcdf
        import h5py
    del h5netcdf, h5py


def attributes(layout: Layout) -> dict[str, object]:
    """Return the attributes of the dataset: all that is needed to repeat the sweep."""
    return {
        "Conventions": "CF-1.11",
        "title": "Sweep of rocking wall-moment frames",
        "source": f"rwmf {layout.version}",
        "version": layout.version,
        "case": readable(layout.case),
        "motion_crc32": layout.motion_crc32,
        "method": layout.method,
        "warnings": layout.warnings,
        "sweep": layout.to_text(),
        **layout.intensity,
    }


def status_names(layout: Layout, source: Source) -> list[str]:
    """Collect the statuses of all chunks: results first, then errors by name."""
    found: set[str] = set()
    for number in range(layout.n_chunks):
        found |= set(source(number).names)
    good = ["ok", "overturned"]
    return good + sorted(found - set(good))


def assemble(
    layout: Layout, source: Source, names: list[str], part: slice | None = None
) -> dict[str, Array]:
    """Assemble chunks into arrays."""
    shape = layout.shape
    begin = 0
    if part is not None:
        begin = part.start * math.prod(shape[1:])
        shape = (part.stop - part.start, *shape[1:])
    n = math.prod(shape)
    arrays: dict[str, Array] = {name: np.empty(n) for name in layout.quantities}
    arrays["status"] = np.zeros(n, dtype="u1")
    code = {name: i for i, name in enumerate(names)}
    for number in range(layout.n_chunks):
        places = layout.rows(number).places - begin
        inside = (places >= 0) & (places < n)
        if not inside.any():
            continue
        chunk = source(number)
        places = places[inside]
        codes = np.array([code[name] for name in chunk.names], dtype="u1")
        arrays["status"][places] = codes[chunk.status[inside]]
        for name, values in chunk.values.items():
            arrays[name][places] = values[inside]
    return {name: array.reshape(shape) for name, array in arrays.items()}


def read_identity(path: Path) -> str:
    """Read the identity of the sweep in a NetCDF file."""
    import h5netcdf

    try:
        # a pipe must not be read here
        with h5netcdf.File(path if path.is_file() else "", "r") as file:
            if str(file.attrs["source"]).startswith("rwmf "):
                return str(file.attrs["sweep"])
    except Exception:
        # HDF5 has errors of many kinds for a damaged file
        pass
    raise InputError(f"{path}: exists and is not the result of a sweep")


def write(layout: Layout, source: Source, path: Path) -> None:
    """Write the file, which appears when it is complete."""
    with new_file(path) as (file, check):
        _fill(file, layout, source, check)


def _fill(file: File, layout: Layout, source: Source, check: Callable[[], None]) -> None:
    names = status_names(layout, source)
    file.dimensions = dict(zip(layout.dims, layout.shape, strict=True))
    file.attrs.update({key: readable(value) for key, value in attributes(layout).items()})
    _write_coordinates(file, layout)
    variables = {name: _new_variable(file, layout, name) for name in layout.quantities}
    variables["status"] = status = _new_variable(file, layout, "status")
    status.attrs.update(status_attributes(names))
    for part in _parts(layout):
        for name, values in assemble(layout, source, names, part).items():
            variables[name][... if part is None else part] = values
        check()


def _parts(layout: Layout) -> Iterator[slice | None]:
    """Return ranges of the first dimension that fit into memory, in whole compressed blocks."""
    if math.prod(layout.shape) <= _TOGETHER:
        yield None
        return
    step = max(1, _TOGETHER // math.prod(layout.shape[1:]))
    block = _blocks(layout.shape)[0]
    step = max(block, step - step % block)
    for start in range(0, layout.shape[0], step):
        yield slice(start, min(start + step, layout.shape[0]))


def status_attributes(names: list[str]) -> dict[str, object]:
    """Describe the numbers of ``status`` by the CF conventions."""
    return {
        "long_name": quantities.QUANTITIES["status"].meaning,
        "flag_values": np.arange(len(names), dtype="u1"),
        "flag_meanings": " ".join(names),
    }


def _write_coordinates(file: File, layout: Layout) -> None:
    for item in layout.coordinates:
        if item.dimension == POINT and not item.column:
            texts = [str(readable(value)).encode() for value in item.values]
            variable = _write_letters(file, item.name, texts, layout.scene_of[POINT])
        else:
            variable = _write_labels(file, item, layout.labels(item))
        variable.attrs.update(item.attributes)


def _write_labels(file: File, item: Coordinate, labels: npt.NDArray[Any]) -> Variable:
    import h5py

    texts = labels.dtype.kind == "U"
    dtype = h5py.string_dtype() if texts else "<f8"
    variable = file.create_variable(item.name, (item.dimension,), dtype=dtype)
    variable[...] = labels.astype(object) if texts else labels
    return variable


def _write_letters(file: File, name: str, texts: list[bytes], which: Scenes) -> Variable:
    """Write texts along the points as characters, which can be compressed."""
    letters = np.array(texts).view("S1").reshape(len(texts), -1)
    file.dimensions[f"{name}_letters"] = letters.shape[1]
    variable = file.create_variable(
        name,
        (POINT, f"{name}_letters"),
        dtype="S1",
        **_compression((len(which), letters.shape[1])),
    )
    variable[...] = letters[which]
    # xarray decodes characters with this attribute to texts
    variable.attrs["_Encoding"] = "utf-8"
    return variable


def _new_variable(file: File, layout: Layout, name: str) -> Variable:
    whole = name != "status"
    variable = file.create_variable(
        name,
        layout.dims,
        dtype="<f8" if whole else "u1",
        fillvalue=np.nan if whole else None,
        **(_compression(layout.shape) if layout.dims else {}),
    )
    if whole:
        variable.attrs.update(ORDINATES[name].attributes)
    labels = [item.name for item in layout.coordinates if item.name != item.dimension]
    if labels:
        variable.attrs["coordinates"] = " ".join(labels)
    return variable


def _compression(shape: tuple[int, ...]) -> dict[str, object]:
    return {
        "chunks": _blocks(shape),
        "compression": "gzip",
        "compression_opts": _LEVEL,
        "shuffle": True,
    }


def _blocks(shape: tuple[int, ...]) -> tuple[int, ...]:
    """Return the shape of compressed blocks: whole last dimensions, as many as fit."""
    capacity = _BLOCK
    blocks = []
    for size in reversed(shape):
        blocks.append(max(1, min(size, capacity)))
        capacity //= blocks[-1]
    return tuple(reversed(blocks))
