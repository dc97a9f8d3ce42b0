"""Programs that solve the same problem, one file each, and their measurement.

A peer is optional: its package is imported when it is used. `problem.py` states the problem,
`walk.py` is the hybrid loop of those that know flights only.
"""

from __future__ import annotations

from peers import heyoka_taylor, numba_rk, scipy_ivp
from peers.problem import Peer

__all__ = ["PEERS"]

PEERS: tuple[Peer, ...] = (*heyoka_taylor.PEERS, *numba_rk.PEERS, *scipy_ivp.PEERS)
