#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What each promise keeps and costs: a table, and pictures side by side, over cameras around a few scenes.

  ninja -C build/release meshlode_cli meshlode_generate bench_promise
  MESHLODE_MODELS=DIR bench/promise/run.py --document      # docs/log/quality.md, docs/pictures/promise-*.png

Every scene is built three times, `--promise position`, `texels` and `appearance`. `bench_promise` selects by each asset's
own promise from 50 cameras around the scene and measures the cuts against the source. Figures of scenes are kept in --out:
run again, it goes on; remove it to begin anew.
"""
import argparse
import json
import math
import os
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BEGIN, END = "<!-- promise: begin -->", "<!-- promise: end -->"
PROMISES = ["position", "texels", "appearance"]
PICTURES = ["FlightHelmet", "painted-tree"]


def measure(build, scene, folder, options):
    name = scene.stem
    kept = folder / f"{name}.json"
    if kept.exists():
        return json.loads(kept.read_text())
    command, seconds = [str(build / "bench/promise/bench_promise"), str(scene), "--orbits", str(options.orbits),
                        "--jobs", str(options.jobs)], {}
    for promise in PROMISES:
        asset = folder / f"{name}-{promise}.lode"
        before = os.times()
        subprocess.run([str(build / "meshlode"), "build", str(scene), "-o", str(asset), "--promise", promise, "--jobs",
                        str(options.jobs), "--quiet"], check=True)
        after = os.times()
        seconds[promise] = after.children_user - before.children_user
        command += [f"--{promise}", str(asset)]
    if name in PICTURES:
        command += ["--pictures", str(folder / f"promise-{name}.png")]
    started = time.time()
    found = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    for row in found["promises"]:
        row["build_user_seconds"] = seconds[row["promise"]]
    kept.write_text(json.dumps(found, indent=1))
    print(f"{name}: {time.time() - started:.0f} s", file=sys.stderr, flush=True)
    return found


def number(value, digits):
    return "–" if value is None else f"{value:,.{digits}f}"


def table_of(results):
    lines = ["| scene | promise | triangles | bytes of a cut | file | drift: position | texels | appearance | FLIP | PSNR | build |",
             "| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"]
    for found in results:
        for i, row in enumerate(found["promises"]):
            drift = row["drift_px"]
            cells = [f"`{found['scene']}`" if i == 0 else "", row["promise"], number(row["triangles"], 0),
                     number(row["bytes"], 0), number(row["file_bytes"], 0)]
            for unit in PROMISES:
                text = number(drift.get(unit), 2)
                cells.append(f"**{text}**" if unit == row["promise"] else text)
            psnr = row["psnr_db"]
            cells += [number(row["flip"], 4), "equal" if psnr is None or math.isinf(psnr) else f"{psnr:.1f} dB",
                      f"{row['build_user_seconds']:.1f} s"]
            lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default="build/release")
    parser.add_argument("--out", default="builder/promise", help="folder of assets and figures")
    parser.add_argument("--orbits", type=int, default=50)
    parser.add_argument("--jobs", type=int, default=0, help="threads; 0 is one per core")
    parser.add_argument("--document", action="store_true", help="write docs/log/quality.md and docs/pictures/promise-*.png")
    options = parser.parse_args()
    build, folder = ROOT / options.build, ROOT / options.out
    folder.mkdir(parents=True, exist_ok=True)
    models = Path(os.environ["MESHLODE_MODELS"])
    tree = folder / "painted-tree.glb"
    if not tree.exists():
        subprocess.run([str(build / "meshlode_generate"), str(folder), "--painted"], check=True, stdout=subprocess.DEVNULL)
    scenes = [models / "spot.glb", ROOT / "data" / "terrain.glb", models / "FlightHelmet" / "FlightHelmet.gltf", tree]
    results = [measure(build, scene, folder, options) for scene in scenes]
    text = table_of(results)
    if not options.document:
        print(text)
        return
    shown = []
    for name in PICTURES:
        picture = folder / f"promise-{name}.png"
        (ROOT / "docs" / "pictures" / picture.name).write_bytes(picture.read_bytes())
        shown.append(f"![{name}: full resolution, and cuts by position, texels and appearance](../pictures/{picture.name})")
    page = ROOT / "docs/log/quality.md"
    before, _, rest = page.read_text().partition(BEGIN)
    _, _, after = rest.partition(END)
    page.write_text(f"{before}{BEGIN}\n\n{text}\n\n" + "\n\n".join(shown) + f"\n\n{END}{after}")


if __name__ == "__main__":
    main()
