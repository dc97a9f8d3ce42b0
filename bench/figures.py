"""Figures of the engine: times over those of versions 0.7.0 and 0.4.0, each beside its limit.

    .venv/bin/python bench/figures.py V070 V040 [ROW ...] [--quick]

V070 and V040 are checkouts of these versions, whose extensions are linked into driver/rwmf. Each
build computes in a separate process with one thread. All times of a scene are measured in turn,
round by round; a time is the smallest processor time of all rounds. An ordinate is a row of a table
of periods from 0.1 to 3 s; a run has neither reactions nor sensitivities. The last column is the
largest error of u_s over rtol, beside `dop853` of 0.7.0 at rtol 1e-13. The exit status is 1 when a
figure exceeds its limit. `--quick` takes few periods and one round.
"""

import argparse
import json
import math
import os
import select
import subprocess
import sys
import time
from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

ROOT = Path(__file__).resolve().parent.parent
HERE, V070, V040 = "here", "0.7.0", "0.4.0"
ROUNDS, LONGEST = 5, 15.0  # rounds of a scene, and time after which no further one begins [s]
QUICK = 8  # of the periods, one
TRUTH = 1e-13  # rtol
Groups = dict[str, Any]

WALL: Groups = {
    "wall": {"h": 2.0, "b": 0.5},
    "frame": {"T_s": 1.0, "gamma": 5.0, "xi_s": 0.05},
    "cable": {"eta_0": 1.0, "eta_alpha": 5.0},
    "impact": {"rule": "constant", "e": 0.9},
    "model": {"formulation": "symmetric"},
    "motion": {
        "kind": "record",
        "file": str(ROOT / "inputs" / "records" / "elcentro.csv"),
        "unit": "g",
    },
}
HEAVY: Groups = {"frame": WALL["frame"] | {"gamma": 1800.0}}
PULSE: Groups = {
    "motion": {"kind": "one_cosine", "a_max_g": 0.4, "T_p": 1.0},
    "model": {"formulation": "published"},
    "solver": {"t_end": 10.0},
}
BILINEAR: Groups = {"u_y": 0.02, "hardening": 0.05}


def _storeys(coupling: str, n: int = 6, **more: Groups | None) -> Groups:
    """Return the groups of a building of equal storeys beside a wall, for 20 s."""
    storeys: Groups = {"n": n, "m_over_m_w": 6 / n, "k_over_m_w": 1000 * n / 6, "height": 18 / n}
    if coupling == "springs":
        storeys["k_link_over_m_w"] = 5000.0
    return {
        "wall": {"h": 9.0, "b": 2.0},
        "frame": {"xi_s": 0.05},
        "storeys": storeys | {"coupling": coupling},
        "cable": None,
        "impact": {"rule": "coupled"},
        "model": {"formulation": "exact"},
        "solver": {"t_end": 20.0},
        **more,
    }


def _bending(modes: int) -> Groups:
    """Return the groups of inputs/storeys_bending.nml."""
    return _storeys(
        "every_floor",
        5,
        wall={"h": 8.0, "b": 2.0},
        storeys={"m_over_m_w": 5 * [1.0], "k_over_m_w": 5 * [500.0], "height": 5 * [3.2],
                 "coupling": "every_floor"},
        bending={"EI_over_m_w": 5e5, "modes": modes, "xi": 0.02},
        cable=WALL["cable"],
        motion={"kind": "one_sine", "a_max_g": 0.5, "T_p": 1.0},
        solver={"t_end": 10.0},
    )  # fmt: skip


