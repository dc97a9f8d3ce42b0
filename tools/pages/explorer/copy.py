"""Write the page of ``rwmf explore`` with stored answers of three examples.

Browsers load no modules from files. The copy therefore has one plain script: each module of the
page becomes a function that returns its exports.
"""

from __future__ import annotations

import json
import re
import shutil
from pathlib import Path
from typing import Any

import rwmf
from rwmf.errors import RwmfError
from rwmf.explorer.model import Model, start
from rwmf.explorer.questions import (
    PRESETS,
    BadQuestionError,
    Preset,
    Question,
    case_of_preset,
    given,
)

__all__ = ["bundle", "write"]

_PAGE = Path(rwmf.__file__).parent / "explorer" / "page"
_STORED = Path(__file__).with_name("stored.js")
# examples, the first one at the opening, and the quantities of their spectra; '' for the default
_SHOWN = {
    "six_storeys": ("", "storey_drift_max"),
    "wall_and_frame": ("", "theta_max_over_alpha"),
    "block": ("",),
}
_POINTS = 200
_IMPORT = re.compile(r'import \{([^}]*)\} from "\./(\w+)\.js";\n')
_EXPORT = re.compile(r"^export (?=(?:async )?(?:function|class|const) (\w+))", re.MULTILINE)
_SCRIPT = re.compile(r"<script[^>]*></script>\n")


def write(folder: Path) -> None:
    """Write the copy."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    shutil.copytree(_PAGE / "vendor", folder / "vendor")
    shutil.copy(_PAGE / "app.css", folder)
    shutil.copy(_STORED, folder)
    (folder / "answers.js").write_text(
        f"window.stored = {json.dumps(_answers(), allow_nan=False)};\n", encoding="utf-8"
    )
    (folder / "page.js").write_text(bundle(_PAGE / "main.js"), encoding="utf-8")
    names = ("vendor/uPlot.iife.js", "answers.js", "stored.js", "page.js")
    scripts = "".join(f'<script src="{name}" defer></script>\n' for name in names)
    html = _SCRIPT.sub("", (_PAGE / "index.html").read_text(encoding="utf-8"))
    html = html.replace("</head>", f"{scripts}</head>")
    (folder / "index.html").write_text(html, encoding="utf-8")


def bundle(main: Path) -> str:
    """Join a module and those that it imports into one plain script."""
    done: dict[str, str] = {}

    def add(path: Path) -> None:
        if path.stem in done:
            return
        done[path.stem] = ""
        text = path.read_text(encoding="utf-8")
        for _, name in _IMPORT.findall(text):
            add(path.with_name(f"{name}.js"))
        exports = ", ".join(_EXPORT.findall(text))
        body = _EXPORT.sub("", _IMPORT.sub(r"const {\1} = $\2;\n", text))
        # insert in the order in which the modules are needed
        del done[path.stem]
        done[path.stem] = f"(async () => {{\n{body}\n}})();\n"
        if path != main:
            module = f"(() => {{\n{body}\nreturn {{ {exports} }};\n}})();\n"
            done[path.stem] = f"const ${path.stem} = {module}"

    add(main)
    return '"use strict";\n' + "".join(done.values())


def _answers() -> dict[str, Any]:
    """Compute the answers to all questions that the copy can ask."""
    presets = {preset.name: preset for preset in PRESETS}
    first, *others = (presets[name] for name in _SHOWN)
    description = start(case_of_preset(first.name), [])
    shown = [preset for preset in description["presets"] if preset["name"] in
             [other.name for other in others]]  # fmt: skip
    return {
        "start": description
        | {"presets": shown, "read_only": True, "name": first.title, "sentence": first.sentence},
        "cases": [_stored(preset) for preset in (first, *others)],
    }


def _stored(preset: Preset) -> dict[str, Any]:
    case = case_of_preset(preset.name)
    groups = given(case)
    model = Model(case, Path(__file__).parent)
    found: dict[str, Any] = {
        "groups": groups,
        "history": model.history(Question(groups, "", _POINTS, ""), _ignore),
        "spectra": {},
        "problem": "",
    }
    for quantity in _SHOWN[preset.name]:
        try:
            answer = model.spectrum(Question(groups, "", _POINTS, quantity), _ignore)
        except (RwmfError, BadQuestionError) as error:
            found["problem"] = str(error)
        else:
            found["spectra"][answer["quantity"]["key"]] = answer
    for answer in found["spectra"].values():
        answer["quantities"] = [row for row in answer["quantities"] if row[0] in found["spectra"]]
    # times of the machine that builds the site would change with each build
    for answer in (found["history"], *found["spectra"].values()):
        answer["kernel_seconds"] = 0.0
    return found


def _ignore(_: int = 0) -> None:
    """Do not stop the computation."""
