#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Builds the assets, measures them with bench_quality and writes the figures into docs/log/quality.md and docs/pictures/.

    cmake --preset release -DMESHLODE_BENCH=ON && ninja -C build/release
    MESHLODE_MODELS=DIR bench/quality/run.py

Figures that are newer than the programs and the model are kept, so that a run that was stopped goes on where it was;
--fresh measures everything again, --document writes the documents from the figures that are there.
"""
import argparse
import json
import os
import resource
import statistics
import subprocess
import sys
from pathlib import Path

sys.dont_write_bytecode = True
import plot  # noqa: E402  (beside this file)

ROOT = Path(__file__).resolve().parents[2]
MODELS = ["bunny", "dragon", "fandisk", "rocker-arm", "homer", "spot", "terrain"]
TERRAIN_TRIANGLES = 1_000_000
AT_MAX, AT_RMS = [1e-3, 2e-3, 5e-3], [1e-4, 3e-4, 1e-3]
NORMALS_WITHIN = {"bunny": 1.5, "dragon": 2.2}  # degrees RMS, at the first maximum
TIERS = ["qem", "measured", "certified"]
# Measured by us earlier with the same kind of evaluator: uniform cuts of the best of meshoptimizer's clusterlod (with
# normals, and positions only) and NVIDIA's nv_cluster_lod_builder, interpolated between cuts; max +-15%, RMS +-5%.
BEST_PEER = {
    "bunny": {"max": [17399, 6853, 1997], "rms": [34027, 9443, 2407]},
    "dragon": {"max": [138712, 60553, 19425], "rms": [70008, 20052, 4883]},
    "fandisk": {"max": [786, 494, 265], "rms": [1123, 527, 240]},
}
BEGIN, END = "<!-- measured: begin -->", "<!-- measured: end -->"


def cpu_seconds(command):
    """Runs a command; its exit code and the CPU seconds of all its threads."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    code = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE).returncode
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return code, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


class Bench:
    def __init__(self, options):
        self.options = options
        self.build = ROOT / options.build
        self.out = ROOT / options.out
        self.out.mkdir(parents=True, exist_ok=True)

    def program(self, name):
        return self.build / name

    def scene(self, model):
        if model != "terrain":
            return Path(os.environ["MESHLODE_MODELS"]) / f"{model}.glb"
        path = self.out / "terrain.glb"
        if not path.exists():
            folder = self.out / "generated"
            folder.mkdir(exist_ok=True)
            subprocess.run([self.program("meshlode_generate"), folder, "--triangles", str(TERRAIN_TRIANGLES)],
                           check=True)
            next(folder.glob("*.glb")).rename(path)
        return path

    def is_fresh(self, result, model):
        inputs = [self.program("meshlode"), self.program("bench/quality/bench_quality"), self.scene(model)]
        return (not self.options.fresh and result.exists()
                and all(result.stat().st_mtime > i.stat().st_mtime for i in inputs))

    def measure(self, model, attributes, tier, arguments, what=""):
        """The figures of one asset, with the CPU seconds of its build; nothing where the tier is not built yet."""
        result = self.out / f"{model}-{attributes}-{tier}{what}.json"
        if self.options.document or self.is_fresh(result, model):
            return json.loads(result.read_text()) if result.exists() else None
        scene, asset = self.scene(model), self.out / f"{model}-{attributes}-{tier}.lode"
        code, seconds = cpu_seconds([self.program("meshlode"), "build", scene, "-o", asset, "--quiet",
                                     "--attributes", attributes, "--error-tier", tier])
        if code == 5:
            print(f"{model} {attributes} {tier}: not built (exit 5)", flush=True)
            return None
        if code != 0:
            raise SystemExit(f"build of {scene} failed with {code}")
        raw = result.with_suffix(".raw")
        subprocess.run([self.program("bench/quality/bench_quality"), scene, asset, "--json", raw, *arguments],
                       check=True, stdout=subprocess.DEVNULL)
        figures = json.loads(raw.read_text())
        raw.unlink()
        figures["build_cpu_seconds"] = seconds
        figures["commit"] = subprocess.run(["git", "-C", ROOT, "rev-parse", "--short", "HEAD"], capture_output=True,
                                           text=True).stdout.strip()
        info = subprocess.run([self.program("meshlode"), "info", asset, "--format", "json"], check=True,
                              capture_output=True)
        totals = json.loads(info.stdout)["totals"]
        figures["roots"], figures["stuck_groups"] = totals["roots"], totals["stuck_groups"]
        result.write_text(json.dumps(figures, indent=1))
        asset.unlink()
        print(f"{model} {attributes} {tier}: done", flush=True)
        return figures

    def measure_all(self):
        figures = {}
        cuts = ["--cuts", str(self.options.cuts)]
        at = ["--max", ",".join(map(str, AT_MAX)), "--rms", ",".join(map(str, AT_RMS))]
        nowhere = ["--max", "none", "--rms", "none", "--drift", "none"]
        for model in self.options.models.split(","):
            reference = ["--reference"] if model in self.options.reference.split(",") else []
            figures[model, "none", "measured"] = self.measure(model, "none", "measured", [*cuts, *at, *reference])
            figures[model, "auto", "measured"] = self.measure(model, "auto", "measured", ["--cuts", "0", *at])
            if model == "bunny":  # no material of it has a texture, so its UVs are kept on demand only
                figures[model, "all", "measured"] = self.measure(model, "all", "measured", ["--cuts", "0", *at])
            if model in NORMALS_WITHIN:
                figures[model, "normals", "measured"] = self.measure(
                    model, "auto", "measured", ["--cuts", "0", "--max", str(AT_MAX[0]), "--rms", "none", "--normals",
                                                str(NORMALS_WITHIN[model])], "-normals")
            for tier in self.options.tiers.split(","):
                if tier != "measured":  # what is proven is held against more samples
                    samples = ["--samples", "1000000"] if tier == "certified" else []
                    figures[model, "none", tier] = self.measure(model, "none", tier, [*cuts, *nowhere, *samples])
        return {key: value for key, value in figures.items() if value}


