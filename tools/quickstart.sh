#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# quickstart.sh [SCENE]: installs what is missing, builds meshlode, turns a scene into an asset, prints its statistics,
# compares it with its source, draws a picture of a LOD cut and writes a page that shows the asset in a browser.
set -euo pipefail
case ${1:-} in -h | --help) sed -n '3,4s/^# //p' "$0"; exit ;; esac
cd "$(dirname "$0")/.."
echo "meshlode: quickstart in $PWD"
scene=${1:-data/rock.glb}
jobs=${JOBS:-$(nproc)}
build=build/release

tools/install-deps.sh
cmake --preset release -DMESHLODE_TESTS=OFF -DMESHLODE_UNITY=ON >/dev/null
ninja -C "$build" -j "$jobs" meshlode_cli
meshlode=$build/meshlode

mkdir -p out
name=$(basename "${scene%.*}")
asset=out/$name.lode
picture=out/$name.png
page=out/$name.html
run() { echo; echo "\$ $*"; "$@"; }
run "$meshlode" build "$scene" -o "$asset"
run "$meshlode" info "$asset" --html "$page"
run "$meshlode" verify "$asset" --source "$scene"
run "$meshlode" render "$asset" -o "$picture" --size 1280x720 --pixel-error 4 --view clusters
echo
echo "program  $PWD/$meshlode"
echo "asset    $PWD/$asset"
echo "picture  $PWD/$picture   (a LOD cut at 4 pixels, a colour per cluster)"
echo "page     $PWD/$page   (the asset in a browser: its DAG, its cuts, its bytes)"
