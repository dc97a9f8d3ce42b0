"""Gradients of results: central differences through the lanes of sweeps."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence

import numpy as np
import xarray as xr

from rwmf.assess.lanes import (
    RECORD,
    Lanes,
    Parameter,
    Scenes,
    Statistic,
    Steps,
    SuiteStatistic,
    find_parameters,
)
from rwmf.case import Case, CaseLike, Motion
from rwmf.case.arguments import case_of, checked, texts_of
from rwmf.errors import InputError
from rwmf.kernel import tables
from rwmf.kernel.progress import Reports, reporting
from rwmf.motion.record_sets import RecordFile
from rwmf.run.quantities import ORDINATES, default_quantity, find_quantities
from rwmf.sweeps.points import Points


def requested(case: Case) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Return the names that the case's `&sensitivity` requests."""
    group = case.sensitivity
    if group is None:
        return (), ()
    return group.parameters, group.quantities if "quantities" in group else ()


@checked
def gradient(
    case: CaseLike,
    parameters: str | Sequence[str] | None = None,
    quantities: str | Sequence[str] | None = None,
    *,
    points: Points | None = None,
    grid: Mapping[str, object] | None = None,
    records: Sequence[str | os.PathLike[str] | RecordFile | Motion] = (),
    statistic: Statistic | None = None,
    over: str | Sequence[str] = RECORD,
    threads: int = 0,
    progress: Reports = None,
    unit: str | None = None,
    dt: float | None = None,
) -> xr.Dataset:
    """Compute derivatives of results with respect to numbers of the case.

    The derivatives are central differences with one Richardson step, computed in the lanes of one
    sweep at a relative tolerance of 1e-9. Where they disagree, lanes with smaller steps and tighter
    tolerances follow. At a bound of a key the differences are one-sided. All other given keys are
    held; defaults and keys that the case derives from a parameter follow it.

    Parameters
    ----------
    case : Case or path
        The case; its `&spectrum` is ignored.
    parameters : str or sequence of str, optional
        Keys with real numbers, with or without their group. An element of a list is ``k(2)``; a
        list with several numbers is represented by its mean, and they keep their ratios. ``scale``
        is the factor on the motion. The default is ``parameters`` of the case's ``&sensitivity``.
    quantities : str or sequence of str, optional
        Quantities of a sweep; the default is that of ``&sensitivity``, else of `rwmf.sweep`.
    points, grid, records
        As in `rwmf.sweep`; each run has a gradient.
    statistic : float or callable, optional
        Differentiate a statistic over the records instead. A number is the share of a quantile, by
        ranks. A function takes an array of one value a record, infinite after a collapse. The
        steps are five times larger.
    over : str or sequence of str
        Dimensions of the array that the statistic takes, ``record`` first.
    threads, progress, unit, dt
        As in `rwmf.sweep`; the number of all runs grows where smaller steps follow.

    Returns
    -------
    xarray.Dataset
        Over ``quantity``, ``parameter``, and the dimensions of points, grid and records. ``value``
        and ``derivative`` have the units of the case; ``error`` is the estimated error of the
        derivative. ``is_kink`` is true where the slopes on both sides differ, or no derivative is
        found. Changes of the parameter up to ``valid_within`` times ``parameter_scale`` change the
        result as predicted within 10 %; at most 0.3. ``parameter_scale`` is the absolute
        ``parameter_value``, for a value of 0 the middle of its usual range. With a statistic,
        ``bootstrap_error`` is the scatter of the derivative over resampled suites. The attribute
        ``runs`` counts the runs.

    Raises
    ------
    InputError
        When an argument is not acceptable. A parameter must be a real number that does not follow
        from other keys, and the kernel must let it change.
    """
    case = case_of(case)
    given, listed = requested(case)
    if parameters is None and not given:
        raise InputError("parameters: must be given, or the case must have &sensitivity")
    parameters = texts_of("parameters", given if parameters is None else parameters)
    names = texts_of("quantities", quantities or listed or default_quantity(case))
    find_quantities(tuple(names))
    scenes = Scenes(case, points, grid, records, unit, dt)
    found = find_parameters(scenes.case, parameters, scenes.columns)
    suite = None
    reduced = texts_of("over", over)
    if statistic is None:
        if reduced != [RECORD]:
            raise InputError("over: needs a statistic")
        reduced = []
    else:
        axes = tuple(scenes.index_of(name) for name in reduced)
        suite = SuiteStatistic(statistic, axes, tuple(scenes.sizes.values()))
    with reporting(progress) as report:
        lanes = Lanes(scenes, found, names, threads, report)
        steps = Steps(scenes, lanes, found, suite)
    dims = [name for name in scenes.sizes if name not in reduced]
    dataset = _dataset(scenes, lanes, steps, dims, found)
    dataset.coords["quantity"] = ("quantity", names, {"long_name": "result"})
    dataset.coords["parameter"] = ("parameter", parameters, {"long_name": "number of the case"})
    dataset.coords["quantity_unit"] = ("quantity", [_unit_of(name) for name in names])
    return dataset


def _dataset(
    scenes: Scenes, lanes: Lanes, steps: Steps, dims: list[str], parameters: Sequence[Parameter]
) -> xr.Dataset:
    """Label derivatives with respect to the parameters themselves."""
    sizes = [scenes.sizes[name] for name in dims]
    # the scenes of a statistic have the same parameters
    scales, values = steps.of_cells(steps.scales), steps.of_cells(lanes.values)

    def cells(array: np.ndarray, *labels: str) -> tuple[tuple[str, ...], np.ndarray]:
        """Give an array the dimensions of the scenes last."""
        shaped = np.moveaxis(array, 0, -1)
        return (*labels, *dims), shaped.reshape((*shaped.shape[:-1], *sizes))

    def over(array: np.ndarray, text: str) -> tuple[tuple[str, ...], np.ndarray, dict[str, str]]:
        return *cells(array.swapaxes(1, 2), "quantity", "parameter"), {"long_name": text}

    by = scales[:, :, None]
    variables = {
        "value": (*cells(steps.value, "quantity"), {"long_name": "value of the result"}),
        "derivative": over(steps.derivative / by, "derivative, unit of result over parameter"),
        "error": over(steps.error / by, "estimated error of the derivative"),
        "is_kink": over(steps.is_kink, "slopes differ on both sides, or there is none"),
        "valid_within": over(
            steps.valid_within,
            "change of the parameter over parameter_scale up to which the derivative predicts the "
            "change of the result within 10 %",
        ),
    }
    if steps.bootstrap_error is not None:
        text = "standard deviation of the derivative over resampled suites"
        variables["bootstrap_error"] = over(steps.bootstrap_error / by, text)
    found = xr.Dataset(variables, attrs={"runs": lanes.runs, "version": tables.version()})
    coordinates = scenes.coordinates()
    for name, label in coordinates.items():
        if set(label.dims) <= set(dims):
            found.coords[name] = label
    found.coords["parameter_value"] = cells(values, "parameter")
    found.coords["parameter_scale"] = cells(scales, "parameter")
    found.coords["parameter_unit"] = ("parameter", [item.unit for item in parameters])
    return found


def _unit_of(name: str) -> str:
    return ORDINATES[next(iter(find_quantities((name,))))].unit
