"""Survey of `rwmf.gradient` over random scenes of all effects: its errors beside the truth.

    .venv/bin/python bench/gradients.py [--count 300] [--first 0] [--quad 30] [--kinks 30]
                                        [--processes 2]

The scenes are numbered ones of tests/support: wall and frame, all effects, walls that bend, and
buildings. Each has two parameters at random and up to ten quantities. The truth comes from
Richardson steps at a tolerance of 1e-13, over a ladder of steps that `rwmf.gradient` does not use.
It is known where two rungs agree within 1e-8 of the scene's largest p dq/dp. `--quad` derivatives
of walls and frames are also compared with differences in quadruple precision. `--kinks` periods of
walls and frames are searched at which two peaks are equal: there, and only there, the derivative is
a kink. Prints tables in Markdown, and each derivative whose error does not cover the truth.
"""

from __future__ import annotations

import argparse
import math
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
import numpy.typing as npt
import rwmf
from rwmf import records
from rwmf._gradient.held_keys import allowed_changes, find_parameters, scale_of
from rwmf._gradient.lanes import Lanes, Request, Scenes
from rwmf._library.measure import solve_reference

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "support"))

from bending_scenes import bending_scene
from building_scenes import building_scene, case_of
from combinations import combination, further_combination
from random_cases import random_cases

ROOT = Path(__file__).resolve().parents[1]
Array = npt.NDArray[np.float64]
QUANTITIES = (
    "u_s_max", "theta_max_over_alpha", "theta_dot_max", "cable_force_increment_max_over_m_w_g",
    "base_shear_max_over_weight", "friction_demand_max", "storey_drift_max", "roof_drift_max",
    "floor_acceleration_max_g", "energy_impact_J_per_kg",
)  # fmt: skip
N_PARAMETERS = 2
# rungs of the ladder: relative steps
RUNGS = 1.2e-3 / 2.0 ** np.arange(11)
TRUSTED, KNOWN = 1e-13, 1e-8
# jump of slopes over the largest p dq/dp, and its relative change over three rungs, of a kink
JUMP, STEADY = 1e-3, 0.1
# largest error of a smooth derivative over the largest p dq/dp; least value over that which counts
SMOOTH, NOTHING = 1e-6, 1e-12
HEADS = (
    "| scenes | derivatives | truth known | within `error` | largest distance | median "
    f"| above {SMOOTH:g} | kinks flagged | truth unknown: flagged, or error above {SMOOTH:g} |"
)
QUAD_STEP, QUAD_TOLERANCE = 1e-7, 1e-24
# relative width of a kink's place, and relative distance of its neighbours
KINK_WITHIN, BESIDE = 1e-13, 1e-5
PRICED = {
    "fig12_one_cosine": ("T_s", "gamma", "xi_s", "eta_0", "eta_alpha", "h", "b", "a_max_g"),
    "accuracy_elcentro_1s": ("T_s", "gamma", "xi_s", "eta_0", "eta_alpha", "h", "b", "scale"),
    "six_storeys_by_dimensions": ("xi_s", "initial_stress", "strand_area", "thickness"),
}
_SETTINGS = ("solver", "output", "spectrum", "model", "sensitivity", "design", "limits")


@dataclass(frozen=True)
class Derivative:
    """A derivative beside its truth, all over the largest p dq/dp of the scene.

    Attributes
    ----------
    label : str
        Scene, quantity, parameter.
    kind : str
        Source of the scene.
    wrong : float
        Distance from the truth; NaN where it is unknown.
    unsure : float
        Disagreement of the two rungs of the truth.
    error : float
        The stated error.
    is_kink : bool
        The stated kink.
    is_corner : bool
        True where slopes differ by the same jump over the smallest rungs.
    """

    label: str
    kind: str
    wrong: float
    unsure: float
    error: float
    is_kink: bool
    is_corner: bool

    @property
    def is_known(self) -> bool:
        """True where the truth is known and the function smooth."""
        return not self.is_corner and self.unsure <= KNOWN

    @property
    def is_covered(self) -> bool:
        """True where the stated error is not below the distance from the truth."""
        return self.wrong <= self.error + self.unsure


