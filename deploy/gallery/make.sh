#!/usr/bin/env bash
# The gallery: results of this repository's examples, as pages with picture, command, count and source.
#   deploy/gallery/make.sh OUT            all entries; takes some minutes
#   deploy/gallery/make.sh OUT --small    entries of a second each, as tests/run.sh makes them
#   deploy/gallery/make.sh OUT NAME...    only these entries
# The program is COGNATE_PROGRAM, target/release/cognate, or on the PATH. Exit code 1: a count is not as expected.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
if [ -z "${COGNATE_PROGRAM:-}" ]; then
  built=$here/../../target/release/cognate
  if [ -x "$built" ]; then COGNATE_PROGRAM=$built; else COGNATE_PROGRAM=$(command -v cognate); fi
fi
export COGNATE_PROGRAM
exec python3 "$here/make.py" "$@"
