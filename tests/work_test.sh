#!/bin/bash
# freshet work on a nats-server of its own: workers, their commands and the server are killed while they work. What
# comes out is what one run without a queue makes.
# usage: tests/work_test.sh FRESHET [KILLS [SHARDS]]   kills, at random moments, half of them for each of the two parts;
#                                                      4, 4, with FRESHET_LONG=1 50, 8
set -euo pipefail
FRESHET=$(realpath "$1")
[ -n "${FRESHET_LONG:-}" ] && long=(50 8) || long=(4 4)
kills=${2:-${long[0]}} shards=${3:-${long[1]}}
for program in nats-server ffmpeg; do
  PATH=$PATH:/usr/sbin command -v $program > /dev/null && continue
  echo "SKIPPED: no $program: freshet work is not tested (apt-get install nats-server ffmpeg)"
  exit 77
done
PATH=$PATH:/usr/sbin
if grep "was built without NATS" <("$FRESHET" work --queue nats://127.0.0.1:1 --status 2>&1); then
  echo "SKIPPED: freshet work is not tested (apt-get install libnats-dev)"
  exit 77
fi
here=$(mktemp -d)
cd "$here"
server=0
mkdir tmp
export TMPDIR=$here/tmp
declare -A workers
fail() { echo "FAILED: $*" >&2; exit 1; }
end() {
  local status=$? process
  [ $status = 0 ] || tail -n 15 "$here"/*.log >&2 || true
  for process in $server "${workers[@]}"; do [ "$process" = 0 ] || kill -9 "$process" 2> /dev/null || true; done
  rm -rf "$here"
}
trap end EXIT

port=0
start_server() {
  local first=$port
  for _ in $(seq 20); do
    [ "$first" != 0 ] || port=$((20000 + RANDOM % 20000))
    : > server.log  # what the one before said is no answer of this one
    nats-server -js -sd "$here/jetstream" -a 127.0.0.1 -p "$port" > server.log 2>&1 &
    server=$!
    for _ in $(seq 100); do
      ! grep -q "Server is ready" server.log || return 0
      kill -0 $server 2> /dev/null || break
      sleep .05
    done
  done
  fail "no nats-server: $(cat server.log)"
}
kill_server() {
  kill -9 $server
  wait $server 2> /dev/null || true
}
start_worker() {  # NAME OPTION..
  local name=$1
  shift
  "$FRESHET" work --queue "nats://127.0.0.1:$port" -j 1 "$@" >> "$name.log" 2>&1 &
  workers[$name]=$!
}
kill_worker() {  # NAME SIGNAL
  kill "-$2" "${workers[$1]}" || fail "$1 ended by itself: $(tail -n 3 "$1.log")"
  wait "${workers[$1]}" 2> /dev/null || true
  workers[$1]=0
}
queue() { "$FRESHET" work --queue "nats://127.0.0.1:$port" "$@"; }
left() { queue --status --json | tr -d ' ",' | awk -F: '$1 == "waiting" || $1 == "in_hand" { n += $2 } END { print n }'; }
empty() {
  for _ in $(seq 1200); do
    [ "$(left)" != 0 ] || return 0
    sleep .3
  done
  fail "tasks are left: $(queue --status)"
}
between() { awk -v seed=$RANDOM -v from="$1" -v to="$2" 'BEGIN { srand(seed); print from + (to - from) * rand() }'; }

# Two workers do what was put in, while one of them, its command or the server is killed now and then, until as many
# kills were made or all is done, as the given command tells.
killed=0
declare -A kills_of
under_fire() {  # KILLS DONE..
  local end=$((killed + $1)) name
  shift
  for name in one two; do start_worker $name --ack-wait 1 --tries 100; done
  while ! "$@"; do
    sleep "$(between .1 1)"
    [ $killed -lt $end ] || continue
    name=$([ $((RANDOM % 2)) = 0 ] && echo one || echo two)
    local kinds=(server command worker-KILL worker-TERM) kind
    kind=${kinds[RANDOM % 4]}
    case $kind in
      server) kill_server; sleep "$(between 0 .5)"; start_server ;;
      command) pkill -9 -P "${workers[$name]}" || continue ;;
      worker-*) kill_worker $name "${kind#*-}"; start_worker $name --ack-wait 1 --tries 100 ;;
    esac
    killed=$((killed + 1))
    kills_of[$kind]=$((${kills_of[$kind]:-0} + 1))
  done
  empty
  for name in one two; do kill_worker $name TERM; done
}
sealed() { [ "$(find many.store.parts -name '*.json' 2> /dev/null | wc -l)" = "$shards" ]; }
rendered() { [ "$(find shared/parts -maxdepth 1 -name '[0-9]*' 2> /dev/null | wc -l)" = 4 ]; }

"$FRESHET" work --queue nats://127.0.0.1:1 --status > none.log 2>&1 && fail "there is no server"
grep -q "127.0.0.1:1: no NATS server answers" none.log || fail "$(cat none.log)"
"$FRESHET" work --queue localhost --status > none.log 2>&1 && fail "that is no address"
grep -q "is no address of a NATS server" none.log || fail "$(cat none.log)"
start_server
kill_server

# A server that goes while a worker introduces itself is waited for, as one that was never there.
python3 - "$port" << 'PYTHON' &
import socket, sys
client, _ = socket.create_server(("127.0.0.1", int(sys.argv[1]))).accept()
client.sendall(b'INFO {"server_id": "brief", "version": "2.9.10", "headers": true, "max_payload": 1048576}\r\n')
said = b""
while b"$JS.API.STREAM.CREATE" not in said:
    heard = client.recv(4096)
    said += heard
    if b"PING" in heard: client.sendall(b"PONG\r\n")
PYTHON
brief=$!
start_worker early
wait $brief
start_server
for _ in $(seq 100); do ! grep -q "waiting for tasks" early.log || break; sleep .1; done
kill_worker early TERM

mkdir clips
for i in $(seq "$shards"); do
  ffmpeg -v error -f lavfi -i "life=s=128x96:mold=8:r=25:seed=$i:ratio=.3,scale=128:96,gblur=2" -frames:v 40 -c:v ffv1 "clips/$i.mkv"
done
cp clips/3.mkv clips/again.mkv
"$FRESHET" ingest one.store clips --force --class water > one.log 2>&1
ffmpeg -v error -f lavfi -i "life=s=96x96:mold=8:seed=77:ratio=.3,gblur=2" -frames:v 1 still.png
sweep=(one.store still.png --whole --frames 12 --vary speed=1,2 --vary sigma=.125,40)
"$FRESHET" synth sweep "${sweep[@]}" -o whole > whole.log 2>&1
cat > ingest.toml <<TOML
[[task]]
run = ["ingest", "many.store", "clips", "--force", "--class", "water"]
shards = $shards
TOML
cat > sweep.toml <<'TOML'
[[task]]
run = ["synth", "sweep", "one.store", "still.png", "--whole", "--frames", "12", "--vary", "speed=1,2", "--vary",
       "sigma=.125,40", "-o", "shared"]
shards = 4
TOML

rounds=0
while :; do
  queue --submit ingest.toml > put.log
  grep -q "$shards tasks put in, 0 there already. When all are done: freshet ingest many.store clips --force --class water --gather" put.log || fail "$(cat put.log)"
  grep -q "0 tasks put in, $shards there already" <(queue --submit ingest.toml) || fail "a task waits twice"
  under_fire $((kills / 2)) sealed
  [ "$(grep -h '"outcome": "added"' many.store.parts/*.json | wc -l)" = "$shards" ] || fail "not every clip was added once"
  "$FRESHET" ingest many.store clips --force --class water --gather > gather.log 2>&1 || fail "$(cat gather.log)"
  grep -q "$shards shards, $shards added, 1 already there, 0 refused, 0 failed" gather.log || fail "$(cat gather.log)"
  [ "$("$FRESHET" store digest one.store)" = "$("$FRESHET" store digest many.store)" ] || fail "another digest than one run's"
  [ "$(find many.store.parts -type f | wc -l)" = "$(($(find many.store.parts -name '*.store' | wc -l) + shards))" ] || fail "more is left: $(ls many.store.parts)"

  queue --submit sweep.toml > /dev/null
  under_fire $((kills / 2)) rendered
  "$FRESHET" synth sweep "${sweep[@]}" -o shared --gather > gather.log 2>&1 || fail "$(cat gather.log)"
  for file in whole/*; do
    case $file in
      *.json | *.html) diff <(sed '/"seconds"/d; s,whole/,shared/,g' "$file") <(sed '/"seconds"/d' "shared/${file#*/}") ;;
      *) cmp "$file" "shared/${file#*/}" ;;
    esac || fail "$file is another"
  done
  [ "$(ls whole)" = "$(ls shared)" ] || fail "other files: $(ls shared)"
  grep -q " 0 given up" <(queue --status) || fail "$(queue --status)"
  rounds=$((rounds + 1))
  [ $killed -lt "$kills" ] || break
  rm -rf many.store* shared
