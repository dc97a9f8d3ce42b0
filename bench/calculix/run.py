"""A validation case in CalculiX: finite elements, a deformable wall that may lift off.

``python bench/calculix/run.py [CASE ...]`` reads ``validation/CASE.nml`` and writes
``validation/calculix/CASE.csv``. Needs the program ``ccx`` (Debian: ``apt-get install
calculix-ccx``).

The wall is a mesh of solid elements (30 GPa, Poisson's ratio 0.2) on a foundation, with contact and
friction between them. The solver is given neither the kinematics of rocking nor a restitution
factor.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import tempfile
import time
from contextlib import suppress
from dataclasses import asdict, fields
from pathlib import Path

import rwmf
from deck import Deck
from history import Array, read_history, slip
from reproduce.engines import write
from settings import SUPPORTS, Settings
from supports import add_support

ROOT = Path(__file__).resolve().parents[2]
# default durations [s]: the first impacts of the heavy wall, which show restitution and lever arm,
# and the complete validation case of the paper
UNTIL = {"g5": 1.2, "g1800": 6.0}


def main() -> None:
    """Compute the cases that the command line names."""
    parser = argparse.ArgumentParser(
        description=__doc__.splitlines()[0],
        epilog="example: python bench/calculix/run.py g5 --until 0.6 --support struts --out .",
    )
    parser.add_argument("cases", nargs="*", metavar="CASE", help=" or ".join(UNTIL), default=UNTIL)
    parser.add_argument("--until", type=float, metavar="T", help="end [s]; as stored when absent")
    for field in fields(Settings):
        allowed = {"choices": SUPPORTS} if field.name == "support" else {"metavar": "X"}
        word = f"--{field.name.replace('_', '-')}"
        parser.add_argument(word, type=type(field.default), default=field.default, **allowed)
    parser.add_argument("--out", type=Path, default=ROOT / "validation" / "calculix")
    options = parser.parse_args()
    settings = Settings(**{field.name: getattr(options, field.name) for field in fields(Settings)})
    options.out.mkdir(parents=True, exist_ok=True)
    for name in options.cases:
        case = rwmf.Case.from_namelist(ROOT / "validation" / f"{name}.nml")
        started = time.perf_counter()
        facts, history = compute(case, settings, options.until or UNTIL[name])
        write(options.out / f"{name}.csv", facts, history)
        print(f"{name}: {time.perf_counter() - started:.0f} s, slip {facts['slip_max_m']:.1e} m")


class SolverStoppedError(Exception):
    """The solver did not reach the end.

    Attributes
    ----------
    reached : float
        Time of the last row [s].
    """

    def __init__(self, reached: float, log: str) -> None:
        super().__init__(f"the solver stopped at {reached:g} s:\n{log}")
        self.reached = reached


def compute(
    case: rwmf.Case, settings: Settings, until: float, limit: float | None = None
) -> tuple[dict[str, object], Array]:
    """Run the solver in a separate folder."""
    deck = Deck(case, settings, until)
    add_support(deck)
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        (folder / "case.inp").write_text(deck.text(), encoding="utf-8")
        _run_solver(folder, limit)
        found = read_history(folder / "case.dat", deck)
        reached = float(found[-1, 0]) if len(found) else 0.0
        if reached < until - 2 * settings.stored_interval:
            log = (folder / "log").read_text(errors="replace")
            raise SolverStoppedError(reached, log[-2000:])
    facts: dict[str, object] = {
        "engine": solver_version(),
        "slip_max_m": float(f"{slip(found):.3g}"),
        **asdict(settings),
    }
    return facts, found[:, :6]


def _run_solver(folder: Path, limit: float | None) -> None:
    with (folder / "log").open("w") as log, suppress(subprocess.TimeoutExpired):
        subprocess.run(
            ["ccx", "case"],
            cwd=folder,
            stdout=log,
            stderr=log,
            check=False,
            env=_environment(),
            timeout=limit,
        )


def _environment() -> dict[str, str]:
    """Keep freed memory: to return it after every increment takes half of the time."""
    keep = {"MALLOC_MMAP_THRESHOLD_": "1000000000", "MALLOC_TRIM_THRESHOLD_": "1000000000"}
    return {**os.environ, **keep, "OMP_NUM_THREADS": "1"}


def solver_version() -> str:
    """Ask the solver for its version."""
    found = subprocess.run(["ccx", "-v"], capture_output=True, text=True, check=False).stdout
    match = re.search(r"Version\s+(\S+)", found)
    return f"CalculiX {match[1] if match else 'unknown'}"


if __name__ == "__main__":
    main()
