"""Sweeps: planning, computation, storage and assembly; merging of parts, also as CSV.

The store of finished chunks is an append-only file that survives ``kill -9``. It has one text line,
the layout with the table of its points, and then one entry per chunk with a checksum. The checksum
identifies an entry that a killed process left incomplete; it is removed.
"""

from __future__ import annotations

import fcntl
import json
import os
import re
import stat
import struct
import zlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import ExitStack, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO, TypedDict

import numpy as np
import xarray as xr

from rwmf.case import CaseLike, Motion
from rwmf.case.arguments import checked
from rwmf.case.namelist import read_text
from rwmf.errors import InputError, Interrupted, OutputError
from rwmf.kernel import files
from rwmf.kernel.files import path_of
from rwmf.kernel.marshalling import Closing
from rwmf.kernel.numbers import grouped
from rwmf.kernel.progress import Progress, Reports, reporting
from rwmf.motion.record_sets import RecordFile
from rwmf.run.quantities import ORDINATES
from rwmf.sweeps import netcdf
from rwmf.sweeps.axes import Layout, difference
from rwmf.sweeps.executors import count_threads, run_in_threads, run_on
from rwmf.sweeps.plan import Chunk, Plan, Request, make_plan
from rwmf.sweeps.points import Points

_MAGIC = b"rwmf sweep journal 3\n"
# number of the chunk, length of the payload, CRC-32 of both and the payload
_HEAD = struct.Struct("<QQI")
_LAYOUT = 2**64 - 1


class ChunkStore(Closing):
    """Finished chunks of a sweep."""

    def __init__(self, path: Path, layout: Layout, *, restart: bool = False) -> None:
        self.path = path
        self.layout = layout
        with files.reported(path):
            self._file: BinaryIO = _open_locked(path)
        try:
            self._index = self._scan(restart)
        except BaseException:
            self._file.close()
            raise

    def _scan(self, restart: bool) -> dict[int, int]:
        """Find the complete entries or create the file; remove incomplete data."""
        index: dict[int, int] = {}
        end = 0
        for number, offset, payload, following in _entries(self._file, self.path):
            if restart:
                break
            if number == _LAYOUT:
                self._compare(Layout.text_of(payload))
            else:
                index[number] = offset
            end = following
        with files.reported(self.path):
            self._file.seek(end)
            self._file.truncate()
            if end == 0:
                self._write(_MAGIC)
                self._append(_LAYOUT, *self.layout.parts())
                files.sync_folder(self.path.parent)
        return index

    def _compare(self, old: str) -> None:
        new = self.layout.to_text()
        if old != new:
            raise InputError(
                f"{self.path}: belongs to another sweep (-), not to this one (+):\n"
                f"{difference(old, new)}\nrestart to discard it, or write to another file"
            )

    def __contains__(self, number: int) -> bool:
        """Return True for a finished chunk."""
        return number in self._index

    def __len__(self) -> int:
        """Count the finished chunks."""
        return len(self._index)

    def add(self, chunk: Chunk) -> None:
        """Append a chunk and wait until it is on the disk."""
        with files.reported(self.path):
            self._file.seek(0, os.SEEK_END)
            self._index[chunk.number] = self._append(chunk.number, _pack(chunk, self.layout))

    def _append(self, number: int, *parts: bytes | memoryview) -> int:
        offset = self._file.tell()
        for part in (_head(number, *parts), *parts):
            self._write(part)
        os.fsync(self._file.fileno())
        return offset

    def _write(self, content: bytes | memoryview) -> None:
        # unbuffered: a buffer would repeat a failed write when the file is closed
        rest = memoryview(content)
        while rest:
            rest = rest[self._file.write(rest) :]

    def get(self, number: int) -> Chunk:
        """Read a chunk."""
        self._file.seek(self._index[number])
        head = self._file.read(_HEAD.size)
        return _unpack(number, self._file.read(_HEAD.unpack(head)[1]), self.layout)

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def read_layout(path: Path) -> Layout:
    """Read the layout of a journal."""
    try:
        with path.open("rb") as file:
            for number, _, payload, _ in _entries(file, path):
                if number == _LAYOUT:
                    return Layout.from_bytes(payload)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror}") from error
    raise InputError(f"{path}: holds no sweep")


