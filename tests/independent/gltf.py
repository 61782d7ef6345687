# SPDX-License-Identifier: GPL-3.0-or-later
"""A second reader of glTF 2.0, written from the specification (Khronos, glTF 2.0.1) and with Python's standard library
alone: accessors of every type, sparse ones, strips and fans, node transforms, skins (skins.py), materials and images. It
reads sound files and refuses nothing but what it does not do (Draco, meshopt): whether a file is sound is not its
question."""

import base64
import json
import math
import os
import struct
from urllib.parse import unquote

from rules import NONE, Unsupported
from skins import Skins, pose

COMPONENTS = {5120: ("b", 1, 127), 5121: ("B", 1, 255), 5122: ("h", 2, 32767), 5123: ("H", 2, 65535), 5125: ("I", 4, 0),
              5126: ("f", 4, 0)}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
IDENTITY = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))


def as_f32(value):
    return struct.unpack("<f", struct.pack("<f", value))[0]


def split_glb(data):
    """(JSON text, binary chunk or None): section 4.4."""
    if data[:4] != b"glTF":
        return data, None
    length, = struct.unpack_from("<I", data, 8)
    at, text, binary = 12, None, None
    while at + 8 <= length:
        size, kind = struct.unpack_from("<II", data, at)
        body = data[at + 8:at + 8 + size]
        if kind == 0x4E4F534A and text is None:
            text = body
        elif kind == 0x004E4942 and binary is None:
            binary = body
        at += 8 + size
        # Padding is part of a chunk, but not all writers have it, nor do all of them count it.
        if not (at + 8 <= length and struct.unpack_from("<I", data, at + 4)[0] == 0x004E4942):
            at = (at + 3) // 4 * 4
    return text, binary


def multiply(a, b):
    return tuple(tuple(sum(a[r][k] * b[k][c] for k in range(4)) for c in range(4)) for r in range(4))


