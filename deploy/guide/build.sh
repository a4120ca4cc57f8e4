#!/usr/bin/env bash
# Builds the guide's site from this folder into the folder OUT: pages, search and the Python reference.
#   deploy/guide/build.sh OUT
# The first run installs the packages of requirements.txt below target/guide. The reference of commands is the program's
# help text: COGNATE_PROGRAM, target/release/cognate, or on the PATH. The site loads nothing from a network.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
root=$(cd "$here/../.." && pwd)
if [ $# -ne 1 ]; then
  echo "usage: deploy/guide/build.sh OUT" >&2
  exit 2
fi
mkdir -p "$1"
out=$(cd "$1" && pwd)

if [ -z "${COGNATE_PROGRAM:-}" ]; then
  built=$root/target/release/cognate
  if [ -x "$built" ]; then COGNATE_PROGRAM=$built; else COGNATE_PROGRAM=$(command -v cognate || true); fi
fi
if [ ! -x "$COGNATE_PROGRAM" ]; then
  echo "guide: the program is missing: set COGNATE_PROGRAM, or build it with deploy/quickstart.sh" >&2
  exit 2
fi
export COGNATE_PROGRAM

# The same environment as `environment guide` of tests/run.sh.
environment=$root/target/guide
if ! cmp -s "$here/requirements.txt" "$environment/requirements.txt"; then
  rm -rf "$environment"
  python3 -m venv "$environment"
  "$environment/bin/python" -m pip install --quiet --disable-pip-version-check --requirement "$here/requirements.txt"
  cp "$here/requirements.txt" "$environment/requirements.txt"
fi

# Hides the theme's notice about its own future.
export NO_MKDOCS_2_WARNING=1
# Builds into another folder than OUT, because mkdocs empties its target folder.
"$environment/bin/python" -m mkdocs build --quiet --strict --clean --config-file "$here/mkdocs.yml" \
  --site-dir "$environment/site"
cp -R "$environment/site/." "$out"
echo "$out/index.html"
