"""``rwmf reproduce``: the paper's figures, its claims, the validation and a report of all."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable
from pathlib import Path

from rwmf import files
from rwmf.commands import progress_bar
from rwmf.errors import InputError, OutputError
from rwmf.reproduce import gallery, pages, report
from rwmf.reproduce.contents import collect
from rwmf.reproduce.workshop import Workshop

__all__ = ["add_parser", "run"]


def add_parser(add: Callable[..., argparse.ArgumentParser]) -> None:
    """Add the subcommand: `add` makes a parser of name, function, text and example."""
    parser = add(
        "reproduce",
        run,
        "Draw the paper's figures again, judge its claims, compare with contact engines.",
        "4 12 --report",
    )
    parser.add_argument(
        "figures",
        nargs="*",
        metavar="FIGURE",
        help="4 to 13, benefit, band, free, block, g5, disc; all when absent",
    )
    parser.add_argument(
        "--report", action="store_true", help="judge the claims and write report.html as well"
    )
    parser.add_argument("--out", type=Path, default=Path("plots"), help="folder of the results")
    parser.add_argument("--docs", type=Path, help="write claims.md and validation.md there")
    parser.add_argument("--inputs", type=Path, default=Path("inputs"), help="folder of the cases")
    parser.add_argument(
        "--validation", type=Path, default=Path("validation"), help="folder of the engines' cases"
    )


def run(options: argparse.Namespace) -> int:
    """Make what the command line asks for and return exit status 0; errors as `collect`."""
    started = time.perf_counter()
    names = list(dict.fromkeys(gallery.find(word) for word in options.figures or gallery.GALLERY))
    _check_folders(options, names)
    work = Workshop(options.inputs, options.validation)
    with progress_bar(len(names)) as step:
        for done, name in enumerate(names):
            if step is None:
                print(gallery.GALLERY[name].caption, flush=True)
            gallery.make(work, name, options.out)
            if step is not None:
                step(done + 1, len(names))
    if options.report or options.docs:
        _write_pages(work, names, options)
    seconds = time.perf_counter() - started
    print(f"{len(names)} figures in {options.out}, {seconds:.1f} s")
    return 0


def _check_folders(options: argparse.Namespace, names: list[str]) -> None:
    """Complain before the computation, not after it."""
    for folder in (options.inputs, options.validation):
        if not folder.is_dir():
            raise InputError(f"{folder}: the folder does not exist; run in the project's folder")
    for folder in (options.out, options.docs):
        if folder is not None:
            try:
                folder.mkdir(parents=True, exist_ok=True)
            except OSError as error:
                text = f"{folder}: the folder cannot be made: {error.strerror}"
                raise OutputError(text) from error
    pages_of = [options.out / "report.html"] if options.report else []
    if options.docs:
        pages_of += [options.docs / "claims.md", options.docs / "validation.md"]
    drawn = [options.out / f"{name}.{kind}" for name in names for kind in gallery.FORMATS]
    read = [*options.inputs.rglob("*"), *options.validation.rglob("*")]
    files.check_outputs([*drawn, *pages_of], read)


def _write_pages(work: Workshop, names: list[str], options: argparse.Namespace) -> None:
    print("claims and validation", file=sys.stderr, flush=True)
    contents = collect(work, {name: options.out / f"{name}.png" for name in names})
    if options.report:
        files.write_bytes(options.out / "report.html", report.compose(contents).encode())
        print(f"written: {options.out / 'report.html'}")
    if options.docs:
        files.write_bytes(options.docs / "claims.md", pages.claims_page(contents).encode())
        files.write_bytes(options.docs / "validation.md", pages.validation_page(contents).encode())
        print(f"written: {options.docs / 'claims.md'}, {options.docs / 'validation.md'}")
