# SPDX-License-Identifier: GPL-3.0-or-later
# An interrupt ends a batch that waits for the reader of a pipe, and its manifest tells of every asset that is there.
cp "$DATA/city.glb" a.glb
mkfifo pipe
# stop SIGNAL OPTION: a build that is sent a signal once its asset is there and it waits for the pipe
stop() {
  rm -f a.lode m.json
  env "--default-signal=$1" timeout -k 1 20 "$MESHLODE" build --quiet a.glb -o a.lode "${@:2}" 2>../stderr &
  local child=$! status
  for _ in $(seq 500); do [ -e a.lode ] && break; sleep 0.02; done
  sleep 0.3
  { kill "-$1" "$child"; wait "$child"; status=$?; } 2>../killed
  echo "$*: exit $status, $(cat ../stderr)"
}
for option in report junit depfile manifest; do stop INT --$option pipe; done
stop TERM --report pipe --manifest m.json
grep -E '"(complete|status|exit_code|error)"' m.json
files
