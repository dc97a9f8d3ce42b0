"""Measure the sources: modules, dependencies, sizes of procedures, and code lines by folder.

python tests/architecture/graph.py [TREE ...]

A TREE is a checkout or a commit of this one; without any, this checkout. Each becomes a column.
"""

from __future__ import annotations

import ast
import re
import statistics
import subprocess
import sys
import tarfile
import tempfile
from collections.abc import Callable
from io import BytesIO
from pathlib import Path

import rules
from fortran import Procedure, Tree, read_tree

ROOT = Path(__file__).resolve().parents[2]
EFFECT_GROUPS = ("damper", "inerter", "link", "fuse", "yielding", "storeys", "vertical", "p_delta")
# Folders whose code lines are counted.
COUNTED = ("src", "driver", "bench", "tools")
# Comments by the suffix of a file; a file without suffix is a shell script. Python is parsed.
_COMMENTS = {
    (".f90", ".F90"): re.compile(r"^\s*![^\n]*", re.MULTILINE),
    (".c", ".js", ".css"): re.compile(r"/\*.*?\*/|^[ \t]*//[^\n]*", re.DOTALL | re.MULTILINE),
    ("", ".sh", ".build", ".awk"): re.compile(r"^\s*#[^\n]*", re.MULTILINE),
    (".html",): re.compile(r"<!--.*?-->", re.DOTALL),
}
# Entry points of a simulation and of an ordinate, with their former names.
SIMULATE = ("rwmf_simulation_simulate", "rwmf_simulation")
ORDINATE = ("rwmf_spectrum_lane_rows", "rwmf_spectrum_fast_driver")

# low + (high - low)/2 and (low + high)/2
_HALVED = re.compile(
    r"(?P<low>\w+(?:\(\d\))?)\s*\+\s*\([\w%()]+\s*-\s*(?P=low)\)/2\b|\(low \+ high\)/2\b"
)


def _first(tree: Tree, names: tuple[str, ...]) -> str:
    return next(name for name in names if name in tree.arrows)


def _procedures(tree: Tree) -> list[Procedure]:
    return [procedure for source in tree.sources for procedure in source.procedures]


def _groups(tree: Tree) -> dict[str, str]:
    """Group of every module within which any may use any: its top folder.

    Without folders: its layer, by the table that docs/developer/architecture.md then has.
    """
    page = next((tree.root.parent / "docs").rglob("architecture.md"))
    text = page.read_text(encoding="utf-8") if page.is_file() else ""
    layers = {
        f"rwmf_{name}": layer
        for layer, names in re.findall(r"^\| (L\d+) \|([^|]*)\|", text, re.MULTILINE)
        for name in re.findall(r"`(\w+)`", names)
    }
    if not (tree.root / "rwmf").is_dir():
        return {source.module: layers.get(source.module, "L6") for source in tree.sources}
    order = rules.order_of_folders(tree.root)
    return {source.module: rules.top_folder(source.path, order) for source in tree.sources}


def _inside(tree: Tree) -> int:
    group = _groups(tree)
    return sum(group[name] == group[used] for name, all_ in tree.arrows.items() for used in all_)


def _naming(tree: Tree, group: str) -> int:
    """Files whose code names a group: as a component, by its type, or in a text."""
    named = re.compile(rf"%{group}\b|'{group}\b|\b{group}_t\b", re.IGNORECASE)
    return sum(
        any(named.search(re.sub(r"!.*", "", source.lines[number - 1])) for number in source.code)
        for source in tree.sources
    )


def _halvings(tree: Tree) -> int:
    """Procedures that halve a bracket in a loop."""

    def halves(procedure: Procedure) -> bool:
        texts = [statement.text for statement in procedure.statements]
        return any(re.match(r"(\w+:\s*)?do\b", text) for text in texts) and any(
            _HALVED.search(text) for text in texts
        )

    return sum(halves(procedure) for procedure in _procedures(tree))


def _largest_folder(tree: Tree) -> int:
    folders = [source.path.parent for source in tree.sources]
    return max(folders.count(folder) for folder in folders)


def _all_lines(tree: Tree) -> int:
    return sum(
        len(path.read_text(encoding="utf-8").splitlines())
        for path in tree.root.rglob("*")
        if path.is_file()
    )


def code_lines(path: Path) -> int:
    """Count the lines of a file that hold code: no blank lines, comments and docstrings.

    Parameters
    ----------
    path : path
        The file.

    Returns
    -------
    int
        Their number; 0 for a file that is no source.
    """
    if path.suffix == ".py":
        lines = _without_docstrings(path.read_text(encoding="utf-8"))
        return sum(bool(line.strip()) and line.lstrip()[0] != "#" for line in lines)
    comment = next(
        (found for suffixes, found in _COMMENTS.items() if path.suffix in suffixes), None
    )
    if comment is None:
        return 0
    text = comment.sub("", path.read_text(encoding="utf-8"))
    return sum(bool(line.strip()) for line in text.splitlines())