@dataclass(frozen=True)
class Survey:
    """Derivatives of one scene.

    Attributes
    ----------
    derivatives : list of Derivative
        The derivatives.
    runs : float
        Runs for each parameter.
    note : str
        Reason why the scene has none.
    """

    derivatives: list[Derivative]
    runs: float = math.nan
    note: str = ""


def scene(number: int, folder: Path) -> tuple[str, rwmf.Case]:
    """Make the case of a number; five sources take turns."""
    kind, i = number % 5, number // 5
    if kind == 0:
        return "wall and frame", next(random_cases(1, 400 + i, folder))
    if kind == 1:
        return "effects", combination(i).build(folder)
    if kind == 2:
        return "loss of strength, slip, gravity", further_combination(i).build(folder)
    if kind == 3:
        groups, record = bending_scene(i)
        if record is not None:
            motion = rwmf.Motion(record["values"], times=record["times"], unit="m/s2", name="noise")
            return "bending walls", rwmf.Case(**groups, motion=motion)
        return "bending walls", rwmf.Case(**groups)
    return "buildings", case_of(building_scene(i), folder, 3.0)


def survey(number: int) -> Survey:
    """Compare derivatives of a scene with their truth."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for record in ("elcentro", "pacoima"):
            records.export(record, folder / f"{record}.csv")
        kind, case = scene(number, folder)
        try:
            return _compare(number, kind, case)
        except rwmf.NumericalError as error:
            return Survey([], note=f"{number}: {str(error).splitlines()[0]}")


def _compare(number: int, kind: str, case: rwmf.Case) -> Survey:
    dice = np.random.default_rng([40, number])
    parameters = _parameters(case, dice)
    found = rwmf.sweep(case, points={"rtol": [1e-9]}, quantities=QUANTITIES, threads=1)
    names = [name for name in QUANTITIES if np.isfinite(found[name].values).all()]
    if not names:
        return Survey([], note=f"{number}: no quantity")
    gradient = rwmf.gradient(case, parameters, names, threads=1)
    ladders = [_ladder(case, parameter, names) for parameter in parameters]
    slopes = abs(gradient["derivative"] * gradient["parameter_scale"]).fillna(0.0)
    largest = np.maximum(slopes.max("parameter"), abs(gradient["value"]))
    found_here = []
    for parameter, ladder in zip(parameters, ladders, strict=True):
        for i, quantity in enumerate(names):
            most = largest.sel(quantity=quantity).item()
            if not most > NOTHING:
                continue
            cell = gradient.sel(quantity=quantity, parameter=parameter)
            scale = cell["parameter_scale"].item() / most
            truth, unsure, is_corner = ladder(i, most)
            found_here.append(
                Derivative(
                    f"{number} {quantity} {parameter}",
                    kind,
                    abs(cell["derivative"].item() * scale - truth / most),
                    unsure / most,
                    cell["error"].item() * scale,
                    bool(cell["is_kink"]),
                    is_corner,
                )
            )
    return Survey(found_here, gradient.attrs["runs"] / len(parameters))


def _parameters(case: rwmf.Case, dice: np.random.Generator) -> list[str]:
    """Draw parameters among the given keys that may be one."""
    known = [
        f"{group}.{key}"
        for group, keys in case.groups.items()
        if group not in _SETTINGS
        for key in sorted(keys.given)
    ]
    chosen: list[str] = []
    for name in dice.permutation(known).tolist():
        try:
            (item,) = find_parameters(case, [name])
            lanes = Lanes(Scenes(case, None, None, (), None, None), [item], QUANTITIES[:1], 1)
            value = float(lanes.values[0, 0])
            allowed_changes(case, item, value, scale_of(item, value))
        except rwmf.InputError:
            continue
        chosen.append(name)
        if len(chosen) == N_PARAMETERS:
            break
    return chosen


def _ladder(
    case: rwmf.Case, parameter: str, names: Sequence[str]
) -> Callable[[int, float], tuple[float, float, bool]]:
    """Run a ladder of steps; return the function that gives truth, disagreement and corner."""
    scenes = Scenes(case.replace(solver={"method": "dop853"}), None, None, (), None, None)
    (item,) = find_parameters(scenes.case, [parameter])
    lanes = Lanes(scenes, [item], names, 1)
    value = float(lanes.values[0, 0])
    scale = scale_of(item, value)
    allowed = allowed_changes(scenes.case, item, value, scale)
    signs = [sign for sign, is_up in ((1.0, True), (-1.0, False)) if allowed[is_up] > 0]
    steps = np.array([0.0, *(sign * rung for rung in RUNGS for sign in signs)])
    runs, _ = lanes.run([Request(0, 0, float(value + step * scale), TRUSTED) for step in steps])
    changes = (runs[1:] - runs[0]).reshape(len(RUNGS), len(signs), -1)
    slopes = changes / (RUNGS[:, None, None] * np.array(signs)[:, None])
    return partial(_truth, slopes, len(signs) == 2)


def _truth(
    slopes: Array, is_central: bool, quantity: int, largest: float
) -> tuple[float, float, bool]:
    """Extrapolate slopes, shape (rungs, sides, quantities), to a step of zero."""
    ours = slopes[:, :, quantity]
    mean = ours.mean(axis=1)
    powers = (2, 4) if is_central else (1, 2, 3)
    for power in powers:
        mean = (2.0**power * mean[1:] - mean[:-1]) / (2.0**power - 1)
    apart = abs(np.diff(mean))
    if not np.isfinite(apart).any():
        return math.nan, math.inf, False
    best = int(np.nanargmin(apart))
    is_corner = False
    if is_central:
        jumps = (ours[:, 0] - ours[:, 1])[-3:]
        is_corner = bool(
            (abs(jumps) > JUMP * largest).all() and np.ptp(jumps) < STEADY * abs(jumps).max()
        )
    return float(mean[best]), float(apart[best]), is_corner


def quad_difference(number: int, parameter: str) -> list[tuple[str, float, float]]:
    """Compare derivatives of a wall and frame with differences in quadruple precision."""
    keys = {"u_s_max": "u_s_max_m", "theta_dot_max": "theta_dot_max_rad_s"}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for record in ("elcentro", "pacoima"):
            records.export(record, folder / f"{record}.csv")
        _, case = scene(number, folder)
        found = rwmf.gradient(case, parameter, tuple(keys), threads=1)
        group, key = parameter.split(".")
        value = found["parameter_value"].item()
        held = case.replace(cable={"eta_alpha": case.cable.eta_alpha})
        sides = []
        for sign in (1, -1):
            there = held.replace(**{group: {key: value * (1 + sign * QUAD_STEP)}})
            run = solve_reference(there, QUAD_TOLERANCE, QUAD_TOLERANCE / 10)
            sides.append((there.groups[group][key], run.values))
    results = []
    for quantity, by in keys.items():
        cell = found.sel(quantity=quantity).squeeze()
        (high, up), (low, down) = sides
        truth = (up[by] - down[by]) / (high - low)
        most = max(abs(truth * value), abs(cell["value"].item()))
        if most > NOTHING and not cell["is_kink"].item():
            wrong = abs(cell["derivative"].item() - truth) * value / most
            label = f"{number} {quantity} {parameter}"
            results.append((label, wrong, cell["error"].item() * value / most))
    return results


def _quad_table(count: int, first: int, pool: ProcessPoolExecutor) -> None:
    """Print the comparison with quadruple precision."""
    dice = np.random.default_rng(41)
    keys = ("wall.h", "wall.b", "frame.T_s", "frame.gamma", "frame.xi_s", "cable.eta_0", "impact.e")
    numbers = [5 * (first // 5 + i) for i in range((count + 1) // 2)]
    chosen = [str(dice.choice(keys)) for _ in numbers]
    rows = [row for rows in pool.map(quad_difference, numbers, chosen) for row in rows]
    wrong = np.array([row[1] for row in rows])
    covered = np.array([row[1] <= row[2] for row in rows])
    print(f"\nQuadruple precision: {len(rows)} derivatives, {covered.sum()} within the error,")
    print(f"largest distance {wrong.max():.1e}, median {np.median(wrong):.1e}.")
    for (label, far, error), is_covered in zip(rows, covered, strict=True):
        if not is_covered:
            print(f"not covered: {label}: {far:.1e} from the truth, error {error:.1e}")


def kink(number: int) -> tuple[str, bool, bool] | None:
    """Find a period at which the largest peak changes, and differentiate there and beside it."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for record in ("elcentro", "pacoima"):
            records.export(record, folder / f"{record}.csv")
        _, case = scene(number, folder)
        period = _equal_peaks(case)
        if period is None:
            return None
        nearby = {"T_s": [period, period * (1 - BESIDE), period * (1 + BESIDE)]}
        found = rwmf.gradient(case, "T_s", "u_s_max", points=nearby, threads=1)
    flags = found["is_kink"].values.ravel()
    return f"{number} T_s = {period:.9g}", bool(flags[0]), bool(flags[1:].any())


