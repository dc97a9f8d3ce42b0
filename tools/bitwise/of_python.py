"""Rows of the Python package: runs, spectra, loops, quadruple precision."""

from __future__ import annotations

import importlib
import sys
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import rwmf

from bitwise import scenes
from bitwise.dump import dump_dataset, dump_value
from bitwise.rows import Row
from bitwise.scenes import Scene

# every so many of the scenes are run from Python too; the batch program runs all
_SOME, _QUICK = 4, 20
_LOOPS = ("tendon-yields", "fuses", "bare-yields", "everything", "published")
# short runs: quadruple precision is a hundred times as slow
_QUAD = (
    "block",
    "coupled",
    "bare-bouc-wen",
    "storeys-full",
    "everything",
    "vertical-record",
    "overturns",
    "housner",
    "pushed",
    "tendon-breaks",
)
_QUAD_END = 1.0  # end of those runs [s]
_QUAD_RTOL = (1e-18, 1e-20)


def rows() -> Iterator[Row]:
    """List the rows of the Python package, but for sweeps and studies."""
    every = scenes.read_scenes()
    by_name = {scene.name.removeprefix("special-"): scene for scene in every}
    for i, scene in enumerate(every):
        if scene.has_spectrum:
            yield from _of_spectrum(scene, is_quick=i % _SOME == 0)
        elif i % _SOME == 0 or scene.has_accuracy:
            key = f"python/simulate/{scene.name}"
            yield Row(key, partial(simulate, scene), i % _QUICK == 0)
    for name in _LOOPS:
        yield Row(f"python/loops/{name}", partial(find_loops, by_name[name]))
    for i, name in enumerate(_QUAD):
        ask = partial(solve_in_quadruple, by_name[name])
        yield Row(f"python/quadruple/{name}", ask, i < 3)
    for name in ("block", "coupled"):
        yield Row(f"python/cost/{name}", partial(measure_cost, by_name[name]), False)


def _of_spectrum(scene: Scene, *, is_quick: bool) -> Iterator[Row]:
    for method in ("auto", "dop853"):
        for threads in (1, 2):
            key = f"python/spectrum/{scene.name}/{method}/threads-{threads}"
            yield Row(key, partial(spectrum, scene, method, threads), is_quick)


def simulate(scene: Scene) -> str:
    """Run a scene."""
    return _answer_of(scene, lambda case: dump_dataset(rwmf.simulate(case, dt=0.025)))


def spectrum(scene: Scene, method: str, threads: int) -> str:
    """Compute a spectrum, once as the scene asks and once on a grid of the call."""

    def compute(case: rwmf.Case) -> str:
        case = case.replace(solver={"method": method})
        grid: dict[str, Any] = {"T_s": [0.3, 0.9, 1.7]}
        if case.wall and not case.storeys:
            grid |= {"gamma": [3.0, 300.0], "b": [0.45, 0.55]}
        given = rwmf.spectrum(case, threads=threads)
        return dump_dataset(given) + dump_dataset(rwmf.spectrum(case, **grid, threads=threads))

    return _answer_of(scene, compute)


def find_loops(scene: Scene) -> str:
    """Find the loops of a scene's springs."""

    def find(case: rwmf.Case) -> str:
        parts = []
        for loop in rwmf.plot.find_loops(rwmf.simulate(case, dt=0.01), case):
            parts.append(dump_value(loop.work))
            parts += [dump_value(loop.displacement), dump_value(loop.force)]
        return "\n".join(parts) + "\n"

    return _answer_of(scene, find)


def measure_cost(scene: Scene) -> str:
    """Return the result of `rwmf.cost` without times and results that depend on them."""

    def measure(case: rwmf.Case) -> str:
        found = rwmf.cost(_shortened(case)).to_dict()
        parts = [dump_value(found["reference"])]
        parts += [dump_value(row) for row in (*found["rows"], *found["practices"])]
        return "\n".join(parts) + "\n"

    return _answer_of(scene, measure)


def solve_in_quadruple(scene: Scene) -> str:
    """Run a scene in quadruple precision."""

    def solve(case: rwmf.Case) -> str:
        case = _shortened(case)
        found = _private_reference()(case, *_QUAD_RTOL)
        return dump_value(vars(found)) + "\n"

    return _answer_of(scene, solve)


def _private_reference() -> Callable[..., object]:
    """Find the reference in quadruple precision: the only private name that the digest uses.

    `rwmf.cost` is public but takes seconds for its other measurements. The module is found by its
    contents, so that it may move.
    """
    name = "solve_reference"
    # the package imports its modules when they are first used
    importlib.import_module(rwmf.cost.__module__)
    holders = [m for key, m in sorted(sys.modules.items()) if key.startswith("rwmf.")]
    found: Callable[..., object]
    found = next(getattr(module, name) for module in holders if hasattr(module, name))
    return found


def _shortened(case: rwmf.Case) -> rwmf.Case:
    return case.replace(solver={"t_end": _QUAD_END})


def _answer_of(scene: Scene, question: Callable[[rwmf.Case], str]) -> str:
    """Answer to a question about a scene; the type of an error is an answer too."""
    try:
        return question(rwmf.Case.from_namelist(scene.put()))
    except rwmf.RwmfError as error:
        return f"{type(error).__name__}\n"
