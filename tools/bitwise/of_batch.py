"""Rows of the batch program: every input and scene."""

from __future__ import annotations

import os
import subprocess
from collections.abc import Iterator
from functools import partial
from pathlib import Path

from bitwise import scenes
from bitwise.clean import csv_text
from bitwise.rows import Row
from bitwise.scenes import METHODS, Scene
from bitwise.tree import Tree

_THREADS = (1, 2)
# every so many of the inputs and scenes are in the quick part
_QUICK_INPUT, _QUICK_SCENE = 4, 5
_COARSE = "0.05"  # interval of histories that are there for the state inside a step [s]
_FEW = 24  # periods of a spectrum with a method that runs one after the other


def rows(tree: Tree) -> Iterator[Row]:
    """List the rows of the batch program."""
    batch = tree.batch
    for i, path in enumerate(tree.inputs):
        yield from _of_input(batch, path, i % _QUICK_INPUT == 0)
    for i, scene in enumerate(scenes.read_scenes()):
        yield from _of_scene(batch, scene, i)


def _of_input(batch: Path, path: Path, is_quick: bool) -> Iterator[Row]:
    scene = scenes.from_input(path)
    key = f"batch/input/{scene.name}"
    for threads in _THREADS if scene.has_spectrum else (1,):
        given = partial(run_words, batch, ("--out", ".", str(path)), threads)
        yield Row(f"{key}/given/threads-{threads}", given, is_quick)
    if scenes.has_period(scene.text):
        alone = scenes.with_interval(scenes.without_spectrum(scene.text), _COARSE)
        for i, method in enumerate(METHODS):
            text = scenes.with_solver(alone, method)
            yield Row(
                f"{key}/{method}", partial(run_scene, batch, scene, text), is_quick and i == 3
            )
    if scene.has_spectrum:
        few = scenes.with_fewer_periods(scenes.without_output(scene.text), _FEW)
        for method in ("dop853", "adams"):
            text = scenes.with_solver(few, method, "1.0e-6")
            yield Row(f"{key}/spectrum/{method}", partial(run_scene, batch, scene, text, 2), False)


def _of_scene(batch: Path, scene: Scene, number: int) -> Iterator[Row]:
    key = f"batch/scene/{scene.name}"
    is_quick = number % _QUICK_SCENE == 0
    is_special = scene.name.startswith("special-")
    yield Row(f"{key}/given", partial(run_scene, batch, scene, scene.text, 2), is_special)
    if scene.has_spectrum:
        for threads in _THREADS:
            text = scenes.with_solver(scene.text, "auto", None)
            ask = partial(run_scene, batch, scene, text, threads)
            yield Row(f"{key}/auto/threads-{threads}", ask, is_quick)
    methods = METHODS if is_special else (METHODS[number % 3], METHODS[3])
    for method in methods:
        text = scenes.with_solver(scene.text, method, None)
        yield Row(f"{key}/{method}", partial(run_scene, batch, scene, text, 2), is_quick)


def run_words(batch: Path, words: tuple[str, ...], threads: int = 1) -> str:
    """Run the batch program, which writes into the current folder."""
    environment = os.environ | {"OMP_NUM_THREADS": str(threads)}
    done = subprocess.run([batch, *words], capture_output=True, env=environment, check=False)
    files = "".join(csv_text(path) for path in sorted(Path().glob("*.csv")))
    return f"status {done.returncode}\n{files}"


def run_scene(batch: Path, scene: Scene, text: str, threads: int = 1) -> str:
    """Run a scene in the current folder."""
    return run_words(batch, (str(scene.put(text)),), threads)
