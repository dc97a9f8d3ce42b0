"""Every Fortran test is built, and every group of its checks can be run alone, by its name."""

import re
from pathlib import Path

UNIT = Path(__file__).resolve().parents[1] / "unit"
_MAIN = re.compile(r"^program \w+$.*?^contains$", re.DOTALL | re.MULTILINE)
_CALL = re.compile(r"^.*\bcall ((?:check|test)_\w+).*$", re.MULTILINE)


def nameless(text: str) -> list[str]:
    """Find calls in the main part of a program that belong to no named group.

    Parameters
    ----------
    text : str
        The program.

    Returns
    -------
    list of str
        Procedures that are called without `checks%wants`, and do not call it themselves.
    """
    main = _MAIN.search(text)
    assert main, "no main part"
    found = [call[1] for call in _CALL.finditer(main[0]) if "%wants(" not in call[0]]
    return [name for name in found if "%wants(" not in _body(text, name)]


def _body(text: str, name: str) -> str:
    found = re.search(rf"subroutine {name}\b.*?end subroutine {name}\b", text, re.DOTALL)
    return found[0] if found else ""


def test_every_group_has_a_name() -> None:
    programs = sorted(UNIT.rglob("test_*.f90"))
    built = (UNIT / "meson.build").read_text(encoding="utf-8")
    assert programs and all(f"'{path.stem.removeprefix('test_')}'" in built for path in programs)
    found = {path.name: nameless(path.read_text(encoding="utf-8")) for path in programs}
    assert not {name: calls for name, calls in found.items() if calls}
