# The interpreters that wheels are made for.
# shellcheck shell=bash

# A CPython of that version with ensurepip, headers and the usual lock; prints where it is.
usable_python() {
   python_is_complete "$2" && "$2" - "$1" <<'PY' 2>/dev/null
import platform, sys, sysconfig
wanted = tuple(map(int, sys.argv[1].split(".")))
if (
    sys.version_info[:2] != wanted
    or platform.python_implementation() != "CPython"
    or sysconfig.get_config_var("Py_GIL_DISABLED")
):
    raise SystemExit(1)
print(sys.executable)
PY
}

# find_python VERSION: on PATH, of Debian, of pyenv, of uv. A name on PATH may be a shim that leads
# nowhere: each candidate is asked.
find_python() {
   local candidate pyenv="${PYENV_ROOT:-$HOME/.pyenv}"
   local uv="${UV_PYTHON_INSTALL_DIR:-${XDG_DATA_HOME:-$HOME/.local/share}/uv/python}"
   for candidate in "python$1" "/usr/bin/python$1" "$pyenv/versions/$1".*/"bin/python$1" \
      "$uv/cpython-$1".*/"bin/python$1"; do
      usable_python "$1" "$candidate" && return
   done
   return 1
}
