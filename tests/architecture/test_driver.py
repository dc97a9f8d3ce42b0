"""Imports in the driver's sources: extensions, argparse, simulations."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
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
    assert {name.split("/")[0] for name in found} == {"_library"}


def test_one_package_knows_the_command_line() -> None:
    assert {name.split("/")[0] for name in _importers("argparse")} == {"cli"}


def test_figures_never_simulate() -> None:
    computing = r"rwmf\.(_library|_simulation|_spectrum|_sweep|simulate|spectrum|sweep)\b"
    assert not [name for name in _importers(computing) if name.startswith(("plot", "loops"))]


def test_no_module_hides_behind_a_public_function() -> None:
    """`import rwmf.X` and `rwmf.X` are the same for every public X that is a module."""
    import rwmf

    modules = {path.stem for path in DRIVER.iterdir() if path.suffix == ".py" or path.is_dir()}
    hidden = [name for name in rwmf.__all__ if name in modules and callable(getattr(rwmf, name))]
    assert not hidden
    assert not [name for name in rwmf.__all__ if not hasattr(rwmf, name)]
    assert set(rwmf.__all__) <= set(dir(rwmf))


def test_base_names_are_unique() -> None:
    """A file is known by its name, without its folder; every package has these two."""
    names = [path.stem for path in DRIVER.rglob("*.py")]
    assert {name for name in names if names.count(name) > 1} == {"__init__"}


def test_no_circles() -> None:
    """Modules that import each other, however indirectly, at the top of their files."""
    modules = {path: _module(path) for path in DRIVER.rglob("*.py")}
    arrows: dict[str, set[str]] = {}
    for path, name in modules.items():
        tops = ast.parse(path.read_text(encoding="utf-8")).body
        used = [
            (str(node.module), f"{node.module}.{item.name}")
            for node in tops
            if isinstance(node, ast.ImportFrom)
            for item in node.names
        ]
        arrows[name] = {inner if inner in modules.values() else outer for outer, inner in used}
    while free := [name for name, targets in arrows.items() if not targets & arrows.keys()]:
        for name in free:
            del arrows[name]
    assert not arrows


def _module(path: Path) -> str:
    parts = path.relative_to(DRIVER.parent).with_suffix("").parts
    return ".".join(parts).removesuffix(".__init__")


def _names(path: Path) -> set[str]:
    """Words of the imports and of the texts of a file, where a module may be named."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    texts = {node.value for node in ast.walk(tree) if isinstance(node, ast.Constant)}
    return {
        word
        for text in (*_imports(path), *filter(lambda text: isinstance(text, str), texts))
        for word in re.findall(r"\w+", text)
    }


def test_no_module_is_there_for_tools_alone() -> None:
    """Each is public, or another module of the package names it."""
    import rwmf

    named = {path: _names(path) for path in DRIVER.rglob("*.py")}
    unused = [
        path.relative_to(DRIVER).as_posix()
        for path in named
        if path.stem not in (*rwmf.__all__, "__init__", "__main__")
        if not any(path.stem in words for other, words in named.items() if other != path)
    ]
    assert not unused


_CASE = ROOT / "inputs" / "fig12_one_cosine.nml"


@pytest.mark.parametrize(
    ("words", "without"),
    [
        (["--version"], ()),
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
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT
    )
    loaded = set(done.stdout.splitlines())
    slow = {"xarray", "pandas", "matplotlib", "scipy", "h5py", "distributed", *without}
    assert "rwmf" in loaded
    assert not slow & loaded


# colours by letter, as in the format ".k" of a plot
_LETTERS = re.compile(r"[.,ox+*sdDvP^|_:-]*[bgrcmyk][.,ox+*sdDvP^|_:-]*")
_DRAWING = ("plot", "loglog", "semilogx", "semilogy")


def _is_text(node: ast.expr | None) -> bool:
    """Return True for a text that names a line style; 'none' draws nothing."""
    return isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value != "none"


def _own_looks(path: Path) -> Iterator[str]:
    """Colours and settings that a file gives itself."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Attribute) and node.attr in ("rcParams", "rc_context", "colormaps"):
            yield node.attr
        elif isinstance(node, ast.Attribute) and ast.unparse(node) == "plt.style":
            yield "plt.style"
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            if re.fullmatch(r"#[0-9a-fA-F]{6}|C\d", node.value):
                yield node.value
        elif isinstance(node, ast.keyword) and re.search("color$|cmap$|fontsize$", node.arg or ""):
            if _is_text(node.value):
                yield ast.unparse(node)
        elif isinstance(node, ast.Dict):
            pairs = zip(node.keys, node.values, strict=True)
            yield from (
                f"{key.value}: {ast.unparse(value)}"
                for key, value in pairs
                if isinstance(key, ast.Constant) and str(key.value).endswith("color")
                if _is_text(value)
            )
        elif isinstance(node, ast.Call) and getattr(node.func, "attr", "") in _DRAWING:
            texts = (ast.literal_eval(arg) for arg in node.args if _is_text(arg))
            yield from (text for text in texts if _LETTERS.fullmatch(text))


def test_one_module_has_the_style_of_figures() -> None:
    style = DRIVER / "plotting" / "style.py"
    sources = [path for folder in (DRIVER, ROOT / "plots", ROOT / "bench", ROOT / "examples")
               for path in folder.rglob("*.py") if path != style]  # fmt: skip
    assert {path.relative_to(ROOT).as_posix(): list(_own_looks(path)) for path in sources
            if any(_own_looks(path))} == {}  # fmt: skip
    assert any(_own_looks(style))


def test_text_of_figures_is_readable() -> None:
    pytest.importorskip("matplotlib")
    from rwmf.plotting.style import WIDTH, style

    sizes = {key: value for key, value in style().items() if "size" in key}
    assert sizes
    assert min(sizes.values()) >= 8
    # at the width of a page the figure is not made smaller
    assert WIDTH <= 8