# number of ordinates, and groups that differ from WALL; None removes one
SCENES: dict[str, tuple[int, Groups]] = {
    "gamma = 5": (320, {}),
    "gamma = 1800": (320, HEAVY),
    "gamma = 0.5": (320, {"frame": WALL["frame"] | {"gamma": 0.5}}),
    "no cable": (320, {"cable": None}),
    "gamma = 1800, no cable": (320, HEAVY | {"cable": None}),
    "exact, truss": (320, {"model": {"formulation": "exact"},
                           "cable": WALL["cable"] | {"law": "truss"}}),
    "e = 0.98": (320, {"impact": {"rule": "constant", "e": 0.98}}),
    "damper, inerter, vertical": (320, {"damper": {"c_over_m_w": 0.5}, "vertical": {"ratio": 0.5},
                                        "inerter": {"inertance_over_m_w": 0.2}}),
    "link of 5 m": (320, {"link": {"L": 5.0}}),
    "pulse": (320, {"motion": {"kind": "sine", "a_max_g": 0.5, "T_p": 0.6, "cycles": 4},
                    "solver": {"t_end": 8.0}}),
    "frame alone": (320, {"wall": None, "cable": None, "impact": None, "model": None,
                          "frame": {"T_s": 1.0, "xi_s": 0.05}}),
    "yielding frame": (160, {"yielding": BILINEAR}),
    "flag": (160, {"yielding": BILINEAR | {"law": "flag", "flag_height": 0.9}}),
    "fuses": (160, {"fuse": {"eta_y": 0.3, "stroke_y": 0.005, "hardening": 0.02}}),
    "yielding tendon": (160, {"cable": WALL["cable"] | {"eta_y": 1.5, "hardening": 0.02}}),
    "Bouc-Wen": (160, {"yielding": BILINEAR | {"law": "bouc_wen"}}),
    "Fig. 12, cosine": (320, PULSE),
    "Fig. 12, sine": (320, PULSE | {"motion": PULSE["motion"] | {"kind": "one_sine"}}),
    "Fig. 12, gamma = 1000": (320, PULSE | {"frame": WALL["frame"] | {"gamma": 1000.0}}),
    **{f"damper, exponent {a}": (160, {"nl_damper": {"eta_1": 0.1, "exponent": a}})
       for a in (0.3, 0.5, 1.0, 2.0)},
    **{name: (32, _storeys(name)) for name in ("reduced", "every_floor", "full", "springs")},
    "full, yielding": (32, _storeys("full", yielding={"storey_u_y": 0.01, "hardening": 0.05})),
    "full, no wall": (32, _storeys("full", wall=None, impact=None, model=None)),
    "2 modes": (16, _bending(2)),
    "6 modes": (16, _bending(6)),
    **{f"{n} storeys": (16, _storeys("full", n)) for n in (50, 100, 200)},
}  # fmt: skip
SMOOTH = list(SCENES)[:11]
BRANCHES = ("yielding frame", "flag", "fuses", "yielding tendon")
BUILDINGS = ("full", "springs", "every_floor", "full, yielding")
U_S = ("u_s_max_m",)
IDR_PFA = ("storey_drift_max", "floor_acceleration_max_g")
# one key of each kind of quantity
DEMANDS = (
    "theta_dot_max_rad_s", "t_u_s_max_s", *IDR_PFA, "roof_drift_max",
    "storey_1_shear_max_over_m_w_g",
    "overturning_moment_max_over_weight_m", "wall_shear_max_over_m_w_g",
    "base_shear_max_over_weight", "wall_moment_max_over_m_w_g_m", "friction_demand_max",
    "pivot_normal_max_over_m_w_g",
    "tendon_force_max_over_m_w_g", "link_1_force_max_over_m_w_g", "residual_displacement_m",
    "roof_residual_drift", "ductility", "storey_1_ductility", "fuse_stroke_max_m",
    "energy_input_J_per_kg",
)  # fmt: skip


class Time(NamedTuple):
    """A measurement: processor time of an ordinate or run [s]."""

    scene: str
    rtol: float
    build: str = HERE
    method: str = "auto"
    keys: tuple[str, ...] = U_S
    kind: str = "ordinate"


class Figure(NamedTuple):
    """The largest of some times over the smallest of others, and its limit."""

    name: str
    wanted: float
    over: tuple[Time, ...]
    under: tuple[Time, ...]


class Build:
    """A build that computes in a separate process."""

    def __init__(self, folder: Path) -> None:
        self.words = [sys.executable, __file__, "serve"]
        self.environment = os.environ | {"PYTHONPATH": str(folder / "driver"),
                                         "PYTHONHASHSEED": "0"}  # fmt: skip
        self._start()

    def _start(self) -> None:
        self.process = subprocess.Popen(
            self.words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=self.environment,
            text=True,
        )  # fmt: skip

    def ask(self, patience: float = 3600.0, **request: object) -> dict[str, Any]:
        """Return the answer to a request of `_serve`, with `error` when there is none in time [s].

        A process that has ended or does not answer is replaced.
        """
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        print(json.dumps(request), file=self.process.stdin, flush=True)
        is_there = select.select([self.process.stdout], [], [], patience)[0]
        line = self.process.stdout.readline() if is_there else ""
        if line:
            answer: dict[str, Any] = json.loads(line)
            return answer
        self.process.kill()
        status = self.process.wait()
        self._start()
        return {"error": f"ended with {status}" if is_there else f"no answer in {patience:g} s"}


