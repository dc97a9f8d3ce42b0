"""The version is defined once, and other descriptions of the package agree."""

import hashlib
import re
import sys
import tomllib
from importlib import metadata
from pathlib import Path

import pytest
import rwmf
from checkout import ROOT, run_words


def _text(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


def _found(pattern: str, name: str) -> str:
    match = re.search(pattern, _text(name), re.MULTILINE)
    assert match, f"{name}: nothing like {pattern}"
    return match[1]


VERSION = _found(r"^ +version: '([\d.]+)',$", "meson.build")
PYPROJECT = tomllib.loads(_text("pyproject.toml"))


def test_the_kernel_has_the_version_of_the_build() -> None:
    assert rwmf.__version__ == VERSION


def test_pages_have_the_version_and_its_day() -> None:
    """The newest released entry of the changelog and the citation have the present version.

    An entry without a day may come before it: the next version.
    """
    day = _found(rf"^## {re.escape(VERSION)} \((\d{{4}}-\d\d-\d\d)\)$", "CHANGELOG.md")
    entries = re.findall(r"^## (\S+) \((.*)\)$", _text("CHANGELOG.md"), re.MULTILINE)
    if entries[0][1] == "Unreleased":
        coming = entries.pop(0)[0]
        assert list(map(int, coming.split("."))) > list(map(int, VERSION.split(".")))
    assert entries[0] == (VERSION, day)
    assert _found(r"^version: (\S+)$", "CITATION.cff") == VERSION
    assert _found(r"^date-released: (\S+)$", "CITATION.cff") == day


def test_recipe_of_conda_has_the_packages_of_the_metadata() -> None:
    """Version, licence, run and build requirements, in the notation of conda."""
    jinja2, yaml = pytest.importorskip("jinja2"), pytest.importorskip("yaml")
    text = jinja2.Template(_text("tools/conda/meta.yaml")).render(
        PYTHON="python", compiler=lambda name: f"{name}-compiler"
    )
    recipe = yaml.safe_load(text)
    assert recipe["package"] == {"name": "rwmf", "version": VERSION}
    assert recipe["about"]["license"] == PYPROJECT["project"]["license"]

    def plain(words: list[str]) -> set[str]:
        return {word.replace(" ", "").replace("==", "") for word in words}

    needs = recipe["requirements"]
    python = f"python{PYPROJECT['project']['requires-python']}"
    assert plain(needs["run"]) == {*plain(PYPROJECT["project"]["dependencies"]), python}
    assert plain(PYPROJECT["build-system"]["requires"]) <= plain(needs["host"])


def test_page_of_installation_names_version_and_extras() -> None:
    page = _text("docs/howto/install.md")
    assert f"version = {{{VERSION}}}" in page and f"rwmf-{VERSION}-" in page
    extras = set(PYPROJECT["project"]["optional-dependencies"]) - {"bench", "test", "validation"}
    assert extras <= set(re.findall(r"`(\w+)`", page))


def test_metadata() -> None:
    project = PYPROJECT["project"]
    assert project["dynamic"] == ["version"]
    for pattern in project["license-files"]:
        assert list(ROOT.glob(pattern)), pattern
    assert project["license"] == _found(r"^ +license: '(.*)',$", "meson.build")
    assert project["license"] == _found(r"^license: (.*)$", "CITATION.cff")
    assert project["scripts"] == {"rwmf": "rwmf.__main__:main"}
    assert (ROOT / project["readme"]).is_file()


def test_the_pythons_of_the_wheels_are_those_of_the_metadata() -> None:
    versions = _found(r"for version in (3\.\d+(?: 3\.\d+)*); do", "tools/wheel").split()
    prefix = "Programming Language :: Python :: 3."
    said = [line for line in PYPROJECT["project"]["classifiers"] if line.startswith(prefix)]
    assert [f"{prefix[:-2]}{version}" for version in versions] == said
    assert PYPROJECT["project"]["requires-python"] == f">={versions[0]}"


def test_every_bundled_part_has_its_licence() -> None:
    table = _text("licenses/README.md")
    for name in re.findall(r"`([\w.-]+\.txt)`", table):
        assert (ROOT / "licenses" / name).stat().st_size > 500
    for part in ("SUNDIALS", "LAPACK", "uPlot", "libgfortran", "libgomp", "libquadmath"):
        assert part in table


def test_files_of_uplot_are_the_pinned_ones() -> None:
    """Package, version and hashes agree wherever they stand; the checkout has the files."""
    pin = _found(r"^(uplot-python==[\d.]+)$", "tools/requirements.txt")
    assert pin in PYPROJECT["build-system"]["requires"]
    named = _found(r"the one of (uplot-python [\d.]+)'", "driver/meson.build")
    assert named == pin.replace("==", " ")
    release = _found(r"uPlot ([\d.]+) ", "licenses/README.md")
    hashes = re.findall(r"'(uPlot\..*)': '([0-9a-f]{64})'", _text("driver/meson.build"))
    assert [name for name, _ in hashes] == ["uPlot.iife.js", "uPlot.min.css"]
    for name, expected in hashes:
        content = (Path(rwmf.__file__).parent / "explorer/page/vendor" / name).read_bytes()
        assert hashlib.sha256(content).hexdigest() == expected
        if name.endswith(".js"):
            assert f"(v{release})" in content.decode()[:400]


def test_every_function_of_the_header_has_a_fortran_interface(tmp_path: Path) -> None:
    """The foreign project `other-compiler` of tests/export compiles and uses it."""
    header = _text("include/rwmf.h")
    names = set(re.findall(r"\b(rwmf_\w+)\(", re.sub(r"/\*.*?\*/", "", header, flags=re.DOTALL)))
    (tmp_path / "host.h").write_text(header, encoding="utf-8")
    words = [sys.executable, ROOT / "tools/make-bindings.py", "client", "host.h"]
    done = run_words([*words, ROOT / "src/bindings/c/functions.table", "host.f90"], tmp_path)
    assert done.returncode == 0, done.stderr
    made = (tmp_path / "host.f90").read_text(encoding="utf-8")
    assert set(re.findall(r"(?:function|subroutine) (rwmf_\w+)\(.*", made)) == names
    assert max(map(len, made.splitlines())) <= 100


def test_pip_knows_the_optional_packages_in_a_checkout(tmp_path: Path) -> None:
    """`pip install 'rwmf[suites]'` finds the package installed, and adds that purpose."""
    tool = [sys.executable, ROOT / "tools/checkout-metadata.py", tmp_path]
    for _ in range(2):  # the second call replaces the metadata
        assert run_words(tool, ROOT).returncode == 0
    (found,) = metadata.distributions(path=[str(tmp_path)])
    assert (found.name, found.version) == ("rwmf", VERSION)
    optional = PYPROJECT["project"]["optional-dependencies"]
    assert found.metadata.get_all("Provides-Extra") == list(optional)
    assert found.requires == [
        *PYPROJECT["project"]["dependencies"],
        *(
            f'{wanted}; extra == "{purpose}"'
            for purpose in optional
            for wanted in optional[purpose]
        ),
    ]


@pytest.mark.parametrize("name", ["bindings/python/_kernel.*.so", "app/rwmf-batch"])
def test_the_kernel_needs_no_newer_c_library_than_the_wheels_say(name: str) -> None:
    """A function with a newer version of its symbol would end `tools/wheel` after its build."""
    minor = int(_found(r"^platform=\"manylinux_2_(\d+)_", "tools/wheel"))
    assert f"glibc 2.{minor} or newer" in _text("README.md")
    (program,) = (ROOT / "build/src").glob(name)
    listed = run_words(["objdump", "--dynamic-syms", program], ROOT)
    needed = [int(found) for found in re.findall(r"\(GLIBC_2\.(\d+)", listed.stdout)]
    assert 0 < max(needed) <= minor