done
[ $killed -gt 0 ] || fail "nothing was killed"

# What is sealed is not made again.
touch -d '2 hours ago' many.store.parts/*
cat ingest.toml sweep.toml > both.toml
queue --submit both.toml > /dev/null
start_worker again --until-empty
wait "${workers[again]}" || fail "$(tail again.log)"
[ -z "$(find many.store.parts -type f -mmin -60)" ] || fail "made again: $(find many.store.parts -type f -mmin -60)"
[ ! -e shared/parts ] || fail "rendered again"

# Who is asked to stop hands its task back within a second, and another has it at once; while it works, nobody else has
# it.
ffmpeg -v error -f lavfi -i "life=s=192x144:mold=8:r=25:seed=9:ratio=.3,scale=192:144,gblur=2" -frames:v 80 -c:v ffv1 long.mkv
printf '[[task]]\nrun = ["ingest", "long.store", "long.mkv", "--force"]\n' > long.toml
queue --submit long.toml > /dev/null
start_worker first --ack-wait 30
for _ in $(seq 100); do ! grep -q begun first.log || break; sleep .05; done
sleep .3
begin=$(date +%s%N)
kill_worker first TERM
took=$((($(date +%s%N) - begin) / 1000000))
[ $took -lt 1000 ] || fail "it took $took ms to stop"
grep -q "handed back: 1/1 of freshet ingest long.store" first.log || fail "$(cat first.log)"
[ ! -e long.store.parts ] || fail "what was stopped is sealed"
start_worker second --ack-wait 1
for _ in $(seq 40); do ! grep -q begun second.log || break; sleep .05; done
grep -q begun second.log || fail "the task was not handed on at once"
start_worker idle --ack-wait 1
empty
! grep -q begun idle.log || fail "two had one task: $(cat idle.log)"
[ -e long.store.parts/1-of-1.json ] || fail "$(cat second.log)"
kill_worker idle TERM
kill_worker second TERM

# What cannot be done is given up, with its reason; what is wrong with the command itself, at once.
printf '[[task]]\nrun = ["ingest", "bad.store", "missing", "--force"]\n[[task]]\nrun = ["ingest", "bad.store", "clips", "--colour", "red"]\n' > bad.toml
queue --submit bad.toml > /dev/null
start_worker bad --until-empty --tries 2
wait "${workers[bad]}" || fail "$(cat bad.log)"
[ "$(grep -c "failed, 1 of 2 times: 1/1 of freshet ingest bad.store missing" bad.log)" = 1 ] || fail "$(cat bad.log)"
[ "$(grep -c "begun: 1/1 of freshet ingest bad.store clips" bad.log)" = 1 ] || fail "$(cat bad.log)"
queue --status > status.log
grep -q "0 waiting, 0 in hand, 2 given up" status.log || fail "$(cat status.log)"
grep -q "given up: 1/1 of freshet ingest bad.store missing --force: missing: there is no such file or folder" status.log || fail "$(cat status.log)"
cp -r clips missing
queue --submit bad.toml > /dev/null
mkdir elsewhere
(cd elsewhere && exec "$FRESHET" work --queue "nats://127.0.0.1:$port" --folder "$here" --until-empty -j 1) > good.log 2>&1 &
workers[good]=$!
wait "${workers[good]}" || fail "$(cat good.log)"
[ "$("$FRESHET" ingest bad.store missing --force --gather 2>&1 | grep -c "1 shards, $shards added")" = 1 ] || fail "$(cat good.log)"
grep -q " 1 given up" <(queue --status) || fail "$(queue --status)"
left=$(find tmp -mindepth 1)
[ -z "$left" ] || fail "left of what was killed: $left"
kill_server
for process in /proc/[0-9]*; do
  [ "$(readlink "$process/cwd" || true)" != "$here" ] || [ "${process#/proc/}" = $$ ] || [ "$(readlink "$process/exe")" != "$FRESHET" ] ||
    fail "still running: $(tr '\0' ' ' < "$process/cmdline")"
done
for kind in "${!kills_of[@]}"; do echo "$kind: ${kills_of[$kind]}"; done
echo "ok: $killed kills in $rounds rounds, $shards shards of clips, 4 animations"
