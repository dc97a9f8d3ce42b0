"""Lessons as notebooks: cells, outputs, and pages whose outputs differ."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import pytest
from checkout import ROOT

sys.path.append(str(ROOT / "tools"))

from pages import blocks, notebooks

pytest.importorskip("nbclient")
nbformat: Any = pytest.importorskip("nbformat")

LESSON = """# A lesson

You learn [nothing](other.md#here), see [a site](https://example.org).
[Download the lesson as a notebook](figures/lesson/lesson.ipynb) with all outputs.

`note.txt`

```text
one
two
```

```console
$ cat note.txt \\
   | tail -n 1
two
$ ls missing || echo status $?
ls: ... status 2
```

```python
import matplotlib.pyplot as plt

x = 2
```

```python
print(x + 1)
plt.plot([0, x])
plt.savefig("line.png")
```

```text
3
```

![A line](figures/lesson/line.png)

![The same file](figures/lesson/line.png)

```sh
tools/run --version
```
"""


def _run(folder: Path, text: str) -> Any:  # noqa: ANN401
    page = folder / "lesson.md"
    page.write_text(text, encoding="utf-8")
    assert notebooks.is_offered(page)
    (folder / "run").mkdir()
    notebooks.run_page(page, folder / "run")
    return nbformat.read(folder / "run" / "lesson.ipynb", as_version=4)


def test_a_page_becomes_cells(tmp_path: Path) -> None:
    found = _run(tmp_path, LESSON)
    cells = found.cells
    code = [cell.source for cell in cells if cell.cell_type == "code"]
    assert code == [
        "%%writefile note.txt\none\ntwo",
        "%%bash\ncat note.txt \\\n   | tail -n 1",
        "%%bash\nls missing || echo status $?",
        "import matplotlib.pyplot as plt\n\nx = 2",
        'print(x + 1)\nplt.plot([0, x])\nplt.savefig("line.png")',
        'from IPython.display import Image\n\nImage("line.png")',
    ]
    prose = "\n".join(cell.source for cell in cells if cell.cell_type == "markdown")
    assert "You learn nothing, see [a site](https://example.org)." in prose
    assert "Download" not in prose
    assert "*A line*" in prose
    assert "*The same file*" in prose
    assert "```sh\ntools/run --version\n```" in prose
    assert "```text" not in prose
    # the first figure is that of its cell, the second one is read from the file
    drawn = [output for cell in cells[-5:] for output in cell.get("outputs", [])]
    assert ["image/png" in output.get("data", {}) for output in drawn].count(True) == 2
    assert {cell.execution_count for cell in cells if cell.cell_type == "code"} == {*range(1, 7)}


def test_a_wrong_page_is_found(tmp_path: Path) -> None:
    with pytest.raises(blocks.PageError, match="printed:\n3\n\nthe page says:\n4"):
        _run(tmp_path, LESSON.replace("\n3\n", "\n4\n"))


def test_errors_of_a_command_stand_anywhere() -> None:
    notebooks._compare(("out\n", "error\n"), "error\nout\n")
    notebooks._compare(("out\n", "error\n"), "out\nerror\n")
    with pytest.raises(blocks.PageError):
        notebooks._compare(("out\n", "error\n"), "out\n")


def test_three_lessons_are_offered() -> None:
    offered = [page.stem for page in blocks.pages() if notebooks.is_offered(page)]
    assert offered == ["first-run", "own-record", "six-storeys"]
