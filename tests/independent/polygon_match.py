# SPDX-License-Identifier: GPL-3.0-or-later
"""Holds level 0 of an asset, as `extract` writes it, against what polygons.py reads of a PLY, OBJ or STL: for each material
area, the vector of areas, first moments, volume, and integrals of UVs (also times the position, so that no two corners can
be exchanged), colours and normals; boxes, triangles, materials, names, and what had to be named as left out.

Polygons are cut into ears twice, from two ends. What depends on the cut (a polygon that is not flat, UVs that are not
affine) may differ by as much as the two do; all else by what the grid and the steps that `info` states can do."""

import math
import os

from gltf import Gltf
from polygons import Face

QUANTITIES = [("area", 1), ("area vector", 3), ("moment", 3), ("volume", 1), ("UV", 2), ("UV times position", 6),
              ("colour", 4), ("normal", 3)]
WIDTH = sum(width for _, width in QUANTITIES)
COLOR_STEP = 0.5 / 255.0 + 1e-6


def sub(a, b):
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def length(a):
    return math.sqrt(dot(a, a))


def newell(points):
    """Twice the vector of the polygon's area, whatever its shape."""
    total = (0.0, 0.0, 0.0)
    for i in range(1, len(points) - 1):
        n = cross(sub(points[i], points[0]), sub(points[i + 1], points[0]))
        total = tuple(t + c for t, c in zip(total, n))
    return total


def ears(points, order):
    """Triangles as triples of corner numbers; holes may be joined to the outline by bridges."""
    normal = newell(points)
    axis = max(range(3), key=lambda k: abs(normal[k]))
    u, v = ((1, 2), (2, 0), (0, 1))[axis]
    sign = 1.0 if normal[axis] > 0.0 else -1.0
    flat = [(p[u], p[v] * sign) for p in points]

    def side(a, b, c):
        (ax, ay), (bx, by), (cx, cy) = flat[a], flat[b], flat[c]
        return (bx - ax) * (cy - ay) - (by - ay) * (cx - ax)

    def blocks(p, a, b, c):
        return flat[p] not in (flat[a], flat[b], flat[c]) and \
            side(a, b, p) >= 0.0 and side(b, c, p) >= 0.0 and side(c, a, p) >= 0.0

    left, out = list(order), []
    while len(left) > 3:
        best = None
        for i in range(len(left)):
            a, b, c = left[i - 1], left[i], left[(i + 1) % len(left)]
            if side(a, b, c) > 0.0 and not any(blocks(p, a, b, c) for p in left):
                best = i
                break
        if best is None:  # corners on a line, or an outline that crosses itself
            best = min(range(len(left)), key=lambda i: abs(side(left[i - 1], left[i], left[(i + 1) % len(left)])))
        out.append((left[best - 1], left[best], left[(best + 1) % len(left)]))
        del left[best]
    return out + [tuple(left)]


def integrals(points, uvs, normals, colors, center):
    """Of one triangle. Products of two linear functions: A / 12 (sum f sum g + sum f g)."""
    a, b, c = (sub(p, center) for p in points)
    vector = cross(sub(b, a), sub(c, a))
    double = length(vector)
    if double == 0.0:
        return [0.0] * WIDTH
    area = 0.5 * double
    flat = tuple(x / double for x in vector)
    mean = lambda rows: [area * sum(row[k] for row in rows) / 3.0 for k in range(len(rows[0]))]  # noqa: E731
    uvs, colors = uvs or [(0.0, 0.0)] * 3, colors or [(1.0, 1.0, 1.0, 1.0)] * 3
    normals = [tuple(x / length(n) for x in n) if length(n) > 0.0 else flat for n in normals or [flat] * 3]
    mixed = []
    for k in range(2):
        f = [uv[k] for uv in uvs]
        for axis in range(3):
            g = (a[axis], b[axis], c[axis])
            mixed.append(area / 12.0 * (sum(f) * sum(g) + dot(f, g)))
    return [area, *(0.5 * x for x in vector), *mean((a, b, c)), dot(a, cross(b, c)) / 6.0, *mean(uvs), *mixed,
            *mean(colors), *mean(normals)]


