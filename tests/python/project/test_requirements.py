"""The development environment: every package pinned. pip itself refuses one without a hash."""

import sys

import pytest
from checkout import ROOT, run_words
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

_TOOLS = ROOT / "tools"


@pytest.mark.parametrize("name", ["requirements", "pip-tools", "docs", "wheel"])
def test_direct_packages_have_the_versions_of_the_lock(name: str) -> None:
    locked = (_TOOLS / f"{name}.lock").read_text(encoding="utf-8").splitlines()
    for line in (_TOOLS / f"{name}.txt").read_text(encoding="utf-8").splitlines():
        if line and line[0] not in "#-":
            wanted = Requirement(line)
            assert f"{canonicalize_name(wanted.name)}{wanted.specifier} \\" in locked


def test_what_packages_pull_in_is_installed() -> None:
    """Nothing that an installed package needs is left to the day of the set-up."""
    done = run_words([sys.executable, "-m", "pip", "check"], ROOT)
    assert done.returncode == 0, done.stdout
