"""The programs of docs/howto/embedding.md are those that run as tests."""

from __future__ import annotations

import re

import pytest
from conftest import ROOT

TEXT = (ROOT / "docs" / "howto" / "embedding.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^`([\w/]+\.(?:f90|c))`\n\n```\w+\n(.*?)```", TEXT, re.MULTILINE | re.DOTALL)


def test_programs_are_shown() -> None:
    assert len(BLOCKS) == 4


@pytest.mark.parametrize(("path", "code"), BLOCKS, ids=[path for path, _ in BLOCKS])
def test_program_is_the_tested_one(path: str, code: str) -> None:
    assert code == (ROOT / path).read_text(encoding="utf-8")
