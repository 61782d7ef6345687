# SPDX-License-Identifier: GPL-3.0-or-later
# Signals, pipes that nobody reads, full devices and limits: exit 2, one line, and no file that is not whole.
cp "$DATA/rock.glb" r.glb
cp "$DATA/rock.glb" a.glb
# interrupt SIGNAL ENV_OPTION: a build that is sent a signal once it waits for some, in a thread of its own.
interrupt() {
  : >../stderr
  env "$2" "$MESHLODE" build r.glb -o r.lode --report r.json >../stdout 2>../stderr &
  local child=$! status
  for _ in $(seq 500); do [ "$(ls "/proc/$child/task" | wc -l)" -gt 1 ] && break; sleep 0.02; done
  kill "-$1" "$child"
  wait "$child"; status=$?
  echo "$1, $2: exit $status, $(grep -c '^meshlode: ' ../stderr) error line(s), of them named: $(grep -c "interrupted by SIG$1" ../stderr)"
}
for signal in INT TERM HUP; do interrupt $signal "--default-signal=$signal"; done
files
interrupt INT --ignore-signal=INT
rm r.lode r.json
"$MESHLODE" build --quiet r.glb -o r.lode &
{ kill -KILL $!; wait $!; } 2>../stderr  # the shell tells of a killed child, wherever that finds it
# What a killed writer leaves has such a name; any command that writes into the folder removes it.
for verb in "build --quiet a.glb -o a.lode" "render a.lode -o a.png --size 16x16" "extract a.lode --error 0 -o cut.glb"; do
  printf 'half' >.meshlode-0123456789abcdef.tmp
  # shellcheck disable=SC2086
  code $verb
  [ -e .meshlode-0123456789abcdef.tmp ] && echo "left behind"
done
# told VERB…: the exit code and the number of lines where nobody reads stdout, or it is full
told() {
  local to
  { sleep 0.2; "$MESHLODE" "$@" 2>../stderr; echo "exit $?, $(grep -c '^meshlode: ' ../stderr) line(s)" >../told; } | true
  echo "unread: $* $(cat ../told)"
  "$MESHLODE" "$@" 2>../stderr >/dev/full; echo "full: $* exit $?, $(grep -c '^meshlode: ' ../stderr) line(s)"
}
told --help
told --version
told build --help
told info a.lode
told validate a.lode
told verify a.lode --source a.glb --cuts 1 --cameras 1
told render a.lode -o a.png --size 16x16
told extract a.lode --error 0 -o cut.glb
told build --quiet --format json a.glb
code build --quiet a.glb -o /dev/full
code render a.lode -o /dev/full --size 16x16
(
  ulimit -f 8
  code build --quiet a.glb -o limited.lode
  code extract a.lode --error 0 -o limited.glb
)
rm -f r.lode
files
