"""Every rule of the architecture objects to a small tree that breaks it, and to no other."""

from __future__ import annotations

import re
from pathlib import Path

import graph
import pytest
import rules
from fortran import Tree, build_macros, read_tree

BUILD = {
    "meson.build": "subdir('rwmf')\nsubdir('app')\nfiles('rwmf.f90')",
    "rwmf/meson.build": "# subdir('motion')\nsubdir('core')\nsubdir('model')",
    "rwmf/core/meson.build": "files('kinds.f90')",
    "rwmf/model/meson.build": "files('cable.f90', 'wall.F90')",
    "app/meson.build": "executable('x', 'main.f90')",
}
SOURCES = {
    "rwmf.f90": "module rwmf\nuse rwmf_model_cable, only: f\nend module rwmf",
    "rwmf/core/kinds.f90": (
        "module rwmf_core_kinds\nuse, intrinsic :: iso_fortran_env, only: real64\n"
        "integer, parameter :: wp = real64\nend module rwmf_core_kinds"
    ),
    "rwmf/model/cable.f90": """
module rwmf_model_cable
   use rwmf_core_kinds, only: &
      wp ! use rwmf_model_wall
   implicit none
   type :: cable_t
      real(wp) :: force = 0.0_wp
   contains
      procedure :: f
   end type cable_t
contains
   function f(x, &
         y) result(text)
      real(wp), intent(in) :: x, y
      character(:), allocatable :: text
      text = 'stop'' use &
         &print'
   end function f
end module rwmf_model_cable""",
    "rwmf/model/wall.F90": (
        "module rwmf_model_wall\nuse rwmf_model_cable\nend module rwmf_model_wall"
    ),
    "app/main.f90": "program p\nuse rwmf\ninteger :: i\nprint *, i\nend program p",
}


def _write(folder: Path, changes: dict[str, str]) -> tuple[Tree, list[str]]:
    for name, text in (BUILD | SOURCES | changes).items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return read_tree(folder), rules.order_of_folders(folder)


def _all_rules(tree: Tree, order: list[str]) -> dict[str, list[str]]:
    return {
        "name": rules.wrong_names(tree),
        "target": rules.unknown_targets(tree),
        "order": rules.against_order(tree, order),
        "effects": rules.between_effects(tree, {}),
        "base name": rules.shared_base_names(tree, {}),
        "type name": rules.shared_type_names(tree, {}),
        "both ways": rules.both_ways(tree, order),
        "circle": tree.cycle,
        "sundials": rules.foreign_sundials(tree),
        "noise": rules.noise(tree, ["app"]),
        "transfer": rules.unchecked_transfers(tree),
        "state": rules.kept_state(tree, {}),
        "size": list(rules.too_large(tree)),
        "file": rules.long_files(tree),
        "build": rules.build_lists(tree.root),
        "types": rules.crowded_types(tree, rules.types_by_name(tree)),
        "model": rules.changed_models(tree, re.compile(r"\w+:prepare_\w+")),
        "pointer": rules.pointers_in(tree, "state_t"),
    }


def _module(name: str, text: str) -> str:
    return f"module rwmf_{name}\n{text}\nend module rwmf_{name}"


def _body(text: str) -> str:
    return f"contains\nsubroutine s()\n{text}\nend subroutine s"


KINDS = "rwmf/core/kinds.f90"
CABLE = "rwmf/model/cable.f90"
WALL = "rwmf/model/wall.F90"


def _kinds(text: str) -> dict[str, str]:
    return {KINDS: _module("core_kinds", text)}


def _wall(text: str) -> dict[str, str]:
    return {WALL: _module("model_wall", text)}


def _model(body: str, of_state: str = "integer :: side") -> str:
    """Return the text of a module with a model and a procedure that has this body."""
    return (
        f"type :: part_t\nreal, allocatable :: x(:)\nend type part_t\n"
        f"type :: state_t\n{of_state}\nend type state_t\n"
        f"type :: model_t\ntype(part_t) :: part\ninteger :: n\nend type model_t\n"
        f"type, extends(model_t) :: equation_t\ntype(state_t) :: state\nend type equation_t\n"
        + _body(body)
    )


def test_the_order_is_that_of_the_build(tmp_path: Path) -> None:
    _, order = _write(tmp_path, {})
    assert order == ["rwmf/core", "rwmf/model", "rwmf", "app"]


def test_a_good_tree_breaks_nothing(tmp_path: Path) -> None:
    tree, order = _write(tmp_path, {})
    assert not any(_all_rules(tree, order).values())
    assert tree.longest_chain == ["p", "rwmf", "rwmf_model_cable", "rwmf_core_kinds"]
    assert tree.closure("rwmf_model_wall") == {
        "rwmf_model_wall",
        "rwmf_model_cable",
        "rwmf_core_kinds",
    }


