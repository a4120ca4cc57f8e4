# shellcheck shell=bash
# Finds and installs missing packages of the system. deploy/quickstart.sh and tests/run.sh source this file.

# Prints the missing packages that a build of the program needs, one per line.
build_packages() {
  command -v cc >/dev/null || printf '%s\n' gcc libc6-dev
  local library
  for library in gmp mpfr mpc; do
    # The compiler repeats the name of a library that it does not find.
    case $(cc -print-file-name="lib$library.a" 2>/dev/null) in
      /*) ;;
      *) echo "lib$library-dev" ;;
    esac
  done
}

# install_packages PACKAGE...: installs by the system's package manager. Exit code 2: the manager is not supported here,
# or it fails.
install_packages() {
  if ! command -v apt-get >/dev/null; then
    echo "missing: $*. Install them with this system's package manager, then run this again." >&2
    return 2
  fi
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null; then
      echo "missing: $*. Install them as root, then run this again." >&2
      return 2
    fi
    as_root=(sudo)
  fi
  local install=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive
    apt-get install -y -qq --no-install-recommends "$@")
  # The package lists of a fresh machine may be empty or old.
  "${install[@]}" >/dev/null 2>&1 && return
  "${as_root[@]}" apt-get update -qq
  "${install[@]}" >/dev/null || return 2
}

# True if the installed GMP, MPFR and MPC are at least 6.2.1, 4.2 and 1.3, as `gmp-mpfr-sys` requires.
libraries_are_new_enough() {
  local versions
  versions=$(printf '%s\n' '#include <gmp.h>' '#include <mpfr.h>' '#include <mpc.h>' \
    'VERSIONS __GNU_MP_VERSION __GNU_MP_VERSION_MINOR __GNU_MP_VERSION_PATCHLEVEL' \
    'MPFR_VERSION_MAJOR MPFR_VERSION_MINOR MPC_VERSION_MAJOR MPC_VERSION_MINOR' |
    cc -E -P - 2>/dev/null | sed -n '/^VERSIONS/,$p' | tr '\n' ' ') || return 1
  # shellcheck disable=SC2086
  set -- $versions
  [ $# -eq 8 ] || return 1
  [ $((($2 * 100 + $3) * 100 + $4)) -ge 60201 ] && [ $(($5 * 100 + $6)) -ge 402 ] &&
    [ $(($7 * 100 + $8)) -ge 103 ]
}

# Installs the packages for a build. If the system's libraries are too old, the build compiles the sources in the crate
# `gmp-mpfr-sys` instead and takes a minute and a half longer.
prepare_build() {
  local missing
  mapfile -t missing < <(build_packages)
  if [ ${#missing[@]} -gt 0 ]; then
    echo "installing ${missing[*]}" >&2
    install_packages "${missing[@]}" || return
  fi
  if ! libraries_are_new_enough; then
    echo "GMP, MPFR and MPC of this system are too old: they are built from source" >&2
    export RUSTFLAGS="${RUSTFLAGS:-} --cfg bundled_libraries"
    missing=()
    command -v make >/dev/null || missing+=(make)
    command -v m4 >/dev/null || missing+=(m4)
    if [ ${#missing[@]} -gt 0 ]; then install_packages "${missing[@]}" || return; fi
  fi
}
