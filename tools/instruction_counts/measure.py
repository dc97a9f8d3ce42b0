"""Count the instructions of standard calls by valgrind's callgrind.

One thread, fixed hash seed, all symbols bound at start. Calls of a host and of Python are marked
(``bench/callgrind_marks.c``), which excludes start-up, imports, reading and a first call. The count
of the batch program is the increase for a second, equal case.
"""

from __future__ import annotations

import json
import os
import platform
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from importlib.metadata import version
from pathlib import Path
from typing import NamedTuple

from instruction_counts.calls import CALLS, Call, write_record

ROOT = Path(__file__).resolve().parents[2]
_BUILD = ROOT / "build"
HOST = _BUILD / "bench" / "standard_calls"
MARKS = _BUILD / "bench" / "libcallgrind_marks.so"
BATCH = _BUILD / "src" / "app" / "rwmf-batch"
_EXTENSIONS = _BUILD / "src" / "bindings" / "python"
EXTENSION = next(_EXTENSIONS.glob("_kernel.*.so"), _EXTENSIONS / "_kernel.so")
# variables of the environment that affect counts
_SETTINGS = {
    "LD_BIND_NOW": "1",
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "PYTHONHASHSEED": "0",
    "PYTHONDONTWRITEBYTECODE": "1",
    "LC_ALL": "C.UTF-8",
}
_SUFFIXES = {".f90", ".F90", ".c", ".h", ".inc"}


class UnmeasurableError(Exception):
    """The measurement is impossible; the message gives the missing part and a remedy."""


class Measured(NamedTuple):
    """Measured counts.

    Attributes
    ----------
    setting : dict of str to str
        Conditions of the counts besides the sources. These are those of the build, and ``lanes``,
        the instruction set of the kernel under valgrind, which does not support AVX-512.
    counts : dict of str to int
        Instructions by name of the call.
    """

    setting: dict[str, str]
    counts: dict[str, int]


def _check_build() -> None:
    """Check that no program is missing or older than one of its sources."""
    parts = {
        HOST: ("src/rwmf", "bench/standard_calls.f90"),
        MARKS: ("bench/callgrind_marks.c",),
        BATCH: ("src/rwmf", "src/app"),
        EXTENSION: ("src/rwmf", "src/bindings/python"),
    }
    for program, sources in parts.items():
        fault = "missing" if not program.is_file() else ""
        for source in () if fault else _files(sources):
            if source.stat().st_mtime > program.stat().st_mtime:
                fault = f"older than {source.relative_to(ROOT)}"
        if fault:
            shown = program.relative_to(ROOT)
            raise UnmeasurableError(f"{shown} is {fault}: build first (tools/run --version)")


def _files(sources: Iterable[str]) -> Iterator[Path]:
    """List the sources; hosts and batch program do not link the baseline."""
    for place in map(ROOT.joinpath, sources):
        yield from (
            [place]
            if place.is_file()
            else (
                path
                for path in place.rglob("*")
                if path.suffix in _SUFFIXES and "baseline" not in path.parts
            )
        )


def setting_of_build() -> dict[str, str]:
    """Compiler, flags and libraries of the build."""
    info = ROOT / "build" / "meson-info"
    try:
        compilers = json.loads((info / "intro-compilers.json").read_text(encoding="utf-8"))
        options = json.loads((info / "intro-buildoptions.json").read_text(encoding="utf-8"))
    except OSError as error:
        raise UnmeasurableError("no build: build first (tools/run --version)") from error
    values = {option["name"]: option["value"] for option in options}
    flags = [f"buildtype={values['buildtype']}", *values["fortran_args"], *values["c_args"]]
    packages = [f"{name} {version(name)}" for name in ("numpy", "xarray")]
    return {
        "compiler": compilers["host"]["fortran"]["full_version"],
        "flags": " ".join(flags),
        "machine": platform.machine(),
        "libc": " ".join(platform.libc_ver()),
        "python": ", ".join([f"CPython {platform.python_version()}", *packages]),
    }


def measure(names: Iterable[str]) -> Measured:
    """Count calls."""
    if not shutil.which("valgrind"):
        raise UnmeasurableError("valgrind is missing (Debian: apt-get install valgrind)")
    _check_build()
    record = ROOT / "inputs" / "records" / "elcentro.csv"
    if not record.is_file():
        raise UnmeasurableError("inputs/records/elcentro.csv is missing: call tools/run first")
    wanted = [call for call in CALLS if call.name in set(names)]
    # the slowest first
    shares = [[call for call in wanted if call.program == x] for x in ("python", "host", "batch")]
    setting = setting_of_build()
    counts: dict[str, int] = {}
    with tempfile.TemporaryDirectory() as name, ThreadPoolExecutor(os.cpu_count()) as executor:
        folder = Path(name)
        write_record(record, folder)
        count = partial(_count_in, folder)
        for instruction_set, found in executor.map(count, filter(None, shares)):
            counts |= found
            if instruction_set:
                setting["lanes"] = instruction_set
    missing = [call.name for call in wanted if call.name not in counts]
    if missing:
        raise UnmeasurableError(f"callgrind wrote no count of {', '.join(missing)}")
    return Measured(setting, {call.name: counts[call.name] for call in wanted})


def _count_in(folder: Path, calls: list[Call]) -> tuple[str, dict[str, int]]:
    """Count calls of one program, and return the instruction set that it reports as well."""
    cases = {call: call.write(folder) for call in calls}
    program = calls[0].program
    if program == "batch":
        return "", {call.name: _count_batch(case, folder) for call, case in cases.items()}
    words = [str(word) for call, case in cases.items() for word in (call.kind, call.name, case)]
    python = [sys.executable, "-m", "instruction_counts.in_python", str(MARKS)]
    command = [*(python if program == "python" else [str(HOST)]), *words]
    out = folder / f"{program}.out"
    printed = _run(["--instr-atstart=no", f"--callgrind-out-file={out}"], command)
    found: dict[str, int] = {}
    for dump in folder.glob(f"{out.name}*"):
        text = dump.read_text(encoding="utf-8")
        if name := re.search(r"^desc: Trigger: Client Request: (\w+)$", text, re.MULTILINE):
            found[name[1]] = _total(text)
    return printed.splitlines()[0], found


def _count_batch(case: Path, folder: Path) -> int:
    """Instructions that a second, equal case adds to a call of the batch program."""
    copy = folder / f"{case.stem}_2.nml"
    copy.write_bytes(case.read_bytes())
    totals = []
    for cases in ([case], [case, copy]):
        out = folder / "batch.out"
        _run([f"--callgrind-out-file={out}"], list(map(str, [BATCH, *cases])))
        totals.append(_total(out.read_text(encoding="utf-8")))
    return totals[1] - totals[0]


def _total(text: str) -> int:
    """Return the sum of a file of callgrind (``summary`` forgets threads that have ended)."""
    match = re.search(r"^totals: (\d+)", text, re.MULTILINE)
    if match is None:
        raise UnmeasurableError("callgrind wrote a file without a sum")
    return int(match[1])


def _run(options: list[str], command: list[str]) -> str:
    """Run a program under callgrind and return its output."""
    path = os.pathsep.join([str(ROOT / "driver"), str(ROOT / "tools")])
    done = subprocess.run(
        ["valgrind", "--tool=callgrind", *options, *command],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, **_SETTINGS, "PYTHONPATH": path},
    )
    if done.returncode:
        said = (done.stdout + done.stderr).splitlines()
        last = "\n".join([line for line in said if not line.startswith("==")][-12:])
        raise UnmeasurableError(f"{Path(command[0]).name} failed under callgrind:\n{last}")
    return done.stdout
