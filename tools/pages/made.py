"""The files that a command makes: from the kernel's tables, its facade, the parser.

``tools/docs --made`` writes them; a test compares them with the present output.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import textwrap
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from itertools import groupby

from rwmf.cli.parser import make_parser
from rwmf.kernel import tables
from rwmf.run.quantities import QUANTITIES, SENSITIVITY, Quantity

from pages import group_types
from pages.blocks import DOCS, ROOT, text_of

_WIDTH = 100
_DEFINITION = (
    r"^ *(?:(?!public|private|use|end)[^!:'\n]*\b(?:subroutine|function) {0}\b"
    r"|type\b[^:\n]*:: *{0}$|(?:abstract )?interface {0}$"
    r"|[^!:\n]*\bparameter\b[^!:\n]*:: *{0}\b)"
)

_SECTIONS = {
    "history": "Columns of the history\n\n`CASE.history.csv`, with `&output dt`",
    "run": "Scalars of a run\n\n`rwmf run --json`, `CASE.summary.csv`",
    "spectrum": "Spectra\n\n`rwmf spectrum --json`, `CASE.spectrum.csv`",
    "ordinate": "Ordinates of a spectrum\n\nRequest them by `&spectrum quantities`, `rwmf spectrum "
    "--quantities` or\n`rwmf.spectrum(case, quantities=[...])`; a Fortran host finds them in "
    "`values` of `spectrum_t`.\nYes is 1, no is 0, and the time of an event that did not happen is "
    "NaN. `&output` needs only\n`friction_limit`. In Python each quantity is a variable under its "
    "name, or under its key",
    "sweep": "Sweeps\n\nA sweep adds these to the requested scalars of a run",
    "cost": "Comparison of methods\n\n`rwmf cost --json`, where `seconds` is processor time",
}


def key_page() -> str:
    """Make the reference of the namelist."""
    parts = [text_of("namelist.md")]
    for group, found in groupby(tables.schema(), key=lambda row: row.group):
        keys = list(found)
        parts.append(
            f"\n## `&{group}`\n\n| key | type | unit | default | allowed | usual | meaning |"
        )
        parts.append("|---|---|---|---|---|---|---|")
        parts.extend(_key_row(key, keys) for key in keys)
    return "\n".join(parts) + "\n"


def _key_row(row: tables.KeyRow, group: Sequence[tables.KeyRow]) -> str:
    _, name, kind, unit, default, allowed, meaning, usual, _ = row
    if kind == "choice":
        allowed = ", ".join(f"'{word}'" for word in allowed.split())
    instead = [f"`{key.key}`" for key in group if key.gives == name]
    if default == "required" and instead:
        default = f"required, or {', '.join(instead)}"
    return f"| `{name}` | {kind} | {unit} | {default} | {allowed} | {usual} | {meaning} |"


def output_page() -> str:
    """Make the reference of the outputs."""
    parts = [text_of("outputs.md").rstrip("\n")]
    for output, title in _SECTIONS.items():
        parts.append(f"\n## {title}.\n\n| key | name | type | unit | meaning | found | present |")
        parts.append("|---|---|---|---|---|---|---|")
        rows = (
            item
            for item in QUANTITIES.values()
            if output in item.outputs.split() and not item.key.startswith(SENSITIVITY)
        )
        parts.extend(_output_row(item, output) for item in rows)
    return "\n".join(parts) + "\n"


def _output_row(item: Quantity, output: str) -> str:
    conditions = (
        item.group and f"`&{item.group}`",
        item.needs,
        item.asked_by and f"`&output {item.asked_by}`",
    )
    present = ", ".join(filter(None, conditions)) or "always"
    name = ", ".join(f"`{name}`" for name in item.names(output))
    found = "row" if output == "history" else item.found
    return (
        f"| `{item.key}` | {name} | {item.kind} | {item.unit} | {item.meaning} | {found} "
        f"| {present} |"
    )


def command_page() -> str:
    """Make the reference of the commands."""
    parts = [text_of("commands.md")]
    for name, parser in _commands("rwmf", make_parser()):
        about = textwrap.fill(parser.description or "", _WIDTH, break_on_hyphens=False)
        parts.append(f"\n## `{name}`\n\n{about}\n")
        rows = [row for action in parser._actions for row in _word_row(action)]
        if rows:
            parts.append("| word | meaning |\n|---|---|\n" + "\n".join(rows) + "\n")
        example = (parser.epilog or "").removeprefix("example: ")
        if example:
            parts.append(f"```sh\n{example}\n```\n")
    return "\n".join(parts) + _batch_section()


def _commands(
    name: str, parser: argparse.ArgumentParser
) -> Iterator[tuple[str, argparse.ArgumentParser]]:
    groups = [a for a in parser._actions if isinstance(a, argparse._SubParsersAction)]
    if not groups:
        yield name, parser
    for group in groups:
        for word, inner in group.choices.items():
            yield from _commands(f"{name} {word}", inner)


def _word_row(action: argparse.Action) -> Iterator[str]:
    """Yield the row of a word, none for --help."""
    if isinstance(action, argparse._HelpAction):
        return
    value = action.metavar or (
        "{" + ",".join(map(str, action.choices)) + "}" if action.choices else action.dest.upper()
    )
    if isinstance(value, tuple):
        value = " ".join(value)
    value = "" if action.nargs == 0 else value + " ..." * (action.nargs in ("+", "*"))
    words = ", ".join(f"{option} {value}".strip() for option in action.option_strings) or value
    meaning = " ".join(((action.help or "") % vars(action)).split()).replace("|", "\\|")
    yield f"| `{words}` | {meaning} |"


def _batch_section() -> str:
    program = ROOT / ".venv" / "bin" / "rwmf-batch"
    done = subprocess.run([program, "--help"], capture_output=True, text=True, check=True)
    return f"\n## `rwmf-batch`\n\n```text\n{done.stdout.strip()}\n```\n"


def facade_page() -> str:
    """Make the reference of the module `rwmf`."""
    source = (ROOT / "src" / "rwmf.f90").read_text(encoding="utf-8")
    uses = source[source.index("\nmodule rwmf") : source.index("implicit none")]
    parts = [text_of("fortran.md")]
    for line in re.sub(r"&\s*\n\s*", "", uses).splitlines():
        if comment := re.match(r" *! (.*)", line):
            title = comment[1][0].upper() + comment[1][1:]
            parts.append(f"\n## {title}\n\n| name | | module |\n|---|---|---|")
        elif use := re.match(r" *use (\w+), only: (.*)", line):
            names = sorted(name.strip() for name in use[2].split(","))
            parts.extend(_facade_row(use[1], name) for name in names)
    return "\n".join(parts) + "\n"


def _facade_row(module: str, name: str) -> str:
    page = f'<a href="../fortran/module/{module}.html">{module}</a>'
    return f"| `{name}` | {_meaning(_sources()[module], name)} | {page} |"


@cache
def _sources() -> dict[str, str]:
    """Read the files of all modules."""
    texts = (path.read_text(encoding="utf-8") for path in (ROOT / "src").rglob("*.[fF]90"))
    return {found[1]: text for text in texts if (found := re.search(r"^module (\w+)$", text, re.M))}


def _meaning(source: str, name: str) -> str:
    """Find the first sentence of the comment before a definition, or below a constant."""
    found = re.search(_DEFINITION.format(name), source, re.MULTILINE)
    if not found:
        return ""
    before = re.search(r"(?:^ *!>.*\n)+\Z", source[: found.start()], re.MULTILINE)
    below = re.match(r".*\n((?: *!!.*\n)+)", source[found.start() :])
    comment = before[0] if before else below[1] if below else ""
    text = " ".join(" ".join(re.findall(r"![>!] ?(.*)", comment)).split())
    return re.split(r"(?<=[.;]) ", text)[0].rstrip(";").replace("|", "\\|")


PAGES: dict[str, Callable[[], str]] = {
    "reference/namelist.md": key_page,
    "reference/outputs.md": output_page,
    "reference/commands.md": command_page,
    "reference/fortran.md": facade_page,
    "../driver/rwmf/case/groups.py": group_types.make,
}


def write_all() -> None:
    """Write every file that a command makes."""
    for name, make in PAGES.items():
        (DOCS / name).write_text(make(), encoding="utf-8")
