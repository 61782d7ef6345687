#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# page_of_sweep.sh MESHLODE SAMPLE_REPORT SCENE: the page that sweep writes from what it holds, and the one that is made of
# the sweep.json beside it, are the same.
set -euo pipefail
meshlode=$(realpath "$1"); sample_report=$(realpath "$2"); scene=$(realpath "$3")
work=$(mktemp -d); trap 'rm -rf "$work"' EXIT
cd "$work"
"$meshlode" sweep "$scene" -o swept --quiet --rounds 1 --samples 500 --budget 2s
"$sample_report" read swept/sweep.json
cmp read/index.html swept/index.html
diff -r read/plots swept/plots
echo "PASSED"
