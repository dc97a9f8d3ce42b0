"""Rules of the architecture: each takes a tree of sources and returns its violations."""

import re
from collections import defaultdict
from collections.abc import Iterable, Mapping
from pathlib import Path, PurePosixPath

from fortran import (
    INTRINSIC,
    OF_HEADER,
    SUNDIALS,
    DerivedType,
    Procedure,
    Source,
    Statement,
    Tree,
    build_lines,
    names_in,
)

PACKAGE = "rwmf"  # name of the facade, of the folder below it, and prefix of all modules
MODEL_FOLDER = PurePosixPath("rwmf/model")
EFFECTS = MODEL_FOLDER / "effects"
SUNDIALS_FOLDERS = [PurePosixPath("rwmf/integrator/sundials"), PurePosixPath("rwmf/paper")]
# Modules that name all effects: the list, and the loops over lanes.
NAMES_EFFECTS = {"list", "loops"}

MOST_LINES = 60
MOST_ARGUMENTS = 8
LONGEST_FILE = 900
MOST_COMPONENTS = 30
MODEL = "model_t"  # constants of an assembled scene
EQUATION = "equation_t"  # a model with its discrete state

_SUBDIR = re.compile(r"\bsubdir\('([^']+)'\)")
_SOURCE_NAME = re.compile(r"(?<![/+] )'(\w+\.(?:f90|F90|c))'")
_TRANSFER = re.compile(r"(?:read|write|open|close|inquire|rewind|backspace)\s*\(", re.IGNORECASE)
_NOISE = re.compile(
    r"(print\b|pause\b|(error\s+)?stop\b|call\s+(exit|abort)\b"
    r"|write\s*\(\s*(unit\s*=\s*)?(\*|output_unit\b|error_unit\b|[06]\s*[,)]))",
    re.IGNORECASE,
)
_DECLARATION = re.compile(
    r"(integer|real|complex|logical|character|double\s*precision|type\s*\(|class\s*\(|procedure\s*\()",
    re.IGNORECASE,
)
_OF_TYPE = re.compile(r"\b(?:type|class)\s*\(\s*(\w+)\s*\)", re.IGNORECASE)
_POINTER = re.compile(r",\s*pointer\b", re.IGNORECASE)
_KEPT = re.compile(r"(save\b|common\s*/|equivalence\s*\(|data\s+\w+\s*[/,(])", re.IGNORECASE)


def order_of_folders(root: Path) -> list[str]:
    """Top folders in the order in which meson.build visits them: a folder may use those before.

    The folders below `rwmf` are followed by the facade, `rwmf.f90`, a folder by itself.
    """
    order: list[str] = []
    for folder in _visited(root, ""):
        if folder == PACKAGE:
            order += [f"{PACKAGE}/{name}" for name in _visited(root, PACKAGE)]
        if any((root / folder).glob("*.[fF]90")) or folder == PACKAGE:
            order.append(folder)
    return order


def _visited(root: Path, folder: str) -> list[str]:
    return _SUBDIR.findall(build_lines((root / folder / "meson.build").read_text("utf-8")))


def top_folder(path: Path, order: Iterable[str]) -> str:
    """Top folder of a file; the facade counts as one, '' for other files."""
    folder = path.parent.as_posix()
    if path.as_posix() == f"{PACKAGE}.f90":
        return PACKAGE
    inside = [top for top in order if f"{folder}/".startswith(f"{top}/") and top != PACKAGE]
    return max(inside, key=len, default="")


def wrong_names(tree: Tree) -> list[str]:
    """Modules that are not named by their path."""
    return [
        f"{source.path}: contains {source.module}, not {expected}"
        for source in tree.sources
        if source.module != (expected := _module_name(source.path)) and not source.is_program
    ]


def _module_name(path: Path) -> str:
    parts = path.with_suffix("").parts
    return "_".join(parts if parts[0] == PACKAGE else (PACKAGE, *parts)).lower()


