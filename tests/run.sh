#!/usr/bin/env bash
# Fresh machine to green: installs what the tests need and runs them all.
#   tests/run.sh          everything: format, lints, mathematics, service, processes, Python, a stranger's client
#   tests/run.sh fast     the mathematics only
#   tests/run.sh CRATE    the tests of one crate: numeric, systems, continuation, ..., worker, coordinator, client, c
#   tests/run.sh long     everything, and the tests that are too long or too near a clock for every run
# What each costs, and how to look into a failure: tests/README.md.
# What cannot be run on this machine is counted at the end; with CI=true it is a failure.
# On Debian and Ubuntu missing packages are installed; elsewhere they are named. Rust must be there.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=deploy/packages.sh
. deploy/packages.sh

mode=${1:-all}
crates="numeric systems machine-code continuation solutions algorithms protocol kinematics mechanism-solver summary worker coordinator client c tests"
case " all fast long $crates " in
  *" $mode "*) ;;
  *)
    printf 'usage: tests/run.sh [fast|long|CRATE]\nCRATE is one of: %s\n' "$crates" >&2
    exit 2
    ;;
esac

begin=$SECONDS
step() { printf '\n== %s (%d s)\n' "$*" $((SECONDS - begin)); }

# skipped WHAT: counted at the end, as the tests count theirs (tests/support/skip.rs).
skipped() {
  echo "skipped: $*"
  echo "$*" >>"$COGNATE_SKIPS"
  [ "${CI:-}" != true ]
}

if ! command -v cargo >/dev/null && [ -x "$HOME/.cargo/bin/cargo" ]; then
  PATH=$HOME/.cargo/bin:$PATH
fi
if ! command -v cargo >/dev/null; then
  echo "missing: Rust 1.94 or newer with cargo (https://rustup.rs)" >&2
  exit 2
fi
prepare_build

case $mode in
  all | long) ;;
  fast)
    step "the mathematics"
    mathematics="numeric systems continuation solutions algorithms"
    nextest=target/tools/bin/cargo-nextest
    # These crates alone have other features of libraries than the workspace, so that nothing built with it would serve.
    if [ -x target/release/cognate ] && [ -x "$nextest" ]; then
      packages=$(printf ' + package(cognate-%s)' $mathematics)
      exec "$nextest" nextest run --release --workspace --lib --config-file tests/nextest.toml -E "${packages# + }"
    fi
    # shellcheck disable=SC2046
    exec cargo test --release --lib $(printf ' -p cognate-%s' $mathematics)
    ;;
  *)
    step "the crate $mode"
    exec cargo test --release -p "cognate-$mode"
    ;;
esac

# --- what the tests need ----------------------------------------------------------------------------
logs=target/logs
mkdir -p "$logs"

step "packages"
packages=()
python3 -c 'import ensurepip, venv' 2>/dev/null || packages+=(python3 python3-venv)
# For tests beside phcpy, which is PHCpack; of the page; of the ledger; of a fleet.
command -v phc >/dev/null || packages+=(phcpack)
command -v chromium >/dev/null || packages+=(chromium)
compgen -G '/usr/lib/postgresql/*/bin/initdb' >/dev/null || command -v initdb >/dev/null || packages+=(postgresql)
PATH=$PATH:/usr/sbin command -v slurmctld >/dev/null || packages+=(slurmctld slurmd slurm-client munge)
# For the guide's program in C++, which takes half a minute to compile.
if [ "$mode" = long ]; then
  command -v grpc_cpp_plugin >/dev/null || packages+=(pkg-config libgrpc++-dev libprotobuf-dev protobuf-compiler-grpc)
