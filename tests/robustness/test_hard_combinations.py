"""All effects at once, in combinations that a number chooses.

A second family has the laws that slip, come back and lose strength, gravity on the frame and shear
keys, and every check looks at all demands there.

RWMF_COMBINATIONS is the number of rounds of each check, RWMF_COMBINATIONS_FIRST the first one; the
default keeps the suite short. 4,000 is the full run.
"""

import math
import os
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import rwmf
from combinations import (
    Changes,
    Combination,
    combination,
    further_combination,
    spectrum_combination,
)
from rwmf.run.quantities import find

NUMBERS = int(os.environ.get("RWMF_COMBINATIONS", "20"))
FIRST = int(os.environ.get("RWMF_COMBINATIONS_FIRST", "0"))
_CHUNK = 20
_STARTS = range(FIRST, FIRST + NUMBERS, _CHUNK)

RTOL = 1e-10
TRUSTED = {"method": "dop853", "rtol": 1e-13}
BALANCE = 1e-6
FLOOR = 1e-6  # of the peak: required accuracy at RTOL without amplification
# the drive of the resting wall changes its sign; the rest is the tolerance of the run
MIRROR = 1e-7
FAST_RTOL, FAST_FLOOR, FAST_FACTOR = 1e-9, 1e-7, 100.0
NOTHING = 1e-12  # m or rad
CHANGE = 1e-9  # of the motion, to measure amplification
UNDECIDED = 0.01  # above this error a comparison is inconclusive
DECIDED = 0.6  # least part of the scenes that a check can decide on
ENDLESS = 0.99  # velocity factor of an impact
PATIENCE = 100_000  # steps of dop853 after which such flights have no end: others take 7,000
LIMIT = 1e-9  # difference between the steps of two runs at rtol 1e-13
PROMISE = 1e-5  # asked by `&solver accuracy`
ROUND_OFF = 1e-11  # difference between a located maximum and a row beside it
PRESSED = 0.05  # least N/(m_w g) for a meaningful H/N

Check = Callable[[Combination, Path], str | None]


class UndecidedError(Exception):
    """The scene amplifies errors beyond the reach of any method."""


def _go_through(check: Check, make: Callable[[int], Combination], start: int, folder: Path) -> None:
    """Apply a check to a chunk of numbers; it returns a finding or None."""
    numbers = range(start, min(start + _CHUNK, FIRST + NUMBERS))
    findings, undecided = [], 0
    for number in numbers:
        made = make(number)
        try:
            finding = check(made, folder)
        except UndecidedError:
            undecided += 1
            continue
        except rwmf.NumericalError as error:
            # hardly a loss at impact: ever smaller flights have no end, or a late one
            assert "max_steps" in str(error), (number, str(error))
            assert _velocity_factor(made, folder) > ENDLESS, (number, str(error))
            undecided += 1
            continue
        if finding is not None:
            findings.append(f"{number}: {finding}")
    assert not findings, "\n".join(findings)
    assert undecided <= (1 - DECIDED) * len(numbers) + 1, (numbers, undecided)


def _velocity_factor(made: Combination, folder: Path) -> float:
    """Return e; a table here loses enough."""
    given = made.groups["impact"].get("e")
    if given is not None:
        return float(given)
    return float(rwmf.simulate(made.build(folder, solver={"t_end": 1e-3})).get("e", 0.0))


def _run(
    made: Combination, folder: Path, method: str = "dop853", **changes: Changes
) -> rwmf.Response:
    solver: Changes = {"method": method, "rtol": RTOL}
    if method == "dop853" and (made.groups.get("impact", {}).get("e") or 0.0) > ENDLESS:
        solver["max_steps"] = PATIENCE
    changes["solver"] = solver | changes.get("solver", {})
    return rwmf.simulate(made.build(folder, **changes))


def _peak(run: rwmf.Response) -> float:
    return float(run["u_s_max" if "u_s_max" in run else "theta_max_over_alpha"])


