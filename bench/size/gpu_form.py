#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds models and prints what each stream of the decoded pages weighs, as the tables of docs/log/size.md.

    bench/size/gpu_form.py build/release/meshlode MODELS [name …]

MODELS is the folder of the models; a model that is not there is left out. Bytes are per source triangle.
"""
import json
import os
import subprocess
import sys
import tempfile

BEVY = ["--attributes", "all", "--normal-error", "0.1", "--uv-error", str(1 / 16384)]
# name, file, options; {diagonal} is the diagonal of the model's largest mesh
RUNS = [
    ("bunny, Bevy's accuracy", "bunny.glb", BEVY + ["--grid", "0.000625"]),
    ("dragon, step 1e-4 of the diagonal", "dragon.glb", ["--attributes", "all", "--normal-error", "0.1", "--grid", "{step}"]),
    ("bunny, defaults", "bunny.glb", ["--attributes", "all"]),
    ("dragon, defaults", "dragon.glb", ["--attributes", "all"]),
    ("spot, defaults", "spot.glb", ["--attributes", "all"]),
    ("homer, defaults", "homer.glb", []),
    ("fandisk, defaults", "fandisk.glb", []),
    ("rocker-arm, defaults", "rocker-arm.glb", []),
    ("cheburashka, defaults", "cheburashka.glb", []),
    ("bunny-three-materials, defaults", "bunny-three-materials.glb", []),
    ("FlightHelmet, defaults", "FlightHelmet/FlightHelmet.gltf", []),
]
STREAMS = ["positions", "normals", "uvs", "colors", "topology", "heads", "materials", "padding"]


def run(tool, *words):
    return subprocess.run([tool, *words], check=True, capture_output=True, text=True).stdout


def info_of(tool, source, options):
    with tempfile.TemporaryDirectory() as folder:
        asset = os.path.join(folder, "a.lode")
        run(tool, "build", source, "-o", asset, "--quiet", *options)
        return json.loads(run(tool, "info", asset, "--format", "json"))


def main():
    tool, models, names = sys.argv[1], sys.argv[2], sys.argv[3:]
    print("| model | source triangles | stored | pages | " + " | ".join(STREAMS) + " | tables | bits/tri topology |")
    print("| --- " * (len(STREAMS) + 6) + "|")
    for name, file, options in RUNS:
        source = os.path.join(models, file)
        if not os.path.exists(source) or (names and not any(name.startswith(n) for n in names)):
            continue
        if "{step}" in options:
            diagonal = max(mesh["diagonal"] for mesh in info_of(tool, source, [])["meshes"])
            options = [o.replace("{step}", repr(diagonal * 1e-4)) for o in options]
        info = info_of(tool, source, options)
        totals, byte_map = info["totals"], info["byte_map"]
        count = totals["source_triangles"]
        cells = [name, f"{count:,}", f"{totals['stored_triangles'] / count:.3f}×", f"{byte_map['pages']['total'] / count:.2f}"]
        cells += [f"{byte_map['pages'][s] / count:.2f}" for s in STREAMS]
        cells += [f"{byte_map['table_bytes'] / count:.2f}",
                  f"{8 * byte_map['pages']['topology'] / totals['stored_triangles']:.2f}"]
        print("| " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
