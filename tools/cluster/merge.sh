#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# merge.sh FOLDER: the job after the array that submit.sh submits. Exits with the batch's code, or 6 where shards are missing:
# `submit.sh --resume FOLDER` builds these.
set -uo pipefail
state=$1
mapfile -d '' -t batch <"$state/batch"
program=${batch[0]} folder=${batch[1]} shards=${batch[2]}
cd "$folder" || exit 2
rm -f "$state/manifest.json"
manifests=()
for ((i = 1; i <= shards; ++i)); do
  [ ! -e "$state/shard-$i.json" ] || manifests+=("$state/shard-$i.json")
done
if [ ${#manifests[@]} -eq 0 ]; then
  echo "merge.sh: no shard of $shards is complete"
  exit 6
fi
"$program" merge "${manifests[@]}" -o "$state/manifest.json"
