"""Extension made by f2py: its arguments are documented in the Fortran sources of the bindings."""

from typing import Any

rwmf_bindings_python_cases: Any
rwmf_bindings_python_cost: Any
rwmf_bindings_python_hosts: Any
rwmf_bindings_python_kernel: Any
rwmf_bindings_python_static_curve: Any
