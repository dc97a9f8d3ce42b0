"""Search for scenes in which a quantity depends on the other requested quantities.

    .venv/bin/python bench/quantities_alone.py [--count 500] [--first 0] [--processes 2]

The scenes are the numbered ones of tests/support/alone.py, of every family of combinations. Each
quantity of a scene is requested by itself and among all. The requests are rows in lanes and of
single runs, and ordinates (`auto` and `dop853`). For every twelfth pair of scenes they include a
sweep, a host in C and rwmf-batch. Runs keep nothing, a history, energies or reactions alone. The
bits must be equal; a peak requested by itself, without chatter, must agree to 100 rtol. Every
difference is listed; the standard error stream shows the progress.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import time
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

from rwmf.errors import RwmfError

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "support"))

from alone import differences


def check_scene(number: int) -> tuple[list[str], str]:
    """Compare the quantities of a scene."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            return list(differences(number, Path(folder))), ""
        except RwmfError as error:
            return [], f"{number}: {error}".splitlines()[0]


def main() -> int:
    """Check all scenes; 1 where a quantity differs."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=500)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--processes", type=int, default=2)
    options = parser.parse_args()
    numbers = range(options.first, options.first + options.count)
    wrong = failed = 0
    begin = time.monotonic()
    with ProcessPoolExecutor(options.processes) as pool:
        for done, (found, reason) in enumerate(pool.map(check_scene, numbers), start=1):
            seconds = time.monotonic() - begin
            print(f"{done} of {options.count} scenes, {seconds:.0f} s", file=sys.stderr, flush=True)
            wrong += bool(found)
            failed += bool(reason)
            for line in [*found, *([reason] if reason else [])]:
                print(line, flush=True)
    print(f"{options.count} scenes: {wrong} with differences, {failed} that end with an error")
    return int(wrong > 0)


if __name__ == "__main__":
    raise SystemExit(main())
