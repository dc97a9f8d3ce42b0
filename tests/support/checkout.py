"""Places of the checkout that tests name, and programs that they run."""

import contextlib
import io
import os
import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

from rwmf import cli

ROOT = Path(__file__).resolve().parents[2]
SUPPORT = ROOT / "tests" / "support"
REFERENCE = ROOT / "tests" / "reference"
# the batch program of the build, or another one
BATCH = Path(os.environ.get("RWMF_BATCH", ROOT / ".venv" / "bin" / "rwmf-batch"))

Runner = Callable[..., "subprocess.CompletedProcess[str]"]


def run_python(code: str, folder: Path, *path: Path) -> subprocess.CompletedProcess[str]:
    """Run lines of Python in a separate process that can import the support modules.

    Parameters
    ----------
    code : str
        The lines.
    folder : Path
        Where they run.
    *path : Path
        Folders of further modules.

    Returns
    -------
    subprocess.CompletedProcess
        Status and streams.
    """
    places = os.pathsep.join(map(str, (SUPPORT, *path)))
    return run_words([sys.executable, "-c", code], folder, PYTHONPATH=places)


def run_words(
    words: list[str | Path], folder: Path, stack: int = 0, **environment: str
) -> subprocess.CompletedProcess[str]:
    """Run a command in a folder; its exit status is the caller's to judge.

    Parameters
    ----------
    words : list
        Program and arguments.
    folder : Path
        Where it runs.
    stack : int
        Size of its stack [bytes]; 0 for that of the tests.
    **environment : str
        Variables that it sees besides those of the tests.

    Returns
    -------
    subprocess.CompletedProcess
        Status and streams.
    """

    def shrink() -> None:
        resource.setrlimit(resource.RLIMIT_STACK, (stack, stack))

    return subprocess.run(
        [str(word) for word in words],
        cwd=folder,
        env=os.environ | environment,
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
        preexec_fn=shrink if stack else None,
    )


def run_command(words: list[str | Path], folder: Path) -> subprocess.CompletedProcess[str]:
    """Run the command rwmf in this process and a folder.

    Parameters
    ----------
    words : list
        Arguments.
    folder : Path
        Where it runs.

    Returns
    -------
    subprocess.CompletedProcess
        Status and streams.
    """
    output, errors = (io.TextIOWrapper(io.BytesIO(), "utf-8") for _ in range(2))
    arguments = [str(word) for word in words]
    with (
        contextlib.chdir(folder),
        contextlib.redirect_stdout(output),
        contextlib.redirect_stderr(errors),
    ):
        status = cli.main(arguments)
    texts = []
    for stream in (output, errors):
        stream.seek(0)
        texts.append(stream.read())
    return subprocess.CompletedProcess(arguments, status, *texts)
