# SPDX-License-Identifier: GPL-3.0-or-later
"""source_match.py ASSET SOURCE [SPOIL]: does level 0 hold what the glTF file says?

Both sides are read here alone: the asset by lode.py (from docs/reference/format.md), the source by gltf.py (from glTF's
specification). Compared are, mesh by mesh, the triangles with their orientation, material and the attributes of their
corners, each within the quantization that the asset states; then instances, materials, images, animations and the rest
of the document. SPOIL changes one thing of what was read of the source first: then something must be found."""

import json
import math
import os
import struct
import sys

from gltf import Gltf, as_f32
from lode import Lode
from rules import NONE, Unsupported
from source import grid_points, is_kept

MAX_FINDINGS = 8


class Log:
    def __init__(self):
        self.findings, self.counts = [], {}

    def expect(self, holds, what):
        if not holds:
            self.findings.append(what)
        return holds

    def count(self, what, number=1):
        self.counts[what] = self.counts.get(what, 0) + number


def f64(bits):
    return struct.unpack("<d", struct.pack("<Q", bits))[0]


def f32(bits):
    return struct.unpack("<f", struct.pack("<I", bits))[0]


def text_of(lode, reference):
    offset, size = reference
    return lode.section("STRS")[offset:offset + size].decode()


def subtract(a, b):
    return tuple(x - y for x, y in zip(a, b))


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def unit(v):
    """None where it has no direction."""
    largest = max(map(abs, v))
    if not 0.0 < largest < math.inf:
        return None
    v = tuple(c / largest for c in v)
    length = math.sqrt(sum(c * c for c in v))
    return tuple(c / length for c in v)


def rotations(triangle):
    a, b, c = triangle
    return ((a, b, c), (b, c, a), (c, a, b))


class Corner:
    """Of the source. `exact` is what tells two corners apart."""

    def __init__(self, position, normal, uvs, color, has_own_normal):
        self.position, self.normal, self.uvs, self.color = position, normal, uvs, color
        self.has_own_normal = has_own_normal
        self.exact = (position, normal if has_own_normal else (), uvs, color)