BREACHES: dict[str, tuple[set[str], dict[str, str]]] = {
    "another name": ({"name"}, {WALL: "module rwmf_model_door\nend module rwmf_model_door"}),
    "an unknown module": ({"target"}, _wall("use rwmf_model_door, only: knob")),
    "an unknown macro": ({"target"}, _wall("use DOOR, only: knob")),
    "an included file": ({"target"}, _wall("include 'door.inc'")),
    "a later folder": ({"order", "circle"}, _kinds("use rwmf_model_cable, only: f")),
    "a later folder, continued": ({"order", "circle"}, _kinds("use &\n\n   rwmf_model_cable")),
    "a later folder, in #ifdef": (
        {"order", "circle"},
        _kinds("#ifdef NEVER\nuse, non_intrinsic :: rwmf_model_cable\n#endif"),
    ),
    "a later folder, by macro": (
        {"order", "circle"},
        _kinds("#define CABLE rwmf_model_cable\nuse CABLE, only: f"),
    ),
    "a later folder, from the build": (
        {"order", "circle"},
        {
            **_kinds("use CABLE_V3, only: f"),
            "rwmf/core/meson.build": "files('kinds.f90')\nforeach l, w : {'v3': '256'}\n"
            "args += '-DCABLE_' + l.to_upper() + '=' + 'rwmf_model_cable'\nendforeach",
        },
    ),
    "the facade": ({"order", "circle"}, {CABLE: _module("model_cable", "use rwmf")}),
    "no folder": (
        {"order", "build"},
        {"other/door.f90": "module rwmf_other_door\nend module rwmf_other_door"},
    ),
    "a circle in a folder": ({"circle"}, {CABLE: _module("model_cable", "use rwmf_model_wall")}),
    "sundials": ({"sundials"}, _wall("use fcvode_mod, only: FCVode")),
    "print": ({"noise"}, _wall(_body("print *, 'a'"))),
    "print on a condition": (
        {"noise"},
        _wall(_body("if (is_bad(1, (2))) write (*, *, iostat=i) 1")),
    ),
    "write to unit 6": ({"noise"}, _wall(_body("write(unit=*, fmt=*, iostat=i) 1"))),
    "write to a text": ({"transfer"}, _wall(_body("if (i > 0) write (text, '(i0)') i"))),
    "read from a text": ({"transfer"}, _wall(_body("read (text, *) i"))),
    "stop": ({"noise"}, _wall(_body("if (a) then; error stop 'b'; end if"))),
    "a variable of a module": ({"state"}, _wall("integer :: counter")),
    "a pointer of a module": ({"state"}, _wall("procedure(f), pointer :: law => null()")),
    "save": ({"state"}, _wall(_body("integer, save :: counter"))),
    "a value as declared": ({"state"}, _wall(_body("integer :: counter = 0"))),
    "data": ({"state"}, _wall(_body("integer :: counter\ndata counter /0/"))),
    "a long procedure": ({"size"}, _wall(_body("x = 1\n" * 61))),
    "many arguments": (
        {"size"},
        _wall("contains\npure real(wp) function f(a,b,c,d,e,g,h, &\n i,j)\nend function f"),
    ),
    "a crowded type": (
        {"types"},
        _wall(
            "type :: wall_t\nreal(wp) :: "
            + ", ".join(f"a_{i}(1, 2)" for i in range(31))
            + "\nend type wall_t"
        ),
    ),
    "a type crowded by its parent": (
        {"types"},
        _wall(
            "type :: base_t\nreal(wp) :: "
            + ", ".join(f"a_{i}" for i in range(30))
            + "\nend type base_t\ntype, extends(base_t) :: wall_t\ninteger :: n\nend type wall_t"
        ),
    ),
    "a model that may change": ({"model"}, _wall(_model("type(part_t), intent(inout) :: x"))),
    "a model that changes": (
        {"model"},
        _wall(_model("type(equation_t), intent(inout) :: e\nif (a(1)) e%part%x(2) = 1")),
    ),
    "a model that changes in a component": ({"model"}, _wall(_model("step%equation%n = 1"))),
    "a model that changes by another name": (
        {"model"},
        _wall(_model("class(equation_t), intent(inout) :: e\nassociate (p => e%part)\np%x = 1")),
    ),
    "a model that is allocated": (
        {"model"},
        _wall(_model("type(equation_t), intent(inout) :: e\nallocate (e%part%x(2))")),
    ),
    "a pointer in a state": ({"pointer"}, _wall(_model("integer :: i", "integer, pointer :: p"))),
    "a long file": ({"file"}, _wall("! comment\n" * 900)),
    "a source that is not built": ({"build"}, {"rwmf/model/cable.c": "int cable;"}),
    "a source that is not there": (
        {"build"},
        {"rwmf/core/meson.build": "files('kinds.f90', 'a.f90')"},
    ),
}


