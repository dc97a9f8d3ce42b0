"""``python -m reproduce``: the paper's figures, verdicts on its claims, validation."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from rwmf.cli.output import printed_warnings
from rwmf.errors import InputError, OutputError, RwmfError
from rwmf.kernel import files
from rwmf.kernel.progress import progress_bar

from reproduce import figures, pages
from reproduce.responses import Responses

__all__ = ["main", "read_options"]

_ROOT = Path(__file__).resolve().parents[2]
_PAGES = {"claims.md": pages.claims_page, "validation.md": pages.validation_page}


def read_options(arguments: Sequence[str] | None = None) -> argparse.Namespace:
    """Read the command line."""
    parser = argparse.ArgumentParser(prog="python -m reproduce", description=__doc__)
    text = "4 to 13, benefit; all when absent"
    parser.add_argument("figures", nargs="*", metavar="FIGURE", help=text)
    text = "write claims.md and validation.md there"
    parser.add_argument("--docs", type=Path, metavar="DIR", help=text)
    text = "write the spectra of Figs 12 and 13 as CSV as well"
    parser.add_argument("--spectra", action="store_true", help=text)
    for name in ("inputs", "validation"):
        parser.add_argument(f"--{name}", type=Path, metavar="DIR", default=_ROOT / name)
    parser.add_argument("--out", type=Path, metavar="DIR", default=_ROOT / "build" / "plots")
    return parser.parse_args(arguments)


def main(options: argparse.Namespace) -> None:
    """Make the requested products."""
    started = time.perf_counter()
    names = list(dict.fromkeys(figures.find(word) for word in options.figures or figures.FIGURES))
    _check_folders(options, names)
    of = Responses(options.inputs, options.validation)
    with progress_bar(len(names)) as step:
        for done, name in enumerate(names):
            if step is None:
                print(figures.FIGURES[name].caption, flush=True)
            with printed_warnings(name):
                figures.make(of, name, options.out)
            if step is not None:
                step(done + 1, len(names))
    if options.spectra:
        figures.write_spectra(of, options.out)
    for name, compose in _PAGES.items() if options.docs else ():
        files.write_bytes(options.docs / name, compose(of).encode())
        print(f"written: {options.docs / name}", flush=True)
    seconds = time.perf_counter() - started
    print(f"{len(names)} figures in {options.out}, {seconds:.1f} s")


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


if __name__ == "__main__":
    try:
        main(read_options())
    except RwmfError as error:
        print(f"reproduce: {error}", file=sys.stderr)
        sys.exit(error.exit_status)
