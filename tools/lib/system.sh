# What the operating system has to bring: compilers, LAPACK, CMake, Python.
# shellcheck shell=bash
#
# LAPACK is the reference implementation and not OpenBLAS: the matrices have as many rows as a frame
# has storeys, so speed is not at stake, while OpenBLAS chooses its kernels by processor (other last
# digits on another machine) and brings further threads into our OpenMP loop.

has_library() { [[ "$(gcc -print-file-name="$1" 2>/dev/null)" == /* ]]; }

# New enough, and with ensurepip and headers (f2py), which Debian splits from the interpreter.
python_is_complete() {
   "$1" - <<'PY' 2>/dev/null
import ensurepip, pathlib, sys, sysconfig
headers = pathlib.Path(sysconfig.get_path("include"), "Python.h")
raise SystemExit(sys.version_info < (3, 11) or not headers.is_file())
PY
}

# The interpreter for the virtual environment: the user's, or Debian's own.
base_python() {
   local candidate
   for candidate in "${RWMF_PYTHON:-python3}" /usr/bin/python3; do
      if python_is_complete "$candidate"; then
         command -v "$candidate"
         return
      fi
   done
   return 1
}

missing_packages() {
   command -v gcc >/dev/null || echo gcc libc6-dev
   command -v gfortran >/dev/null || echo gfortran
   has_library liblapack.so || echo liblapack-dev
   has_library libblas.so || echo libblas-dev
   command -v pkg-config >/dev/null || echo pkg-config
   [[ -x "$python" ]] || base_python >/dev/null || echo python3-venv python3-dev
   if ! sundials_is_ready; then
      command -v cmake >/dev/null || echo cmake
      command -v make >/dev/null || echo make
      command -v dpkg-source >/dev/null || echo dpkg-dev
   fi
}

# An apt that sees Debian's own suites with their sources and nothing else: a broken third-party
# entry cannot stop the set-up, and the machine's own configuration and lists stay as they are.
prepare_apt() {
   [[ -z "${apt_dir:-}" ]] || return 0
   command -v apt-get >/dev/null || die "this is no Debian system (no apt-get); install by hand: \
gfortran, LAPACK, BLAS, Python >= 3.11 with headers, and SUNDIALS (then RWMF_SUNDIALS_PREFIX=...)"
   apt_dir="$(mktemp -d)"
   chmod 755 "$apt_dir"
   mkdir -p "$apt_dir/lists/partial" "$apt_dir/cache/archives/partial"
   awk -f "$root/tools/lib/debian_sources.awk" \
      -v suites="$(. /etc/os-release && echo "${VERSION_CODENAME:-stable}")" \
      $(ls /etc/apt/sources.list /etc/apt/sources.list.d/*.list \
           /etc/apt/sources.list.d/*.sources 2>/dev/null) >"$apt_dir/sources.list"
   [[ -s "$apt_dir/sources.list" ]] || die "no Debian suite among the machine's apt sources"
   apt_options=(-qq -o "Dir::Etc::sourcelist=$apt_dir/sources.list" -o Dir::Etc::sourceparts=-
      -o "Dir::State::Lists=$apt_dir/lists" -o "Dir::Cache=$apt_dir/cache"
      -o Dpkg::Use-Pty=0 -o Acquire::Retries=3)
   say "reading Debian's package lists"
   quietly "$cache/apt-update.log" apt-get "${apt_options[@]}" update
}

# Forgets the directory too: a later installation prepares its own.
drop_apt() {
   [[ -z "${apt_dir:-}" ]] || rm -rf "$apt_dir"
   apt_dir=
}

as_root() {
   if [[ "$(id -u)" == 0 ]]; then
      env DEBIAN_FRONTEND=noninteractive "$@"
   else
      sudo -n env DEBIAN_FRONTEND=noninteractive "$@"
   fi
}

may_install() { [[ "$(id -u)" == 0 ]] || sudo -n true 2>/dev/null; }

install_packages() {
   prepare_apt
   say "installing Debian packages: $*"
   quietly "$cache/apt-install.log" as_root apt-get "${apt_options[@]}" install --yes \
      --no-install-recommends "$@"
}

install_system_packages() {
   local packages
   mapfile -t packages < <(missing_packages | tr ' ' '\n')
   [[ ${#packages[@]} -gt 0 ]] || return 0
   may_install || die "missing: ${packages[*]}. Neither root nor sudo without password here; ask for:
   apt-get install ${packages[*]}"
   install_packages "${packages[@]}"
}

# What only tests use: they are skipped without it, so that its lack stops nothing. A browser of a
# quarter of a gigabyte is installed only where no test may be skipped.
install_test_packages() {
   local package missing=()
   for package in valgrind strace; do
      command -v "$package" >/dev/null || missing+=("$package")
   done
   if ! command -v chromium-headless-shell >/dev/null; then
      if [[ "${RWMF_MUST_RUN:-}" == 1 ]]; then
         missing+=(chromium-headless-shell)
      else
         say 'no chromium-headless-shell: tests in a browser are skipped (RWMF_MUST_RUN=1 installs it)'
      fi
   fi
   [[ ${#missing[@]} -gt 0 ]] || return 0
   if may_install && command -v apt-get >/dev/null &&
      (trap drop_apt EXIT; install_packages "${missing[@]}"); then return 0; fi
   say "no ${missing[*]}: tests that need it are skipped"
}
