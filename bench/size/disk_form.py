#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds models with each disk codec and prints what the whole file weighs, as the tables of docs/log/size.md.

    bench/size/disk_form.py build/release/meshlode MODELS DATA [name …]

MODELS is the folder of the models, DATA that of the generated scenes; what is not there is left out. Bytes are those of
geometry (tables and pages, without images), per source triangle; `file` has everything."""
import json
import os
import subprocess
import sys
import tempfile

BEVY = ["--attributes", "all", "--normal-error", "0.1", "--uv-error", str(1 / 16384)]
CODECS = ["none", "strips"]
# name, file, options; {diagonal} is the diagonal of the model's largest mesh
RUNS = [
    ("bunny, Bevy's accuracy", "bunny.glb", BEVY + ["--grid", "0.000625"]),
    ("dragon, step 1e-4 of the diagonal", "dragon.glb", ["--attributes", "all", "--normal-error", "0.1", "--grid", "0.0000268"]),
    ("bunny, defaults", "bunny.glb", ["--attributes", "all"]),
    ("spot, defaults", "spot.glb", ["--attributes", "all"]),
    ("FlightHelmet, defaults", "FlightHelmet/FlightHelmet.gltf", []),
]


def build(tool, source, codec, options, folder):
    asset = os.path.join(folder, "a.lode")
    subprocess.run([tool, "build", source, "-o", asset, "--quiet", "--codec", codec, *options], check=True)
    done = subprocess.run([tool, "info", asset, "--format", "json"], check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


def main():
    tool, models, data, names = sys.argv[1], sys.argv[2], sys.argv[3], sys.argv[4:]
    runs = [(name, os.path.join(models, file), options) for name, file, options in RUNS]
    runs += [(f"{file[:-4]}, defaults", os.path.join(data, file), []) for file in sorted(os.listdir(data)) if file.endswith(".glb")]
    print("| model | source triangles | stored | " + " | ".join(f"`{codec}`" for codec in CODECS) + " | `strips`, per stored triangle |")
    print("| --- " * (len(CODECS) + 4) + "|")
    for name, source, options in runs:
        if not os.path.exists(source) or (names and not any(name.startswith(n) for n in names)):
            continue
        cells = []
        with tempfile.TemporaryDirectory() as folder:
            for codec in CODECS:
                info = build(tool, source, codec, options, folder)
                count, stored = info["totals"]["source_triangles"], info["totals"]["stored_triangles"]
                cells.append(f"{info['geometry_bytes'] / count:.2f}")
                if codec == "strips":
                    each = info["geometry_bytes"] / stored
        print(f"| {name} | {count:,} | {stored / count:.3f}× | " + " | ".join(cells) + f" | {each:.2f} |", flush=True)


if __name__ == "__main__":
    main()