def _counted(tree: Tree, folder: str) -> int:
    """Code lines of the tracked files of a folder; of all files in an archive."""
    root = tree.root.parent
    tracked = subprocess.run(
        ["git", "-C", root, "ls-files", "-z", "--", folder], capture_output=True, check=False
    ).stdout.decode()
    paths = [root / name for name in tracked.split("\0") if name]
    return sum(code_lines(path) for path in paths or (root / folder).rglob("*") if path.is_file())


def _without_docstrings(text: str) -> list[str]:
    lines = text.splitlines()
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            first = node.body[0] if node.body else None
            if first and ast.get_docstring(node) is not None:
                lines[first.lineno - 1 : first.end_lineno] = [""] * (
                    (first.end_lineno or first.lineno) - first.lineno + 1
                )
    return lines


def _critical(tree: Tree) -> int:
    return sum(
        bool(re.match(r"\s*!\$omp critical\b", line))
        for source in tree.sources
        for line in source.lines
    )


ROWS: dict[str, Callable[[Tree], object]] = {
    "modules": lambda tree: len(tree.sources),
    "most in one folder": _largest_folder,
    "arrows (`use`), those through macros too": lambda tree: sum(map(len, tree.arrows.values())),
    "of these inside a layer or top folder": _inside,
    "longest chain": lambda tree: len(tree.longest_chain),
    "modules that `simulate` meets": lambda tree: len(tree.closure(_first(tree, SIMULATE))),
    "modules that an ordinate adds": lambda tree: len(
        tree.closure(_first(tree, ORDINATE)) - tree.closure(_first(tree, SIMULATE))
    ),
    **{
        f"modules that name the group `&{word}`": lambda tree, word=word: _naming(tree, word)
        for word in EFFECT_GROUPS
    },
    "lines of Fortran": lambda tree: sum(len(source.lines) for source in tree.sources),
    "of these code": lambda tree: sum(len(source.code) for source in tree.sources),
    "lines of all files in `src`": _all_lines,
    **{
        f"code lines of all files in `{folder}`": lambda tree, folder=folder: _counted(tree, folder)
        for folder in COUNTED
    },
    "code lines of the four": lambda tree: sum(_counted(tree, folder) for folder in COUNTED),
    "longest file": lambda tree: max(len(source.lines) for source in tree.sources),
    "procedures": lambda tree: len(_procedures(tree)),
    "median of their code lines": lambda tree: f"{_median(tree, 'code_lines'):g}",
    f"over {rules.MOST_LINES} code lines": lambda tree: _over(tree, "code_lines", rules.MOST_LINES),
    "median of their arguments": lambda tree: f"{_median(tree, 'arguments'):g}",
    "more than 6 arguments": lambda tree: _over(tree, "arguments", 6),
    f"more than {rules.MOST_ARGUMENTS}": lambda tree: _over(
        tree, "arguments", rules.MOST_ARGUMENTS
    ),
    "that halve a bracket in a loop": _halvings,
    "that return a text of deferred length": lambda tree: sum(
        procedure.returns_deferred_text for procedure in _procedures(tree)
    ),
    "critical sections": _critical,
}


def _median(tree: Tree, what: str) -> float:
    return statistics.median(getattr(procedure, what) for procedure in _procedures(tree))


def _over(tree: Tree, what: str, bound: int) -> int:
    return sum(getattr(procedure, what) > bound for procedure in _procedures(tree))


def _measure(root: Path) -> list[str]:
    tree = read_tree(root / "src")
    return [str(row(tree)) for row in ROWS.values()]


def _column(name: str) -> list[str]:
    if (Path(name) / "src").is_dir():
        return _measure(Path(name).resolve())
    archive = subprocess.run(
        ["git", "-C", ROOT, "archive", name, *COUNTED, "docs"],
        capture_output=True,
        check=True,
    ).stdout
    with tempfile.TemporaryDirectory() as folder:
        with tarfile.open(fileobj=BytesIO(archive)) as tar:
            tar.extractall(folder, filter="data")
        return _measure(Path(folder))


def main() -> None:
    """Print the table."""
    names = sys.argv[1:] or [str(ROOT)]
    columns = [_column(name) for name in names]
    print("| | " + " | ".join(f"`{Path(name).name or 'this'}`" for name in names) + " |")
    print("|---|" + "---:|" * len(names))
    for row, values in zip(ROWS, zip(*columns, strict=True), strict=True):
        print(f"| {row} | " + " | ".join(values) + " |")


if __name__ == "__main__":
    main()
