"""Random walls on a base that gives, beside a second program: errors of the requested peaks.

    .venv/bin/python bench/base_survey.py [--count 600] [--first 0] [--processes 2]

The scenes are those of tests/support/base_scenes.py. The second program integrates the equations of
Newton and Euler by SciPy (tests/support/compliant_wall.py). Prints a table in Markdown by class of
scene. The error of a scene is that of its worst peak, over this peak. Scenes whose error exceeds
the tolerance follow, with their largest sensitivity to the size of the motion.
"""

import argparse
import tempfile
import warnings
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
import rwmf
from common import table

from base_scenes import BASES, BaseScene, base_scene  # isort: skip

TOLERANCES = (1e-6, 1e-9, 1e-12)


class Found(NamedTuple):
    """Errors of a scene at each tolerance; none if the wall overturns."""

    number: int
    classes: tuple[str, ...]
    errors: tuple[float, ...]
    peak: str
    sensitivity: float


def survey(number: int, folder: Path) -> Found:
    """Compare the peaks of a scene."""
    warnings.simplefilter("ignore")
    scene = base_scene(number, folder)
    classes = [scene.base, "released" if scene.motion == "free" else "under a motion"]
    classes.append("with a frame" if "frame" in scene.groups else "block")
    if scene.wall.devices:
        classes.append("with devices")
    try:
        runs = [scene.peaks(rtol, folder) for rtol in TOLERANCES]
        truth = scene.second_peaks() if all(runs) else {}
    except (rwmf.RwmfError, RuntimeError) as problem:
        return Found(number, tuple(classes), (), f"fails: {problem}", 0.0)
    if not truth:
        return Found(number, tuple(classes), (), "overturns", 0.0)
    errors = [
        {name: abs(run[name] / truth[name] - 1) for name in run if truth[name] > 0} for run in runs
    ]
    peak = max(errors[0], key=errors[0].__getitem__)
    return Found(
        number,
        tuple(classes),
        tuple(max(found.values()) for found in errors),
        peak,
        sensitivity(scene, peak, folder) if max(errors[0].values()) > TOLERANCES[0] else 0.0,
    )


def sensitivity(scene: BaseScene, peak: str, folder: Path) -> float:
    """Relative change of a peak over that of the ground motion."""
    case = rwmf.Case.from_text(
        f"{scene.text()}\n&solver rtol=1e-10, t_end=2.0 /\n", folder / "scene.nml"
    )
    run = rwmf.simulate(case.replace(output={"reactions": True, "conditioning": True}))
    return float(run.get(f"sensitivity_{peak}", np.nan))


def rows_of(found: Sequence[Found]) -> list[list[str]]:
    """Lines of the table."""
    names = [*BASES, "block", "with a frame", "with devices", "under a motion", "released"]
    rows = []
    for name in [*names, "all"]:
        errors = np.array([f.errors for f in found if f.errors and name in (*f.classes, "all")])
        if not errors.size:
            continue
        cells = [name, str(len(errors))]
        for i, rtol in enumerate(TOLERANCES):
            cells += [f"{np.median(errors[:, i]):.0e}", f"{np.max(errors[:, i]):.0e}"]
            if rtol >= 1e-9:
                cells.append(f"{np.count_nonzero(errors[:, i] <= rtol)}")
        rows.append(cells)
    return rows


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=600)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--processes", type=int, default=2)
    options = parser.parse_args()
    numbers = range(options.first, options.first + options.count)
    with (
        tempfile.TemporaryDirectory() as name,
        ProcessPoolExecutor(options.processes) as pool,
    ):
        found = list(pool.map(partial(survey, folder=Path(name)), numbers, chunksize=4))
    heads = ["scenes", "number"]
    for rtol in TOLERANCES:
        heads += [f"rtol {rtol:.0e}: median", "worst", *["within rtol"] * (rtol >= 1e-9)]
    print(table(heads, rows_of(found)))
    print(f"\n{sum(f.peak == 'overturns' for f in found)} further scenes overturn.")
    for f in found:
        beyond = [e for e, rtol in zip(f.errors, TOLERANCES[:2], strict=False) if e > rtol]
        if f.peak.startswith("fails"):
            print(f"scene {f.number} {f.peak}")
        if beyond:
            errors = ", ".join(f"{e:.1e}" for e in f.errors)
            print(f"scene {f.number}, {f.peak}: {errors}; sensitivity {f.sensitivity:.0f}")


if __name__ == "__main__":
    main()