def _equal_peaks(case: rwmf.Case) -> float | None:
    """Return the first period around that of the case where two separate peaks are equal [s]."""
    low, high = case.frame.T_s * 0.8, case.frame.T_s * 1.2
    while high - low > KINK_WITHIN * high:
        periods = np.linspace(low, high, 33)
        table = {"T_s": periods, "rtol": np.full(periods.size, 1e-12)}
        found = rwmf.sweep(case, points=table, quantities=("u_s_max", "t_u_s_max"), threads=1)
        times, peaks = (found[name].values.ravel() for name in ("t_u_s_max", "u_s_max"))
        # a peak moves less than a quarter of a period within a part of the interval
        jumps = np.flatnonzero(abs(np.diff(times)) > periods[:-1] / 4)
        if jumps.size == 0 or not np.isfinite(times).all():
            return None
        # an impact that moves makes the peak itself jump
        if abs(np.diff(peaks))[jumps[0]] > 0.2 * peaks.max():
            return None
        low, high = periods[jumps[0]], periods[jumps[0] + 1]
    return float(low)


def _row(name: str, items: Sequence[Derivative]) -> str:
    known = [item for item in items if item.is_known]
    smooth = [item for item in known if not item.is_kink]
    wrong = np.array([item.wrong for item in smooth] or [math.nan])
    corners = [item for item in items if item.is_corner]
    open_ = [item for item in items if not item.is_corner and not item.is_known]
    flagged = sum(item.is_kink or not item.error < SMOOTH for item in open_)
    cells = (
        name,
        len(items),
        len(known),
        f"{100 * sum(item.is_covered for item in known) / max(len(known), 1):.2f} %",
        f"{np.max(wrong):.1e}",
        f"{np.median(wrong):.1e}",
        sum(item.wrong > SMOOTH for item in smooth),
        f"{sum(item.is_kink for item in corners)} of {len(corners)}",
        f"{flagged} of {len(open_)}",
    )
    return "| " + " | ".join(map(str, cells)) + " |"


