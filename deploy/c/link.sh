#!/usr/bin/env bash
# Makes the shared library of the archive that cargo builds, with the functions of cognate.h and the system's GMP, MPFR, MPC:
#   cargo build --release -p cognate-c && deploy/c/link.sh target/release/libcognate.a OUT
set -euo pipefail
if [ $# -ne 2 ] || [ ! -f "$1" ]; then
  echo "usage: link.sh target/release/libcognate.a OUT" >&2
  exit 2
fi
archive=$1
out=$2
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
mkdir -p "$out"
mapfile -t functions < <(sed -n 's/^[a-z].*[ *]\(cognate_[a-z_]*\)(.*/-Wl,-u,\1/p' "$here/cognate.h")
"${CC:-cc}" -shared -o "$out/libcognate.so" -Wl,-soname,libcognate.so "${functions[@]}" \
  -Wl,--version-script="$here/exports" -Wl,--gc-sections -Wl,--strip-all \
  "$archive" -lmpc -lmpfr -lgmp -lgcc_s -lm -lpthread -ldl
cp "$here/cognate.h" "$out"