def unknown_targets(tree: Tree) -> list[str]:
    """Arrows to modules that no file contains and that are not the compiler's; included files."""
    known = tree.owners.keys()
    found = [
        f"{source.path}:{line}: uses {name}, which no source contains"
        for source in tree.sources
        for name, line in source.used.items()
        if name not in known and not any(of.match(name) for of in (INTRINSIC, SUNDIALS, OF_HEADER))
    ]
    return found + [
        f"{source.path}:{line}: includes a file"
        for source in tree.sources
        for line in source.includes
    ]


def against_order(tree: Tree, order: list[str]) -> list[str]:
    """List arrows to a later folder, and files in no folder."""
    place = {name: number for number, name in enumerate(order)}
    found = []
    for source in tree.sources:
        own = top_folder(source.path, order)
        if own not in place:
            found.append(f"{source.path}: lies in no folder that meson.build visits")
            continue
        for name, line in source.used.items():
            target = tree.owners.get(name)
            folder = top_folder(target.path, order) if target else own
            if folder in place and place[folder] > place[own]:
                found.append(f"{source.path}:{line}: {own} uses {name} of {folder}")
    return found


def between_effects(tree: Tree) -> list[str]:
    """List arrows from one effect to another."""
    found = []
    for source in tree.sources:
        own = _effect(source.path)
        for name, line in source.used.items():
            target = _effect(tree.owners[name].path) if name in tree.owners else ""
            if own and target and target != own and own not in NAMES_EFFECTS:
                found.append(f"{source.path}:{line}: {own} uses {name} of {target}")
    return found


def _effect(path: Path) -> str:
    """Effect that a file belongs to: its name but for `_loop`, or its folder below `effects`."""
    pure = PurePosixPath(path.as_posix())
    if not pure.is_relative_to(EFFECTS):
        return ""
    return pure.relative_to(EFFECTS).with_suffix("").parts[0].removesuffix("_loop")


def shared_names(tree: Tree) -> list[str]:
    """Find base names of several files below the package, and names of several derived types."""
    places: dict[str, list[str]] = defaultdict(list)
    for source in tree.sources:
        if source.path.parts[0] == PACKAGE:
            places[source.path.stem.lower()].append(source.path.as_posix())
        for kind in source.types:
            places[f"type {kind.name}"].append(source.path.as_posix())
    return [f"{name}: {', '.join(found)}" for name, found in places.items() if len(found) > 1]


def both_ways(tree: Tree, order: list[str]) -> list[str]:
    """Find folders inside one top folder that use each other.

    The files beside a sub-folder count as a folder too.
    """
    arrows: dict[tuple[str, str], str] = {}
    for source in tree.sources:
        own = source.path.parent.as_posix()
        for name, line in source.used.items():
            target = tree.owners.get(name)
            if target is None or top_folder(target.path, order) != top_folder(source.path, order):
                continue
            folder = target.path.parent.as_posix()
            if folder != own:
                arrows.setdefault((own, folder), f"{source.path}:{line} uses {name}")
    return [
        f"{a} and {b}: {text}; {arrows[b, a]}"
        for (a, b), text in sorted(arrows.items())
        if a < b and (b, a) in arrows
    ]


def naming_modules(tree: Tree, effect: str) -> list[str]:
    """Modules outside an effect's own files that use one of them or contain its name in code."""
    word = re.compile(rf"\b{effect}\b", re.IGNORECASE)
    own = {source.module for source in tree.sources if effect in _effect(source.path)}
    return [
        source.module
        for source in tree.sources
        if source.module not in own
        and (
            own & source.used.keys()
            or any(word.search(re.sub(r"!.*", "", source.lines[line - 1])) for line in source.code)
        )
    ]


def foreign_sundials(tree: Tree) -> list[str]:
    """Files that use SUNDIALS outside its folders."""
    return [
        f"{source.path}:{line}: uses {name}"
        for source in tree.sources
        if PurePosixPath(source.path.parent.as_posix()) not in SUNDIALS_FOLDERS
        for name, line in source.used.items()
        if SUNDIALS.match(name)
    ]


def noise(tree: Tree, free: Iterable[str]) -> list[str]:
    """Statements that print or stop, except in the folders that are free to."""
    return [
        f"{source.path}:{statement.line}: {statement.text}"
        for source in tree.sources
        if not source.path.as_posix().startswith(tuple(f"{name}/" for name in free))
        for statement in source.statements
        if _NOISE.match(_without_condition(statement.text))
    ]


