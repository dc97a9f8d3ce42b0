"""The folders of `src` show the architecture (docs/developer/architecture.md) and keep it so.

The `meson.build` files (`src/meson.build` and `src/rwmf/meson.build`) define the order of the
folders, which is also the order of the build. A folder uses itself and those before it.
"""

import re
from pathlib import Path

import pytest
import rules
from fortran import Tree, read_tree

ROOT = Path(__file__).resolve().parents[2]
SRC = ROOT / "src"

# The folder whose files may print and stop: the program's.
MAY_PRINT = ("app",)

STATE_ALLOWED = {
    "rwmf_app_signals": "a signal handler receives nothing but the number of the signal",
}

# Largest number of modules outside an effect's own files that use it or contain its name in code.
NAMING_MODULES = {"storeys": 6, "vertical": 5, "yielding": 5}

# Procedures over the bounds, with reasons. Remove the line of a procedure when you shorten it.
_CALLER_IS_NO_FORTRAN = "an interface for f2py: scalars and plain arrays, no types"
_STEP_OF_A_HOST = "both ends of a step of a host, what is found, and an error that it may leave out"
_VECTORISED = "a vectorised loop: a call would end it"
LARGE: dict[str, str] = {
    "rwmf_integrator_lane_control:accept_or_reject": _VECTORISED,
    "rwmf_integrator_lane_step:attempt_step": "a block of lanes as plain arrays",
    "rwmf_integrator_lane_quiet:find_quiet_steps": "a block of lanes as plain arrays",
    "rwmf_integrator_lane_screens:screen_steps": "a block of lanes as plain arrays",
    "rwmf_integrator_series_series_loops:end_all": _VECTORISED,
    "rwmf_integrator_series_series_loops:expand": _VECTORISED,
    "rwmf_integrator_series_series_demand_loops:expand_terms": _VECTORISED,
    "rwmf_integrator_series_series_loops:screen": _VECTORISED,
    "rwmf_embedding_element:next_impact": _STEP_OF_A_HOST,
    "rwmf_embedding_element:next_lift_off": _STEP_OF_A_HOST,
    "rwmf_bindings_python_cost:measure": _CALLER_IS_NO_FORTRAN,
    "rwmf_bindings_python_cost:measure_fixed_steps": _CALLER_IS_NO_FORTRAN,
    "rwmf_bindings_python_reference:solve": _CALLER_IS_NO_FORTRAN,
}


# Types of runs that have to stay small as well as those of the model.
STATES = ("hybrid_t", "snapshot_t", "wall_instance_t", "wall_element_t")

# Procedures that assemble a model, and the contributions of each effect. In an embedding the motion
# comes from the host, and an element has none.
ASSEMBLY = re.compile(
    r"rwmf_model_(system_assembly|system_contributions|system_placement|effects_list|scene):\w+"
    r"|rwmf_model_hysteresis_spring_set:add_springs"
    r"|rwmf_model_\w+:(prepare|choose|set)_\w+"
    r"|rwmf_embedding_wall_instance:(size_to_expect|use_host_motion|hold_ground_acceleration"
    r"|restore_state)"
    r"|rwmf_embedding_stepping:advance_own"
    r"|rwmf_embedding_(element:create_element|member:create_member)"
)


@pytest.fixture(scope="module")
def tree() -> Tree:
    return read_tree(SRC)


@pytest.fixture(scope="module")
def order() -> list[str]:
    return rules.order_of_folders(SRC)


def _none(found: list[str]) -> None:
    assert not found, "\n" + "\n".join(found)


def test_a_module_is_named_by_its_path(tree: Tree) -> None:
    _none(rules.wrong_names(tree))


def test_every_arrow_has_a_known_target(tree: Tree) -> None:
    _none(rules.unknown_targets(tree))


def test_a_folder_uses_itself_and_those_before(tree: Tree, order: list[str]) -> None:
    _none(rules.against_order(tree, order))


