"""Sketches of the theory: those that pages show are those that are drawn, with text to read."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import pytest
from checkout import ROOT

sys.path.append(str(ROOT / "tools"))

from pages import sketches
from pages.sketches import bending
from pages.sketches.shapes import HALF, Sketch

PAGES = sorted((ROOT / "docs" / "theory").glob("*.md"))


def test_pages_show_the_sketches() -> None:
    text = "".join(page.read_text(encoding="utf-8") for page in PAGES)
    shown = re.findall(r"\]\(figures/sketches/([\w-]+)\.svg\)", text)
    assert len(shown) == len(set(shown))
    drawn = {sketch.name for sketch in sketches.SKETCHES}
    ready = {sketch.name for sketch in bending.SKETCHES}
    assert drawn - ready <= set(shown) <= drawn


@pytest.mark.parametrize("sketch", sketches.SKETCHES, ids=lambda sketch: sketch.name)
def test_a_sketch_is_a_panel(sketch: Sketch, tmp_path: Path) -> None:
    """It fits beside another one, and stays the same when it is drawn again."""
    sketch.write(tmp_path)
    first = (tmp_path / f"{sketch.name}.svg").read_text(encoding="utf-8")
    width = re.search(r'width="([\d.]+)pt"', first)
    assert width is not None
    assert float(width[1]) <= 72 * HALF + 0.1
    sketch.write(tmp_path)
    assert (tmp_path / f"{sketch.name}.svg").read_text(encoding="utf-8") == first
