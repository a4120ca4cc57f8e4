#!/usr/bin/env bash
# From a fresh Debian or Ubuntu machine with Rust to a solved problem: installs missing packages,
# builds, starts a coordinator and two workers, and solves Dietmaier's Stewart-Gough platform.
# A second run is safe and takes seconds. All started processes end with the script.
set -euo pipefail

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
problem=deploy/examples/stewart_gough_dietmaier.bertini
cd "$root"

say() { printf '\033[1m==>\033[0m %s\n' "$*" >&2; }
fail() { printf 'quickstart: %s\n' "$*" >&2; exit 3; }

# --- what the build needs: GMP, MPFR and MPC; a C compiler; Rust ----------------------------------
# shellcheck source=deploy/packages.sh
. deploy/packages.sh
prepare_build || fail "what the build needs is missing"
[ -x "$(command -v cargo)" ] || [ ! -x "$HOME/.cargo/bin/cargo" ] || PATH="$HOME/.cargo/bin:$PATH"
command -v cargo >/dev/null || fail "Rust is missing: see https://rustup.rs, then run this again"

say "building (minutes the first time, seconds after that)"
cargo build --release --quiet --package cognate-client --bin cognate
cognate=${CARGO_TARGET_DIR:-target}/release/cognate

# --- one coordinator, two workers, in a folder of their own ---------------------------------------
folder=$(mktemp -d)
started=()
clean_up() {
  trap - EXIT INT TERM
  for process in "${started[@]}"; do kill "$process" 2>/dev/null || true; done
  for process in "${started[@]}"; do wait "$process" 2>/dev/null || true; done
  rm -rf "$folder"
}
trap clean_up EXIT
trap 'exit 130' INT TERM

export COGNATE_COORDINATOR=unix:$folder/coordinator.sock
say "starting a coordinator and two workers"
"$cognate" coordinator --listen "$COGNATE_COORDINATOR" \
  --ledger "sqlite:$folder/ledger.db" --results "$folder/results" >"$folder/coordinator.log" 2>&1 &
started+=($!)
for n in 1 2; do
  "$cognate" worker >"$folder/worker-$n.log" 2>&1 &
  started+=($!)
done
ready=no
for _ in $(seq 100); do
  if "$cognate" workers >/dev/null 2>&1; then ready=yes; break; fi
  kill -0 "${started[0]}" 2>/dev/null || break
  sleep 0.1
done
if [ "$ready" = no ]; then
  cat "$folder/coordinator.log" >&2
  fail "the coordinator did not come up (its log is above)"
fi

# --- a real problem -------------------------------------------------------------------------------
say "solving $problem"
job=$("$cognate" submit "$problem")
code=0
"$cognate" watch "$job" || code=$?
if [ "$code" -gt 1 ]; then
  cat "$folder"/*.log >&2
  exit "$code"
fi
"$cognate" results "$job" || code=$?

cat <<END

Next:  $cognate solve FILE       solve your own system here
       $cognate --help           all commands
       deploy/README.md          a service on several machines
END
exit "$code"
