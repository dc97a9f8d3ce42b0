#!/usr/bin/env bash
# What the kernel costs beyond CVODE itself: builds bench/bare_cvode.f90 and runs it.
set -euo pipefail
root="$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)"
"$root/tools/run" --version >&2
"$root/.venv/bin/meson" compile -C "$root/build" bare_cvode >&2
exec "$root/build/bench/bare_cvode" "$root/bench/bare_cvode.nml"