@pytest.mark.parametrize("name", list(BREACHES))
def test_a_breach_is_found(name: str, tmp_path: Path) -> None:
    expected, changes = BREACHES[name]
    tree, order = _write(tmp_path, changes)
    broken = {rule for rule, found in _all_rules(tree, order).items() if found}
    assert broken == expected


@pytest.mark.parametrize(
    "text",
    [
        _body("integer, parameter :: n = 1"),
        _body("real :: a(merge(1, 2, n == 1))"),
        _body("! integer :: n = 1\nx = 'integer :: n = 1; stop'"),
        _body("write (unit, *, iostat=i) 1\nif (is_bad) write (text, '(a)', iostat=i) 'stop'"),
        _body("contains\nsubroutine t()\n" + "x = 1\n" * 60 + "end subroutine t"),
        "interface\nsubroutine s(a,b,c,d,e,f,g,h,i) bind(c)\ninteger :: a\nend subroutine s\n"
        "end interface",
        "type, abstract :: wall_t\ninteger :: n = 0\nend type wall_t",
        _model("type(part_t), intent(in) :: x"),
        _model("type(equation_t), intent(inout) :: e\ne%state%side = 1"),
        _model("type(equation_t), intent(inout) :: e\nif (e%n == 1) n = e%n"),
        _model("type(equation_t), intent(inout) :: e\nassociate (n => size(e%part%x))\nm = n"),
        _model("type(other_t) :: e\ne%n = 1"),
    ],
)
def test_what_is_allowed_is_not_found(text: str, tmp_path: Path) -> None:
    tree, order = _write(tmp_path, _wall(text))
    assert not any(_all_rules(tree, order).values())


def _effects(folder: Path) -> tuple[Tree, list[str]]:
    effects = {
        "damper_loop": "",
        "damper": "use rwmf_model_effects_damper_loop",
        "storeys/yielding": "use rwmf_model_effects_storeys_building",
        "storeys/building": "use rwmf_model_effects_damper",
        "list": "use rwmf_model_effects_damper\nuse rwmf_model_effects_storeys_building",
        "loops": "use rwmf_model_effects_damper_loop",
    }
    return _write(
        folder,
        {
            f"rwmf/model/effects/{name}.f90": _module(
                "model_effects_" + name.replace("/", "_"), text
            )
            for name, text in effects.items()
        },
    )


def test_an_effect_that_uses_another_is_found(tmp_path: Path) -> None:
    tree, _ = _effects(tmp_path)
    (found,) = rules.between_effects(tree, {})
    assert "storeys uses rwmf_model_effects_damper of damper" in found


def test_a_permission_without_an_arrow_is_found(tmp_path: Path) -> None:
    tree, _ = _effects(tmp_path)
    assert not rules.between_effects(tree, {("storeys", "damper"): "shares its law"})
    found = rules.between_effects(tree, {("storeys", "damper"): "", ("damper", "storeys"): ""})
    assert found == ["damper -> storeys: is allowed, but not used"]


def test_a_file_that_is_compiled_twice_is_one_module(tmp_path: Path) -> None:
    """Its second name adds a suffix to the first, and arrows to it lead to the file."""
    wall = "#ifndef WALL\n#define WALL rwmf_model_wall\n#endif\nmodule WALL\nend module WALL"
    build = "files('cable.f90', 'wall.F90')\nnames = '-DWALL=' + 'rwmf_model_wall_v3'"
    changes = {
        WALL: wall,
        "rwmf/model/meson.build": build,
        "rwmf.f90": "module rwmf\nuse rwmf_model_wall_v3\nend module rwmf",
    }
    tree, order = _write(tmp_path, changes)
    assert not any(_all_rules(tree, order).values())
    assert tree.arrows["rwmf"] == {"rwmf_model_wall"}
    lanes = {"rwmf.f90": "module rwmf\nuse rwmf_model_wall_l16_v4\nend module rwmf"}
    tree, order = _write(tmp_path, {**changes, **lanes})
    assert not any(_all_rules(tree, order).values())
    assert tree.arrows["rwmf"] == {"rwmf_model_wall"}
    tree, _ = _write(
        tmp_path, {**changes, "rwmf/model/meson.build": build.replace("wall_", "door_")}
    )
    assert rules.wrong_names(tree) == ["rwmf/model/wall.F90: is compiled as rwmf_model_door_v3"]


def _lists(values: dict[str, set[str]]) -> dict[str, list[str]]:
    return {name: sorted(value) for name, value in values.items()}


