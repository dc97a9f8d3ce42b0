"""What the driver's sources show: one module imports the extension, plots only plot."""

from __future__ import annotations

import re
from pathlib import Path

DRIVER = Path(__file__).resolve().parents[2] / "driver" / "rwmf"


def test_one_python_module_imports_the_extension() -> None:
    importers = [
        path.relative_to(DRIVER).as_posix()
        for path in DRIVER.rglob("*.py")
        if re.search(r"import _kernel|_kernel import", path.read_text(encoding="utf-8"))
    ]
    assert importers == ["_library.py"]


def test_plot_never_simulates() -> None:
    text = (DRIVER / "plot.py").read_text(encoding="utf-8")
    assert not re.search(r"^(from|import) rwmf", text, re.MULTILINE)
