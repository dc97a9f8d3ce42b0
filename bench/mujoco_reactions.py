"""Comparison of base reactions with the contact forces of MuJoCo, an independent program.

``python bench/mujoco_reactions.py [CASE ...]`` simulates ``validation/CASE.nml`` with both and
prints a table. Needs ``pip install '.[validation]'``. The engine's contact is a stiff spring and
damper: forces are averaged over windows. Windows at an impact or a jump of the motion are omitted.
The engine spreads an impulse or a sudden force over some time.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import mujoco
import mujoco_cases
import numpy as np
import numpy.typing as npt
import rwmf

Array = npt.NDArray[np.float64]

ROOT = Path(__file__).resolve().parents[1]
CASES = ("free", "block", "g5", "g1800", "disc")
WINDOW = 0.01  # s
AROUND_JUMPS = 0.05  # s before and after
HISTORY_DT = 5e-4  # s
LEAST_PRESSURE = 0.05  # of the weight: below, a ratio of forces of the engine says nothing


def main() -> None:
    """Compare the cases that the command line names, all of them otherwise."""
    parser = argparse.ArgumentParser(
        description=__doc__.splitlines()[0], epilog="example: python bench/mujoco_reactions.py g5"
    )
    parser.add_argument("cases", nargs="*", metavar="CASE", help=f"any of {', '.join(CASES)}")
    options = parser.parse_args()
    print(f"MuJoCo {mujoco.__version__}; root-mean-square difference of forces over m_w g, in")
    print(
        f"windows of {WINDOW} s; {AROUND_JUMPS} s around impacts and jumps of the motion left out"
    )
    heads = ("windows", "rms N", "diff N", "rms H", "diff H", "|H|/N", "engine")
    print(f"{'case':6s}" + "".join(f"{head:>9s}" for head in heads))
    for name in options.cases or CASES:
        case = rwmf.Case.from_namelist(ROOT / "validation" / f"{name}.nml")
        print(f"{name:6s}" + "".join(f"{value:9.4g}" for value in compare(case)), flush=True)


def compare(case: rwmf.Case) -> list[float]:
    """Compute a case with both programs."""
    run = rwmf.simulate(case.replace(output={"dt": HISTORY_DT, "reactions": True}))
    own = np.stack([run["pivot_normal_over_m_w_g"], run["pivot_horizontal_over_m_w_g"]], axis=1)
    own = windows(own[:-1], round(WINDOW / HISTORY_DT))
    engine = mujoco_cases.Engine()
    found = windows(contact_forces(case, engine), round(WINDOW / engine.dt))
    n = min(len(own), len(found))
    middle = (np.arange(n) + 0.5) * WINDOW
    jumps = run["event_time"].values[run["event"].values == "impact"]
    if case.motion.kind == "one_cosine":
        # the pulse begins and ends with a jump, which the engine's contact follows in its own time
        jumps = np.append(jumps, [0.0, 2 * np.pi / float(case.motion.omega_p)])
    far = np.array([np.all(np.abs(jumps - t) > AROUND_JUMPS) for t in middle])
    own, found = own[:n][far], found[:n][far]
    size, difference = rms(own), rms(own - found)
    pressed = found[:, 0] > LEAST_PRESSURE
    demand = [np.max(np.abs(part[pressed, 1]) / part[pressed, 0]) for part in (own, found)]
    return [far.sum(), size[0], difference[0], size[1], difference[1], *demand]


def contact_forces(case: rwmf.Case, engine: mujoco_cases.Engine) -> Array:
    """Vertical and horizontal force of the ground on the wall over m_w g, one row a time step."""
    model = mujoco.MjModel.from_xml_string(mujoco_cases.scene(case, engine))
    data = mujoco.MjData(model)
    mujoco_cases.start(case, model, data)
    settling = round(engine.settling / engine.dt) if case.initial is None else 0
    n = round(case.solver.t_end / engine.dt)
    rows = np.zeros((n, 2))
    force = np.zeros(6)
    for i in range(-settling, n):
        time = (i + 0.5) * engine.dt if i >= 0 else -1.0
        mujoco_cases.push(case, model, data, time)
        mujoco.mj_step(model, data)
        for k in range(data.ncon if i >= 0 else 0):
            mujoco.mj_contactForce(model, data, k, force)
            # the normal points from the ground into the wall
            world = data.contact[k].frame.reshape(3, 3).T @ force[:3]
            rows[i] += world[2], world[0]
    return rows / (case.wall.m_w * case.model.g)


def windows(rows: Array, n: int) -> Array:
    """Return means over windows of n rows."""
    m = len(rows) // n
    return rows[: m * n].reshape(m, n, -1).mean(axis=1)


def rms(rows: Array) -> Array:
    """Return the root mean square of each column."""
    return np.sqrt(np.mean(rows**2, axis=0))


if __name__ == "__main__":
    main()
