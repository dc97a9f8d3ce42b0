"""Execution of the code blocks of a page in order, in a temporary folder.

========= =========================================================================================
block     treatment
========= =========================================================================================
named     a file; its name is in code letters on the line before the block. The block of an existing
          path must equal that file word for word; other names are written.
console   lines after ``$`` are run. The output must equal the lines below; ``...`` is anything
python    runs with the names of the blocks before it. Output must equal the `text` block after it
nml       must contain existing groups and keys
fortran,  without a name: must be part of a source file that is built, or be a namelist
c, make
sh        is not run (a build, hours, a cluster), but parsed: words must be known to `rwmf`
text      after other blocks than python: prose
========= =========================================================================================

Figures that the blocks draw are kept beside the page, in ``figures/PAGE/``. `notebooks` runs the
pages that offer themselves as a notebook.
"""

from __future__ import annotations

import contextlib
import io
import os
import re
import shlex
import shutil
import subprocess
from dataclasses import dataclass
from functools import cache
from itertools import zip_longest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
HERE = Path(__file__).parent
FIGURES = "figures"
INSTALLED = ROOT / "build" / "pages" / "installed"

_FENCE = re.compile(
    r"(?:^`(?P<name>[\w./-]+)`\n\n)?^```(?P<language>[\w{}-]*)\n(?P<text>.*?)^```$",
    re.MULTILINE | re.DOTALL,
)
_SOURCES = {"fortran", "c", "make"}
_RUN_BY = {"python", "console", "nml", "sh", "text"} | _SOURCES


class PageError(Exception):
    """The result of a block differs from the page."""


@dataclass(frozen=True)
class Block:
    """A fenced block.

    Attributes
    ----------
    name : str
        Name of the file that it shows, or empty.
    language : str
        Word behind the fence.
    text : str
        Its lines.
    printed : str or None
        The `text` block that follows at once.
    begin, end : int
        Its place in the page, with the printed block [characters].
    """

    name: str
    language: str
    text: str
    printed: str | None
    begin: int
    end: int


def text_of(name: str) -> str:
    """Read a text that a made page begins with."""
    return (HERE / name).read_text(encoding="utf-8")


def pages() -> list[Path]:
    """List all pages with blocks."""
    found = [ROOT / "README.md", *sorted(DOCS.rglob("*.md"))]
    return [path for path in found if "```" in path.read_text(encoding="utf-8")]


def blocks_of(text: str) -> list[Block]:
    """Find the blocks of a page."""
    fences = list(_FENCE.finditer(text))
    blocks = []
    for fence, after in zip_longest(fences, fences[1:]):
        if fence["language"].startswith("{"):
            continue  # a directive of Sphinx
        printed, end = None, fence.end()
        if after and after["language"] == "text" and not text[fence.end() : after.start()].strip():
            printed, end = after["text"], after.end()
        name, language = fence["name"] or "", fence["language"]
        blocks.append(Block(name, language, fence["text"], printed, fence.start(), end))
    return blocks


def code_of(page: Path) -> str:
    """Text of the blocks of a page and names of its figures, without the prose."""
    text = page.read_text(encoding="utf-8")
    return "\n".join(map(str, [*blocks_of(text), *_figures_of(page, text)]))


def run_page(page: Path, folder: Path) -> None:
    """Run every block of a page."""
    shutil.copytree(ROOT / "inputs", folder / "inputs")
    names: dict[str, object] = {}
    with contextlib.chdir(folder):
        for block in blocks_of(page.read_text(encoding="utf-8")):
            try:
                run_block(block, names)
            except PageError:
                raise
            except Exception as error:
                raise PageError(f"{type(error).__name__}: {error}, in\n{block.text}") from error


def run_block(block: Block, names: dict[str, object]) -> None:
    """Run or check one block in the present folder."""
    if block.language not in _RUN_BY:
        raise PageError(f"a block of the language '{block.language}':\n{block.text}")
    if block.name and (ROOT / block.name).is_file():
        if (ROOT / block.name).read_text(encoding="utf-8") != block.text:
            raise PageError(f"{block.name} differs from the block of the page")
    elif block.name:
        Path(block.name).write_text(block.text, encoding="utf-8")
    elif block.language == "console":
        _run_console(block.text)
    elif block.language == "python":
        _run_python(block, names)
    elif block.language == "sh":
        _parse_shell(block.text)
    elif block.language == "nml" or re.match(r"\s*&", block.text):
        _check_namelist(block.text)
    elif block.language in _SOURCES and block.text.strip() not in _tested_sources():
        raise PageError(f"in no tested source:\n{block.text}")


def _run_python(block: Block, names: dict[str, object]) -> None:
    output = io.StringIO()
    with contextlib.redirect_stdout(output):
        exec(compile(block.text, "<page>", "exec"), names)
    if block.printed is not None:
        compare(output.getvalue(), block.printed)


def _run_console(text: str) -> None:
    for words, expected in commands_of(text):
        done = subprocess.run(
            ["bash", "-euo", "pipefail", "-c", words],
            env=environment(words),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            timeout=300,
            check=False,
        )
        if done.returncode:
            raise PageError(f"{words}\nends with {done.returncode}:\n{done.stdout}")
        if expected:
            compare(done.stdout, expected)


