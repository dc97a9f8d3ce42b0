"""The main job: the displacement spectra of the paper's Figs 12 and 13 as CSV and as figures.

``python plots/shipped_spectra.py`` reads ``inputs/`` and writes ``plots/`` in the current folder.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import xarray as xr
from rwmf._spectrum import spectrum, start, to_dataset
from rwmf.case import Case
from rwmf.case.grid import count_ordinates
from rwmf.cli.progress import progress_bar
from rwmf.errors import InputError, Interrupted, OutputError, RwmfError
from rwmf.plotting import files as figures
from rwmf.quantities import ENDINGS

__all__ = ["SHIPPED", "compute", "main", "without_wall"]

# namelist without suffix, title of the figure
SHIPPED = {
    "fig12_one_sine": "Fig. 12 (a): one-sine pulse, 0.4 g, 1 s",
    "fig12_one_cosine": "Fig. 12 (b): one-cosine pulse, 0.4 g, 1 s",
    "fig13_elcentro_slender_wall": "Fig. 13 (a): El Centro 1940 N-S, tan α = 0.5/2",
    "fig13_elcentro_squat_wall": "Fig. 13 (b): El Centro 1940 N-S, tan α = 1/2",
}
_FORMATS = ("png", "svg")


def main(arguments: Sequence[str] | None = None) -> int:
    """Compute, write and plot the shipped spectra.

    Parameters
    ----------
    arguments : sequence of str, optional
        Words of the command line; otherwise those of the process.

    Returns
    -------
    int
        Exit status: 0, 1 numerical failure, 2 input, 130 interrupted.
    """
    options = _make_parser().parse_args(arguments)
    try:
        _make_folder(options.plots)
        for name in options.names or SHIPPED:
            _check_name(name)
        for name in options.names or SHIPPED:
            compute(name, options.inputs, options.plots)
    except RwmfError as error:
        print(f"rwmf: {error}", file=sys.stderr)
        return error.exit_status
    except KeyboardInterrupt:
        print("rwmf: interrupted", file=sys.stderr)
        return Interrupted.exit_status
    return 0


def compute(name: str, inputs: Path, plots: Path) -> None:
    """Compute one shipped spectrum, write ``NAME.csv`` and its figures.

    Parameters
    ----------
    name : str
        Key of `SHIPPED`.
    inputs : path
        Folder of the namelists.
    plots : path
        Existing folder for the results.

    Raises
    ------
    InputError, NumericalError, OutputError, Interrupted
        As `rwmf.spectrum` and the writers of files.
    """
    started = time.perf_counter()
    case = Case.from_namelist(inputs / f"{name}.nml")
    total = count_ordinates(case)
    print(f"{SHIPPED[name]}: {total} simulations", flush=True)
    with progress_bar(total) as report, start(case, 0, report) as sweep:
        dataset = to_dataset(sweep)
        sweep.write(str(plots / f"{name}.csv"))
    bare = spectrum(without_wall(case))
    for kind in _FORMATS:
        figures.save_spectrum(dataset, plots / f"{name}.{kind}", bare, SHIPPED[name])
    _report(dataset, plots / name, time.perf_counter() - started)


def without_wall(case: Case) -> Case:
    """Return the same frame without wall: a linear oscillator.

    Parameters
    ----------
    case : Case
        A case with wall and `&spectrum`.

    Returns
    -------
    Case
        The case of the frame alone.

    Raises
    ------
    InputError
        When the case has no frame that could stand alone.
    """
    removed = dict.fromkeys(("wall", "cable", "impact", "initial"))
    return case.replace(frame={"gamma": None}, spectrum={"gamma": None, "b": None}, **removed)


def _report(dataset: xr.Dataset, stem: Path, seconds: float) -> None:
    status = dataset["status"].values
    failed = int((~np.isin(status, ("ok", *ENDINGS))).sum())
    files = ", ".join(f"{stem}.{kind}" for kind in ("csv", *_FORMATS))
    note = f"; {failed} simulations failed, see the status column" if failed else ""
    print(
        f"  {seconds:.1f} s ({dataset.attrs['threads']} threads), written: {files}{note}",
        flush=True,
    )


def _check_name(name: str) -> None:
    if name not in SHIPPED:
        raise InputError(f"{name!r} is not a shipped spectrum; these are {', '.join(SHIPPED)}")


def _make_folder(path: Path) -> None:
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"{path}: the folder cannot be made: {error.strerror}") from error


def _make_parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="python plots/shipped_spectra.py",
        description="Compute and plot the displacement spectra of the paper's Figs 12 and 13.",
        epilog="example: python plots/shipped_spectra.py fig12_one_cosine",
    )
    parser.add_argument(
        "names", nargs="*", metavar="NAME", help=f"any of {', '.join(SHIPPED)}; all when absent"
    )
    parser.add_argument("--inputs", type=Path, default=Path("inputs"), help="folder of the cases")
    parser.add_argument("--plots", type=Path, default=Path("plots"), help="folder of the results")
    return parser


if __name__ == "__main__":
    sys.exit(main())
