#!/usr/bin/env python3
"""Join source files, so that the compiler can put their procedures into each other."""

import argparse
import re
from pathlib import Path

MODULE = re.compile(r"^module (\w+)$", re.MULTILINE)


def main() -> None:
    """Write the files one after the other; messages of the compiler still name them.

    A file that is compiled once more, for more lanes or other instructions, gives its modules
    names with a suffix.
    """
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("target", type=Path, help="the file to be written")
    parser.add_argument("sources", nargs="+", type=Path, help="in the order of their use")
    parser.add_argument("--suffix", default="", help="of the names of the modules")
    parser.add_argument("--define", default="", help="a macro and its value, NAME=VALUE")
    options = parser.parse_args()
    parts = [f"#define {options.define.replace('=', ' ')}\n"] if options.define else []
    parts += [f'# 1 "{name}"\n{name.read_text(encoding="utf-8")}\n' for name in options.sources]
    text = "".join(parts)
    for module in MODULE.findall(text) if options.suffix else []:
        text = re.sub(rf"\b{module}\b", module + options.suffix, text)
    # sources may be newer without another text, and these units are slow to compile
    if not options.target.exists() or options.target.read_text(encoding="utf-8") != text:
        options.target.write_text(text, encoding="utf-8")
        # the compiler appends to its report on the loops of this text
        options.target.with_suffix(".vec").unlink(missing_ok=True)


if __name__ == "__main__":
    main()