def _entries(file: BinaryIO, path: Path) -> Iterator[tuple[int, int, bytes, int]]:
    """Yield number, offset, payload and following offset of every complete entry."""
    file.seek(0)
    magic = file.read(len(_MAGIC))
    if not _MAGIC.startswith(magic):
        raise InputError(f"{path}: is no journal of a sweep of this version")
    offset = len(magic)
    while len(head := file.read(_HEAD.size)) == _HEAD.size:
        number, length, _ = _HEAD.unpack(head)
        # a damaged length could request all memory
        if length > os.fstat(file.fileno()).st_size - offset:
            return
        payload = file.read(length)
        if _head(number, payload) != head:
            return
        yield number, offset, payload, offset + _HEAD.size + length
        offset += _HEAD.size + length


def _head(number: int, *parts: bytes | memoryview) -> bytes:
    """Make the header of an entry."""
    length = sum(map(len, parts))
    checksum = zlib.crc32(struct.pack("<QQ", number, length))
    for part in parts:
        checksum = zlib.crc32(part, checksum)
    return _HEAD.pack(number, length, checksum)


def _pack(chunk: Chunk, layout: Layout) -> bytes:
    arrays = [np.ascontiguousarray(chunk.values[name], dtype="<f8") for name in layout.quantities]
    first = json.dumps(chunk.names).encode() + b"\n"
    return b"".join([first, chunk.status.tobytes(), *(array.tobytes() for array in arrays)])


def _unpack(number: int, payload: bytes, layout: Layout) -> Chunk:
    first, _, rest = payload.partition(b"\n")
    n = layout.chunk_size(number)
    values = {
        name: np.frombuffer(rest, "<f8", n, n + 8 * n * i)
        for i, name in enumerate(layout.quantities)
    }
    return Chunk(number, tuple(json.loads(first)), np.frombuffer(rest, "u1", n), values)


def _open_locked(path: Path) -> BinaryIO:
    """Open or create the file of this name, and lock it."""
    while True:
        file = open(path, "a+b", buffering=0, opener=_open_regular)  # noqa: SIM115
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if os.path.samestat(os.fstat(file.fileno()), path.lstat()):
                return file
        except FileNotFoundError:
            pass
        except BlockingIOError as error:
            file.close()
            raise OutputError(f"{path}: another process writes it") from error
        except BaseException:
            file.close()
            raise
        file.close()


def _open_regular(path: str, flags: int) -> int:
    """Open a regular file without following links."""
    descriptor = os.open(path, flags | os.O_NOFOLLOW | os.O_NONBLOCK, 0o666)
    if not stat.S_ISREG(os.fstat(descriptor).st_mode):
        os.close(descriptor)
        raise InputError(f"{path}: is no journal of a sweep")
    return descriptor


# line below the version, written by rwmf-batch --part
_PART = re.compile(r"# part (\d{1,9})/(\d{1,9})$")


@dataclass(frozen=True)
class _Part:
    """One file: its number, the lines common to all parts, its lines of numbers."""

    path: str
    k: int
    n: int
    head: tuple[str, ...]
    rows: tuple[str, ...]


def merge_csv(parts: Sequence[str | os.PathLike[str]], file: str | os.PathLike[str]) -> None:
    """Join the parts of a spectrum into the file of an undivided run, byte for byte."""
    found = sorted((_read(os.fspath(path)) for path in parts), key=lambda part: part.k)
    first = found[0]
    for part in found:
        if (part.n, part.head) != (first.n, first.head):
            raise InputError(f"{part.path}: is not a part of the same case as {first.path}")
    if [part.k for part in found] != list(range(1, first.n + 1)):
        given = ", ".join(str(part.k) for part in found)
        raise InputError(f"merge: needs the parts 1 to {first.n} once each, has {given}")
    text = "".join([*first.head, *_interleave(found)])
    files.check_outputs([file], parts)
    files.write_bytes(file, text.encode("utf-8", "surrogateescape"))


