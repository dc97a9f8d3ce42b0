"""Products of ``python -m reproduce``: the paper's figures, verdicts on its claims, validation."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from rwmf._files import files
from rwmf._progress import progress_bar
from rwmf.errors import InputError, OutputError

from reproduce import figures, pages
from reproduce.response_cache import ResponseCache

__all__ = ["main"]

_ROOT = Path(__file__).resolve().parents[2]
_PAGES = {"claims.md": pages.claims_page, "validation.md": pages.validation_page}


def main(arguments: Sequence[str] | None = None) -> int:
    """Make the requested products."""
    parser = argparse.ArgumentParser(prog="python -m reproduce", description=__doc__)
    text = "4 to 13, benefit, band, free, block, g5, disc, six_storeys; all when absent"
    parser.add_argument("figures", nargs="*", metavar="FIGURE", help=text)
    text = "write claims.md and validation.md there"
    parser.add_argument("--docs", type=Path, metavar="DIR", help=text)
    for name, place in (
        ("out", _ROOT / "build" / "plots"),
        ("inputs", _ROOT / "inputs"),
        ("validation", _ROOT / "validation"),
    ):
        parser.add_argument(f"--{name}", type=Path, metavar="DIR", default=place)
    return run(parser.parse_args(arguments))


def run(options: argparse.Namespace) -> int:
    """Make the products of the given options."""
    started = time.perf_counter()
    names = list(dict.fromkeys(figures.find(word) for word in options.figures or figures.FIGURES))
    _check_folders(options, names)
    cache = ResponseCache(options.inputs, options.validation)
    with progress_bar(len(names)) as step:
        for done, name in enumerate(names):
            if step is None:
                print(figures.FIGURES[name].caption, flush=True)
            figures.make(cache, name, options.out)
            if step is not None:
                step(done + 1, len(names))
    if options.docs:
        _write_pages(cache, options.docs)
    seconds = time.perf_counter() - started
    print(f"{len(names)} figures in {options.out}, {seconds:.1f} s")
    return 0


def _check_folders(options: argparse.Namespace, names: list[str]) -> None:
    """Complain before the computation, not after it."""
    for folder in (options.inputs, options.validation):
        if not folder.is_dir():
            raise InputError(f"{folder}: the folder does not exist")
    for folder in (options.out, options.docs):
        if folder is not None:
            try:
                folder.mkdir(parents=True, exist_ok=True)
            except OSError as error:
                text = f"{folder}: the folder cannot be made: {error.strerror}"
                raise OutputError(text) from error
    written = [options.docs / name for name in _PAGES] if options.docs else []
    drawn = [options.out / f"{name}.{kind}" for name in names for kind in figures.FORMATS]
    read = [*options.inputs.rglob("*"), *options.validation.rglob("*")]
    files.check_outputs([*drawn, *written], read)


def _write_pages(cache: ResponseCache, folder: Path) -> None:
    print("claims and validation", file=sys.stderr, flush=True)
    for name, compose in _PAGES.items():
        files.write_bytes(folder / name, compose(cache).encode())
        print(f"written: {folder / name}")
