"""Write every sketch as a file that a page shows: ``python -m pages.sketches.command FOLDER``."""

from __future__ import annotations

import sys
from pathlib import Path

from pages.sketches import bending, frames, laws, sections, walls
from pages.sketches.shapes import Sketch

SKETCHES: tuple[Sketch, ...] = (
    *walls.SKETCHES,
    *frames.SKETCHES,
    *laws.SKETCHES,
    *sections.SKETCHES,
    *bending.SKETCHES,
)


def write_all(folder: Path) -> None:
    """Draw all sketches."""
    folder.mkdir(parents=True, exist_ok=True)
    for sketch in SKETCHES:
        sketch.write(folder)


if __name__ == "__main__":
    write_all(Path(sys.argv[1]))