class MeshMatch:
    def __init__(self, lode, index, source, log):
        self.record, self.log, self.place = lode.tables["MESH"][index], log, f"mesh {index}"
        self.origin = tuple(map(f64, self.record["origin"]))
        self.step = self.record["grid_mantissa"] * 2.0 ** self.record["grid_log2"]
        self.deviation = f32(self.record["level0_deviation"])
        self.source, self.index = source, index
        self.default_material = len(source.root.get("materials", []))

    def moved(self, position, point):
        return math.sqrt(sum((q * self.step - (p - o)) ** 2 for p, o, q in zip(position, self.origin, point)))

    def source_corners(self):
        """All triangles as ((three corners), material), with what the asset stores of each corner."""
        record, out = self.record, []
        stored_sets = record["uv_set_source"][:record["uv_set_count"]]
        self.vertices = 0
        for attributes, triangles, material in self.source.primitives(self.index):
            positions = [tuple(c + 0.0 for c in map(float, p)) for p in attributes["POSITION"]]
            used = len(positions)
            if used > 3 * len(triangles):  # what no triangle names is dropped where vertices outnumber corners
                used = len({v for t in triangles for v in t})
            self.vertices += used
            cache = {}

            def corner(v, flat):
                if v in cache and flat is None:
                    return cache[v]
                normal = flat
                if record["normal_mode"] != 1:
                    normal = None
                elif "NORMAL" in attributes:
                    normal = tuple(map(as_f32, attributes["NORMAL"][v]))
                uvs = tuple(tuple(as_f32(c) + 0.0 for c in attributes[f"TEXCOORD_{n}"][v])
                            if f"TEXCOORD_{n}" in attributes else (0.0, 0.0) for n in stored_sets)
                color = None
                if record["has_color"]:
                    color = tuple(attributes["COLOR_0"][v]) if "COLOR_0" in attributes else (1.0,) * 4
                    color = tuple(min(max(c, 0.0), 1.0) for c in color + (1.0,) * (4 - len(color)))
                cache[v] = Corner(positions[v], normal, uvs, color, flat is None)
                return cache[v]

            needs_flat = record["normal_mode"] == 1 and "NORMAL" not in attributes
            for t in triangles:
                flat = None
                if needs_flat:
                    a, b, c = (positions[v] for v in t)
                    flat = unit(cross(subtract(b, a), subtract(c, a))) or (0.0, 0.0, 0.0)
                out.append((tuple(corner(v, flat) for v in t), self.default_material if material is None else material))
            self.check_attributes(attributes, triangles, positions)
        return out

    def check_attributes(self, attributes, triangles, positions):
        """What the asset does not store must say nothing: normals that are not stored are the triangles' own."""
        record = self.record
        if record["normal_mode"] != 1 and "NORMAL" in attributes:
            self.log.expect(record["normal_mode"] == 2, f"{self.place}: normals of the source are not stored")
            for t in triangles:
                a, b, c = (positions[v] for v in t)
                own = unit(cross(subtract(b, a), subtract(c, a)))
                for v in t if own else ():
                    normal = unit(attributes["NORMAL"][v])
                    close = normal is None or sum(x * y for x, y in zip(own, normal)) > math.cos(math.radians(0.6))
                    self.log.expect(close, f"{self.place}: a normal that is not stored is not its triangle's own")
                    self.log.count("flat normals")
        for n in range(4):
            if f"TEXCOORD_{n}" in attributes:
                stored = n in record["uv_set_source"][:record["uv_set_count"]]
                self.log.expect(stored, f"{self.place}: TEXCOORD_{n} is not stored")
        if "COLOR_0" in attributes:
            self.log.expect(record["has_color"] == 1, f"{self.place}: colours are not stored")

    def stored_triangles(self, clusters):
        """((three vertices of integers), material), level 0 alone."""
        out = []
        for vertices, triangles in clusters:
            out += [(tuple(tuple(vertices[v]) for v in t[:3]), t[3]) for t in triangles]
        return out

    def run(self, clusters, spoil):
        record, log, place = self.record, self.log, self.place
        source = self.source_corners()
        if spoil is not None:
            spoil(source)
        log.expect(record["source_triangles"] == len(source), f"{place}: {record['source_triangles']} source triangles "
                                                              f"where the source has {len(source)}")
        log.expect(record["source_vertices"] == self.vertices, f"{place}: {record['source_vertices']} source vertices "
                                                               f"where the source has {self.vertices}")
        kept = is_kept([tuple(c.position for c in corners) for corners, _ in source])
        degenerate = kept.count(False)
        source = [s for s, is_there in zip(source, kept) if is_there]
        self.check_diagonal(source)
        self.points, moved = grid_points([tuple(c.position for c in corners) for corners, _ in source], self.origin,
                                         self.step)
        log.count("corners of needles kept apart", moved)
        whole, loose = {}, 0
        for corners, material in source:
            exact = min(rotations(tuple((c.exact, i) for i, c in enumerate(corners))))
            first = exact[0][1]
            order = corners[first:] + corners[:first]
            key = tuple(e for e, _ in exact), material
            # Copies whose normals are computed may differ in their last bits, and then both stay.
            loose += key in whole and not corners[0].has_own_normal
            whole.setdefault(key, order)
        duplicate = len(source) - len(whole)
        log.expect(record["dropped_degenerate"] == degenerate,
                   f"{place}: {record['dropped_degenerate']} degenerate triangles dropped, the source has {degenerate}")
        log.expect(duplicate - loose <= record["dropped_duplicate"] <= duplicate,
                   f"{place}: {record['dropped_duplicate']} duplicates dropped, the source has {duplicate}")
        stored = self.stored_triangles(clusters)
        expected = len(source) - record["dropped_duplicate"]
        log.expect(len(stored) == expected, f"{place}: level 0 has {len(stored)} triangles, the source {expected}")
        self.match(whole, stored)
        log.count("triangles", len(stored))
        log.count("dropped", degenerate + duplicate)

    def check_diagonal(self, source):
        points = [c.position for corners, _ in source for c in corners]
        size = [max(p[k] for p in points) - min(p[k] for p in points) for k in range(3)] if points else [0.0]
        diagonal, stored = math.sqrt(sum(s * s for s in size)), f64(self.record["diagonal"])
        self.log.expect(abs(stored - diagonal) <= 1e-12 * diagonal, f"{self.place}: diagonal {stored}, not {diagonal}")

    def match(self, whole, stored):
        """Each source triangle to a stored one of its own, on its grid points."""
        sources, places = {}, {}
        for (_, material), corners in whole.items():
            key = material, min(rotations(tuple(self.points[c.position] for c in corners)))
            sources.setdefault(key, []).append(corners)
        for vertices, material in stored:
            key = material, min(rotations(tuple(v[:3] for v in vertices)))
            places.setdefault(key, []).append(vertices)
        for key in set(sources) | set(places):
            lonely, _ = pair(sources.get(key, []), places.get(key, []), self.fits)
            for corners in lonely:
                self.log.expect(False, f"{self.place}: no triangle of level 0 is the source's "
                                       f"{[c.position for c in corners]} of material {key[0]} with its attributes")

    def fits(self, corners, vertices):
        return any(all(self.corner_fits(c, v) for c, v in zip(corners, turned)) for turned in rotations(vertices))

    def corner_fits(self, corner, vertex):
        if self.points[corner.position] != vertex[:3]:
            return False
        if self.moved(corner.position, vertex[:3]) > self.deviation * (1 + 1e-9) + 1e-300:
            return False
        at = 3
        if self.record["normal_mode"] == 1:
            stored, at = unit(vertex[at:at + 3]), at + 3
            normal = unit(corner.normal)
            # The stored direction is at most sqrt(2) / M radians away (docs/reference/format.md, section 4).
            limit = math.sqrt(2) / self.record["normal_scale"] * (1 + 1e-6) + 1e-6
            if normal is not None and math.dist(stored, normal) > limit:
                return False
        for k, uv in enumerate(corner.uvs):
            step = 2.0 ** self.record["uv_log2"][k]
            if any(abs(step * q - c) > 0.5 * step * (1 + 1e-9) for q, c in zip(vertex[at:at + 2], uv)):
                return False
            at += 2
        if corner.color is not None:
            return all(abs(q / 255 - c) <= 0.5 / 255 + 1e-6 for q, c in zip(vertex[at:at + 4], corner.color))
        return True


