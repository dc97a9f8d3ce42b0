"""Time of a run and of an ordinate with a wall that bends, over those of the rigid wall.

    python bench/bending_times.py [--repeat N]

The building of inputs/storeys_bending.nml, without reactions, rigid and with 1 to 6 modes: one run,
and ordinates of a spectrum in lanes, one thread. Times are the fastest of N, measured in turn.
"""

from __future__ import annotations

import argparse
import math
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import rwmf

CASE = Path(__file__).resolve().parents[1] / "inputs" / "storeys_bending.nml"
MODES = (0, 1, 2, 3, 4, 6)
PERIODS = np.linspace(0.5, 2.0, 32)


def _case(modes: int) -> rwmf.Case:
    case = rwmf.Case.from_namelist(CASE).without("spectrum")
    return case.replace(bending={"modes": modes}) if modes else case.without("bending")


def _seconds(call: Callable[[], object]) -> float:
    begin = time.perf_counter()
    call()
    return time.perf_counter() - begin


def _main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeat", type=int, default=5, metavar="N", help="measurements of each")
    repeat = parser.parse_args().repeat
    cases = {modes: _case(modes) for modes in MODES}
    best = {modes: [math.inf, math.inf] for modes in MODES}
    steps = {}
    for _ in range(repeat):
        for modes, case in cases.items():
            run = rwmf.simulate(case)
            steps[modes] = int(run.flat()["steps"])

            def spectrum(case: rwmf.Case = case) -> object:
                return rwmf.spectrum(case, T_s=PERIODS, quantities=("u_s_max",), threads=1)

            best[modes][0] = min(best[modes][0], _seconds(lambda c=case: rwmf.simulate(c)))
            best[modes][1] = min(best[modes][1], _seconds(spectrum) / PERIODS.size)
    print("| modes | steps of a run | run over rigid | ordinate [us] | ordinate over rigid |")
    print("|---|---|---|---|---|")
    for modes, (run, ordinate) in best.items():
        ratios = run / best[0][0], ordinate / best[0][1]
        name = str(modes) if modes else "rigid"
        print(f"| {name} | {steps[modes]} | {ratios[0]:.1f} | {ordinate * 1e6:.0f} "
              f"| {ratios[1]:.1f} |")  # fmt: skip


if __name__ == "__main__":
    _main()
