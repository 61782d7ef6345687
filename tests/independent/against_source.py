# SPDX-License-Identifier: GPL-3.0-or-later
"""against_source.py MESHLODE seeds FIRST LAST
against_source.py MESHLODE models FILE...   (below the folder that MESHLODE_MODELS names)

Builds each scene with all its attributes and holds level 0 and the tables against the source (source_match.py). `seeds`
takes the scenes of odd_scenes.py, and then spoils what was read of them in one place after another: each kind of spoilt
source must be found, or the comparison could not fail. Exit code 77: there is nothing to compare with, and it says why."""

import copy
import os
import random
import subprocess
import sys
import tempfile

import odd_scenes
from source_match import MAX_FINDINGS, match

# What a scene must have had at least once over the seeds; else the generator no longer makes it.
SEEN = ("triangles", "corners of needles kept apart", "dropped", "flat normals", "instances", "materials", "images", "animations")


def change_triangle(change):
    """Applies `change(corners, i)` to a copy of some triangle with area; False where it does not apply."""

    def spoil(source):
        for i in range(len(source) // 2, len(source)):
            corners, material = source[i]
            if len({c.position for c in corners}) < 3:
                continue
            corners = [copy.copy(c) for c in corners]
            if change(corners) is False:
                continue
            for c in corners:
                c.exact = (c.position, c.normal if c.has_own_normal else (), c.uvs, c.color)
            source[i] = tuple(corners), material
            spoil.done = True
            return

    return spoil


def move_position(corners):
    corners[1].position = tuple((p + q) / 2 for p, q in zip(corners[0].position, corners[1].position))


def turn_over(corners):
    corners[0], corners[1] = corners[1], corners[0]


def tilt_normal(corners):
    if corners[0].normal is None or not corners[0].has_own_normal:
        return False
    x, y, z = corners[0].normal
    corners[0].normal = (x + 0.02, y - 0.02, z + 0.02)
    return None


def move_uv(corners):
    if not corners[2].uvs:
        return False
    corners[2].uvs = ((corners[2].uvs[0][0], corners[2].uvs[0][1] + 0.01),) + corners[2].uvs[1:]
    return None


def fade_color(corners):
    if corners[0].color is None:
        return False
    c = corners[0].color
    corners[0].color = c[:2] + (c[2] + (0.006 if c[2] < 0.5 else -0.006),) + c[3:]
    return None


def lose_triangle(source):
    if source:
        source.pop()
        lose_triangle.done = True


def other_material(source):
    if source and len({c.position for c in source[0][0]}) == 3:
        source[0] = source[0][0], source[0][1] + 1
        other_material.done = True


def move_instance(instances):
    if instances:
        node, world = instances[0]
        rows = [list(row) for row in world]
        rows[1][3] += 1e-9 * max(1.0, *(abs(row[3]) for row in rows[:3]))
        instances[0] = node, tuple(map(tuple, rows))
        move_instance.done = True
    return instances


def swap_axes(instances):
    if instances:
        node, world = instances[0]
        instances[0] = node, tuple((row[1], row[0]) + row[2:] for row in world)
        swap_axes.done = True
    return instances


def pale_material(materials):
    if materials:
        r, g, b, a = materials[0]["base_color"]
        materials[0]["base_color"] = r, g * 0.5 + 0.1, b, a
        pale_material.done = True


def show_both_sides(materials):
    if materials:
        materials[-1]["double_sided"] ^= 1
        show_both_sides.done = True


def rename_node(document):
    document["nodes"][0]["name"] = "another"
    rename_node.done = True


def move_key(document):
    """An animation's first time."""
    if document.get("animations"):
        document["animations"][0]["samplers"][0]["interpolation"] = "CUBICSPLINE"
        move_key.done = True


SPOILERS = {"a corner halfway to the next": ("triangles", change_triangle(move_position)),
            "a triangle turned over": ("triangles", change_triangle(turn_over)),
            "a normal by two degrees": ("triangles", change_triangle(tilt_normal)),
            "a UV by 0.01": ("triangles", change_triangle(move_uv)),
            "a colour by one and a half steps": ("triangles", change_triangle(fade_color)),
            "a triangle lost": ("triangles", lose_triangle),
            "another material": ("triangles", other_material),
            "an instance by 1e-9": ("instances", move_instance),
            "an instance with x and y exchanged": ("instances", swap_axes),
            "a material's colour": ("materials", pale_material),
            "a material's sides": ("materials", show_both_sides),
            "a node's name": ("document", rename_node),
            "an animation's interpolation": ("document", move_key)}


class Judge:
    def __init__(self, meshlode, folder):
        self.meshlode, self.asset, self.failed = meshlode, os.path.join(folder, "scene.lode"), 0
        self.counts = {}

    def build(self, path, tier):
        command = [self.meshlode, "build", path, "-o", self.asset, "--attributes", "all", "--codec", "none", "--quiet",
                   "--error-tier", tier]
        done = subprocess.run(command, capture_output=True, check=False, text=True)
        if done.returncode != 0:
            print(f"FAILED: {path} does not build: {done.stderr.strip()}")
            self.failed += 1
        return done.returncode == 0

    def compare(self, path):
        findings, counts = match(self.asset, path)
        for what, number in counts.items():
            self.counts[what] = self.counts.get(what, 0) + number
        for finding in findings[:MAX_FINDINGS]:
            print(f"FAILED: {os.path.basename(path)}: {finding}")
        self.failed += bool(findings)
        return counts

    def told(self):
        return ", ".join(f"{number} {what}" for what, number in sorted(self.counts.items()) if number)


def run_seeds(judge, folder, first, last):
    spoilt = {}
    for seed in range(first, last + 1):
        path = odd_scenes.Scene(seed).write(folder, seed)
        if not judge.build(path, "qem"):
            continue
        judge.compare(path)
        waiting = [name for name in SPOILERS if spoilt.get(name, 0) < 3]
        for name in random.Random(seed).sample(waiting, min(3, len(waiting))):
            part, function = SPOILERS[name]
            function.done = False
            findings, _ = match(judge.asset, path, (part, function))
            if not function.done:
                continue
            spoilt[name] = spoilt.get(name, 0) + 1
            if not findings:
                print(f"FAILED: {os.path.basename(path)} with {name} passes")
                judge.failed += 1
    for name in SPOILERS:
        if spoilt.get(name, 0) == 0:
            print(f"FAILED: {name}: no scene could be spoilt so")
            judge.failed += 1
    for what in SEEN:
        if judge.counts.get(what, 0) == 0:
            print(f"FAILED: no scene had {what}")
            judge.failed += 1
    print(f"seeds {first} to {last}: {judge.told()}; {sum(spoilt.values())} spoilt sources tried")


def run_models(judge, names):
    """77 where there are no models, and nobody asked for them."""
    folder = os.environ.get("MESHLODE_MODELS", "")
    if not os.path.isdir(folder):
        if os.environ.get("MESHLODE_REQUIRE_MODELS") == "1":
            print("FAILED: MESHLODE_MODELS names no folder and MESHLODE_REQUIRE_MODELS=1")
            return 1
        print("SKIPPED: set MESHLODE_MODELS to the folder of models to run this test")
        return 77
    for name in names:
        path = os.path.join(folder, name)
        if not os.path.exists(path):
            print(f"FAILED: {path} is not there")
            judge.failed += 1
        elif judge.build(path, "qem"):
            counts = judge.compare(path)
            print(f"{name}: " + ", ".join(f"{number} {what}" for what, number in counts.items() if number))
            if counts.get("triangles", 0) == 0:
                print(f"FAILED: {name}: nothing was compared")
                judge.failed += 1
    return 0


def main(arguments):
    meshlode, what = arguments[:2]
    with tempfile.TemporaryDirectory() as folder:
        judge = Judge(meshlode, folder)
        if what == "models":
            code = run_models(judge, arguments[2:])
            if code != 0:
                return code
        else:
            run_seeds(judge, folder, int(arguments[2]), int(arguments[3]))
        print("FAILED" if judge.failed else "PASSED")
        return 1 if judge.failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
