"""Time of an ordinate in this build and in another one, side by side.

    .venv/bin/python bench/ordinates.py OTHER [SCENE ...]

OTHER is the checkout of the other build, whose extension is linked into its folder driver/rwmf.
Both builds compute the same spectra in turn, one thread, and the smallest of ROUNDS counts. The
time of an ordinate excludes the overhead of a call. Spectra of 500 and 100 periods from 0.1 to 3 s
differ by 400 ordinates; their times give the cost of one. Methods: here `auto`, there `fast` and
`dop853`, its general lanes. Errors are those of 500 ordinates against `dop853` of the other build
at rtol 1e-13. The last column is the time of a single run over that of an ordinate of this build.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parent.parent
RECORD = ROOT / "inputs" / "records" / "elcentro.csv"
ROUNDS = 5
PERIODS = (100, 500)
RTOLS = (1e-7, 1e-9)
WALL: dict[str, Any] = {
    "wall": {"h": 2.0, "b": 0.5},
    "frame": {"gamma": 5.0, "xi_s": 0.05},
    "cable": {"eta_0": 1.0, "eta_alpha": 5.0},
    "impact": {"rule": "constant", "e": 0.9},
    "model": {"formulation": "symmetric"},
    "motion": {"kind": "record", "file": str(RECORD), "unit": "g"},
}
DEVICES: dict[str, Any] = {
    "damper": {"c_over_m_w": 0.5},
    "inerter": {"inertance_over_m_w": 0.2},
    "vertical": {"ratio": 0.5},
}
PULSE: dict[str, Any] = {"kind": "sine", "a_max_g": 0.5, "T_p": 0.6, "cycles": 4}
# groups that differ from WALL; None removes one
SCENES: dict[str, dict[str, Any]] = {
    "gamma = 5": {},
    "gamma = 1800": {"frame": {"gamma": 1800.0, "xi_s": 0.05}},
    "gamma = 0.5": {"frame": {"gamma": 0.5, "xi_s": 0.05}},
    "no cable": {"cable": None},
    "gamma = 1800, no cable": {"frame": {"gamma": 1800.0, "xi_s": 0.05}, "cable": None},
    "exact, truss": {
        "model": {"formulation": "exact"},
        "cable": {"eta_0": 1.0, "eta_alpha": 5.0, "law": "truss"},
    },
    "e = 0.98": {"impact": {"rule": "constant", "e": 0.98}},
    "damper, inerter, vertical": DEVICES,
    "link of 5 m": {"link": {"L": 5.0}},
    "pulse": {"motion": PULSE, "solver": {"t_end": 8.0}},
    "frame alone": {"wall": None, "cable": None, "impact": None, "model": None,
                    "frame": {"xi_s": 0.05}},
    "yielding frame": {"yielding": {"u_y": 0.02, "hardening": 0.05}},
    "Bouc-Wen": {"yielding": {"u_y": 0.02, "hardening": 0.05, "law": "bouc_wen"}},
    "fuses": {"fuse": {"eta_y": 0.3, "stroke_y": 0.005, "hardening": 0.02}},
    "yielding tendon": {
        "cable": {"eta_0": 1.0, "eta_alpha": 5.0, "eta_y": 1.5, "hardening": 0.02}
    },
}  # fmt: skip


def _serve() -> None:
    """Answer requests, one a line: groups, method, rtol and repeats to times and ordinates."""
    import numpy as np
    import rwmf

    for line in sys.stdin:
        groups, method, rtol, runs = json.loads(line)
        changed = {name: group for name, group in {**WALL, **groups}.items() if group is not None}
        changed["frame"] = {"T_s": 1.0, **changed["frame"]}
        changed["solver"] = changed.get("solver", {}) | {"method": method, "rtol": rtol}
        case = rwmf.Case(**changed)
        answer: dict[str, Any] = {}
        if runs:
            ones = [case.replace(frame={"T_s": float(T_s)}) for T_s in np.linspace(0.2, 3.0, 10)]
            answer["seconds"] = [
                float(np.mean([rwmf.simulate(one).attrs["seconds"] for one in ones]))
            ]
        else:
            answer["seconds"] = []
            for n in PERIODS:
                T_s = np.linspace(0.1, 3.0, n)
                started = time.process_time()
                found = rwmf.spectrum(case, T_s=T_s, threads=1)
                answer["seconds"].append(time.process_time() - started)
            answer["peaks"] = [float(one) for one in found.u_s_max.values.ravel()]
        print(json.dumps(answer), flush=True)


class Build:
    """A build that computes in a separate process."""

    def __init__(self, folder: Path) -> None:
        self.process = subprocess.Popen(
            [sys.executable, __file__, "serve"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            env=os.environ | {"PYTHONPATH": str(folder / "driver")},
            text=True,
        )

    def ask(
        self, groups: dict[str, Any], method: str, rtol: float, runs: bool = False
    ) -> dict[str, Any]:
        """Compute two spectra, or some of their ordinates as single runs."""
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        print(json.dumps([groups, method, rtol, runs]), file=self.process.stdin, flush=True)
        answer: dict[str, Any] = json.loads(self.process.stdout.readline())
        return answer


def _us(answers: list[dict[str, Any]]) -> float:
    """Time of an ordinate [us]."""
    few, many = (min(one["seconds"][i] for one in answers) for i in range(2))
    return 1e6 * (many - few) / (PERIODS[1] - PERIODS[0])


def _error(answer: dict[str, Any], truth: list[float]) -> float:
    """Largest relative error of the ordinates."""
    pairs = zip(answer["peaks"], truth, strict=True)
    return max((abs(a / b - 1) for a, b in pairs if b > 0), default=0.0)


def _rows(here: Build, there: Build, names: list[str]) -> Iterator[str]:
    """Measure and yield the lines of the table."""
    for name in names:
        groups = SCENES[name]
        truth = there.ask(groups, "dop853", 1e-13)["peaks"]
        run = min(here.ask(groups, "auto", RTOLS[0], runs=True)["seconds"][0] for _ in range(2))
        for rtol in RTOLS:
            builds = ((here, "auto"), (there, "fast"), (there, "dop853"))
            found = [[build.ask(groups, method, rtol) for _ in range(ROUNDS)]
                     for build, method in builds]  # fmt: skip
            us = [_us(answers) for answers in found]
            errors = [_error(answers[0], truth) for answers in found]
            yield (
                f"| {name} | {rtol:.0e} | {us[0]:.0f} | {us[1]:.0f} | {us[2]:.0f} "
                f"| {us[0] / us[1]:.2f} | {us[0] / us[2]:.2f} | {errors[0]:.0e} | {errors[1]:.0e} "
                f"| {1e6 * run / us[0]:.1f} |"
            )


def main(other: str, *names: str) -> None:
    """Print the table."""
    print("| scene | rtol | us an ordinate | there, fast | there, dop853 | over fast | over dop853 "
          "| error | error of fast | run over ordinate |")  # fmt: skip
    print("|---|---|---|---|---|---|---|---|---|---|")
    for row in _rows(Build(ROOT), Build(Path(other)), list(names) or list(SCENES)):
        print(row, flush=True)


if __name__ == "__main__":
    if sys.argv[1:] == ["serve"]:
        _serve()
    else:
        main(*sys.argv[1:])
