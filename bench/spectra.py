"""Cost of a displacement spectrum: ordinates per second and true error, by program.

.venv/bin/python bench/spectra.py [--periods N] [--peers all|none|NAME,...] [--plot FILE]

docs/developer/bench.md describes the measurement and the columns.
"""

from __future__ import annotations

import argparse
import importlib.metadata
import os
import platform
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import rwmf
from peers import PEERS, draw
from peers.measure import Row, kernel, kernel_row, peer_row
from peers.problem import GAMMAS, Array, Peer, Record, bands, case, read_record
from rwmf._library import measure as _measure

ROOT = Path(__file__).resolve().parent.parent
RECORD = ROOT / "inputs" / "records" / "elcentro.csv"
TRUTH = ("dop853", 1e-13)
# loose and tight tolerance of the reference in quadruple precision
QUAD = (1e-18, 1e-20)
OURS = (("auto", 1e-7), ("auto", 1e-8), ("auto", 1e-9))
SLOW = (
    ("dop853", 1e-7),
    ("dop853", 1e-9),
    ("taylor", 1e-7),
    ("taylor", 1e-8),
    ("adams", 1e-8),
    ("bdf", 1e-8),
)
BASE = "auto"
TARGET = 1e-7
TOLERANCES = (1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)


def _truth(record: Record, T_s: Array, quad: int) -> dict[float, Array]:
    """Peaks that errors are measured against, checked against quadruple precision."""
    found, worst, count = {}, 0.0, 0
    for gamma in GAMMAS:
        found[gamma], _ = kernel(case(record, *TRUTH), T_s, gamma, threads=0)
        for part in bands(T_s) if quad else []:
            for k in part[((np.arange(quad) + 0.5) * part.size / quad).astype(int)]:
                one = case(record, *TRUTH).replace(frame={"gamma": gamma, "T_s": float(T_s[k])})
                exact = _measure.solve_reference(one, *QUAD)
                worst = max(worst, abs(found[gamma][k] / exact.values["u_s_max_m"] - 1))
                count += 1
    if count:
        print(f"Reference: {TRUTH[0]} at rtol {TRUTH[1]:.0e}; {count} ordinates of it differ from")
        print(f"the reference in quadruple precision by {worst:.0e} at the most.\n")
    return found


def _rocking(
    record: Record, T_s: Array, truth: dict[float, Array], peers: Sequence[Peer], rounds: int
) -> list[Row]:
    """Measure all programs that solve the wall; ours in turn with the slow ones."""
    slow = [
        *((lambda g, m=m, r=r: kernel_row(record, m, r, g, T_s, truth[g], 1)) for m, r in SLOW),
        *((lambda g, p=p: peer_row(p, record, g, T_s, truth[g])) for p in peers),
    ]
    found: dict[tuple[str, float, float], Row] = {}
    for i in range(max(rounds, len(slow))):
        for gamma in GAMMAS:
            rows = [slow[i](gamma)] if i < len(slow) else []
            for method, rtol in OURS:
                rows.append(kernel_row(record, method, rtol, gamma, T_s, truth[gamma], 3))
            for row in rows:
                key = (row.program, row.rtol, row.gamma)
                if key not in found or row.seconds < found[key].seconds:
                    found[key] = row
    order = [name for name, _ in (*OURS, *SLOW)] + [peer.name for peer in peers]
    return sorted(found.values(), key=lambda row: (row.gamma, order.index(row.program), -row.rtol))


def _table(heads: Sequence[str], lines: Sequence[Sequence[str]]) -> None:
    """Print a table in Markdown."""
    print("| " + " | ".join(heads) + " |")
    print("|" + "---|" * len(heads))
    for line in lines:
        print("| " + " | ".join(line) + " |")
    print(flush=True)


def _rtol(row: Row) -> str:
    return "-" if np.isnan(row.rtol) else f"{row.rtol:.0e}"


def _print_rocking(rows: Sequence[Row], n: int) -> None:
    """Print the table of programs that solve the wall."""
    base = {row.gamma: row.seconds for row in rows if (row.program, row.rtol) == OURS[0]}
    heads = (
        "program", "rtol", "gamma", "periods run", "us an ordinate", "ordinates a second",
        "largest error", f"above {TARGET:.0e}", f"times {BASE} {OURS[0][1]:.0e}",
    )  # fmt: skip
    lines = [
        (
            row.program,
            _rtol(row),
            f"{row.gamma:g}",
            f"{row.ordinates} of {n}",
            f"{1e6 * row.seconds:.4g}",
            f"{1 / row.seconds:.3g}",
            f"{row.error:.0e}",
            str(int(np.sum(~(row.errors <= TARGET)))),
            f"{row.seconds / base[row.gamma]:.3g}",
        )
        for row in rows
    ]
    _table(heads, lines)


def _choose(text: str) -> list[Peer]:
    """Return the requested peers that are installed, and list the others."""
    if text == "none":
        return []
    words = None if text == "all" else text.lower().split(",")
    wanted = [p for p in PEERS if words is None or any(word in p.name.lower() for word in words)]
    for package in dict.fromkeys(p.distribution or p.package for p in wanted if not p.is_installed):
        print(f"Not installed: {package}; python -m pip install {package}")
    return [peer for peer in wanted if peer.is_installed]


def _print_machine(peers: Sequence[Peer]) -> None:
    """Print the date and the machine of the measurement."""
    used = dict.fromkeys(p.distribution or p.package for p in peers if p.package)
    versions = ", ".join(f"{name} {importlib.metadata.version(name)}" for name in used)
    print(f"rwmf {rwmf.__version__}; {versions or 'no peers'}; Python {platform.python_version()}")
    load = ", ".join(f"{value:.1f}" for value in os.getloadavg())
    print(f"{_processor()}, {os.cpu_count()} CPUs, load {load}\n")


def _processor() -> str:
    path = Path("/proc/cpuinfo")
    lines = path.read_text(encoding="utf-8").splitlines() if path.exists() else []
    names = [line.split(":")[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure, print and draw."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add: Callable[..., object] = parser.add_argument
    add("--periods", type=int, default=200, help="of the spectrum, from 0.05 to 3 s")
    add("--peers", default="all", help="all, none, or parts of names: scipy,heyoka")
    add("--quad", type=int, default=1, help="periods a band for quadruple precision, 0 for none")
    add("--rounds", type=int, default=3, help="repetitions of fast measurements")
    add("--record", type=Path, default=RECORD, help="two columns: time in s, acceleration in g")
    add("--plot", type=Path, default=ROOT / "plots" / "spectra.png", help="figure")
    options = parser.parse_args(arguments)
    peers = _choose(options.peers)
    _print_machine(peers)
    record = read_record(options.record)
    T_s = np.linspace(0.05, 3.0, options.periods)
    truth = _truth(record, T_s, options.quad)
    rows = _rocking(record, T_s, truth, peers, options.rounds)
    _print_rocking(rows, T_s.size)
    tolerances = [
        kernel_row(record, "auto", rtol, gamma, T_s, truth[gamma], options.rounds)
        for gamma in GAMMAS
        for rtol in TOLERANCES
    ]
    _print_rocking(tolerances, T_s.size)
    draw.spectra(rows, tolerances, options.plot)
    print(f"Figure: {options.plot}")


if __name__ == "__main__":
    main()
