"""Command tools/words: count the style of all texts and compare it with the limits."""

from __future__ import annotations

import argparse
import sys
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

from prose.limits import LIMITS
from prose.rules import RULES, count_words
from prose.texts import KINDS, Text, read_fortran, read_page, read_python

ROOT = Path(__file__).resolve().parents[2]
_FOLDERS = ("driver", "tools", "bench", "plots", "tests", "src", "examples", "docs", "validation")
_READERS = {".py": read_python, ".f90": read_fortran, ".F90": read_fortran, ".md": read_page}

Counts = dict[tuple[str, str], dict[str, int]]
Places = list[tuple[str, str, str]]


def main(words: list[str] | None = None) -> int:
    """Run the command.

    Parameters
    ----------
    words : list of str, optional
        Arguments; otherwise those of the process.

    Returns
    -------
    int
        Exit status: 1 when a count exceeds its limit.
    """
    parser = argparse.ArgumentParser(prog="tools/words", description=__doc__)
    parser.add_argument("--counts", action="store_true", help="print the table of counts")
    parser.add_argument("--list", choices=(*KINDS, *RULES), help="print the places of a kind")
    options = parser.parse_args(words)
    counts, places = _count(ROOT)
    if options.list:
        for kind, rule, place in places:
            if options.list in (kind, rule):
                print(f"{place} [{kind}, {rule}]")
        return 0
    if options.counts:
        _print_counts(counts)
        return 0
    return _compare(counts)


def _count(root: Path) -> tuple[Counts, Places]:
    """Count words and broken rules by folder and kind of text, and list the places."""
    counts: Counts = defaultdict(lambda: dict.fromkeys(("words", *RULES), 0))
    places: Places = []
    for folder, path in _files(root):
        for text in _READERS[path.suffix](path.read_text(encoding="utf-8")):
            if _is_input(folder, text):
                continue
            row = counts[folder, text.kind]
            row["words"] += 0 if text.kind == "code" else count_words(text)
            for rule, find in RULES.items():
                if text.kind == "code" and rule != "wide":
                    continue
                for line, shown in find(text):
                    row[rule] += 1
                    name = f"{path.relative_to(root)}:{line}"
                    places.append((text.kind, rule, f"{name}: {shown}"))
    return counts, places


def _files(root: Path) -> Iterator[tuple[str, Path]]:
    yield from (("", path) for path in sorted(root.glob("*.md")))
    for folder in _FOLDERS:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in _READERS:
                yield folder, path


def _is_input(folder: str, text: Text) -> bool:
    """Literals of tests are inputs and expected outputs, not messages."""
    return folder == "tests" and text.kind == "messages"


def _totals(counts: Counts) -> dict[str, dict[str, int]]:
    totals = {kind: dict.fromkeys(("words", *RULES), 0) for kind in KINDS}
    for (_, kind), row in counts.items():
        for name, number in row.items():
            totals[kind][name] += number
    return totals


def _rate(row: dict[str, int], rule: str) -> float:
    """Count of a rule; of "what" its number in 1,000 words."""
    return 1000 * row["what"] / max(row["words"], 1) if rule == "what" else row[rule]


def _print_counts(counts: Counts) -> None:
    print(f"{'folder':<12}{'kind':<12}{'words':>8}{'what/1000':>11}", end="")
    print("".join(f"{rule:>10}" for rule in list(RULES)[1:]))
    totals = [(("all", kind), row) for kind, row in _totals(counts).items()]
    for (folder, kind), row in [*sorted(counts.items()), *totals]:
        print(f"{folder or '.':<12}{kind:<12}{row['words']:>8}{_rate(row, 'what'):>11.2f}", end="")
        print("".join(f"{row[rule]:>10}" for rule in list(RULES)[1:]))


def _compare(counts: Counts) -> int:
    """Print every count above its limit, and return the exit status."""
    status = 0
    for kind, row in _totals(counts).items():
        for rule, limit in LIMITS[kind].items():
            if _rate(row, rule) > limit:
                print(f"words: {kind}: {rule} {_rate(row, rule):.4g}, limit {limit:g}; ", end="")
                print(f"tools/words --list {rule} prints the places")
                status = 1
    return status


if __name__ == "__main__":
    sys.exit(main())
