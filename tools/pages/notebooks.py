"""Lessons as Jupyter notebooks: pages that link to ``figures/PAGE/PAGE.ipynb``.

Such a page is run once, in a Jupyter kernel. Its blocks become the cells of the notebook. Their
outputs are compared with those on the page.

================ =================================================================================
page             cell
================ =================================================================================
prose            Markdown, without links to other pages.
named block      ``%%writefile``.
command          ``%%bash``.
python           code; its printed output is that of the kernel.
figure           ``Image``, unless the cells since the last one show their own figure.
others           Markdown; checked as on other pages
================ =================================================================================
"""

from __future__ import annotations

import re
import shutil
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import rwmf

from pages import blocks

if TYPE_CHECKING:
    from nbformat import NotebookNode

# of a cell
_SECONDS = 300
_RECORDS = re.compile(r"inputs/records/(\w+)\.csv")
_FIGURE = re.compile(r"^!\[(?P<words>[^\]]*)\]\(figures/[\w-]+/(?P<name>[\w.-]+)\)$", re.MULTILINE)
# links to other pages and files lead nowhere from a file that was downloaded
_LINK = re.compile(r"(?<!!)\[(?P<words>[^\]]+)\]\((?!https?:)[^)]+\)", re.DOTALL)
_IMAGE = "from IPython.display import Image\n\n"
_START = """\
# {title}

This notebook is a lesson of the documentation of rwmf {version}, executed in a Jupyter kernel.
Run its cells in order, in an empty folder. It needs Linux and the packages
`rwmf[plot,progress,netcdf,records]`.
"""


def is_offered(page: Path) -> bool:
    """Check whether a page offers itself as a notebook."""
    return f"]({_place(page)})" in page.read_text(encoding="utf-8")


def _place(page: Path) -> str:
    return f"{blocks.FIGURES}/{page.stem}/{page.stem}.ipynb"


def run_page(page: Path, folder: Path) -> None:
    """Run a page as a notebook and write it as PAGE.ipynb."""
    import nbformat

    shutil.copytree(blocks.ROOT / "inputs", folder / "inputs")
    writer = _Writer(page)
    writer.write()
    _execute(writer.notebook, folder)
    for cell, expected in writer.expected:
        _compare(cell, expected)
    _drop_figures(writer.notebook)
    nbformat.validate(writer.notebook)
    nbformat.write(writer.notebook, folder / f"{page.stem}.ipynb")


def _execute(notebook: NotebookNode, folder: Path) -> None:
    """Run the cells in a kernel in the folder, which writes nothing into the user's own."""
    from nbclient import NotebookClient
    from nbclient.exceptions import CellExecutionError

    # the kernel chooses the backend of notebooks itself, and its cells use all processors
    unset = ("MPLBACKEND", "OMP_NUM_THREADS")
    variables = {name: value for name, value in blocks.environment("").items() if name not in unset}
    client = NotebookClient(
        notebook,
        timeout=_SECONDS,
        kernel_name="python3",
        record_timing=False,
        coalesce_streams=True,
        resources={"metadata": {"path": str(folder)}},
    )
    # a temporary folder: paths of sockets have at most 107 characters
    with tempfile.TemporaryDirectory() as apart:
        manager = client.create_kernel_manager()
        # sockets instead of ports of the machine
        manager.transport = "ipc"
        manager.ip = f"{apart}/socket"
        manager.connection_file = f"{apart}/kernel.json"
        try:
            client.execute(env=variables | {"IPYTHONDIR": apart})
        except CellExecutionError as error:
            raise blocks.PageError(str(error)) from None


def _drop_figures(notebook: NotebookNode) -> None:
    """Drop the cell of a figure where a cell since the last one shows its own."""
    is_shown, kept = False, []
    for cell in notebook.cells:
        is_figure = cell.source.startswith(_IMAGE)
        if not (is_figure and is_shown):
            kept.append(cell)
        outputs = cell.get("outputs", ())
        is_shown |= any("image/png" in output.get("data", {}) for output in outputs)
        is_shown &= not is_figure
    notebook.cells = kept


class _Writer:
    """Cells of a page, and the output that some of them must have."""

    def __init__(self, page: Path) -> None:
        from nbformat.v4 import new_notebook

        self.page = page
        self.notebook: NotebookNode = new_notebook()
        self.expected: list[tuple[NotebookNode, str]] = []

    def write(self) -> None:
        """Write the page."""
        text = self.page.read_text(encoding="utf-8")
        heading, _, text = text.partition("\n")
        title = heading.removeprefix("# ")
        self._prose(_START.format(title=title, version=rwmf.__version__))
        self._get_records(sorted(set(_RECORDS.findall(text))))
        end = 0
        for block in blocks.blocks_of(text):
            if block.begin < end:
                continue  # the output of the block before it
            self._prose(text[end : block.begin])
            self._block(block, text[block.begin : block.end])
            end = block.end
        self._prose(text[end:])

    def _get_records(self, names: list[str]) -> None:
        if names:
            self._prose("The records of this lesson:")
            lines = [
                f"rwmf records export {name} --out inputs/records/{name}.csv --force"
                for name in names
            ]
            self._code("\n".join(["%%bash", "mkdir -p inputs/records", *lines]))

    def _prose(self, text: str) -> None:
        """Write Markdown, and a cell for every figure in it."""
        text = re.sub(r"^```\{toctree\}.*?^```$", "", text, flags=re.MULTILINE | re.DOTALL)
        offer = rf"^[^\n]*\]\({re.escape(_place(self.page))}\)[^\n]*$"
        text = re.sub(offer, "", text, flags=re.MULTILINE)
        end = 0
        for figure in _FIGURE.finditer(text):
            self._markdown(text[end : figure.start()])
            self._code(f'{_IMAGE}Image("{figure["name"]}")')
            self._markdown(f"*{figure['words']}*")
            end = figure.end()
        self._markdown(text[end:])

    def _markdown(self, text: str) -> None:
        from nbformat.v4 import new_markdown_cell

        text = _LINK.sub(r"\g<words>", text).strip()
        if text:
            self._add(new_markdown_cell(text))

    def _add(self, cell: NotebookNode) -> None:
        # the name of a cell is random otherwise
        cell["id"] = f"cell-{len(self.notebook.cells) + 1}"
        self.notebook.cells.append(cell)

    def _block(self, block: blocks.Block, source: str) -> None:
        if block.name:
            self._code(f"%%writefile {block.name}\n{block.text}")
        elif block.language == "console":
            for words, expected in blocks.commands_of(block.text):
                self._code(f"%%bash\n{words}", expected)
        elif block.language == "python":
            self._code(block.text, block.printed or "")
        else:
            blocks.run_block(block, {})
            self._markdown(source)

    def _code(self, source: str, expected: str = "") -> None:
        """Write a cell with the output that it must have, if any."""
        from nbformat.v4 import new_code_cell

        self._add(new_code_cell(source.rstrip("\n")))
        if expected:
            self.expected.append((self.notebook.cells[-1], expected))


def _compare(cell: NotebookNode, expected: str) -> None:
    """Compare the output of a cell; errors of a command may stand before or after the rest."""
    streams = {"stdout": "", "stderr": ""}
    for output in cell.outputs:
        if output.output_type == "stream":
            streams[output.name] += output.text
    out, errors = streams.values()
    if not cell.source.startswith("%%bash"):
        errors = ""
    try:
        blocks.compare(errors + out, expected)
    except blocks.PageError:
        blocks.compare(out + errors, expected)
