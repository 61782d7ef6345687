# SPDX-License-Identifier: GPL-3.0-or-later
"""odd_scenes.py FOLDER FIRST LAST: writes one sound glTF scene a seed, stored in an odd but allowed way.

Every scene draws at random from what glTF 2.0 and KHR_mesh_quantization allow: component types, normalization, strides,
offsets, sparse accessors with and without a base, strips and fans with stitches, with and without indices, shared and
unused vertices, several materials and the default one, texture transforms, data URIs, escaped file names and GLB, node
trees with matrices, mirrors and shears, instances of EXT_mesh_gpu_instancing, several scenes, animations, and things
that are to be left out."""

import base64
import json
import math
import os
import random
import struct
import sys
import zlib

from odd_skins import add_skin

SIZES = {5120: ("b", 1), 5121: ("B", 1), 5122: ("h", 2), 5123: ("H", 2), 5125: ("I", 4), 5126: ("f", 4)}
LARGEST = {5120: 127, 5121: 255, 5122: 32767, 5123: 65535}
WIDTHS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4"}


def as_f32(value):
    return struct.unpack("<f", struct.pack("<f", value))[0]


def png(side, color):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    rows = b"".join(b"\0" + bytes(color) * side for _ in range(side))
    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", side, side, 8, 2, 0, 0, 0)) +
            chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


