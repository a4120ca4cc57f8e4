#!/usr/bin/env bash
# Fresh machine to green: installs what the tests need and runs them all.
#   tests/run.sh         everything: format, lints, mathematics, service, processes, Python, a stranger's client
#   tests/run.sh fast    the mathematics only, under a minute once built
# What cannot be run on this machine is counted at the end; with CI=true it is a failure.
# On Debian and Ubuntu missing packages are installed; elsewhere they are named. Rust must be there.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

mode=${1:-all}
case $mode in
  all | fast) ;;
  *)
    echo "usage: tests/run.sh [fast]" >&2
    exit 2
    ;;
esac

step() { printf '\n== %s\n' "$*"; }

# skipped WHAT: counted at the end, as the tests count theirs (tests/support/skip.rs).
skipped() {
  echo "skipped: $*"
  echo "$*" >>"$COGNATE_SKIPS"
  [ "${CI:-}" != true ]
}

# install PACKAGE...: by the system's package manager, if it is one that we know.
install() {
  if ! command -v apt-get >/dev/null; then
    echo "missing: $*. Install them with this system's package manager." >&2
    exit 2
  fi
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then as_root=(sudo); fi
  "${as_root[@]}" apt-get update -qq
  DEBIAN_FRONTEND=noninteractive "${as_root[@]}" apt-get install -y -qq --no-install-recommends "$@"
}

if ! command -v cargo >/dev/null && [ -x "$HOME/.cargo/bin/cargo" ]; then
  PATH=$HOME/.cargo/bin:$PATH
fi
if ! command -v cargo >/dev/null; then
  echo "missing: Rust 1.94 or newer with cargo (https://rustup.rs)" >&2
  exit 2
fi

# GMP, MPFR and MPC are built from source: a C compiler, make and m4.
missing=()
command -v cc >/dev/null || missing+=(gcc libc6-dev)
command -v make >/dev/null || missing+=(make)
command -v m4 >/dev/null || missing+=(m4)
if [ ${#missing[@]} -gt 0 ]; then
  step "installing ${missing[*]}"
  install "${missing[@]}"
fi

mathematics=(-p cognate-numeric -p cognate-systems -p cognate-continuation -p cognate-solutions
  -p cognate-algorithms)

if [ "$mode" = fast ]; then
  step "the mathematics"
  cargo test --release "${mathematics[@]}"
  exit
fi

step "format and lints"
cargo fmt --all --check
cargo clippy --release --workspace --all-targets -- -D warnings

step "libraries: licences, sources, known faults"
deny=target/deny/bin/cargo-deny
[ -x "$deny" ] || cargo install --quiet --debug --locked cargo-deny --version 0.20.2 --root target/deny
"$deny" --config deploy/deny.toml check licenses bans sources
if "$deny" --config deploy/deny.toml fetch db; then
  "$deny" --config deploy/deny.toml check advisories
else
  # Its database is not in a package registry, so that many machines cannot reach it; not a test of this project.
  echo "the database of known faults cannot be reached: not looked at"
fi

step "a stranger's client: Python packages into target/stranger"
if ! python3 -c 'import ensurepip, venv' 2>/dev/null; then
  install python3 python3-venv
fi
stranger=target/stranger
if ! cmp -s tests/stranger/requirements.txt "$stranger/requirements.txt"; then
  rm -rf "$stranger"
  python3 -m venv "$stranger"
  "$stranger/bin/python" -m pip install --quiet --disable-pip-version-check \
    --requirement tests/stranger/requirements.txt
  cp tests/stranger/requirements.txt "$stranger/"
fi
export COGNATE_STRANGER_PYTHON=$PWD/$stranger/bin/python

step "the Python package: what its tests use, into target/python"
python=target/python
if ! cmp -s tests/python/requirements.txt "$python/requirements.txt"; then
  rm -rf "$python"
  python3 -m venv "$python"
  "$python/bin/python" -m pip install --quiet --disable-pip-version-check \
    --requirement tests/python/requirements.txt
  cp tests/python/requirements.txt "$python/"
fi
# For its tests beside phcpy, which is PHCpack.
if ! command -v phc >/dev/null && command -v apt-get >/dev/null; then
  install phcpack || true
fi

# For the tests of the page.
if ! command -v chromium >/dev/null && command -v apt-get >/dev/null; then
  install chromium || true
fi

step "a PostgreSQL server for tests"
postgres=${TMPDIR:-/tmp}/cognate-pg-$$
COGNATE_SKIPS=$(mktemp)
export COGNATE_SKIPS
trap 'tests/support/postgres.sh stop "$postgres"; tests/support/s3.sh stop "${storage:-/nowhere}"; rm -f "$COGNATE_SKIPS"' EXIT
tests/support/postgres.sh start "$postgres" && started=0 || started=$?
if [ "$started" -eq 77 ] && command -v apt-get >/dev/null; then
  install postgresql
  tests/support/postgres.sh start "$postgres" && started=0 || started=$?
fi
case $started in
  0) export COGNATE_TEST_POSTGRES="host=$postgres&user=cognate" ;;
  77) skipped "the tests of the ledger on PostgreSQL, which is not installed" ;;
  *) exit 1 ;;
