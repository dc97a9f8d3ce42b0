"""Force-displacement loops of the springs in a case: frame, cable, fuses."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

from rwmf._arguments import case_of, checked, dataset_of
from rwmf._numbers import show, to_array, to_items
from rwmf.case import Case, CaseLike
from rwmf.errors import InputError
from rwmf.plotting.style import LEVEL, Panels, legend_above, make_panels, series

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

__all__ = ["Loop", "check_springs", "draw", "find_loops", "group_by_kind", "springs_of"]

Array = npt.NDArray[np.float64]

_COLUMNS = (
    "theta",
    "u_s",
    "frame_force_over_m_s_g",
    "cable_force_over_m_w_g",
    "fuse_left_force_over_m_w_g",
    "fuse_right_force_over_m_w_g",
)
_FUSES = {"left": 1.0, "right": -1.0}
_DISPLACEMENTS = {
    "frame": "$u_s$ (mm)",
    "cable": "elongation (mm)",
    "fuse": "uplift of its corner (mm)",
}


@dataclass(frozen=True)
class Loop:
    """Force of one spring over its displacement.

    Attributes
    ----------
    spring : str
        'frame', 'cable', 'left fuse' or 'right fuse'.
    displacement : numpy.ndarray, shape (n,)
        Displacement of the frame, elongation of the cable, uplift of the fuse's corner [m].
    force : numpy.ndarray, shape (n,)
        Force over the weight of the frame's mass or of the wall [-].
    label : str
        Label of the force, with the weight that it is divided by.
    """

    spring: str
    displacement: Array
    force: Array
    label: str

    @property
    def work(self) -> float:
        """Work done on the spring over the same weight [m], stored energy included."""
        known = np.isfinite(self.force)
        return float(np.trapezoid(self.force[known], self.displacement[known]))


def find_loops(dataset: xr.Dataset, case: CaseLike) -> list[Loop]:
    """Find the springs whose force is in the history.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `rwmf.simulate`, with a history.
    case : Case or path
        The case that was simulated: shape of the wall, law of the cable.

    Returns
    -------
    list of Loop
        Loops of a yielding frame, of the cable and of both fuses.

    Raises
    ------
    InputError
        When there is no history, or when no spring has a force in it.
    """
    case = case_of(case)
    dataset = dataset_of(dataset, "rwmf.simulate")
    if "time" not in dataset.coords:
        raise InputError(
            "dataset: no history: must be the dataset of rwmf.simulate with an interval, "
            "simulate(case, dt=0.01)"
        )
    loops = springs_of({str(name): dataset[name].values for name in dataset}, case)
    if not loops:
        check_springs(case)
        raise InputError("the history holds no force of a spring")
    return loops


def springs_of(columns: Mapping[str, Array], case: CaseLike) -> list[Loop]:
    """Find the springs whose force is among the columns of a history.

    Parameters
    ----------
    columns : mapping of str to numpy.ndarray, each shape (n,)
        Columns by their names in a dataset.
    case : Case or path
        The case that was simulated.

    Returns
    -------
    list of Loop
        As `find_loops`; empty when no column is a force.

    Raises
    ------
    InputError
        When an argument has the wrong type.
    """
    case = case_of(case)
    if not isinstance(columns, Mapping):
        raise InputError(f"columns = {show(columns)}: must be columns of a history by their names")
    columns = {name: to_array(f"columns: {name}", values, is_finite=False)
               for name, values in columns.items() if name in _COLUMNS}  # fmt: skip
    loops = []
    if "frame_force_over_m_s_g" in columns:
        force = columns["frame_force_over_m_s_g"]
        loops.append(Loop("frame", columns["u_s"], force, r"$F_s/(m_s g)$"))
    if "cable_force_over_m_w_g" in columns:
        force = columns["cable_force_over_m_w_g"]
        loops.append(Loop("cable", _elongation(columns["theta"], case), force, r"$P/(m_w g)$"))
    for corner, side in _FUSES.items():
        name = f"fuse_{corner}_force_over_m_w_g"
        if name in columns:
            uplift = _uplift(columns["theta"], case, side)
            loops.append(Loop(f"{corner} fuse", uplift, columns[name], r"$F/(m_w g)$"))
    return loops


def check_springs(case: CaseLike) -> None:
    """Refuse a case without a spring whose force a history can hold.

    Parameters
    ----------
    case : Case or path
        The case.

    Raises
    ------
    InputError
        When it has no such spring; storeys that yield individually report no force.
    """
    case = case_of(case)
    one_by_one = case.yielding is not None and "storey_u_y" in case.yielding
    springs = {"cable", "fuse"} if one_by_one else {"yielding", "cable", "fuse"}
    if not springs & case.groups.keys():
        source = case.source or "the case"
        if one_by_one:
            raise InputError(
                f"{source}: loops need a spring: storeys that yield one by one report no force; "
                "&cable or &fuse would have one"
            )
        raise InputError(f"{source}: loops need a spring: &yielding, &cable or &fuse")


def group_by_kind(loops: Iterable[Loop]) -> dict[str, list[Loop]]:
    """Group the loops by kind of spring.

    Parameters
    ----------
    loops : iterable of Loop
        From `find_loops`.

    Returns
    -------
    dict
        Loops by kind: 'frame', 'cable', 'fuse'.

    Raises
    ------
    InputError
        When an argument has the wrong type.
    """
    found = to_items(loops)
    if found is None or not all(isinstance(loop, Loop) for loop in found):
        raise InputError(f"loops = {show(loops)}: must be the result of find_loops")
    kinds: dict[str, list[Loop]] = {}
    for loop in found:
        kinds.setdefault(loop.spring.split()[-1], []).append(loop)
    return kinds


def _uplift(theta: Array, case: Case, side: float) -> Array:
    """Return the uplift 4b sin(theta/2) of the corner that lifts for this sign of theta [m]."""
    return 4 * float(case.wall.b) * np.sin(np.maximum(0.0, side * theta) / 2)


def _elongation(theta: Array, case: Case) -> Array:
    """Return the elongation since theta = 0 [m]: b |theta| for Eq. (1), else the exact one."""
    h, b = float(case.wall.h), float(case.wall.b)
    phi = theta if case.model.formulation == "published" else np.abs(theta)
    if case.cable.law != "truss":
        return b * phi
    half = np.sin(phi / 2)
    rise = 4 * b * (b * half**2 + h * np.sin(phi))
    elongation: Array = rise / (np.sqrt(4 * h**2 + rise) + 2 * h)
    return elongation


@checked
def draw(dataset: xr.Dataset, case: CaseLike, axes: Axes | Sequence[Axes] | None = None) -> Panels:
    """Draw the loops, a panel for each kind of spring.

    Parameters
    ----------
    dataset : xarray.Dataset
        From `rwmf.simulate`, with a history fine enough to resolve corners.
    case : Case or path
        The case that was simulated.
    axes : matplotlib axes or sequence of axes, optional
        One for each kind of spring (frame, cable, fuses); otherwise a new figure.

    Returns
    -------
    numpy.ndarray, shape (kinds,)
        The axes.

    Raises
    ------
    InputError
        As `find_loops`.
    InputError
        When the numbers of axes and of kinds of springs differ.
    """
    case = case_of(case)
    kinds = group_by_kind(find_loops(dataset, case))
    panels = make_panels(axes, len(kinds), across=True)
    for ax, (kind, found) in zip(panels, kinds.items(), strict=True):
        for i, loop in enumerate(found):
            label = loop.spring if len(found) > 1 else None
            # side by side at equal width: one loop drawn inside another would be unreadable
            line_style = series(i, len(found)) | {"linewidth": 0.9, "label": label}
            ax.plot(1e3 * loop.displacement, loop.force, **line_style)
        ax.axhline(0.0, **LEVEL)
        ax.set_xlabel(_DISPLACEMENTS[kind])
        ax.set_ylabel(found[0].label)
        if len(found) > 1:
            legend_above(ax, len(found))
        else:
            ax.set_title(kind)
    return panels
