"""Pages that a command makes are those that the present code makes."""

from __future__ import annotations

import re

from conftest import ROOT
from rwmf import key_reference, output_reference


def test_namelist_reference_is_current() -> None:
    """docs/reference/namelist.md is the output of `python -m rwmf.key_reference`."""
    page = (ROOT / "docs" / "reference" / "namelist.md").read_text(encoding="utf-8")
    assert page == key_reference.make()


def test_output_reference_is_current() -> None:
    """docs/reference/outputs.md is the output of `python -m rwmf.output_reference`."""
    page = (ROOT / "docs" / "reference" / "outputs.md").read_text(encoding="utf-8")
    assert page == output_reference.make()


def test_an_equation_has_a_label_of_its_own() -> None:
    """A label ends the line of its equation; all others refer to one."""
    page = (ROOT / "docs" / "theory" / "theory.md").read_text(encoding="utf-8")
    labels = re.findall(r"^ {4,}.* {2}\((T\d+)\)$", page, re.MULTILINE)
    assert len(labels) == len(set(labels))
    assert set(re.findall(r"\((T\d+)\)", page)) == set(labels)
