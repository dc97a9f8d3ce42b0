"""Each quantity of a scene by itself beside the same quantity among all, in every path."""

import csv
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from pathlib import Path

import numpy as np
import numpy.typing as npt
import rwmf
from c_host import run_rows
from checkout import BATCH, run_words
from combinations import Combination, combination, further_combination, spectrum_combination
from rwmf.kernel import results
from rwmf.run import simulation as _simulation
from rwmf.run.quantities import find

Numbers = npt.NDArray[np.float64]
Found = dict[str, Numbers]
Path_ = Callable[[rwmf.Case, Sequence[str], Path], Found]

RTOL = 1e-7
# paths whose ordinates advance by Taylor series, where these know all requested quantities
_BY_SERIES = ("rows", "spectrum", "sweep", "C")
# forces and demands that the series know
_OF_SERIES = re.compile(
    "(t_)?(base_shear|pivot_normal_(min|max)|link_|friction_demand_max|shear_key|floor_(\\d+_)?acceleration"
    "|storey_|roof_|wall_drift|frame_drift|tendon_)|pivot_lifts"
)
FAMILIES = (combination, further_combination, spectrum_combination)


def scene_of(number: int) -> Combination:
    """Scene of a number: of each family in turn.

    Parameters
    ----------
    number : int
        Any.

    Returns
    -------
    Combination
        The scene.
    """
    return FAMILIES[number % len(FAMILIES)](number // len(FAMILIES))


def build(number: int, folder: Path) -> rwmf.Case:
    """Make the case of a number, every second one with a mass: its forces are in N as well.

    Parameters
    ----------
    number : int
        Any.
    folder : Path
        Folder for its records.

    Returns
    -------
    rwmf.Case
        A case with a period, whose friction is compared with a limit.
    """
    made = scene_of(number)
    # the first numbers have every family with and without a mass
    mass = {"wall": {"m_w": 1000.0}} if "wall" in made.groups and number // 3 % 2 else {}
    case = made.build(folder, solver={"rtol": RTOL}, **mass)
    if case.spectrum is not None:
        case = case.replace(frame={"T_s": case.spectrum.T_s[0]}, spectrum=None)
    has_base = case.wall is not None and not case.wall.shear_key
    limit = {"friction_limit": 0.3} if has_base else {}
    return case.replace(output={"reactions": True, "energy": True, **limit})


def paths(number: int) -> dict[str, Path_]:
    """Ways from a case to quantities: those of other programs for some numbers only.

    Parameters
    ----------
    number : int
        Of the scene.

    Returns
    -------
    dict of str to callable
        By name.
    """
    ways: dict[str, Path_] = {"rows": _rows, "rows of runs": _rows_of_runs}
    if number % 6 < 3:
        ways["spectrum"] = _spectrum
    if number % 12 < 2:
        ways |= {"sweep": _sweep, "C": _host_in_c, "rwmf-batch": _batch}
    return ways


def differences(number: int, folder: Path, every_storey: bool = True) -> Iterator[str]:
    """Find the quantities of a scene that depend on the other requested quantities.

    Parameters
    ----------
    number : int
        Of the scene.
    folder : Path
        Folder for its files.
    every_storey : bool, optional
        Whether to request a quantity of each storey alone, rather than that of one storey.

    Yields
    ------
    str
        Scene, path, quantity and its numbers.
    """
    case = build(number, folder)
    keys = case.kernel.applicable()
    for name, compute in paths(number).items():
        together = compute(case, keys, folder)
        for key in keys if every_storey else _of_one_storey(keys, number):
            alone = compute(case, [key], folder)[key]
            if not _is_same(alone, together[key], key if name in _BY_SERIES else ""):
                yield f"{number}, {name}, {key}: {alone} alone, {together[key]} among all"
    yield from _run_differences(number, case)


def _of_one_storey(keys: Iterable[str], number: int) -> list[str]:
    """Choose one of the quantities that differ by the number of a storey, floor or link only."""
    alike: dict[str, list[str]] = {}
    for key in keys:
        alike.setdefault(re.sub(r"_\d+_", "_i_", key), []).append(key)
    return [group[number % len(group)] for group in alike.values()]


def _is_same(alone: Numbers, together: Numbers, key: str) -> bool:
    """Compare bits; series are close to the complete motion."""
    if np.array_equal(alone, together, equal_nan=True):
        return True
    is_by_series = bool(key) and (not find(key).asked_by or bool(_OF_SERIES.match(key)))
    return is_by_series and np.allclose(
        alone, together, rtol=100 * RTOL, atol=100 * RTOL, equal_nan=True
    )


def _run_differences(number: int, case: rwmf.Case) -> Iterator[str]:
    """Compare runs that keep one thing with the run that keeps all."""
    # a limit of friction asks for the first excess: it is part of the case, not of a request
    limit: dict[str, object] = {}
    if hasattr(case.output, "friction_limit"):
        limit["friction_limit"] = case.output.friction_limit
    together = _summary(case, limit | {"reactions": True, "dt": 0.05, "energy": True})
    for output in ({}, {"dt": 0.05}, {"energy": True}, {"reactions": True}):
        for key, value in _summary(case, limit | output).items():
            if find(key).found == "work" or key == "warnings":
                continue
            if not np.array_equal(value, together[key], equal_nan=find(key).kind == "real"):
                yield f"{number}, run with {output}, {key}: {value}, {together[key]} of all"


def _summary(case: rwmf.Case, output: dict[str, object]) -> dict[str, object]:
    with _simulation.start(case.replace(output=None).replace(output=output)) as run:
        return dict(run.summary())


def _size(case: rwmf.Case) -> tuple[str, float]:
    """Key of the size of the motion, and its value."""
    key = "scale" if case.motion.kind == "record" else "a_max_g"
    return key, getattr(case.motion, key)


def _table(case: rwmf.Case, keys: Sequence[str], factors: Sequence[float]) -> Found:
    name, size = _size(case)
    numbers = size * np.array(factors)[:, None]
    sizes = [f"motion.{name}"]
    with results.start_rows(case.kernel, "", sizes, numbers, keys, 1) as found:
        return {key: np.ravel(values) for key, values in found.values().items() if key in keys}


def _rows(case: rwmf.Case, keys: Sequence[str], _: Path) -> Found:
    """Rows of a table, in lanes."""
    return _table(case, keys, [1.0, 0.7, 1.3])


def _rows_of_runs(case: rwmf.Case, keys: Sequence[str], _: Path) -> Found:
    """Rows by a method without lanes, which do not see each other."""
    return _table(case.replace(solver={"method": "taylor", "rtol": 1e-5}), keys, [1.0, 1.3])


def _spectrum(case: rwmf.Case, keys: Sequence[str], _: Path) -> Found:
    """Ordinates of three periods."""
    periods = [0.31, 0.7, 1.9]
    found = rwmf.spectrum(case, T_s=periods, quantities=keys)
    return {key: np.ravel(found[find(key).names("ordinate")[0]]) for key in keys}


def _sweep(case: rwmf.Case, keys: Sequence[str], _: Path) -> Found:
    name, size = _size(case)
    found = rwmf.sweep(case, {f"motion.{name}": [size]}, quantities=tuple(keys))
    return {key: np.ravel(found[find(key).called(key)]) for key in keys}


def _host_in_c(case: rwmf.Case, keys: Sequence[str], folder: Path) -> Found:
    path = folder / "host.nml"
    case.to_namelist(path)
    name, size = _size(case)
    rows = run_rows(path, f"motion.{name}", [size, 0.8 * size], keys)
    return dict(zip(keys, np.transpose(rows), strict=True))


def _batch(case: rwmf.Case, keys: Sequence[str], folder: Path) -> Found:
    path = folder / "batch.nml"
    asked = case.replace(
        spectrum={"T_s": [0.4, 1.1], "quantities": list(keys)}, solver={"method": "dop853"}
    )
    asked.to_namelist(path)
    done = run_words([BATCH, path], folder)
    assert done.returncode == 0, done.stderr
    with path.with_suffix(".spectrum.csv").open(encoding="utf-8") as file:
        lines: Iterable[str] = (line for line in file if not line.startswith("#"))
        rows = list(csv.DictReader(lines))
    return {key: np.array([float(row[key]) for row in rows]) for key in keys}
