#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# submit.sh --shards N [OPTION]… FOLDER ARGUMENT…   builds a batch as a Slurm job array of N shards, and merges
# submit.sh --resume [OPTION]… FOLDER               those shards alone that are not complete, and merges
#
# ARGUMENTs are those of `meshlode build`: inputs, -O, settings, --cache, --fail-if; not the files that a build writes beside its
# assets. All state is files in FOLDER, which every node sees under this name: what was asked for, shard-I.json once shard I is
# complete, manifest.json once all are, last.json (that of the batch before), log/. Prints the ids: "array ID" (where shards are
# left to do) and "merge ID".
# docs/guides/many-machines.md
#
#   --retries N      times that a shard which a signal ended is started again on its node (2)
#   --sbatch OPTION  of sbatch, for the shards; may be given again: --sbatch --cpus-per-task=8 --sbatch --mem=16G
# The program is $MESHLODE, or meshlode on the PATH.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
fail() { echo "submit.sh: $*" >&2; exit 1; }
usage() { sed -n '3,14s/^# \{0,1\}//p' "$0" >&2; exit 1; }

shards='' retries=2 resume=no options=()
while [ $# -gt 0 ]; do
  case $1 in
    --shards) shards=${2:-}; shift 2 || usage ;;
    --retries) retries=${2:-}; shift 2 || usage ;;
    --sbatch) options+=("${2:-}"); shift 2 || usage ;;
    --resume) resume=yes; shift ;;
    -*) usage ;;
    *) break ;;
  esac
done
[ $# -ge 1 ] || usage
[[ $retries =~ ^[0-9]{1,3}$ ]] || fail "--retries: give a number"
command -v sbatch >/dev/null || fail "no sbatch on the PATH"

for argument in "${@:2}"; do
  case ${argument%%=*} in
    --junit | --report | --depfile) fail "$argument: each shard would write this file over the others'" ;;
    --shard | --shard-costs | --manifest) fail "$argument: is given to each shard by this script" ;;
    --dry-run | --fail-fast) fail "$argument: not for shards" ;;
    -o | --output) fail "$argument: give -O" ;;
  esac
done
mkdir -p "$1/log"
state=$(cd "$1" && pwd); shift
if [ $resume = no ]; then
  [[ $shards =~ ^[1-9][0-9]{0,4}$ ]] || fail "--shards: give a number, 1 to 99999"
  [ $# -ge 1 ] || fail "nothing to build: give the arguments of meshlode build"
  program=$(command -v "${MESHLODE:-meshlode}") || fail "no program ${MESHLODE:-meshlode}"
  rm -f "$state"/shard-*.json
  # What the last batch of this folder took balances this one (build --shard-costs), also when it is resumed.
  [ ! -e "$state/manifest.json" ] || mv "$state/manifest.json" "$state/last.json"
  printf '%s\0' "$(realpath "$program")" "$PWD" "$shards" "$@" >"$state/batch.new"
  mv "$state/batch.new" "$state/batch"
else
  [ -z "$shards" ] && [ $# -eq 0 ] || fail "--resume goes on with what was asked for at first"
  [ -f "$state/batch" ] || fail "$state: nothing was submitted from here"
fi
mapfile -d '' -t batch <"$state/batch"
folder=${batch[1]} shards=${batch[2]}

# Complete is a shard whose manifest is there and has no failure.
left=()
for ((i = 1; i <= shards; ++i)); do
  grep -qs '^  "exit_code": 0,$' "$state/shard-$i.json" || left+=("$i")
done
pattern=${state//%/%%}  # to Slurm a lone % begins a pattern
after=()
if [ ${#left[@]} -gt 0 ]; then
  # --requeue: a shard whose node goes away is begun again elsewhere.
  array=$(sbatch --parsable --requeue --job-name=meshlode --chdir="$folder" --output="$pattern/log/shard-%a.txt" \
                 --open-mode=append --array="$(IFS=,; echo "${left[*]}")" "${options[@]}" \
                 "$here/shard.sh" "$state" "$retries")
  array=${array%%;*}
  echo "array $array"
  after=(--dependency="afterany:$array")
fi
merge=$(sbatch --parsable --requeue --job-name=meshlode-merge --chdir="$folder" --output="$pattern/log/merge.txt" \
               --open-mode=append "${after[@]}" "$here/merge.sh" "$state")
echo "merge ${merge%%;*}"
