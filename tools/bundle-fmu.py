#!/usr/bin/env python3
"""Make the part of an FMU that all cases share: binaries of one platform and licences, in a zip.

The shared library takes LAPACK, SUNDIALS and the kernel in. The runtime libraries of gfortran are
beside it, because their static versions are not position-independent; it finds them there.
"""

import re
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

# Libraries that every Linux has; all others go into the FMU.
SYSTEM = re.compile(r"(ld-linux|linux-vdso|libc\.|libm\.|libdl\.|libpthread\.|libgcc_s\.)")
NAME = "rwmf.so"
FMI_ONLY = "{ global: fmi3*; local: *; };\n"


def link(library: Path, parts: list[str], linker: list[str]) -> None:
    """Link the functions of FMI with their part of the kernel and of the other archives."""
    symbols = library.with_suffix(".map")
    symbols.write_text(FMI_ONLY, encoding="ascii")
    fmi, *archives = parts
    static = [found for name in ("lapack", "blas") if (found := static_library(name, linker))]
    shared = [] if len(static) == 2 else ["-llapack", "-lblas"]
    command = [*linker, "-shared", "-s", "-o", str(library), f"-Wl,--version-script={symbols}"]
    command += ["-Wl,--as-needed", "-Wl,--gc-sections", "-Wl,-z,defs", "-Wl,-rpath,$ORIGIN"]
    # an rpath that also holds for the libraries of the library
    command += ["-Wl,--disable-new-dtags", "-Wl,--whole-archive", fmi, "-Wl,--no-whole-archive"]
    command += ["-Wl,--start-group", *archives, *static, *shared, "-Wl,--end-group", "-fopenmp"]
    subprocess.run(command, check=True)


def static_library(name: str, linker: list[str]) -> str:
    """Find a static library."""
    command = [*linker, f"-print-file-name=lib{name}.a"]
    found = subprocess.run(command, check=True, capture_output=True, text=True).stdout.strip()
    return found if "/" in found else ""


def runtime_libraries(library: Path) -> list[Path]:
    """List the libraries that a shared library needs and that not every Linux has."""
    command = ["ldd", str(library)]
    lines = subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines()
    found = [line.split() for line in lines if not SYSTEM.match(Path(line.split()[0]).name)]
    missing = [words[0] for words in found if words[2:3] == ["not"] or len(words) < 3]
    if missing:
        raise SystemExit(f"bundle-fmu: not found: {', '.join(missing)}")
    return [Path(words[2]) for words in found]


def main() -> None:
    """Make ``OUTPUT PLATFORM LICENSES LICENSE FMI KERNEL [ARCHIVE ...] -- LINKER ...``."""
    arguments = sys.argv[1:]
    at = arguments.index("--")
    output, platform, licenses, own, *parts = arguments[:at]
    with tempfile.TemporaryDirectory() as folder:
        library = Path(folder) / NAME
        link(library, parts, arguments[at + 1 :])
        files = {f"binaries/{platform}/{NAME}": library}
        for path in runtime_libraries(library):
            files[f"binaries/{platform}/{path.name}"] = path
        files["documentation/licenses/license.txt"] = Path(own)
        for path in sorted(Path(licenses).glob("*.txt")):
            # uPlot is part of the explorer alone
            if path.stem != "uPlot":
                files[f"documentation/licenses/{path.name}"] = path
        with zipfile.ZipFile(output, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, path in files.items():
                entry = zipfile.ZipInfo(name)
                entry.external_attr = 0o644 << 16
                archive.writestr(entry, path.read_bytes(), zipfile.ZIP_DEFLATED)


if __name__ == "__main__":
    main()
