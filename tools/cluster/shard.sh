#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# shard.sh FOLDER RETRIES: one task of the array that submit.sh submits: builds shard $SLURM_ARRAY_TASK_ID of the batch in
# FOLDER. Exits with the program's code.
set -uo pipefail
state=$1 retries=$2 shard=$SLURM_ARRAY_TASK_ID
mapfile -d '' -t batch <"$state/batch"
program=${batch[0]} folder=${batch[1]} shards=${batch[2]} arguments=("${batch[@]:3}")
cd "$folder" || exit 2
# As many threads as Slurm gave, where nobody asked for another number.
cpus=${SLURM_CPUS_PER_TASK:-${SLURM_CPUS_ON_NODE:-}}
if [ -n "$cpus" ] && [[ " ${arguments[*]} " != *" --jobs"[\ =]* ]]; then
  arguments+=(--jobs "$cpus")
fi
[ ! -e "$state/last.json" ] || arguments+=(--shard-costs "$state/last.json")
for ((attempt = 0; ; ++attempt)); do
  "$program" build "${arguments[@]}" --shard "$shard/$shards" --manifest "$state/shard-$shard.json"
  status=$?
  # What the program refused it will refuse again. Signals that ask for an end come from Slurm or a person. The others, such
  # as a kernel's that is out of memory, may have been bad luck.
  case $status in
    129 | 130 | 143) exit $status ;;
    *) [ $status -ge 128 ] && [ "$attempt" -lt "$retries" ] || exit $status ;;
  esac
  echo "shard.sh: shard $shard/$shards was ended by signal $((status - 128)); attempt $((attempt + 2)) of $((retries + 1))"
done
