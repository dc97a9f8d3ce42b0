"""Extension made by f2py: src/bindings/python documents its arguments."""

from typing import Any

rwmf_bindings_python_cases: Any
rwmf_bindings_python_cost: Any
rwmf_bindings_python_hosts: Any
rwmf_bindings_python_kernel: Any
rwmf_bindings_python_static_curve: Any
