"""Code blocks of the pages match the present program; generated pages are up to date."""

from __future__ import annotations

import re
import sys
from itertools import pairwise
from pathlib import Path

import pytest
from checkout import ROOT

sys.path.append(str(ROOT / "tools"))

from pages import blocks, made
from pages.steps import run_blocks

PAGES = blocks.pages()


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_blocks(page: Path) -> None:
    """Every block of the page gives the result on the page, now or in tools/docs."""
    run_blocks(page)


def test_no_output_escapes() -> None:
    """A text block is the output of the block before it; other blocks contain no output."""
    escaped = [
        (str(page.relative_to(ROOT)), block.text.splitlines()[0])
        for page in PAGES
        if str(page.relative_to(blocks.DOCS if blocks.DOCS in page.parents else ROOT))
        not in made.PAGES
        for before, block in pairwise([None, *blocks.blocks_of(page.read_text(encoding="utf-8"))])
        if block is not None and block.language == "text" and not block.name
        if before is None or before.language != "python" or before.printed is None
    ]
    assert escaped == []


@pytest.mark.parametrize("name", made.PAGES)
def test_made_page_is_current(name: str) -> None:
    """`tools/docs --made` would not change it."""
    assert (blocks.DOCS / name).read_text(encoding="utf-8") == made.PAGES[name]()


@pytest.mark.parametrize("page", sorted(blocks.DOCS.rglob("*.md")), ids=lambda page: page.stem)
def test_code_stands_in_fences(page: Path) -> None:
    """An indented block would never be run."""
    text = re.sub(r"^```.*?^```$", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
    assert not re.findall(r"\n\n {4,}(?![-*\d ]).*", text)


def test_an_equation_has_a_label_of_its_own() -> None:
    """A label belongs to one equation; all others refer to it."""
    pages = (blocks.DOCS / "theory").glob("*.md")
    text = "".join(page.read_text(encoding="utf-8") for page in pages)
    labels = re.findall(r"\\tag\{(T\d+)\}", text)
    assert len(labels) == len(set(labels)) > 0
    assert set(re.findall(r"\((T\d+)\)", text)) <= set(labels)


@pytest.mark.parametrize(
    ("page", "fault"),
    [
        ("```python\nprint(1.5)\n```\n\n```text\n1.6\n```\n", "the page says"),
        ("```python\nmissing\n```\n", "NameError"),
        ("```console\n$ echo one two\none ... three\n```\n", "the page says"),
        ("```console\n$ false\n```\n", "ends with 1"),
        ("```sh\nrwmf run --nothing case.nml\n```\n", "nothing"),
        ("```sh\nif true\n```\n", "syntax error"),
        ("```nml\n&wall height = 1 /\n```\n", "no key height"),
        ("```nml\n&house /\n```\n", "no group &house"),
        ("```fortran\nprogram nobody_builds\nend program\n```\n", "in no tested source"),
        (
            "`examples/one_wall.c`\n\n```c\nint main(void) {}\n```\n",
            "differs from the block of the page",
        ),
        ("```basic\n10 PRINT 1\n```\n", "of the language"),
    ],
)
def test_a_wrong_block_is_found(page: str, fault: str, tmp_path: Path) -> None:
    path = tmp_path / "page.md"
    path.write_text(page, encoding="utf-8")
    (tmp_path / "run").mkdir()
    with pytest.raises(blocks.PageError, match=fault):
        blocks.run_page(path, tmp_path / "run")


@pytest.mark.parametrize(
    ("found", "expected", "same"),
    [
        ("a 1.0 b", "a 1.0 b", True),
        ("a 1.0000000001 b", "a 1.0 b", False),
        ("a 1.00001 b", "a 1.0 b", False),
        ("a b c d", "a ... d", True),
        ("a d", "a ... d", True),
        ("a b c d", "... c ... d", True),
        ("a b c d", "a ... c", False),
        ("a b", "a b c", False),
        ("[1.5 2.5]", "[1.5 2.5]", True),
    ],
)
def test_dots_stand_for_any_words(found: str, expected: str, same: bool) -> None:
    if same:
        blocks.compare(found, expected)
    else:
        with pytest.raises(blocks.PageError):
            blocks.compare(found, expected)
