# The virtual environment: exactly the files of tools/requirements.lock, by the machine's own pip
# configuration. A file with another hash is refused.
# shellcheck shell=bash

venv_key() { hash_of "$root/tools/requirements.lock" "$root/tools/lib/venv.sh"; }

# Complete, and made for this folder: a virtual environment does not survive a move.
venv_is_sound() {
   grep -qsF -- "$venv" "$venv/pyvenv.cfg" && "$python" -c 'import pip' 2>/dev/null
}

install_venv() {
   local key interpreter
   key="$(venv_key)"
   if grep -qsF -- "$venv" "$venv/pyvenv.cfg" &&
      stamp_is "$venv/requirements.stamp" "$key"; then return 0; fi
   if ! venv_is_sound; then
      interpreter="$(base_python)" || die "no Python >= 3.11 with ensurepip and headers found"
      say "creating the virtual environment .venv"
      rm -rf "$venv"
      quietly "$cache/venv.log" "$interpreter" -m venv "$venv"
   fi
   say "installing the Python packages of tools/requirements.lock into .venv"
   quietly "$cache/pip.log" "$python" -m pip install --disable-pip-version-check \
      --no-deps --require-hashes --requirement "$root/tools/requirements.lock"
   link_package
   printf '%s\n' "$key" >"$venv/requirements.stamp"
}

# The package is used from its folder: no install step between an edit and a run. The extension is
# linked into that folder by build.sh. The package `reproduce` of the folder plots is for tests and
# measurements.
link_package() {
   local site
   site="$("$python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')"
   printf '%s\n' "$root/driver" "$root/plots" >"$site/rwmf-checkout.pth"
   printf '#!%s\nfrom rwmf.__main__ import main\n\nraise SystemExit(main())\n' "$python" \
      >"$venv/bin/rwmf"
   chmod 755 "$venv/bin/rwmf"
}
