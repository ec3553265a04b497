#!/usr/bin/env bash
# run.sh [parallel|slurm|mpirun|snakemake|dask]...: sweeps under real schedulers on this machine; all of them if none
# is named. A scheduler that is not installed is skipped with a reason; if all are, the exit code is still 0.
#
#   parallel   GNU parallel with three shards
#   slurm      a cluster of one node with two slots: slurmctld, slurmd and munged as ordinary programs of this user, in a
#              scratch folder. A job array and srun; a task is killed by SIGKILL and requeued
#   mpirun     OpenMPI with two processes
#   snakemake  the Snakefile of docs/examples/sweep
#   dask       the program of docs/sweeps.md
#
# Each of them must give the same table, byte for byte, as one process alone. PALPA_CLUSTER_KEEP: if set, the scratch
# folder stays. The Python module must be built.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
# The interpreter that the Python module was built for; another one may come first in PATH.
interpreter=$(sed -n 's/^_Python_EXECUTABLE:INTERNAL=//p' build/release/CMakeCache.txt)
export PYTHONPATH=$PWD/build/release/python PALPA_ASSETS=$PWD/assets LP_NUM_THREADS=1
sweeps=("$interpreter" -m palpa.sweeps)

work=$(mktemp -d "${TMPDIR:-/tmp}/palpa-cluster.XXXXXX")
started=() # the programs to be ended
finish() {
  local pid
  for pid in "${started[@]}"; do kill "$pid" 2>/dev/null || true; done
  wait 2>/dev/null || true
  [[ -n ${PALPA_CLUSTER_KEEP-} ]] || rm -rf "$work"
}
trap finish EXIT

say() { printf 'cluster: %s\n' "$*"; }
die() {
  say "$*"
  exit 1
}
needs() { # PROGRAM PACKAGE
  command -v "$1" >/dev/null && return
  say "$what: skipped: there is no $1 here: apt-get install $2"
  return 1
}

# The plan: 60 cases of some 10 ms each, and one process' table of it.
cat >"$work/plan.toml" <<END
command = "field"
[options]
focus = "0,0,100mm"
plane = "xz"
size = "40mm,40mm"
centre = "0,0,100mm"
pixels = "64,64"
[vary]
layout = ["openmpd", "autd3", "paper"]
temperature = { from = 15, to = 34, count = 20 }
END
sweep() { "${sweeps[@]}" "$work/plan.toml" --backend cpu --quiet "$@"; }
gather() { "${sweeps[@]}" "$work/plan.toml" --out "$work/$1" --gather "$work/$1/table.csv" --quiet; }

sweep --out "$work/one"
gather one

# same NAME: its table is the one process'.
same() {
  gather "$1" || die "$1: does not gather"
  cmp "$work/one/table.csv" "$work/$1/table.csv" || die "$1: the table differs from that of one process"
  say "$1: the same table, from $(find "$work/$1" -name '*.jsonl' | wc -l) files"
}

with_parallel() {
  needs parallel parallel || return 0
  parallel --will-cite --jobs 2 "${sweeps[@]}" "$work/plan.toml" --backend cpu --quiet --out "$work/parallel" \
    --shard {}/3 ::: 0 1 2
  same parallel
}

with_mpirun() {
  needs mpirun openmpi-bin || return 0
  local root=()
  ((EUID != 0)) || root=(--allow-run-as-root)
  mpirun "${root[@]}" --oversubscribe -n 2 "${sweeps[@]}" "$work/plan.toml" --backend cpu --quiet --out "$work/mpirun" --shard env
  [[ $(find "$work/mpirun" -name '*.jsonl' | wc -l) == 2 ]] || die "mpirun: not two processes computed"
  same mpirun
}

with_snakemake() {
  needs snakemake snakemake || return 0
  mkdir "$work/snakemake-job"
  cp docs/examples/sweep/Snakefile "$work/snakemake-job/"
  cp "$work/plan.toml" "$work/snakemake-job/"
  (cd "$work/snakemake-job" && snakemake --cores 2 --config shards=3 options='--backend cpu --quiet' python="$interpreter" >log 2>&1) || {
    tail -n 20 "$work/snakemake-job/log"
    die "snakemake failed"
  }
  cmp "$work/one/table.csv" "$work/snakemake-job/results/table.csv" || die "snakemake: the table differs"
  say "snakemake: the same table"
}

