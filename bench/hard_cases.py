"""Table of the hard cases: error and verdict of every method in every case.

    python bench/hard_cases.py               the rows from the stored answers
    python bench/hard_cases.py --reference   first the answers that are not stored yet, or whose
                                             case has changed (all of them: some minutes)

The cases are those of tests/robustness; the reference answers come from quadruple precision. The
rows go to docs/validation/hard-cases.csv, and their summary to hard-cases.md beside it.
"""

from __future__ import annotations

import csv
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests" / "support"))

import collection  # noqa: E402
from hard_scenes import METHODS  # noqa: E402

TARGET = ROOT / "docs" / "validation" / "hard-cases.csv"
COLUMNS = (
    "family", "case", "peak", "overturned", "kappa", "method", "rtol", "error", "bound", "end",
    "impacts", "lift_offs", "steps", "verdict",
)  # fmt: skip
_HEAD = r"""# Hard cases

For users who must trust the integrators in extreme cases: this page compares every method with
quadruple precision, over chatter, grazing, lift-off, overturning, springs with memory and pulses.
`bench/hard_cases.py` makes it from the rows of [hard-cases.csv](hard-cases.csv), and
`tests/robustness` tests every row.

The **reference** is the same problem in quadruple precision (Taylor series, rtol
1e-19); a run at rtol 1e-16 differs from it by less than 1e-13 of the peak unless the problem
amplifies errors. The sensitivity $\kappa$ is the relative change of the peak per relative change of
the motion. The **bound** of the error is max(1e-7, 100 rtol $\kappa$). A row is *right* within its
bound, with the final rotation within 1000 rtol times its own sensitivity. It is *refused* if the
method reported the failure, and *WRONG* otherwise.

| column | meaning |
|---|---|
| family, case | names in the tests |
| peak | largest $\lvert u_s\rvert$ in m, without a frame $\lvert\theta\rvert$ in rad |
| overturned | whether the wall overturns |
| kappa | relative change of the peak per relative change of the motion |
| method, rtol | settings of the run |
| error | relative error of the peak; 0 also for differences below 1e-12 m |
| bound | allowed error |
| end | error of the final rotation over the largest rotation |
| impacts, lift_offs, steps | of the run; in chatter before rest they depend on method and rtol |
| verdict | right, refused or WRONG |
"""


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
    rows = []
    for family, cases in collection.FAMILIES.items():
        for hard in cases:
            truth = answers[family, hard.name]
            for method in METHODS:
                row = collection.evaluate(hard, truth, method, folder)
                rows.append(_values(family, hard.name, truth, row))
    with TARGET.open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
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
    families = {
        family: [r for r in rows if r["family"] == family] for family in collection.FAMILIES
    }
    by_method = {method: [r for r in rows if r["method"] == method] for method in METHODS}
    wrong = sum(row["verdict"] == "WRONG" for row in rows)
    lines = [
        _HEAD,
        "## Results",
        "",
        f"{len(rows)} rows, {wrong} wrong.",
        "",
        "Methods, over all cases: largest error as a share of its bound, rows with an error below "
        "1e-9, and all steps:",
        "",
        "| method | rows | right | refused | largest error/bound | in | below 1e-9 | steps |",
        "|---|---|---|---|---|---|---|---|",
        *(f"| `{method}` | {_share_of(rows_of)} |" for method, rows_of in by_method.items()),
        "",
        "Families of cases, over all methods:",
        "",
        "| family | rows | right | refused | largest error/bound | in | below 1e-9 | steps |",
        "|---|---|---|---|---|---|---|---|",
        *(f"| {family} | {_share_of(rows_of)} |" for family, rows_of in families.items()),
        "",
        "The most sensitive cases. Here an accurate integrator does not give an accurate answer:",
        "",
        "| case | kappa | largest error | bound |",
        "|---|---|---|---|",
        *_most_sensitive(rows),
    ]
    return "\n".join(lines) + "\n"


def _share_of(rows: list[dict[str, str]]) -> str:
    worst = max(rows, key=_share)
    counts = (sum(row["verdict"] == verdict for row in rows) for verdict in ("right", "refused"))
    fine = sum(float(row["error"]) < 1e-9 for row in rows)
    cells = (len(rows), *counts, f"{_share(worst):.1g}", worst["case"], fine)
    return " | ".join(map(str, (*cells, sum(int(row["steps"]) for row in rows))))


def _share(row: dict[str, str]) -> float:
    return float(row["error"]) / float(row["bound"])


def _most_sensitive(rows: list[dict[str, str]]) -> list[str]:
    cases: dict[str, list[dict[str, str]]] = {}
    for row in rows:
        cases.setdefault(row["case"], []).append(row)
    ranked = sorted(cases.items(), key=lambda item: -float(item[1][0]["kappa"]))[:10]
    return [
        f"| {name} | {same[0]['kappa']} | {max(float(row['error']) for row in same):.0e} "
        f"| {max(float(row['bound']) for row in same):.0e} |"
        for name, same in ranked
    ]


if __name__ == "__main__":
    sys.exit(main())