esac

step "a server of S3 for tests, into target/s3"
storage=${TMPDIR:-/tmp}/cognate-s3-$$
if tests/support/s3.sh install && tests/support/s3.sh start "$storage"; then
  set -a
  # shellcheck disable=SC1091
  . "$storage/environment"
  set +a
else
  skipped "the tests of results in a bucket: s3s-fs cannot be installed"
fi

step "building"
# Programs and libraries are those of deploy/quickstart.sh: same profile, same features (tests/benches/build.md).
cargo test --release --workspace --no-run
# The build above has made it; the tests need not ask cargo again.
built=$(realpath "${CARGO_TARGET_DIR:-target}")/release
export COGNATE_PROGRAM=$built/cognate
[ -x "$COGNATE_PROGRAM" ]

step "everything"
cargo test --release --workspace

step "the Python package, with the program that is built"
# Afresh: a wheel of the same version would be taken for installed.
"$python/bin/python" -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation \
  --force-reinstall ./deploy/python
"$python/bin/python" -m pytest -q tests/python

step "the gallery, at a small size, into target/gallery"
deploy/gallery/make.sh target/gallery --small

step "chaos: a minute and a half of random kills, on either ledger and with two coordinators"
# Built above with everything else; `cargo run` of one package would build half of it once more.
"$built/chaos" --seconds 30 --seed 1
"$built/chaos" --seconds 30 --seed 2 --ledger postgres
"$built/chaos" --seconds 30 --seed 3 --ledger postgres --coordinators 2

step "chaos: a minute with workers that do evil and results that are lost, and half a minute with results in S3"
"$built/chaos" --seconds 60 --seed 4 --katsura 12 --bits 53 --evil-workers yes --storage-faults yes
"$built/chaos" --seconds 30 --seed 6 --ledger postgres --coordinators 2 --results s3

step "partitions: ten workers join and leave in networks whose wires are cut"
"$built/partitions" --seconds 20

step "a large job: 160,000 made-up results through one coordinator"
"$built/large_job" --degree 20 --memory-mib 256

step "load: 60 small jobs by 6 clients beside one of 4096 paths"
"$built/load"

step "a fleet in Slurm"
if ! command -v slurmctld >/dev/null && command -v apt-get >/dev/null; then
  install slurmctld slurmd slurm-client munge || true
fi
tests/slurm/run.sh && fleet=0 || fleet=$?
case $fleet in
  0) ;;
  77) skipped "the fleet in Slurm: why is said above" ;;
  *) exit 1 ;;
esac

step "many solves: 10 seeds each on one warm coordinator"
"$built/many_solves" --solves 10

if [ -s "$COGNATE_SKIPS" ]; then
  step "skipped: $(wc -l <"$COGNATE_SKIPS")"
  sort "$COGNATE_SKIPS"
  [ "${CI:-}" != true ] || exit 1
fi
printf '\nall tests passed, %s skipped\n' "$(wc -l <"$COGNATE_SKIPS")"
