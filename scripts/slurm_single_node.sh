#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The Vernier authors
# SPDX-License-Identifier: Apache-2.0
# Runs a small study under a real Slurm of one node: as an array of shards, which are merged, and under
# mpirun in an allocation; compares both with a plain run. Debian's munge, slurmctld, slurmd and slurm-client,
# with a configuration, keys, logs and ports of its own in a temporary folder: an installed Slurm is not
# touched. Ends what it started, by process number. See docs/cluster.md.
set -euo pipefail

usage() {
  cat <<'USAGE'
usage: scripts/slurm_single_node.sh [--install] [PROGRAM]
  --install   install Debian's slurmd, slurmctld, slurm-client and munge first
  PROGRAM     default: build/release/vernier
Needs root: Slurm's daemons change to the user of a job.
USAGE
}

cd "$(dirname "${BASH_SOURCE[0]}")/.."
install=no
program=build/release/vernier
while (($# > 0)); do
  case "$1" in
    --install) install=yes ;;
    -h | --help)
      usage
      exit 0
      ;;
    -*)
      usage >&2
      exit 2
      ;;
    *) program=$1 ;;
  esac
  shift
done
if [[ $(id -u) != 0 ]]; then
  echo "slurm_single_node.sh: needs root" >&2
  exit 2
fi
if [[ ! -x $program ]]; then
  echo "slurm_single_node.sh: $program: not found; build it, or give the program" >&2
  exit 2
fi
program=$(realpath "$program")
if [[ $install == yes ]]; then
  DEBIAN_FRONTEND=noninteractive apt-get --quiet install --yes --no-install-recommends \
    slurmd slurmctld slurm-client munge >&2
fi
for tool in munged slurmctld slurmd sbatch; do
  if ! command -v "$tool" >/dev/null; then
    echo "slurm_single_node.sh: $tool: not found; run with --install" >&2
    exit 2
  fi
done

