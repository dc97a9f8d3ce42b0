"""Start-up times: imports, one run and the first spectrum, each in a new process.

    .venv/bin/python bench/start_up.py [ROUNDS]

The least wall-clock time of some alternating rounds counts (default 5); the ratio is that to
``import xarray``, which every result in Python needs.
"""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
CASE = str(ROOT / "inputs" / "fig12_one_cosine.nml")
_SPECTRUM = f"import rwmf; rwmf.spectrum(rwmf.Case.from_namelist({CASE!r}), T_s=[0.5, 1.0])"
COMMANDS = {
    "`python -c pass`": ["-c", "pass"],
    "`import numpy`": ["-c", "import numpy"],
    "`import xarray`": ["-c", "import xarray"],
    "`import rwmf`": ["-c", "import rwmf"],
    "`rwmf --version`": ["-m", "rwmf", "--version"],
    "`rwmf check CASE`": ["-m", "rwmf", "check", CASE],
    "`rwmf run CASE`": ["-m", "rwmf", "run", CASE],
    "first `rwmf.simulate`": ["-c", f"import rwmf; rwmf.simulate({CASE!r})"],
    "first `rwmf.spectrum`": ["-c", _SPECTRUM],
}


def main(rounds: int = 5) -> None:
    """Measure and print."""
    least = dict.fromkeys(COMMANDS, float("inf"))
    for _ in range(rounds):
        for name, words in COMMANDS.items():
            least[name] = min(least[name], _seconds(words))
    print("| start | seconds | over `import xarray` |\n|---|---|---|")
    for name, seconds in least.items():
        print(f"| {name} | {seconds:.2f} | {seconds / least['`import xarray`']:.2f} |")


def _seconds(words: list[str]) -> float:
    path = os.pathsep.join([str(ROOT / "driver"), os.environ.get("PYTHONPATH", "")])
    begin = time.perf_counter()
    subprocess.run(
        [sys.executable, *words],
        check=True, capture_output=True, cwd=ROOT, env=os.environ | {"PYTHONPATH": path},
    )  # fmt: skip
    return time.perf_counter() - begin


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
