"""Benefit of the wall: largest displacement with a wall over that of the frame alone."""

from __future__ import annotations

import numpy as np

from reproduce.formulations import FORMULATIONS, SHIPPED_ETAS
from reproduce.response_cache import COARSE, ResponseCache
from reproduce.tables import Table

__all__ = ["benefit_table"]

_SCENES = {
    "fig12_one_sine": "one-sine",
    "fig12_one_cosine": "one-cosine",
    "fig13_elcentro_slender_wall": "El Centro, tan alpha = 0.5/2",
    "fig13_elcentro_squat_wall": "El Centro, tan alpha = 1/2",
}
_GAMMAS = (5.0, 10.0, 100.0, 2000.0)
# stiff, mild and flexible frames of the paper [s]
_RANGES = ((0.0, 0.6), (0.6, 1.5), (1.5, 3.0))


def benefit_table(cache: ResponseCache) -> Table:
    """Average the ratio of the largest displacements over ranges of periods."""
    heads = ("motion and wall", "form", "gamma", *(f"T_s {a:g} to {b:g} s" for a, b in _RANGES))
    rows = []
    for name, scene in _SCENES.items():
        alone = cache.spectrum_alone(name, COARSE)["u_s_max"].values
        for form in FORMULATIONS:
            spectrum = cache.spectrum(name, form, SHIPPED_ETAS, COARSE).isel(b=0)
            for gamma in _GAMMAS:
                ratio = spectrum["u_s_max"].sel(gamma=gamma).values / alone
                rows.append((scene, form.label, f"{gamma:g}", *_cells(ratio)))
    return Table(heads, rows)


def _cells(ratio: np.ndarray) -> list[str]:
    periods = np.array(COARSE)
    cells = []
    for low, high in _RANGES:
        part = ratio[(low + 1e-9 < periods) & (high + 1e-9 >= periods)]
        cells.append(f"{part.mean():.2f} ({part.min():.2f} to {part.max():.2f})")
    return cells
