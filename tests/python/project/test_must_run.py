"""With RWMF_MUST_RUN, a skip is a failure with test and reason."""

import sys
from pathlib import Path

import pytest
from checkout import SUPPORT, run_words
from may_skip import MAY_SKIP

TESTS = {
    "test_files.py": "def test_it(): pytest.skip('only root can give files away')",
    "test_other.py": "def test_it(): pytest.skip('only root can give files away')",
    "test_all.py": "pytest.importorskip('no_such_package')",
}
EXPECTED = {
    "0": ["3 skipped"],
    "1": ["1 failed, 1 skipped, 1 error", "test_other.py::test_it must not", "'no_such_package'"],
}


@pytest.mark.parametrize("must_run", EXPECTED)
def test_a_skip_is_a_failure(must_run: str, tmp_path: Path) -> None:
    """A skipped test and a skipped file; the same reason in a file that may give it."""
    for name, text in TESTS.items():
        (tmp_path / name).write_text(f"import pytest\n{text}\n", encoding="ascii")
    words = [sys.executable, "-m", "pytest", "-p", "may_skip", "--continue-on-collection-errors"]
    place = {"RWMF_MUST_RUN": must_run, "PYTHONPATH": str(SUPPORT)}
    done = run_words([*words, "."], tmp_path, **place)
    assert (done.returncode == 0) == (must_run == "0"), done.stdout
    assert all(part in done.stdout for part in EXPECTED[must_run]), done.stdout


def test_every_exception_is_of_a_test() -> None:
    """No line of the list outlives its file."""
    files = {path.name for path in SUPPORT.parent.rglob("test_*.py")}
    assert {file for file, _, _ in MAY_SKIP} <= files