def _print_survey(numbers: range, surveys: list[Survey], items: list[Derivative]) -> None:
    print(f"rwmf {rwmf.__version__}, scenes {numbers.start} to {numbers.stop - 1}\n")
    print(HEADS)
    print("|---|---|---|---|---|---|---|---|---|")
    for kind in dict.fromkeys(item.kind for item in items):
        print(_row(kind, [item for item in items if item.kind == kind]))
    print(_row("all", items))
    runs = np.median([found.runs for found in surveys if found.derivatives])
    print(f"\nRuns for each parameter: {runs:.0f} (median).")


def _print_kinks(count: int, pool: ProcessPoolExecutor) -> None:
    found = [item for item in pool.map(kink, range(0, 5 * count, 5)) if item is not None]
    print(f"\nKinks: {sum(item[1] for item in found)} of {len(found)} flagged, "
          f"{sum(item[2] for item in found)} of their neighbours.")  # fmt: skip
    for label, is_flagged, is_beside in found:
        if not is_flagged or is_beside:
            print(f"kink: {label}: flagged {is_flagged}, beside it {is_beside}")


def _print_price() -> None:
    """Print the processor time of a gradient for each parameter over that of a run."""
    print("\n| case | parameters | runs | price of a parameter |\n|---|---|---|---|")
    for name, parameters in PRICED.items():
        case = rwmf.Case.from_namelist(ROOT / "inputs" / f"{name}.nml")
        case = case.without("spectrum") if "spectrum" in case.groups else case
        one = case.replace(solver={"rtol": 1e-9, "atol": None}, output={"conditioning": False})
        differentiate = partial(rwmf.gradient, case, parameters, "u_s_max", threads=1)
        runs = differentiate().attrs["runs"]
        price = _fastest(differentiate) / _fastest(partial(rwmf.simulate, one)) / len(parameters)
        print(f"| `{name}` | {len(parameters)} | {runs} | {price:.1f} runs |")


