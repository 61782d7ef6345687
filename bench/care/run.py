#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""What care costs: the table of docs/log/numerics.md and docs/pictures/care.svg.

    cmake --preset release -DMESHLODE_TESTS=ON && ninja -C build/release meshlode_cli hard_cases
    MESHLODE_MODELS=DIR bench/care/run.py --document

Each scene is swept over `care` and `error_tier` alone (`meshlode sweep --knobs`), in rounds, so that what else the machine does
falls on all builds alike; a share is that of the medians, and one within the spread is marked. What breaks is what
`hard_cases care NAME=off` finds: cases and parameters whose verdict is worse without that care.
"""
import argparse
import json
import math
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BEGIN, END = "<!-- care: begin -->", "<!-- care: end -->"
# In the table's order: the words of the point's settings, what is left out, and the name that hard_cases knows.
CARES = [
    ({"care": "double-quadrics=off"}, "quadrics in floats", "double-quadrics=off"),
    ({"care": "fallback=off"}, "no fallback for ill-conditioned minima", "fallback=off"),
    ({"care": "spheres=off"}, "spheres around boxes' centres", "spheres=off"),
    ({"care": "needles=off"}, "needles not kept apart", "needles=off"),
    ({"error_tier": "qem"}, "errors estimated, not measured", None),
]
METRICS = [("build_user_seconds", "CPU"), ("triangles_at_max", "triangles at 1e-3"), ("cut_triangles", "triangles of a view"),
           ("deviation", "deviation of the finest cut")]


def sweep(meshlode, scene, folder, rounds):
    subprocess.run([meshlode, "sweep", str(scene), "-o", str(folder), "--knobs", "care,error_tier", "--rounds", str(rounds),
                    "--quiet"], check=True)
    return json.loads((folder / "sweep.json").read_text())


def find_point(swept, settings):
    for point in swept["points"]:
        words = point["settings"]
        rest = {"care": "all", "error_tier": "auto", **settings}
        if all(words.get(name) == word for name, word in rest.items()) and point["figures"]:
            return point
    return None


def share(point, base, key):
    """Of the medians, and whether it is beyond the spread; None where either lacks the figure."""
    a, b = point["figures"].get(key), base["figures"].get(key)
    if not a or not b or not b["value"]:
        return None
    is_clear = key != "build_user_seconds" or a["min"] > b["max"] or a["max"] < b["min"]
    return a["value"] / b["value"], is_clear


def share_text(found):
    if found is None:
        return "–"
    value, is_clear = found
    return ("" if is_clear else "≈ ") + f"{100.0 * (value - 1.0):+.1f}%"


def broken_by(hard_cases, care, jobs, kept):
    """What hard_cases says, or said: `kept` is a file of it."""
    if kept.exists():
        said = kept.read_text()
    else:
        command = [hard_cases, "care", care, "--jobs", str(jobs)]
        said = subprocess.run(command, check=True, capture_output=True, text=True).stdout
        kept.write_text(said)
    lines = [line.split("\t") for line in said.splitlines()]
    return [line for line in lines if len(line) == 6], lines[-1][-1]


def broken_text(lines, count):
    if not lines:
        return f"nothing ({count})"
    cases = {}
    for _, name, parameter, before, after, _ in lines:
        cases.setdefault(name, []).append(f"{parameter}: {before} → {after}")
    return f"({count}) " + "; ".join(f"`{name}` at " + ", ".join(cases[name]) for name in sorted(cases))


def plot(rows, scenes):
    """A dot a scene: CPU seconds against triangles at equal deviation, both over the careful build's."""
    width, height, left, top, right, bottom = 640, 380, 64, 20, 210, 52
    xs = [x for row in rows for x, _ in row["dots"]] + [1.0]
    ys = [y for row in rows for _, y in row["dots"]] + [1.0]

    def span(values):
        low, high = min(values), max(values)
        pad = max(0.02, 0.06 * (high - low))
        return low - pad, high + pad
    (x0, x1), (y0, y1) = span(xs), span([math.log10(y) for y in ys])

    def px(x): return left + (x - x0) / (x1 - x0) * (width - left - right)
    def py(y): return top + (y1 - math.log10(y)) / (y1 - y0) * (height - top - bottom)
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" font-size="12">',
           f'<title>What care costs, over {len(scenes)} scenes</title>',
           f'<rect width="{width}" height="{height}" fill="#fff"/>',
           f'<path d="M{left} {py(1.0):.1f}H{width - right}M{px(1.0):.1f} {top}V{height - bottom}" stroke="#999" fill="none"/>']
    for i in range(5):
        x = x0 + (x1 - x0) * i / 4
        y = 10 ** (y0 + (y1 - y0) * i / 4)
        out.append(f'<text x="{px(x):.1f}" y="{height - bottom + 18}" text-anchor="middle">{x:.2f}</text>')
        out.append(f'<text x="{left - 8}" y="{py(y) + 4:.1f}" text-anchor="end">{y:.2f}</text>')
    out.append(f'<text x="{(left + width - right) / 2:.0f}" y="{height - 12}" text-anchor="middle">CPU seconds, over the careful build</text>')
    out.append(f'<text transform="translate(16 {(top + height - bottom) / 2:.0f}) rotate(-90)" text-anchor="middle">triangles at deviation 1e-3</text>')
    colors = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#444444"]
    shapes = ["M-5 0A5 5 0 1 0 5 0A5 5 0 1 0-5 0Z", "M-5-5H5V5H-5Z", "M0-6L6 5H-6Z", "M0-6L6 0L0 6L-6 0Z", "M-5-5L5 5M5-5L-5 5"]
    for i, row in enumerate(rows):
        style = f'fill="{colors[i] if i < 4 else "none"}" stroke="{colors[i]}" stroke-width="1.5" fill-opacity="0.7"'
        for x, y in row["dots"]:
            out.append(f'<path transform="translate({px(x):.1f} {py(y):.1f})" d="{shapes[i]}" {style}/>')
        y = top + 16 + 24 * i
        out.append(f'<path transform="translate({width - right + 18} {y - 4})" d="{shapes[i]}" {style}/>')
        out.append(f'<text x="{width - right + 32}" y="{y}" font-size="11">{row["short"]}</text>')
    return "\n".join(out) + "\n</svg>\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", default="build/release")
    parser.add_argument("--out", default="build/care", help="folder of sweeps and trials: run again, they go on; remove it to begin anew")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--only-kept", action="store_true", help="try no hard cases but those that --out has")
    parser.add_argument("--document", action="store_true", help="write docs/log/numerics.md and docs/pictures/care.svg")
    options = parser.parse_args()
    models = Path(os.environ["MESHLODE_MODELS"])
    scenes = [ROOT / "data" / "rock.glb", ROOT / "data" / "crystal.glb", models / "bunny.glb", models / "fandisk.glb"]
    meshlode = ROOT / options.build / "meshlode"
    swept = {}
    for scene in scenes:
        folder = ROOT / options.out / scene.stem
        folder.parent.mkdir(parents=True, exist_ok=True)
        swept[scene.stem] = sweep(meshlode, scene, folder, options.rounds)
        print(scene.stem, "swept", file=sys.stderr, flush=True)
    rows = []
    table = ["| left out | scene | " + " | ".join(title for _, title in METRICS) + " |", "| --- | --- |" + " --- |" * len(METRICS)]
    breaks = ["| left out | whose verdict is worse |", "| --- | --- |"]
    for settings, title, care in CARES:
        dots = []
        for name, result in swept.items():
            base, point = find_point(result, {}), find_point(result, settings)
            if not base or not point:
                continue
            shares = [share(point, base, key) for key, _ in METRICS]
            table.append(f"| {title} | {name} | " + " | ".join(share_text(one) for one in shares) + " |")
            if shares[0] and shares[1]:
                dots.append((shares[0][0], shares[1][0]))
        rows.append({"short": care or "error-tier qem", "dots": dots})
        if care:
            kept = ROOT / options.out / f"hard-{care}.tsv"
            if options.only_kept and not kept.exists():
                continue
            broken = broken_by(ROOT / options.build / "tests/hard/hard_cases", care, options.jobs, kept)
            breaks.append(f"| {title} | {broken_text(*broken)} |")
            print(care, "tried", file=sys.stderr, flush=True)
    text = "\n".join(table) + "\n"
    if len(breaks) > 2:
        text += "\n" + "\n".join(breaks) + "\n"
    if not options.document:
        print(text)
        return
    page = ROOT / "docs/log/numerics.md"
    before, _, rest = page.read_text().partition(BEGIN)
    _, _, after = rest.partition(END)
    page.write_text(f"{before}{BEGIN}\n\n{text}\n{END}{after}")
    (ROOT / "docs" / "pictures" / "care.svg").write_text(plot(rows, scenes))


if __name__ == "__main__":
    main()
