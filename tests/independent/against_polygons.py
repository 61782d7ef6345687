# SPDX-License-Identifier: GPL-3.0-or-later
"""against_polygons.py MESHLODE cases [NAME...]
against_polygons.py MESHLODE files FILE...

Builds each PLY, OBJ and STL with all its attributes and holds level 0 and what is named as left out against a second
reader (polygons.py, polygon_match.py). `cases` takes those of odd_polygons.py, whose areas are known, and then spoils what
was read of some of them: each kind of spoilt source must be found, or the comparison could not fail. `files` leaves out
names that are not there. Exit code 77: there is nothing to compare with, and it says why."""

import glob
import json
import os
import subprocess
import sys
import tempfile

import odd_polygons
import polygons
from polygon_match import Match, Sum, without_copies

MAX_FINDINGS = 6
MAX_BYTES = 400000  # of a model: what Python reads in a second


def spoil_corner(model):
    points = model.faces[len(model.faces) // 2].points
    points[1] = tuple((a + b) / 2.0 for a, b in zip(points[0], points[1]))


def spoil_uvs(model):
    uvs = model.faces[0].uvs
    uvs[0], uvs[1] = uvs[1], uvs[0]


def spoil_normals(model):
    model.faces[0].normals = [(0.0, 0.0, 1.0)] * 4


def spoil_colors(model):
    for face in model.faces:
        face.colors = [c[:2] + (c[2] + 0.02,) + c[3:] for c in face.colors]


def spoil_material(model):
    model.faces[0].material = sorted(model.materials)[-1]


def spoil_alpha(model):
    model.materials["it"].alpha = 0.25


def spoil_texture(model):
    model.materials["it"].textures["map_kd"] = model.materials["it"].textures["map_kd"].replace("my map", "other")


SPOILERS = {"a corner": ("obj_full.obj", spoil_corner), "UVs exchanged": ("obj_full.obj", spoil_uvs),
            "normals of a face": ("ply_normals.ply", spoil_normals), "colours": ("ply_ascii_float_color.ply", spoil_colors),
            "a face turned over": ("stl_text_lf.stl", lambda model: model.faces[0].points.reverse()),
            "a face lost": ("ply_ascii_lf.ply", lambda model: model.faces.pop()),
            "a material": ("obj_two_libraries.obj", spoil_material), "alpha": ("obj_mtl_blanks.obj", spoil_alpha),
            "a picture": ("obj_mtl_blanks.obj", spoil_texture),
            "a word that nobody says": ("stl_text_lf.stl", lambda model: model.unread.add("unheard")),
            "a name that nobody has": ("stl_text_lf.stl", lambda model: model.names.append("unheard"))}


class Judge:
    def __init__(self, meshlode, folder):
        self.meshlode, self.folder, self.failed, self.flagged = meshlode, folder, 0, []

    def run(self, *arguments):
        return subprocess.run([self.meshlode, *arguments], capture_output=True, check=False, text=True, errors="replace")

    def asset_of(self, path):
        return os.path.join(self.folder, os.path.basename(path) + ".lode")

    def build(self, path, arguments=()):
        done = self.run("build", path, "-o", self.asset_of(path), "--attributes", "all", "--error-tier", "qem", "--quiet",
                        "--jobs", "1", *arguments)
        if done.returncode == 0:
            return True
        self.fail(path, [f"does not build: {done.stderr.strip()}"])
        return False

    def fail(self, path, findings):
        for finding in findings[:MAX_FINDINGS]:
            print(f"FAILED: {os.path.basename(path)}: {finding}")
        if findings:
            self.failed += 1
            self.flagged.append(os.path.basename(path))

    def findings(self, path, model):
        """\\pre the asset is there"""
        asset, glb = self.asset_of(path), os.path.join(self.folder, "level0.glb")
        done = self.run("extract", asset, "--level", "0", "-o", glb, "--quiet")
        if done.returncode != 0:
            return [f"level 0 is not extracted: {done.stderr.strip()}"]
        return Match(model, glb, json.loads(self.run("info", asset, "--format", "json").stdout)).run()


def run_cases(judge, names):
    scenes = os.path.join(judge.folder, "scenes")
    os.mkdir(scenes)
    cases = odd_polygons.write_all(scenes)
    built = {}
    for path, area, arguments in cases:
        name = os.path.basename(path)
        if names and name not in names:
            continue
        total = Sum()
        for face in without_copies(polygons.read(path).faces):
            total.add(face, (0.0, 0.0, 0.0))
        if abs(total.values[0] - area) > 1e-6 * area:
            print(f"FAILED: the second reader reads an area of {total.values[0]} of {name}, which has {area}")
            judge.failed += 1
        if judge.build(path, arguments):
            built[name] = path
            judge.fail(path, judge.findings(path, polygons.read(path)))
    for what, (name, spoil) in SPOILERS.items():
        if name not in built or name in judge.flagged:
            continue
        model = polygons.read(built[name])
        spoil(model)
        if not judge.findings(built[name], model):
            print(f"FAILED: {name} with {what} spoilt passes")
            judge.failed += 1
    print(f"{len(cases)} cases, {len(judge.flagged)} differ: {' '.join(judge.flagged)}")


def run_files(judge, patterns):
    paths = sorted(path for pattern in patterns for path in glob.glob(pattern) if os.path.getsize(path) <= MAX_BYTES)
    if not paths:
        print("SKIPPED: none of these files is there")
        return 77
    for path in paths:
        if judge.build(path):
            judge.fail(path, judge.findings(path, polygons.read(path)))
    print(f"{len(paths)} files, {len(judge.flagged)} differ: {' '.join(judge.flagged)}")
    return 0


def main(arguments):
    meshlode, what = arguments[:2]
    with tempfile.TemporaryDirectory() as folder:
        judge = Judge(meshlode, folder)
        code = run_files(judge, arguments[2:]) if what == "files" else run_cases(judge, arguments[2:])
        if code == 77:
            return code
        print("FAILED" if judge.failed else "PASSED")
        return 1 if judge.failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
