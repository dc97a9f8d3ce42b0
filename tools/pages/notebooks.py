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
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

import rwmf

from pages import blocks

if TYPE_CHECKING:
    from nbclient import NotebookClient
    from nbformat import NotebookNode

# of a cell
_SECONDS = 300
_RECORDS = re.compile(r"inputs/records/(\w+)\.csv")
_FIGURE = re.compile(r"^!\[(?P<words>[^\]]*)\]\(figures/[\w-]+/(?P<name>[\w.-]+)\)$", re.MULTILINE)
# links to other pages and files lead nowhere from a file that was downloaded
_LINK = re.compile(r"(?<!!)\[(?P<words>[^\]]+)\]\((?!https?:)[^)]+\)", re.DOTALL)
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
    with _kernel(folder) as client:
        _Writer(page, client).write()
        nbformat.validate(client.nb)
        nbformat.write(client.nb, folder / f"{page.stem}.ipynb")


@contextmanager
def _kernel(folder: Path) -> Iterator[NotebookClient]:
    """Start a kernel in the folder, which writes nothing into the user's own."""
    import nbformat.v4
    from nbclient import NotebookClient

    # the kernel chooses the backend of notebooks itself, and its cells use all processors
    unset = ("MPLBACKEND", "OMP_NUM_THREADS")
    variables = {name: value for name, value in blocks.environment("").items() if name not in unset}
    client = NotebookClient(
        nbformat.v4.new_notebook(),
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
        with client.setup_kernel(env=variables | {"IPYTHONDIR": apart}):
            yield client


class _Writer:
    """Cells of a page, each executed as soon as it is written."""

    def __init__(self, page: Path, client: NotebookClient) -> None:
        self.page = page
        self.client = client
        self.shows_figure = False
        self.has_image = False

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
            self._figure(figure["name"], figure["words"])
            end = figure.end()
        self._markdown(text[end:])

    def _markdown(self, text: str) -> None:
        from nbformat.v4 import new_markdown_cell

        text = _LINK.sub(r"\g<words>", text).strip()
        if text:
            self.client.nb.cells.append(self._named(new_markdown_cell(text)))

    def _named(self, cell: NotebookNode) -> NotebookNode:
        # the name of a cell is random otherwise
        cell["id"] = f"cell-{len(self.client.nb.cells) + 1}"
        return cell

    def _figure(self, name: str, words: str) -> None:
        if not self.shows_figure:
            first = "" if self.has_image else "from IPython.display import Image\n\n"
            self.has_image = True
            self._code(f'{first}Image("{name}")')
        self.shows_figure = False
        self._markdown(f"*{words}*")

    def _block(self, block: blocks.Block, source: str) -> None:
        if block.name:
            self._code(f"%%writefile {block.name}\n{block.text}")
        elif block.language == "console":
            for words, expected in blocks.commands_of(block.text):
                printed = self._code(f"%%bash\n{words}")
                if expected:
                    _compare(printed, expected)
        elif block.language == "python":
            out, _ = self._code(block.text)
            if block.printed is not None:
                blocks.compare(out, block.printed)
        else:
            blocks.run_block(block, {})
            self._markdown(source)

    def _code(self, source: str) -> tuple[str, str]:
        """Write and run a cell; return its standard output and its errors."""
        from nbclient.exceptions import CellExecutionError
        from nbformat.v4 import new_code_cell

        cells = self.client.nb.cells
        cells.append(self._named(new_code_cell(source.rstrip("\n"))))
        try:
            self.client.execute_cell(cells[-1], len(cells) - 1)
        except CellExecutionError as error:
            raise blocks.PageError(str(error)) from None
        streams = {"stdout": "", "stderr": ""}
        for output in cells[-1].outputs:
            if output.output_type == "stream":
                streams[output.name] += output.text
            self.shows_figure |= "image/png" in output.get("data", {})
        return streams["stdout"], streams["stderr"]


def _compare(printed: tuple[str, str], expected: str) -> None:
    """Compare the output of a command; its errors may stand before or after the rest."""
    out, errors = printed
    try:
        blocks.compare(errors + out, expected)
    except blocks.PageError:
        blocks.compare(out + errors, expected)