def _fastest(call: Callable[[], object]) -> float:
    times = []
    for _ in range(5):
        start = time.process_time()
        call()
        times.append(time.process_time() - start)
    return min(times)


def _list_findings(items: Sequence[Derivative]) -> None:
    """Print derivatives that need a look."""
    for item in items:
        if item.is_known and not item.is_covered:
            print(f"not covered: {item.label}: {item.wrong:.1e} from the truth, error "
                  f"{item.error:.1e}, unsure {item.unsure:.0e}")  # fmt: skip
        if item.is_corner and not item.is_kink:
            print(f"corner without a flag: {item.label}: error {item.error:.1e}")
        if not item.is_corner and not item.is_known and not item.is_kink and item.error < SMOOTH:
            print(f"unknown truth: {item.label}: unsure {item.unsure:.0e}, error {item.error:.1e}")
        if item.is_known and not item.is_kink and item.wrong > SMOOTH:
            print(f"far: {item.label}: {item.wrong:.1e}, error {item.error:.1e}")
        if item.is_known and item.is_kink:
            print(f"flagged, but smooth: {item.label}: error {item.error:.1e}")


def main() -> int:
    """Print the survey; the exit status is 1 when less than 99 % are covered."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=300, help="number of scenes")
    parser.add_argument("--first", type=int, default=0, help="number of the first one")
    parser.add_argument("--quad", type=int, default=30, help="derivatives in quadruple precision")
    parser.add_argument("--kinks", type=int, default=30, help="scenes searched for kinks")
    parser.add_argument("--processes", type=int, default=2)
    arguments = parser.parse_args()
    numbers = range(arguments.first, arguments.first + arguments.count)
    with ProcessPoolExecutor(arguments.processes) as pool:
        surveys = []
        for found in pool.map(survey, numbers):
            surveys.append(found)
            print(f"\r{len(surveys)} scenes", end="", file=sys.stderr, flush=True)
        print(file=sys.stderr)
        items = [item for found in surveys for item in found.derivatives]
        if items:
            _print_survey(numbers, surveys, items)
        if arguments.quad:
            _quad_table(arguments.quad, arguments.first, pool)
        if arguments.kinks:
            _print_kinks(arguments.kinks, pool)
    _print_price()
    _list_findings(items)
    for note in (found.note for found in surveys if found.note):
        print(note)
    known = [item for item in items if item.is_known]
    return 0 if sum(item.is_covered for item in known) >= 0.99 * len(known) else 1


if __name__ == "__main__":
    sys.exit(main())
