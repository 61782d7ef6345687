#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What aggregates take and cover, with --aggregate and without: tables, curves and pictures of docs/log/aggregates.md.

  ninja -C build/release meshlode_cli meshlode_generate bench_aggregate bench_aggregate_pictures
  bench/aggregate/run.py --document      # docs/log/aggregates.md, docs/pictures/aggregates.{svg,png}

The four scenes of the first table and the eight others are the generator's. `bench_aggregate` measures uniform cuts at
one pixel of error; builds are timed in turn, with and without, medians.
"""
import argparse
import json
import math
import os
import shutil
import statistics
import subprocess
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
MAIN = ["foliage", "grass", "tree", "soup"]
OTHERS = ["hedge", "ivy", "pads", "clumps", "conifer", "blades", "splinters", "fence"]
TITLES = {"foliage": "foliage, 8,000 masked triangles", "grass": "grass, 20,000 blades",
          "tree": "tree, 40,000 masked leaves", "soup": "soup, 20,000 boxes", "hedge": "hedge",
          "ivy": "ivy along a wall", "pads": "pads on a pond", "clumps": "clumps", "conifer": "conifer of needles",
          "blades": "blades, a triangle each", "splinters": "splinters, a triangle each",
          "fence": "fence of cards that stand"}
SHOWN = [100, 72, 50, 30, 10]
COLORS = {"never": "#c0392b", "auto": "#1f5fbf"}


def build(meshlode, scene, asset, choice, jobs):
    before, started = os.times(), time.time()
    subprocess.run([meshlode, "build", scene, "-o", asset, "--aggregate", choice, "--jobs", str(jobs), "--quiet"],
                   check=True)
    after = os.times()
    return time.time() - started, (after.children_user + after.children_system - before.children_user
                                   - before.children_system)


def measure(bench, asset):
    """{pixels: (triangles, noise, covered, contrast, worst direction)}, the last four as printed"""
    rows = {}
    for line in subprocess.run([bench, asset], check=True, capture_output=True, text=True).stdout.splitlines()[2:]:
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        rows[int(cells[1])] = (int(cells[2]), *cells[3:])
    return rows


def main_table(found):
    lines = ["| asset | pixels across | triangles, `never` | noise | `auto` | noise | covered | contrast | worst direction |",
             "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"]
    for name in MAIN:
        for pixels in SHOWN:
            never, auto = found[name]["never"][pixels], found[name]["auto"][pixels]
            lines.append(f"| {TITLES[name] if pixels == SHOWN[0] else ''} | {pixels} | {never[0]:,} | {never[1]} | "
                         f"{auto[0]:,} | {auto[1]} | {auto[2]} | {auto[3]} | {auto[4]} |")
    return "\n".join(lines)


def other_table(found):
    lines = ["| asset | source | at 100 pixels | noise | worst direction | at 30 | noise | worst direction |",
             "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"]
    for name in OTHERS:
        fine, coarse = found[name]["auto"][100], found[name]["auto"][30]
        lines.append(f"| {TITLES[name]} | {found[name]['source']:,} | {fine[0]:,} | {fine[1]} | {fine[4]} | "
                     f"{coarse[0]:,} | {coarse[1]} | {coarse[4]} |")
    return "\n".join(lines)


def time_table(times, jobs):
    lines = [f"| asset | `never`, {jobs} threads | `auto` | | processor seconds, `never` | `auto` | |",
             "| --- | ---: | ---: | ---: | ---: | ---: | ---: |"]
    for name in MAIN:
        median = {(choice, i): statistics.median(run[i] for run in times[name][choice])
                  for choice in ("never", "auto") for i in (0, 1)}
        lines.append(f"| {name} | {median['never', 0]:.2f} s | {median['auto', 0]:.2f} s | "
                     f"{median['auto', 0] / median['never', 0]:.1f}× | {median['never', 1]:.2f} | "
                     f"{median['auto', 1]:.2f} | {median['auto', 1] / median['never', 1]:.1f}× |")
    return "\n".join(lines)


def curves(found):
    width, height, left, top, right, bottom, gap = 270, 210, 52, 26, 10, 34, 10
    out = ['<?xml version="1.0" encoding="UTF-8"?>', "<!-- SPDX-License-Identifier: GPL-3.0-or-later -->",
           f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {4 * width} {2 * height + gap + 20}" '
           'font-family="sans-serif" font-size="11" fill="#222">',
           f'<rect width="{4 * width}" height="{2 * height + gap + 20}" fill="#fff"/>']
    x_low, x_high = math.log10(5), math.log10(300)

    def panel(column, row, title, low, high, ticks, label, of_row, is_log, limit=None):
        x0, y0 = column * width + left, row * (height + gap) + top
        w, h = width - left - right, height - top - bottom

        def x_of(pixels): return x0 + (math.log10(pixels) - x_low) / (x_high - x_low) * w

        def y_of(value):
            value = min(max(value, low), high)
            if is_log:
                return y0 + h - (math.log10(value) - math.log10(low)) / (math.log10(high) - math.log10(low)) * h
            return y0 + h - (value - low) / (high - low) * h

        out.append(f'<text x="{x0 + w / 2:.1f}" y="{y0 - 8}" text-anchor="middle" font-weight="bold">{title}</text>')
        for pixels in (5, 10, 30, 100, 300):
            out.append(f'<line x1="{x_of(pixels):.1f}" y1="{y0}" x2="{x_of(pixels):.1f}" y2="{y0 + h}" stroke="#ddd"/>'
                       f'<text x="{x_of(pixels):.1f}" y="{y0 + h + 14}" text-anchor="middle">{pixels}</text>')
        for tick in ticks:
            out.append(f'<line x1="{x0}" y1="{y_of(tick):.1f}" x2="{x0 + w}" y2="{y_of(tick):.1f}" stroke="#ddd"/>'
                       f'<text x="{x0 - 4}" y="{y_of(tick) + 4:.1f}" text-anchor="end">{label(tick)}</text>')
        if limit is not None:
            out.append(f'<line x1="{x0}" y1="{y_of(limit):.1f}" x2="{x0 + w}" y2="{y_of(limit):.1f}" stroke="#888" '
                       'stroke-dasharray="4 3"/>')
        for choice in ("never", "auto"):
            places = [(x_of(pixels), y_of(of_row(cells)))
                      for pixels, cells in sorted(found[MAIN[column]][choice].items())]
            path = " ".join(f"{x:.1f},{y:.1f}" for x, y in places)
            out.append(f'<polyline points="{path}" fill="none" stroke="{COLORS[choice]}" stroke-width="1.6"/>')
            out.extend(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="2.4" fill="{COLORS[choice]}"/>' for x, y in places)

    for column, name in enumerate(MAIN):
        panel(column, 0, f"{name}: triangles", 50, 300000, (100, 1000, 10000, 100000), lambda t: f"{t:,}",
              lambda cells: cells[0], True)
        panel(column, 1, f"{name}: noise", 0.0, 0.5, (0.0, 0.1, 0.2, 0.3, 0.4, 0.5), lambda t: f"{t:g}",
              lambda cells: float(cells[1]), False, 0.22)
    y = 2 * height + gap + 12
    for i, (choice, title) in enumerate((("never", "--aggregate never"), ("auto", "--aggregate auto"))):
        out.append(f'<rect x="{left + 150 * i}" y="{y - 9}" width="10" height="10" fill="{COLORS[choice]}"/>'
                   f'<text x="{left + 15 + 150 * i}" y="{y}">{title}</text>')
    out.append(f'<text x="{left + 300}" y="{y}">against pixels across the longest side; dashed: the most that V208 '
               'allows; noise above 0.5 is drawn at 0.5</text>')
    return "\n".join(out) + "\n</svg>\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=Path, default=ROOT / "build/release")
    parser.add_argument("--out", type=Path, default=ROOT / "builder/aggregate", help="assets are written there")
    parser.add_argument("--rounds", type=int, default=7, help="of timed builds")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--document", action="store_true", help="write docs/log/aggregates.md and its pictures")
    options = parser.parse_args()
    meshlode, bench = str(options.build / "meshlode"), str(options.build / "bench/aggregate/bench_aggregate")
    options.out.mkdir(parents=True, exist_ok=True)
    subprocess.run([str(options.build / "meshlode_generate"), str(options.out), "--aggregates"], check=True,
                   stdout=subprocess.DEVNULL)
    shutil.copy(ROOT / "data/foliage.glb", options.out / "foliage.glb")
    found, times, pairs = {}, {}, []
    for name in MAIN + OTHERS:
        scene, found[name] = str(options.out / f"{name}.glb"), {}
        times[name] = {"never": [], "auto": []}
        for _ in range(options.rounds if name in MAIN else 1):
            for choice in times[name]:
                times[name][choice].append(build(meshlode, scene, str(options.out / f"{name}-{choice}.lode"), choice,
                                                 options.jobs))
        for choice in times[name]:
            found[name][choice] = measure(bench, str(options.out / f"{name}-{choice}.lode"))
        said = subprocess.run([meshlode, "info", str(options.out / f"{name}-auto.lode"), "--format", "json"], check=True,
                              capture_output=True, text=True).stdout
        found[name]["source"] = json.loads(said)["meshes"][0]["source_triangles"]
        subprocess.run([meshlode, "verify", str(options.out / f"{name}-auto.lode"), "--source", scene, "--quiet"], check=True)
        if name in MAIN:
            pairs += [str(options.out / f"{name}-auto.lode"), str(options.out / f"{name}-never.lode")]
    picture = options.out / "aggregates.png"
    subprocess.run([str(options.build / "bench/aggregate/bench_aggregate_pictures"), str(picture), *pairs], check=True)
    tables = {"cuts": main_table(found), "others": other_table(found), "times": time_table(times, options.jobs)}
    for table in tables.values():
        print("\n" + table)
    if not options.document:
        return
    book = ROOT / "docs/log/aggregates.md"
    text = book.read_text()
    for key, table in tables.items():
        begin, end = f"<!-- {key}: begin -->", f"<!-- {key}: end -->"
        head, rest = text.split(begin)
        text = head + begin + "\n\n" + table + "\n\n" + end + rest.split(end)[1]
    book.write_text(text)
    (ROOT / "docs/pictures/aggregates.svg").write_text(curves(found))
    shutil.copy(picture, ROOT / "docs/pictures/aggregates.png")


if __name__ == "__main__":
    main()
