"""One simulation: from a case to labelled arrays."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

from rwmf.case import Case, CaseLike
from rwmf.case.arguments import case_of, checked
from rwmf.case.elements import heights_of_floors, heights_of_storeys
from rwmf.kernel import results, tables
from rwmf.run.headline import tendon_yield_of
from rwmf.run.quantities import Quantity, find_numbered

if TYPE_CHECKING:
    from rwmf.run.response import Labelled, Response

# keys of &solver that choose the tolerance by the accuracy of a peak, removed
NO_ACCURACY: dict[str, object] = dict.fromkeys(("accuracy", "accuracy_of", "verify"))


@checked
def simulate(case: CaseLike, dt: float | None = None) -> Response:
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
    Response
        An `xarray.Dataset`: variables over ``time`` (none without an interval), coordinates over
        ``event``, and maxima and counts, each with its unit in ``attrs``. Variables over ``storey``
        and ``floor`` hold the values from the ground up. The attributes of the dataset hold the
        cost of the computation; ``warnings`` has one warning per line. Names carry no units
        (docs/reference/outputs.md): energies over time are ``energy_input`` and so on, energies at
        the end ``energy_input_end``.

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
    if dt is not None:
        case = case.replace(output={"dt": dt})
    with start(case) as run:
        return to_dataset(run, case)


def start(case: Case) -> results.Run:
    """Run a case and keep the kernel's result until the end of a ``with`` block."""
    return results.start_simulation(case.kernel, case.label)


def to_dataset(run: results.Run, case: Case) -> Response:
    """Label the kernel's result."""
    # imported here, so that a run without a dataset does not load xarray
    from rwmf.run.response import Response, dataset

    summary = run.summary()
    columns, values = run.history()
    over_time = by_quantity(zip(columns, values, strict=True))
    of_run = by_quantity(summary.items())
    sizes = sizes_of((*over_time.values(), *of_run.values()))
    if "floor_{i}_m" in over_time:
        # the roof is a floor as well; on link springs it moves separately
        over_time["floor_{i}_m"][1].setdefault(sizes["floor"], over_time["u_s_m"][1][0])
    variables: dict[str, Labelled] = {}
    label(variables, over_time, "history", sizes)
    coordinates: dict[str, Labelled] = {}
    if columns:
        coordinates = {"time": variables.pop("time")} | _event_coordinates(run, summary)
    label(variables, {key: item for key, item in of_run.items() if item[0].name}, "run", sizes)
    if sizes:
        coordinates |= level_coordinates(
            case, sizes, {dim for item in variables.values() for dim in item[0]}
        )
    facts: dict[str, Any] = {"version": tables.version()}
    tendon_yield = tendon_yield_of(case)
    if tendon_yield is not None:
        facts["tendon_yield_over_m_w_g"] = tendon_yield
    for key, (quantity, value) in of_run.items():
        if not quantity.name:
            # attributes of files are texts, and must not be empty
            facts[key] = "\n".join(value[0]) if key == "warnings" else value[0]
    return dataset(variables, coordinates, facts, Response)


# rows of the table by their keys, each with the values of its floors or storeys by number
_Found = dict[str, tuple[Quantity, dict[int, Any]]]


def by_quantity(items: Iterable[tuple[str, Any]]) -> _Found:
    """Group values by their row in the table of quantities."""
    found: _Found = {}
    for key, value in items:
        quantity, number = find_numbered(key)
        found.setdefault(quantity.key, (quantity, {}))[1][number] = value
    return found


def sizes_of(found: Iterable[tuple[Quantity, dict[int, Any]]]) -> dict[str, int]:
    """Return the number of storeys, as many as floors, and of modes; absent without a quantity."""
    sizes: dict[str, int] = {}
    for quantity, values in found:
        if quantity.level:
            sizes[quantity.level] = max(sizes.get(quantity.level, 0), *values)
    for level in {"storey", "floor"} & sizes.keys():
        sizes[level] = max(sizes.get("storey", 0), sizes.get("floor", 0))
    return sizes


def label(
    variables: dict[str, Labelled],
    found: _Found,
    output: str,
    sizes: dict[str, int],
    over: str = "time",
) -> None:
    """Add variables over time or of a run, those of storeys or floors over their numbers."""
    for quantity, values in found.values():
        dims = (over,) if output == "history" else ()
        if quantity.level:
            missing = np.full_like(next(iter(values.values())), np.nan, dtype=np.float64)
            levels = [values.get(number, missing) for number in range(1, sizes[quantity.level] + 1)]
            dims, array = (*dims, quantity.level), np.stack(levels, axis=-1)
            quantity = quantity.over_levels
        else:
            array = values[0]
        for name in quantity.names(output):
            variables[name] = (dims, array, quantity.attributes)


def level_coordinates(case: Case, sizes: dict[str, int], dims: set[str]) -> dict[str, Labelled]:
    """Return numbers and heights of the storeys and floors, from the ground up."""
    found: dict[str, Labelled] = {}
    known = {
        "storey": (heights_of_storeys(case), "height of the storey, from floor to floor"),
        "floor": (heights_of_floors(case), "height of the floor above the base"),
    }
    for level in ("storey", "floor", "mode", "tendon", "fuse", "restraint"):
        if level in dims:
            values, meaning = known.get(level, ([], ""))
            text = f"number of the {level}" + (", from the ground up" if meaning else "")
            found[level] = ((level,), np.arange(1, sizes[level] + 1), {"long_name": text})
            if values:
                attributes = {"units": "m", "long_name": meaning}
                found[f"{level}_height"] = ((level,), np.array(values), attributes)
    return found


def _event_coordinates(run: results.Run, summary: dict[str, Any]) -> dict[str, Labelled]:
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
