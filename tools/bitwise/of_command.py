"""Rows of the command `rwmf`: what it prints and writes."""

from __future__ import annotations

import contextlib
import io
import json
import os
from collections.abc import Iterator
from functools import partial
from pathlib import Path

from bitwise import of_batch, scenes
from bitwise.clean import VOLATILE, csv_text, without_times
from bitwise.rows import Row
from bitwise.scenes import CASE, Scene
from bitwise.tree import Tree

_SOME, _QUICK_CHECK, _QUICK = 8, 10, 40
_COMMANDS = (
    "run",
    "spectrum",
    "cost",
    "check",
    "records",
    "sweep",
    "merge",
    "reproduce",
    "animate",
)
_STUDIES = ("overturning", "spectra", "fragility", "wall", "friction", "bands", "equal-response")


def rows(tree: Tree) -> Iterator[Row]:
    """List the rows of the command.

    Parameters
    ----------
    tree : Tree
        The checkout.

    Yields
    ------
    Row
        One for each word and scene.
    """
    yield Row("command/namelist-page", partial(read_page, tree))
    for i, scene in enumerate(scenes.read_scenes()):
        check = partial(say, scene, ("check", CASE))
        yield Row(f"command/check/{scene.name}", check, i % _QUICK_CHECK == 0)
        if scene.has_spectrum:
            yield from _of_spectrum(scene)
        elif i % _SOME == 0 or scene.has_accuracy:
            is_quick = i % _QUICK == 0
            run = partial(say, scene, ("run", CASE, "--json", "--out", "."))
            yield Row(f"command/run-json/{scene.name}", run, is_quick)
            yield Row(f"command/run/{scene.name}", partial(say, scene, ("run", CASE)), is_quick)
    for path in tree.inputs:
        key = f"command/check/input-{path.stem}"
        yield Row(key, partial(say, scenes.from_input(path), ("check", CASE)), False)
    for scene in scenes.read_refused()[::_SOME]:
        yield Row(f"command/refused/{scene.name}", partial(say, scene, ("run", CASE)))
    yield Row("command/merge", partial(merge_parts, tree))
    yield Row("command/records-list", partial(say, None, ("records", "list")))
    export = ("records", "export", "elcentro", "elcentro.csv")
    yield Row("command/records-export", partial(say, None, export))
    helps = [(word,) for word in _COMMANDS] + [("study", word) for word in _STUDIES]
    for words in [(), *helps]:
        key = "-".join(("help", *words))
        yield Row(f"command/{key}", partial(say, None, (*words, "--help")), False)


def _of_spectrum(scene: Scene) -> Iterator[Row]:
    words = ("spectrum", CASE, "--threads", "2")
    for key, more in (("json", ("--json", "--csv", "found.csv")), ("table", ())):
        yield Row(f"command/spectrum-{key}/{scene.name}", partial(say, scene, (*words, *more)))


def read_page(tree: Tree) -> str:
    """Give the reference of groups and keys; a test compares it with the kernel's table.

    Parameters
    ----------
    tree : Tree
        The checkout.

    Returns
    -------
    str
        All tables, without the introduction.
    """
    page = tree.namelist_page.read_text(encoding="utf-8")
    return page[page.index("## `&") :]


def merge_parts(tree: Tree) -> str:
    """Join two parts of a spectrum that the batch program made.

    Parameters
    ----------
    tree : Tree
        The checkout.

    Returns
    -------
    str
        Exit status, outputs, files.
    """
    of_batch.run_parts(tree.batch)
    parts = sorted(str(path) for path in Path().glob("*.part-*.csv"))
    return say(None, ("merge", "case.spectrum.csv", *parts))


def say(scene: Scene | None, words: tuple[str, ...]) -> str:
    """Give what a command prints about a scene, and the files that it writes.

    Parameters
    ----------
    scene : Scene or None
        The scene, whose case lies in the current folder.
    words : tuple of str
        Words of the command.

    Returns
    -------
    str
        Exit status, outputs, files.
    """
    # not at the top: this is the command's own module, which the batch rows need not load
    from rwmf.__main__ import main

    if scene is not None:
        scene.put()
    os.environ["COLUMNS"] = "80"
    printed, errors = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(errors):
        try:
            status: object = main(list(words))
        except SystemExit as leave:
            status = leave.code
    text = _without_seconds(printed.getvalue(), is_json="--json" in words)
    files = "".join(csv_text(path, with_case=True) for path in sorted(Path().glob("*.csv")))
    return f"status {status}\n{text}{without_times(errors.getvalue())}{files}"


def _without_seconds(text: str, *, is_json: bool) -> str:
    if is_json and text:
        found = json.loads(text)
        return json.dumps({key: found[key] for key in found if key not in VOLATILE}, indent=1)
    lines = without_times(text).split("\n")
    return "\n".join(line for line in lines if line.split(" ")[0] not in VOLATILE)