_DEMANDS = re.compile(
    r"(storey_\d+_|floor_\d+_|roof_|base_shear|overturning_moment|pivot_normal|friction_demand"
    r"|shear_key_force|wall_shear|wall_moment|link_\d+_|tendon_|fuse_stroke)(?!.*height).*_(max|min|sum)"
)


def _numbers(run: rwmf.Response) -> dict[str, float]:
    """Return the peak, and the demands if the scene has them."""
    names = [find(key).name for key in run.flat()]
    found = {name: float(run[name]) for name in names if _DEMANDS.match(name)}
    if found.get("pivot_normal_min_over_m_w_g", 1.0) < PRESSED:
        found.pop("friction_demand_max", None)
    return {"peak": _peak(run)} | found


def _apart(*runs: rwmf.Response) -> tuple[float, str]:
    """Largest difference of a number over the largest one of its kind [-], and its name."""
    numbers = [_numbers(run) for run in runs]
    if len({frozenset(found) for found in numbers}) > 1:
        return math.inf, "names"
    scales: dict[str, float] = {}
    for name, value in numbers[0].items():
        kind = re.sub(r"\d+", "i", name)
        scales[kind] = max(scales.get(kind, 0.0), abs(value))
    worst = (0.0, "")
    for name in numbers[0]:
        values = [found[name] for found in numbers]
        spread = max(values) - min(values)
        if spread > NOTHING:
            worst = max(worst, (spread / scales[re.sub(r"\d+", "i", name)], name))
    return worst


def _shaken(made: Combination, factor: float) -> dict[str, Changes]:
    """Return the keys that multiply the whole motion by a factor."""
    if not made.horizontal:
        return {"motion": {"a_max_g": factor * made.groups["motion"]["a_max_g"]}}
    changes = {"motion": {"scale": factor}}
    if made.vertical:
        changes["vertical"] = {"scale": factor}
    return changes


def _amplification(made: Combination, folder: Path) -> float:
    """Change of the history and of the peak over that of the motion, all relative [-]."""
    output = {"output": {"dt": 0.02}}
    plain = _run(made, folder, **output)
    name = "u_s" if "u_s" in plain else "theta"
    largest = 0.0
    for sign in (-1, 1):
        other = _run(made, folder, **output, **_shaken(made, 1 + sign * CHANGE))
        both = [x[name].values for x in (plain, other)]
        if not np.array_equal(*map(np.isnan, both)):
            return math.inf
        change = np.nanmax(np.abs(both[0] - both[1])) / np.nanmax(np.abs(both[0]))
        largest = max(largest, change, abs(_peak(other) / _peak(plain) - 1))
        largest = max(largest, _apart(plain, other)[0])
    return largest / CHANGE


def find_imbalance(made: Combination, folder: Path) -> str | None:
    """Compare the work of the ground with stored and dissipated energies, by name."""
    run = _run(made, folder, output={"energy": True})
    if not float(run["energy_balance_relative"]) < BALANCE:
        return f"balance {float(run['energy_balance_relative'])}"
    for name in ("energy_viscous_J_per_kg", "energy_hysteretic_J_per_kg", "energy_impact_J_per_kg"):
        if name in run and not float(run[name]) >= -1e-12:
            return f"{name} {float(run[name])}"
    return None


def find_hinge(made: Combination, folder: Path) -> str | None:
    """Hinge the wall, all but cable and impact: the ledger closes and two methods agree."""
    groups = {name: keys for name, keys in made.groups.items() if name not in ("cable", "impact")}
    made = replace(made, groups=groups | {"wall": made.groups["wall"] | {"base": "pinned"}})
    runs = [_run(made, folder, method, output={"energy": True}) for method in ("dop853", "bdf")]
    if not float(runs[0]["energy_balance_relative"]) < BALANCE:
        return f"balance {float(runs[0]['energy_balance_relative'])}"
    return _judge(made, folder, runs)