def pair(sources, places, fits):
    """A largest matching by augmenting paths; (sources, places) that are left without a partner."""
    owner = [None] * len(places)
    lonely = []
    for first in range(len(sources)):
        # Depth first without recursion: `trail` holds the sources on the path and where each has got to.
        trail, seen, path = [(first, iter(range(len(places))))], set(), []
        while trail:
            s, candidates = trail[-1]
            place = next((p for p in candidates if p not in seen and fits(sources[s], places[p])), None)
            if place is None:
                trail.pop()
                if path:
                    path.pop()
                continue
            seen.add(place)
            path.append((s, place))
            if owner[place] is None:
                for s, p in path:
                    owner[p] = s
                break
            trail.append((owner[place], iter(range(len(places)))))
        if not trail:
            lonely.append(sources[first])
    return lonely, [p for p, s in zip(places, owner) if s is None]


def largest_singular_value(m):
    """Of the left 3 x 3 part: Jacobi rotations on its Gram matrix."""
    largest = max(abs(m[r][c]) for r in range(3) for c in range(3))
    if largest == 0.0:
        return 0.0
    rows = [[m[r][c] / largest for c in range(3)] for r in range(3)]
    g = [[sum(rows[k][i] * rows[k][j] for k in range(3)) for j in range(3)] for i in range(3)]
    for _ in range(40):
        for i, j in ((0, 1), (0, 2), (1, 2)):
            if g[i][j] == 0.0:
                continue
            angle = 0.5 * math.atan2(2 * g[i][j], g[j][j] - g[i][i])
            c, s = math.cos(angle), math.sin(angle)
            for k in range(3):
                g[k][i], g[k][j] = c * g[k][i] - s * g[k][j], s * g[k][i] + c * g[k][j]
            for k in range(3):
                g[i][k], g[j][k] = c * g[i][k] - s * g[j][k], s * g[i][k] + c * g[j][k]
    return largest * math.sqrt(max(g[i][i] for i in range(3)))


def match_instances(lode, source, log, spoil):
    instances = list(source.instances())
    if spoil is not None:
        instances = spoil(instances)
    stored = lode.tables["INST"]
    log.expect(len(stored) == len(instances), f"{len(stored)} instances, the source has {len(instances)}")
    for i, (record, (node, world)) in enumerate(zip(stored, instances)):
        place, source_node = f"instance {i}", source.root["nodes"][node]
        log.expect(record["node"] == node, f"{place}: node {record['node']}, not {node}")
        log.expect(record["mesh"] == source_node["mesh"], f"{place}: mesh {record['mesh']}")
        log.expect(text_of(lode, record["name"]) == source_node.get("name", ""), f"{place}: another name")
        transform = [f64(bits) for bits in record["transform"]]
        expected = [world[r][c] for r in range(3) for c in range(4)]
        for part in ([r * 4 + c for r in range(3) for c in range(3)], [3, 7, 11]):
            size = max(abs(expected[k]) for k in part)
            far = max(abs(transform[k] - expected[k]) for k in part)
            log.expect(far <= 1e-12 * max(size, 1e-300), f"{place}: its transform is off by {far}")
        x, y, z = ([world[r][c] for r in range(3)] for c in range(3))
        volume = sum(a * b for a, b in zip(cross(x, y), z))
        if volume != 0.0:
            log.expect(record["flags"] == (1 if volume < 0.0 else 0), f"{place}: flags {record['flags']}, "
                                                                      f"determinant {volume}")
        scale, sigma = f64(record["scale"]), largest_singular_value(world)
        log.expect(sigma * (1 - 1e-9) <= scale <= sigma * (1 + 1e-9), f"{place}: scale {scale}, not {sigma}")
        log.count("instances")


