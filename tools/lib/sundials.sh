# SUNDIALS from Debian's source package, built once into the cache of this checkout.
# shellcheck shell=bash
#
# Why not the binary package: it pulls in MPI, PETSc and hypre (about 1 GB) and is compiled without
# optimisation, three times slower at the same results. This file is the recipe: changing it, or
# the compiler, rebuilds.

sundials_key() { { gfortran -dumpfullversion; cat "$root/tools/lib/sundials.sh"; } | sha256sum; }

sundials_is_ready() {
   [[ -z "${RWMF_SUNDIALS_PREFIX:-}" ]] || return 0
   command -v gfortran >/dev/null && stamp_is "$sundials_prefix/recipe" "$(sundials_key)"
}

fetch_sundials() {
   local work="$1"
   prepare_apt
   say "fetching the source of SUNDIALS $sundials_version from Debian"
   (cd "$work" && quietly "$cache/sundials-fetch.log" apt-get "${apt_options[@]}" \
      -o APT::Sandbox::User="$(id -un)" source --only-source --download-only sundials)
   local description
   description="$(cd "$work" && ls sundials_"$sundials_version"*.dsc 2>/dev/null)" || true
   [[ -n "$description" ]] || die "Debian's source here is not SUNDIALS $sundials_version; \
give another installation with RWMF_SUNDIALS_PREFIX=..."
   quietly "$cache/sundials-unpack.log" dpkg-source -x "$work/$description" "$work/source"
}

configure_sundials() {
   local work="$1"
   # No contraction to fused multiply-add: the same bits on every processor of an architecture.
   quietly "$cache/sundials-configure.log" cmake -S "$work/source" -B "$work/build" \
      -DCMAKE_INSTALL_PREFIX="$work/install" -DCMAKE_INSTALL_LIBDIR=lib \
      -DCMAKE_BUILD_TYPE=Release -DCMAKE_POSITION_INDEPENDENT_CODE=ON \
      -DCMAKE_C_FLAGS=-ffp-contract=off -DCMAKE_Fortran_FLAGS=-ffp-contract=off \
      -DBUILD_SHARED_LIBS=OFF -DBUILD_STATIC_LIBS=ON -DBUILD_FORTRAN_MODULE_INTERFACE=ON \
      -DBUILD_CVODE=ON -DBUILD_ARKODE=OFF -DBUILD_CVODES=OFF -DBUILD_IDA=OFF -DBUILD_IDAS=OFF \
      -DBUILD_KINSOL=OFF -DENABLE_LAPACK=ON -DENABLE_MPI=OFF -DENABLE_OPENMP=OFF \
      -DEXAMPLES_ENABLE_C=OFF -DEXAMPLES_ENABLE_CXX=OFF -DEXAMPLES_ENABLE_F2003=OFF \
      -DEXAMPLES_INSTALL=OFF
}

install_sundials() {
   sundials_is_ready && return 0
   local work
   work="$(mktemp --directory --tmpdir="$cache")"
   fetch_sundials "$work"
   say "building SUNDIALS $sundials_version (CVODE) once, into .cache"
   configure_sundials "$work"
   quietly "$cache/sundials-build.log" cmake --build "$work/build" --parallel "$(nproc)"
   quietly "$cache/sundials-install.log" cmake --install "$work/build"
   sundials_key >"$work/install/recipe"
   # The rename comes last: a prefix that exists is complete.
   rm -rf "$sundials_prefix"
   mv "$work/install" "$sundials_prefix"
   rm -rf "$work"
}