BUILD_TEXTS: dict[str, tuple[str, dict[str, list[str]]]] = {
    "a comment": ("# a = '-DA=b'", {}),
    "a list": ("args = ['-O3',\n  '-DA=b']  # '-DA=c'", {"A": ["b"]}),
    "no module": ("args += '-DA'\nargs += '-DB=\"1\"'", {}),
    "what is not understood": (
        "x = declare_dependency(\n  a: 1)\ny = x + '-DA=b'\nz = '-DC=d'",
        {"C": ["d"]},
    ),
    "loops": (
        "kernels = {'STEP': 'step',\n  'NODE': 'stage'}\nforeach level, width : {'v3': 1, 'v4': 2}"
        "\nforeach macro, kernel : kernels\nmodule = 'm_' + kernel + '_' + level\n"
        "names += '-D' + macro + '=' + module\nendforeach\nif x\n  y = z()\nendif\nendforeach",
        {"STEP": ["m_step_v3", "m_step_v4"], "NODE": ["m_stage_v3", "m_stage_v4"]},
    ),
}


@pytest.mark.parametrize("name", list(BUILD_TEXTS))
def test_names_that_the_build_defines(name: str) -> None:
    text, expected = BUILD_TEXTS[name]
    assert _lists(build_macros(text)) == expected


def test_text_functions_are_counted(tmp_path: Path) -> None:
    tree, _ = _write(tmp_path, {})
    (procedure,) = tree.owners["rwmf_model_cable"].procedures
    assert procedure.returns_deferred_text
    assert (procedure.arguments, procedure.code_lines) == (2, 4)


RATCHETS = {
    "base name": (rules.shared_base_names, {"rwmf/model/kinds.f90": ""}, {"kinds": 2}),
    "type name": (
        rules.shared_type_names,
        _wall("type :: cable_t\ninteger :: n\nend type cable_t"),
        {"cable_t": 2},
    ),
}


@pytest.mark.parametrize("name", list(RATCHETS))
def test_a_ratchet_only_falls(tmp_path: Path, name: str) -> None:
    rule, changes, allowed = RATCHETS[name]
    (key,) = allowed
    good, _ = _write(tmp_path / "good", {})
    bad, _ = _write(tmp_path / "bad", changes)
    assert rule(good, {}) == rule(bad, allowed) == []
    assert rule(bad, {})[0].startswith(f"{key}: 2, allowed are 0: rwmf/")
    assert rule(good, allowed) == [f"{key}: 2 are allowed, 0 are found: lower the permission"]
    assert rule(bad, {key: 3}) == [f"{key}: 3 are allowed, 2 are found: lower the permission"]


# A sub-folder that uses the files beside it; the second text makes these use it as well.
_SPRING = "rwmf/model/laws/spring.f90"
_ONE_WAY = {_SPRING: _module("model_laws_spring", "use rwmf_model_cable, only: f")}
_BOTH_WAYS = _ONE_WAY | _wall("use rwmf_model_laws_spring")


def test_folders_that_use_each_other_are_found(tmp_path: Path) -> None:
    tree, order = _write(tmp_path / "one", _ONE_WAY)
    assert rules.both_ways(tree, order) == []
    tree, order = _write(tmp_path / "both", _BOTH_WAYS)
    assert tree.cycle == []
    (found,) = rules.both_ways(tree, order)
    assert found.startswith("rwmf/model and rwmf/model/laws: rwmf/model/wall.F90:2 uses")


def test_modules_that_name_an_effect_are_counted(tmp_path: Path) -> None:
    effect = {"rwmf/model/effects/corner_damper.f90": _module("model_effects_corner_damper", "")}
    others = {
        "use": "use rwmf_model_effects_corner_damper",
        "name": "integer :: Damper",
        "text": "character(*), parameter :: key = 'damper'",
    }
    for text in others.values():
        tree, _ = _write(tmp_path, effect | _wall(text))
        assert rules.naming_modules(tree, "damper") == ["rwmf_model_wall"]
    tree, _ = _write(tmp_path, effect | _wall("integer :: undamped ! no damper"))
    assert rules.naming_modules(tree, "damper") == []


CODE = {
    "a.f90": "module m\n\n   ! a comment\n   !$omp simd\n   x = 1 ! code\nend module m\n",
    "a.py": '"""A text\nof two lines."""\n\nx = 1\n# no code\ny = """not a\ndocstring"""\n',
    "a.c": "/* a comment\n   of two lines */\n// another\nint x; /* code */\nint y;\nint z;\n",
    "script": "#!/bin/sh\n# a comment\na=1\n\nb=2\n  c=3\n",
    "a.html": "<p>\n<!-- a\ncomment -->\n\n</p>\n<br>\n",
}


@pytest.mark.parametrize("name", list(CODE))
def test_code_lines_are_neither_blank_nor_comment(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    path.write_text(CODE[name], encoding="utf-8")
    assert graph.code_lines(path) == 3
    other = tmp_path / "a.lock"
    other.write_text("not\ncode\n", encoding="utf-8")
    assert graph.code_lines(other) == 0
