"""Locations in a checkout: program, inputs, host."""

from __future__ import annotations

import subprocess
from dataclasses import dataclass
from pathlib import Path


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
        """The batch program."""
        return self._built("app/rwmf-batch")

    @property
    def inputs(self) -> list[Path]:
        """Every shipped case, in whatever folder below `inputs`, by name; none of a sweep."""
        found = [path for path in self.root.glob("inputs/**/*.nml") if path.parent.name != "sweeps"]
        return sorted(found, key=lambda path: path.stem)

    def compile_host(self, folder: Path) -> Path:
        """Compile the host program against the library."""
        program = folder / "host"
        modules = self._built("librwmf.a.p/rwmf.mod").parent
        sources = [Path(__file__).with_name("host.f90"), self._built("package/librwmf.a")]
        flags = ["-O1", f"-I{modules}", f"-J{folder}"]
        libraries = ["-llapack", "-lblas", "-lquadmath", "-fopenmp"]
        words = ["gfortran", *flags, "-o", str(program), *map(str, sources), *libraries]
        done = subprocess.run(words, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise MissingPartError(f"the host does not compile:\n{done.stderr}")
        return program

    def _built(self, name: str) -> Path:
        path = self.root / "build" / "src" / name
        if not path.is_file():
            raise MissingPartError(f"{path} is missing: build first")
        return path
