"""Sizes at their limits with a small stack: nothing that a user sizes lies on it."""

import os
from pathlib import Path

import fuzz_sizes
import pytest
from checkout import BATCH, run_words

FIRST = int(os.environ.get("RWMF_FUZZ_FIRST", "0"))
ATTACKS = int(os.environ.get("RWMF_FUZZ", "1"))


@pytest.mark.slow
@pytest.mark.parametrize("number", range(FIRST, FIRST + ATTACKS))
@pytest.mark.parametrize("kind", fuzz_sizes.KINDS)
def test_sizes_at_their_limits(kind: str, number: int, tmp_path: Path) -> None:
    """The batch program and Python answer; RWMF_FUZZ sets the number of attacks of each kind."""
    fuzz_sizes.survive(fuzz_sizes.attack(kind, number), tmp_path)


@pytest.mark.slow
@pytest.mark.parametrize("law", fuzz_sizes.choices("yielding.law")[::3])
def test_every_law_in_many_storeys(law: str, tmp_path: Path) -> None:
    # a matrix of the storeys is larger than the stack
    text = fuzz_sizes.building(400, "full", law, "dop853")
    (tmp_path / "case.nml").write_text(text.replace("t_end = 2e-4", "t_end = 1e-4"), "utf-8")
    done = run_words([BATCH, "case.nml"], tmp_path, fuzz_sizes.STACK)
    assert done.returncode == 0, done.stderr


def test_many_samples_of_an_array(tmp_path: Path) -> None:
    """A motion of more samples than a stack of 8 MB holds."""
    attack = fuzz_sizes.Attack(
        {"case.nml": "&frame xi_s = 0.05, T_s = 1.0 /\n&solver t_end = 0.1 /\n"
         "&motion kind = 'one_sine', a_max_g = 0.4, T_p = 1.0 /\n"},
        "a = np.sin(np.arange(1_100_000) / 9)\n"
        "rwmf.simulate(case.replace(motion=rwmf.Motion(a, times=np.arange(a.size) * 0.01, "
        "unit='g')))\n",
    )  # fmt: skip
    fuzz_sizes.survive(attack, tmp_path)
