"""Locations in a checkout: program, library, modules, inputs."""

from __future__ import annotations

import subprocess
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

_ARCHIVE = b"!<arch>\n"  # a thin archive of the build names its objects and begins otherwise


class MissingPartError(Exception):
    """The checkout is not built, or lacks a required file."""


@dataclass(frozen=True)
class Tree:
    """A checkout and its files.

    Attributes
    ----------
    root : Path
        Its folder.
    """

    root: Path

    @property
    def batch(self) -> Path:
        """The batch program, wherever the build puts it."""
        return self._newest(p for p in self.root.glob("build/**/rwmf-batch") if p.is_file())

    @property
    def library(self) -> Path:
        """The static library that holds all that a host needs."""
        found = self.root.glob("build/**/librwmf.a")
        return self._newest(path for path in found if _begins_with(path, _ARCHIVE))

    @property
    def modules(self) -> Path:
        """Folder of the module files in double precision."""
        found = self.root.glob("build/**/rwmf.mod")
        double = (path for path in found if "quad" not in str(path.relative_to(self.root)))
        return self._newest(double).parent

    @property
    def header(self) -> Path:
        """Folder of `rwmf.h`."""
        found = [*self.root.glob("include/**/rwmf.h"), *self.root.glob("src/**/rwmf.h")]
        return self._newest(found).parent

    @property
    def inputs(self) -> list[Path]:
        """Every shipped case, in whatever folder below `inputs`, by name; none of a sweep."""
        found = [path for path in self.root.glob("inputs/**/*.nml") if path.parent.name != "sweeps"]
        return sorted(found, key=lambda path: path.stem)

    def _newest(self, found: Iterable[Path]) -> Path:
        """Take the newest: a build keeps the old files when its folders move."""
        paths = sorted(found, key=lambda path: path.stat().st_mtime)
        if not paths:
            raise MissingPartError(f"{self.root}: not built, or a part of it is missing")
        return paths[-1]


def compile_hosts(tree: Tree, folder: Path) -> dict[str, Path]:
    """Compile the host programs in Fortran and C against the library."""
    here = Path(__file__).parent
    programs = {"fortran": folder / "host_fortran", "c": folder / "host_c"}
    library = [str(tree.library), "-llapack", "-lblas", "-lquadmath", "-fopenmp"]
    fortran = ["gfortran", "-O1", f"-I{tree.modules}", f"-J{folder}", str(here / "host.f90")]
    c = ["gcc", "-O1", f"-I{tree.header}", str(here / "host.c")]
    _run([*fortran, "-o", str(programs["fortran"]), *library])
    _run([*c, "-o", str(programs["c"]), *library, "-lgfortran", "-lm"])
    return programs


def _run(words: list[str]) -> None:
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise MissingPartError(f"{' '.join(words)}\n{done.stderr}")


def _begins_with(path: Path, first: bytes) -> bool:
    with path.open("rb") as file:
        return file.read(len(first)) == first
