# What tools/docs needs beside the rest, and tools/test for its tests of the site.
# shellcheck shell=bash

# Sphinx, its theme and FORD, on top of the packages of tools/requirements.lock.
install_docs() {
   local key package missing=()
   for package in libjs-bootstrap5 libjs-lunr; do
      [[ -d "/usr/share/javascript/${package#libjs-}" ]] || missing+=("$package")
   done
   [[ -d /usr/share/doc/fonts-texgyre-math ]] || missing+=(fonts-texgyre-math)
   if [[ ${#missing[@]} -gt 0 ]]; then
      may_install || die "missing: ${missing[*]}. Neither root nor sudo without password here"
      (trap drop_apt EXIT; install_packages "${missing[@]}")
   fi
   key="$(venv_key) $(hash_of "$root/tools/docs.lock")"
   stamp_is "$venv/docs.stamp" "$key" && return 0
   say "installing the packages of tools/docs.lock into .venv"
   quietly "$cache/pip-docs.log" "$python" -m pip install --disable-pip-version-check \
      --no-deps --require-hashes --requirement "$root/tools/docs.lock"
   printf '%s\n' "$key" >"$venv/docs.stamp"
}
