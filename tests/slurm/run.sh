#!/usr/bin/env bash
# `cognate fleet slurm` in a real Slurm of two nodes on this machine: workers come by the backlog, one of
# them is requeued and one killed, the answer is what it must be, and all leave when there is nothing to do.
#   COGNATE_PROGRAM=target/release/cognate tests/slurm/run.sh
# Exit code 77, with the reason: Slurm cannot be had here (Debian's slurmctld, slurmd, slurm-client, munge).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
program=$(realpath "${COGNATE_PROGRAM:-target/release/cognate}")
PATH=$PATH:/usr/sbin

skip() {
  echo "skipped: the fleet in Slurm: $*" >&2
  exit 77
}
for command in slurmctld slurmd squeue sbatch munged; do
  command -v "$command" >/dev/null || skip "$command is not installed"
done
[ "$(id -u)" -eq 0 ] || skip "slurmd runs jobs of other users only as root"

place=$(mktemp -d "${TMPDIR:-/tmp}/cognate-slurm-XXXXXX")
chmod 755 "$place"
pids=()
finish() {
  local code=$?
  if [ "$code" -ne 0 ]; then
    for log in "$place"/*.log; do
      echo "---- $log" >&2
      tail -n 25 "$log" >&2
    done
  fi
  scancel --me 2>/dev/null || true
  # The last that were started first; jobs are children of slurmd's steppers, which end with scancel.
  for ((k = ${#pids[@]} - 1; k >= 0; k--)); do kill "${pids[k]}" 2>/dev/null || true; done
  wait 2>/dev/null || true
  rm -rf "$place"
  exit "$code"
}
trap finish EXIT

# until_true SECONDS WHAT COMMAND...: asks again and again.
until_true() {
  local limit=$1 what=$2
  shift 2
  for ((k = 0; k < limit * 2; k++)); do
    if "$@" >/dev/null 2>&1; then return; fi
    sleep 0.5
  done
  echo "not within $limit s: $what" >&2
  return 1
}

# munge, on a socket of its own.
mkdir -m 700 "$place/munge"
mkdir -m 755 "$place/socket"
dd if=/dev/urandom of="$place/munge/key" bs=1 count=1024 status=none
chmod 400 "$place/munge/key"
munged --foreground --force --key-file="$place/munge/key" --socket="$place/socket/munge" \
  --pid-file="$place/munge/pid" --seed-file="$place/munge/seed" --log-file="$place/munge/log" \
  >"$place/munged.log" 2>&1 &
pids+=($!)

port=$((20000 + RANDOM % 20000))
host=$(hostname -s)
cat >"$place/slurm.conf" <<END
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$place/socket/munge
CredType=cred/munge
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
StateSaveLocation=$place/state
SlurmdSpoolDir=$place/spool-%n
SlurmctldPidFile=$place/slurmctld.pid
SlurmdPidFile=$place/slurmd-%n.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/linear
SchedulerType=sched/backfill
SchedulerParameters=bf_interval=2,sched_min_interval=500000
SlurmdParameters=config_overrides
ReturnToService=2
MinJobAge=10
KillWait=5
MpiDefault=none
NodeName=n1 NodeHostname=$host NodeAddr=127.0.0.1 Port=$((port + 1)) CPUs=1
NodeName=n2 NodeHostname=$host NodeAddr=127.0.0.1 Port=$((port + 2)) CPUs=1
PartitionName=all Nodes=n1,n2 Default=YES MaxTime=60 State=UP
END
mkdir "$place/state" "$place/spool-n1" "$place/spool-n2"
export SLURM_CONF=$place/slurm.conf
until_true 10 "munge answers" test -S "$place/socket/munge" || skip "munged does not come up"
slurmctld -D >"$place/slurmctld.log" 2>&1 &
pids+=($!)
for node in n1 n2; do
  slurmd -D -N "$node" >"$place/slurmd-$node.log" 2>&1 &
  pids+=($!)
done
idle() { [ "$(sinfo --noheader --format=%D --states=idle)" = 2 ]; }
until_true 60 "two nodes are idle" idle || skip "slurmctld and slurmd do not come up"
sinfo --version

# The service, and a fleet of it.
export COGNATE_COORDINATOR=http://127.0.0.1:$((port + 3))
"$program" coordinator --listen "127.0.0.1:$((port + 3))" --ledger "sqlite:$place/ledger.db" \
  --results "$place/results" >"$place/coordinator.log" 2>&1 &
pids+=($!)
until_true 30 "the coordinator answers" "$program" jobs
mkdir "$place/logs"
RUST_LOG=debug "$program" fleet slurm --max 4 --every 1 --idle-timeout 8 --finish-within 1 \
  --time 10 --program "$program" --logs "$place/logs" >"$place/fleet.log" 2>&1 &
fleet=$!
pids+=("$fleet")
sleep 3
[ -z "$(squeue --noheader)" ] || { echo "workers without work" >&2; exit 1; }

submit() { "$program" submit deploy/examples/katsura_10.bertini --precision 60 --seed "$1"; }
jobs=()
for seed in 1 2 3 4; do jobs+=("$(submit "$seed")"); done
running() { [ "$(squeue --noheader --states=RUNNING | wc -l)" -ge "$1" ]; }
until_true 60 "both nodes work" running 2
until_true 30 "workers are there" grep -q '"worker"' <("$program" workers --format json)

# One is requeued, one is killed with its slurmstepd: Slurm runs the first again, the fleet replaces the other.
victims=($(squeue --noheader --states=RUNNING --array --format=%A --sort=i))
scontrol requeue "${victims[0]}"
# A new fleet, that knows nothing of the first: what stands, Slurm knows.
kill "$fleet"
wait "$fleet" || true
RUST_LOG=debug "$program" fleet slurm --max 4 --every 1 --idle-timeout 8 --finish-within 1 \
  --time 10 --program "$program" --logs "$place/logs" >"$place/fleet-2.log" 2>&1 &
pids+=($!)
scancel --signal=KILL "${victims[1]}" || true

for job in "${jobs[@]}"; do
  timeout 900 "$program" watch "$job" >"$place/watch.log" 2>&1
  found=$("$program" results "$job" --format json | python3 -c \
    'import json,sys; s = json.load(sys.stdin); p = s["paths"]; print(p["total"], p["failed"], s["solutions"]["distinct"])')
  [ "$found" = "1024 0 1024" ] || { echo "job $job: found $found" >&2; exit 1; }
done
most=$(squeue --noheader --array | wc -l)
[ "$most" -le 4 ] || { echo "$most workers, and 4 are the most" >&2; exit 1; }
quiet() { [ -z "$(squeue --noheader --states=PENDING,RUNNING)" ]; }
until_true 90 "all have left, for there is nothing to do" quiet
grep -q "workers are submitted" "$place/fleet.log"
echo "the fleet in Slurm: ${#jobs[@]} jobs solved through a requeue, a kill and a new fleet"
