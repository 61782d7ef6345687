#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Times whole builds against Debian's gltfpack and writes the tables of docs/log/build-time.md.

    cmake --preset release && ninja -C build/release
    MESHLODE_MODELS=DIR bench/build/run.py --document

Every round runs the yardstick and then each of our programs on the same model, one after the other, so that what else the
machine does falls on all of them alike; the figures are medians of the rounds, a ratio is that of the medians. Wall and CPU
seconds and the peak resident size are those of the whole process. Seconds of stages are those of `--report`, of builds with
one thread, where wall and CPU are the same.
"""
import argparse
import json
import os
import shutil
import statistics
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DATA = ["terrain", "crystal", "rock", "foliage", "city"]
REAL = ["dragon", "bunny", "bunny-three-materials", "cheburashka", "fandisk", "homer", "rocker-arm", "spot"]
# What the yardstick does: half of the triangles, positions and attributes as they are.
YARDSTICK = ["-si", "0.5", "-noq"]
BEGIN, END = "<!-- builds: begin -->", "<!-- builds: end -->"


def run(command):
    """Wall and CPU seconds and the peak resident bytes of one process, or what it said where it failed."""
    begin = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    said = process.stderr.read()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode != 0:
        raise SystemExit(f"{' '.join(map(str, command))}: exit code {process.returncode}: {said.decode()}")
    return {"wall": time.monotonic() - begin, "cpu": usage.ru_utime + usage.ru_stime, "rss": usage.ru_maxrss * 1024}


def median(rounds, key):
    return statistics.median(one[key] for one in rounds)


class Bench:
    def __init__(self, options):
        self.options = options
        self.program = ROOT / options.build / "meshlode"
        self.out = ROOT / options.out
        self.out.mkdir(parents=True, exist_ok=True)
        self.gltfpack = shutil.which("gltfpack")
        if not self.gltfpack:
            raise SystemExit("gltfpack is missing: apt-get install gltfpack")

    def scene(self, model):
        if model in DATA:
            return ROOT / "data" / f"{model}.glb"
        return Path(os.environ["MESHLODE_MODELS"]) / f"{model}.glb"

    def build(self, scene, preset, threads):
        asset, report = self.out / "asset.lode", self.out / "report.json"
        figures = run([self.program, "build", scene, "-o", asset, "--preset", preset, "--jobs", str(threads), "--quiet",
                       "--report", report])
        built = json.loads(report.read_text())["builds"][0]
        figures["stages"] = {stage["stage"]: stage["seconds"] for stage in built["stages"]}
        figures["levels"] = built.get("levels", [])
        figures["triangles"], figures["bytes"] = built["source_triangles"], built["file_bytes"]
        asset.unlink()
        return figures

    def measure(self, model):
        scene, packed = self.scene(model), self.out / "packed.glb"
        variants = [(preset, threads) for preset in self.options.presets.split(",")
                    for threads in map(int, self.options.threads.split(","))]
        yardstick, ours = [], {variant: [] for variant in variants}
        for _ in range(self.options.rounds):
            yardstick.append(run([self.gltfpack, "-i", scene, "-o", packed, *YARDSTICK]))
            for variant in variants:
                ours[variant].append(self.build(scene, *variant))
        print(f"{model}: done", file=sys.stderr, flush=True)
        return {"model": model, "yardstick": yardstick,
                "ours": [{"preset": p, "threads": t, "rounds": r} for (p, t), r in ours.items()]}


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "|".join([" --- "] + [" ---: "] * (len(header) - 1)) + "|"]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def whole_table(figures):
    rows = []
    for one in figures:
        base = median(one["yardstick"], "wall")
        triangles = one["ours"][0]["rounds"][0]["triangles"]
        rows.append([one["model"], f"{triangles:,}", "gltfpack", "1", f"{base:.2f}", f"{median(one['yardstick'], 'cpu'):.2f}",
                     "1", "–", f"{median(one['yardstick'], 'rss') / 1e6:.0f}", "–"])
        for ours in one["ours"]:
            rounds = ours["rounds"]
            wall = median(rounds, "wall")
            rows.append(["", "", f"`{ours['preset']}`", str(ours["threads"]), f"{wall:.2f}", f"{median(rounds, 'cpu'):.2f}",
                         f"{wall / base:.1f}", f"{wall / triangles * 1e6:.1f}", f"{median(rounds, 'rss') / 1e6:.0f}",
                         f"{rounds[0]['bytes'] / triangles:.2f}"])
    return table(["model", "triangles", "program", "threads", "wall s", "CPU s", "× gltfpack", "µs per triangle", "peak MB",
                  "bytes per triangle"], rows)


def single_thread(figures):
    for one in figures:
        for ours in one["ours"]:
            if ours["threads"] == 1:
                yield one["model"], ours["preset"], ours["rounds"]


def stage_table(figures):
    rows, stages = [], []
    for model, preset, rounds in single_thread(figures):
        stages = stages or list(rounds[0]["stages"])
        rows.append([model, f"`{preset}`"] + [f"{statistics.median(r['stages'][s] for r in rounds):.3f}" for s in stages])
    return table(["model", "preset", *stages], rows) if rows else ""


def level_table(figures, model):
    """Of one mesh: a level's seconds end with the level, so that the first are those of clustering the source."""
    rows = []
    for name, preset, rounds in single_thread(figures):
        if name != model:
            continue
        for index, level in enumerate(rounds[0]["levels"]):
            seconds = statistics.median(r["levels"][index]["seconds"] for r in rounds)
            rows.append([f"`{preset}`", str(level["level"]), f"{level['triangles']:,}", f"{seconds:.3f}"])
    return table(["preset", "level", "triangles", "seconds"], rows) if rows else ""


def write_document(figures, options):
    commit = subprocess.run(["git", "-C", ROOT, "rev-parse", "--short", "HEAD"], capture_output=True, text=True).stdout.strip()
    rounds = len(figures[0]["yardstick"])
    parts = [f"Commit {commit}, {os.cpu_count()} cores, medians of {rounds} rounds.\n", whole_table(figures),
             "### Seconds of the stages, one thread\n", stage_table(figures)]
    levels = level_table(figures, figures[0]["model"])
    if levels:
        parts += [f"### Seconds of the levels of {figures[0]['model']}, one thread\n", levels]
    path = ROOT / "docs/log/build-time.md"
    document = path.read_text()
    begin, end = document.index(BEGIN) + len(BEGIN), document.index(END)
    path.write_text(document[:begin] + "\n\n" + "\n".join(parts) + "\n" + document[end:])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--models", default=",".join(REAL + DATA))
    parser.add_argument("--presets", default="fast,default,best")
    parser.add_argument("--threads", default=",".join(dict.fromkeys(["1", "2", str(os.cpu_count())])))
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--build", default="build/release")
    parser.add_argument("--out", default="out/build", help="assets while they are measured, and figures.json")
    parser.add_argument("--document", action="store_true", help="write docs/log/build-time.md")
    options = parser.parse_args()
    bench = Bench(options)
    figures = [bench.measure(model) for model in options.models.split(",")]
    (bench.out / "figures.json").write_text(json.dumps(figures, indent=1))
    print(whole_table(figures))
    if options.document:
        write_document(figures, options)


if __name__ == "__main__":
    main()
