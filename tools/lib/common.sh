# What every tool shares: where things are, how they speak, and one lock a checkout.
# Sourced, with `set -euo pipefail` in force and `root` set by the caller.
# shellcheck shell=bash

cache="$root/.cache"
venv="$root/.venv"
python="$venv/bin/python"
sundials_version=6.4.1
sundials_prefix="${RWMF_SUNDIALS_PREFIX:-$cache/sundials-$sundials_version}"

# Progress goes to standard error: standard output belongs to `rwmf ... --json`.
say() { printf 'set-up: %s\n' "$*" >&2; }
die() { printf 'set-up: %s\n' "$*" >&2; exit 1; }

# Run a command whose output matters only when it fails.
quietly() {
   local log="$1"; shift
   if ! "$@" >"$log" 2>&1 </dev/null; then
      tail -n 60 "$log" >&2
      die "this failed: $* (complete output: $log)"
   fi
}

hash_of() { cat -- "$@" | sha256sum | cut -d' ' -f1; }

stamp_is() { [[ -f "$1" && "$(<"$1")" == "$2" ]]; }

# Two calls at once: the second waits, then finds everything done.
take_lock() {
   mkdir -p "$cache"
   exec 9>"$cache/lock"
   if ! flock --nonblock 9; then
      say "another call is setting up this checkout; waiting for it"
      flock 9
   fi
}
release_lock() { exec 9>&-; }
