"""Every hard case with every method against its trusted answer."""

from pathlib import Path

import collection
import hard_cases
import pytest
from hard_scenes import METHODS, Hard

ANSWERS = collection.read_answers()
EVERY = list(collection.every_case())


def _name(value: object) -> str:
    return value.name if isinstance(value, Hard) else str(value)


@pytest.mark.slow
@pytest.mark.parametrize(("family", "hard"), EVERY, ids=_name)
def test_case(family: str, hard: Hard, tmp_path: Path) -> None:
    truth = ANSWERS[family, hard.name]
    assert truth.checksum == collection.checksum(hard), "run bench/hard_cases.py --reference"
    rows = [collection.evaluate(hard, truth, method, tmp_path) for method in METHODS]
    wrong = [row for row in rows if row.verdict != "right"]
    assert not wrong, f"{truth}\n{wrong}"


def test_references_are_much_better_than_what_they_judge() -> None:
    """Their own error, even where nothing but the amplification of the case limits it."""
    for truth in ANSWERS.values():
        assert truth.error <= 1e-13 * max(1.0, truth.kappa), truth


def test_the_table_is_complete() -> None:
    rows = hard_cases.read_rows()
    shown = {(row["family"], row["case"], row["method"]) for row in rows}
    every = {(family, hard.name, method) for family, hard in EVERY for method in METHODS}
    assert shown == every, "run bench/hard_cases.py"
    assert not [row for row in rows if row["verdict"] == "WRONG"]


def test_the_page_is_made_from_the_table() -> None:
    page = hard_cases.TARGET.with_suffix(".md").read_text(encoding="utf-8")
    assert page == hard_cases.make_page(), "run bench/hard_cases.py"


def test_one_answer_is_computed_anew(tmp_path: Path) -> None:
    """The stored answers are those of this kernel's quadruple build."""
    pytest.importorskip("rwmf._reference")
    family, hard = next(each for each in EVERY if each[1].name == "pulse, e = 0.5")
    fresh = collection.answer(family, hard, tmp_path)
    assert fresh.peak == pytest.approx(ANSWERS[family, hard.name].peak, rel=1e-14)
