"""sdof: spectra of the linear oscillator in C, by the average acceleration method (its default).

Its spectrum without `threads` refines the record to a fiftieth of the period but integrates it with
the old interval (0.0.12). The result is wrong for periods shorter than 50 intervals; the C spectrum
is right to the order of the method. A record with eight times as many samples makes
it more accurate. Of n periods from p to q it solves p + i (q - p)/n, whatever it labels them.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from peers.problem import XI, Array, Peer, Record, Solver


def _maker(steps: int) -> Callable[[Record, float, float], Solver]:
    def make(record: Record, gamma: float, rtol: float) -> Solver:
        import sdof

        t = np.linspace(0.0, record.t[-1], steps * (record.t.size - 1) + 1)
        a = np.interp(t, record.t, record.a)

        def solve(T_s: Array) -> Array:
            step = (T_s[-1] - T_s[0]) / (T_s.size - 1)
            periods = (T_s[0], T_s[-1] + step, T_s.size)
            found = sdof.spectrum(a, record.interval / steps, XI, periods=periods, threads=1)
            return np.asarray(found[0][1])

        return solve

    return make


PEERS = (
    Peer("sdof, C spectrum", np.nan, _maker(1), "sdof", linear=True),
    Peer("sdof, 8 steps a sample", np.nan, _maker(8), "sdof", linear=True),
)