class Scene:
    def __init__(self, seed):
        self.random = random.Random(seed)
        self.root = {"asset": {"version": "2.0", "generator": f"seed {seed}"}, "accessors": [], "bufferViews": []}
        self.buffers = [bytearray() for _ in range(self.random.choice((1, 1, 2, 3)))]
        self.extensions = set()

    def view(self, data, stride=None):
        buffer = self.random.randrange(len(self.buffers))
        out = self.buffers[buffer]
        out += bytes(self.random.choice((0, 4, 12)) + -len(out) % 4)
        view = {"buffer": buffer, "byteLength": len(data)}
        if len(out) or self.random.random() < 0.5:
            view["byteOffset"] = len(out)
        if stride:
            view["byteStride"] = stride
        out += data
        self.root["bufferViews"].append(view)
        return len(self.root["bufferViews"]) - 1

    def accessor(self, rows, kind, normalized=False, is_vertex=True, name=None):
        """Stores rows of numbers of a component type, whichever way chance takes."""
        letter, size = SIZES[kind]
        width, r = len(rows[0]), self.random
        accessor = {"componentType": kind, "count": len(rows), "type": WIDTHS[width]}
        if normalized:
            accessor["normalized"] = True
        if name == "POSITION":
            accessor["min"] = [min(row[k] for row in rows) for k in range(width)]
            accessor["max"] = [max(row[k] for row in rows) for k in range(width)]
        sparse = {}
        if r.random() < 0.3 and len(rows) > 3:
            if r.random() < 0.3:  # no base: zeros but for the sparse ones
                sparse = {i: row for i, row in enumerate(rows) if any(row)}
                base = None
            else:
                sparse = {i: rows[i] for i in sorted(r.sample(range(len(rows)), r.randrange(1, len(rows) // 2 + 1)))}
                base = [tuple(r.randrange(0, 100) for _ in row) if i in sparse else row for i, row in enumerate(rows)]
        else:
            base = rows
        if base is not None:
            packed = [struct.pack(f"<{width}{letter}", *row) for row in base]
            stride, offset = width * size, 0
            if is_vertex:  # vertex attributes start at multiples of 4
                stride += -stride % 4 + r.choice((0, 0, 4, 20))
                offset = r.choice((0, 0, 8))
            elif r.random() < 0.3:
                offset = 2 * size
            gap = stride - width * size
            data = bytes(offset) + b"".join(p + bytes(gap) for p in packed)
            if gap and r.random() < 0.5:
                data = data[:-gap]  # the last element needs no gap behind it
            accessor["bufferView"] = self.view(data, stride if is_vertex and (gap or r.random() < 0.5) else None)
            if offset or r.random() < 0.3:
                accessor["byteOffset"] = offset
        if sparse:
            places = r.choice([k for k in (5121, 5123, 5125) if max(sparse) < (1 << 8 * SIZES[k][1]) - 1])
            places_at, values_at = r.choice((0, 4)), r.choice((0, 8))
            accessor["sparse"] = {
                "count": len(sparse),
                "indices": {"componentType": places, "byteOffset": places_at, "bufferView": self.view(
                    bytes(places_at) + struct.pack(f"<{len(sparse)}{SIZES[places][0]}", *sparse))},
                "values": {"byteOffset": values_at, "bufferView": self.view(
                    bytes(values_at) + b"".join(struct.pack(f"<{width}{letter}", *row) for row in sparse.values()))}}
        self.root["accessors"].append(accessor)
        return len(self.root["accessors"]) - 1

    def quantized(self, rows, kinds, limits):
        """(rows of integers or floats, component type, normalized): numbers of limits low … high, taken to the type's."""
        kind, normalized = self.random.choice(kinds)
        if kind == 5126:
            return [tuple(struct.unpack("<f", struct.pack("<f", c))[0] for c in row) for row in rows], kind, False
        if (kind, normalized) not in ((5121, True), (5123, True)):
            self.extensions.add("KHR_mesh_quantization")
        low, high = limits
        top = LARGEST[kind]
        bottom = -top if kind in (5120, 5122) and low < 0 else 0
        return [tuple(round(bottom + (c - low) / (high - low) * (top - bottom)) for c in row) for row in rows], kind, normalized

    def patch(self, n):
        """Positions in -1 … 1, normals, UVs 0 … 1 and colours 0 … 1 of an n x n patch, flat or with bumps."""
        r = self.random
        a, b, h = r.uniform(1, 5), r.uniform(1, 5), r.choice((0.0, 0.1, 0.3, 0.6))
        out = []
        for y in range(n + 1):
            for x in range(n + 1):
                u, v = x / n, y / n
                z = h * math.sin(a * u) * math.cos(b * v)
                slope = (-h * a * math.cos(a * u) * math.cos(b * v) / 2, h * b * math.sin(a * u) * math.sin(b * v) / 2, 1.0)
                length = math.sqrt(sum(c * c for c in slope))
                out.append(((2 * u - 1, 2 * v - 1, z), tuple(c / length for c in slope), (u, v), (v, u * v, 1 - u, 0.5 + u / 2)))
        return out

    def corners(self, n):
        """(mode, vertices in order): the patch as a list, as one stitched strip, or a fan of its border."""
        r, w = self.random, n + 1
        mode = r.choice((4, 4, 5, 6))
        if mode == 6:
            rim = ([x for x in range(w)] + [y * w + n for y in range(1, w)] + [n * w + x for x in range(n - 1, -1, -1)] +
                   [y * w for y in range(n - 1, 0, -1)])
            return mode, [(n // 2) * w + n // 2] + rim + rim[:1]
        if mode == 5:
            out = []
            for y in range(n):
                row = [v for x in range(w) for v in (y * w + x + w, y * w + x)]
                out += ([out[-1], row[0]] if out else []) + row  # two corners more, so that each row starts even
            return mode, out
        triangles = []
        for y in range(n):
            for x in range(n):
                i = y * w + x
                triangles += [(i, i + 1, i + w + 1), (i, i + w + 1, i + w)]
        for _ in range(r.choice((0, 0, 3))):  # duplicates, turned or not, mirror images, degenerate ones
            a, b, c = r.choice(triangles)
            triangles.append(r.choice(((a, b, c), (b, c, a), (b, a, c), (a, a, b))))
        r.shuffle(triangles)
        return mode, [v for t in triangles for v in t] + [0] * r.choice((0, 0, 1, 2))

    def awkward(self, vertices, corners, n):
        """Needles narrower than any grid, hairs of no area, and one that closes a T-junction where the patch is flat."""
        r = self.random

        def add(like, position):
            vertices.append((position,) + vertices[like][1:])
            return len(vertices) - 1

        for _ in range(r.randrange(1, 4)):
            v, far = r.sample(range((n + 1) ** 2), 2)
            x, y, z = vertices[v][0]
            kind = r.randrange(3)
            if kind == 0:
                turn = [r.uniform(-1e-5, 1e-5) for _ in range(3)]
                corners += [v, add(v, (x + turn[0], y + turn[1], z + turn[2])), far]
            elif kind == 1:
                corners += [v, add(v, (r.uniform(-1.1, 1.1), y, z)), add(v, (r.uniform(-1.1, 1.1), y, z))]
            else:
                v -= v % (n + 1) == n
                a, b = vertices[v][0], vertices[v + 1][0]
                corners += [v, v + 1, add(v, ((a[0] + b[0]) / 2, a[1], a[2]))]

    def primitive(self, material_count):
        r = self.random
        n = r.randrange(2, 11)
        vertices = self.patch(n)
        mode, corners = self.corners(n)
        if mode == 4 and r.random() < 0.3:
            corners = corners[:len(corners) - len(corners) % 3]
            self.awkward(vertices, corners, n)
        if r.random() < 0.3:  # vertices that nothing names, in front and behind
            vertices = [vertices[0]] * 3 + vertices + [vertices[-1]] * r.choice((1, 900))
            corners = [v + 3 for v in corners]
        kinds = [k for k in (5121, 5123, 5125) if len(vertices) < (1 << 8 * SIZES[k][1]) - 1]
        primitive = {"attributes": {}}
        if r.random() < 0.75:
            primitive["indices"] = self.accessor([(v,) for v in corners], r.choice(kinds), is_vertex=False)
        else:
            vertices = [vertices[v] for v in corners]
        if mode != 4 or r.random() < 0.3:
            primitive["mode"] = mode
        place = [r.uniform(-0.4, 0.4) for _ in range(3)]
        positions = [tuple(c * 0.5 + p for c, p in zip(v[0], place)) for v in vertices]
        small = [(k, is_normalized) for k in (5120, 5121, 5122, 5123) for is_normalized in (False, True)]
        put = lambda name, rows, kind, normalized: primitive["attributes"].__setitem__(  # noqa: E731
            name, self.accessor(rows, kind, normalized, name=name))
        put("POSITION", *self.quantized(positions, [(5126, False)] * 6 + small, (-1.0, 1.0)))
        if r.random() < 0.7:
            put("NORMAL", *self.quantized([v[1] for v in vertices], ((5126, False), (5120, True), (5122, True)), (-1.0, 1.0)))
            if r.random() < 0.3:
                put("TANGENT", [(1.0, 0.0, 0.0, 1.0)] * len(vertices), 5126, False)
        for k in range(r.choice((0, 1, 1, 2, 4))):
            uvs = [(v[2][0] * (k + 1), 1 - v[2][1]) for v in vertices]
            put(f"TEXCOORD_{k}", *self.quantized(uvs, [(5126, False), (5121, True), (5123, True)] * 3 + small, (-1.0, 5.0)))
        if r.random() < 0.4:
            width = r.choice((3, 4))
            put("COLOR_0", *self.quantized([v[3][:width] for v in vertices], ((5126, False), (5121, True), (5123, True)),
                                           (0.0, 1.0)))
        if r.random() < 0.2:
            put("_TEMPERATURE", [(float(i),) for i in range(len(vertices))], 5126, False)
        if r.random() < 0.2:
            primitive["targets"] = [{"POSITION": primitive["attributes"]["POSITION"]}]
        if r.random() < 0.8 and material_count:
            primitive["material"] = r.randrange(material_count)
        return primitive

    def other_primitive(self):
        """Points and lines, to be left out."""
        return {"mode": self.random.choice((0, 1, 2, 3)),
                "attributes": {"POSITION": self.accessor([(0.0, 0.0, float(i)) for i in range(4)], 5126, name="POSITION")}}

    def materials(self):
        r = self.random
        out = []
        for i in range(r.randrange(0, 4)):
            material = {} if r.random() < 0.2 else {"name": r.choice(("stone", "Blätter", "", "a \"b\" \\ c"))}
            pbr = {}
            if r.random() < 0.7:
                pbr["baseColorFactor"] = [r.random() for _ in range(4)]
            if r.random() < 0.7:
                pbr["baseColorTexture"] = self.texture_info()
            if pbr or r.random() < 0.5:
                material["pbrMetallicRoughness"] = pbr
            if r.random() < 0.3:
                material["normalTexture"] = self.texture_info()
            if r.random() < 0.5:
                material["alphaMode"] = r.choice(("OPAQUE", "MASK", "BLEND"))
            if material.get("alphaMode") == "MASK" and r.random() < 0.5:
                material["alphaCutoff"] = r.random()
            if r.random() < 0.5:
                material["doubleSided"] = r.random() < 0.5
            if r.random() < 0.3:
                self.extensions.add("KHR_materials_pbrSpecularGlossiness")
                old = {}
                if r.random() < 0.6:
                    old["diffuseFactor"] = [r.random() for _ in range(4)]
                if r.random() < 0.6:
                    old["diffuseTexture"] = self.texture_info()
                material["extensions"] = {"KHR_materials_pbrSpecularGlossiness": old}
            if r.random() < 0.3:
                material["extras"] = {"note": [1, 2.5, None, "x"]}
            out.append(material)
        return out

    def texture_info(self):
        r = self.random
        info = {"index": r.randrange(2)}
        if r.random() < 0.5:
            info["texCoord"] = r.randrange(2)
        if r.random() < 0.4:
            self.extensions.add("KHR_texture_transform")
            transform = {"offset": [r.random(), r.random()], "rotation": r.random()}
            if r.random() < 0.5:
                transform["texCoord"] = r.randrange(3)
            info["extensions"] = {"KHR_texture_transform": transform}
        return info

    def nodes(self, mesh_count):
        r = self.random
        nodes = []
        for _ in range(r.randrange(1, 9)):
            node = {} if r.random() < 0.2 else {"name": r.choice(("a", "Knoten", "a", "x/y"))}
            if r.random() < 0.7:
                node["mesh"] = r.randrange(mesh_count)
            how = r.random()
            if how < 0.4:
                matrix = [r.uniform(-2, 2) for _ in range(16)]
                matrix[3], matrix[7], matrix[11], matrix[15] = 0, 0, 0, 1
                node["matrix"] = matrix
            elif how < 0.9:
                if r.random() < 0.7:
                    node["translation"] = [r.uniform(-1e3, 1e3) for _ in range(3)]
                if r.random() < 0.7:
                    q = [r.gauss(0, 1) for _ in range(4)]
                    length = math.sqrt(sum(c * c for c in q))
                    node["rotation"] = [c / length for c in q]
                if r.random() < 0.7:
                    node["scale"] = [r.choice((-1, 1)) * r.uniform(0.1, 3) for _ in range(3)]
            if r.random() < 0.3:
                node["extras"] = {"key": len(nodes)}
            if r.random() < 0.15:
                self.extensions.add("EXT_mesh_gpu_instancing")
                node["extensions"] = {"EXT_mesh_gpu_instancing": {"attributes": self.instance_attributes()}}
            if r.random() < 0.15:
                self.extensions.add("KHR_node_visibility")
                node.setdefault("extensions", {})["KHR_node_visibility"] = {"visible": r.random() < 0.5}
            nodes.append(node)
        order = list(range(len(nodes)))
        r.shuffle(order)
        for i in range(1, len(order)):  # each under an earlier one, or a root of its own
            if r.random() < 0.7:
                nodes[order[r.randrange(i)]].setdefault("children", []).append(order[i])
        children = {c for node in nodes for c in node.get("children", [])}
        roots = [n for n in range(len(nodes)) if n not in children]
        self.root["nodes"] = nodes
        how = r.random()
        if how < 0.6:
            self.root["scenes"] = [{"nodes": roots, "name": "all"}]
            if r.random() < 0.3:  # as UniGLTF does: a parent that no scene lists, which moves nothing
                nodes.append({"name": "tmpParent", "translation": [5, 6, 7], "children": r.sample(roots, r.randint(1, len(roots)))})
            if r.random() < 0.7:
                self.root["scene"] = 0
        elif how < 0.85:
            self.root["scenes"] = [{"nodes": [roots[0]]}, {"nodes": roots}]
            self.root["scene"] = r.randrange(2)
        if r.random() < 0.4:
            times = self.accessor([(0.0,), (0.5,), (2.0,)], 5126, is_vertex=False)
            moves = self.accessor([(0.0, 0.0, 1.0), (1.0, 2.0, 3.0), (4.0, 0.0, 0.0)], 5126, is_vertex=False)
            turns = self.accessor([(0, 0, 0, 127), (127, 0, 0, 0), (0, 127, 0, 0)], 5120, True, is_vertex=False)
            moving = [n for n, node in enumerate(nodes) if "matrix" not in node]
            if moving:
                self.root["animations"] = [{
                    "samplers": [{"input": times, "output": moves}, {"input": times, "output": turns, "interpolation": "STEP"}],
                    "channels": [{"sampler": 0, "target": {"node": r.choice(moving), "path": "translation"}},
                                 {"sampler": 1, "target": {"node": r.choice(moving), "path": "rotation"}}]}]

    def instance_attributes(self):
        r, out = self.random, {}
        count = r.randrange(1, 6)
        if r.random() < 0.7:
            rows = [tuple(as_f32(r.uniform(-9, 9)) for _ in range(3)) for _ in range(count)]
            out["TRANSLATION"] = self.accessor(rows, 5126, is_vertex=False)
        if r.random() < 0.7:
            kind = r.choice((5120, 5122, 5126))
            rows = [tuple(as_f32(r.gauss(0, 1)) if kind == 5126 else r.randint(-LARGEST[kind], LARGEST[kind])
                          for _ in range(3)) + (1,) for _ in range(count)]
            out["ROTATION"] = self.accessor(rows, kind, kind != 5126, is_vertex=False)
        if r.random() < 0.5 or not out:
            rows = [tuple(as_f32(r.choice((-1, 1)) * r.uniform(0.1, 3)) for _ in range(3)) for _ in range(count)]
            out["SCALE"] = self.accessor(rows, 5126, is_vertex=False)
        if r.random() < 0.2:
            out["_ID"] = self.accessor([(i,) for i in range(count)], 5121, is_vertex=False)
        return out

    def build(self):
        r, root = self.random, self.root
        materials = self.materials()
        if materials:
            root["materials"] = materials
            root["samplers"] = [{"magFilter": 9729}]
            root["textures"] = [{"source": 0, "sampler": 0}, {"source": 1}]
        meshes = []
        for i in range(r.randrange(1, 4)):
            primitives = [self.primitive(len(materials)) for _ in range(r.randrange(1, 4))]
            if r.random() < 0.2:
                primitives.insert(r.randrange(len(primitives) + 1), self.other_primitive())
            mesh = {"primitives": primitives}
            if r.random() < 0.7:
                mesh["name"] = f"mesh {i}"
            # Morph targets: all primitives of a mesh have the same number of them.
            if any("targets" in p for p in primitives):
                for p in primitives:
                    p["targets"] = [{"POSITION": p["attributes"]["POSITION"]}]
            meshes.append(mesh)
        root["meshes"] = meshes
        self.nodes(len(meshes))
        add_skin(self)
        if self.extensions:
            root["extensionsUsed"] = sorted(self.extensions)
            required = [e for e in sorted(self.extensions) if e in ("KHR_mesh_quantization", "EXT_mesh_gpu_instancing")]
            if required:
                root["extensionsRequired"] = required
        return bool(materials)

    def write(self, folder, seed):
        r, root = self.random, self.root
        stem = os.path.join(folder, f"scene-{seed}")
        if self.build():
            images = [png(8, (255, 0, 0)), png(4, (0, 255, 9))]
            with open(stem + " ü.png", "wb") as file:
                file.write(images[1])
            inside = {"bufferView": self.view(images[0]), "mimeType": "image/png"}
            text = {"uri": "data:image/png;base64," + base64.b64encode(images[0]).decode()}
            root["images"] = [r.choice((inside, text)), {"uri": f"scene-{seed}%20%C3%BC.png", "name": "outside"}]
        is_glb = r.random() < 0.5
        buffers = []
        for i, data in enumerate(self.buffers):
            data += bytes(-len(data) % 4)
            buffer = {"byteLength": len(data)}
            if i > 0 or not is_glb:
                if r.random() < 0.5:
                    buffer["uri"] = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
                else:
                    buffer["uri"] = f"scene-{seed}%20{i}.bin"
                    with open(f"{stem} {i}.bin", "wb") as file:
                        file.write(data)
            if len(data):
                buffers.append(buffer)
            else:  # no view names it, and a buffer has at least one byte
                buffers.append({"byteLength": 1, "uri": "data:application/octet-stream;base64,AA=="})
        root["buffers"] = buffers
        if is_glb and len(self.buffers[0]) == 0:
            is_glb = False
        text = json.dumps(root).encode()
        if not is_glb:
            with open(stem + ".gltf", "wb") as file:
                file.write(text)
            return stem + ".gltf"
        text += b" " * (-len(text) % 4)
        binary = bytes(self.buffers[0])
        with open(stem + ".glb", "wb") as file:
            file.write(struct.pack("<4sIIII", b"glTF", 2, 28 + len(text) + len(binary), len(text), 0x4E4F534A) + text +
                       struct.pack("<II", len(binary), 0x004E4942) + binary)
        return stem + ".glb"


def main(arguments):
    folder, first, last = arguments[0], int(arguments[1]), int(arguments[2])
    os.makedirs(folder, exist_ok=True)
    for seed in range(first, last + 1):
        print(Scene(seed).write(folder, seed))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
