"""The building with a rocking wall in OpenSees: rigid and bending wall, rigid and flexible links.

``python bench/opensees_bent_wall.py [VARIANT ...]`` reads ``validation/six_storeys_wall.nml`` and
writes ``validation/opensees/bent_wall_peaks.csv`` and the histories
``validation/opensees/bent_wall_MOTION_VARIANT.csv``. Needs the environment variable
RWMF_OPENSEES, a Python that has ``openseespy`` from PyPI. Every variant is also computed with steps
twice as long; the table of peaks has both.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
import rwmf
from opensees_cases import NoOpenSeesError, ask
from reproduce.bent_wall import (
    MOTIONS,
    STORED,
    VARIANTS,
    Variant,
    bent_wall_case,
    damping_of,
    write_peak_table,
)
from reproduce.engines import write

ROOT = Path(__file__).resolve().parents[1]


@dataclass(frozen=True)
class Engine:
    """Numbers of the computation: none of them belongs to the structure.

    Attributes
    ----------
    elements : int
        Number of beams over the height of the wall.
    stiffness : float
        Stiffness of the pad under each corner [N/m].
    contact_ratio : float
        Stiffness of the spring without tension over that of its pad [-].
    damping_ratio : float
        Of the rigid wall that moves vertically on both its pads [-].
    axial_ratio : float
        Axial stiffness of the wall over that of its section: the axis of rwmf has one length [-].
    dt : float
        Time step [s].
    integrator : tuple
        Integrator of OpenSees and its parameters.
    stored_interval : float
        Interval of the stored history [s].
    stored : tuple of str
        Columns of the stored history.
    """

    elements: int = 48
    stiffness: float = 1e12
    contact_ratio: float = 10.0
    damping_ratio: float = 1.0
    axial_ratio: float = 1e3
    dt: float = 4e-5
    integrator: tuple[str | float, ...] = ("Newmark", 0.5, 0.25)
    stored_interval: float = 0.02
    stored: tuple[str, ...] = STORED
