#!/usr/bin/env bash
# All linkages through nine points, without known solutions: 143,360 paths on a coordinator and two workers.
#
#   deploy/families/from_scratch.sh FOLDER [SEED [KILLS]]
#
# FOLDER keeps the ledger, the results and the job's number. After a stop or kill at any moment, the same
# command continues from there. KILLS (default 0): number of random moments at which the coordinator or a
# worker is killed with -9 and started again. At the end FOLDER/answer has everything. The script compares
# its solutions one by one with the set that monodromy found, and prints the digest of the file.
set -euo pipefail

folder=${1:?a folder is expected: from_scratch.sh FOLDER [SEED [KILLS]]}
seed=${2:-1}
kills=${3:-0}
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
. "$root/deploy/families/program.sh"
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
export COGNATE_COORDINATOR=unix:$folder/coordinator.sock
say() { printf '%s %s\n' "$(date +%T)" "$*"; }

# The three processes, by number: 0 the coordinator, 1 and 2 the workers.
started=()
start() {
  if [ "$1" -eq 0 ]; then
    "$cognate" coordinator --listen "$COGNATE_COORDINATOR" --ledger "sqlite:$folder/ledger.db" \
      --results "$folder/results" >>"$folder/coordinator.log" 2>&1 &
  else
    "$cognate" worker --threads 1 >>"$folder/worker-$1.log" 2>&1 &
  fi
  started[$1]=$!
}
stop_all() {
  trap - EXIT INT TERM
  for process in "${started[@]}"; do kill "$process" 2>/dev/null || true; done
  wait
}
trap stop_all EXIT
trap 'exit 130' INT TERM
for process in 0 1 2; do start $process; done
until "$cognate" jobs >/dev/null 2>&1; do sleep 0.2; done

if [ ! -s "$folder/job" ]; then
  "$cognate" submit "$root/deploy/examples/nine_point_groups.json" --start multihomogeneous \
    --seed "$seed" --target-parameters "$root/deploy/families/nine_point/parameters.json" \
    >"$folder/job.new"
  mv "$folder/job.new" "$folder/job"
fi
job=$(cat "$folder/job")
say "job $job"

RANDOM=$seed
"$cognate" watch "$job" >"$folder/watch.log" 2>&1 &
watch=$!
began=$SECONDS
for ((n = 1; n <= kills; n++)); do
  sleep $((2 + RANDOM % 9))
  kill -0 "$watch" 2>/dev/null || break
  process=$((RANDOM % 3))
  kill -9 "${started[$process]}" 2>/dev/null || true
  wait "${started[$process]}" 2>/dev/null || true
  say "kill $n: $([ $process -eq 0 ] && echo the coordinator || echo "worker $process")"
  start $process
done
while kill -0 "$watch" 2>/dev/null; do sleep 0.5; done
say "ended after $((SECONDS - began)) s of this call"

until "$cognate" jobs >/dev/null 2>&1; do sleep 0.2; done
"$cognate" results "$job" --output "$folder/answer" || true
"$cognate" explain "$job"
"$root/deploy/families/compare.py" "$root/deploy/families/nine_point/solutions.points" \
  x,X,a,A,y,Y,b,B "$folder/answer/solutions.jsonl"
sha256sum "$folder/answer/solutions.jsonl" | sed "s|$folder/||"
