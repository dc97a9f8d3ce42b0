"""Sketches of spring laws: the skeleton and cycles of growing amplitude."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from rwmf.plotting.style import ALONE, COLOURS, LEVEL

from pages.sketches.shapes import HALF, Array, Sketch, dimension, label

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_HARDENING = 0.08
_LIMIT = 6.0


def _way(turns: tuple[float, ...]) -> Array:
    """Give the displacements of a way that turns at these places, in small steps."""
    ends = (0.0, *turns)
    parts = [np.linspace(a, b, 400, endpoint=False) for a, b in pairwise(ends)]
    return np.concatenate(parts)


_CYCLES = _way((2.5, -2.5, 4.5, -4.5, 0.0))


def _bilinear(x: Array) -> Array:
    """Force of a bilinear spring with kinematic hardening, over its first yield."""
    hard = _HARDENING / (1 - _HARDENING)
    plastic, force = 0.0, np.empty_like(x)
    for i, at in enumerate(x):
        if abs(at - plastic - hard * plastic) > 1.0:
            plastic = (at - np.sign(at - plastic - hard * plastic)) / (1 + hard)
        force[i] = at - plastic
    return force


def _flag(x: Array, height: float = 0.8) -> Array:
    """Force of a self-centring spring, over its first yield."""
    force = np.empty_like(x)
    last_x, last = 0.0, 0.0
    for i, at in enumerate(x):
        sign = np.sign(at) or 1.0
        size = abs(at)
        upper = 1 + _HARDENING * (size - 1)
        lower = (1 - height) + _HARDENING * (size - (1 - height))
        trial = last + (at - last_x)
        value = np.clip(sign * trial, min(lower, size), min(upper, size))
        force[i] = sign * value
        last_x, last = at, force[i]
    return force


def _bouc_wen(x: Array, exponent: float = 2.0) -> Array:
    """Force of a smooth spring, over its first yield."""
    z, force = 0.0, np.empty_like(x)
    for i, step in enumerate(np.diff(x, prepend=0.0)):
        # beta = gamma = 1/2: no change of slope while it unloads
        z += step * (1 - abs(z) ** exponent * 0.5 * (np.sign(step * z) + 1))
        force[i] = _HARDENING * x[i] + (1 - _HARDENING) * z
    return force


def _envelope(x: Array, strength: float = 1.0) -> Array:
    """Envelope of a degrading spring over its ductility: yield, cap at 3, descent, residual."""
    hard = 1 + _HARDENING * (x - 1)
    cap = 1 + 2 * _HARDENING
    beyond = np.maximum(cap - 0.28 * (x - 3), 0.25)
    lowest: Array = np.minimum(np.minimum(x, hard), beyond)
    return lowest * strength


def _degrading() -> tuple[Array, Array]:
    """Give the corners of cycles that aim at the peak of their side, and wear."""
    peaks = {1: (1.0, 1.0), -1: (1.0, 1.0)}
    strength = {1: 1.0, -1: 1.0}
    x, force = [0.0], [0.0]
    stiffness, side = 1.0, 1
    for turn in (2.5, 2.5, 4.0, 4.0, 5.5, 5.5):
        at, value = peaks[side]
        x.append(side * at)
        force.append(side * value)
        on = np.linspace(at, turn, 30)[1:]
        if turn > at:
            envelope = _envelope(on, strength[side])
            x += (side * on).tolist()
            force += (side * envelope).tolist()
            peaks[side] = (turn, float(envelope[-1]))
        stiffness *= 0.93
        x.append(x[-1] - force[-1] / stiffness)
        force.append(0.0)
        side = -side
        strength[side] *= 0.93
        far, high = peaks[side]
        peaks[side] = (far * 1.03, min(high, float(_envelope(np.array(far), strength[side]))))
    return np.array(x), np.array(force)


def _axes(ax: Axes, text: str) -> None:
    ax.axhline(0.0, **LEVEL)
    ax.axvline(0.0, **LEVEL)
    ax.set(xlabel="$x/x_y$", ylabel="$F/F_y$", ylim=(-1.7, 1.7), xticks=[-5, -1, 1, 5])
    ax.set_yticks([-1, 0, 1])
    label(ax, (-_LIMIT + 0.2, 1.5), text, ha="left")
    ax.set_position((0.13, 0.18, 0.84, 0.79))


def _draw_bilinear(ax: Axes) -> None:
    _axes(ax, "elastic_plastic")
    ax.plot(_CYCLES, _bilinear(_CYCLES), color=COLOURS[0])
    far = np.linspace(0.0, _LIMIT, 200)
    ax.plot(far, np.minimum(far, 1 + _HARDENING * (far - 1)), **ALONE)
    label(ax, (0.55, 0.28), "$k$", ha="left")
    label(ax, (3.6, 1.42), "$a\\,k$")
    dimension(ax, (4.9, -0.71), (4.9, 1.28), "$2F_y$", (0.55, 0.0))


def _draw_flag(ax: Axes) -> None:
    _axes(ax, "flag")
    way = _way((2.5, 0.0, -2.5, 0.0, 4.5, 0.0, -4.5, 0.0))
    ax.plot(way, _flag(way), color=COLOURS[0])
    far = np.linspace(0.0, _LIMIT, 200)
    ax.plot(far, np.minimum(far, 1 + _HARDENING * (far - 1)), **ALONE)
    dimension(ax, (3.4, 0.46), (3.4, 1.19), r"$\eta F_y$", (-0.55, -0.05))


def _draw_bouc_wen(ax: Axes) -> None:
    _axes(ax, "bouc_wen, $n = 2$")
    ax.plot(_CYCLES, _bouc_wen(_CYCLES), color=COLOURS[0])
    far = np.linspace(0.0, _LIMIT, 200)
    ax.plot(far, _HARDENING * far + (1 - _HARDENING) * np.tanh(far), **ALONE)


def _draw_degrading(ax: Axes) -> None:
    _axes(ax, "peak_oriented")
    ax.plot(*_degrading(), color=COLOURS[0])
    far = np.linspace(0.0, _LIMIT, 200)
    ax.plot(far, _envelope(far) * (far > 0), **ALONE)
    label(ax, (3.0, 1.35), "cap")
    label(ax, (4.95, 1.12), "envelope")


SKETCHES = (
    Sketch("law-bilinear", _draw_bilinear, HALF, (-_LIMIT, _LIMIT)),
    Sketch("law-flag", _draw_flag, HALF, (-_LIMIT, _LIMIT)),
    Sketch("law-bouc-wen", _draw_bouc_wen, HALF, (-_LIMIT, _LIMIT)),
    Sketch("law-degrading", _draw_degrading, HALF, (-_LIMIT, _LIMIT)),
)
