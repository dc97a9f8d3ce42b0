"""Pages that a command makes are those that the present code makes."""

from __future__ import annotations

from conftest import ROOT
from rwmf import key_reference, output_reference


def test_namelist_reference_is_current() -> None:
    """docs/namelist.md is the output of `python -m rwmf.key_reference`."""
    page = (ROOT / "docs" / "namelist.md").read_text(encoding="utf-8")
    assert page == key_reference.make()


def test_output_reference_is_current() -> None:
    """docs/outputs.md is the output of `python -m rwmf.output_reference`."""
    page = (ROOT / "docs" / "outputs.md").read_text(encoding="utf-8")
    assert page == output_reference.make()
