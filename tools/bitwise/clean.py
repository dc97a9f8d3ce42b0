"""Take out of a text what may change from run to run: times, places, versions, thread counts."""

from __future__ import annotations

import csv
import re
from pathlib import Path

# columns of a summary, and keys of JSON objects and attributes, that hold a time or a machine
VOLATILE = frozenset({"seconds", "estimate_seconds", "threads", "version"})

# only where a command tells how long it took: messages name times too, of the response
_SECONDS = re.compile(r"(\(| in |ordinates, )\d*\.\d+ s\b")
_THREADS = re.compile(r"\b\d+ threads\b")
_VERSION = re.compile(r'(\brwmf |"version": ")\d+\.\d+\.\d+')
_FILE = re.compile(r"(['\"])<(?:here|root)>/[^'\"\n]*?([^/'\"\n]+)\1")


def without_times(text: str) -> str:
    """Replace seconds and thread counts in what a command prints.

    Parameters
    ----------
    text : str
        Output of a command.

    Returns
    -------
    str
        The same with marks in their place.
    """
    return _THREADS.sub("<n> threads", _SECONDS.sub(r"\1<t> s", text))


def without_versions(text: str) -> str:
    """Replace the version of rwmf where a file says what made it.

    Parameters
    ----------
    text : str
        Any text.

    Returns
    -------
    str
        The same with a mark in its place: a release changes no row.
    """
    return _VERSION.sub(r"\1<version>", text)


def without_places(text: str, folder: Path, root: Path) -> str:
    """Replace the paths of the folder in use and of the checkout.

    Parameters
    ----------
    text : str
        Any text.
    folder, root : Path
        What stands for the two.

    Returns
    -------
    str
        The same with marks in their place; quoted paths of files keep their last part only, so
        that inputs may move between folders.
    """
    text = text.replace(str(folder), "<here>").replace(str(root), "<root>")
    return _FILE.sub(r"\1<...>/\2\1", text)


def csv_text(path: Path, *, with_case: bool) -> str:
    """Read a CSV file of rwmf without its times.

    Parameters
    ----------
    path : Path
        Summary, history or spectrum.
    with_case : bool
        Keep the case that the head repeats; inputs have comments that may change.

    Returns
    -------
    str
        Head without version, names of the columns, values.
    """
    lines = path.read_text(encoding="utf-8", errors="surrogateescape").split("\n")
    head = [line for line in lines if line.startswith("#")][1:]
    body = [line for line in lines if not line.startswith("#")]
    head = [re.sub(r"(record: )\S*/", r"\1", line) for line in head]
    if not with_case:
        head = head[: next((i for i, line in enumerate(head) if line.startswith("# case")), None)]
    return "\n".join([f"[{path.name}]", *head, *_without_columns(body)]) + "\n"


def _without_columns(lines: list[str]) -> list[str]:
    """Leave out the columns of times; other lines stay as they are, character by character."""
    names = lines[0].split(",")
    if not VOLATILE & set(names):
        return lines
    kept = [i for i, name in enumerate(names) if name not in VOLATILE]
    rows = csv.reader(lines)
    return ["\t".join(row[i] for i in kept) for row in rows if row]
