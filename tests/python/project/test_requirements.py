"""The development environment: every package pinned, every file of it known by its hash."""

import importlib.metadata
import re
import tomllib

import pytest
from checkout import ROOT
from packaging.markers import default_environment
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

_TOOLS = ROOT / "tools"
_NAMES = ("requirements", "pip-tools", "docs", "wheel")


def _direct(name: str) -> list[Requirement]:
    lines = (_TOOLS / f"{name}.txt").read_text(encoding="utf-8").splitlines()
    return [Requirement(line) for line in lines if line and line[0] not in "#-"]


def _locked(name: str) -> dict[str, tuple[str, int]]:
    """Version and number of hashes of every package."""
    text = (_TOOLS / f"{name}.lock").read_text(encoding="utf-8").replace("\\\n", "")
    found = {}
    for line in text.splitlines():
        pin = re.match(r"([\w.-]+)==(\S+)(.*)", line)
        if pin:
            hashes = re.findall(r"--hash=sha256:[0-9a-f]{64}(?= |$)", pin[3])
            found[canonicalize_name(pin[1])] = (pin[2], len(hashes))
        else:
            assert not line or line.lstrip()[0] == "#", line
    return found


@pytest.mark.parametrize("name", _NAMES)
def test_every_package_has_a_version_and_hashes(name: str) -> None:
    locked = _locked(name)
    assert all(n > 0 for _, n in locked.values())
    for wanted in _direct(name):
        assert str(wanted.specifier) == f"=={locked[canonicalize_name(wanted.name)][0]}"


def test_what_packages_pull_in_is_locked() -> None:
    """Nothing that an installed package of the lock needs is left to the day of the set-up."""
    locked = _locked("requirements")
    environment = default_environment() | {"extra": ""}
    for name, (version, _) in locked.items():
        try:
            installed = importlib.metadata.distribution(name)
        except importlib.metadata.PackageNotFoundError:
            pytest.skip(f"{name} is not installed: not the environment of tools/run")
        if installed.version != version:
            pytest.skip(f"{name} {installed.version}: not the environment of tools/run")
        for line in installed.requires or ():
            wanted = Requirement(line)
            if wanted.marker is None or wanted.marker.evaluate(environment):
                pinned = locked[canonicalize_name(wanted.name)][0]
                assert wanted.specifier.contains(pinned, prereleases=True), (name, line)


def test_wheels_are_built_with_locked_packages() -> None:
    """The lock has every package of pyproject.toml, in the version of the checkout."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    locked, checkout = _locked("wheel"), _locked("requirements")
    needs = [Requirement(line) for line in project["build-system"]["requires"]]
    for wanted in [*needs, Requirement("pip>=23.1")]:
        name = canonicalize_name(wanted.name)
        assert wanted.specifier.contains(locked[name][0])
        assert name == "pip" or locked[name][0] == checkout[name][0]
