"""Build of the documentation site; ``tools/docs`` installs its requirements and calls it."""

from __future__ import annotations

import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor, as_completed
from functools import cache, partial
from multiprocessing import get_context
from pathlib import Path

from pages import blocks, check, explorer, made, notebooks, sketches

ROOT = blocks.ROOT
BUILD = ROOT / "build" / "pages"
SITE = ROOT / "build" / "site"
SKETCHES = ROOT / "docs" / "theory" / "figures" / "sketches"
_SECONDS_SHOWN = 0.1
# folders of the site that Sphinx does not write
_OTHERS = ("fortran", "explorer")
_SHOWN = (
    "examples",
    "tests/unit",
    "tests/export",
    "tools/pages/blocks.py",
    "tools/pages/notebooks.py",
    "tools/requirements.lock",
)


def main() -> int:
    """Build the changed parts; the exit status is 1 for an error in a page."""
    if not SITE.is_dir():
        shutil.rmtree(BUILD, ignore_errors=True)
    if "--made" in sys.argv[1:]:
        made.write_all()
    try:
        _run_parts()
        step("pages by Sphinx", _run_sphinx, _sphinx_files())
        step("links", _check_links, [*_sphinx_files(), *_files("src")])
    except blocks.PageError as error:
        print(f"docs: {error}", file=sys.stderr)
        return 1
    print(f"{SITE.relative_to(ROOT) / 'index.html'}")
    return 0


def _run_parts() -> None:
    """Run the parts that do not depend on each other, one process for each processor."""
    shutil.rmtree(blocks.INSTALLED, ignore_errors=True)
    if not SKETCHES.is_dir():
        (BUILD / "sketches.key").unlink(missing_ok=True)
    pages = ("docs/fortran.css", "tools/pages/fortran_pages.py", "tools/pages/docstrings.py")
    kernel = _files("src", *pages, "tools/docs.lock")
    drawing = _files("tools/pages/sketches.py", "driver/rwmf/figures/styles.py")
    copy = [*_files("tools/pages/explorer"), *_program()]
    write_copy = partial(explorer.write, SITE / "explorer")
    # spawned: a forked process would share the threads of the libraries that are loaded
    with ProcessPoolExecutor(os.cpu_count(), get_context("spawn")) as pool:
        parts = [
            pool.submit(step, "pages by FORD", _run_ford, kernel),
            pool.submit(step, "read-only explorer", write_copy, copy),
            pool.submit(step, "sketches", partial(sketches.write_all, SKETCHES), drawing),
            *(pool.submit(run_blocks, page) for page in blocks.pages()),
        ]
        try:
            for part in as_completed(parts):
                part.result()
        except blocks.PageError:
            pool.shutdown(cancel_futures=True)
            raise


def run_blocks(page: Path) -> None:
    """Run the blocks of a page and keep the figures that they draw, unless nothing has changed."""
    # a notebook holds the prose of its page as well
    is_notebook = notebooks.is_offered(page)

    def run() -> None:
        with tempfile.TemporaryDirectory() as name:
            (notebooks if is_notebook else blocks).run_page(page, Path(name))
            blocks.keep_figures(page, Path(name))

    text = page.read_text(encoding="utf-8") if is_notebook else blocks.code_of(page)
    step(f"blocks of {page.relative_to(ROOT)}", run, _program(), text)


def step(name: str, run: Callable[[], None], inputs: Iterable[Path], text: str = "") -> None:
    """Do one step unless its inputs are those of its last success."""
    BUILD.mkdir(parents=True, exist_ok=True)
    key = hashlib.sha256(text.encode())
    for path in sorted(set(inputs)):
        key.update(f"{path} {_digest(path)}\n".encode())
    stamp = BUILD / (name.replace("/", "-").replace(" ", "-") + ".key")
    if stamp.is_file() and stamp.read_text(encoding="utf-8") == key.hexdigest():
        return
    stamp.unlink(missing_ok=True)
    started = time.perf_counter()
    try:
        run()
    except blocks.PageError as error:
        raise blocks.PageError(f"{name}: {error}") from error
    spent = time.perf_counter() - started
    if spent > _SECONDS_SHOWN:
        print(f"docs: {name}: {spent:.1f} s", file=sys.stderr)
    stamp.write_text(key.hexdigest(), encoding="utf-8")


@cache
def _digest(path: Path) -> str:
    """Checksum of a file, which does not change while the site is built."""
    return hashlib.sha256(path.read_bytes()).hexdigest()


def _files(*places: str) -> list[Path]:
    """List the files in these places that git tracks or would track, without generated files."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard", *places],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    return [path for path in map(ROOT.joinpath, listed.stdout.split("\0")) if path.is_file()]


@cache
def _program() -> list[Path]:
    """List the files that the blocks depend on."""
    extensions = (ROOT / "build" / "src" / "bindings" / "python").glob("_*.so")
    return [*_files("driver", "inputs", *_SHOWN), *extensions]


def _sphinx_files() -> list[Path]:
    return [*_files("docs", "plots", "include", "tools/pages", "tools/docs.lock"), *_program()]


def _run_sphinx() -> None:
    """Write all pages, so that none stays whose source has gone; those of others stay."""
    for path in SITE.glob("*"):
        if path.is_dir() and path.name not in _OTHERS:
            shutil.rmtree(path)
        elif path.is_file():
            path.unlink()
    words = ["-m", "sphinx", "-n", "-W", "--keep-going", "-q", "-j", "auto", "-b", "html", "docs"]
    done = subprocess.run(
        [sys.executable, *words, SITE, "-d", BUILD / "doctrees"], cwd=ROOT, check=False
    )
    if done.returncode:
        raise blocks.PageError(f"Sphinx ends with {done.returncode}")


def _run_ford() -> None:
    import rwmf

    from pages import fortran_pages

    warnings = fortran_pages.build(SITE / "fortran", BUILD / "ford", rwmf.__version__)
    if warnings:
        raise blocks.PageError("\n".join(warnings))


def _check_links() -> None:
    faults = check.faults_of(SITE)
    if faults:
        raise blocks.PageError("\n".join(faults))
