"""Survey of `rwmf.gradient` over random scenes of all effects: its errors beside the truth.

    .venv/bin/python bench/gradients.py [--count 300] [--first 0] [--processes 2]

The scenes are numbered ones of tests/support: wall and frame, all effects, walls that bend, and
buildings. Each has two parameters at random and up to ten quantities. The truth comes from
Richardson steps at a tolerance of 1e-13, over a ladder of steps that `rwmf.gradient` does not use.
It is known where two rungs agree within 1e-8 of the scene's largest p dq/dp. Prints a table in
Markdown, and each derivative whose error does not cover the truth.
"""

import argparse
import math
import sys
import tempfile
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
import rwmf
from common import ROOT, spent, table
from rwmf import records
from rwmf.assess.lanes import Lanes, Request, Scenes, allowed_changes, find_parameters, scale_of

from bending_scenes import bending_scene  # isort: skip
from building_scenes import building_scene, case_of  # isort: skip
from combinations import combination, further_combination  # isort: skip
from random_cases import random_cases  # isort: skip

QUANTITIES = (
    "u_s_max", "theta_max_over_alpha", "theta_dot_max", "cable_force_increment_max_over_m_w_g",
    "base_shear_max_over_weight", "friction_demand_max", "storey_drift_max", "roof_drift_max",
    "floor_acceleration_max_g", "energy_impact_J_per_kg",
)  # fmt: skip
# rungs of the ladder: relative steps
RUNGS = 1.2e-3 / 2.0 ** np.arange(11)
TRUSTED, KNOWN = 1e-13, 1e-8
# largest error of a smooth derivative over the largest p dq/dp; least value over that which counts
SMOOTH, NOTHING = 1e-6, 1e-12
PRICED = {
    "fig12_one_cosine": ("T_s", "gamma", "xi_s", "eta_0", "eta_alpha", "h", "b", "a_max_g"),
    "six_storeys_by_dimensions": ("xi_s", "initial_stress", "strand_area", "thickness"),
}
_SETTINGS = ("solver", "output", "spectrum", "model", "sensitivity", "design", "limits")


class Derivative(NamedTuple):
    """A derivative beside its truth, all over the largest p dq/dp of the scene."""

    label: str  # scene, quantity, parameter
    kind: str  # source of the scene
    wrong: float  # distance from the truth
    unsure: float  # disagreement of the two rungs of the truth
    error: float  # as stated
    is_kink: bool  # as stated

    @property
    def is_covered(self) -> bool:
        """True where the stated error is not below the distance from the truth."""
        return self.wrong <= self.error + self.unsure


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
            groups |= {"motion": motion}
        return "bending walls", rwmf.Case(**groups)
    return "buildings", case_of(building_scene(i), folder, 3.0)


