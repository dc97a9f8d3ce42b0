"""Required items of Python docstrings: public functions, methods and classes.

Names are public without a leading underscore, in public scopes outside functions. The docstring of
a property gives its value, and that of a class its arguments. A method common to several classes of
a file is explained in the first of them.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

from docstrings.finding import Finding

__all__ = ["check"]

_Function = ast.FunctionDef | ast.AsyncFunctionDef
_NOTHING = ("None", "NoReturn", "Never")
# a property needs a first line only
_BARE = ("property", "cached_property", "setter")


def check(path: Path) -> tuple[int, list[Finding]]:
    """Look at a file.

    Parameters
    ----------
    path : path
        The file.

    Returns
    -------
    int
        Number of checked docstrings.
    list of Finding
        Missing items.
    """
    tree = ast.parse(path.read_text(encoding="utf-8"))
    n, found = 0, []
    explained: set[str] = set()
    for node, name in _public(tree.body, ""):
        n += 1
        text = ast.get_docstring(node) or ""
        if isinstance(node, ast.ClassDef):
            missing = list(_missing_of_class(node, text))
        else:
            in_common = name.partition(".")[2]
            missing = [] if in_common in explained else list(_missing_of_function(node, text))
            explained |= {in_common} - {""}
        missing += _missing_shapes(text)
        missing = missing if text else ["no docstring"]
        found += [Finding(path, node.lineno, f"{name}: {fault}") for fault in missing]
    return n, found


def _public(body: list[ast.stmt], within: str) -> Iterator[tuple[ast.ClassDef | _Function, str]]:
    for node in body:
        if isinstance(node, ast.ClassDef | _Function) and not node.name.startswith("_"):
            # the docstring of an overloaded function is that of its implementation
            if any(_last_name(decorator) == "overload" for decorator in node.decorator_list):
                continue
            yield node, within + node.name
            if isinstance(node, ast.ClassDef):
                yield from _public(node.body, f"{within}{node.name}.")


def _missing_of_class(node: ast.ClassDef, text: str) -> Iterator[str]:
    for function in node.body:
        if isinstance(function, _Function) and function.name == "__init__":
            yield from _missing_arguments(function, text)
    fields = [part for part in node.body if isinstance(part, ast.AnnAssign)]
    names = [part.target.id for part in fields if isinstance(part.target, ast.Name)]
    documented = _names_of(text, "Attributes") | _names_of(text, "Parameters")
    for name in names:
        if not name.startswith("_") and name not in documented:
            yield f"attribute {name} is not in the docstring"


def _missing_of_function(node: _Function, text: str) -> Iterator[str]:
    if any(_last_name(decorator) in _BARE for decorator in node.decorator_list):
        return
    yield from _missing_arguments(node, text)
    gives = node.returns is not None and ast.unparse(node.returns).strip("'\"") not in _NOTHING
    if gives and not _has_section(text, "Returns") and not _has_section(text, "Yields"):
        yield "no section Returns or Yields"
    if _raises(node) and not _has_section(text, "Raises"):
        yield "no section Raises"


def _missing_arguments(node: _Function, text: str) -> Iterator[str]:
    arguments = node.args
    names = [item.arg for item in (*arguments.posonlyargs, *arguments.args, *arguments.kwonlyargs)]
    names += [f"*{arguments.vararg.arg}"] if arguments.vararg else []
    names += [f"**{arguments.kwarg.arg}"] if arguments.kwarg else []
    documented = _names_of(text, "Parameters")
    for name in names:
        if name not in ("self", "cls") and not name.startswith("_") and name not in documented:
            yield f"argument {name} is not in the docstring"


def _missing_shapes(text: str) -> Iterator[str]:
    """Return the arrays whose entry, type and description together, gives no shape."""
    for entry in re.findall(r"^\S[^\n]*ndarray[^\n]*(?:\n +[^\n]+)*", text, re.MULTILINE):
        if "shape" not in entry:
            yield f"no shape of an array: {entry.splitlines()[0]}"


def _last_name(node: ast.expr) -> str:
    return ast.unparse(node).split("(")[0].split(".")[-1]


def _has_section(text: str, title: str) -> bool:
    return re.search(rf"^{title}\n-+$", text, re.MULTILINE) is not None


def _names_of(text: str, title: str) -> set[str]:
    """Names that a section of a docstring explains."""
    found = re.search(rf"^{title}\n-+\n(.*?)(?=^\S[^\n]*\n-+$|\Z)", text, re.MULTILINE | re.DOTALL)
    if found is None:
        return set()
    heads = re.findall(r"^(\S[^\n]*)", found[1], re.MULTILINE)
    return {name.strip() for head in heads for name in head.split(" : ")[0].split(",")}


def _raises(node: _Function) -> bool:
    """Check whether the body raises an error itself, apart from re-raised ones and assertions."""
    nested = {
        inner
        for part in ast.walk(node)
        if isinstance(part, _Function | ast.Lambda | ast.ClassDef) and part is not node
        for inner in ast.walk(part)
    }
    return any(
        isinstance(part, ast.Raise) and part.exc is not None and part not in nested
        for part in ast.walk(node)
    )
