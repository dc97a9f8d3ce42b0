"""The main job: the displacement spectra of the paper's Figs 12 and 13 as CSV and as figures.

Each is computed as published (e = 0.9) and in the exact form with the momentum balance at impacts,
and both are drawn over the same axes. ``python plots/shipped_spectra.py`` reads ``inputs/`` and
writes ``build/plots/`` in the current folder.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr
from reproduce.formulations import FORMULATIONS, PUBLISHED
from rwmf._progress import progress_bar
from rwmf._spectrum import spectrum, start, to_dataset
from rwmf.case import Case
from rwmf.errors import InputError, OutputError, RwmfError
from rwmf.plotting import image_files as figures
from rwmf.plotting.response import spectrum as draw_spectrum
from rwmf.plotting.style import NESTED, legend_below, new_figure
from rwmf.quantities import ENDINGS

__all__ = ["HEAD", "SHIPPED", "Pair", "compute", "draw", "main", "without_wall"]

# namelist without suffix, title of the figure
SHIPPED = {
    "fig12_one_sine": "Fig. 12 (a): one-sine pulse, 0.4 g, 1 s",
    "fig12_one_cosine": "Fig. 12 (b): one-cosine pulse, 0.4 g, 1 s",
    "fig13_elcentro_slender_wall": "Fig. 13 (a): El Centro 1940 N-S, slender wall, tan α = 0.5/2",
    "fig13_elcentro_squat_wall": "Fig. 13 (b): El Centro 1940 N-S, squat wall, tan α = 1/2",
}
# file without suffix, and the spectra that it shows above each other
HEAD = ("head", ("fig13_elcentro_slender_wall", "fig13_elcentro_squat_wall"))
_FORMATS = ("png", "svg")
_LEGEND = rf"$\gamma = m_s/m_w$; {NESTED}"


@dataclass(frozen=True)
class Pair:
    """A shipped spectrum in both forms.

    Attributes
    ----------
    title : str
        Origin of the spectrum.
    forms : list of xarray.Dataset
        The spectra, in the order of `FORMULATIONS`.
    alone : xarray.Dataset
        Spectrum of the frame without wall.
    """

    title: str
    forms: list[xr.Dataset]
    alone: xr.Dataset


def main(arguments: Sequence[str] | None = None) -> int:
    """Compute, write and plot the shipped spectra."""
    options = _make_parser().parse_args(arguments)
    names = options.names or list(SHIPPED)
    try:
        _make_folder(options.out)
        for name in names:
            _check_name(name)
        pairs = {name: compute(name, options.inputs, options.out) for name in names}
        figures_of = {name: (name,) for name in names}
        for stem, shown in (figures_of | dict([HEAD])).items():
            if pairs.keys() >= set(shown):
                draw([pairs[name] for name in shown], options.out / stem)
    except RwmfError as error:
        print(f"rwmf: {error}", file=sys.stderr)
        return error.exit_status
    except KeyboardInterrupt:
        print("rwmf: interrupted", file=sys.stderr)
        return 130
    return 0


def compute(name: str, inputs: Path, plots: Path) -> Pair:
    """Compute one shipped spectrum in both forms; write ``NAME.csv`` and ``NAME_exact.csv``."""
    case = Case.from_namelist(inputs / f"{name}.nml")
    print(f"{SHIPPED[name]}: {len(FORMULATIONS)} times {case.kernel.ordinates()} simulations")
    forms = []
    for form in FORMULATIONS:
        started = time.perf_counter()
        path = plots / (f"{name}.csv" if form is PUBLISHED else f"{name}_{form.key}.csv")
        changed = case.replace(**form.changes)
        with progress_bar(changed.kernel.ordinates()) as report, start(changed, 0, report) as sweep:
            forms.append(to_dataset(sweep))
            sweep.write(changed.text, str(path))
        _report(forms[-1], path, time.perf_counter() - started)
    return Pair(SHIPPED[name], forms, spectrum(without_wall(case)))


def draw(pairs: Sequence[Pair], stem: Path) -> None:
    """Draw spectra over the same axes: a row for each, a column for each form."""
    with new_figure(0.8 + 2.7 * len(pairs)) as figure:
        panels = figure.subplots(len(pairs), len(FORMULATIONS), sharey=True, squeeze=False)
        for row, pair in zip(panels, pairs, strict=True):
            for ax, form, dataset in zip(row, FORMULATIONS, pair.forms, strict=True):
                draw_spectrum(dataset, ax, pair.alone, legend=False)
                ax.set_title(form.label)
                ax.label_outer()
            row[0].set_title(f"{pair.title}\n{FORMULATIONS[0].label}")
        highest = max(
            float(x["u_s_max"].max()) for pair in pairs for x in (*pair.forms, pair.alone)
        )
        panels[0, 0].set_ylim(0.0, 1.05 * highest)
        legend_below(figure, panels[0, 0], columns=6, title=_LEGEND)
        for kind in _FORMATS:
            figures.save(figure, stem.with_suffix(f".{kind}"))
    print(f"  written: {', '.join(f'{stem}.{kind}' for kind in _FORMATS)}", flush=True)


def without_wall(case: Case) -> Case:
    """Return the same frame without wall: a linear oscillator."""
    removed = dict.fromkeys(("wall", "cable", "impact", "initial"))
    return case.replace(frame={"gamma": None}, spectrum={"gamma": None, "b": None}, **removed)


def _report(dataset: xr.Dataset, path: Path, seconds: float) -> None:
    status = dataset["status"].values
    failed = int((~np.isin(status, ("ok", *ENDINGS))).sum())
    note = f"; {failed} simulations failed, see the status column" if failed else ""
    threads = dataset.attrs["threads"]
    print(f"  {seconds:.1f} s ({threads} threads), written: {path}{note}", flush=True)


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
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("build/plots"),
        help="folder of the results (default: build/plots)",
    )
    return parser


if __name__ == "__main__":
    sys.exit(main())
