"""Table of the hard cases: every case, every method, its true error and a verdict.

    python bench/hard_cases.py               docs/validation/hard-cases.md from the stored answers
    python bench/hard_cases.py --reference   first the answers that are not stored yet, or whose
                                             case has changed (all of them: some minutes)

The cases are those of tests/hard; the trusted answers come from quadruple precision.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests" / "hard"))

import collection  # noqa: E402
from hard_scenes import METHODS  # noqa: E402

TARGET = ROOT / "docs" / "validation" / "hard-cases.md"
_HEAD = """# Hard cases

Made by `python bench/hard_cases.py`; the cases are in `tests/hard/cases_*.py`, and
`tests/hard` runs every row as a test.

**Truth** is the same problem in quadruple precision (extrapolation of order 18, rtol 1e-19); the
difference from rtol 1e-16 is below 1e-13 of the peak wherever nothing amplifies it.
**error** is the relative error of the peak: of |u_s|, without a frame of |theta|; 0 also for
differences below 1e-12 m. **end** is the error of theta at the end over the largest |theta|.
**bound** is what is allowed, max(1e-7, 100 rtol kappa), where kappa is the relative change of the
peak per relative change of the motion. A row is *right* within the bound (the end: within
1000 rtol times its own sensitivity), *refused* when the method said so itself, else *WRONG*.
Impacts and steps in the chatter before rest depend on method and tolerance.
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
    stored = collection.read_answers() if collection.REFERENCE.exists() else {}
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
    lines, wrong, rows = [_HEAD], 0, 0
    for family, cases in collection.FAMILIES.items():
        lines += ["", f"## {family.capitalize()}", "", *_table_head()]
        for hard in cases:
            truth = answers[family, hard.name]
            for i, method in enumerate(METHODS):
                row = collection.judge(hard, truth, method, folder)
                lines.append(_line(hard.name if i == 0 else "", truth, row))
                wrong += row.verdict == "WRONG"
                rows += 1
    lines += ["", f"{rows} rows, {wrong} wrong."]
    TARGET.write_text("\n".join(lines) + "\n", encoding="utf-8")
    print(f"{TARGET.relative_to(ROOT)}: {rows} rows, {wrong} wrong")
    return wrong


def _table_head() -> list[str]:
    names = ("case", "peak", "kappa", "method", "rtol", "error", "bound", "end",
             "impacts", "lift-offs", "steps", "verdict")  # fmt: skip
    return ["| " + " | ".join(names) + " |", "|" + "---|" * len(names)]


def _line(name: str, truth: collection.Answer, row: collection.Row) -> str:
    peak = f"{truth.peak:.6g}" + (" (overturns)" if truth.overturned else "")
    cells = (name, peak if name else "", f"{truth.kappa:.1e}" if name else "", row.method,
             f"{row.rtol:.0e}", f"{row.error:.0e}", f"{row.bound:.0e}", f"{row.error_end:.0e}",
             str(row.impacts), str(row.lift_offs), str(row.steps), row.verdict)  # fmt: skip
    return "| " + " | ".join(cells) + " |"


if __name__ == "__main__":
    sys.exit(main())