def _read(path: str) -> _Part:
    lines = [f"{line}\n" for line in read_text(path).removesuffix("\n").split("\n")]
    marks = [i for i, line in enumerate(lines) if _PART.match(line.rstrip("\n"))]
    if len(marks) != 1:
        raise InputError(f"{path}: is not written by rwmf-batch --part K/N")
    match = _PART.match(lines.pop(marks[0]).rstrip("\n"))
    heads = [i for i, line in enumerate(lines) if not line.startswith("#")]
    start = heads[0] + 1 if heads else len(lines)
    k, n = (int(word) for word in match.groups()) if match else (0, 0)
    return _Part(path, k, n, tuple(lines[:start]), tuple(lines[start:]))


def _interleave(parts: list[_Part]) -> list[str]:
    """Return the rows of an undivided run: periods were dealt to the parts in turn."""
    curves = [_curves(part) for part in parts]
    if len({len(found) for found in curves}) > 1:
        raise InputError("merge: the parts do not have the same mass ratios and widths")
    rows: list[str] = []
    for same in zip(*curves, strict=True):
        # the first parts may have one period more
        for turn in range(len(same[0])):
            rows += [curve[turn] for curve in same if turn < len(curve)]
    return rows


def _curves(part: _Part) -> list[list[str]]:
    """Return the rows grouped by width and mass ratio, the columns before the period."""
    names = part.head[-1].rstrip("\n").split(",")
    n = names.index("T_s_s") if "T_s_s" in names else 0
    return list(grouped(part.rows, lambda row: tuple(row.split(",")[:n])).values())


class SweepOptions(TypedDict, total=False):
    """Arguments of `sweep` that studies pass on: execution of its runs, reading of records.

    Attributes
    ----------
    threads : int
        Threads, 0 for all.
    executor : concurrent.futures.Executor, optional
        Processes, MPI ranks or Dask workers instead of threads.
    progress : callable or bool, optional
        True for a bar in a notebook or terminal, or a function that is called with the numbers of
        finished and of all runs.
    chunk : int
        Largest number of runs in a chunk, 0 for the default.
    unit : str, optional
        Unit of records that are not AT2: 'g', 'm/s2' or 'cm/s2'.
    dt : float, optional
        Sampling interval of records of one column [s].
    """

    threads: int
    executor: Executor | None
    progress: Reports
    chunk: int
    unit: str | None
    dt: float | None