def unchecked_transfers(tree: Tree) -> list[str]:
    """Statements that read or write without `iostat`: an error would end the host's process."""
    return [
        f"{source.path}:{statement.line}: {statement.text}"
        for source in tree.sources
        for statement in source.statements
        if _TRANSFER.match(_without_condition(statement.text))
        and not re.search(r"\biostat\s*=", statement.text, re.IGNORECASE)
    ]


def _without_condition(text: str) -> str:
    """Rest of a statement behind `if (...)`."""
    if not re.match(r"if\s*\(", text, re.IGNORECASE):
        return text
    depth = 0
    for position, character in enumerate(text):
        depth += (character == "(") - (character == ")")
        if depth == 0 and character == ")":
            return text[position + 1 :].lstrip()
    return text


def kept_state(tree: Tree, allowed: Mapping[str, str]) -> list[str]:
    """Variables that live longer than a call: of modules, saved, or given a value as declared."""
    found = []
    for source in tree.sources:
        statements = [] if source.module in allowed else _kept_by(source)
        found += [f"{source.path}:{statement.line}: {statement.text}" for statement in statements]
    return found


def _kept_by(source: Source) -> list[Statement]:
    head = [] if source.is_program else source.head
    kept = [part for part in head if _DECLARATION.match(part.text) and not _is_constant(part.text)]
    kept += [part for part in source.statements if _KEPT.match(part.text) or _is_saved(part.text)]
    for procedure in source.procedures:
        kept += [part for part in procedure.statements if _has_value(part.text)]
    return kept


def _is_constant(text: str) -> bool:
    return bool(re.search(r",\s*parameter\b.*::", text, re.IGNORECASE))


def _is_saved(text: str) -> bool:
    return bool(_DECLARATION.match(text) and re.search(r",\s*save\b[^:]*::", text, re.IGNORECASE))


def _has_value(text: str) -> bool:
    """Tell whether a declaration gives a local variable a value, which makes it a saved one."""
    if not _DECLARATION.match(text) or "::" not in text or _is_constant(text):
        return False
    entities = re.sub(r"\([^()]*\)", "", text.split("::", 1)[1])
    return bool(re.search(r"(?<![=/<>])=(?!=)", entities))


def too_large(tree: Tree) -> dict[str, str]:
    """Procedures with more lines or arguments than they may have: `module:procedure` and why."""
    found = {}
    for source in tree.sources:
        for procedure in source.procedures:
            reasons = []
            if procedure.code_lines > MOST_LINES:
                reasons.append(f"{procedure.code_lines} lines")
            if procedure.arguments > MOST_ARGUMENTS:
                reasons.append(f"{procedure.arguments} arguments")
            if reasons:
                found[f"{source.module}:{procedure.name}"] = ", ".join(reasons)
    return found


def long_files(tree: Tree) -> list[str]:
    """Files with more lines than a file may have."""
    return [
        f"{source.path}: {len(source.lines)} lines"
        for source in tree.sources
        if len(source.lines) > LONGEST_FILE
    ]


def component_counts(tree: Tree) -> dict[str, int]:
    """Count the components of every derived type, those of its parent among them."""
    types = types_by_name(tree)

    def count_of(name: str) -> int:
        found = types.get(name)
        return len(found.components) + count_of(found.parent) if found else 0

    return {name: count_of(name) for name in types}


def crowded_types(tree: Tree, names: Iterable[str]) -> list[str]:
    """Types with more components than they may have, and names that no type has."""
    counts = component_counts(tree)
    return [
        f"{name}: {counts[name]} components" if name in counts else f"{name}: there is no such type"
        for name in names
        if counts.get(name, MOST_COMPONENTS + 1) > MOST_COMPONENTS
    ]


