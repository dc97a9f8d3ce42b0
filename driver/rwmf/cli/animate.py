"""Subcommand ``rwmf animate``: film of one case."""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np

from rwmf._files import files
from rwmf._progress import progress
from rwmf._simulation import simulate
from rwmf.case import Case
from rwmf.plotting.animation import animate, in_words


def run(options: argparse.Namespace) -> int:
    """Make the film."""
    case = Case.from_namelist(options.case)
    path = Path(options.out or f"{Path(options.case).stem}.gif")
    files.check_outputs([path], case.inputs)
    wanted: dict[str, object] = {"conditioning": False, "dt": options.speed / options.fps}
    if case.storeys is not None:
        # the reactions include the drifts
        wanted["reactions"] = True
    response = simulate(case.replace(output=wanted))
    # the film ends with overturning or collapse
    shown = np.isfinite(response["theta" if case.wall is not None else "u_s"].values)
    if options.until is not None:
        shown &= response["time"].values <= options.until
    response = response.isel(time=shown)
    frames = response.sizes["time"]
    print(f"{path}: {frames} frames to draw", flush=True)
    with progress("frame") as report:
        scale = animate(case, response, path, options.fps, report)
    print(f"written: {path}, {response.sizes['time']} frames, {in_words(case, scale)}")
    return 0
