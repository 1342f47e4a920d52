#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# usage: one_node.sh: a sweep of 20 points on a Slurm of one node on the loopback device: a task is killed midway, the
# sweep goes on, and its tables are those of --on local. Exit status 77, with a sentence, where Slurm cannot be started.
# PHOTONLOOM is the program; SLURM_PACKAGES=install lets it install slurm-wlm and munge first.
set -u
source=$(cd "$(dirname "$0")/../.." && pwd)
photonloom=$(realpath -m "${PHOTONLOOM:-$source/build/photonloom}")  # the sweeps run in a folder of their own
skip() { echo "skipped: $*"; exit 77; }
fail() { echo "FAILED: $*"; exit 1; }

[ "$(id -u)" = 0 ] || skip "slurmd needs root"
[ "${SLURM_PACKAGES:-}" != install ] || "$source/scripts/setup" slurm-test || skip "the packages cannot be installed"
for tool in slurmctld slurmd munged sbatch squeue scancel; do
  command -v "$tool" >/dev/null 2>&1 || [ -x "/usr/sbin/$tool" ] || skip "there is no $tool (make slurm-test installs it)"
done
PATH=$PATH:/usr/sbin
work=$(mktemp -d)
daemons=""
clean() {
  # shellcheck disable=SC2086
  [ -z "$daemons" ] || kill $daemons 2>/dev/null
  sleep 1
  # shellcheck disable=SC2086
  [ -z "$daemons" ] || kill -9 $daemons 2>/dev/null
  rm -rf "$work"
}
trap clean EXIT INT TERM
start() {  # start NAME COMMAND...: in the foreground of a job of its own, its number kept for the end
  name=$1
  shift
  "$@" >"$work/$name.out" 2>&1 &
  daemons="$daemons $!"
}

# munge with a key and a socket of its own.
mkdir -p "$work/munge" "$work/state" "$work/spool"
chmod 755 "$work"
chmod 700 "$work/munge" "$work/state"
dd if=/dev/urandom of="$work/munge/key" bs=1024 count=1 2>/dev/null
chmod 400 "$work/munge/key"
start munged munged --foreground --force --key-file="$work/munge/key" --socket="$work/munge.socket" \
  --pid-file="$work/munge/pid" --log-file="$work/munge/log" --seed-file="$work/munge/seed"
# Ports of the day: two sweeps of this test may run on one machine.
port=$((20000 + $$ % 20000))
cat >"$work/slurm.conf" <<END
ClusterName=loopback
SlurmctldHost=$(hostname -s)(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket=$work/munge.socket
CredType=cred/munge
SlurmctldPort=$port
SlurmdPort=$((port + 1))
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_interval=2
MpiDefault=none
SwitchType=switch/none
ReturnToService=2
NodeName=$(hostname -s) NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP
END
export SLURM_CONF=$work/slurm.conf
sleep 1
start slurmctld slurmctld -D -f "$work/slurm.conf"
start slurmd slurmd -D -N "$(hostname -s)" -f "$work/slurm.conf"
tries=0
until sinfo --noheader --format=%t 2>/dev/null | grep -q '^idle'; do
  tries=$((tries + 1))
  if [ $tries -gt 60 ]; then
    tail -n 5 "$work"/*.log "$work"/*.out
    skip "a Slurm of one node does not start here"
  fi
  sleep 1
done

# A baseline and 19 values of k.
cat >"$work/study.toml" <<END
[study]
name = "slurm"
scenes = ["$source/scenes/cornell.xml"]
seeds = [1, 2]
size = "24x24"
measure = ["visible", "formats", "gather", "resources"]
[references]
spp = 16
[gather]
queries = 256
[base]
photons = 20000
frame.spp = 4
frame.gather_rays = 8
[[points]]
strategy = "grid"
lines = { gather.k = [2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20] }
END
cd "$work" || exit 1
"$photonloom" sweep study.toml -o local || fail "the local sweep"

"$photonloom" sweep study.toml -o slurm --on slurm >"$work/sweep.out" 2>&1 &
sweep=$!
# Kills the whole array once some of its results are there.
tries=0
while [ "$(find slurm/results -name '*.json' 2>/dev/null | wc -l)" -lt 3 ]; do
  tries=$((tries + 1))
  [ $tries -lt 600 ] || { cat sweep.out slurm/slurm/*.log; fail "no results came"; }
  sleep 0.1
done
scancel "$(squeue --noheader --format=%F | head -n 1)" || fail "scancel"
wait $sweep || { cat sweep.out; fail "the sweep on Slurm"; }
cat sweep.out
grep -q 'submitted again' sweep.out || fail "no task was killed midway: the test says nothing"
for table in results.sqlite results.csv summary.json; do
  cmp "local/$table" "slurm/$table" || fail "$table differs"
done
echo "20 points, the array job killed midway: the same tables as --on local"
