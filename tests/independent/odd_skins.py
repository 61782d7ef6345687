# SPDX-License-Identifier: GPL-3.0-or-later
"""Skins for the scenes of odd_scenes.py."""

import random
import struct


def as_f32(value):
    return struct.unpack("<f", struct.pack("<f", value))[0]


def add_skin(scene):
    """One mesh gets joints and weights, and the nodes that draw it get a skin: one in four scenes."""
    r = random.Random(f"skin {scene.root['asset']['generator']}")
    if r.random() > 0.25:
        return
    nodes, mesh = scene.root["nodes"], r.randrange(len(scene.root["meshes"]))
    joints = []
    for _ in range(r.choice((1, 2, 3))):
        joint = {"translation": [as_f32(r.uniform(-2, 2)) for _ in range(3)], "scale": [r.choice((-1, 0.5, 1, 2))] * 3}
        if r.random() < 0.5:
            nodes[r.randrange(len(nodes))].setdefault("children", []).append(len(nodes))
        elif "scenes" in scene.root:
            scene.root["scenes"][-1]["nodes"].append(len(nodes))
        joints.append(len(nodes))
        nodes.append(joint)
    skin = {"joints": joints}
    if r.random() < 0.7:
        rows = [tuple(as_f32(r.uniform(-1, 1)) for _ in range(12)) for _ in joints]
        rows = [sum((row[3 * c:3 * c + 3] + ((1.0,) if c == 3 else (0.0,)) for c in range(4)), ()) for row in rows]
        data = b"".join(struct.pack("<16f", *row) for row in rows)
        scene.root["accessors"].append({"bufferView": scene.view(data), "componentType": 5126, "count": len(rows),
                                       "type": "MAT4"})
        skin["inverseBindMatrices"] = len(scene.root["accessors"]) - 1
    scene.root["skins"] = [skin]
    is_rigid = r.random() < 0.3  # all of it by one joint
    for primitive in scene.root["meshes"][mesh]["primitives"]:
        if primitive.get("mode", 4) < 4:
            continue
        count = scene.root["accessors"][primitive["attributes"]["POSITION"]]["count"]
        for n in range(r.choice((1, 1, 2))):
            kind = r.choice((5121, 5123))
            rows = [tuple(0 if is_rigid else r.randrange(len(joints)) for _ in range(4)) for _ in range(count)]
            primitive["attributes"][f"JOINTS_{n}"] = scene.accessor(rows, kind)
            rows = [tuple(r.choice((0, 0, 64, 100, 255)) for _ in range(4)) for _ in range(count)]
            if r.random() < 0.5:
                primitive["attributes"][f"WEIGHTS_{n}"] = scene.accessor(rows, 5121, True)
            else:
                rows = [tuple(as_f32(w / 255) for w in row) for row in rows]
                primitive["attributes"][f"WEIGHTS_{n}"] = scene.accessor(rows, 5126)
    for node in nodes:
        if node.get("mesh") == mesh and "EXT_mesh_gpu_instancing" not in node.get("extensions", {}):
            if r.random() < 0.8:
                node["skin"] = 0