def _judge(made: Combination, folder: Path, runs: list[rwmf.Response]) -> str | None:
    """Compare runs: a step may err by the tolerance, and only the scene may amplify that."""
    apart, name = _apart(*runs)
    if apart <= FLOOR:
        return None
    bound = RTOL * max(int(run.attrs["steps"]) for run in runs) * _amplification(made, folder)
    if not bound < UNDECIDED:
        raise UndecidedError
    return None if apart <= bound else f"{name} {apart}, bound {bound}"


def find_disagreement(made: Combination, folder: Path) -> str | None:
    """Compare methods.

    Without loss at impact the chatter keeps the phase of flights that are smaller than the
    tolerance. There a multistep method has no digits, so that it is omitted.
    """
    third = () if made.groups["impact"].get("e") == 1.0 else ("bdf",)
    return _judge(made, folder, [_run(made, folder, x) for x in ("dop853", "taylor", *third)])


def find_asymmetry(made: Combination, folder: Path) -> str | None:
    """Turn the motion round, not the vertical one: in `symmetric` the rotation turns as well."""
    groups = made.groups | {"model": made.groups["model"] | {"formulation": "symmetric"}}
    made = replace(made, groups=groups)
    opposite = _shaken(made, -1.0)
    opposite.pop("vertical", None)
    if "ratio" in groups.get("vertical", {}):
        opposite["vertical"] = {"ratio": -groups["vertical"]["ratio"]}
    output = {"output": {"dt": 0.05}}
    runs = [_run(made, folder, **output, **x) for x in ({}, opposite)]
    one, other = (run["theta"].values for run in runs)
    if not np.array_equal(np.isnan(one), np.isnan(other)):
        return "only one of both overturns"
    rest = np.nanmax(np.abs(one + other)) / max(np.nanmax(np.abs(one)), 1e-9)
    apart, name = _apart(*runs)
    return None if max(rest, apart) <= MIRROR else f"{rest}, {name} {apart}"


def find_shift(made: Combination, folder: Path) -> str | None:
    """Delay the motion: it does the same later, and before it nothing moves."""
    if (made.horizontal and made.horizontal[0][0] < 0) or made.groups["motion"].get("t_0", 0.0) < 0:
        return None
    if made.vertical and made.vertical[0][0] < 0:
        return None
    delay = 1.0 / 3.0
    t_end = made.groups["solver"].get("t_end")
    if t_end is None:
        t_end = max(
            t for samples in (made.horizontal, made.vertical) for t, _ in samples or [(0, 0)]
        )
    groups = {name: dict(keys) for name, keys in made.groups.items()}
    if not made.horizontal:
        groups["motion"]["t_0"] = groups["motion"].get("t_0", 0.0) + delay
    late = replace(
        made,
        groups=groups,
        horizontal=tuple((t + delay, a) for t, a in made.horizontal),
        vertical=tuple((t + delay, a) for t, a in made.vertical),
    )
    now = _run(made, folder, solver={"t_end": t_end})
    then = _run(late, folder, solver={"t_end": t_end + delay})
    # the wall has borne its weight before
    least = "pivot_normal_min_over_m_w_g"
    but = [least, "friction_demand_max"] if float(now.get(least, 1.0)) < PRESSED else [least]
    return _judge(made, folder, [run.drop_vars(but, errors="ignore") for run in (now, then)])


def find_change(made: Combination, folder: Path) -> str | None:
    """Compare runs and ordinates, alone and beside others, bit for bit."""
    runs = [_numbers(_run(made, folder)) for _ in range(2)]
    if runs[0] != runs[1]:
        return f"{runs}"
    names = [name for name in runs[0] if name != "peak"]
    if not names or "frame" not in made.groups:
        return None
    case = made.build(folder, solver={"method": "dop853", "rtol": RTOL})
    T_s = made.groups["frame"].get("T_s")
    if T_s is None:
        T_s = float(rwmf.simulate(case.replace(solver={"t_end": 1e-3}))["T_s"])
    alone, beside = (
        rwmf.spectrum(case, T_s=periods, quantities=names)
        .squeeze()
        .isel(T_s=0, missing_dims="ignore")
        for periods in ([T_s], [T_s, 1.5 * T_s, 2.2 * T_s])
    )
    wrong = [
        name for name in names
        if not np.array_equal(alone[name].values, beside[name].values, equal_nan=True)
    ]  # fmt: skip
    return f"{wrong}" if wrong else None