def equal(figures, method, figure, x):
    """The fewest triangles; cuts are by the stored error, and for the RMS by the quadric's too."""
    methods = ["cuts", "quadric cuts"] if method == "cuts" else [method]
    found = [one for one in (figures["meshes"][0]["equal_deviation"] if figures else [])
             if one["method"] in methods and one["figure"] == figure and abs(one["x"] / x - 1) < 1e-9]
    return min(found, key=lambda one: one["triangles"] if one["is_found"] else float("inf"), default=None)


def count(one):
    if one is None:
        return "–"
    return f'{one["triangles"]:,}' if one["is_found"] else "none"


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "|".join([" --- "] + [" ---: "] * (len(header) - 1)) + "|"]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows]) + "\n"


def equal_table(figures, models, figure, xs):
    rows = []
    for model in models:
        ours = figures.get((model, "none", "measured"))
        if not ours:
            continue
        row = [model, f'{ours["meshes"][0]["source_triangles"]:,}']
        for i, x in enumerate(xs):
            peer = BEST_PEER.get(model)
            row += [f'**{count(equal(ours, "cuts", figure, x))}**', count(equal(ours, "openmesh", figure, x)),
                    f"{peer[figure][i]:,}" if peer else "–"]
        rows.append(row + [ours.get("commit", "–")])
    header = ["mesh", "source"]
    for x in xs:
        header += [f"≤ {x:.0e}", "OpenMesh", "best peer"]
    return table(header + ["commit"], rows)


def attribute_table(figures, models):
    rows = []
    for model in models:
        for attributes in ("auto", "normals", "all"):
            ours = figures.get((model, attributes, "measured"))
            for figure, xs in (("max", AT_MAX), ("rms", AT_RMS)):
                for x in xs:
                    one = equal(ours, "cuts", figure, x)
                    if not one or not one["is_found"]:
                        continue
                    normal, uv = one.get("normal_degrees"), one.get("uv")
                    label = {"auto": "", "all": ", all attributes",
                             "normals": f", normals ≤ {NORMALS_WITHIN.get(model)}"}[attributes]
                    rows.append([model + label, f"{figure} ≤ {x:.0e}", count(one),
                                 *(f"{normal[k]:.2f}" if normal else "–" for k in ("rms", "p99")),
                                 *(f"{uv[k]:.1e}" if uv else "–" for k in ("rms", "p99")),
                                 ours.get("commit", "–")])
    return table(["mesh", "true deviation", "triangles", "normals/deg RMS", "99%", "UV RMS", "99%",
                  "commit"], rows)


