"""Force-displacement loops of the springs in a case: frame or storeys, cable, fuses."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from rwmf.case import Case, CaseLike
from rwmf.case.arguments import case_of, checked
from rwmf.case.elements import heights_of_storeys
from rwmf.errors import InputError
from rwmf.figures.styles import LEVEL, Panels, make_panels, series, storey
from rwmf.kernel.numbers import Array, grouped, show, to_array, to_items
from rwmf.run.arguments import dataset_of

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

__all__ = ["Loop", "draw", "find_loops"]


# title of a panel and label of its displacement
_PANELS = {
    "frame": ("Frame", "displacement $u_s$ (mm)"),
    "storey": ("Storeys", "storey drift (mm)"),
    "cable": ("Tendon", "elongation (mm)"),
    "fuse": ("Fuses", "stroke (mm)"),
    "coupling": ("Couplings", "stroke (mm)"),
    "restraint": ("Restraints", "stroke (mm)"),
}


@dataclass(frozen=True)
class Loop:
    """Force of one spring over its displacement.

    Attributes
    ----------
    spring : str
        'frame', 'storey 1' and so on, 'cable', 'left fuse', 'right fuse', 'coupling', or group and
        number of an element with an `offset`.
    displacement : numpy.ndarray, shape (n,)
        Displacement of the frame, drift of the storey, stroke of a vertical element [m].
    force : numpy.ndarray, shape (n,)
        Force over the weight of the frame's mass or of the wall [-].
    label : str
        Label of the force, with the weight that it is divided by.
    newtons : numpy.ndarray, shape (n,), optional
        The force [N]; None for a case without masses.
    """

    spring: str
    displacement: Array
    force: Array
    label: str
    newtons: Array | None = None

    @property
    def kind(self) -> str:
        """Kind of spring: 'frame', 'storey', 'cable' or 'fuse'."""
        return next(kind for kind in _PANELS if kind in self.spring)

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
        Loops of a yielding frame or of its yielding storeys, of the cable and of both fuses.

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
    columns = {str(name): dataset[name].values for name in dataset if "time" in dataset[name].dims}
    for i in range(len(_heights_of_yielding(case))):
        for part in ("drift", "shear_over_m_w_g", "shear"):
            if (name := f"storey_{i + 1}_{part}") in dataset:
                columns[name] = dataset[name].values
    loops = springs_of(columns, case)
    if not loops:
        check_springs(case)
        raise InputError(
            "the history holds no force of a spring; those of storeys need &output reactions"
        )
    return loops


def springs_of(columns: Mapping[str, Array], case: CaseLike) -> list[Loop]:
    """Find the springs whose force is among the columns of a history."""
    case = case_of(case)
    if not isinstance(columns, Mapping):
        raise InputError(f"columns = {show(columns)}: must be columns of a history by their names")
    loops = []
    for spring, (name, label, displacement) in _springs(case).items():
        if name in columns:
            ratio, newtons = f"columns: {name}", name.rsplit("_over_", 1)[0]
            moved = displacement(_Columns(columns))
            force = to_array(ratio, columns[name], is_finite=False)
            in_newtons = None
            if newtons in columns:
                in_newtons = to_array(f"columns: {newtons}", columns[newtons], is_finite=False)
            loops.append(Loop(spring, moved, force, label, in_newtons))
    return loops


class _Columns:
    """Columns of a history, checked at their use."""

    def __init__(self, columns: Mapping[str, Array]) -> None:
        self._columns = columns

    def __getitem__(self, name: str) -> Array:
        if name not in self._columns:
            raise InputError(f"columns: has no {name}: must be columns of a history by their names")
        return to_array(f"columns: {name}", self._columns[name], is_finite=False)


_Spring = tuple[str, str, Callable[[_Columns], Array]]


def _springs(case: Case) -> dict[str, _Spring]:
    """Return force column, label and displacement of each spring that a case may have."""
    found: dict[str, _Spring] = {
        "frame": ("frame_force_over_m_s_g", r"$F_s/(m_s g)$", lambda columns: columns["u_s"])
    }
    for i, height in enumerate(_heights_of_yielding(case), 1):
        found[f"storey {i}"] = (
            f"storey_{i}_shear_over_m_w_g",
            r"$V/(m_w g)$",
            partial(_sway, height=height, name=f"storey_{i}_drift"),
        )
    if case.wall is None:
        return found
    for group in ("cable", "fuse", "coupling", "restraint"):
        for name, column, i in _elements(case, group):
            found[name] = (
                f"{column}_force_over_m_w_g",
                r"$P/(m_w g)$" if group == "cable" else r"$F/(m_w g)$",
                partial(_stroke, case=case, group=group, i=i),
            )
    return found


def _heights_of_yielding(case: Case) -> list[float]:
    """Return the heights of storeys that yield one by one."""
    if case.storeys is None or case.yielding is None or "storey_u_y" not in case.yielding:
        return []
    return heights_of_storeys(case)


def check_springs(case: CaseLike) -> None:
    """Refuse a case without a spring whose force a history can hold."""
    case = case_of(case)
    if not {"yielding", "cable", "fuse", "coupling", "restraint"} & case.groups.keys():
        source = case.source or "the case"
        raise InputError(
            f"{source}: loops need a spring: &yielding, &cable, &fuse, &coupling or &restraint"
        )


def group_by_kind(loops: Iterable[Loop]) -> dict[str, list[Loop]]:
    """Group the loops by kind of spring."""
    found = to_items(loops)
    if found is None or not all(isinstance(loop, Loop) for loop in found):
        raise InputError(f"loops = {show(loops)}: must be the result of find_loops")
    return grouped(found, lambda loop: loop.kind)


def _sway(columns: _Columns, height: float, name: str) -> Array:
    """Return the relative displacement of the floors of a storey [m]."""
    return height * columns[name]


def _elements(case: Case, group: str) -> list[tuple[str, str, int]]:
    """Return name, column without its ending, and number of each element of a group."""
    given = getattr(case, group)
    if given is None:
        return []
    if "offset" not in given:
        corners = ("left", "right")
        if group == "fuse":
            return [(f"{corner} fuse", f"fuse_{corner}", i) for i, corner in enumerate(corners)]
        return [(group, group, 0)]
    n = len(given.offset)
    return [(f"{group} {i + 1}", f"{group}_{i + 1}", i) for i in range(n)]


def _stroke(columns: _Columns, case: Case, group: str, i: int) -> Array:
    """Return the stroke of an element since theta = 0 (docs/theory/elements.md) [m]."""
    given, theta = getattr(case, group), columns["theta"]
    h, b = float(case.wall.h), float(case.wall.b)
    phi = np.abs(theta)
    if group == "coupling":
        return (2 * b + float(given.span)) * np.sin(theta)
    corners = (-b, b) if group == "fuse" else (0.0,)
    arm = b - np.where(theta < 0, -1.0, 1.0) * given.get("offset", corners)[i]
    half = np.sin(phi / 2)
    if group == "fuse":
        return np.asarray(2 * arm * half)
    height = np.atleast_1d(given.get("height", 2 * h))
    z = float(height[i if height.size > 1 else 0])
    if group == "restraint":
        return np.asarray(arm * np.sin(phi) - 2 * z * half**2)
    if given.law != "truss":
        return np.asarray(arm * (theta if case.model.formulation == "published" else phi))
    rise = 2 * arm * (2 * arm * half**2 + z * np.sin(phi))
    return np.asarray(rise / (np.sqrt(z**2 + rise) + z))


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
        One for each kind of spring (frame or storeys, cable, fuses); otherwise a new figure.

    Returns
    -------
    numpy.ndarray, shape (kinds,)
        The axes. Forces are in kN where masses are known, otherwise over a weight.

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
            label = loop.spring.replace(kind, "").strip() if len(found) > 1 else None
            # side by side at equal width: one loop drawn inside another would be unreadable
            line = storey(i, len(found)) if kind == "storey" else series(i, len(found))
            force = loop.force if loop.newtons is None else 1e-3 * loop.newtons
            ax.plot(1e3 * loop.displacement, force, **line | {"linewidth": 0.9, "label": label})
        ax.axhline(0.0, **LEVEL)
        title, displacement = _PANELS[kind]
        force_label = found[0].label if found[0].newtons is None else "force (kN)"
        ax.set(title=title, xlabel=displacement, ylabel=force_label)
        if len(found) > 1:
            # full columns, at most five
            columns = math.ceil(len(found) / math.ceil(len(found) / 5))
            ax.legend(
                title=kind, ncols=columns, loc="upper center", bbox_to_anchor=(0.5, -0.18),
                handlelength=1.2, columnspacing=0.8, handletextpad=0.4,
            )  # fmt: skip
    return panels
