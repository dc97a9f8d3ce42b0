"""Code blocks of the pages match the present program; generated pages are up to date."""

from __future__ import annotations

import re
import sys

import pytest
from checkout import ROOT

sys.path.append(str(ROOT / "tools"))

from pages import blocks, made


@pytest.mark.parametrize("name", made.PAGES)
def test_made_page_is_current(name: str) -> None:
    """`tools/docs --made` would not change it."""
    assert (blocks.DOCS / name).read_text(encoding="utf-8") == made.PAGES[name]()


def test_an_equation_has_a_label_of_its_own() -> None:
    """A label belongs to one equation; all others refer to it."""
    pages = (blocks.DOCS / "theory").glob("*.md")
    text = "".join(page.read_text(encoding="utf-8") for page in pages)
    labels = re.findall(r"\\tag\{(T\d+)\}", text)
    assert len(labels) == len(set(labels)) > 0
    assert set(re.findall(r"\((T\d+)\)", text)) <= set(labels)