def survey(number: int) -> list[Derivative]:
    """Compare derivatives of a scene with their truth; none of a scene that fails."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for record in ("elcentro", "pacoima"):
            records.export(record, folder / f"{record}.csv")
        kind, case = scene(number, folder)
        try:
            return _compare(number, kind, case)
        except rwmf.NumericalError:
            return []


def _compare(number: int, kind: str, case: rwmf.Case) -> list[Derivative]:
    parameters = _parameters(case, np.random.default_rng([40, number]))
    found = rwmf.sweep(case, points={"rtol": [1e-9]}, quantities=QUANTITIES, threads=1)
    names = [name for name in QUANTITIES if np.isfinite(found[name].values).all()]
    if not names:
        return []
    gradient = rwmf.gradient(case, parameters, names, threads=1)
    slopes = abs(gradient["derivative"] * gradient["parameter_scale"]).fillna(0.0)
    largest = np.maximum(slopes.max("parameter"), abs(gradient["value"])).values.ravel()
    rows = []
    for parameter in parameters:
        truth, unsure = _truth(case, parameter, names)
        for i in np.flatnonzero(largest > NOTHING):
            cell = gradient.sel(quantity=names[i], parameter=parameter)
            scale = cell["parameter_scale"].item() / largest[i]
            rows.append(
                Derivative(
                    f"{number} {names[i]} {parameter}",
                    kind,
                    abs(cell["derivative"].item() * scale - truth[i] / largest[i]),
                    unsure[i] / largest[i],
                    cell["error"].item() * scale,
                    bool(cell["is_kink"]),
                )
            )
    return rows


def _parameters(case: rwmf.Case, dice: np.random.Generator) -> list[str]:
    """Draw two parameters among the given keys that may be one."""
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
    return chosen[:2]


def _truth(case: rwmf.Case, parameter: str, names: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
    """Return p dq/dp of each quantity from a ladder of steps, and its disagreement."""
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
    slopes = (changes / (RUNGS[:, None, None] * np.array(signs)[:, None])).mean(axis=1)
    for power in (2, 4) if len(signs) == 2 else (1, 2, 3):
        slopes = (2.0**power * slopes[1:] - slopes[:-1]) / (2.0**power - 1)
    apart = np.nan_to_num(abs(np.diff(slopes, axis=0)), nan=math.inf)
    best = apart.argmin(axis=0), np.arange(len(names))
    return slopes[best], apart[best]


def _row(name: str, items: Sequence[Derivative]) -> list[object]:
    known = [item for item in items if item.unsure <= KNOWN]
    wrong = np.array([item.wrong for item in known if not item.is_kink] or [math.nan])
    covered = sum(item.is_covered for item in known) / max(1, len(known))
    return [
        name,
        len(items),
        len(known),
        f"{100 * covered:.2f} %",
        f"{wrong.max():.1e}",
        f"{np.median(wrong):.1e}",
        int((wrong > SMOOTH).sum()),
        sum(item.is_kink for item in items),
    ]


def _prices() -> list[list[object]]:
    """Price of a parameter in runs of the case."""
    rows: list[list[object]] = []
    for name, parameters in PRICED.items():
        case = rwmf.Case.from_namelist(ROOT / "inputs" / f"{name}.nml")
        case = case.without("spectrum") if "spectrum" in case.groups else case
        one = case.replace(solver={"rtol": 1e-9, "atol": None}, output={"conditioning": False})
        differentiate = partial(rwmf.gradient, case, parameters, "u_s_max", threads=1)
        runs = differentiate().attrs["runs"]
        times = [min(spent(call) for _ in range(5))
                 for call in (differentiate, partial(rwmf.simulate, one))]  # fmt: skip
        price = times[0] / times[1] / len(parameters)
        rows.append([f"`{name}`", len(parameters), runs, f"{price:.1f} runs"])
    return rows


def main() -> int:
    """Print the survey; the exit status is 1 when less than 99 % are covered."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=300, help="number of scenes")
    parser.add_argument("--first", type=int, default=0, help="number of the first one")
    parser.add_argument("--processes", type=int, default=2)
    options = parser.parse_args()
    numbers = range(options.first, options.first + options.count)
    with ProcessPoolExecutor(options.processes) as pool:
        items = [item for found in pool.map(survey, numbers) for item in found]
    kinds = list(dict.fromkeys(item.kind for item in items))
    heads = ("scenes", "derivatives", "truth known", "within `error`", "largest distance",
             "median", f"above {SMOOTH:g}", "flagged as kinks")  # fmt: skip
    rows = [_row(kind, [item for item in items if item.kind == kind]) for kind in kinds]
    print(table(heads, [*rows, _row("all", items)]), end="\n\n")
    print(table(("case", "parameters", "runs", "processor time of a parameter"), _prices()))
    known = [item for item in items if item.unsure <= KNOWN]
    for item in known:
        if not item.is_covered:
            print(f"not covered: {item.label}: {item.wrong:.1e} from the truth, "
                  f"error {item.error:.1e}, unsure {item.unsure:.0e}")  # fmt: skip
    return 0 if sum(item.is_covered for item in known) >= 0.99 * len(known) else 1


if __name__ == "__main__":
    sys.exit(main())
