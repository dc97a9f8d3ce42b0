"""Exact linear recursion (bench/linear_recursion.c): cost of a spectrum without a wall."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

from peers.problem import XI, Array, Peer, Record, Solver

ROOT = Path(__file__).resolve().parents[2]
REPEATS = 20


def build(name: str) -> Path:
    """Build a program of bench/ in the folder build/."""
    ninja = Path(sys.executable).parent / "ninja"
    done = subprocess.run(
        [ninja if ninja.exists() else "ninja", "-C", ROOT / "build", f"bench/{name}"],
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode != 0:
        raise RuntimeError(f"{name} could not be built:\n{done.stdout[-2000:]}")
    return ROOT / "build" / "bench" / name


class Recursion:
    """The program for one record."""

    def __init__(self, record: Record, lanes: int) -> None:
        self.program = build("linear_recursion")
        self.lanes = lanes
        self.text = "\n".join(f"{value:.17g}" for value in (record.interval, *record.a))
        self.seconds = np.nan
        """Of the last spectrum, as the program measured it [s]."""

    def __call__(self, T_s: Array) -> Array:
        """Peaks [m] of equidistant periods [s]."""
        words = (self.lanes, REPEATS, repr(float(T_s[0])), repr(float(T_s[-1])), T_s.size, XI)
        done = subprocess.run(
            [self.program, *(str(word) for word in words)],
            input=self.text,
            capture_output=True,
            text=True,
            check=True,
        )
        values = np.array(done.stdout.split(), dtype=float)
        self.seconds = float(values[0])
        return values[1:]


def _maker(lanes: int) -> Callable[[Record, float, float], Solver]:
    def make(record: Record, gamma: float, rtol: float) -> Solver:
        return Recursion(record, lanes)

    return make


PEERS = tuple(
    Peer(name, np.nan, _maker(lanes), linear=True)
    for name, lanes in (
        ("exact recursion, scalar", 1),
        ("exact recursion, 8 lanes", 8),
        ("exact recursion, 32 lanes", 32),
    )
)