def commands_of(text: str) -> list[tuple[str, str]]:
    """Split a console block into its commands."""
    found: list[tuple[str, str]] = []
    goes_on = False
    for line in text.splitlines():
        if line.startswith("$ "):
            found.append((line[2:], ""))
        elif goes_on:
            found[-1] = (found[-1][0] + "\n" + line, "")
        elif not found:
            raise PageError(f"a console block begins with '$ ':\n{text}")
        else:
            found[-1] = (found[-1][0], found[-1][1] + line + "\n")
        goes_on = line.endswith("\\")
    return found


def environment(words: str) -> dict[str, str]:
    """Make the environment of a reader: the commands of .venv, where things are."""
    places = {
        "PATH": f"{ROOT / '.venv' / 'bin'}:{os.environ['PATH']}",
        "CHECKOUT": str(ROOT),
        "MPLBACKEND": "Agg",
        "OMP_NUM_THREADS": "1",
    }
    if "$PREFIX" in words:
        places["PREFIX"] = str(_installed_library())
    return os.environ | places


@cache
def _installed_library() -> Path:
    """Install the library for host programs as `meson install` does, below the build."""
    target = INSTALLED / str(os.getpid())  # pages run in several processes
    words: list[str | Path] = [ROOT / ".venv/bin/meson", "install", "-C", ROOT / "build"]
    words += ["--no-rebuild", "--quiet", "--tags", "devel", "--destdir", target]
    subprocess.run(words, check=True)
    prefix = next(target.rglob("rwmf.h")).parents[2]
    library = next(target.rglob("librwmf.a"))
    if library.parent != prefix / "lib":
        # Debian's folder of libraries has the architecture in its name
        library.rename(prefix / "lib" / library.name)
    return prefix


def _parse_shell(text: str) -> None:
    done = subprocess.run(
        ["bash", "-n"], input=text, capture_output=True, text=True, timeout=60, check=False
    )
    if done.returncode:
        raise PageError(f"{done.stderr}\n{text}")
    for line in text.replace("\\\n", " ").splitlines():
        words = shlex.split(re.sub(r"\$\{?\w+\}?", "1", line), comments=True)
        for name in ("rwmf", "tools/run"):
            if name in words[:1] or ("-m" in words and name in words):
                _parse_words(words[words.index(name) + 1 :], line)
        program = next(iter(words), "")
        if program.startswith(("tools/", "bench/", ".ci/")) and not (ROOT / program).is_file():
            raise PageError(f"{program} is no file: {line}")


def _parse_words(words: list[str], line: str) -> None:
    """Check the words of a command with its parser."""
    from rwmf.cli.parser import make_parser

    refused = io.StringIO()
    try:
        with contextlib.redirect_stderr(refused), contextlib.redirect_stdout(io.StringIO()):
            if words:
                make_parser().parse_args(words)
    except SystemExit as leave:
        if leave.code:
            raise PageError(f"{line}: {refused.getvalue()}") from None


def _check_namelist(text: str) -> None:
    """Every group and key is one of the kernel's, or of a sweep's file."""
    keys = _keys()
    bare = re.sub(r"'[^']*'|![^\n]*", "", text)
    for group, body in re.findall(r"&(\w+)([^&]*)", bare):
        if group.lower() not in keys:
            raise PageError(f"no group &{group}:\n{text}")
        for key in re.findall(r"([A-Za-z]\w*)\s*=", body):
            if keys[group.lower()] and key.lower() not in keys[group.lower()]:
                raise PageError(f"no key {key} in &{group}:\n{text}")


@cache
def _keys() -> dict[str, set[str]]:
    from rwmf.kernel import tables

    keys: dict[str, set[str]] = {"sweep": set(), "grid": set()}
    for group, key, *_ in tables.schema():
        keys.setdefault(group.lower(), set()).add(key.lower())
    return keys


@cache
def _tested_sources() -> str:
    folders = [ROOT / name for name in ("src", "tests/unit", "tests/export", "examples")]
    return "\n".join(
        path.read_text(encoding="utf-8")
        for folder in folders
        for path in sorted(folder.rglob("*"))
        if path.suffix in {".f90", ".f", ".c"} or path.name == "Makefile"
    )


def compare(found: str, expected: str) -> None:
    """Compare word by word; `...` matches any words."""
    if not _matches(found.split(), expected.split()):
        raise PageError(f"printed:\n{found}\nthe page says:\n{expected}")


def _matches(found: list[str], expected: list[str]) -> bool:
    head = expected.index("...") if "..." in expected else len(expected)
    if len(found) < head or found[:head] != expected[:head]:
        return False
    if head == len(expected):
        return len(found) == head
    rest = expected[head + 1 :]
    return any(_matches(found[i:], rest) for i in range(head, len(found) + 1))


def keep_figures(page: Path, folder: Path) -> None:
    """Keep the pictures that the blocks have drawn, for the page that shows them."""
    target = page.parent / FIGURES / page.stem
    for name in _figures_of(page, page.read_text(encoding="utf-8")):
        target.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(folder / name, target / name)


def _figures_of(page: Path, text: str) -> list[str]:
    return re.findall(rf"\]\({FIGURES}/{page.stem}/([\w.-]+)\)", text)
