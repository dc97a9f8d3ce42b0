"""Static curve of a case under lateral loads."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt
import xarray as xr

from rwmf.case import Case, CaseLike
from rwmf.case.arguments import case_of, checked
from rwmf.errors import InputError
from rwmf.kernel import results, tables
from rwmf.kernel.numbers import Array, show, to_array, to_whole
from rwmf.run.checks import crossings_of
from rwmf.run.quantities import INSTANT, QUANTITIES, find_numbered
from rwmf.run.response import OWN, Labelled, Response, dataset, marks_of
from rwmf.run.simulation import by_quantity, label, level_coordinates, sizes_of

PATTERNS = ("first_mode", "floors", "roof")

# drift of the roof without a protocol: beyond the limits of design codes and the range of tests
_DRIFT = 0.04
_MOST_STEPS = 100_000
_STEP = "step"
_Curve = TypeVar("_Curve", bound=xr.Dataset)

# in a history these are forces of the foundation or of the inertia, with other signs
_SIGNED = {
    "base_shear_over_weight": "total lateral load, the base shear, over weight of wall and frame",
    "overturning_moment_over_weight": "moment of the lateral load about the ground over the weight",
}


@checked
def pushover(
    case: CaseLike,
    drifts: float | Sequence[float] = _DRIFT,
    pattern: str | Sequence[float] | None = None,
    *,
    forces: Sequence[float] | None = None,
    steps: int = 100,
) -> Response:
    """Compute the static curve of a case: base shear over the drift of its roof.

    The roof moves slowly from rest through the drifts. Motion, initial state and dampers of the
    case have no effect. Ends of branches, lift-off and contact are located to round-off; each is a
    step with a mark.

    Parameters
    ----------
    case : Case or path
        The case.
    drifts : float or sequence of float
        Drifts of the roof at the ends of the legs: one for a monotonic curve, turning points with
        their signs for a cyclic one.
    pattern : str or sequence of float, optional
        Load on the floors: ``'first_mode'`` (masses times first mode of the frame; default with
        `&storeys`), ``'roof'`` (default otherwise), ``'floors'`` with `forces`, or these forces.
    forces : sequence of float, optional
        Forces on the floors from the ground up, in any unit.
    steps : int
        Steps of a leg, apart from events.

    Returns
    -------
    Response
        An `xarray.Dataset` over ``step``: ``roof_drift``, ``base_shear_over_weight`` and
        ``overturning_moment_over_weight``. Displacements and forces have the names of a history,
        with masses also in N. The coordinates ``mark``, ``mark_step`` and
        ``mark_roof_drift`` name the events. The attribute ``weight`` names the weight;
        ``ending`` is ``complete``, ``overturned``, ``collapsed`` (a drift limit of the case),
        ``no_equilibrium`` or ``no_contact``.

    Raises
    ------
    InputError
        When an argument is not acceptable, or the height of the frame is unknown.
    NumericalError
        When branches change without end.
    Interrupted
        After Ctrl-C.
    """
    case = case_of(case)
    name, loads = _pattern_of(case, pattern, forces)
    legs = to_array("drifts", drifts, least=1)
    n = to_whole("steps", steps, 1, _MOST_STEPS)
    curve = results.compute_curve(case.kernel, case.label, name, loads, legs, n)
    found = _to_dataset(curve, case, name)
    if case.kernel.limited_demands():
        return _with_marks(found, crossings_of(case, found))
    return found


def _with_marks(curve: _Curve, more: Iterable[tuple[str, int, float]]) -> _Curve:
    """Add marks by name, step and drift, in the order of the steps."""
    rows = sorted([*marks_of(curve), *more], key=lambda row: row[1])
    steps = np.array([step for _, step, _ in rows], dtype=np.int64)
    drifts = np.array([drift for *_, drift in rows], dtype=np.float64)
    plain = curve.drop_dims("mark")
    marks = _marks([name for name, *_ in rows], steps, drifts)
    return plain.assign_coords({key: xr.Variable(*item) for key, item in marks.items()})


def _pattern_of(case: Case, pattern: object, forces: object) -> tuple[str, Array]:
    """Return the name of the pattern, and the forces of 'floors'."""
    if pattern is not None and not isinstance(pattern, str):
        if forces is not None:
            raise InputError("forces: must not be given when pattern holds the forces")
        pattern, forces = "floors", pattern
    if pattern is None:
        pattern = "first_mode" if case.storeys is not None else "roof"
        if forces is not None:
            pattern = "floors"
    if pattern not in PATTERNS:
        raise InputError(f"pattern = {show(pattern)}: must be one of {', '.join(PATTERNS)}")
    if pattern == "floors" and forces is None:
        raise InputError("pattern = 'floors': needs forces, one for each floor from the ground up")
    loads = np.zeros(0) if forces is None else to_array("forces", forces, least=1)
    return str(pattern), loads


def _to_dataset(curve: results.StaticCurve, case: Case, pattern: str) -> Response:
    """Label the curve of the kernel."""
    columns = {name: values for name, values in curve.columns.items() if name not in OWN}
    found = by_quantity((columns | _in_newtons(columns, curve.weights, case)).items())
    sizes = sizes_of(found.values())
    variables: dict[str, Labelled] = {}
    for name, (short, unit, meaning) in OWN.items():
        variables[short] = (
            (_STEP,),
            curve.columns[name],
            {"units": unit, "long_name": meaning},
        )
    label(variables, found, "history", sizes, _STEP)
    for name, meaning in _SIGNED.items():
        dims, values, attributes = variables[name]
        variables[name] = (dims, values, {**attributes, "long_name": meaning})
    steps = np.array([step for _, step in curve.marks], dtype=np.int64)
    coordinates: dict[str, Labelled] = {
        _STEP: ((_STEP,), np.arange(len(curve.columns["roof_drift"])), {"long_name": "step"}),
        **_marks([name for name, _ in curve.marks], steps, curve.columns["roof_drift"][steps]),
    }
    if sizes:
        used = {dim for item in variables.values() for dim in item[0]}
        coordinates |= level_coordinates(case, sizes, used)
    facts: dict[str, Any] = {
        "version": tables.version(),
        "pattern": pattern,
        "pattern_shares": curve.pattern.tolist(),
        "ending": curve.ending,
        "warnings": "\n".join(case.kernel.motion_warnings()),
        "roof_height_m": curve.height,
        "weight": "weight of wall and frame" if case.wall is not None else "weight of the frame",
    }
    if curve.weights[1] > 0:
        facts["weight_N"] = curve.weights[1]
    return dataset(variables, coordinates, facts, Response)


def _marks(names: list[str], steps: npt.NDArray[Any], drifts: Array) -> dict[str, Labelled]:
    return {
        "mark": (("mark",), np.array(names, dtype=str), {"long_name": "event of the path"}),
        "mark_step": (("mark",), steps, {"long_name": "step of the event"}),
        "mark_roof_drift": (
            ("mark",),
            drifts,
            {"units": "1", "long_name": "drift of the roof at the event"},
        ),
    }


def _in_newtons(
    columns: dict[str, Array], weights: tuple[float, float], case: Case
) -> dict[str, Array]:
    """Return the forces in N and moments in N m, where the case has masses."""
    if not weights[0] > 0:
        return {}
    by_suffix = {"_over_m_w_g": weights[0], "_over_weight": weights[1]}
    if case.storeys is None:
        by_suffix["_over_m_s_g"] = weights[1] - (weights[0] if case.wall is not None else 0.0)
    found = {}
    for name, values in columns.items():
        for suffix, weight in by_suffix.items():
            for end, unit in ((suffix, "_N"), (f"{suffix}_m", "_N_m")):
                if not name.endswith(end):
                    continue
                key = name.removesuffix(end) + unit
                pattern = find_numbered(name)[0].key.removesuffix(end) + unit
                if pattern in QUANTITIES or pattern in INSTANT:
                    found[key] = weight * values
    return found