with_dask() {
  "$interpreter" -c 'import distributed' 2>/dev/null || {
    say "dask: skipped: there is no distributed here: apt-get install python3-distributed"
    return 0
  }
  mkdir "$work/dask-job"
  # shellcheck disable=SC2016  # Markdown
  awk '/^```python$/ { inside = 1; text = ""; next }
       /^```$/ { if (inside && text ~ /import distributed/) printf "%s", text; inside = 0 }
       inside { text = text $0 "\n" }' docs/sweeps.md | sed 's/client=client/&, backend="cpu"/' >"$work/dask-job/many.py"
  cp "$work/plan.toml" "$work/dask-job/"
  (cd "$work/dask-job" && "$interpreter" many.py >log 2>&1) || {
    tail -n 20 "$work/dask-job/log"
    die "dask failed"
  }
  cmp "$work/one/table.csv" "$work/dask-job/results/table.csv" || die "dask: the table differs"
  say "dask: the same table, $(cat "$work/dask-job/log")"
}

# ---- Slurm ----------------------------------------------------------------------------------------------------------

wait_for() { # SECONDS COMMAND...
  local end=$((SECONDS + $1))
  until "${@:2}" >/dev/null 2>&1; do
    ((SECONDS < end)) || return 1
    sleep 0.2
  done
}

start_slurm() {
  local host user
  host=$(hostname -s) user=$(id -un)
  mkdir -p "$work"/slurm/{state,spool,log}
  chmod 755 "$work" "$work/slurm"
  dd if=/dev/urandom of="$work/slurm/munge.key" bs=128 count=1 status=none
  chmod 600 "$work/slurm/munge.key"
  munged --foreground --force --key-file="$work/slurm/munge.key" --socket="$work/slurm/munge.socket" \
    --pid-file="$work/slurm/munge.pid" --log-file="$work/slurm/log/munge" --seed-file="$work/slurm/munge.seed" >/dev/null 2>&1 &
  started+=($!)
  cat >"$work/slurm/slurm.conf" <<END
ClusterName=palpa
SlurmctldHost=$host(127.0.0.1)
SlurmUser=$user
SlurmdUser=$user
AuthType=auth/munge
AuthInfo=socket=$work/slurm/munge.socket,cred_expire=10
CredType=cred/munge
StateSaveLocation=$work/slurm/state
SlurmdSpoolDir=$work/slurm/spool
SlurmctldPidFile=$work/slurm/slurmctld.pid
SlurmdPidFile=$work/slurm/slurmd.pid
SlurmctldLogFile=$work/slurm/log/slurmctld
SlurmdLogFile=$work/slurm/log/slurmd
SlurmctldPort=$port
SlurmdPort=$((port + 1))
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerType=sched/backfill
SchedulerParameters=batch_sched_delay=0,sched_interval=1,requeue_delay=1
JobRequeue=1
ReturnToService=2
SlurmdParameters=config_overrides
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=all Nodes=$host Default=YES MaxTime=INFINITE State=UP
END
  export SLURM_CONF=$work/slurm/slurm.conf
  wait_for 10 test -S "$work/slurm/munge.socket" || die "slurm: munged does not start: $(tail -n 3 "$work/slurm/log/munge")"
  slurmctld -D >/dev/null 2>&1 &
  started+=($!)
  slurmd -D >/dev/null 2>&1 &
  started+=($!)
  # shellcheck disable=SC2016  # expanded by the shell that is started
  wait_for 30 bash -c 'sinfo -h -o %T | grep -q idle' || {
    tail -n 5 "$work"/slurm/log/*
    die "slurm: the node does not get ready"
  }
}

with_slurm() {
  local program job pid killed
  for program in slurmctld:slurmctld slurmd:slurmd sbatch:slurm-client munged:munge; do
    needs "${program%:*}" "${program#*:}" || return 0
  done
  port=$((20000 + $$ % 20000))
  start_slurm
  # A job array of four tasks with the numbers 3 to 6, at most two at a time.
  sbatch --quiet --wait --array=3-6 --chdir="$work" --output="$work/array-%a.log" --wrap \
    "'$interpreter' -m palpa.sweeps plan.toml --backend cpu --quiet --out array --shard env" || {
    cat "$work"/array-*.log
    die "slurm: the job array failed"
  }
  same array
  # srun starts two processes in one job.
  srun --quiet --ntasks=2 --chdir="$work" "${sweeps[@]}" plan.toml --backend cpu --quiet --out srun --shard env ||
    die "slurm: srun failed"
  same srun
  # A task is killed by SIGKILL while it computes, and Slurm starts it again.
  cat >"$work/requeued.sh" <<END
#!/bin/bash
'$interpreter' -m palpa.sweeps plan.toml --backend cpu --quiet --out requeued --shard env && exit
# SIGKILL is like a lost node: back into the queue.
scontrol requeue "\${SLURM_ARRAY_JOB_ID}_\$SLURM_ARRAY_TASK_ID"
sleep 60
END
  # Longer cases, so that it is killed in the middle of them.
  sed 's/64,64/120,120/' "$work/plan.toml" >"$work/longer.toml"
  mv "$work/plan.toml" "$work/short.toml"
  mv "$work/longer.toml" "$work/plan.toml"
  job=$(sbatch --parsable --requeue --array=0-1 --chdir="$work" --output="$work/requeued-%a.log" --open-mode=append "$work/requeued.sh")
  # shellcheck disable=SC2016  # expanded by the shell that is started
  wait_for 60 bash -c '[[ $(cat "$1"/requeued/shard-0-of-2.jsonl | wc -l) -ge 3 ]]' _ "$work" || die "slurm: no case was computed"
  link=$(find /proc/[0-9]*/fd -lname "$work/requeued/shard-0-of-2.jsonl" 2>/dev/null | head -n 1 || true)
  pid=${link#/proc/} pid=${pid%%/*}
  kill -KILL "$pid"
  killed=$(wc -l <"$work/requeued/shard-0-of-2.jsonl")
  say "slurm: killed process $pid after $killed cases"
  # shellcheck disable=SC2016
  wait_for 180 bash -c '[[ -z $(squeue --noheader --jobs "$1" 2>/dev/null) ]]' _ "$job" || die "slurm: the requeued job does not end: $(squeue)"
  [[ $(wc -l <"$work/requeued/shard-0-of-2.jsonl") -gt $killed ]] || die "slurm: the killed task did not run again"
  sweep --out "$work/alone"
  gather requeued || die "slurm: requeued: does not gather"
  gather alone
  cmp "$work/alone/table.csv" "$work/requeued/table.csv" || die "slurm: requeued: the table differs"
  say "slurm: a task that was killed and requeued gives the same table"
  mv "$work/short.toml" "$work/plan.toml"
}

(($#)) || set -- parallel mpirun snakemake dask slurm
for what; do
  declare -F "with_$what" >/dev/null || die "there is no $what here"
  "with_$what"
done
say "all of it: $SECONDS s"