fi
if [ ${#packages[@]} -gt 0 ]; then
  # One by one where not all are to be had: what is missing then skips its tests by name.
  install_packages "${packages[@]}" || for package in "${packages[@]}"; do install_packages "$package" || true; done
fi

# environment NAME REQUIREMENTS: a Python environment target/NAME with these packages.
environment() {
  local folder=target/$1 requirements=$2
  cmp -s "$requirements" "$folder/requirements.txt" && return
  rm -rf "$folder"
  python3 -m venv "$folder"
  "$folder/bin/python" -m pip install --quiet --disable-pip-version-check --requirement "$requirements"
  cp "$requirements" "$folder/requirements.txt"
}
# Packages are fetched while the programs are built.
{
  environment stranger tests/stranger/requirements.txt
  environment python tests/python/requirements.txt
  environment guide deploy/guide/requirements.txt
  environment tools tests/support/tools.txt
} >"$logs/environments" 2>&1 &
environments=$!

step "building"
# Programs and libraries are those of deploy/quickstart.sh: same profile, same features (tests/benches/build.md).
cargo test --quiet --release --workspace --no-run
# The build above has made it; the tests need not ask cargo again.
built=$(realpath "${CARGO_TARGET_DIR:-target}")/release
export COGNATE_PROGRAM=$built/cognate
[ -x "$COGNATE_PROGRAM" ]

step "format and lints"
cargo fmt --all --check
cargo clippy --quiet --release --workspace --all-targets -- -D warnings

wait "$environments" || { cat "$logs/environments" >&2; exit 1; }
export COGNATE_STRANGER_PYTHON=$PWD/target/stranger/bin/python
python=$PWD/target/python/bin/python

step "libraries: licences, sources, known faults"
deny=(target/tools/bin/cargo-deny --config deploy/deny.toml)
"${deny[@]}" check licenses bans sources
if "${deny[@]}" fetch db; then
  "${deny[@]}" check advisories
else
  # Its database is not in a package registry, so that many machines cannot reach it; not a test of this project.
  echo "the database of known faults cannot be reached: not looked at"
fi

step "servers for tests: PostgreSQL and S3"
postgres=${TMPDIR:-/tmp}/cognate-pg-$$
storage=${TMPDIR:-/tmp}/cognate-s3-$$
COGNATE_SKIPS=$(mktemp)
export COGNATE_SKIPS
trap 'tests/support/postgres.sh stop "$postgres"; tests/support/s3.sh stop "$storage"; rm -f "$COGNATE_SKIPS"' EXIT
tests/support/postgres.sh start "$postgres" && started=0 || started=$?
case $started in
  0) export COGNATE_TEST_POSTGRES="host=$postgres&user=cognate" ;;
  77) skipped "the tests of the ledger on PostgreSQL, which is not installed" ;;
  *) exit 1 ;;
esac
if tests/support/s3.sh install && tests/support/s3.sh start "$storage"; then
  set -a
  # shellcheck disable=SC1091
  . "$storage/environment"
  set +a
else
  skipped "the tests of results in a bucket: s3s-fs cannot be installed"
fi

step "the tests of the workspace"
if [ "$mode" = long ]; then export COGNATE_LONG=yes; fi
# One more at a time than there are cores: some wait for leases, servers and processes.
target/tools/bin/cargo-nextest nextest run --release --workspace --config-file tests/nextest.toml \
  --test-threads $(($(nproc) + 1))
cargo test --quiet --release --workspace --doc

step "the Python package, with the program that is built"
# Afresh: a wheel of the same version would be taken for installed.
"$python" -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation \
  --force-reinstall ./deploy/python

# --- the rest in two lanes: one computes, the other mostly waits ------------------------------------
lane_computes() {
  set -e
  step "the Python package"
  "$python" -m pytest -q tests/python
  step "the gallery, at a small size, into target/gallery"
  deploy/gallery/make.sh target/gallery --small
  step "many solves: 10 seeds each on one warm coordinator"
  "$built/many_solves" --solves 10
}

lane_waits() {
  set -e
  step "chaos: a minute and a half of random kills, on either ledger and with two coordinators"
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
  tests/slurm/run.sh && fleet=0 || fleet=$?
  case $fleet in
    0) ;;
    77) skipped "the fleet in Slurm: why is said above" ;;
    *) return 1 ;;
  esac
}

step "two lanes: Python, gallery and many solves; chaos, partitions, load and a fleet"
# In the background, since bash ignores `set -e` in what stands before `&&`.
(lane_waits) >"$logs/waits" 2>&1 &
waits=$!
(lane_computes) >"$logs/computes" 2>&1 &
computes=$!
wait "$computes" && computed=0 || computed=$?
cat "$logs/computes"
wait "$waits" && waited=0 || waited=$?
cat "$logs/waits"
if [ "$computed" -ne 0 ] || [ "$waited" -ne 0 ]; then
  echo "a lane failed: its output is above" >&2
  exit 1
fi

if [ "$mode" = long ]; then
  step "the release: built, and tried in bare roots"
  tests/release/run.sh && released=0 || released=$?
  case $released in
    0) ;;
    77) skipped "the release: why is said above" ;;
    *) exit 1 ;;
  esac
fi

if [ -s "$COGNATE_SKIPS" ]; then
  step "skipped: $(wc -l <"$COGNATE_SKIPS")"
  sort "$COGNATE_SKIPS"
  [ "${CI:-}" != true ] || exit 1
fi
printf '\nall tests passed, %s skipped, %d s\n' "$(wc -l <"$COGNATE_SKIPS")" $((SECONDS - begin))