def parts_of(tree: Tree, whole: str) -> dict[str, DerivedType]:
    """Find a type and the types that it contains, without targets of pointers."""
    types = types_by_name(tree)
    parts: dict[str, DerivedType] = {}
    waiting = [whole]
    while waiting:
        name = waiting.pop()
        if name in parts or name not in types:
            continue
        parts[name] = types[name]
        waiting.append(types[name].parent)
        for declaration in types[name].components.values():
            if not _POINTER.search(declaration):
                waiting += [kind.lower() for kind in _OF_TYPE.findall(declaration)]
    return parts


def pointers_in(tree: Tree, whole: str) -> list[str]:
    """Pointers in a type and in the types that it consists of."""
    return [
        f"{name}: {component}"
        for name, part in parts_of(tree, whole).items()
        for component, declaration in part.components.items()
        if _POINTER.search(declaration)
    ]


def changed_models(tree: Tree, free: re.Pattern[str]) -> list[str]:
    """Procedures that could change a model or do, but for those that put it together.

    A dummy argument of the model's type or of a part of it has `intent(in)`; in an equation only
    the discrete state and the record are assigned. `free` matches `module:procedure`.
    """
    parts = parts_of(tree, MODEL)
    if not parts:
        return []
    model = set(parts[MODEL].components)
    return [
        f"{source.path}:{statement.line}: {procedure.name}: {statement.text}"
        for source in tree.sources
        for procedure in source.procedures
        if not free.fullmatch(f"{source.module}:{procedure.name}")
        for statement in _changes(procedure, parts, model)
    ]


def types_by_name(tree: Tree) -> dict[str, DerivedType]:
    """All derived types; of several with one name that of the model."""
    sources = sorted(tree.sources, key=lambda source: source.path.is_relative_to(MODEL_FOLDER))
    return {found.name: found for source in sources for found in source.types}


def _changes(procedure: Procedure, parts: Iterable[str], model: set[str]) -> Iterable[Statement]:
    """Find statements of a procedure that change a model, or allow it to be changed."""
    equations = r"\w+%equation"  # names of variables and components that are one
    aliases: set[str] = set()  # of parts of a model
    for statement in procedure.statements:
        text = statement.text
        kinds = {kind.lower() for kind in _OF_TYPE.findall(text.split("::")[0])}
        if "::" in text and kinds & set(parts) and re.search(r"intent\s*\(\s*(in)?out", text, re.I):
            yield statement
        if "::" in text and kinds & {MODEL, EQUATION}:
            equations += "".join(f"|{name}" for name in names_in(text.split("::", 1)[1]))
        place = rf"(?:\w+%)*(?:{equations})%(?:{'|'.join(sorted(model))}|{MODEL})\b"
        if re.match(r"associate\b", text, re.IGNORECASE):
            aliases |= set(re.findall(rf"(\w+)\s*=>\s*{place}(?!\s*\()", text, re.IGNORECASE))
        changed = _without_condition(text)
        if aliases:
            place = rf"(?:{place}|(?:{'|'.join(sorted(aliases))})(?:\([^()]*\))?%\w+\b)"
        if "::" not in text and (
            re.match(rf"{place}[\w%(),:+\- ]*=(?!=)", changed, re.IGNORECASE)
            or re.match(rf"(de)?allocate\s*\(\s*{place}", changed, re.IGNORECASE)
            or re.match(rf"call\s+move_alloc\s*\(.*,\s*{place}", changed, re.IGNORECASE)
        ):
            yield statement


def build_lists(root: Path) -> list[str]:
    """Find sources missing in the meson.build beside them, and listed files that are missing."""
    found = []
    folders = {path.parent for path in root.rglob("*") if path.suffix in (".f90", ".F90", ".c")}
    for folder in sorted(folders):
        build = folder / "meson.build"
        beside = {path.name for path in folder.iterdir() if path.suffix in (".f90", ".F90", ".c")}
        text = build_lines(build.read_text(encoding="utf-8")) if build.is_file() else ""
        made = re.sub(r"(custom_target\(|output:\s*)('[^']+'|\[[^]]+\])", "", text)
        listed = set(_SOURCE_NAME.findall(made))
        relative = folder.relative_to(root)
        found += [f"{relative}: {name} is not in meson.build" for name in sorted(beside - listed)]
        found += [f"{relative}: meson.build lists {name}" for name in sorted(listed - beside)]
    return found
