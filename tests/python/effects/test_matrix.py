"""Every effect on every way to use the program: it agrees with the run, or is refused for a reason.

The tables and the columns are in `matrix.py`, which also makes docs/reference/matrix.md.
"""

import re
from pathlib import Path

import matrix
import pytest
import rwmf
from checkout import ROOT
from matrix import PATHS, REFUSALS, ROWS, Scene, entry_of
from rwmf.kernel import tables


@pytest.fixture(scope="module")
def scenes(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Scene]:
    """Make the scenes of all rows, with their record."""
    folder = tmp_path_factory.mktemp("matrix")
    matrix.pairs.prepare(folder)
    return {row: Scene(groups, folder) for row, groups in ROWS.items()}


@pytest.mark.slow
@pytest.mark.parametrize(("row", "path"), [(row, path) for row in ROWS for path in PATHS])
def test_cell(row: str, path: str, scenes: dict[str, Scene], tmp_path: Path) -> None:
    expected = entry_of(REFUSALS, row, path)
    try:
        PATHS[path](scenes[row], tmp_path)
    except rwmf.RwmfError as error:
        message = matrix.reason(error)
        assert expected is not None, f"refused, and no table says why: {message}"
        assert message.startswith(expected.message)
    else:
        assert expected is None, f"is not refused any more: {expected}"


def test_every_effect_has_a_row() -> None:
    """The kernel's own list; a case with `&spectrum` is the business of two columns."""
    present = {group for groups in ROWS.values() for group in groups}
    requests = {"spectrum", "base_section", "limits", "sensitivity", "design"}
    assert present == set(tables.needs_of_groups()) - requests


@pytest.mark.parametrize("entry", REFUSALS, ids=lambda entry: entry.rows)
def test_every_entry_names_cells(entry: matrix.Refusal) -> None:
    """No entry is left over, or hidden by one before it."""
    for path in entry.paths:
        for rows in entry.rows.split("|"):
            assert any(
                entry_of(REFUSALS, row, path) is entry for row in ROWS if re.search(rows, row)
            )


def test_page_is_current() -> None:
    """docs/reference/matrix.md equals the output of the command."""
    assert (ROOT / "docs" / "reference" / "matrix.md").read_text(encoding="utf-8") == matrix.make()
