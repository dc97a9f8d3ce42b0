"""Rows of a host in Fortran: whole cases, spectra, stepping, the wall as an element."""

from __future__ import annotations

import subprocess
from collections.abc import Iterator
from functools import partial
from pathlib import Path

from bitwise import scenes
from bitwise.rows import Row
from bitwise.scenes import CASE, METHODS, Scene

_WHOLE, _QUICK = 6, 5  # every so many scenes


def rows(program: Path) -> Iterator[Row]:
    """List the rows of the host."""
    for i, scene in enumerate(scenes.read_scenes()):
        for kind, method in _questions(scene, i):
            text = scene.text if method is None else scenes.with_solver(scene.text, method, None)
            key = "/".join(filter(None, ("fortran", kind, scene.name, method)))
            yield Row(key, partial(ask, program, kind, scene, text), i % _QUICK == 0)


def _questions(scene: Scene, number: int) -> Iterator[tuple[str, str | None]]:
    """Ways of use and methods of a scene."""
    if scene.has_spectrum:
        yield from (("spectrum-1", None), ("spectrum-2", None))
        return
    yield "element", None
    yield "stepping", "taylor"
    yield "stepping", METHODS[number % 3]
    if number % _WHOLE == 0 or scene.has_accuracy:
        yield "simulate", None


def ask(program: Path, kind: str, scene: Scene, text: str) -> str:
    """Run a host on a scene."""
    scene.put(text)
    found = subprocess.run(
        [program, kind, CASE], capture_output=True, encoding="utf-8", errors="replace", check=False
    )
    return f"status {found.returncode}\n{found.stdout}"
