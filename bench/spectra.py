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
from peers import PEERS, draw, scaling
from peers.measure import Row, kernel, kernel_row, peer_row
from peers.problem import BANDS, GAMMAS, Array, Peer, Record, bands, bare_frame, case, read_record
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
LONG = 0.3


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
        *((lambda g, p=p: peer_row(p, record, g, T_s, truth[g])) for p in peers if not p.linear),
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


def _linear(record: Record, T_s: Array, peers: Sequence[Peer]) -> list[Row]:
    """Measure all programs that solve the bare frame."""
    truth, _ = kernel(bare_frame(record, *TRUTH), T_s, threads=0)
    rows = []
    for method, rtol in (OURS[0], ("dop853", TARGET)):
        peaks, seconds = kernel(bare_frame(record, method, rtol), T_s, repeats=5)
        name = f"rwmf, {method}"
        errors = np.abs(peaks / truth - 1)
        rows.append(Row(name, rtol, np.nan, T_s.size, seconds / T_s.size, errors))
    return rows + [peer_row(peer, record, np.nan, T_s, truth) for peer in peers if peer.linear]


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


def _print_linear(rows: Sequence[Row], T_s: Array) -> None:
    """Print the table of programs that solve the bare frame."""
    print(f"Bare frame, {T_s.size} periods from {T_s[0]:g} to {T_s[-1]:g} s\n")
    heads = ("program", "rtol", "us an ordinate", "largest error", "median error")
    lines = [
        (
            row.program,
            _rtol(row),
            f"{1e6 * row.seconds:.3g}",
            f"{row.error:.0e}",
            f"{np.median(row.errors):.0e}",
        )
        for row in rows
    ]
    _table(heads, lines)


def _print_against_recursion(record: Record, T_s: Array, linear: Sequence[Row]) -> None:
    """Print the cost of the wall over the exact recursion of the bare frame."""
    recursions = [row for row in linear if row.program.startswith("exact recursion")]
    if not recursions:
        return
    heads = ("gamma", "us an ordinate", *(f"over {row.program}" for row in recursions))
    lines = []
    for gamma in GAMMAS:
        _, seconds = kernel(case(record, *OURS[0]), T_s, gamma, repeats=9)
        cost = seconds / T_s.size
        ratios = (f"{cost / row.seconds:.3g}" for row in recursions)
        lines.append((f"{gamma:g}", f"{1e6 * cost:.3g}", *ratios))
    print(f"auto at {OURS[0][1]:.0e}, {T_s.size} periods from {T_s[0]:g} to {T_s[-1]:g} s\n")
    _table(heads, lines)


def _print_points(name: str, points: scaling.Points) -> None:
    """Print one dependence."""
    first = points[0][1]
    lines = [(f"{x:g}", f"{1e6 * y:.3g}", f"{first / y:.3g}") for x, y in points]
    _table((name, "us an ordinate", "first line over this"), lines)


def _scaling(
    record: Record, T_s: Array, truth: dict[float, Array], most: int, repeats: int
) -> dict[str, list]:
    """Measure and print the dependences of an ordinate's cost."""
    found: dict[str, list] = {
        "ordinates": scaling.ordinates(record, most, repeats),
        "seconds of motion": scaling.lengths(record, T_s[T_s >= LONG], repeats),
        "threads": scaling.threads(record, min(most, 2000), repeats),
    }
    for name, points in found.items():
        _print_points(name, points)
    found["tolerances"] = scaling.tolerances(record, T_s, truth, repeats)
    _print_rocking(found["tolerances"], T_s.size)
    heads = ("formulation, cable", "gamma", *(f"T_s {low:g}-{high:g}" for low, high in BANDS))
    rows = scaling.formulations(record, min(192, T_s.size), repeats)
    _table(heads, [(name, f"{gamma:g}", *(f"{1e6 * cost:.4g}" for cost in costs))
                   for name, gamma, costs in rows])  # fmt: skip
    return found


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
    add("--most", type=int, default=100_000, help="ordinates in the largest spectrum")
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
    _print_linear(_linear(record, T_s, peers), T_s)
    long = np.linspace(LONG, T_s[-1], T_s.size)
    linear = _linear(record, long, peers)
    _print_linear(linear, long)
    _print_against_recursion(record, long, linear)
    draw.spectra(rows, _scaling(record, T_s, truth, options.most, options.rounds), options.plot)
    print(f"Figure: {options.plot}")


if __name__ == "__main__":
    main()
