#!/bin/sh
# Arms of known dimensions by cognate and by what pip installs, in one run: writes the table of ../mechanisms.md to
# standard output. The other programs are installed below target/ once.
set -eu
root=$(cd "$(dirname "$0")/../../.." && pwd)
peers=$root/target/mechanism_peers
program=${COGNATE:-$root/target/release/cognate}
if [ ! -x "$peers/bin/python" ]; then
    python3 -m venv "$peers"
fi
for package in numpy scipy EAIK ikdh ssik ikpy pin roboticstoolbox-python; do
    "$peers/bin/pip" install --quiet "$package" || echo "$package cannot be installed here" >&2
done
exec "$peers/bin/python" "$root/tests/benches/mechanisms/compare.py" "$program" "$root/tests/mechanisms" "$@"
