"""Time of a run and of an ordinate with a wall that bends, over those of the rigid wall.

    python bench/bending_times.py [--repeat N]
    python bench/bending_times.py --suite [--levels N] [--modes N ...]

The building of inputs/storeys_bending.nml, without reactions, rigid and with 1 to 6 modes: one run,
and ordinates of a spectrum in lanes, one thread. Times are the fastest of N, measured in turn.

With --suite: the building of validation/six_storeys_wall.nml, with a wall of 30 GPa. It runs under
the 44 records of FEMA P-695 (far field, `pip install '.[suites]'`) at N levels, rigid and with
modes.
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
SUITE = Path(__file__).resolve().parents[1] / "validation" / "six_storeys_wall.nml"
ASKED = ("storey_drift_max", "floor_acceleration_max_g", "wall_moment_max_over_m_w_g",
         "wall_shear_base_max_over_m_w_g", "link_1_force_max_over_m_w_g")  # fmt: skip
MODES = (0, 1, 2, 3, 4, 6)
PERIODS = np.linspace(0.5, 2.0, 32)


def _case(modes: int) -> rwmf.Case:
    case = rwmf.Case.from_namelist(CASE).without("spectrum")
    return case.replace(bending={"modes": modes}) if modes else case.without("bending")


def _seconds(call: Callable[[], object]) -> float:
    begin = time.perf_counter()
    call()
    return time.perf_counter() - begin


def _suite(levels: int, modes: list[int]) -> None:
    """Print the cost of a suite of records at several levels."""
    scale = np.linspace(0.2, 4.0, levels)
    print("| modes | runs | not completed | processor time [s] | of a run [ms] |")
    print("|---|---|---|---|---|")
    for n in modes:
        case = rwmf.Case.from_namelist(SUITE).replace(solver={"t_end": None, "rtol": None})
        case = case.replace(bending={"E": 30e9, "modes": n}) if n else case
        begin = time.process_time()
        found = rwmf.sweep(
            case, grid={"scale": scale}, records=["fema:far_field"], quantities=ASKED
        )
        seconds = time.process_time() - begin
        runs, failed = found.status.size, int((found.status != 0).sum())
        cost = f"{seconds:.0f} | {1e3 * seconds / runs:.1f}"
        print(f"| {n or 'rigid'} | {runs} | {failed} | {cost} |", flush=True)


def _main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--repeat", type=int, default=5, metavar="N", help="measurements of each")
    parser.add_argument("--suite", action="store_true", help="44 records at several levels")
    parser.add_argument("--levels", type=int, default=20, metavar="N", help="levels of the suite")
    parser.add_argument("--modes", type=int, nargs="+", default=[0, 3], metavar="N",
                        help="numbers of modes of the suite, 0: rigid")  # fmt: skip
    given = parser.parse_args()
    if given.suite:
        _suite(given.levels, given.modes)
        return
    repeat = given.repeat
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
