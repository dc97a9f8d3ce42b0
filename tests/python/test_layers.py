"""The rules of docs/architecture.md that the source text shows."""

from __future__ import annotations

import re

import pytest
from conftest import ROOT

SOURCES = {
    path.stem: path for path in sorted((ROOT / "src").iterdir()) if path.suffix.lower() == ".f90"
}
# the programs and the wrappers, which may print or stop
TOP = 6
_USE = re.compile(r"^\s*use\s*(?:,\s*intrinsic\s*)?(?:::)?\s*(\w+)", re.IGNORECASE)


def _layers() -> dict[str, int]:
    """Layer of every module: the table of docs/architecture.md."""
    text = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
    layers: dict[str, int] = {}
    for row in re.findall(r"^\| L(\d+) \|([^|]*)\|", text, re.MULTILINE):
        for name in re.findall(r"`(\w+)`", row[1]):
            layers[name] = int(row[0])
    return layers


def _code(name: str) -> list[str]:
    """Lines of a source without comments and without texts in quotes."""
    lines = SOURCES[name].read_text(encoding="utf-8").splitlines()
    return [re.sub(r"'[^']*'|\"[^\"]*\"", "''", line).split("!")[0] for line in lines]


def _used(name: str) -> set[str]:
    modules = {match[1].lower() for line in _code(name) if (match := _USE.match(line))}
    used = {module.removeprefix("rwmf_") for module in modules if module.startswith("rwmf")}
    return used - {name}


def test_every_source_has_a_layer() -> None:
    assert set(SOURCES) <= set(_layers()), "sources that docs/architecture.md does not name"


@pytest.mark.parametrize("name", list(SOURCES))
def test_uses_only_lower_layers(name: str) -> None:
    layers = _layers()
    # a source without a layer fails the test above, once
    own = layers.get(name, TOP)
    above = {used for used in _used(name) if layers.get(used, 0) > own}
    assert not above, f"{name} (L{own}) uses {above} of a layer above"


def test_no_circles() -> None:
    done: set[str] = set()
    waiting = {name: _used(name) for name in SOURCES}
    while waiting:
        ready = {name for name, used in waiting.items() if used <= done}
        assert ready, f"these use each other in a circle: {sorted(waiting)}"
        done |= ready
        waiting = {name: used for name, used in waiting.items() if name not in ready}


@pytest.mark.parametrize("name", list(SOURCES))
def test_only_its_own_files_name_sundials(name: str) -> None:
    foreign = re.compile(r"^\s*use\s*,?.*\b(f?sundials_\w+|f(?:cvode|arkode|sun|nvector)\w*)", re.I)
    if name not in ("sundials", "cvode", "erkstep"):
        assert not [line for line in _code(name) if foreign.match(line)]


@pytest.mark.parametrize("name", list(SOURCES))
def test_the_library_neither_prints_nor_stops(name: str) -> None:
    if _layers().get(name, TOP) < TOP:
        noisy = re.compile(r"^\s*(print\b|stop\b|error\s+stop\b|write\s*\(\s*\*)", re.I)
        assert not [line for line in _code(name) if noisy.match(line)]


@pytest.mark.parametrize("name", [name for name in SOURCES if name != "interrupt"])
def test_no_module_variables(name: str) -> None:
    """Between `module` and `contains` only constants, types and interfaces are declared."""
    depth = 0
    for line in _code(name):
        word = line.strip().lower()
        if word.startswith("contains") and depth == 0:
            break
        if (
            re.match(r"(type\s*(,|::|\s\w)|(abstract\s+)?interface\b)", word)
            and "(" not in word[:6]
        ):
            depth += 1
        elif re.match(r"end\s*(type|interface)\b", word):
            depth -= 1
        elif depth == 0 and "::" in word and SOURCES[name].stem != "batch_program":
            allowed = ("public", "private", "use", "import", "integer, parameter")
            assert "parameter" in word or word.startswith(allowed), line
        assert not re.match(r".*\bsave\b", word), line


def test_one_python_module_imports_the_extension() -> None:
    importers = [
        path.name
        for path in (ROOT / "driver" / "rwmf").glob("*.py")
        if re.search(r"import _kernel|_kernel import", path.read_text(encoding="utf-8"))
    ]
    assert importers == ["_library.py"]


def test_plot_never_simulates() -> None:
    text = (ROOT / "driver" / "rwmf" / "plot.py").read_text(encoding="utf-8")
    assert not re.search(r"^(from|import) rwmf", text, re.MULTILINE)


@pytest.mark.parametrize("name", list(SOURCES))
def test_files_stay_small(name: str) -> None:
    assert len(SOURCES[name].read_text(encoding="utf-8").splitlines()) <= 450
