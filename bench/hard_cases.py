"""Table of the hard cases: error and verdict of every method in every case.

    python bench/hard_cases.py               the rows from the stored answers
    python bench/hard_cases.py --reference   first the answers that are not stored yet, or whose
                                             case has changed (all of them: some minutes)

The cases are those of tests/robustness; the reference answers come from quadruple precision. The
rows go to docs/validation/hard-cases.csv, and their summary to hard-cases.md beside it.
"""

import csv
import sys
import tempfile
import time
from collections.abc import Iterable, Iterator
from pathlib import Path

from common import ROOT, fill, table

import collection  # isort: skip
from hard_scenes import METHODS  # isort: skip

TARGET = ROOT / "docs" / "validation" / "hard-cases.csv"
TEXT = Path(__file__).with_name("hard_cases_text.md")


def main() -> int:
    """Write the table; the exit status is 1 when a row is wrong."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        if "--reference" in sys.argv[1:]:
            collection.write_answers(_answers(folder))
        wrong = _write_table(folder)
    return 1 if wrong else 0


def _answers(folder: Path) -> list[collection.Answer]:
    answers = []
    stored = collection.read_answers() if collection.ANSWERS.exists() else {}
    for family, hard in collection.every_case():
        old = stored.get((family, hard.name))
        if old is not None and old.checksum == collection.checksum(hard):
            answers.append(old)
            continue
        started = time.perf_counter()
        answers.append(collection.answer(family, hard, folder))
        spent = time.perf_counter() - started
        print(f"{family}: {hard.name}: {spent:.1f} s", flush=True)
    return answers


def _write_table(folder: Path) -> int:
    answers = collection.read_answers()
    rows = [
        _values(family, hard.name, truth, collection.evaluate(hard, truth, method, folder))
        for family, cases in collection.FAMILIES.items()
        for hard in cases
        for truth in [answers[family, hard.name]]
        for method in METHODS
    ]
    with TARGET.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, rows[0], lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    page = TARGET.with_suffix(".md")
    page.write_text(make_page(), encoding="utf-8")
    wrong = sum(row["verdict"] == "WRONG" for row in rows)
    print(f"{TARGET.relative_to(ROOT)}: {len(rows)} rows, {wrong} wrong")
    return wrong


def _values(
    family: str, name: str, truth: collection.Answer, row: collection.Row
) -> dict[str, str]:
    return {
        "family": family,
        "case": name,
        "peak": f"{truth.peak:.6g}",
        "overturned": "yes" if truth.overturned else "no",
        "kappa": f"{truth.kappa:.1e}",
        "method": row.method,
        "rtol": f"{row.rtol:.0e}",
        "error": f"{row.error:.0e}",
        "bound": f"{row.bound:.0e}",
        "end": f"{row.error_end:.0e}",
        "impacts": str(row.impacts),
        "lift_offs": str(row.lift_offs),
        "steps": str(row.steps),
        "verdict": row.verdict,
    }


def read_rows() -> list[dict[str, str]]:
    """Read the rows of the repository."""
    with TARGET.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def make_page() -> str:
    """Make the page that summarises the rows."""
    rows = read_rows()
    heads = ("rows", "right", "refused", "largest error/bound", "in", "below 1e-9", "steps")

    def summary(key: str, names: Iterable[str], form: str = "{}") -> str:
        parts = {name: [row for row in rows if row[key] == name] for name in names}
        lines = ([form.format(name), *_share_of(part)] for name, part in parts.items())
        return table([key, *heads], lines)

    wrong = sum(row["verdict"] == "WRONG" for row in rows)
    return fill(
        TEXT,
        count=f"{len(rows)} rows, {wrong} wrong.",
        methods=summary("method", METHODS, "`{}`"),
        families=summary("family", collection.FAMILIES),
        sensitive=table(["case", "kappa", "largest error", "bound"], _most_sensitive(rows)),
    )


def _share_of(rows: list[dict[str, str]]) -> list[object]:
    worst = max(rows, key=_share)
    counts = (sum(row["verdict"] == verdict for row in rows) for verdict in ("right", "refused"))
    fine = sum(float(row["error"]) < 1e-9 for row in rows)
    steps = sum(int(row["steps"]) for row in rows)
    return [len(rows), *counts, f"{_share(worst):.1g}", worst["case"], fine, steps]


def _share(row: dict[str, str]) -> float:
    return float(row["error"]) / float(row["bound"])


def _most_sensitive(rows: list[dict[str, str]]) -> Iterator[list[str]]:
    kappas = {row["case"]: row["kappa"] for row in rows}
    for name in sorted(kappas, key=lambda name: -float(kappas[name]))[:10]:
        same = [row for row in rows if row["case"] == name]
        largest = (max(float(row[key]) for row in same) for key in ("error", "bound"))
        yield [name, kappas[name], *(f"{x:.0e}" for x in largest)]


if __name__ == "__main__":
    sys.exit(main())
