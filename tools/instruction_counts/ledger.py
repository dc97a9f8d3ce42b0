"""Counts stored in the repository, and rules for changing them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Self

from instruction_counts.calls import CALLS, NAMES

LIMIT = 1.03
"""A call whose count exceeds this times the recorded one has grown."""
NOISE = 1.01
"""The same program counted again: a host's counts differ by 0.03 %, those of Python by 0.5 %."""

_HEAD = """\
# Instructions of the standard calls, counted by valgrind's callgrind; written by tools/counts, see
# developer/bench.md. Their conditions come first. Below a count: date, earlier count and
# reason.
"""


class RefusedError(Exception):
    """Counts are not recorded: a reason is missing, or they come from another setting."""


@dataclass
class Ledger:
    """Recorded counts.

    Attributes
    ----------
    setting : dict of str to str
        Conditions of the counts besides the sources.
    counts : dict of str to int
        Instructions by name of the call.
    reasons : dict of str to list of str
        One line for each time a count grew.
    """

    setting: dict[str, str] = field(default_factory=dict)
    counts: dict[str, int] = field(default_factory=dict)
    reasons: dict[str, list[str]] = field(default_factory=dict)

    @classmethod
    def read(cls, path: Path) -> Self:
        """Read a file."""
        ledger, name = cls(), ""
        for line in path.read_text(encoding="utf-8").splitlines():
            if line.startswith(" "):
                ledger.reasons.setdefault(name, []).append(line.strip())
            elif line and not line.startswith("#"):
                name, value = line.split("\t")
                if value.isdecimal():
                    ledger.counts[name] = int(value)
                else:
                    ledger.setting[name] = value
        return ledger

    def write(self, path: Path) -> None:
        """Write a file."""
        lines = [f"{key}\t{value}" for key, value in self.setting.items()]
        lines.append("")
        for name in NAMES:
            if name in self.counts:
                lines.append(f"{name}\t{self.counts[name]}")
                lines += [f"   {reason}" for reason in self.reasons.get(name, ())]
        path.write_text(_HEAD + "\n".join(lines) + "\n", encoding="utf-8")

    def differences(self, setting: Mapping[str, str], name: str) -> list[str]:
        """List the differences from the recorded setting that affect a call."""
        is_python = any(call.name == name and call.program == "python" for call in CALLS)
        return [
            f"{key}: counts are of '{self.setting[key]}', here is '{value}'"
            for key, value in setting.items()
            if key in self.setting and self.setting[key] != value
            if is_python or key != "python"
        ]

    def grown(self, counts: Mapping[str, int]) -> list[str]:
        """Say which calls have grown by more than the limit, or were never recorded."""
        lines = []
        for name, new in counts.items():
            old = self.counts.get(name)
            if old is None:
                lines.append(f"{name} has no recorded count: tools/counts --accept {name}")
            elif new > LIMIT * old:
                lines.append(
                    f"{name} has grown by {100 * (new / old - 1):.1f} %: from {old} to {new} "
                    f"instructions, ratio {new / old:.3f}. "
                    f"On purpose? tools/counts --accept {name} 'the reason'"
                )
        return lines

    def accept(self, measured: Mapping[str, int], setting: Mapping[str, str], reason: str) -> None:
        """Record counts in the place of older ones.

        A count that is the same but for noise stays, so that small growth cannot add up.
        """
        reason = " ".join(reason.split())
        kept = self.counts.keys() - measured.keys()
        others = {line for name in kept for line in self.differences(setting, name)}
        if others:
            raise RefusedError(
                "; ".join(sorted(others)) + ": renew all counts, tools/counts --accept all"
            )
        above = {
            name: f"{self.counts[name]} -> {new}"
            for name, new in measured.items()
            if name in self.counts and new > NOISE * self.counts[name]
        }
        if above and not reason:
            listed = "; ".join(f"{name} has grown, {change}" for name, change in above.items())
            raise RefusedError(f"{listed}: say why, tools/counts --accept NAME 'the reason'")
        for name, change in above.items():
            self.reasons.setdefault(name, []).append(f"{change}: {reason}")
        for name, new in measured.items():
            old = self.counts.get(name)
            if old is None or name in above or NOISE * new < old:
                self.counts[name] = new
        self.setting = dict(setting)