def tier_table(figures, models):
    rows = []
    for model in models:
        base = figures.get((model, "none", "qem"))
        for tier in TIERS:  # a ratio compares builds of one commit
            ours = figures.get((model, "none", tier))
            if not ours:
                continue
            ratios = [c["max"] / c["stored"] for c in ours["meshes"][0]["cuts"] if c["stored"] > 0]
            seconds = ours["build_cpu_seconds"]
            is_comparable = base is not None and base.get("commit") == ours.get("commit")
            ratio = f'{seconds / base["build_cpu_seconds"]:.2f}' if is_comparable else "–"
            rows.append([model, tier, str(len(ratios)), f"{statistics.median(ratios):.2f}", f"{max(ratios):.3f}",
                         str(sum(r > 1.0 for r in ratios)), str(sum(r > 1.05 for r in ratios)), f"{seconds:.2f}", ratio,
                         str(ours["roots"]), str(ours["stuck_groups"]), ours.get("commit", "–")])
    return table(["mesh", "tier", "cuts", "true/stored median", "largest", "> 1", "> 1.05", "build CPU s", "× qem", "roots",
                  "stuck", "commit"], rows)


def write_pictures(figures, models):
    links = []
    for model in models:
        ours = figures.get((model, "none", "measured"))
        if not ours:
            continue
        cuts = ours["meshes"][0]["cuts"]

        def curves(figure, xs):
            def found(method):
                all_found = (equal(ours, method, figure, x) for x in xs)
                return [(one[figure], one["triangles"]) for one in all_found if one and one["is_found"]]

            line = [(c[figure], c["triangles"]) for c in cuts] if figure == "max" else []
            peer = list(zip(xs, BEST_PEER[model][figure])) if model in BEST_PEER else []
            return [("meshlode", "meshlode, measured", line + found("cuts"), True),
                    ("openmesh", "OpenMesh decimater", found("openmesh"), True),
                    ("peer", "best peer", peer, False)]

        path = ROOT / "docs/pictures" / f"quality-{model}.svg"
        path.write_text(plot.svg(model, curves("max", AT_MAX), curves("rms", AT_RMS)))
        links.append(f"![{model}: triangles over true deviation](../pictures/{path.name})\n")
    return "\n".join(links)


def write_document(figures, options):
    models = options.models.split(",")
    notes = []
    for model in models:
        ours = figures.get((model, "none", "measured"))
        notes += [f"- {model}: {note}" for note in (ours["meshes"][0]["notes"] if ours else [])]
    parts = [
        "Each row names the commit whose programs made it. A dash is a figure that was not measured.\n",
        "### Triangles at equal true maximum, `--attributes none`\n", equal_table(figures, models, "max", AT_MAX),
        "### Triangles at equal true RMS, `--attributes none`\n", equal_table(figures, models, "rms", AT_RMS),
        "\n".join(notes) + "\n" if notes else "",
        "### With attributes (`auto`, the default)\n", attribute_table(figures, models),
        "### How true the stored errors are, and what they cost\n", tier_table(figures, models),
        write_pictures(figures, models),
    ]
    path = ROOT / "docs/log/quality.md"
    document = path.read_text()
    begin, end = document.index(BEGIN) + len(BEGIN), document.index(END)
    path.write_text(document[:begin] + "\n\n" + "\n".join(p for p in parts if p) + "\n" + document[end:])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--models", default=",".join(MODELS))
    parser.add_argument("--tiers", default=",".join(TIERS))
    parser.add_argument("--reference", default="bunny,dragon,fandisk", help="meshes that OpenMesh decimates too")
    parser.add_argument("--cuts", type=int, default=24, help="cuts in the table of true over stored errors")
    parser.add_argument("--build", default="build/release")
    parser.add_argument("--out", default="out/quality", help="assets and figures")
    parser.add_argument("--fresh", action="store_true")
    parser.add_argument("--document", action="store_true")
    options = parser.parse_args()
    figures = Bench(options).measure_all()
    write_document(figures, options)


if __name__ == "__main__":
    main()
