#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""measure.py MESHLODE MODELS DATA: the table of docs/log/plan.md.

What the plan of each scene leaves out and what that saves against `--keep all`, by `plan --measure`. MODELS has
FlightHelmet and dragon.glb, DATA is data/; a scene with vertex colours alone is made here.
"""
import json
import math
import os
import subprocess
import sys
import tempfile


def write_colors(path, n=100):
    """n x n quads of a gentle hill, a colour a vertex, neither normals nor texture coordinates."""
    with open(path, "w", encoding="ascii") as out:
        out.write("ply\nformat ascii 1.0\n")
        out.write(f"element vertex {(n + 1) * (n + 1)}\nproperty float x\nproperty float y\nproperty float z\n")
        out.write("property uchar red\nproperty uchar green\nproperty uchar blue\n")
        out.write(f"element face {n * n}\nproperty list uchar int vertex_indices\nend_header\n")
        for j in range(n + 1):
            for i in range(n + 1):
                z = 0.2 * math.sin(6.0 * i / n) * math.cos(5.0 * j / n)
                out.write(f"{i / n:.6f} {j / n:.6f} {z:.6f} {255 * i // n} {255 * j // n} {(i * j) % 256}\n")
        for j in range(n):
            for i in range(n):
                a = j * (n + 1) + i
                out.write(f"4 {a} {a + 1} {a + n + 2} {a + n + 1}\n")


def change(planned, everything):
    return f"{100.0 * (planned - everything) / everything:+.1f}%" if everything else "–"


def spread(figure, digits):
    return f"{figure['median']:.{digits}f} ({figure['smallest']:.{digits}f} … {figure['largest']:.{digits}f})"


def row(meshlode, path, extra):
    text = subprocess.run([meshlode, "plan", path, "--measure", "--format", "json", *extra], check=True,
                          capture_output=True).stdout
    plan = json.loads(text)
    out = {}
    for mesh in plan["meshes"]:
        for attribute in mesh["attributes"]:
            if not attribute["kept"]:
                out[attribute["name"]] = out.get(attribute["name"], 0) + 1
    left_out = ", ".join(f"{name} ({count} of {len(plan['meshes'])})" for name, count in sorted(out.items())) or "nothing"
    a, b = plan["measured"]["plan"], plan["measured"]["keep_all"]
    cells = [os.path.basename(path), left_out,
             f"{a['geometry_bytes']:,} / {b['geometry_bytes']:,} ({change(a['geometry_bytes'], b['geometry_bytes'])})",
             spread(a["build_seconds"], 2) + " / " + spread(b["build_seconds"], 2),
             spread(a["cpu_frame_ms"], 0) + " / " + spread(b["cpu_frame_ms"], 0)]
    if a["gpu_frame_ms"]:
        cells.append(spread(a["gpu_frame_ms"], 1) + " / " + spread(b["gpu_frame_ms"], 1))
    print("| " + " | ".join(cells) + " |", flush=True)


def main():
    meshlode, models, data = sys.argv[1:4]
    print("| scene | left out (meshes) | geometry bytes, plan / all | build seconds | CPU frame, ms | Vulkan frame, ms |")
    print("| --- | --- | --- | --- | --- | --- |")
    with tempfile.TemporaryDirectory() as folder:
        colors = os.path.join(folder, "colors.ply")
        write_colors(colors)
        scenes = [os.path.join(models, "FlightHelmet", "FlightHelmet.gltf"), os.path.join(data, "foliage.glb"),
                  os.path.join(data, "city.glb"), os.path.join(models, "dragon.glb"), colors]
        for scene in scenes:
            row(meshlode, scene, sys.argv[4:])


if __name__ == "__main__":
    main()
