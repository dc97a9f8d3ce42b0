"""The command `tools/counts`."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from instruction_counts.calls import NAMES
from instruction_counts.ledger import Ledger, OtherSettingError, ReasonMissingError, names_of
from instruction_counts.measure import Build, Measured, UnmeasurableError, measure

ROOT = Path(__file__).resolve().parents[2]
REFERENCE = ROOT / "tests" / "reference" / "instruction_counts.txt"


def main() -> int:
    """Count, and compare or record."""
    options = _read_options()
    names, reason = options.name, ""
    if options.accept:
        names, reason = options.accept[:1], " ".join(options.accept[1:])
    try:
        measured = measure(Build(ROOT), names_of(names))
    except KeyError as error:
        return _complain(f"no standard call is named {error}; there are: {', '.join(NAMES)}")
    except UnmeasurableError as error:
        return _complain(str(error))
    ledger = Ledger.read(REFERENCE)
    _tabulate(ledger, measured)
    if options.accept:
        return _accept(ledger, measured, reason)
    return _compare(ledger, measured)


def _read_options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="tools/counts",
        description="Instructions of the standard calls, beside the recorded ones.",
        epilog=f"Calls: {', '.join(NAMES)}.",
    )
    parser.add_argument("name", nargs="*", help="calls to count; all without any")
    parser.add_argument(
        "--accept",
        nargs="+",
        metavar=("NAME", "REASON"),
        help="record the present count of this call (or 'all'); growth needs a reason",
    )
    options = parser.parse_args()
    if options.accept and (options.name or len(options.accept) > 2):
        parser.error("--accept takes one name and one reason (in quotation marks)")
    return options


def _complain(text: str) -> int:
    print(f"counts: {text}", file=sys.stderr)
    return 2


def _tabulate(ledger: Ledger, measured: Measured) -> None:
    print(f"{'call':<20}{'recorded':>14}{'now':>14}{'ratio':>9}")
    for name, new in measured.counts.items():
        old = ledger.counts.get(name)
        ratio = f"{new / old:.4f}" if old else "-"
        print(f"{name:<20}{old or '-':>14}{new:>14}{ratio:>9}")


def _compare(ledger: Ledger, measured: Measured) -> int:
    lines = []
    for name, count in measured.counts.items():
        others = ledger.differences(measured.setting, name)
        # counts of another compiler are shown, not judged
        lines += others or ledger.grown({name: count})
    # one line for a setting that several calls share
    for line in dict.fromkeys(lines):
        print(line, file=sys.stderr)
    return 1 if lines else 0


def _accept(ledger: Ledger, measured: Measured, reason: str) -> int:
    try:
        ledger.accept(measured.counts, measured.setting, reason)
    except (ReasonMissingError, OtherSettingError) as error:
        return _complain(str(error))
    ledger.write(REFERENCE)
    print(f"recorded in {REFERENCE.relative_to(ROOT)}", file=sys.stderr)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
