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
from importlib.metadata import version
from pathlib import Path
from typing import NamedTuple

from instruction_counts.calls import CALLS, Call, write_record

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


class StaleBuildError(UnmeasurableError):
    """The build is missing or older than its sources."""


class ValgrindMissingError(UnmeasurableError):
    """There is no valgrind."""


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


class Build(NamedTuple):
    """The build folder of a checkout, and its programs.

    Attributes
    ----------
    root : path
        The checkout.
    """

    root: Path

    @property
    def folder(self) -> Path:
        """The build folder of meson."""
        return self.root / "build"

    @property
    def host(self) -> Path:
        """The program that makes the calls of a host."""
        return self.folder / "bench" / "standard_calls"

    @property
    def marks(self) -> Path:
        """The library of the marks."""
        return self.folder / "bench" / "libcallgrind_marks.so"

    @property
    def batch(self) -> Path:
        """The batch program."""
        return self.folder / "src" / "app" / "rwmf-batch"

    @property
    def extension(self) -> Path:
        """The extension of the Python package."""
        found = self.folder.glob("src/bindings/python/_kernel.*.so")
        return next(found, self.folder / "src" / "bindings" / "python" / "_kernel.so")

    def check(self) -> None:
        """Check that no program is missing or older than one of its sources."""
        kernel = self.root / "src" / "rwmf"
        bench = self.root / "bench"
        parts = {
            self.host: (kernel, bench / "standard_calls.f90"),
            self.marks: (bench / "callgrind_marks.c",),
            self.batch: (kernel, self.root / "src" / "app"),
            self.extension: (kernel, self.root / "src" / "bindings" / "python"),
        }
        for program, sources in parts.items():
            shown = program.relative_to(self.root)
            if not program.is_file():
                raise StaleBuildError(f"{shown} is missing: build first (tools/run --version)")
            built = program.stat().st_mtime
            for source in _files(sources):
                if source.stat().st_mtime > built:
                    raise StaleBuildError(
                        f"{shown} is older than {source.relative_to(self.root)}: "
                        "build first (tools/run --version)"
                    )

    def setting(self) -> dict[str, str]:
        """Compiler, flags and libraries of the build."""
        info = self.folder / "meson-info"
        try:
            compilers = json.loads((info / "intro-compilers.json").read_text(encoding="utf-8"))
            options = json.loads((info / "intro-buildoptions.json").read_text(encoding="utf-8"))
        except OSError as error:
            raise StaleBuildError("there is no build: build first (tools/run --version)") from error
        values = {option["name"]: option["value"] for option in options}
        flags = [f"buildtype={values['buildtype']}"]
        flags += [*values["fortran_args"], *values["c_args"]]
        packages = [f"{name} {version(name)}" for name in ("numpy", "xarray")]
        return {
            "compiler": compilers["host"]["fortran"]["full_version"],
            "flags": " ".join(flags),
            "machine": platform.machine(),
            "libc": " ".join(platform.libc_ver()),
            "python": ", ".join([f"CPython {platform.python_version()}", *packages]),
        }


def measure(build: Build, names: Iterable[str]) -> Measured:
    """Count calls."""
    if not shutil.which("valgrind"):
        raise ValgrindMissingError("valgrind is missing (Debian: apt-get install valgrind)")
    build.check()
    record = build.root / "inputs" / "records" / "elcentro.csv"
    if not record.is_file():
        raise UnmeasurableError("inputs/records/elcentro.csv is missing: call tools/run first")
    wanted = [call for call in CALLS if call.name in set(names)]
    with tempfile.TemporaryDirectory() as name, ThreadPoolExecutor(os.cpu_count()) as executor:
        folder = Path(name)
        write_record(record, folder)
        tasks = [executor.submit(_count_in, build, group, folder) for group in _shares(wanted)]
        counted = [task.result() for task in tasks]
    setting = build.setting()
    counts: dict[str, int] = {}
    for instruction_set, found in counted:
        counts |= found
        if instruction_set:
            setting["lanes"] = instruction_set
    missing = [call.name for call in wanted if call.name not in counts]
    if missing:
        raise UnmeasurableError(f"callgrind wrote no count of {', '.join(missing)}")
    return Measured(setting, {call.name: counts[call.name] for call in wanted})


def _files(sources: Iterable[Path]) -> Iterator[Path]:
    for source in sources:
        if source.is_file():
            yield source
        # hosts and batch program do not link the baseline
        yield from (
            path
            for path in source.rglob("*")
            if path.suffix in _SUFFIXES and "baseline" not in path.parts
        )


def _shares(calls: list[Call]) -> Iterator[list[Call]]:
    """Share calls out to processes, the slowest first."""
    for program in ("python", "host", "batch"):
        share = [call for call in calls if call.program == program]
        if share:
            yield share


def _count_in(build: Build, calls: list[Call], folder: Path) -> tuple[str, dict[str, int]]:
    """Count calls of one program, and return the instruction set that it reports as well."""
    cases = [call.write(folder) for call in calls]
    if calls[0].program == "batch":
        counts = (_count_batch(build, case, folder) for case in cases)
        return "", dict(zip((call.name for call in calls), counts, strict=True))
    words: list[str | Path] = [
        word
        for call, case in zip(calls, cases, strict=True)
        for word in (call.kind, call.name, case)
    ]
    command: list[str | Path] = [build.host, *words]
    if calls[0].program == "python":
        program = "instruction_counts.in_python"
        command = [sys.executable, "-m", program, build.marks, *words]
    out = folder / f"{calls[0].program}.out"
    printed = _run(build, ["--instr-atstart=no", f"--callgrind-out-file={out}"], command)
    found: dict[str, int] = {}
    for dump in folder.glob(f"{out.name}*"):
        text = dump.read_text(encoding="utf-8")
        if name := re.search(r"^desc: Trigger: Client Request: (\w+)$", text, re.MULTILINE):
            found[name[1]] = _total(text)
    return printed.splitlines()[0], found


def _count_batch(build: Build, case: Path, folder: Path) -> int:
    """Instructions that a second, equal case adds to a call of the batch program."""
    copy = folder / f"{case.stem}_2.nml"
    copy.write_bytes(case.read_bytes())
    totals = []
    for words in ([case], [case, copy]):
        out = folder / "batch.out"
        _run(build, [f"--callgrind-out-file={out}"], [build.batch, *words])
        totals.append(_total(out.read_text(encoding="utf-8")))
    return totals[1] - totals[0]


def _total(text: str) -> int:
    """Return the sum of a file of callgrind (``summary`` forgets threads that have ended)."""
    match = re.search(r"^totals: (\d+)", text, re.MULTILINE)
    if match is None:
        raise UnmeasurableError("callgrind wrote a file without a sum")
    return int(match[1])


def _run(build: Build, options: list[str], command: list[str | Path]) -> str:
    """Run a program under callgrind and return its output."""
    path = os.pathsep.join([str(build.root / "driver"), str(build.root / "tools")])
    done = subprocess.run(
        ["valgrind", "--tool=callgrind", *options, *map(str, command)],
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