@checked
def sweep(
    case: CaseLike,
    grid: Mapping[str, object] | None = None,
    records: Sequence[str | os.PathLike[str] | RecordFile | Motion] = (),
    file: str | os.PathLike[str] | None = None,
    *,
    points: Points | None = None,
    quantities: Sequence[str] | None = None,
    threads: int = 0,
    executor: Executor | None = None,
    progress: Reports = None,
    restart: bool = False,
    part: tuple[int, int] = (1, 1),
    chunk: int = 0,
    unit: str | None = None,
    dt: float | None = None,
    intensity: str | None = None,
    period: float | None = None,
    damping: float | None = None,
    periods: Sequence[float] | None = None,
) -> xr.Dataset:
    """Compute the runs of all combinations of records, table rows and grid values.

    Parameters
    ----------
    case : Case or path
        Settings common to all runs; the values of its `&spectrum` are part of the grid.
    grid : mapping, optional
        Values by name of the axis: ``T_s`` [s], ``gamma`` [-], ``b`` [m], ``scale`` (factor on the
        motion) or ``eta`` (pairs eta_0, eta_alpha). Any key of the case is an axis as well (``e``,
        ``formulation``, ``frame.xi_s``).
    records : sequence of str, path or Motion, optional
        Ground motions that replace the case's, see `find_records`; each run lasts to the last
        sample unless ``t_end`` is in the grid.
    file : str or path, optional
        NetCDF file to write. Finished chunks are kept beside it until it is complete: repeating the
        call continues an interrupted sweep and gives the same bytes.
    points : mapping, pandas.DataFrame, xarray.Dataset, structured array, str or path, optional
        Table whose rows are runs with individual numbers, or the CSV or NetCDF file that contains
        it. Its columns have the names of grid axes; ``record`` holds names or paths of records.
        They become coordinates along the dimension ``point``.
    quantities : sequence of str, optional
        Quantities stored for each run; the default is ``u_s_max``, or ``theta_max_over_alpha`` for
        a wall without a frame.
    threads : int
        Threads, 0 for all; ignored with an executor. The result does not depend on it.
    executor : concurrent.futures.Executor, optional
        Alternative engine: processes, MPI ranks, Dask workers.
    progress : callable or bool, optional
        True for a bar in a notebook or terminal, or a function that is called with the numbers of
        finished and of all runs.
    restart : bool
        Discard an earlier sweep in `file`; other files are not replaced.
    part : (int, int)
        (K, N): only the K-th of N parts of the chunks, for a later `merge`; requires `file`.
    chunk : int
        Largest number of runs in a chunk, 0 for the default.
    unit : str, optional
        Unit of records that are not AT2: 'g', 'm/s2' or 'cm/s2'.
    dt : float, optional
        Sampling interval of records of one column [s].
    intensity : str, optional
        A kind of `rwmf.records.intensity`. Each record is scaled to an intensity of one, so that
        the values of ``scale`` are intensities: accelerations in g, others in SI units.
    period, damping : float, optional
        Period [s] and damping ratio [-] of a ``pseudo_acceleration``; otherwise those of the frame.
        Both are required where the runs differ in the structure (period, mass ratio, storeys,
        wall), because each record has one factor for all runs.
    periods : sequence of float, optional
        Periods of an ``average_acceleration`` [s].

    Returns
    -------
    xarray.Dataset
        The quantities and ``status`` (numbers, named in its ``flag_meanings``) over all axes. The
        attribute ``warnings`` lists conservation laws that some runs violate. With a file the
        dataset is opened from it; for a part it has attributes only.

    Raises
    ------
    InputError
        When an argument is not acceptable, or when `file` is an input of the sweep or holds
        another.
    OutputError
        When the file cannot be written.
    Interrupted
        After Ctrl-C.
    """
    options = (intensity, period, damping, periods)
    request = Request(case, grid, records, points, quantities, chunk, unit, dt, *options)
    with reporting(progress) as report:
        work = _Work(make_plan(request), threads, executor, report, part)
        if file is not None:
            return _sweep_to_file(work, Path(file), restart)
        _check_part(part, in_memory=True)
        chunks = {chunk.number: chunk for chunk in work.run(set())}
    return _to_dataset(work.plan.layout, chunks.__getitem__)


class _Work:
    """Chunks of a plan for one call, with progress reports."""

    def __init__(
        self,
        plan: Plan,
        threads: int,
        executor: Executor | None,
        progress: Progress | None,
        part: tuple[int, int],
    ) -> None:
        _check_part(part)
        self.plan = plan
        self.part = part
        # the owner of an executor chooses the number of its workers
        self._threads = count_threads(threads) if executor is None else 0
        self._executor = executor
        self._progress = progress
        k, n = part
        self._numbers = range(k - 1, plan.layout.n_chunks, n)

    def run(self, done: set[int]) -> Iterator[Chunk]:
        """Compute the missing chunks."""
        layout = self.plan.layout
        sizes = {number: layout.chunk_size(number) for number in self._numbers}
        total = sum(sizes.values())
        finished = sum(sizes[number] for number in done if number in sizes)
        missing = [number for number in self._numbers if number not in done]

        def report_progress(unfinished: int = 0) -> None:
            if self._progress is not None:
                self._progress(finished + unfinished, total)

        report_progress()
        if self._executor is None:
            chunks = run_in_threads(self.plan.task, missing, self._threads, report_progress)
        else:
            chunks = run_on(self._executor, (self.plan.task(number) for number in missing))
        for result in chunks:
            finished += sizes[result.number]
            yield result
            report_progress()


