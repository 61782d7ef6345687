#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Measures the tables of README and docs, and writes them into the pages and, with their origin, into docs/log/results/.

    cmake --preset release -DMESHLODE_BENCH=ON && ninja -C build/release
    MESHLODE_MODELS=DIR bench/results.py accuracy brackets     # these tables; --list names all; no name: every table
    MESHLODE_MODELS=DIR bench/results.py --jobs 16             # tables and scenes side by side, on a machine with as many cores

A table lies between `<!-- NAME: begin -->` and `<!-- NAME: end -->` in its page. docs/log/results/TABLE.json has its commit,
machine, command, the content hashes of its assets, its figures where they are measured here, and a hash of the text in the page.
tools/release-check compares these with the repository. What another script of bench/ measures it prints; tables of docs/log that
are not named here are of the commits that they name.
"""
import argparse
import concurrent.futures
import dataclasses
import datetime
import hashlib
import json
import os
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
RESULTS = "docs/log/results"
DATA = ["city", "crystal", "foliage", "rock", "terrain"]
REAL = ["dragon", "bunny", "FlightHelmet", "fandisk", "rocker-arm", "homer", "spot"]
MODELS = ["FlightHelmet", "dragon"]


@dataclasses.dataclass
class Table:
    page: str
    scenes: list              # whose content hashes are recorded; "data/rock" is data/rock.glb, "rock" a file of MESHLODE_MODELS
    command: list             # a script of bench/ and its arguments; empty: measured here
    minutes: int = 1          # an estimate for --list; the result has what it took


ALL_DATA = [f"data/{name}" for name in DATA]
TOOL, LIBRARY = "build/release/meshlode", "build/release/libmeshlode.so"
TABLES = {
    "picture": Table("README.md", ["bunny"], []),
    "accuracy": Table("README.md", MODELS, [], minutes=15),
    # Foliage is drawn as an aggregate, whose errors are of coverage.
    "brackets": Table("docs/explanation/errors.md", REAL + [name for name in ALL_DATA if "foliage" not in name], [], minutes=12),
    "defaults": Table("docs/log/size.md", ALL_DATA + ["FlightHelmet", "bunny"],
                      ["bench/size/defaults.py", TOOL, LIBRARY, "MODELS", "data"], minutes=2),
    "gpu-form": Table("docs/log/size.md", REAL, ["bench/size/gpu_form.py", TOOL, "MODELS"], minutes=3),
    "disk-form": Table("docs/log/size.md", ALL_DATA + ["bunny", "spot", "FlightHelmet", "dragon"],
                       ["bench/size/disk_form.py", TOOL, "MODELS", "data"], minutes=3),
    "plan": Table("docs/log/plan.md", ["FlightHelmet", "dragon"] + ALL_DATA, ["bench/plan/measure.py", TOOL, "MODELS", "data"],
                  minutes=6),
    "borders": Table("docs/log/quality.md", ["data/terrain"], ["bench/borders/run.py"], minutes=4),
    "topology": Table("docs/log/numerics.md", ["bunny", "dragon"], ["bench/topology/run.py"], minutes=10),
}
# What a table of accuracy has in a row: settings that differ from the defaults, as a sweep names them.
ROWS = [
    ("`--preset fast` (errors estimated)", {"preset": "fast"}),
    ("`--error-tier qem` (errors estimated)", {"error_tier": "qem"}),
    ("default (errors measured)", {}),
    ("`--preset best`", {"preset": "best"}),
    ("`--error-tier certified` (errors proven)", {"error_tier": "certified"}),
    ("`--promise texels`", {"promise": "texels"}),
    ("`--promise appearance`", {"promise": "appearance"}),
]
SWEEP = ["--knobs", "preset,error-tier,promise", "--rounds", "1", "--samples", "50000"]
KNOBS = {"preset": "default", "error_tier": "auto", "promise": "position"}


def scene_path(name):
    if name.startswith("data/"):
        return ROOT / f"{name}.glb"
    folder = Path(os.environ.get("MESHLODE_MODELS", ".")).resolve()
    for path in (folder / f"{name}.glb", folder / name / f"{name}.gltf", folder / name / f"{name}.glb"):
        if path.is_file():
            return path
    raise SystemExit(f"results: {name}: no such model below MESHLODE_MODELS")


def run(*command, codes=(0,)):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, cwd=ROOT)
    if done.returncode not in codes:
        raise SystemExit(f"results: {' '.join(map(str, command))}: exit code {done.returncode}: {done.stderr}")
    return done.stdout


def meshlode(*command, codes=(0,)):
    return run(ROOT / TOOL, *command, codes=codes)


def content_hash(scene, folder):
    asset = Path(folder) / "asset.lode"
    meshlode("build", scene, "-o", asset, "--quiet", "--no-settings-file")
    return json.loads(meshlode("info", asset, "--format", "json"))["content_hash"]


def machine():
    names = [line.split(":")[1].strip() for line in open("/proc/cpuinfo", encoding="ascii") if line.startswith("model name")]
    return {"processor": names[0] if names else "unknown", "cores": len(names) or os.cpu_count()}


def origin(commit):
    """The commit, and whether the program may be of something else than that. `commit`: as somebody says who has no repository."""
    if commit:
        return {"commit": commit, "is_changed": False}
    changed = run("git", "status", "--porcelain", "--", "src", "include", "tools/meshlode", "cmake", "CMakeLists.txt",
                  "bench")
    return {"commit": run("git", "rev-parse", "HEAD").strip(), "is_changed": bool(changed.strip())}


def text_table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "|".join([" --- "] + [" ---: "] * (len(header) - 1)) + "|"]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def measure_accuracy(name, folder):
    report = Path(folder) / "sweep"
    meshlode("sweep", scene_path(name), "-o", report, *SWEEP, "--quiet")
    points = json.loads((report / "sweep.json").read_text())["points"]
    figures = {}
    for label, changed in ROWS:
        wanted = {**KNOBS, **changed}
        found = [p for p in points if p["status"] == "done" and
                 all(p["settings"].get(knob, value) == value for knob, value in wanted.items())]
        if not found:
            continue  # a promise that the scene has nothing for
        value = {key: one["value"] for key, one in found[0]["figures"].items()}
        view = next(p for p in found[0]["pictures"] if p["view"] == "near")
        figures[label] = {"content_hash": found[0]["content_hash"], "seconds": value["build_user_seconds"],
                          "bytes": value["geometry_bytes"], "equal": value["triangles_at_max"], "drawn": view["triangles"]}
    return figures


def accuracy_text(figures, about):
    header = ["`meshlode build`"]
    for name in figures:
        header += [f"{name}: CPU s", "geometry MB", "equal accuracy", "drawn"]
    rows = []
    for label, _ in ROWS:
        row = [label]
        for of in figures.values():
            one = of.get(label)
            row += ["–"] * 4 if one is None else [f"{one['seconds']:.1f}", f"{one['bytes'] / 1e6:.2f}", f"{one['equal']:,.0f}",
                                                  f"{one['drawn']:,}"]
        rows.append(row)
    return text_table(header, rows) + "\n\nBy `meshlode sweep SCENE -o report " + " ".join(SWEEP) + "`; " + about + "."


def measure_brackets(name, folder):
    scene, asset = scene_path(name), Path(folder) / "asset.lode"
    meshlode("build", scene, "-o", asset, "--quiet", "--no-settings-file")
    report = json.loads(meshlode("verify", asset, "--source", scene, "--deviation-cuts", "all", "--cameras", "0", "--format", "json",
                                 codes=(0, 6)))
    cuts = report["deviations"]
    shares = [cut["lower"] / cut["stored"] for cut in cuts if cut["stored"]]
    return {"cuts": len(cuts), "above": sum(s > 1.0 for s in shares), "beyond": sum(s > 1.05 for s in shares),
            "undecided": sum(cut["verdict"] == "undecided" for cut in cuts), "largest": max(shares, default=0.0)}


def brackets_text(figures, about):
    rows = [[name, f"{f['cuts']}", f"{f['above']}", f"{f['beyond']}", f"{f['undecided']}", f"{f['largest']:.4f}"]
            for name, f in figures.items()]
    return text_table(["model", "cuts", "above the stored error", "above 1.05 of it", "undecided",
                       "largest lower bound / stored"], rows) + f"\n\nEvery cut; {about}."


PICTURE_ERRORS = [1, 4, 16]  # pixels


def measure_picture(name, folder):
    """Draws docs/pictures/lod-*.png; the triangles of each."""
    asset, counts = Path(folder) / "asset.lode", {}
    meshlode("build", scene_path(name), "-o", asset, "--quiet", "--no-settings-file")
    for error in PICTURE_ERRORS:
        printed = meshlode("render", asset, "-o", ROOT / f"docs/pictures/lod-{error}.png", "--size", "420x420", "--pixel-error", error,
                           "--view", "clusters")
        counts[str(error)] = int(re.search(r"(\d+) triangles", printed).group(1))
    source = json.loads(meshlode("info", asset, "--format", "json"))["totals"]["source_triangles"]
    return {"source": source, "drawn": counts}


def picture_text(figures, about):
    of = figures["bunny"]
    images = " ".join(f'<img src="docs/pictures/lod-{e}.png" width="32%" alt="The bunny in {of["drawn"][str(e)]:,} triangles">'
                      for e in PICTURE_ERRORS)
    first, second, third = (f"{of['drawn'][str(e)]:,}" for e in PICTURE_ERRORS)
    return (f"{images}\n*One asset at an error of 1, 4 and 16 pixels: {first}, {second} and {third} of {of['source']:,} triangles. "
            "One colour per cluster.*")


MEASURED = {"picture": (measure_picture, picture_text), "accuracy": (measure_accuracy, accuracy_text), "brackets": (measure_brackets, brackets_text)}


def split_page(text, marker):
    """Before, between and behind a page's markers; None without them."""
    begin, end = f"<!-- {marker}: begin -->", f"<!-- {marker}: end -->"
    if text.count(begin) != 1 or text.count(end) != 1:
        return None
    first, last = text.index(begin) + len(begin), text.index(end)
    return text[:first], text[first:last], text[last:]


