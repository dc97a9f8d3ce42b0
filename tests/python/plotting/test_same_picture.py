"""A case in ratios and the same case in kg, N and Pa give the same figures, films and studies."""

from __future__ import annotations

import base64
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import rwmf
from dimensional import in_both

pytest.importorskip("matplotlib")

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from rwmf.explorer.model import Model
from rwmf.explorer.questions import given, read
from rwmf.figures import loops
from rwmf.figures.film import Scale, _stage, find_building
from rwmf.figures.styles import new_figure
from rwmf.run.quantities import find

Drawing = Callable[[rwmf.Case, Figure], object]
_SHORT: dict[str, Any] = {"output": {"dt": 0.02, "reactions": True}, "solver": {"t_end": 3.0}}


def _own_period(case: rwmf.Case) -> dict[str, Any]:
    """At another period a force and a displacement at first yield are two strengths."""
    return {"T_s": [case.kernel.axes()["T_s"].value]}


def _history(case: rwmf.Case, figure: Figure) -> None:
    run = rwmf.simulate(case)
    names = rwmf.figures.histories.panels_of(run)
    rwmf.plot.history(run, figure.subplots(len(names)), names, case=case)


def _profile(case: rwmf.Case, figure: Figure) -> None:
    run = rwmf.simulate(case)
    n = len(rwmf.figures.profiles.demands_of(run))
    # without a wall ratios are over no mass, and no shear is in N
    if n and case.wall is not None:
        rwmf.plot.profile(run, figure.subplots(1, n), case=case)


def _loops(case: rwmf.Case, figure: Figure) -> None:
    run = rwmf.simulate(case)
    # a mass makes kilonewtons of ratios
    run = run.drop_vars([name for name in run if run[name].attrs.get("units") == "N"])
    if {"yielding", "cable", "fuse"} & case.groups.keys():
        n = len(loops.group_by_kind(rwmf.plot.find_loops(run, case)))
        rwmf.plot.loops(run, case, figure.subplots(1, n, squeeze=False)[0])


def _film(case: rwmf.Case, figure: Figure) -> None:
    """Draw the last picture, with all storeys that have yielded."""
    run = rwmf.simulate(case)
    building = find_building(case, run)
    _stage(figure, case, run, building, Scale(1.0, 1.0))(run.sizes["time"] - 1)


def _spectrum(case: rwmf.Case, figure: Figure) -> None:
    if "T_s" in case.kernel.axes():
        rwmf.plot.spectrum(rwmf.spectrum(case, **_own_period(case)), figure.subplots())


def _wall_effect(case: rwmf.Case, figure: Figure) -> None:
    if case.frame is not None and case.wall is not None:
        found = rwmf.studies.wall_effect(case, _own_period(case))
        rwmf.plot.wall_effect(found, figure.subplots())


def _motion(size: float = 3.0) -> rwmf.Motion:
    t = np.arange(0.0, 2.0, 0.02)
    samples = size * np.sin(6.0 * t) * np.sin(1.57 * t)
    return rwmf.Motion(samples, dt=0.02, unit="m/s2", name=f"{size:g}")


def _fragility(case: rwmf.Case, figure: Figure) -> None:
    if "T_s" in case.kernel.axes():
        quantity = find(case.kernel.default_quantity()).name
        records = [_motion(), _motion(-2.0)]
        found = rwmf.stripes(case, records, [0.1, 0.2, 0.4], quantity)
        # mirrored records have equal responses: round-off would decide at the median itself
        above = 1.1 * float(found[quantity].median())
        rwmf.plot.fragility(rwmf.fragility(found, above, resamples=0), figure.subplots())


def _equal_response(case: rwmf.Case, figure: Figure) -> None:
    if "T_s" in case.kernel.axes():
        target = 0.02 if case.frame is not None else 0.1
        found = rwmf.studies.equal_response(case, [0.5, 1.0], target, tolerance=1e-4)
        rwmf.plot.equal_response(found, figure.subplots())


def _overturning(case: rwmf.Case, figure: Figure) -> None:
    if case.frame is None:
        found = rwmf.studies.overturning_map(case, [5.0, 6.0], [1.0, 9.0], tolerance=0.1)
        rwmf.plot.overturning_map(found, figure.subplots())