def local_matrix(node):
    """Rows of the 4 x 4 matrix: `matrix` is column-major; else T * R * S (section 3.5.3)."""
    if "matrix" in node:
        m = node["matrix"]
        return tuple(tuple(float(m[4 * c + r]) for c in range(4)) for r in range(4))
    x, y, z, w = node.get("rotation", (0.0, 0.0, 0.0, 1.0))
    length = math.sqrt(x * x + y * y + z * z + w * w)
    x, y, z, w = x / length, y / length, z / length, w / length
    s, t = node.get("scale", (1.0, 1.0, 1.0)), node.get("translation", (0.0, 0.0, 0.0))
    r = ((1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
         (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
         (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)))
    return tuple(tuple(r[i][k] * s[k] for k in range(3)) + (float(t[i]),) for i in range(3)) + (IDENTITY[3],)


class Gltf:
    """`root` is the JSON tree; `buffers` the bytes of the buffers. `blobs` (bytes by number) stand in for the files of a
    document that an asset carries, whose images and buffers name entries of BLBT."""

    def __init__(self, path=None, root=None, blobs=None):
        self.folder, self.blobs, self.cache = os.path.dirname(path or ""), blobs, {}
        binary = None
        if root is None:
            with open(path, "rb") as file:
                text, binary = split_glb(file.read())
            root = json.loads(text.rstrip(b"\0 "))
        self.root = root
        self.buffers = []
        for i, buffer in enumerate(root.get("buffers", [])):
            data = binary if i == 0 and binary is not None and "uri" not in buffer else self.bytes_of(buffer)
            self.buffers.append(data)
        self.cut_parents()
        self.expand_instances()
        self.posed = {}
        if self.root.get("skins") and self.root.get("meshes"):
            try:
                self.posed = Skins(self, local_matrix, multiply).settle()
            except KeyError:  # a document without its geometry
                pass
        if len(self.root.get("meshes", [])) > 1:
            self.merge_meshes()

    def cut_parents(self):
        """A node that a scene lists is a root, whatever is above it (docs/reference/input.md)."""
        roots = {n for scene in self.root.get("scenes", []) for n in scene.get("nodes", [])}
        for node in self.root.get("nodes", []):
            children = node.pop("children", [])
            if children := [c for c in children if c not in roots]:
                node["children"] = children

    def merge_meshes(self):
        """Of equal meshes the first is drawn in the place of the others, which lose their primitives (docs/reference/input.md)."""
        kept = ("POSITION", "NORMAL", "COLOR_0", "TEXCOORD_0", "TEXCOORD_1", "TEXCOORD_2", "TEXCOORD_3")
        first, place = {}, {}
        try:
            for m, mesh in enumerate(self.root["meshes"]):
                parts = [(material, "TANGENT" in attributes, triangles,
                          [(name, attributes[name]) for name in kept if name in attributes])
                         for attributes, triangles, material in self.primitives(m)]
                variants = [p.get("extensions", {}).get("KHR_materials_variants") for p in mesh["primitives"]]
                if any(part[2] for part in parts):
                    place[m] = first.setdefault(repr((parts, variants)), m)
        except (Unsupported, KeyError):  # what cannot be read here, or is a document without its geometry
            return
        for m, other in place.items():
            if m != other:
                self.root["meshes"][m]["primitives"] = []
        for node in self.root.get("nodes", []):
            if "mesh" in node:
                node["mesh"] = place.get(node["mesh"], node["mesh"])

    def expand_instances(self):
        """EXT_mesh_gpu_instancing: a node for each instance (docs/reference/input.md), behind the others."""
        added, nodes = [], self.root.get("nodes", [])
        for n, node in enumerate(nodes):
            instancing = node.get("extensions", {}).pop("EXT_mesh_gpu_instancing", None)
            if instancing is None:
                continue
            if not node["extensions"]:
                del node["extensions"]
            if "mesh" not in node:
                continue
            rows = {name: self.accessor(index) for name, index in instancing["attributes"].items()}
            mesh, first = node.pop("mesh"), len(nodes) + len(added)
            count = len(next(iter(rows.values())))
            for i in range(count):
                instance = {"name": f"{node.get('name') or f'node {n}'}[{i}]", "mesh": mesh}
                if "TRANSLATION" in rows:
                    instance["translation"] = list(rows["TRANSLATION"][i])
                if "ROTATION" in rows:
                    x, y, z, w = rows["ROTATION"][i]
                    length = math.sqrt(x * x + y * y + z * z + w * w)
                    instance["rotation"] = [x / length, y / length, z / length, w / length]
                if "SCALE" in rows:
                    instance["scale"] = list(rows["SCALE"][i])
                added.append(instance)
            children = list(range(first, first + count)) + node.get("children", [])
            if children:
                node["children"] = children
        nodes += added

    def bytes_of(self, item):
        """The bytes of an image or a buffer; None where it names none."""
        if "blob" in item and self.blobs is not None:
            return self.blobs[item["blob"]]
        if "bufferView" in item:
            return self.view(item["bufferView"])[0]
        uri = item.get("uri")
        if uri is None:
            return None
        if uri.startswith("data:"):
            head, _, text = uri.partition(",")
            if head.endswith(";base64"):
                return base64.b64decode("".join(unquote(text).split()))
            return unquote(text, "latin-1").encode("latin-1")
        for name in (unquote(uri), uri):  # "100%wood.png" is no escape
            path = os.path.join(self.folder, name)
            if os.path.exists(path):
                with open(path, "rb") as file:
                    return file.read()
        return None

    def view(self, index):
        """(bytes, stride or None)"""
        view = self.root["bufferViews"][index]
        if any(name.endswith("_meshopt_compression") for name in view.get("extensions", {})):
            raise Unsupported("EXT_meshopt_compression")
        at = view.get("byteOffset", 0)
        return self.buffers[view["buffer"]][at:at + view["byteLength"]], view.get("byteStride")

    def accessor(self, index):
        """A list of tuples: numbers as the specification's section 3.6.2 has them, normalized where they say so."""
        if index not in self.cache:
            accessor = self.root["accessors"][index]
            kind, width = accessor["componentType"], WIDTHS[accessor["type"]]
            count = accessor["count"]
            rows = [(0,) * width] * count
            if "bufferView" in accessor:
                data, stride = self.view(accessor["bufferView"])
                rows = unpack_rows(data, accessor.get("byteOffset", 0), stride, kind, width, count)
            if "sparse" in accessor:
                sparse = accessor["sparse"]
                where, what = sparse["indices"], sparse["values"]
                places = unpack_rows(self.view(where["bufferView"])[0], where.get("byteOffset", 0), None,
                                     where["componentType"], 1, sparse["count"])
                values = unpack_rows(self.view(what["bufferView"])[0], what.get("byteOffset", 0), None, kind, width,
                                     sparse["count"])
                rows = list(rows)
                for (place,), value in zip(places, values):
                    rows[place] = value
            if accessor.get("normalized", False):
                largest = COMPONENTS[kind][2]
                rows = [tuple(max(c / largest, -1.0) for c in row) for row in rows]
            self.cache[index] = rows
        return self.cache[index]

    def primitives(self, mesh):
        """Those that have triangles: (attributes by name, triangles as triples of vertices, material or None)."""
        if mesh not in self.posed or not self.root["meshes"][mesh]["primitives"]:
            yield from self.stored_primitives(mesh)
            return
        source, matrices = self.posed[mesh]
        for attributes, triangles, material in self.stored_primitives(source):
            yield pose(attributes, triangles, matrices) + (material,)

    def stored_primitives(self, mesh):
        restarts = any(name.endswith("_mesh_primitive_restart") for key in ("extensionsUsed", "extensionsRequired")
                       for name in self.root.get(key, []))
        for primitive in self.root["meshes"][mesh]["primitives"]:
            mode = primitive.get("mode", 4)
            if mode < 4 or "POSITION" not in primitive["attributes"]:
                continue
            if "KHR_draco_mesh_compression" in primitive.get("extensions", {}):
                raise Unsupported("KHR_draco_mesh_compression")
            attributes = {name: self.accessor(a) for name, a in primitive["attributes"].items()}
            color = self.root["accessors"][primitive["attributes"].get("COLOR_0", 0)]
            if "COLOR_0" in attributes and color["componentType"] != 5126 and not color.get("normalized", False):
                if any(c > 1 for row in attributes["COLOR_0"] for c in row):  # whole numbers can only be meant normalized
                    largest = COMPONENTS[color["componentType"]][2]
                    attributes["COLOR_0"] = [tuple(c / largest for c in row) for row in attributes["COLOR_0"]]
            if "indices" in primitive:
                corners = [i for i, in self.accessor(primitive["indices"])]
            else:
                corners = list(range(len(attributes["POSITION"])))
            parts = [corners]
            if restarts and mode != 4 and "indices" in primitive:
                restart = 256 ** COMPONENTS[self.root["accessors"][primitive["indices"]]["componentType"]][1] - 1
                parts = [[]]
                for corner in corners:
                    if corner == restart:
                        parts.append([])
                    else:
                        parts[-1].append(corner)
            triangles = [t for part in parts for t in triangles_of(mode, part)]
            yield attributes, triangles, primitive.get("material")

    def instances(self):
        """(node, world matrix) of every visible node with a mesh, depth first over the default scene."""
        nodes, scenes = self.root.get("nodes", []), self.root.get("scenes", [])
        if scenes:
            roots = scenes[self.root.get("scene", 0)].get("nodes", [])
        else:
            children = {c for node in nodes for c in node.get("children", [])}
            roots = [n for n in range(len(nodes)) if n not in children]
        todo = [(n, IDENTITY) for n in reversed(roots)]
        while todo:
            n, parent = todo.pop()
            if not nodes[n].get("extensions", {}).get("KHR_node_visibility", {}).get("visible", True):
                continue
            world = multiply(parent, local_matrix(nodes[n]))
            if "mesh" in nodes[n]:
                yield n, world
            todo += [(c, world) for c in reversed(nodes[n].get("children", []))]

    def materials(self):
        for material in self.root.get("materials", []):
            pbr = material.get("pbrMetallicRoughness", {})
            factor, texture = pbr.get("baseColorFactor"), pbr.get("baseColorTexture")
            old = material.get("extensions", {}).get("KHR_materials_pbrSpecularGlossiness")
            if old is not None:  # where both are there the extension stands, with its own defaults
                factor, texture = old.get("diffuseFactor"), old.get("diffuseTexture")
            uv_set = NONE
            if texture is not None:
                moved = texture.get("extensions", {}).get("KHR_texture_transform", {})
                uv_set = moved.get("texCoord", texture.get("texCoord", 0))
            yield {"name": material.get("name", ""),
                   "alpha_mode": ("OPAQUE", "MASK", "BLEND").index(material.get("alphaMode", "OPAQUE")),
                   "base_color": tuple(as_f32(c) for c in factor or (1.0, 1.0, 1.0, 1.0)),
                   "alpha_cutoff": as_f32(material.get("alphaCutoff", 0.5)),
                   "double_sided": int(material.get("doubleSided", False)),
                   "base_color_texture": NONE if texture is None else texture["index"],
                   "base_color_uv_set": uv_set}

    def motions(self):
        """Rigid animations: a list for each of (node, path, interpolation, times, values), without weights and without joints
        that carry nothing else."""
        nodes = self.root.get("nodes", [])
        parent = {c: n for n, node in enumerate(nodes) for c in node.get("children", [])}
        shown = set()
        for n in (n for n, node in enumerate(nodes) if node.keys() & {"mesh", "camera", "extensions"}):
            while n is not None and n not in shown:
                shown.add(n)
                n = parent.get(n)
        joints = {n for skin in self.root.get("skins", []) for n in skin["joints"]} - shown
        for animation in self.root.get("animations", []):
            rows = []
            for channel in animation["channels"]:
                target, sampler = channel["target"], animation["samplers"][channel["sampler"]]
                if "node" in target and target["path"] != "weights" and target["node"] not in joints:
                    how = sampler.get("interpolation", "LINEAR")
                    rows.append((target["node"], target["path"], how if isinstance(how, str) else "LINEAR",
                                 self.accessor(sampler["input"]), self.accessor(sampler["output"])))
            yield sorted(rows, key=lambda row: row[:3])


def unpack_rows(data, offset, stride, kind, width, count):
    letter, size, _ = COMPONENTS[kind]
    if stride in (None, width * size):
        values = struct.unpack_from(f"<{count * width}{letter}", data, offset)
        return [values[i:i + width] for i in range(0, count * width, width)]
    return [struct.unpack_from(f"<{width}{letter}", data, offset + i * stride) for i in range(count)]


def triangles_of(mode, corners):
    """Section 3.7.2.1: p_i of a strip is (v_i, v_(i + 1 + i % 2), v_(i + 2 - i % 2)), of a fan (v_(i+1), v_(i+2), v_0)."""
    v, n = corners, len(corners)
    if mode == 4:
        return [(v[i], v[i + 1], v[i + 2]) for i in range(0, n - n % 3, 3)]
    if mode == 5:
        return [(v[i], v[i + 1 + i % 2], v[i + 2 - i % 2]) for i in range(n - 2)]
    return [(v[i + 1], v[i + 2], v[0]) for i in range(n - 2)]
