#!/bin/bash
# SPDX-License-Identifier: Apache-2.0
# Runs the bench's job list as an array on a real Slurm with one node, which the script starts in its own folder and stops at
# the end. It kills one task, submits the array again, and compares the tables with those of a run without Slurm.
# usage: slurm_array_test.sh PLVO_BENCH; 77: skipped
set -euo pipefail

bench=$1
skip() { echo "SKIPPED: $*" >&2; exit 77; }
for program in slurmctld slurmd sbatch squeue scancel; do
  command -v "$program" >/dev/null || skip "no $program (apt install slurm-wlm)"
done
[ "$(id -u)" -eq 0 ] || skip "slurmd runs jobs as their users, which only root may"

work=$(mktemp -d)
daemons=()
none_left() { [ -z "$(squeue --noheader 2>/dev/null)" ]; }
end() {
  scancel --quiet --user root 2>/dev/null || true
  for _ in 1 2 3 4 5; do none_left && break || sleep 1; done
  for pid in "${daemons[@]}"; do kill "$pid" 2>/dev/null || true; done
  for pid in "${daemons[@]}"; do wait "$pid" 2>/dev/null || true; done
  rm -rf "$work"
}
trap end EXIT
fail() {
  echo "FAILED: $*" >&2
  tail -n 20 "$work"/*.log >&2 || true
  exit 1
}

# One node, this machine. It needs no authentication, so it has no keys. The ports are unlikely to be in use.
host=$(hostname)
port=$((20000 + $$ % 20000))
mkdir "$work/state" "$work/spool"
export SLURM_CONF=$work/slurm.conf
cat > "$SLURM_CONF" <<CONF
ClusterName=plvo
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmdPort=$((port + 1))
AuthType=auth/none
CredType=cred/none
SlurmUser=root
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SwitchType=switch/none
MpiDefault=none
ReturnToService=2
SchedulerParameters=sched_interval=1,batch_sched_delay=1
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
CONF
slurmctld -D >"$work/slurmctld.log" 2>&1 &
daemons+=($!)
slurmd -D -N "$host" >"$work/slurmd.log" 2>&1 &
daemons+=($!)

# wait_for WHAT COMMAND…: waits at most ten minutes, to allow for other load on the machine.
wait_for() {
  local what=$1
  shift
  for _ in $(seq 600); do
    if "$@"; then return; fi
    sleep 1
  done
  fail "$what did not come about"
}
idle() { sinfo --noheader --format %T 2>/dev/null | grep -q '^idle'; }
started() { [ -e "$work/started" ]; }
wait_for "a node that is ready" idle

measure=("$bench" lighting --out "$work/results" --sites desk,bare --seeds 1 --frames 4 --systems ours)
# Submits the remaining jobs as an array: one line of the list for each task.
submit() {
  "${measure[@]}" --list-jobs > "$work/jobs.txt"
  sbatch --parsable --chdir "$work" --output "$work/task-%a.log" --array="1-$(wc -l < "$work/jobs.txt")" --wrap "$1"
}
task='sh -c "$(sed -n ${SLURM_ARRAY_TASK_ID}p jobs.txt)"'

# The second task reports that it runs and then waits, so that it is killed while it runs, whatever the speed of the machine.
array=$(submit "if [ \$SLURM_ARRAY_TASK_ID = 2 ]; then touch started; sleep 1000; fi; $task")
[ "$(wc -l < "$work/jobs.txt")" -eq 4 ] || fail "four sequences were to be measured"
wait_for "the start of the second task" started
scancel "${array}_2"
wait_for "the end of the array" none_left
"${measure[@]}" --list-jobs > "$work/left.txt"
[ "$(wc -l < "$work/left.txt")" -eq 1 ] || fail "one sequence was to be left, not $(wc -l < "$work/left.txt")"
grep -q -- '--sites desk --lights varying' "$work/left.txt" || fail "the wrong sequence is left: $(cat "$work/left.txt")"

submit "$task" >/dev/null
wait_for "the end of the second array" none_left
[ -z "$("${measure[@]}" --list-jobs)" ] || fail "something is left after the second array"
"${measure[@]}" >"$work/tables.log" 2>&1 || fail "the tables were not made"

measure[3]=$work/alone
"${measure[@]}" >"$work/alone.log" 2>&1 || fail "the run without Slurm failed"
# Compares drift and errors. The page and the raw results contain times, which differ between runs.
tables() { sed 's/, load [0-9.]*;/;/' "$work/$1/lighting.md"; }
cmp <(tables results) <(tables alone) || fail "the tables differ"
for file in "$work"/alone/jobs/*.txt; do
  cmp "$file" "$work/results/jobs/$(basename "$file")" || fail "the trajectories differ"
done
echo "$(find "$work/alone/jobs" -name '*.txt' | wc -l) trajectories and the tables are the same"