def test_an_effect_uses_no_other(tree: Tree) -> None:
    _none(rules.between_effects(tree))


def test_names_of_files_and_types_are_unique(tree: Tree) -> None:
    _none(rules.shared_names(tree))


def test_folders_inside_a_top_folder_use_each_other_one_way(tree: Tree, order: list[str]) -> None:
    _none(rules.both_ways(tree, order))


@pytest.mark.parametrize("effect", list(NAMING_MODULES))
def test_few_modules_name_an_effect(tree: Tree, effect: str) -> None:
    found = rules.naming_modules(tree, effect)
    print(f"{effect}: {len(found)} modules: {', '.join(found)}")
    assert len(found) <= NAMING_MODULES[effect]


def test_only_two_folders_name_sundials(tree: Tree) -> None:
    _none(rules.foreign_sundials(tree))


def test_the_library_neither_prints_nor_stops(tree: Tree) -> None:
    _none(rules.noise(tree, MAY_PRINT))


def test_every_transfer_has_a_status(tree: Tree) -> None:
    _none(rules.unchecked_transfers(tree))


def test_nothing_is_kept_between_calls(tree: Tree) -> None:
    _none(rules.kept_state(tree, STATE_ALLOWED))


def test_procedures_stay_small(tree: Tree) -> None:
    over = rules.too_large(tree)
    for name, size in over.items():
        print(f"{name}: {size} ({LARGE.get(name, 'NOT ALLOWED')})")
    _none([f"{name}: {size}" for name, size in over.items() if name not in LARGE])
    _none([f"{name}: is small, its line in LARGE can go" for name in LARGE if name not in over])


def test_types_of_model_and_state_stay_small(tree: Tree) -> None:
    of_model = [
        found.name
        for source in tree.sources
        if source.path.as_posix().startswith("rwmf/model/")
        for found in source.types
    ]
    assert {"model_t", "discrete_state_t", "equation_t"} <= set(of_model)
    counts = rules.component_counts(tree)
    print({name: counts[name] for name in [*of_model, *STATES]})
    _none(rules.crowded_types(tree, [*of_model, *STATES]))


def test_a_model_is_fixed_once_it_is_put_together(tree: Tree) -> None:
    assert {"floors_t", "spring_t", "contribution_t"} <= rules.parts_of(tree, rules.MODEL).keys()
    _none(rules.changed_models(tree, ASSEMBLY))


def test_a_discrete_state_is_plain_values(tree: Tree) -> None:
    assert rules.pointers_in(tree, "discrete_state_t") == []


def test_files_stay_readable(tree: Tree) -> None:
    _none(rules.long_files(tree))


def test_every_build_file_lists_the_sources_beside_it() -> None:
    _none(rules.build_lists(SRC))


def test_every_fortran_test_is_built() -> None:
    unit = ROOT / "tests" / "unit"
    built = (unit / "meson.build").read_text(encoding="utf-8")
    names = [path.stem.removeprefix("test_") for path in unit.rglob("test_*.f90")]
    assert names and all(f"'{name}'" in built for name in names)


def test_the_page_names_the_folders_in_their_order(order: list[str]) -> None:
    page = (ROOT / "docs" / "developer" / "architecture.md").read_text(encoding="utf-8")
    page = page.partition("\n## The folders of the kernel\n")[2]
    named = re.findall(r"^\| `(?:src/)?([\w/.]+?)/?` \|", page, re.MULTILINE)
    assert [name.removesuffix(".f90") for name in named] == [
        name.removeprefix("rwmf/") for name in order
    ]


def test_the_page_names_files_that_exist() -> None:
    page = (ROOT / "docs" / "developer" / "architecture.md").read_text(encoding="utf-8")
    paths = re.findall(r"`([\w/]+\.(?:[fF]90|py|h|build))`", page)
    places = [ROOT, SRC, SRC / "rwmf"]
    _none([path for path in paths if not any((place / path).is_file() for place in places)])
