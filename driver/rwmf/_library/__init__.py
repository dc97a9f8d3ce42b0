"""Interface to the compiled kernel: buffers, handles, status numbers, Ctrl-C.

Text enters the kernel as UTF-8 bytes and leaves it in byte buffers. No other module imports the
extensions. `measure`, which needs the extension in quadruple precision, is imported on demand.
"""

from rwmf._library.kernel_case import (
    Changes,
    KernelCase,
    Samples,
    SceneAxis,
    keep_samples,
    read_case,
    read_host_case,
)
from rwmf._library.results import (
    Run,
    Spectrum,
    StaticCurve,
    check_threads,
    compute_curve,
    start_rows,
    start_simulation,
    start_spectrum,
)
from rwmf._library.tables import (
    FileChannel,
    KeyRow,
    digits_of,
    instruction_set,
    meant_quantity,
    needs_of_groups,
    number_of,
    quantities,
    read_record,
    read_record_header,
    result_names,
    schema,
    strip_under,
    unit_named,
    unusual_record,
    version,
)

__all__ = [
    "Changes",
    "FileChannel",
    "KernelCase",
    "KeyRow",
    "Run",
    "Samples",
    "SceneAxis",
    "Spectrum",
    "StaticCurve",
    "check_threads",
    "compute_curve",
    "digits_of",
    "instruction_set",
    "keep_samples",
    "meant_quantity",
    "needs_of_groups",
    "number_of",
    "quantities",
    "read_case",
    "read_host_case",
    "read_record",
    "read_record_header",
    "result_names",
    "schema",
    "start_rows",
    "start_simulation",
    "start_spectrum",
    "strip_under",
    "unit_named",
    "unusual_record",
    "version",
]