def _serve() -> None:
    """Answer requests, one a line: groups of a case and either keys, a run or rows."""
    import rwmf
    from rwmf.kernel import kernel_case, results

    @cache
    def case_of(groups: str) -> kernel_case.KernelCase:
        return rwmf.Case(**json.loads(groups)).kernel

    for line in sys.stdin:
        request = json.loads(line)
        found: dict[str, Any]
        try:
            scene = case_of(json.dumps(request["groups"]))
            begin = time.process_time()
            if request["kind"] == "keys":
                found = {"keys": scene.applicable()}
            elif request["kind"] == "run":
                with results.start_simulation(scene, ""):
                    found = {"seconds": time.process_time() - begin}
            else:
                keys, table = request["keys"], np.array(request["table"])[:, np.newaxis]
                with results.start_rows(scene, "", ["T_s"], table, keys, 1) as rows:
                    found = {"seconds": (time.process_time() - begin) / len(table)}
                    values = rows.values()
                found |= {key: np.ravel(values[key]).tolist() for key in ["status", *keys]}
        except rwmf.errors.RwmfError as error:
            found = {"error": str(error)}
        print(json.dumps(found), flush=True)


def _groups(scene: str, **solver: object) -> Groups:
    """Return the groups of a scene with a method and a tolerance."""
    groups = {name: keys for name, keys in (WALL | SCENES[scene][1]).items() if keys is not None}
    return groups | {"solver": groups.get("solver", {}) | {"max_steps": 10_000_000} | solver}