def _explorer(case: rwmf.Case, figure: Figure) -> None:
    """Draw the arrays that the page draws: columns, loops, spectrum with and without the wall."""
    model = Model(case, Path("/proc/nowhere"))
    question = read({"groups": given(case), "points": 2})
    answer = model.history(question, lambda _: None)
    curves = dict(answer["columns"])
    for loop in answer["loops"]:
        for key in ("displacement", "force"):
            values = np.frombuffer(base64.b64decode(loop[key]), "<f4")
            if loop["kind"] == "frame" and key == "force":
                # a mass makes kilonewtons of ratios
                values = values / np.abs(values).max()
            curves[f"{loop['spring']} {key}"] = base64.b64encode(values.tobytes()).decode()
    if "T_s" in case.kernel.axes():
        (own,) = _own_period(case)["T_s"]
        own = case.replace(spectrum={"T_s": [own, 2 * own]})
        found = model.spectrum(read({"groups": given(own), "points": 2}), lambda _: None)
        # at other periods units are other strengths
        curves |= {name: found[name] for name in ("T", "values", "alone") if found[name]}
    ax = figure.subplots()
    ax.set_title(" ".join(curves))
    for name, packed in curves.items():
        values = np.frombuffer(base64.b64decode(packed), "<f4").astype(float)
        ax.plot(values[:1] if name in ("T", "values", "alone") else values)


DRAWINGS = (
    _fragility,
    _equal_response,
    _overturning,
    _explorer,
    _history,
    _profile,
    _loops,
    _film,
    _spectrum,
    _wall_effect,
)


def _texts(ax: Axes) -> Iterator[str]:
    yield from (ax.get_xlabel(), ax.get_ylabel(), ax.get_title())
    yield from (text.get_text() for text in ax.texts)
    for child in ax.get_children():
        if isinstance(child, Legend):
            yield from (text.get_text() for text in child.get_texts())


def _drawn(figure: Figure) -> tuple[list[str], list[np.ndarray], list[str]]:
    """Texts, coordinates and colours of all that is drawn."""
    texts = [text for ax in figure.axes for text in _texts(ax)]
    numbers: list[np.ndarray] = []
    looks: list[str] = []
    for ax in figure.axes:
        for line in ax.lines:
            numbers.append(np.asarray(line.get_xydata(), dtype=float))
            looks.append(f"{line.get_color()} {line.get_linestyle()} {line.get_marker()}")
        for patch in ax.patches:
            numbers.append(np.asarray(patch.get_path().vertices, dtype=float))
        for found in ax.collections:
            numbers += [path.vertices for path in found.get_paths()]
    return texts, numbers, looks


@pytest.mark.parametrize("scene", ["block", "corners", "storeys p_delta"])
@pytest.mark.parametrize("drawing", DRAWINGS, ids=lambda drawing: drawing.__name__.strip("_"))
def test_units_do_not_change_the_picture(drawing: Drawing, scene: str) -> None:
    found = []
    for case in in_both(scene):
        with new_figure(4.0) as figure:
            drawing(case.replace(**_SHORT), figure)
            found.append(_drawn(figure))
    (texts, numbers, looks), (texts_si, numbers_si, looks_si) = found
    assert (texts, looks) == (texts_si, looks_si)
    assert len(numbers) == len(numbers_si)
    for ours, theirs in zip(numbers, numbers_si, strict=True):
        # the tolerance of the runs, over the largest number of the line
        size = np.nanmax(np.abs(ours), initial=0.0)
        np.testing.assert_allclose(theirs, ours, rtol=1e-6, atol=1e-6 * size)


def test_prestress_in_newtons_follows_every_axis() -> None:
    """The largest cable force of a study is that of a run, for each stress and width."""
    ratios, units = in_both("corners")
    del ratios
    stress = float(units.cable.initial_stress)
    grid = {"T_s": [0.8], "initial_stress": [0.5 * stress, stress], "b": [1.8, 2.0]}
    name = "tendon_force_max_over_m_w_g"
    found = rwmf.sweep(units, grid, quantities=name)[name].squeeze()
    for i, share in enumerate((0.5, 1.0)):
        for k, b in enumerate((1.8, 2.0)):
            changed = units.replace(
                cable={"initial_stress": share * stress}, wall={"b": b}, output={"dt": 2e-3}
            )
            run = rwmf.simulate(changed)
            force = float(run["cable_force_over_m_w_g"].max())
            at = found.isel(initial_stress=i).sel(b=b)
            assert float(at) == pytest.approx(force, rel=1e-4), (share, b, k)
