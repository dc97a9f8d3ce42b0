"""Imports in the driver's sources: extensions, argparse. pyproject.toml has the order of rooms."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
from checkout import ROOT, run_python

DRIVER = ROOT / "driver" / "rwmf"


def _imports(path: Path) -> Iterator[str]:
    """Yield the names of the modules that a file imports, with the imported names."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (name.name for name in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield from (f"{node.module}.{name.name}" for name in node.names)


def _importers(pattern: str) -> set[str]:
    return {
        path.relative_to(DRIVER).as_posix()
        for path in DRIVER.rglob("*.py")
        if any(re.match(pattern, name) for name in _imports(path))
    }


def test_one_package_imports_the_extensions() -> None:
    found = _importers(r"rwmf\._(kernel|reference)\b")
    assert found
    assert {name.split("/")[0] for name in found} == {"kernel"}


def test_one_package_knows_the_command_line() -> None:
    assert {name.split("/")[0] for name in _importers("argparse")} == {"cli"}


def test_one_package_writes_files() -> None:
    """Others write into temporary folders only."""
    writing = r"\.write_(text|bytes)\(|open\([^)]*[\"'][wxa]b?[\"']|\.to_(netcdf|csv)\("
    found = {
        path.relative_to(DRIVER).as_posix()
        for path in DRIVER.rglob("*.py")
        if re.search(rf"(?<!files){writing}", path.read_text(encoding="utf-8"))
    }
    own = {"cli/streams.py", "hosts/fmu.py", "explorer/model.py", "explorer/server.py"}
    assert {name for name in found - own if not name.startswith("kernel/")} == set()


def test_no_module_hides_behind_a_public_function() -> None:
    """`import rwmf.X` and `rwmf.X` are the same for every public X that is a module."""
    import rwmf

    modules = {path.stem for path in DRIVER.iterdir() if path.suffix == ".py" or path.is_dir()}
    hidden = [name for name in rwmf.__all__ if name in modules and callable(getattr(rwmf, name))]
    assert not hidden
    assert not [name for name in rwmf.__all__ if not hasattr(rwmf, name)]
    assert set(rwmf.__all__) <= set(dir(rwmf))


_CASE = ROOT / "inputs" / "fig12_one_cosine.nml"


@pytest.mark.parametrize(
    ("words", "without"),
    [
        (["--version"], ("numpy", "importlib.metadata")),
        (["--help"], ("numpy", "rwmf._kernel")),
        (["study", "wall", "--help"], ("numpy", "rwmf._kernel")),
        (["check", str(_CASE)], ("rwmf._reference",)),
        (["run", str(_CASE)], ("rwmf._reference",)),
        (None, ("numpy", "rwmf._kernel", "argparse")),
    ],
)
def test_commands_import_what_they_need(words: list[str] | None, without: tuple[str, ...]) -> None:
    """Slow imports are made only by the commands that need them."""
    call = "import rwmf" if words is None else f"from rwmf.cli import main; main({words!r})"
    code = f"import sys; {call}; print(*sys.modules, sep='\\n')"
    loaded = set(run_python(code, ROOT).stdout.splitlines())
    slow = {"xarray", "pandas", "matplotlib", "scipy", "h5py", "distributed", *without}
    assert "rwmf" in loaded
    assert not slow & loaded