class Bench:
    """Three builds and their measurements."""

    def __init__(self, v070: Path, v040: Path, is_quick: bool) -> None:
        self.builds = {HERE: Build(ROOT), V070: Build(v070), V040: Build(v040)}
        self.quick = QUICK if is_quick else 1
        self.best: dict[Time, float] = {}
        self.peaks: dict[Time, list[float]] = {}

    def periods(self, scene: str) -> list[float]:
        """Periods of the ordinates of a scene."""
        n = max(2, SCENES[scene][0] // self.quick)
        return [float(T_s) for T_s in np.linspace(0.1, 3.0, n)]

    def keys(self, scene: str) -> list[str]:
        """Keys of the quantities that a scene has here."""
        found = self.builds[HERE].ask(kind="keys", groups=_groups(scene, rtol=1e-7))
        return [str(key) for key in found["keys"]]

    def measure(self, times: Sequence[Time]) -> None:
        """Measure times of one scene in turn, round by round."""
        begin = time.monotonic()
        for _ in range(1 if self.quick > 1 else ROUNDS):
            for one in times:
                self.best[one] = min(self.best.get(one, math.inf), self._once(one))
            if time.monotonic() - begin > LONGEST:
                break

    def _once(self, one: Time) -> float:
        build, groups = self.builds[one.build], _groups(one.scene, method=one.method, rtol=one.rtol)
        if one.kind == "run":
            groups["output"] = {"reactions": False, "conditioning": False}
            periods = [{}] if "storeys" in groups else [{"T_s": 0.25 + 0.5 * i} for i in range(6)]
            answers = [build.ask(kind="run", groups=groups | {"frame": groups["frame"] | period})
                       for period in periods]  # fmt: skip
        else:
            answers = [build.ask(kind=one.kind, groups=groups, keys=one.keys,
                                 table=self.periods(one.scene))]  # fmt: skip
        for answer in answers:
            if "error" in answer or set(answer.get("status", [])) - {"ok", "overturned"}:
                raise RuntimeError(f"{one}: {answer.get('error', answer.get('status'))}")
        self.peaks[one] = answers[0].get(U_S[0], [])
        return float(np.mean([answer["seconds"] for answer in answers]))

    def error(self, one: Time) -> float:
        """Largest relative error of the ordinates of a time over its rtol."""
        truth = one._replace(build=V070, method="dop853", rtol=TRUTH)
        if truth not in self.peaks:
            self._once(truth)
        pairs = zip(self.peaks[one], self.peaks[truth], strict=True)
        return max(abs(a / b - 1) / one.rtol for a, b in pairs if b > 0)


def _figures(bench: Bench) -> dict[str, list[Figure]]:
    """Return the rows of the table, each with its figures."""

    def over_070(
        name: str,
        wanted: float,
        rtols: Sequence[float] = (1e-7, 1e-9),
        keys: tuple[str, ...] = U_S,
        kind: str = "ordinate",
    ) -> list[Figure]:
        times = [Time(name, rtol, keys=keys, kind=kind) for rtol in rtols]
        return [Figure(f"{name}, {one.rtol:.0e}", wanted, (one,), (one._replace(build=V070),))
                for one in times]  # fmt: skip

    def over_040(name: str, rtol: float, wanted: float, *methods: str) -> Figure:
        one = Time(name, rtol)
        under = tuple(one._replace(build=V040, method=method) for method in methods)
        return Figure(f"{name}, {rtol:.0e}", wanted, (one,), under)

    def demands(name: str) -> list[Figure]:
        u_s, keys = Time(name, 1e-7), bench.keys(name)
        each = tuple(u_s._replace(keys=(key,)) for key in DEMANDS if key in keys)
        every = u_s._replace(keys=tuple(keys))
        return [Figure(f"{name}, any one", 1.4, each, (u_s,)),
                Figure(f"{name}, all", 2.5, (every,), (u_s,))]  # fmt: skip

    def runs(name: str) -> list[Figure]:
        run = Time(name, 1e-7, kind="run")
        return [Figure(f"{name} over ordinate", 5, (run,), (run._replace(kind="ordinate"),)),
                *over_070(name, 0.4, (1e-7,), kind="run")]  # fmt: skip

    pulses = [name for name in SCENES if "Fig. 12" in name]
    corners = [name for name in SCENES if "exponent" in name]
    laws = ("gamma = 5", "damper, inerter, vertical", "link of 5 m", *BRANCHES, "Bouc-Wen",
            "damper, exponent 0.5", "reduced", *BUILDINGS, "full, no wall", "2 modes")  # fmt: skip
    singles = ("gamma = 5", "gamma = 1800", "pulse", "yielding frame")
    bent = [(name, kind) for name in ("2 modes", "6 modes") for kind in ("run", "ordinate")]
    few, many = (Time(f"{n} storeys", 1e-7, kind="run") for n in (50, 200))
    one_rtol = (1e-7,)
    return {
        "smooth": [one for name in SMOOTH for one in over_070(name, 0.6)],
        "fast": [over_040(f"gamma = {gamma}", 1e-7, wanted, "fast")
                 for gamma, wanted in ((5, 2.0), (1800, 3.0))],
        "best": [over_040(name, 1e-9, 1.1, "fast", "dop853")
                 for name in (*SMOOTH, *BRANCHES, "Bouc-Wen") if name != "flag"],
        "pulses": [one for name in pulses for one in over_070(name, 0.4, one_rtol)],
        "branches": [one for name in BRANCHES for one in over_070(name, 0.6)],
        "corners": [*over_070("Bouc-Wen", 0.7),
                    *(one for name in corners for one in over_070(name, 1.0))],
        "demands": [one for name in laws for one in demands(name)],
        "storeys": [one for name in BUILDINGS
                    for one in over_070(name, 0.5, one_rtol, keys=IDR_PFA)],
        "runs": [*(one for name in singles for one in runs(name)),
                 *(one for name in BUILDINGS for one in over_070(name, 0.4, one_rtol, kind="run"))],
        "bending": [one._replace(name=f"{name}, {kind}") for name, kind in bent
                    for one in over_070(name, 0.6, one_rtol, kind=kind)],
        "growth": [Figure("200 storeys over 50", 4**2.1, (many,), (few,)),
                   Figure("200 storeys", 1 / 8.9, (many,), (many._replace(build=V070),))],
    }  # fmt: skip


def _line(bench: Bench, row: str, figure: Figure) -> tuple[str, bool]:
    """Return a line of the table, and whether it exceeds the limit."""
    worst = max(figure.over, key=lambda one: bench.best[one])
    ratio = bench.best[worst] / min(bench.best[one] for one in figure.under)
    is_exceeded = not ratio <= figure.wanted
    name = f"{figure.name} ({worst.keys[0]})" if len(figure.over) > 1 else figure.name
    error = ""
    if worst.kind == "ordinate" and worst.keys == U_S:
        error = f"{bench.error(worst):.2g}"
    mark = "exceeded" if is_exceeded else ""
    return f"| {row} | {name} | {figure.wanted:.3g} | {ratio:.3g} | {mark} | {error} |", is_exceeded


def main() -> int:
    """Print the table; 1 when a figure exceeds its limit."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("v070", type=Path, help="checkout of version 0.7.0")
    parser.add_argument("v040", type=Path, help="checkout of version 0.4.0")
    parser.add_argument("row", nargs="*", help="rows of the table; all without any")
    parser.add_argument("--quick", action="store_true", help="few periods, one round")
    options = parser.parse_args()
    bench = Bench(options.v070, options.v040, options.quick)
    exceeded = 0
    print("| row | figure | wanted | measured | | error over rtol |\n|---|---|---|---|---|---|")
    for row, figures in _figures(bench).items():
        if options.row and row not in options.row:
            continue
        times = dict.fromkeys(one for figure in figures for one in (*figure.over, *figure.under))
        for scene in dict.fromkeys(one.scene for one in times):
            bench.measure([one for one in times if one.scene == scene])
        for figure in figures:
            line, is_exceeded = _line(bench, row, figure)
            print(line, flush=True)
            exceeded += is_exceeded
    print(f"\n{exceeded} figures are exceeded.")
    return int(exceeded > 0)


if __name__ == "__main__":
    if sys.argv[1:] == ["serve"]:
        _serve()
    else:
        sys.exit(main())
