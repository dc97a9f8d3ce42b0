"""One simulation: from a case to labelled arrays."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import xarray as xr

from rwmf import _library
from rwmf._arguments import case_of
from rwmf._labels import Labelled, dataset
from rwmf._numbers import to_number
from rwmf.case import Case, CaseLike
from rwmf.quantities import find

__all__ = ["simulate", "start", "to_dataset", "with_history"]


def simulate(case: CaseLike, dt: float | None = None) -> xr.Dataset:
    """Compute the response of a case.

    Parameters
    ----------
    case : Case or path
        The case.
    dt : float, optional
        Interval of the history [s]; otherwise that of the case's `&output`. The integration
        does not depend on it.

    Returns
    -------
    xarray.Dataset
        Variables over ``time`` (none without an interval), coordinates over ``event``, and maxima
        and counts without dimension, each with its unit in ``attrs``. The attributes of the dataset
        hold the cost of the computation; ``warnings`` has one warning per line. Names carry no
        units (docs/reference/outputs.md): energies over time are ``energy_input`` and so on,
        energies at the end ``energy_input_end``.

    Raises
    ------
    InputError
        When the case is not acceptable.
    NumericalError
        When the integration fails.
    Interrupted
        After Ctrl-C.
    """
    case = case_of(case)
    with start(case if dt is None else with_history(case, dt)) as run:
        return to_dataset(run)


def with_history(case: Case, dt: float) -> Case:
    """Return the case with another interval of the history.

    Parameters
    ----------
    case : Case
        The case.
    dt : float
        Interval [s].

    Returns
    -------
    Case
        The edited case.

    Raises
    ------
    InputError
        When the interval is not acceptable.
    """
    return case.replace(output={"dt": to_number("dt", dt, above=0.0, wanted="a number > 0 [s]")})


@contextmanager
def start(case: Case) -> Iterator[_library.Run]:
    """Run a case and keep the kernel's result until the ``with`` block is left.

    Parameters
    ----------
    case : Case
        The case.

    Yields
    ------
    Run
        Summary, history, events, and the files of the batch program.

    Raises
    ------
    InputError, NumericalError, Interrupted
        As `simulate`.
    """
    with _library.start_simulation(case.kernel, case.label) as run:
        yield run


def to_dataset(run: _library.Run) -> xr.Dataset:
    """Label the kernel's result.

    Parameters
    ----------
    run : Run
        From `start`.

    Returns
    -------
    xarray.Dataset
        As `simulate` returns it.
    """
    summary = run.summary()
    variables: dict[str, Labelled] = {}
    columns, values = run.history()
    for i, column in enumerate(columns):
        quantity = find(column)
        for name in quantity.names("history"):
            variables[name] = (("time",), values[i], quantity.attributes)
    coordinates: dict[str, Labelled] = {}
    if columns:
        coordinates = {"time": variables.pop("time")} | _event_coordinates(run, summary)
    facts: dict[str, Any] = {"version": _library.version()}
    for key, value in summary.items():
        quantity = find(key)
        for name in quantity.names("run"):
            variables[name] = ((), value, quantity.attributes)
        if not quantity.name:
            # attributes of files are texts, and must not be empty
            facts[key] = "\n".join(value) if key == "warnings" else value
    return dataset(variables, coordinates, facts)


def _event_coordinates(run: _library.Run, summary: dict[str, Any]) -> dict[str, Labelled]:
    """Return the coordinates over the events; the state of a bare frame is its displacement."""
    events = run.events()
    state = ("theta", "theta_dot") if "wall" in summary["effects"] else ("u_s", "u_s_dot")
    over = ("event",)
    units = ("rad", "rad/s") if state[0] == "theta" else ("m", "m/s")
    return {
        "event": (over, events["kind"], {"long_name": "kind of event"}),
        "event_time": (over, events["t"], {"units": "s", "long_name": "time of the event"}),
        f"event_{state[0]}": (over, events["theta"], {"units": units[0]}),
        f"event_{state[1]}": (
            over,
            events["theta_dot"],
            {"units": units[1], "long_name": "rate at the event, at an impact the one before it"},
        ),
    }
