#!/bin/bash
# contrib/slurm on a Slurm of its own: one machine, two virtual nodes, of which one at a time is killed while jobs run
# on it. What comes out is what one run without Slurm makes.
# usage: tests/slurm_test.sh ROOT FRESHET [KILLS]   kills of each of the two parts, at random moments; 1
set -euo pipefail
root=$(realpath "$1") FRESHET=$(realpath "$2") kills=${3:-1}
export FRESHET
for program in slurmctld slurmd sbatch munged ffmpeg; do
  PATH=$PATH:/usr/sbin command -v $program > /dev/null && continue
  echo "SKIPPED: no $program: contrib/slurm is not tested (apt-get install slurm-wlm munge ffmpeg)"
  exit 77
done
PATH=$PATH:/usr/sbin
here=$(mktemp -d)
cd "$here"
daemons=()
# Of a process and all below it.
kill_tree() {
  local child
  for child in $(ps -o pid= --ppid "$1"); do kill_tree "$child"; done
  kill -9 "$1" 2> /dev/null || true
}
end() {
  local status=$? daemon
  [ $status = 0 ] || tail -n 20 "$here"/*.log "$here"/slurm/slurm*.log >&2 || true
  for node in n1 n2; do kill_node $node; done
  for daemon in "${daemons[@]}"; do kill_tree "$daemon"; done
  rm -rf "$here"
}
fail() { echo "FAILED: $*" >&2; exit 1; }

mkdir -p slurm/state
(umask 077; head -c 1024 /dev/urandom > slurm/key)
munged --foreground --force --key-file="$here/slurm/key" --socket="$here/slurm/munge" --pid-file="$here/slurm/munged.pid" \
  --log-file="$here/slurm/munged.log" > slurm/munged.out 2>&1 &
daemons+=($!)
port=$((20000 + $$ % 20000))
cat > slurm/slurm.conf <<CONF
ClusterName=virtual
SlurmctldHost=localhost
SlurmctldPort=$port
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/munge
AuthInfo=socket=$here/slurm/munge
StateSaveLocation=$here/slurm/state
SlurmdSpoolDir=$here/slurm/spool-%n
SlurmctldPidFile=$here/slurm/slurmctld.pid
SlurmdPidFile=$here/slurm/slurmd-%n.pid
SlurmctldLogFile=$here/slurm/slurmctld.log
SlurmdLogFile=$here/slurm/slurmd-%n.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SlurmdParameters=config_overrides
JobRequeue=1
SlurmdTimeout=300
ReturnToService=2
MpiDefault=none
SchedulerParameters=sched_interval=1,bf_interval=1
NodeName=n1 NodeHostname=localhost NodeAddr=127.0.0.1 Port=$((port + 1)) CPUs=1 RealMemory=500
NodeName=n2 NodeHostname=localhost NodeAddr=127.0.0.1 Port=$((port + 2)) CPUs=1 RealMemory=500
PartitionName=all Nodes=n1,n2 Default=YES MaxTime=60 State=UP
CONF
export SLURM_CONF=$here/slurm/slurm.conf

start_node() { slurmd -N "$1"; }
# The node's daemon and all that runs on it, as when its power goes.
kill_node() {
  local process
  [ ! -e "slurm/slurmd-$1.pid" ] || kill -9 "$(cat "slurm/slurmd-$1.pid")" 2> /dev/null || true
  rm -f "slurm/slurmd-$1.pid"
  for process in $(grep -lsE "SLURMD_NODENAME=$1" /proc/[0-9]*/environ 2> /dev/null | cut -d/ -f3); do
    grep -qsF "SLURM_CONF=$SLURM_CONF" "/proc/$process/environ" || continue
    parent=$(ps -o ppid= -p "$process" | tr -d ' ' || true)
    [ -z "$parent" ] || ! ps -o args= -p "$parent" | grep -q '^slurmstepd' || kill -9 "$parent" 2> /dev/null || true
    kill -9 "$process" 2> /dev/null || true
  done
}
trap end EXIT
sleep 1
slurmctld -c -D > slurm/out 2>&1 &
daemons+=($!)
for node in n1 n2; do start_node $node; done
for _ in $(seq 60); do [ "$(sinfo -h -o %T)" != idle ] || break; sleep .5; done
[ "$(sinfo -h -o %T)" = idle ] || fail "no Slurm: $(sinfo)"

# Kills the nodes in turn while a job is there, and waits for it to end well.
finish() {  # JOB
  local killed=0 state
  while state=$(squeue -h -j "$1" -t all -o %T) && [[ ! $state =~ ^(COMPLETED|FAILED|CANCELLED|TIMEOUT|NODE_FAIL|OUT_OF_MEMORY)$ ]]; do
    sleep "$(awk -v seed=$RANDOM 'BEGIN { srand(seed); print .2 + 1.2 * rand() }')"
    if [ $killed -lt "$kills" ]; then
      local node=n$((killed % 2 + 1))
      [ -n "$(squeue -h -t running -w $node)" ] || continue
      kill_node $node
      scontrol update nodename=$node state=down reason=killed
      killed=$((killed + 1))
      start_node $node
      scontrol update nodename=$node state=resume 2> /dev/null || true
      for job in $(squeue -h -t pending -r -o %A); do  # not after the two minutes that Slurm waits, nor while it ends the one before
        scontrol update jobid="$job" starttime=now+4 2> /dev/null || true
      done
    fi
  done
  [ "$state" = COMPLETED ] || fail "job $1: $state"
  [ $killed -gt 0 ] || fail "no node was killed"
  echo "job $1: $killed nodes killed, jobs started again: $(scontrol show job | grep -o 'Restarts=[0-9]*' | cut -d= -f2 | paste -sd+ | bc)"
}

mkdir clips
for i in $(seq 8); do
  ffmpeg -v error -f lavfi -i "life=s=192x144:mold=8:r=25:seed=$i:ratio=.3,scale=192:144,gblur=2" -frames:v 60 -c:v ffv1 "clips/$i.mkv"
done
cp clips/3.mkv clips/again.mkv
"$FRESHET" ingest one.store clips --force --class water > one.log 2>&1
shards=8
finish "$("$root/contrib/slurm/freshet-slurm" ingest $shards many.store "$here/clips" --force --class water)"
[ "$("$FRESHET" store digest one.store)" = "$("$FRESHET" store digest many.store)" ] || fail "another digest than one run's"
[ "$(grep -h '"outcome": "added"' many.store.parts/*.json | wc -l)" = 8 ] || fail "not every clip was added once"
[ "$(ls many.store.parts | wc -l)" = $((2 * shards)) ] || fail "more lies in many.store.parts than shards: $(ls many.store.parts | tr "\n" " ")"

ffmpeg -v error -f lavfi -i "life=s=96x96:mold=8:seed=77:ratio=.3,gblur=2" -frames:v 1 still.png
sweep=(one.store still.png --whole --frames 48 --vary speed=1,2,.5,1.0 --vary sigma=.125,40)
"$FRESHET" synth sweep "${sweep[@]}" -o whole > whole.log 2>&1
finish "$("$root/contrib/slurm/freshet-slurm" sweep 8 "${sweep[@]}" -o shared)"
for file in whole/*; do
  case $file in
    *.json | *.html) diff <(sed '/"seconds"/d; s,whole/,shared/,g' "$file") <(sed '/"seconds"/d' "shared/${file#*/}") ;;
    *) cmp "$file" "shared/${file#*/}" ;;
  esac || fail "$file is another"
done
[ "$(ls whole)" = "$(ls shared)" ] || fail "other files: $(ls shared)"
echo "ok: $shards shards of clips, 8 animations"
