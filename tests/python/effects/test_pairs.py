"""Every pair of effects runs, or is refused with a reason that names both."""

import functools
import re
from itertools import combinations
from pathlib import Path

import pairs
import pytest
from checkout import ROOT
from rwmf.kernel import tables

# groups of the solver and the output, which are no effects
_NO_EFFECTS = {"solver", "output", "spectrum", "base_section", "limits", "sensitivity", "design"}
_TRY = pairs.try_pair
_PAIRS = list(combinations(pairs.EFFECTS, 2))


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of the cases and their record."""
    path = tmp_path_factory.mktemp("pairs")
    pairs.prepare(path)
    return path


@functools.cache
def _outcome(first: str, second: str, folder: Path) -> pairs.Outcome:
    return _TRY(first, second, folder)


@pytest.mark.parametrize(("first", "second"), _PAIRS, ids=map("-".join, _PAIRS))
def test_pair(first: str, second: str, folder: Path) -> None:
    """`try_pair` checks the results of a run."""
    outcome = _outcome(first, second, folder)
    if outcome.kind == "refused":
        for effect in (first, second):
            named = set(pairs.EFFECTS[effect]) & set(re.findall(r"&(\w+)", outcome.message))
            assert named, outcome.message


def test_no_group_is_missing() -> None:
    groups = {row[0] for row in tables.schema()} - _NO_EFFECTS
    assert groups == {group for effect in pairs.EFFECTS.values() for group in effect} - _NO_EFFECTS


def test_no_law_is_missing() -> None:
    """Every value of every choice of an effect; pulses are drives of one kind.

    A rule that makes lists (`distribution`) is the same effect as those lists, and the scale of a
    damping (`xi_of`) the same as that damping.
    """
    for group, key, kind, _, default, allowed, *_ in tables.schema():
        if group in _NO_EFFECTS or kind != "choice" or group in ("motion",):
            continue
        if key in ("unit", "distribution", "xi_of"):
            continue
        used = {
            (changes or {}).get(key)
            for effect in pairs.EFFECTS.values()
            for changes in (effect.get(group), pairs.SCENE.get(group))
        }
        # 'none' leaves the effect out
        assert set(allowed.split()) - {"none"} <= used | {default}, (group, key)


def test_page_is_current(
    folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The table of docs/reference/effects.md equals the output of the command."""
    monkeypatch.setattr(pairs, "try_pair", lambda a, b, _: _outcome(a, b, folder))
    pairs.main()
    assert capsys.readouterr().out in (ROOT / "docs" / "reference" / "effects.md").read_text(
        encoding="utf-8"
    )