work=$(mktemp --directory)
daemons=()
close() {
  local code=$? pid
  if ((code != 0)); then
    for log in "$work"/*.log "$work"/job-*.out; do
      [[ -f $log ]] && tail --lines=8 "$log" | sed "s|^|$(basename "$log"): |" >&2
    done
  fi
  for ((i = ${#daemons[@]} - 1; i >= 0; --i)); do
    pid=${daemons[$i]}
    kill "$pid" 2>/dev/null || continue
    for _ in {1..100}; do
      kill -0 "$pid" 2>/dev/null || break
      sleep 0.1
    done
    kill -KILL "$pid" 2>/dev/null || true
  done
  rm --recursive --force "$work"
  exit "$code"
}
trap close EXIT

free_port() { python3 -c 'import socket; s = socket.socket(); s.bind(("", 0)); print(s.getsockname()[1])'; }

# munge proves to the daemons who sends a message; it insists on folders that nobody else may write.
chmod 755 "$work"
mkdir "$work/munge" "$work/state" "$work/spool"
(umask 077 && head --bytes=1024 /dev/urandom >"$work/munge/key")
munged --foreground --force --key-file="$work/munge/key" --socket="$work/munge/socket" \
  --pid-file="$work/munge/pid" --log-file="$work/munge/log" --seed-file="$work/munge/seed" \
  >"$work/munged.log" 2>&1 &
daemons+=($!)

host=$(hostname --short)
cat >"$work/slurm.conf" <<CONF
ClusterName=vernier
SlurmctldHost=$host(127.0.0.1)
SlurmUser=root
SlurmdUser=root
SlurmctldPort=$(free_port)
SlurmdPort=$(free_port)
AuthType=auth/munge
AuthInfo=socket=$work/munge/socket
CredType=cred/munge
MpiDefault=none
# one that needs neither systemd nor control groups
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerType=sched/builtin
ReturnToService=2
StateSaveLocation=$work/state
SlurmdSpoolDir=$work/spool
SlurmctldPidFile=$work/slurmctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/slurmctld.log
SlurmdLogFile=$work/slurmd.log
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
CONF
export SLURM_CONF=$work/slurm.conf
slurmctld -D -f "$SLURM_CONF" >/dev/null 2>&1 &
daemons+=($!)
slurmd -D -f "$SLURM_CONF" -N "$host" >/dev/null 2>&1 &
daemons+=($!)

for _ in {1..300}; do
  [[ $(sinfo --noheader --format=%T 2>/dev/null) == idle ]] && break
  sleep 0.1
done
if [[ $(sinfo --noheader --format=%T) != idle ]]; then
  echo "slurm_single_node.sh: the node does not come up: $(sinfo --noheader --format='%T %E')" >&2
  exit 1
fi
echo "$(sinfo --version): one node, $(nproc) cores"

cd "$work"
"$program" world make --seed 5 --size-m 10,8,2.5 -o small.world.toml -q >/dev/null
cat >study.toml <<'STUDY'
[study]
trials = 120
protocol = "near_path"
[world]
file = "small.world.toml"
[map]
spacing_m = 4
[sweep]
"sources.calibration" = [0, 3]
STUDY

# What is compared: results, without times.
results() {
  python3 -c 'import json, sys
cells = json.load(sys.stdin)["cells"]
print(json.dumps([{k: v for k, v in cell.items() if "_ms_" not in k} for cell in cells]))'
}
"$program" study study.toml -o plain --json -q | results >plain.json

same() {
  if ! cmp --silent plain.json "$2"; then
    echo "slurm_single_node.sh: $1: other results than the plain run" >&2
    exit 1
  fi
  echo "$1: identical to the plain run"
}

# A job of several tasks, each a shard; the variables of the array tell the program which.
run_array() {
  local name=$1 array=$2 folder=$3
  sbatch --quiet --wait --job-name="$name" --array="$array" --cpus-per-task=1 --chdir="$work" \
    --output="job-$name-%a.out" --wrap="'$program' study study.toml -o $folder -q --threads 1"
}
echo "sbatch --array=0-3, one folder"
run_array one 0-3 shards
"$program" study merge shards -o merged --json -q | results >merged.json
same "array 0-3, merged" merged.json

echo "sbatch --array=1-7:3, a folder for each task"
run_array own 1-7:3 'part-$SLURM_ARRAY_TASK_ID'
"$program" study merge part-1 part-4 part-7 -o merged_parts --json -q | results >parts.json
same "array 1-7:3, merged" parts.json

echo "sbatch --array=0-3, the third task fails and is run again"
sbatch --quiet --wait --array=0-3 --cpus-per-task=1 --chdir="$work" --output=job-some-%a.out \
  --wrap="[ \$SLURM_ARRAY_TASK_ID != 2 ] || exit 1; '$program' study study.toml -o some -q --threads 1" ||
  true
code=0
"$program" study merge some -o merged_some -q >/dev/null 2>said || code=$?
cat said
if [[ $code != 3 ]] || ! grep --quiet -e '--shard 2/4' said; then
  echo "slurm_single_node.sh: the missing shard is not named (exit code $code)" >&2
  exit 1
fi
"$program" study study.toml -o some --shard 2/4 -q >/dev/null
"$program" study merge some -o merged_some --json -q | results >some.json
same "the missing shard run, merged again" some.json

if command -v mpirun >/dev/null && "$program" doctor | grep --quiet '^  MPI'; then
  echo "sbatch --ntasks=$(nproc), mpirun"
  sbatch --quiet --wait --job-name=ranks --ntasks="$(nproc)" --chdir="$work" --output=job-ranks.out \
    --export=ALL,OMPI_ALLOW_RUN_AS_ROOT=1,OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 \
    --wrap="mpirun --bind-to none '$program' study study.toml -o ranks -q"
  "$program" study status ranks --json -q | results >ranks.json
  same "mpirun in an allocation" ranks.json

  if srun --mpi=list 2>&1 | grep --quiet --word-regexp pmix; then
    echo "sbatch --ntasks=$(nproc), srun --mpi=pmix"
    sbatch --quiet --wait --job-name=srun --ntasks="$(nproc)" --chdir="$work" --output=job-srun.out \
      --wrap="srun --mpi=pmix '$program' study study.toml -o srun -q"
    "$program" study status srun --json -q | results >srun.json
    same "srun in an allocation" srun.json
  fi
else
  echo "mpirun: left out, MPI is not installed or the program was built without it"
fi
