"""Frozen scenes, and their texts with another method."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

REFERENCE = Path(__file__).parents[2] / "tests" / "reference"
_SCENES = "bits_scenes.txt"

METHODS = ("adams", "bdf", "dop853", "taylor")
RTOL = "1.0e-8"
CASE = "case.nml"


@dataclass(frozen=True)
class Scene:
    """A case with the files that it names.

    Attributes
    ----------
    name : str
        Its name.
    text : str
        Namelist text.
    files : tuple of pairs
        Name and content of the records.
    """

    name: str
    text: str
    files: tuple[tuple[str, str], ...] = ()

    @property
    def has_spectrum(self) -> bool:
        """True for a scene with a spectrum."""
        return "&spectrum" in self.text

    @property
    def has_accuracy(self) -> bool:
        """True for a scene with `accuracy`, which elements and steps do not support."""
        return bool(re.search(r"\b(accuracy|verify)\s*=", self.text))

    def put(self, text: str | None = None) -> Path:
        """Write the case and its records into the current folder."""
        for name, content in self.files:
            Path(name).write_text(content, encoding="utf-8", newline="")
        path = Path(CASE)
        path.write_text(self.text if text is None else text, encoding="utf-8", newline="")
        return path


def read_scenes(path: Path = REFERENCE / _SCENES) -> list[Scene]:
    """Read scenes: blocks ``=== name``, in them ``--- file NAME`` and ``--- case``."""
    with path.open(encoding="utf-8", newline="") as file:
        blocks = re.split(r"(?m)^=== ", file.read())[1:]
    return [_scene(block) for block in blocks]


def _scene(block: str) -> Scene:
    name, rest = block.split("\n", 1)
    parts = [part.split("\n", 1) for part in re.split(r"(?m)^--- ", rest)[1:]]
    files = tuple((head.removeprefix("file "), text) for head, text in parts if head != "case")
    return Scene(name, next(text for head, text in parts if head == "case"), files)


def from_input(path: Path) -> Scene:
    """Make a scene of a shipped input: no comments, records by their full path."""
    lines = path.read_text(encoding="utf-8").split("\n")
    text = "\n".join(_without_comment(line).rstrip() for line in lines)

    def full(match: re.Match[str]) -> str:
        return f"{match[1]}'{(path.parent / match[2]).resolve()}'"

    text = re.sub(r"(?i)(\bfile\s*=\s*)'([^']*)'", full, text)
    return Scene(path.stem, re.sub(r"\n\n+", "\n", text).strip() + "\n")


def _without_comment(line: str) -> str:
    quoted = False
    for i, letter in enumerate(line):
        quoted ^= letter == "'"
        if letter == "!" and not quoted:
            return line[:i]
    return line


def with_solver(text: str, method: str, rtol: str | None = RTOL) -> str:
    """Give a case another method, and a tolerance where it has none."""
    text = re.sub(r"(?i),?\s*\bmethod\s*=\s*'[^']*'", "", text)
    keys = f"method = '{method}'"
    if rtol is not None and not re.search(r"\baccuracy\s*=", text):
        text = re.sub(r"(?i),?\s*\brtol\s*=\s*[^\s,/]+", "", text)
        keys += f" rtol = {rtol}"
    if "&solver" not in text:
        return text + f"&solver {keys} /\n"
    return text.replace("&solver", f"&solver {keys}", 1)


def with_interval(text: str, dt: str) -> str:
    """Give the history of a case another interval, where it has one."""
    return re.sub(r"(&output\b[^/]*?\bdt\s*=\s*)[^\s,/]+", rf"\g<1>{dt}", text)


def without_spectrum(text: str) -> str:
    """Take the spectrum out of a case."""
    return re.sub(r"&spectrum\b[^/]*/", "", text)


def with_fewer_periods(text: str, n: int) -> str:
    """Give a grid of periods another number of them."""
    return re.sub(r"(&spectrum\b[^/]*?\bn\s*=\s*)\d+", rf"\g<1>{n}", text)


def has_period(text: str) -> bool:
    """Tell whether a case describes one structure: no frame, or one that has a period."""
    is_frame = "&frame" in text
    return not is_frame or "&storeys" in text or bool(re.search(r"&frame\b[^/]*\bT_s\s*=", text))


def without_output(text: str) -> str:
    """Take the output group out of a case."""
    return re.sub(r"&output\b[^/]*/", "", text)
