"""The command `tools/counts`."""

from __future__ import annotations

import argparse
import sys

from instruction_counts.calls import NAMES
from instruction_counts.ledger import Ledger, RefusedError
from instruction_counts.measure import ROOT, Measured, UnmeasurableError, measure

REFERENCE = ROOT / "tests" / "reference" / "instruction_counts.txt"


def main() -> int:
    """Count, and compare or record."""
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
    requested, *reason = options.accept or ["all" if not options.name else ""]
    names = options.name or (NAMES if requested == "all" else [requested])
    if unknown := set(names) - set(NAMES):
        parser.error(f"no standard call is named {min(unknown)}; there are: {', '.join(NAMES)}")
    ledger = Ledger.read(REFERENCE)
    try:
        measured = measure(names)
        _tabulate(ledger, measured)
        if not options.accept:
            return _compare(ledger, measured)
        ledger.accept(measured.counts, measured.setting, " ".join(reason))
    except (UnmeasurableError, RefusedError) as error:
        print(f"counts: {error}", file=sys.stderr)
        return 2
    ledger.write(REFERENCE)
    print(f"recorded in {REFERENCE.relative_to(ROOT)}", file=sys.stderr)
    return 0


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


if __name__ == "__main__":
    raise SystemExit(main())
