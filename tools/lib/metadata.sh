# What pip knows of the package of this checkout.
# shellcheck shell=bash

# Version and optional dependencies: `pip install 'rwmf[suites]'` adds those of a purpose.
describe_package() {
   local site key
   key="$(hash_of "$root/pyproject.toml" "$root/meson.build" "$root/tools/checkout-metadata.py") \
$(venv_key)"
   stamp_is "$venv/metadata.stamp" "$key" && return 0
   site="$("$python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')"
   "$python" "$root/tools/checkout-metadata.py" "$site"
   printf '%s\n' "$key" >"$venv/metadata.stamp"
}
