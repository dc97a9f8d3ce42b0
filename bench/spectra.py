"""Cost of a displacement spectrum: ordinates per second and true error, by program.

.venv/bin/python bench/spectra.py [--periods N] [--peers all|none|NAME,...] [--quad N]

docs/developer/bench.md describes the measurement and the columns.
"""

import argparse
import platform
from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
import rwmf
from common import ROOT, least, spent, table
from peers import GAMMAS, PEERS, Array, Peer, Record, case, read_record
from rwmf.kernel import measure

RECORD = ROOT / "inputs" / "records" / "elcentro.csv"
TRUTH = ("dop853", 1e-13)
# loose and tight tolerance of the reference in quadruple precision
QUAD = (1e-18, 1e-20)
METHODS = (
    *(("auto", rtol) for rtol in (1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10)),
    *(("dop853", rtol) for rtol in (1e-7, 1e-9)),
    *(("taylor", rtol) for rtol in (1e-7, 1e-8)),
    ("adams", 1e-8),
    ("bdf", 1e-8),
)
BASE, TARGET = ("auto", 1e-7), 1e-7
# periods [s] from which an ordinate costs about the same up to the next
BANDS = (0.05, 0.2, 0.5)


class Way(NamedTuple):
    """A way to compute ordinates."""

    program: str
    rtol: float
    gamma: float
    parts: list[Array]  # numbers of the computed periods in each band
    # Peaks [m] of some numbers of periods, and the time [s]
    peaks: Callable[[Array], tuple[Array, float]]


def _kernel(record: Record, method: str, rtol: float, gamma: float, T_s: Array, threads: int = 1
            ) -> tuple[Array, float]:  # fmt: skip
    """Let the kernel compute a spectrum; its time excludes Python."""
    found = rwmf.spectrum(case(record, method, rtol), T_s=T_s, gamma=gamma, threads=threads)
    return found.u_s_max.values.ravel(), float(found.attrs["seconds"])


def _peer(peer: Peer, record: Record, gamma: float, T_s: Array) -> tuple[Array, float]:
    found: list[Array] = []
    seconds = spent(lambda: found.append(peer.peaks(record, gamma, peer.rtol, T_s)))
    return found[0], seconds


def _bands(T_s: Array) -> list[Array]:
    """Numbers of the periods in each band."""
    band = np.searchsorted(BANDS[1:], T_s, side="right")
    found = [np.flatnonzero(band == k) for k in range(len(BANDS))]
    return [part for part in found if part.size]


def _middles(part: Array, wanted: int) -> Array:
    """Return the middles of equal parts; all for 0."""
    n = min(wanted, part.size) or part.size
    return part[((np.arange(n) + 0.5) * part.size / n).astype(int)]


def _truth(record: Record, T_s: Array, quad: int) -> dict[float, Array]:
    """Peaks that errors are measured against, checked against quadruple precision."""
    found, worst = {}, 0.0
    for gamma in GAMMAS:
        found[gamma], _ = _kernel(record, *TRUTH, gamma, T_s, threads=0)
        for part in _bands(T_s) if quad else []:
            for k in _middles(part, quad):
                one = case(record, *TRUTH).replace(frame={"gamma": gamma, "T_s": float(T_s[k])})
                exact = measure.solve_reference(one, *QUAD)
                worst = max(worst, abs(found[gamma][k] / exact.values["u_s_max_m"] - 1))
    if quad:
        print(f"Reference: {TRUTH[0]} at rtol {TRUTH[1]:.0e}; {quad} ordinates of each band differ")
        print(f"from the reference in quadruple precision by {worst:.0e} at the most.\n")
    return found


def _ways(record: Record, T_s: Array, peers: Sequence[Peer]) -> list[Way]:
    parts, ways = _bands(T_s), []
    for gamma in GAMMAS:
        for method, rtol in METHODS:
            ways.append(Way(method, rtol, gamma, [np.arange(T_s.size)],
                            partial(_kernel, record, method, rtol, gamma)))  # fmt: skip
        for peer in peers:
            chosen = [_middles(part, peer.per_band) for part in parts]
            ways.append(Way(peer.name, peer.rtol, gamma, chosen,
                            partial(_peer, peer, record, gamma)))  # fmt: skip
            if not peer.per_band:
                peer.peaks(record, gamma, peer.rtol, T_s[:1])  # compiles
    return ways


def _rows(
    ways: Sequence[Way], T_s: Array, truth: dict[float, Array], rounds: int
) -> list[list[str]]:
    """Measure all ways in turn; a sample of each band is weighted with the number of periods."""
    errors = {}
    weights = [part.size for part in _bands(T_s)]

    def cost(way: Way) -> float:
        answers = [way.peaks(T_s[part]) for part in way.parts]
        found = [peaks / truth[way.gamma][part] - 1
                 for (peaks, _), part in zip(answers, way.parts, strict=True)]  # fmt: skip
        errors[way[:3]] = abs(np.concatenate(found))
        sizes = weights if len(way.parts) > 1 else [T_s.size]
        each = zip(answers, way.parts, sizes, strict=True)
        return sum(time * size / part.size for (_, time), part, size in each) / T_s.size

    slow = [way for way in ways if len(way.parts) > 1 and way.parts[-1].size < weights[-1]]
    seconds = least({way[:3]: partial(cost, way) for way in slow}, 1) if slow else {}
    seconds |= least({way[:3]: partial(cost, way) for way in ways if way not in slow}, rounds)
    rows = []
    for key in (way[:3] for way in ways):
        program, rtol, gamma = key
        rows.append(
            [
                program,
                f"{rtol:.0e}",
                f"{gamma:g}",
                f"{errors[key].size} of {T_s.size}",
                f"{1e6 * seconds[key]:.4g}",
                f"{1 / seconds[key]:.3g}",
                f"{errors[key].max():.0e}",
                str(int((~(errors[key] <= TARGET)).sum())),
                f"{seconds[key] / seconds[*BASE, gamma]:.3g}",
            ]
        )
    return rows


def _choose(text: str) -> list[Peer]:
    """Return the requested peers that are installed, and list the others."""
    words = {"none": [], "all": [""]}.get(text, text.lower().split(","))
    wanted = [p for p in PEERS if any(word in p.name.lower() for word in words)]
    for package in dict.fromkeys(p.package for p in wanted if not p.is_installed):
        print(f"Not installed: {package}; python -m pip install {package}")
    return [peer for peer in wanted if peer.is_installed]


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    add: Callable[..., object] = parser.add_argument
    add("--periods", type=int, default=200, help="of the spectrum, from 0.05 to 3 s")
    add("--peers", default="all", help="all, none, or parts of names: scipy,numba")
    add("--quad", type=int, default=1, help="periods a band for quadruple precision, 0 for none")
    add("--rounds", type=int, default=3, help="repetitions of fast measurements")
    add("--record", type=Path, default=RECORD, help="two columns: time in s, acceleration in g")
    options = parser.parse_args()
    record = read_record(options.record)
    T_s = np.linspace(BANDS[0], 3.0, options.periods)
    truth = _truth(record, T_s, options.quad)
    ways = _ways(record, T_s, _choose(options.peers))
    print(f"rwmf {rwmf.__version__}, Python {platform.python_version()}, {platform.processor()}\n")
    heads = ("program", "rtol", "gamma", "periods run", "us an ordinate", "ordinates a second",
             "largest error", f"above {TARGET:.0e}", "times auto 1e-07")  # fmt: skip
    print(table(heads, _rows(ways, T_s, truth, options.rounds)))


if __name__ == "__main__":
    main()
