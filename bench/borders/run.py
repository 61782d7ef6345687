#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What --lock-borders costs in triangles: the table borders of docs/log/quality.md (bench/results.py).

    cmake --preset release && ninja -C build/release meshlode_cli
    MESHLODE_MODELS=DIR bench/borders/run.py

Each scene is built with and without. Triangles are those of uniform cuts at equal stored errors, as shares of the diagonal, and of
the coarsest cut.
"""
import argparse
import json
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
ERRORS = [1e-3, 3e-3, 1e-2]
WAYS = [[], ["--lock-borders"]]


def write_tile(path, cells=96):
    """A square of terrain, one a side."""
    side = cells + 1
    with open(path, "w", encoding="ascii") as out:
        for j in range(side):
            for i in range(side):
                x, y = i / cells, j / cells
                z = 0.12 * math.sin(5 * x) * math.cos(4 * y) + 0.03 * math.sin(31 * x + 17 * y)
                out.write(f"v {x:.9g} {y:.9g} {z:.9g}\n")
        for j in range(cells):
            for i in range(cells):
                a = j * side + i + 1
                out.write(f"f {a} {a + 1} {a + side + 1}\nf {a} {a + side + 1} {a + side}\n")


def run_json(*command):
    return json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)


def row_of(meshlode, name, scene, folder):
    cells, infos, locked = [[] for _ in ERRORS], [], 0
    for options in WAYS:
        asset = folder / "asset.lode"
        subprocess.run([meshlode, "build", scene, "-o", asset, "--quiet", *options], check=True)
        info = run_json(meshlode, "info", asset, "--format", "json")
        infos.append(info)
        for cell, error in zip(cells, ERRORS):
            cell.append(run_json(meshlode, "extract", asset, "--error", f"{error:.9g}", "--relative", "-o",
                                 folder / "cut.glb", "--format", "json")["triangles"])
        locked += sum(int(one["reason"].split()[0]) for one in info["plan"] if one["what"].endswith(": borders"))
    coarsest = [sum(mesh["root_triangles"] for mesh in info["meshes"]) for info in infos]
    bytes_of = [info["geometry_bytes"] for info in infos]
    return (f"| {name} | {infos[0]['totals']['source_triangles']:,} | {locked:,} | " +
            " | ".join(f"{free:,} → {kept:,}" for free, kept in cells) +
            f" | {coarsest[0]:,} → {coarsest[1]:,} | {100 * (bytes_of[1] / bytes_of[0] - 1):+.1f}% |")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default="build/release")
    options = parser.parse_args()
    table = ["| scene | triangles | locked vertices | " + " | ".join(f"at {error:g}" for error in ERRORS) +
             " | coarsest cut | bytes |", "| --- | ---: | ---: | " + "---: | " * len(ERRORS) + "---: | ---: |"]
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        write_tile(folder / "tile.obj")
        scenes = [("tile, 96 × 96", folder / "tile.obj"), ("terrain (data)", ROOT / "data" / "terrain.glb")]
        if "MESHLODE_MODELS" in os.environ:
            models = Path(os.environ["MESHLODE_MODELS"])
            scenes += [("terrain", models / "terrain" / "terrain.glb"), ("Mountains", models / "terrain" / "Mountains.gltf")]
        for name, scene in scenes:
            table.append(row_of(ROOT / options.build / "meshlode", name, scene, folder))
            print(table[-1], file=sys.stderr, flush=True)
    print("\n".join(table))


if __name__ == "__main__":
    main()
