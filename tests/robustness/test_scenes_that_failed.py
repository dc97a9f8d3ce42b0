"""Scenes in which a method once failed or was wrong, from reference/scenes_that_failed.txt.

A heading has the difficulty, the methods (`row` is one of a table, by `dop853`), the tolerances,
the bound of the error over the tolerance with its least value, and the quantities; `peak` is the
number of peaks. The truth is `dop853` at rtol 1e-13. Most scenes were found by
`test_hard_combinations.py` and `bench/accuracy_promise.py`.
"""

from pathlib import Path

import pytest
import rwmf
from bitwise.scenes import Scene, read_scenes
from checkout import ROOT
from rwmf import records

SCENES = read_scenes(ROOT / "tests" / "reference" / "scenes_that_failed.txt")
RUNS = [(scene, method) for scene in SCENES for method in scene.name.split(" -> ")[1].split()]


def _values(case: rwmf.Case, method: str, rtol: float, names: list[str]) -> list[float]:
    if method == "row":
        case = case.replace(solver={"method": "dop853", "rtol": rtol}, output=None)
        found = rwmf.sweep(case, points={"scale": [1.0]}, quantities=names)
        return [found[name].item() for name in names]
    run = rwmf.simulate(case.replace(solver={"method": method, "rtol": rtol}))
    return [
        (run["event"].values == name).sum() if name == "peak" else run[name].item()
        for name in names
    ]


@pytest.mark.parametrize(
    ("scene", "method"), RUNS, ids=lambda x: x if isinstance(x, str) else x.name.split(" ->")[0]
)
def test_every_tolerance_is_kept(
    scene: Scene, method: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for name in ("elcentro", "pacoima"):
        if f"'{name}.csv'" in scene.text:
            records.export(name, f"{name}.csv")
    _, _, rtols, bound, words = scene.name.split(" -> ")
    factor, least = map(float, bound.split())
    names = words.split()
    case = rwmf.Case.from_namelist(scene.put())
    truth = _values(case, "dop853", 1e-13, names)
    for rtol in map(float, rtols.split()):
        found = _values(case, method, rtol, names)
        assert found == pytest.approx(truth, rel=max(factor * rtol, least), abs=0), rtol


def test_storeys_that_do_not_move_yet_cost_little() -> None:
    """The upper ones of nine storeys move by round-off at first: halving for them is bounded."""
    n = 9
    case = rwmf.Case(
        wall={"h": 1.5 * n, "b": 3.0},
        frame={"xi_s": 0.0},
        storeys={"m_over_m_w": [1.0] * n, "k_over_m_w": [3000.0] * n, "height": [3.0] * n}
        | {"coupling": "full"},
        yielding={"storey_u_y": 0.005},
        cable={"eta_0": 5.0, "eta_alpha": 9.0},
        impact={"e": 0.9},
        motion={"kind": "one_sine", "a_max_g": 0.3, "T_p": 1.0},
        solver={"t_end": 0.3, "method": "dop853", "rtol": 1e-7},
    )
    run = rwmf.simulate(case)
    assert run.attrs["rhs_evaluations"] < 1000 * run.attrs["steps"]