def page_hash(root, name, table):
    """Of what lies between the markers of a table's page; None where a marker is missing."""
    split = split_page((Path(root) / table.page).read_text(encoding="utf-8"), name)
    return None if split is None else hashlib.sha256(split[1].encode()).hexdigest()


def measure(name, scenes, options, pool):
    """The result of one table, and its text."""
    table, begin = TABLES[name], time.monotonic()
    result = {"table": name, "page": table.page, **origin(options.commit), "machine": machine()}
    about = f"commit {result['commit'][:8]}, {result['machine']['cores']} cores of {result['machine']['processor']}"
    with tempfile.TemporaryDirectory() as folder:
        def of_scenes(one):
            def in_own_folder(scene):
                with tempfile.TemporaryDirectory(dir=folder) as own:
                    return one(scene, own)
            return dict(zip(scenes, pool.map(in_own_folder, scenes)))

        if table.command:
            models = str(Path(os.environ.get("MESHLODE_MODELS", ".")).resolve())
            result["command"] = " ".join(table.command)
            printed = run(sys.executable, "-B", *(models if part == "MODELS" else part for part in table.command))
            text = f"{printed.strip()}\n\n{about[0].upper()}{about[1:]}."
        else:
            measured, write = MEASURED[name]
            result["command"] = f"bench/results.py {name}"
            result["figures"] = of_scenes(measured)
            text = write(result["figures"], about)
        result["assets"] = of_scenes(lambda scene, own: content_hash(scene_path(scene), own))
    result["date"], result["minutes"] = datetime.date.today().isoformat(), round((time.monotonic() - begin) / 60, 1)
    print(f"results: {name}: measured", file=sys.stderr, flush=True)
    return result, text