def match_materials(lode, source, log, spoil):
    materials = list(source.materials())
    uses_default = any("attributes" in p and "POSITION" in p["attributes"] and p.get("mode", 4) >= 4 and
                       "material" not in p for m in source.root.get("meshes", []) for p in m["primitives"])
    if uses_default:
        materials.append({"name": "", "alpha_mode": 0, "base_color": (1.0,) * 4, "alpha_cutoff": 0.5, "double_sided": 0,
                          "base_color_texture": NONE, "base_color_uv_set": NONE})
    if spoil is not None:
        spoil(materials)
    stored = lode.tables["MATL"]
    log.expect(len(stored) == len(materials), f"{len(stored)} materials, the source has {len(materials)}")
    for i, (record, material) in enumerate(zip(stored, materials)):
        index = i if i < len(source.root.get("materials", [])) else NONE
        log.expect(record["source_index"] == index, f"material {i}: source_index {record['source_index']}")
        for key, expected in material.items():
            value = record[key]
            if key == "name":
                value = text_of(lode, value)
            elif key == "base_color":
                value = tuple(map(f32, value))
            elif key == "alpha_cutoff":
                value = f32(value)
            log.expect(value == expected, f"material {i}, {key}: {value}, not {expected}")
        log.count("materials")


def match_document(lode, source, log, spoil):
    """What is carried through unchanged."""
    document = json.loads(lode.section("SCNE"))
    blobs = [lode.data[b["offset"]:b["offset"] + b["bytes"]] for b in lode.tables["BLBT"]]
    carried = Gltf(root=document, blobs=blobs)
    if spoil is not None:
        spoil(document)
    root = source.root
    for key in ("asset", "scene", "scenes", "materials", "textures", "samplers", "cameras", "extras"):
        log.expect(document.get(key) == root.get(key), f"{key} of the document is not the source's")
    for key, left in (("nodes", ("skin", "weights")), ("meshes", ("primitives", "weights", "extensions"))):
        expected = [{k: v for k, v in item.items() if k not in left} for item in root.get(key, [])]
        found = document.get(key, [])
        if key == "meshes":  # of primitives, only what KHR_materials_variants says
            found = [{k: v for k, v in item.items() if k != "primitives"} for item in found]
        log.expect(found == expected, f"{key} of the document are not the source's")
    images = root.get("images", [])
    log.expect(len(document.get("images", [])) == len(images), "another number of images")
    for i, (image, other) in enumerate(zip(images, document.get("images", []))):
        log.expect(source.bytes_of(image) == carried.bytes_of(other), f"image {i}: other bytes")
        log.count("images")
    motions, others = list(source.motions()), list(carried.motions())
    motions = [rows for rows in motions if rows]
    log.expect(motions == [rows for rows in others if rows], "animations are not the source's")
    log.count("animations", len(motions))


def first_cluster_of(lode, meshes):
    """Level-0 clusters by mesh: [(vertices, triangles)]."""
    out = [[] for _ in meshes]
    groups, records = lode.tables["GRUP"], lode.tables["CLUS"]
    for cluster, vertices, triangles in lode.clusters():
        if records[cluster]["level"] == 0:
            out[groups[records[cluster]["coarser_group"]]["mesh"]].append((vertices, triangles))
    return out


def match(asset, path, spoil=None):
    """(findings, counts). `spoil`: ("triangles" | "instances" | "materials" | "document", a function)."""
    with open(asset, "rb") as file:
        lode = Lode(file.read())
    source, log = Gltf(path), Log()
    pick = lambda part: spoil[1] if spoil is not None and spoil[0] == part else None  # noqa: E731
    meshes = source.root.get("meshes", [])
    if log.expect(len(lode.tables["MESH"]) == len(meshes), "another number of meshes"):
        for m, clusters in enumerate(first_cluster_of(lode, meshes)):
            name = text_of(lode, lode.tables["MESH"][m]["name"])
            log.expect(name == meshes[m].get("name", ""), f"mesh {m}: name {name!r}")
            MeshMatch(lode, m, source, log).run(clusters, pick("triangles"))
    match_instances(lode, source, log, pick("instances"))
    match_materials(lode, source, log, pick("materials"))
    match_document(lode, source, log, pick("document"))
    return log.findings, log.counts


def main(arguments):
    asset, path = arguments
    try:
        findings, counts = match(asset, path)
    except Unsupported as error:
        print(f"{os.path.basename(path)}: not read: {error}")
        return 5
    for finding in findings[:MAX_FINDINGS]:
        print(f"{os.path.basename(path)}: {finding}")
    told = ", ".join(f"{number} {what}" for what, number in counts.items() if number)
    print(f"{os.path.basename(path)}: {len(findings)} findings; {told}")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
