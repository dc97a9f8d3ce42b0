"""Types of the public names in the eyes of a checker and of an editor."""

import runpy
from collections.abc import Mapping
from keyword import iskeyword

import pytest
import rwmf
from checkout import ROOT
from rwmf.kernel.tables import schema
from scenes import coupled


def test_a_users_script_runs() -> None:
    """`tools/lint` checks its types."""
    runpy.run_path(str(ROOT / "tests" / "typing" / "user_script.py"))


def test_declared_keys_are_those_of_the_kernel() -> None:
    """`tools/docs --made` makes the declarations; every value of a case has its declared type."""
    types = {"float": float, "int": int, "bool": bool, "str": str}
    declared = rwmf.case.groups.TYPES
    assert list(declared) == list(dict.fromkeys(row.group for row in schema()))
    for row in schema():
        annotations = declared[row.group].__annotations__
        assert (row.key in annotations) != iskeyword(row.key), row
    for name, group in coupled().groups.items():
        assert type(group) is declared[name]
        for key, value in group.items():
            first, *_ = declared[name].__annotations__[key].split(" | ")
            kind = first.split("[")[0]
            assert isinstance(value, types.get(kind, str if kind == "Literal" else tuple)), key


def test_names_for_completion() -> None:
    case = coupled()
    assert {*case.groups} <= {*dir(case)}
    assert "storeys" not in dir(case)
    assert {*case.wall} <= {*dir(case.wall)}
    assert "m_w" not in dir(case.wall)
    assert case.storeys is None
    assert isinstance(case.wall, Mapping)
    assert all(hasattr(case, name) for name in dir(case))
    assert all(hasattr(case.wall, name) for name in dir(case.wall))


def test_an_editor_completes_names() -> None:
    """Jedi, which completes in notebooks, knows groups and keys without running the script."""
    jedi = pytest.importorskip("jedi")
    begin = "import rwmf\ncase = rwmf.Case.from_text('')\n"

    def after(text: str) -> set[str]:
        return {found.name for found in jedi.Script(begin + text).complete()}

    assert set(rwmf.__all__) <= after("rwmf.")
    assert {*rwmf.case.groups.TYPES, "replace", "without_wall"} <= after("case.")
    assert {"h", "b", "m_w", "given"} <= after("case.replace(frame={}).wall.")
    assert {"advance", "state"} <= after("rwmf.Wall(case).")
    (kind,) = jedi.Script(begin + "case.wall.h").infer()
    assert kind.name == "float"


def test_a_table_in_a_notebook() -> None:
    """It shows every key with its value, unit and meaning; text of the user is escaped."""
    case = coupled(motion=rwmf.Motion([0.0, 1.0], dt=0.1, unit="g", name="<b>&"))
    page = case._repr_html_()
    for name, group in case.groups.items():
        assert f">&amp;{name}</td>" in page
        for key in group:
            assert f">{key}</td>" in page
        assert group._html_rows() in page
    assert "<b>" not in page
    assert "half height of the wall" in page
    assert page.count("<tr") == page.count("</tr>") == sum(map(len, case.groups.values()))
