"""No array of user-defined size on the stack, by the compiler's report on every frame.

``-fstack-usage`` leaves a list beside each object. A frame is `dynamic` where its size depends on
numbers of a run. In the three folders that meson compiles with ``-fstack-arrays`` such
frames hold a few numbers for each state, and the number of states is bounded (1,000 storeys).
tests/robustness/test_small_stack.py runs them at that bound. Elsewhere each dynamic frame has a
reason here.
"""

import re
from collections.abc import Iterable
from pathlib import Path

import pytest
from checkout import ROOT

BUILD = ROOT / "build" / "src"
# a row of states or less
OF_STATES = ("model", "integrator", "paper", "simulation")
# procedures elsewhere, and why their frames are small
ALLOWED = {"input/schema_check.f90:suggest": "a name of the table of keys"}
# fixed frames: the largest that the deepest calls leave room for [bytes]
LARGEST = 65536


def frames(lists: Iterable[Path]) -> dict[tuple[str, str], tuple[int, str]]:
    """Read size and kind of the frame of each procedure, by file and name."""
    found = {}
    for path in lists:
        for line in path.read_text(encoding="utf-8").splitlines():
            place, size, kind = line.split("\t")
            file, _, _, name = place.rsplit(":", 3)
            if "/src/" not in f"/{file}":
                continue
            # clones of the compiler, and procedures that release a type's components
            name = re.sub(r"\.(constprop|isra|part|cold).*", "", name)
            if not name.startswith(("__final_", "__copy_")):
                key = (f"/{file}".rpartition("/src/")[2].removeprefix("rwmf/"), name)
                found[key] = max(found.get(key, (0, "")), (int(size), kind))
    return found


@pytest.fixture(scope="module")
def built() -> dict[tuple[str, str], tuple[int, str]]:
    """Frames of the kernel and the batch program."""
    lists: dict[str, Path] = {}
    for path in sorted(BUILD.rglob("*.su"), key=lambda path: path.stat().st_mtime):
        # a library that is no longer built leaves its lists behind: the newest of each name counts
        if "quad" not in str(path):
            lists[path.name] = path
    assert len(lists) > 150, "the build has no lists of frames: tools/run --version makes them"
    return frames(lists.values())


def test_dynamic_frames_hold_states_only(built: dict[tuple[str, str], tuple[int, str]]) -> None:
    dynamic = {key for key, (_, kind) in built.items() if kind == "dynamic"}
    assert len(dynamic) > 50
    other = {f"{file}:{name}" for file, name in dynamic if file.split("/")[0] not in OF_STATES}
    assert other == set(ALLOWED)


def test_fixed_frames_are_small(built: dict[tuple[str, str], tuple[int, str]]) -> None:
    large = {key: size for key, (size, _) in built.items() if size > LARGEST}
    assert not large