class Sum:
    """Integrals over the faces of one material, and by how much they may be off."""

    def __init__(self):
        self.values, self.slack, self.triangles, self.flat = [0.0] * WIDTH, [0.0] * WIDTH, 0, 0
        self.area = self.edges = 0.0
        self.largest = {"uv": 0.0, "position": 0.0}

    def add(self, face, center):
        n = len(face.points)
        cuts = [ears(face.points, order) for order in (range(n), [*range(1, n), 0])[:n - 2]]
        sums = []
        for cut in cuts:
            total = [0.0] * WIDTH
            for t in cut:
                take = lambda rows, t=t: None if rows is None else [rows[i] for i in t]  # noqa: E731
                one = integrals(take(face.points), take(face.uvs), take(face.normals), take(face.colors), center)
                total = [x + y for x, y in zip(total, one)]
                self.flat += one[0] == 0.0 and cut is cuts[0]
            sums.append(total)
        self.values = [x + y for x, y in zip(self.values, sums[0])]
        if len(sums) == 2:
            self.slack = [s + 2.0 * abs(x - y) for s, x, y in zip(self.slack, *sums)]
        self.triangles += n - 2
        self.area += sums[0][0]
        self.edges += sum(length(sub(face.points[i], face.points[i - 1])) for i in range(n)) * (1 if n == 3 else 3)
        far = max(length(sub(p, center)) for p in face.points)
        self.largest["position"] = max(self.largest["position"], far)
        for uv in face.uvs or []:
            self.largest["uv"] = max(self.largest["uv"], abs(uv[0]), abs(uv[1]))

    def tolerances(self, steps):
        """What moves of a corner by `position`, of a UV by `uv` and so on can do to each integral."""
        d, r, u = steps["position"], self.largest["position"], self.largest["uv"]
        area = 0.5 * self.edges * d + 1e-9 * self.area
        uv = area * u + self.area * steps["uv"]
        normal = area + self.area * (steps["normal"] + 1e-3)
        bounds = {"area": area, "area vector": area, "moment": area * r + self.area * d,
                  "volume": area * r + self.area * d, "UV": uv, "UV times position": uv * r + self.area * u * d,
                  "colour": area + self.area * COLOR_STEP, "normal": normal}
        rows = [bounds[name] for name, width in QUANTITIES for _ in range(width)]
        return [bound * 1.01 + slack for bound, slack in zip(rows, self.slack)]


def extracted_faces(gltf):
    """Triangles; their material is its index or None."""
    for n, world in gltf.instances():
        assert all(world[r][c] == (1.0 if r == c else 0.0) for r in range(3) for c in range(3)), "no pure translation"
        offset = tuple(row[3] for row in world[:3])
        for attributes, triangles, material in gltf.primitives(gltf.root["nodes"][n]["mesh"]):
            rows = [attributes.get(name) for name in ("TEXCOORD_0", "NORMAL", "COLOR_0")]
            if rows[2] is not None and len(rows[2][0]) == 3:
                rows[2] = [c + (1.0,) for c in rows[2]]
            for t in triangles:
                points = [tuple(x + o for x, o in zip(attributes["POSITION"][i], offset)) for i in t]
                yield Face(points, material, *(None if r is None else [r[i] for i in t] for r in rows))


def without_copies(faces):
    """A build keeps the first of triangles on the same points in the same order; what has no area is not drawn."""
    seen = set()
    for face in faces:
        if len(face.points) < 3:
            continue
        first = min(range(len(face.points)), key=lambda i: face.points[i])
        key = face.material, tuple(face.points[first:] + face.points[:first])
        if key not in seen:
            seen.add(key)
            yield face


