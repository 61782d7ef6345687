#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# slurm_test.sh MESHLODE JSON_CHECK: a batch of 30 files as an array of 4 shards on a real Slurm: one node, its daemons (munged,
# slurmctld, slurmd) started here from a temporary folder, as whoever runs the test, and ended with it. One shard's program is
# killed and one shard is cancelled, each in the middle: assets and manifest must be those of a local batch all the same.
# Skipped, aloud, where Slurm is not installed; with MESHLODE_REQUIRE_SLURM=1 that is a failure.
set -uo pipefail
program=$(realpath "$1"); json_check=$(realpath "$2")
repository=$(cd "$(dirname "$0")/../.." && pwd)
PATH=$PATH:/usr/sbin:/sbin
unset MESHLODE_CACHE
skip() {
  [ "${MESHLODE_REQUIRE_SLURM:-}" != 1 ] || { echo "FAILED: $*, and MESHLODE_REQUIRE_SLURM=1"; exit 1; }
  echo "SKIPPED: $*"; exit 77
}
for tool in munged slurmctld slurmd sbatch squeue sinfo scancel scontrol python3 setpriv; do
  command -v $tool >/dev/null || skip "no $tool (Debian: slurm-wlm munge)"
done

state='state at 100%a'  # no character of a folder's name means anything
work=$(mktemp -d /tmp/meshlode-slurm.XXXXXX); chmod 755 "$work"
daemons=()
# The folder's processes; zombies, which the machine's init has yet to bury, have no environment.
# shellcheck disable=SC2016
processes() { env -i -C / bash -c 'grep -lsF "$1" /proc/[0-9]*/environ | cut -d/ -f3 | tr "\n" " "' - "$work"; }
is_alone() { [ -z "$(processes)" ]; }
finish() {
  local status=$? pid
  if [ $status -ne 0 ] && [ ${#daemons[@]} -eq 3 ]; then  # nothing of ours is left running
    timeout 10 scancel -u "$(id -un)" 2>/dev/null
    for _ in $(seq 50); do [ -n "$(timeout 5 squeue -h 2>/dev/null)" ] || break; sleep 0.2; done
  fi
  for ((i = ${#daemons[@]} - 1; i >= 0; --i)); do
    pid=${daemons[i]}
    kill "$pid" 2>/dev/null
    for _ in $(seq 50); do kill -0 "$pid" 2>/dev/null || break; sleep 0.1; done
    kill -KILL "$pid" 2>/dev/null
  done
  wait 2>/dev/null
  # All that was started here has the folder in its environment.
  within 10 is_alone || { echo "FAILED: left running: $(processes)"; [ $status -ne 0 ] || status=1; }
  if [ "${KEEP:-0}" = 1 ]; then echo "kept: $work"; else rm -rf "$work"; fi
  exit $status
}
trap finish EXIT
trap 'exit 143' TERM INT HUP
fail() {
  echo "FAILED: $*"
  for log in munged slurmctld slurmd; do
    echo "-- $log"
    grep -vs 'Unauthorized credential' "$work/log/$log" | tail -n 15
  done
  tail -n 20 "$work/cluster/$state"/log/* 2>/dev/null
  exit 1
}
# within SECONDS COMMAND…: asks every 0.2 s until the command succeeds
within() {
  local end=$((SECONDS + $1)); shift
  until "$@"; do [ $SECONDS -lt $end ] || return 1; sleep 0.2; done
}

# A Slurm of one node.
mkdir -p "$work"/{munge,ctld,slurmd,log}
chmod 700 "$work/munge"
(umask 077; head -c 1024 /dev/urandom >"$work/munge/key")
mkdir "$work/socket"; chmod 755 "$work/socket"
node=$(uname -n); node=${node%%.*}
read -r port_1 port_2 < <(python3 -c '
import socket
sockets = [socket.socket() for _ in range(2)]
for s in sockets: s.bind(("127.0.0.1", 0))
print(*(s.getsockname()[1] for s in sockets))')
export SLURM_CONF=$work/slurm.conf
cat >"$SLURM_CONF" <<CONF
ClusterName=meshlode
SlurmctldHost=$node(127.0.0.1)
SlurmctldPort=$port_1
SlurmdPort=$port_2
SlurmUser=$(id -un)
SlurmdUser=$(id -un)
AuthType=auth/munge
AuthInfo=socket=$work/socket/munge,cred_expire=5
CredType=cred/munge
StateSaveLocation=$work/ctld
SlurmdSpoolDir=$work/slurmd
SlurmctldPidFile=$work/ctld.pid
SlurmdPidFile=$work/slurmd.pid
SlurmctldLogFile=$work/log/slurmctld
SlurmdLogFile=$work/log/slurmd
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MpiDefault=none
KillWait=2
ReturnToService=2
SlurmdParameters=config_overrides
SchedulerParameters=batch_sched_delay=0,sched_interval=2
NodeName=$node NodeAddr=127.0.0.1 CPUs=4 Boards=1 SocketsPerBoard=1 CoresPerSocket=4 ThreadsPerCore=1 State=UNKNOWN
PartitionName=all Nodes=$node Default=YES MaxTime=INFINITE State=UP
CONF
# Should this script be killed, they are too.
started() { exec setpriv --pdeathsig TERM "$@"; }
started munged --foreground --key-file="$work/munge/key" --socket="$work/socket/munge" --pid-file="$work/munge/pid" \
       --log-file="$work/log/munged.log" --seed-file="$work/munge/seed" --origin=127.0.0.1 >"$work/log/munged" 2>&1 &
daemons+=($!)
within 20 test -S "$work/socket/munge" || fail "munged does not start"
started slurmctld -D >"$work/log/slurmctld.out" 2>&1 & daemons+=($!)
is_up() { scontrol ping 2>/dev/null | grep -q ' is UP'; }
within 20 is_up || fail "slurmctld does not answer"
started slurmd -D >"$work/log/slurmd.out" 2>&1 & daemons+=($!)
is_idle() { [ "$(sinfo -h -o %T 2>/dev/null)" = idle ]; }
within 60 is_idle || fail "the node is not idle but $(sinfo -h -o '%T %E' 2>&1)"
echo "Slurm: $(scontrol --version), as $(id -un), $(sinfo -h -o '%D node(s), %c CPUs')"

# 30 files: terrains of all sizes below two folders, a scene with a texture, a few of data/.
# terrain SIDE SEED: an OBJ of 2 SIDE^2 triangles
terrain() {
  awk -v n="$1" -v seed="$2" 'BEGIN {
    srand(seed)
    for (y = 0; y <= n; ++y) for (x = 0; x <= n; ++x) printf "v %d %d %.4f\n", x, y, rand()
    for (y = 0; y < n; ++y) for (x = 0; x < n; ++x) {
      a = y * (n + 1) + x + 1
      printf "f %d %d %d\nf %d %d %d\n", a, a + 1, a + n + 2, a, a + n + 2, a + n + 1
    }
  }'
}
mkdir -p "$work/local/in/deep"
cd "$work/local" || exit 1
for i in $(seq 1 14); do terrain $((20 + 3 * i)) "$i" >"in/$i.obj"; done
for i in $(seq 15 27); do terrain $((10 + i)) "$i" >"in/deep/$i.obj"; done
for name in crystal rock city; do cp "$repository/data/$name.glb" in/deep; done
[ "$(find in -type f | wc -l)" = 30 ] || fail "not 30 files"
mkdir "$work/cluster" && cp -r in "$work/cluster/in"
settings=(--preset fast)
"$program" build in -O out "${settings[@]}" --manifest manifest.json --quiet || fail "the local batch"

# What stands for the program in the array: shard 2 is killed after its second file, shard 3 then stops until it is cancelled;
# each once. Stopped first, so that no program is too quick for it.
cat >"$work/meshlode" <<WRAPPER
#!/usr/bin/env bash
echo "\$*" >>$work/words
case " \$* " in
  *" --shard 2/4 "*) mark=$work/killed ;;
  *" --shard 3/4 "*) mark=$work/waiting ;;
  *) exec "$program" "\$@" ;;
esac
[ ! -e "\$mark" ] || exec "$program" "\$@"
exec 3< <(echo "\$BASHPID"; exec "$program" "\$@" 2>&1)
read -r pid <&3
while read -r line <&3; do
  echo "\$line"
  case \$line in "[2/"*) kill -STOP "\$pid"; break ;; esac
done
echo "\$line" >"\$mark"
if [ \$mark = $work/waiting ]; then cat <&3; exit 2; fi
kill -KILL "\$pid"
cat <&3
exit 137
WRAPPER
chmod +x "$work/meshlode"

cd "$work/cluster" || exit 1
export MESHLODE=$work/meshlode
submit=$repository/tools/cluster/submit.sh
id_of() { sed -n "s/^$1 //p" <<<"$2"; }
is_over() { [ -z "$(squeue -h ${1:+-j "$1"} 2>/dev/null)" ]; }  # of all jobs where no id is given
code_of() { scontrol -o show job "$1" | sed -n 's/.* ExitCode=\([0-9]*\):.*/\1/p'; }

for refused in "--junit j.xml" "--report=r.json" "--manifest m.json" "--shard 1/2" "--dry-run" "--fail-fast"; do
  # shellcheck disable=SC2086
  "$submit" --shards 4 refused in -O out $refused >"$work/refused" 2>&1 && fail "submit.sh takes $refused"
  grep -q '^submit.sh: --' "$work/refused" || fail "submit.sh does not say why it refuses $refused: $(cat "$work/refused")"
done
if [ -e refused ] || ! is_over ''; then fail "something was submitted"; fi

first=$("$submit" --shards 4 --sbatch --cpus-per-task=1 "$state" in -O out "${settings[@]}" --cache cache) || fail "submit.sh"
echo "$first"
array=$(id_of array "$first") merge=$(id_of merge "$first")
within 180 test -e "$work/waiting" || fail "shard 3 does not begin"
scancel "${array}_3"
within 300 is_over "$array" || fail "the array is not over: $(squeue -h 2>&1)"
within 60 is_over "$merge" || fail "the merge is not over: $(squeue -h 2>&1)"
[ -e "$work/killed" ] || fail "shard 2 was not killed"
echo "killed at: $(cat "$work/killed")"
echo "cancelled at: $(cat "$work/waiting")"
grep -q 'shard 2/4 was ended by signal 9; attempt 2 of 3' "$state"/log/shard-2.txt || fail "shard 2 was not begun again"
[ -e "$state"/shard-2.json ] || fail "shard 2 was not completed by its second attempt"
[ ! -e "$state"/shard-3.json ] || fail "the cancelled shard has a manifest"
[ "$(code_of "$merge")" = 6 ] || fail "merging without shard 3 exits with $(code_of "$merge")"
grep -q 'shard 3 of 4 is missing' "$state"/log/merge.txt || fail "the merge does not say what is missing"
[ ! -e "$state"/manifest.json ] || fail "there is a manifest without shard 3"
[ "$(find out -name '*.lode' | wc -l)" -lt 30 ] || fail "nothing was missing"

second=$("$submit" --resume "$state") || fail "submit.sh --resume"
echo "$second"
array=$(id_of array "$second") merge=$(id_of merge "$second")
[ "$(scontrol -o show job "$array" | grep -o 'ArrayTaskId=[0-9,-]*' | sort -u)" = ArrayTaskId=3 ] || fail "not shard 3 alone"
within 300 is_over "$array" || fail "the second array is not over"
within 60 is_over "$merge" || fail "the second merge is not over"
[ "$(code_of "$merge")" = 0 ] || fail "the second merge exits with $(code_of "$merge"): $(cat "$state"/log/merge.txt)"

# A CPU each: asked for at first, Slurm's default when resumed.
[ "$(grep -c -- ' --jobs 1 --shard ./4 ' "$work/words")" = 6 ] || fail "threads: $(cat "$work/words")"

# Seconds are the machine's, and whether an asset was built or taken from the cache depends on what was killed when.
same() { sed -E -e 's/^(      "(seconds|processor_seconds|peak_memory_bytes)": ).*/\1M,/' \
  -e 's/^(        "(use|reason|meshes)": ).*/\1C/' -e 's/^(      "status": ")(cached|unchanged)"/\1built"/' "$1"; }
"$json_check" "$repository/docs/schemas/manifest.schema.json" <"$state"/manifest.json || fail "the manifest's schema"
diff <(same ../local/manifest.json) <(same "$state"/manifest.json) || fail "the manifest is not that of a local batch"
diff -r ../local/out out || fail "the assets are not those of a local batch"
echo "taken from the cache or found unchanged: $(grep -c '"status": "\(cached\|unchanged\)"' "$state"/manifest.json) of 30"
[ "$(grep -c '"status": "\(cached\|unchanged\)"' "$state"/manifest.json)" -ge 2 ] || fail "what was finished was built again"

# Nothing is left to do: no array, and the merge says the same.
third=$("$submit" --resume "$state") || fail "submit.sh --resume"
[ -z "$(id_of array "$third")" ] || fail "complete shards are built again"
merge=$(id_of merge "$third")
within 60 is_over "$merge" || fail "the third merge is not over"
diff <(same ../local/manifest.json) <(same "$state"/manifest.json) || fail "merged again it is another manifest"

# The next batch in the folder is balanced by what this one took.
printf 'first\n' >"$work/words"
fourth=$("$submit" --shards 4 "$state" in -O out "${settings[@]}") || fail "submit.sh, the next batch"
within 300 is_over "$(id_of array "$fourth")" || fail "the fourth array is not over"
merge=$(id_of merge "$fourth")
within 60 is_over "$merge" || fail "the fourth merge is not over"
[ "$(grep -c -- "--shard-costs $PWD/$state/last.json" "$work/words")" = 4 ] || fail "not balanced: $(cat "$work/words")"
diff <(same ../local/manifest.json) <(same "$state"/manifest.json) || fail "balanced anew it is another manifest"
echo "PASSED: 30 files, 4 shards, one killed and one cancelled: as a local batch"
