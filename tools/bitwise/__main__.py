"""The command `tools/bits`."""

from __future__ import annotations

import argparse
import fnmatch
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

from bitwise import of_batch, of_host, of_python, of_studies
from bitwise.rows import Row, compute, digest_of
from bitwise.scenes import REFERENCE
from bitwise.tree import MissingPartError, Tree

_DIGEST = REFERENCE / "bits.txt"


def main() -> int:
    """Compute the digest, and print, write or compare it."""
    options = _read_options()
    started = time.monotonic()
    try:
        with tempfile.TemporaryDirectory() as folder:
            status = _run(options, Path(folder))
    except MissingPartError as error:
        print(f"bits: {error}", file=sys.stderr)
        status = 2
    print(f"bits: {time.monotonic() - started:.0f} s", file=sys.stderr)
    return status


def _read_options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="tools/bits", description="A digest of the numbers that rwmf gives."
    )
    parser.add_argument("--root", type=Path, required=True, help="the checkout to look at")
    action = parser.add_mutually_exclusive_group()
    action.add_argument(
        "--compare", nargs="?", type=Path, const=_DIGEST, metavar="FILE", help="list changed rows"
    )
    action.add_argument(
        "--write", nargs="?", type=Path, const=_DIGEST, metavar="FILE", help="write the digest"
    )
    action.add_argument("--show", metavar="KEY", help="print the text behind a row")
    action.add_argument("--list", action="store_true", help="print the keys only")
    parser.add_argument("--only", metavar="PATTERN", help="rows with this in their key, or fitting")
    parser.add_argument("--quick", action="store_true", help="a representative part, within 45 s")
    parser.add_argument("--keep", type=Path, metavar="DIR", help="save the text of every row there")
    return parser.parse_args()


def _run(options: argparse.Namespace, folder: Path) -> int:
    tree = Tree(options.root.resolve())
    _check_package(tree)
    rows = [row for row in _every_row(tree, folder) if _is_wanted(row, options)]
    if not rows:
        print("bits: no row has such a key", file=sys.stderr)
        return 2
    if options.list:
        print("\n".join(sorted(row.key for row in rows)))
        return 0
    digest = {}
    for key, text in compute(rows, tree):
        digest[key] = digest_of(text)
        if options.keep:
            _keep(options.keep, key, text)
        if options.show:
            sys.stdout.write(text)
    if options.show:
        return 0
    if options.compare:
        is_part = bool(options.quick or options.only)
        return _compare(digest, options.compare, is_part=is_part)
    lines = "".join(f"{key}\t{digest[key]}\n" for key in sorted(digest))
    if options.write:
        options.write.write_text(lines, encoding="utf-8")
        print(f"bits: {len(digest)} rows written to {options.write}", file=sys.stderr)
    else:
        sys.stdout.write(lines)
    return 0


def _check_package(tree: Tree) -> None:
    """Complain when Python would load another checkout's package."""
    import rwmf

    if not Path(rwmf.__file__).is_relative_to(tree.root):
        raise MissingPartError(f"the package is {rwmf.__file__}, not that of {tree.root}")


def _every_row(tree: Tree, folder: Path) -> Iterator[Row]:
    """All rows, those that take longest first: the two processes end together."""
    yield from of_studies.rows()
    yield from of_python.rows()
    yield from of_batch.rows(tree)
    yield from of_host.rows(tree.compile_host(folder))


def _is_wanted(row: Row, options: argparse.Namespace) -> bool:
    if options.show:
        return bool(row.key == options.show)
    if options.quick and not row.is_quick:
        return False
    pattern = options.only
    return pattern is None or pattern in row.key or fnmatch.fnmatchcase(row.key, pattern)


def _keep(folder: Path, key: str, text: str) -> None:
    path = folder / f"{key}.txt"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8", errors="surrogateescape")


def _compare(digest: dict[str, str], file: Path, *, is_part: bool) -> int:
    """List the differences from a file: changed, missing and (for a whole digest) removed rows."""
    lines = file.read_text(encoding="utf-8").splitlines()
    before = dict(line.split("\t") for line in lines)
    changes = [("differs", key) for key in digest if key in before and before[key] != digest[key]]
    changes += [("new", key) for key in digest if key not in before]
    if not is_part:
        changes += [("missing", key) for key in before if key not in digest]
    for word, key in sorted(changes):
        print(f"{word}\t{key}")
    print(f"bits: {len(digest)} rows, {len(changes)} changed", file=sys.stderr)
    return 1 if changes else 0


if __name__ == "__main__":
    raise SystemExit(main())