def write_page(name, table, result, text):
    page = ROOT / table.page
    split = split_page(page.read_text(encoding="utf-8"), name)
    if split is None:
        raise SystemExit(f"results: {table.page}: the markers of {name} are missing")
    page.write_text(f"{split[0]}\n\n{text}\n\n{split[2]}", encoding="utf-8")
    result["page_sha256"] = page_hash(ROOT, name, table)
    (ROOT / RESULTS).mkdir(parents=True, exist_ok=True)
    (ROOT / RESULTS / f"{name}.json").write_text(json.dumps(result, indent=1) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("tables", nargs="*", metavar="TABLE")
    parser.add_argument("--list", action="store_true", help="names, pages and about how many minutes each takes")
    parser.add_argument("--jobs", type=int, default=1, help="tables, and scenes of a table, that are measured at once")
    parser.add_argument("--commit", help="of the programs, where there is no repository")
    parser.add_argument("--try", dest="out", type=Path, help="write into this folder and leave pages and results alone")
    parser.add_argument("--from", dest="tried", type=Path, help="measure nothing: take what --try wrote into this folder")
    parser.add_argument("--scenes", help="with --try: these scenes alone, comma-separated")
    options = parser.parse_args()
    if options.list:
        for name, table in TABLES.items():
            print(f"{name:11} {table.minutes:3} min  {table.page}")
        return
    unknown = [name for name in options.tables if name not in TABLES]
    if unknown or (options.scenes and not options.out):
        parser.error(f"no table is called {unknown[0]}: --list names them" if unknown else "--scenes needs --try")
    names = options.tables or list(TABLES)
    if options.tried:
        for name in names:
            result = json.loads((options.tried / f"{name}.json").read_text())
            write_page(name, TABLES[name], result, (options.tried / f"{name}.md").read_text().strip())
        return
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as tables, concurrent.futures.ThreadPoolExecutor(options.jobs) as scenes:
        waited = {tables.submit(measure, name, options.scenes.split(",") if options.scenes else TABLES[name].scenes, options,
                                scenes): name for name in names}
        for done in concurrent.futures.as_completed(waited):
            name, (result, text) = waited[done], done.result()
            if options.out is None:
                write_page(name, TABLES[name], result, text)
                continue
            options.out.mkdir(parents=True, exist_ok=True)
            (options.out / f"{name}.json").write_text(json.dumps(result, indent=1) + "\n")
            (options.out / f"{name}.md").write_text(text + "\n")


if __name__ == "__main__":
    main()