def find_broken_promise(made: Combination, folder: Path) -> str | None:
    """Ask for an accuracy of the peak, and see whether it is delivered."""
    asked = _run(made, folder, solver={"accuracy": PROMISE, "rtol": None})
    trusted = _run(made, folder, solver=TRUSTED)
    error = abs(_peak(asked) - _peak(trusted))
    if error <= max(PROMISE * _peak(trusted), NOTHING):
        return None
    if not RTOL * int(trusted.attrs["steps"]) * _amplification(made, folder) < 0.1 * PROMISE:
        raise UndecidedError
    return f"{error / _peak(trusted)}"


# columns of a history and their located extremes: the largest magnitude
_LOCATED = {
    r"(storey_\d+_drift|wall_drift|frame_drift|friction_demand|u_s|theta_dot)": r"\1_max",
    r"(storey_\d+_shear|wall_shear|wall_moment)_over_m_w_g": r"\1_max_over_m_w_g",
    r"(wall_shear_base|wall_moment_base|link_\d+_force)_over_m_w_g": r"\1_max_over_m_w_g",
    r"(floor_\d+_acceleration)_g": r"\1_max_g",
    r"(overturning_moment|base_shear)_over_weight": r"\1_max_over_weight",
    "pivot_horizontal_over_m_w_g": "shear_key_force_max_over_m_w_g",
}


def find_overlooked(made: Combination, folder: Path) -> str | None:
    """Find rows of 0.1 ms beyond the maximum located between rows, also at a loose tolerance."""
    for rtol in (1e-4, RTOL):
        run = _run(made, folder, solver={"rtol": rtol}, output={"dt": 1e-4})
        for column in map(str, run):
            for pattern, key in _LOCATED.items():
                found = re.fullmatch(pattern, column)
                if found is None or found.expand(key) not in run:
                    continue
                highest = np.nanmax(np.abs(run[column].values))
                if highest > float(run[found.expand(key)]) * (1 + ROUND_OFF) + NOTHING**2:
                    return f"{column} {highest} {float(run[found.expand(key)])} at rtol {rtol}"
        if "pivot_normal_over_m_w_g" in run:
            lowest = np.nanmin(run["pivot_normal_over_m_w_g"].values)
            least = float(run["pivot_normal_min_over_m_w_g"])
            if lowest < least - ROUND_OFF * max(1.0, abs(least)):
                return f"pivot_normal {lowest} {least} at rtol {rtol}"
    return None


def find_slip(made: Combination, folder: Path) -> str | None:
    """Ask method `auto` as a whole: its lanes, and where it leaves the scene to the kernel."""

    def peaks(solver: Changes, **changes: Changes) -> np.ndarray:
        found = rwmf.spectrum(made.build(folder, solver=solver, **changes), threads=1)
        if set(found["status"].values.flat) - {"ok", "overturned"}:
            raise UndecidedError
        return found["u_s_max"].values.ravel()

    trusted = peaks(TRUSTED)
    found = peaks({"method": "auto", "rtol": FAST_RTOL})
    errors = np.abs(found - trusted)
    if np.all(errors <= np.maximum(FAST_FLOOR * trusted, NOTHING)):
        return None
    others = [peaks(TRUSTED, **_shaken(made, 1 + s * 10 * FAST_RTOL)) for s in (-1, 1)]
    kappa = np.maximum(*(np.abs(x - trusted) for x in others)) / (10 * FAST_RTOL * trusted)
    bounds = FAST_FACTOR * FAST_RTOL * np.maximum(kappa, 1.0)
    wrong = (errors > bounds * trusted) & (bounds < UNDECIDED)
    return f"{found[wrong]} {trusted[wrong]} {kappa[wrong]}" if np.any(wrong) else None


