"""Frequency of amplification by a rocking and by a pinned wall, against the frame alone.

.venv/bin/python bench/pinned.py

For El Centro and two pulses, the share of 59 periods from 0.1 to 3 s at which the frame moves
farther with the wall than without it.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import rwmf
from rwmf.studies import wall_effect

ROOT = Path(__file__).resolve().parent.parent
PERIODS = np.linspace(0.1, 3.0, 59)
MOTIONS = {
    "El Centro": "kind = 'record', file = 'inputs/records/elcentro.csv', unit = 'g'",
    "one sine, 0.4 g, 1 s": "kind = 'one_sine', a_max_g = 0.4, T_p = 1.0",
    "one cosine, 0.4 g, 1 s": "kind = 'one_cosine', a_max_g = 0.4, T_p = 1.0",
}
WALLS = {
    "rocking": ("", "&impact rule = 'coupled' /"),
    "rocking, cable": ("", "&impact rule = 'coupled' /\n&cable eta_0 = 1.0, eta_alpha = 5.0 /"),
    "pinned": (", base = 'pinned'", ""),
}


def main() -> None:
    """Compute and print."""
    print("| motion | gamma | " + " | ".join(WALLS) + " |")
    print("|---|---|" + "---|" * len(WALLS))
    for name, motion in MOTIONS.items():
        for gamma in (5.0, 50.0):
            shares = []
            for base, more in WALLS.values():
                text = (
                    f"&wall h = 2.0, b = 0.5{base} /\n&frame T_s = 1.0, gamma = {gamma}, "
                    f"xi_s = 0.05 /\n{more}\n&motion {motion} /\n"
                    "&model formulation = 'exact' /\n&solver method = 'dop853', t_end = 40.0 /\n"
                )
                case = rwmf.Case.from_text(text, source=ROOT / "pinned.nml")
                ratio = wall_effect(case, {"T_s": PERIODS})["ratio"].values
                shares.append(f"{100 * np.mean(ratio > 1):.0f} %")
            print(f"| {name} | {gamma:g} | " + " | ".join(shares) + " |")


if __name__ == "__main__":
    main()
