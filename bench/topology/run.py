#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What --keep-topology costs: the table topology of docs/log/numerics.md (bench/results.py).

    cmake --preset release && ninja -C build/release meshlode_cli
    MESHLODE_MODELS=DIR bench/topology/run.py

Each scene is built with and without, in turns. Triangles are those of uniform cuts at equal stored errors, 24 of them evenly in
the logarithm from 1e-4 to 1e-2 of the diagonal: the geometric mean of the shares. One seed of the partition: another draw moves a
share by some percent.
"""
import argparse
import json
import math
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ERRORS = [10 ** (-4 + 2 * i / 23) for i in range(24)]
WAYS = [[], ["--keep-topology"]]


def user_seconds():
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime


def build(meshlode, scene, out, options):
    before = user_seconds()
    subprocess.run([meshlode, "build", scene, "-o", out, "--quiet", *options], check=True)
    return user_seconds() - before


def triangles_at(meshlode, asset, error, cut):
    command = [meshlode, "extract", asset, "--error", f"{error:.9g}", "--relative", "-o", cut, "--format", "json"]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)["triangles"]


def crowded(meshlode, asset, scene):
    command = [meshlode, "verify", asset, "--source", scene, "--cuts", "100", "--cameras", "1", "--deviation-cuts", "1",
               "--format", "json"]
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)["crowded_edges"]


def row_of(meshlode, scene, rounds, folder):
    assets = [folder / "free.lode", folder / "kept.lode"]
    seconds = [[], []]
    for _ in range(rounds):
        for way in (0, 1):
            seconds[way].append(build(meshlode, scene, assets[way], WAYS[way]))
    logs, before = [], None
    for error in ERRORS:
        counts = tuple(triangles_at(meshlode, asset, error, folder / "cut.glb") for asset in assets)
        if counts != before:  # a cut that is the same as the one before says nothing new
            logs.append(math.log(counts[1] / counts[0]))
        before = counts
    info = [json.loads(subprocess.run([meshlode, "info", asset, "--format", "json"], check=True, capture_output=True,
                                      text=True).stdout) for asset in assets]
    roots = [sum(mesh["root_triangles"] for mesh in one["meshes"]) for one in info]
    edges = [crowded(meshlode, asset, scene) for asset in assets]
    fastest = [min(one) for one in seconds]
    return (f"| {scene.stem} | {100 * (math.exp(sum(logs) / len(logs)) - 1):+.1f}% | {100 * (math.exp(min(logs)) - 1):+.1f}% … "
            f"{100 * (math.exp(max(logs)) - 1):+.1f}% | {roots[0]:,} → {roots[1]:,} | {fastest[0]:.2f} → {fastest[1]:.2f} | "
            f"{edges[0]['level0']:,} | {edges[0]['most']:,} → {edges[1]['most']:,} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default="build/release")
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    models = Path(os.environ["MESHLODE_MODELS"])
    scenes = [ROOT / "data" / f"{name}.glb" for name in ("rock", "crystal", "terrain", "foliage")]
    scenes += [models / f"{name}.glb" for name in ("spot", "fandisk", "homer", "cheburashka", "rocker-arm", "bunny", "dragon")]
    table = ["| scene | triangles at equal error | at single errors | triangles of the roots | CPU seconds | "
             "crowded edges of level 0 | of the worst cut |", "| --- | ---: | ---: | ---: | ---: | ---: | ---: |"]
    with tempfile.TemporaryDirectory() as folder:
        for scene in scenes:
            table.append(row_of(ROOT / options.build / "meshlode", scene, options.rounds, Path(folder)))
            print(table[-1], file=sys.stderr, flush=True)
    print("\n".join(table))


if __name__ == "__main__":
    main()