@pytest.mark.slow
@pytest.mark.parametrize("start", _STARTS)
@pytest.mark.parametrize(
    "check",
    [find_imbalance, find_hinge, find_disagreement, find_asymmetry, find_shift],
    ids=lambda x: x.__name__,
)
def test_combinations(check: Check, start: int, tmp_path: Path) -> None:
    """Check the laws that hold for all combinations."""
    _go_through(check, combination, start, tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("start", _STARTS)
@pytest.mark.parametrize(
    "check",
    [
        find_imbalance,
        find_hinge,
        find_disagreement,
        find_asymmetry,
        find_shift,
        find_change,
        find_broken_promise,
        find_overlooked,
    ],
    ids=lambda x: x.__name__,
)
def test_further_combinations(check: Check, start: int, tmp_path: Path) -> None:
    """Check further laws, for every demand."""
    _go_through(check, further_combination, start, tmp_path)


@pytest.mark.parametrize("start", _STARTS)
def test_fast(start: int, tmp_path: Path) -> None:
    """Spectra by `fast` under every kind of motion against the general kernel at its tightest."""
    _go_through(find_slip, spectrum_combination, start, tmp_path)


# an effect, the value that makes it vanish, and the equivalent scene without it
_LIMITS = {
    "link": ({"link": {"L": 1e12}}, {}),
    "cable": ({"cable": {"eta_y": 1e9}}, {}),
    "cable, truss": (
        {"cable": {"law": "truss", "eta_y": 1e9}},
        {"cable": {"law": "truss"}},
    ),
    "cable, strain": ({"cable": {"rupture_strain": 1e9}}, {}),
    "yielding": ({"yielding": {"u_y": 1e9}}, {}),
    "fuse": ({"fuse": {"eta_y": 1e-15, "stroke_y": 0.01}}, {}),
    "damper": ({"damper": {"c_over_m_w": 0.0}}, {}),
    "inerter": ({"inerter": {"inertance_over_m_w": 0.0}}, {}),
    "vertical": ({"vertical": {"ratio": 0.0}}, {}),
    "table": (
        {
            "impact": {
                "rule": "table",
                "e": None,
                "table_theta_dot": [0.1, 2.0],
                "table_e": [0.9, 0.9],
            }
        },
        {},
    ),
}


@pytest.mark.parametrize("formulation", ["symmetric", "exact"])
@pytest.mark.parametrize("limit", _LIMITS)
def test_limit(limit: str, formulation: str) -> None:
    """The scene without the effect, but for round-off: same events, same peaks."""
    with_it, without = _LIMITS[limit]
    scene = rwmf.Case(
        wall={"h": 2.0, "b": 0.5},
        frame={"T_s": 0.8, "gamma": 5.0, "xi_s": 0.05},
        cable={"eta_0": 1.0, "eta_alpha": 5.0},
        impact={"rule": "constant", "e": 0.9},
        motion={"kind": "one_cosine", "a_max_g": 0.4, "omega_p": 2 * math.pi},
        model={"formulation": formulation},
        solver={"t_end": 3.0, "method": "dop853", "rtol": 1e-13},
    )
    run = rwmf.simulate(scene.replace(**with_it), dt=3.0)
    plain = rwmf.simulate(scene.replace(**without), dt=3.0)
    assert int(plain["impacts"]) > 3
    for name in ("u_s_max", "theta_dot_max"):
        assert float(run[name]) == pytest.approx(float(plain[name]), rel=LIMIT), name
    impacts = [x["event_time"].values[x["event"].values == "impact"][:4] for x in (run, plain)]
    assert impacts[0] == pytest.approx(impacts[1], rel=LIMIT)