def _sweep_to_file(work: _Work, path: Path, restart: bool) -> xr.Dataset:
    netcdf.check_package()
    store_path = path_of_store(path, work.part)
    files.check_outputs([path, store_path], work.plan.inputs)
    if not files.is_regular_or_new(path):
        raise InputError(f"{path}: a sweep is read again, it needs a regular file")
    layout = work.plan.layout
    if path.exists():
        if not restart:
            _check_same(path, layout)
            if work.part[1] == 1 and store_path.exists():
                # of a run that was killed behind its file; not that of another or running sweep
                with suppress(InputError, OutputError), ChunkStore(store_path, layout):
                    files.remove(store_path)
            return open_result(path)
        # discard nothing but a sweep
        netcdf.read_identity(path)
    with ChunkStore(store_path, layout, restart=restart) as store:
        if restart:
            files.remove(path)
        done = {number for number in range(layout.n_chunks) if number in store}
        try:
            for result in work.run(done):
                store.add(result)
        except KeyboardInterrupt as error:
            raise Interrupted(
                f"{len(store)} of {layout.n_chunks} chunks are kept in {store_path}; the same "
                "command continues"
            ) from error
        if work.part[1] > 1:
            return xr.Dataset(attrs=netcdf.attributes(layout))
        netcdf.write(layout, store.get, path)
        # rename while locked, so that another process finds the complete file
        files.remove(store_path)
    return open_result(path)


def path_of_store(path: Path, part: tuple[int, int] = (1, 1)) -> Path:
    """Return the path of the store for the chunks of a sweep or of one part."""
    suffix = "" if part[1] == 1 else f".part-{part[0]}-of-{part[1]}"
    return path.with_name(f"{path.name}{suffix}.journal")


@checked
def merge(parts: Sequence[str | os.PathLike[str]], file: str | os.PathLike[str]) -> xr.Dataset:
    """Join the parts of a sweep into the same file as an undivided one.

    Parameters
    ----------
    parts : sequence of str or path
        Journals of all parts.
    file : str or path
        NetCDF file to write.

    Returns
    -------
    xarray.Dataset
        Dataset opened from the file.

    Raises
    ------
    InputError
        When a part is missing, or when the parts are not of one sweep.
    OutputError
        When the file cannot be written.
    """
    netcdf.check_package()
    parts = [path_of("parts", part) for part in parts]
    files.check_outputs([file], parts)
    if not parts:
        raise InputError("parts: the list is empty")
    layout = read_layout(Path(parts[0]))
    with ExitStack() as stack:
        stores = []
        for name in parts:
            if not Path(name).is_file():
                raise InputError(f"{name}: the file does not exist")
            stores.append(stack.enter_context(ChunkStore(Path(name), layout)))
        owner = {n: item for item in stores for n in range(layout.n_chunks) if n in item}
        if len(owner) < layout.n_chunks:
            missing = layout.n_chunks - len(owner)
            raise InputError(
                f"{missing} of {layout.n_chunks} chunks are in none of the parts: a part is "
                "missing or has not finished"
            )
        netcdf.write(layout, lambda number: owner[number].get(number), Path(file))
    return open_result(Path(file))


def open_result(path: Path) -> xr.Dataset:
    """Open the file of a sweep."""
    return xr.open_dataset(path, engine="h5netcdf")


def _check_same(path: Path, layout: Layout) -> None:
    old, new = netcdf.read_identity(path), layout.to_text()
    if old != new:
        raise InputError(
            f"{path}: holds another sweep (-), not this one (+):\n{difference(old, new)}\n"
            "restart to discard it, or write to another file"
        )


def _check_part(part: tuple[int, int], *, in_memory: bool = False) -> None:
    k, n = part
    if not 1 <= k <= n:
        raise InputError(f"part {k}/{n}: K/N needs 1 <= K <= N")
    if in_memory and n > 1:
        raise InputError(f"part {k}/{n}: a part needs a file to keep its chunks")


def _to_dataset(layout: Layout, source: Callable[[int], Chunk]) -> xr.Dataset:
    """Label a sweep in memory as if xarray had read it from a file."""
    names = netcdf.status_names(layout, source)
    arrays = netcdf.assemble(layout, source, names)
    axes = {
        item.name: (item.dimension, layout.labels(item), item.attributes)
        for item in layout.coordinates
    }
    found: dict[str, Any] = {
        name: (layout.dims, arrays[name], ORDINATES[name].attributes) for name in layout.quantities
    }
    found["status"] = (layout.dims, arrays["status"], netcdf.status_attributes(names))
    return xr.Dataset(coords=axes, attrs=netcdf.attributes(layout)).assign(found)