class Match:
    def __init__(self, model, glb, info):
        self.model, self.gltf, self.info, self.findings = model, Gltf(glb), info, []
        self.left_out = " | ".join(f"{item['what']}: {item['why']}" for item in info["left_out"])

    def expect(self, holds, words):
        if not holds:
            self.findings.append(words)

    def is_named(self, word):
        """As a word of its own."""
        padded = "".join(c if c.isalnum() or c in "_-." else " " for c in self.left_out.lower())
        return f" {word.lower()} " in f" {padded} "

    def key_of(self, material):
        """What the material of a primitive is called in the source; None: it has none."""
        if material is None:
            return None
        record = self.gltf.root["materials"][material]
        if not self.model.by_texture:
            name = record.get("name")
            return name if name in self.model.materials else None
        data = self.texture_bytes(record.get("pbrMetallicRoughness", {}).get("baseColorTexture"))
        for name, wanted in self.model.materials.items():
            if data is not None and data == read_bytes(wanted.textures.get("map_kd")):
                return name
        return None

    def texture_bytes(self, reference):
        if reference is None:
            return None
        texture = self.gltf.root["textures"][reference["index"]]
        return self.gltf.bytes_of(self.gltf.root["images"][texture["source"]])

    def run(self):
        faces = list(without_copies(self.model.faces))
        points = [p for face in faces for p in face.points]
        low = [min((p[k] for p in points), default=0.0) for k in range(3)]
        high = [max((p[k] for p in points), default=0.0) for k in range(3)]
        center = tuple((a + b) / 2.0 for a, b in zip(low, high))
        expected, found = {}, {}
        for face in faces:
            if face.uvs is not None:  # theirs begin below, glTF's above
                face.uvs = [(u, 1.0 - v) for u, v in face.uvs]
            key = face.material if face.material in self.model.materials else None
            expected.setdefault(key, Sum()).add(face, center)
        corners = []
        keys = {m: self.key_of(m) for m in (None, *range(len(self.gltf.root.get("materials", []))))}
        for triangle in extracted_faces(self.gltf):
            found.setdefault(keys[triangle.material], Sum()).add(triangle, center)
            corners += triangle.points
        self.match_sums(expected, found)
        step = self.steps()["position"] * 1.01 + 1e-9
        for k in range(3):
            box = min((p[k] for p in corners), default=0.0), max((p[k] for p in corners), default=0.0)
            self.expect(abs(box[0] - low[k]) <= step and abs(box[1] - high[k]) <= step,
                        f"box along {'xyz'[k]}: {box}, not {(low[k], high[k])}")
        self.match_materials()
        names = {item.get("name") for kind in ("meshes", "nodes") for item in self.gltf.root.get(kind, [])}
        for name in self.model.names:
            is_cut = any(item["why"].endswith("…") for item in self.info["left_out"])  # a list of the first
            self.expect(name in names or name in self.left_out or is_cut, f"no word of the object or group {name!r}")
        for word in sorted(self.model.unread):
            self.expect(self.is_named(word), f"no word of {word!r}, which is not carried")
        whats = [item["what"] for item in self.info["left_out"]]
        self.expect(len(whats) == len(set(whats)), "left_out names something twice")
        return self.findings

    def steps(self):
        """The largest moves that the asset's own statements allow, over its meshes."""
        settings = self.info["settings"]
        texels = 2048.0 if settings["uv_error_unit"] == "texels" else 1.0  # no texture counts as smaller
        return {"position": max((m["level0_deviation"] for m in self.info["meshes"]), default=0.0),
                "uv": settings["uv_error"] / texels + 2.0 ** -20,
                "normal": math.radians(settings["normal_error"])}

    def match_sums(self, expected, found):
        steps = self.steps()
        for key in sorted(set(expected) | set(found), key=str):
            want, have = expected.get(key, Sum()), found.get(key, Sum())
            about = f"material {key!r}: " if key is not None or len(expected) > 1 else ""
            self.expect(want.triangles - want.flat <= have.triangles <= want.triangles,
                        f"{about}{have.triangles} triangles, not {want.triangles}")
            bounds, at = want.tolerances(steps), 0
            for name, width in QUANTITIES:
                a, b, bound = have.values[at:at + width], want.values[at:at + width], bounds[at:at + width]
                off = max(abs(x - y) - t for x, y, t in zip(a, b, bound))
                told = [tuple(round(x, 4) for x in row) for row in (a, b)]
                self.expect(off <= 0.0, f"{about}{name} {told[0]}, not {told[1]}")
                at += width

    def match_materials(self):
        records = {m.get("name"): m for m in self.gltf.root.get("materials", [])}
        for name, want in sorted(self.model.materials.items()):
            record = records.get(name)
            if self.model.by_texture or not any(face.material == name for face in self.model.faces):
                continue
            if record is None:
                self.expect(False, f"material {name!r} is not there")
                continue
            self.match_material(name, want, record)

    def match_material(self, name, want, record):
        pbr = record.get("pbrMetallicRoughness", {})
        color = pbr.get("baseColorFactor", (1.0, 1.0, 1.0, 1.0))
        self.expect(max(abs(a - b) for a, b in zip(color, want.color + (want.alpha,))) < 1e-6,
                    f"material {name!r}: colour {color}, not {want.color + (want.alpha,)}")
        modes = ("MASK", "BLEND") if "map_d" in want.textures else ("BLEND",) if want.alpha < 1.0 else ("OPAQUE",)
        mode = record.get("alphaMode", "OPAQUE")
        self.expect(mode in modes or ("map_d" in want.textures and self.is_named("map_d")),
                    f"material {name!r} is {mode}, not {' or '.join(modes)}")
        strength = record.get("extensions", {}).get("KHR_materials_emissive_strength", {}).get("emissiveStrength", 1.0)
        emissive = tuple(c * strength for c in record.get("emissiveFactor", (0.0, 0.0, 0.0)))
        carried = {"roughness": ("Pr", (pbr.get("roughnessFactor", 1.0),)),
                   "metallic": ("Pm", (pbr.get("metallicFactor", 1.0),)), "emissive": ("Ke", emissive)}
        for factor, values in want.factors.items():
            word, have = carried[factor]
            if values == (0.0,) and {"roughness": "map_pr", "metallic": "map_pm"}.get(factor) in want.textures and \
                    "metallicRoughnessTexture" in pbr:
                values = (1.0,)  # the 0 that writers always write would switch the map off
            same = len(have) == len(values) and max(abs(a - b) for a, b in zip(have, values)) < 1e-6
            self.expect(same or self.is_named(word), f"material {name!r}: {word} is {have}, not {values}")
        roles = {"map_kd": pbr.get("baseColorTexture"), "norm": record.get("normalTexture"),
                 "bump": record.get("normalTexture"), "map_bump": record.get("normalTexture"),
                 "map_ke": record.get("emissiveTexture"), "map_pr": pbr.get("metallicRoughnessTexture"),
                 "map_pm": pbr.get("metallicRoughnessTexture"), "map_d": pbr.get("baseColorTexture")}
        for role, path in sorted(want.textures.items()):
            wanted = read_bytes(path)
            there = roles[role] is not None and (role in ("map_pr", "map_pm") or self.texture_bytes(roles[role]) == wanted)
            self.expect(there or self.is_named(role) or (wanted is None and os.path.basename(path) in self.left_out),
                        f"material {name!r}: {role} is neither there nor named")
            for option in sorted(want.options.get(role, ())) if there else ():
                self.expect(self.is_named(option), f"no word of {option!r} of {role}, which is not carried")


def read_bytes(path):
    if path is None or not os.path.exists(path):
        return None
    with open(path, "rb") as file:
        return file.read()
