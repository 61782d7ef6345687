# SPDX-License-Identifier: GPL-3.0-or-later
"""Skinned meshes in the rest pose of a glTF file, from the specification's section 3.7.3 and from what docs/reference/input.md says
of the asset: which meshes are moved by one matrix, which vertex by vertex, and what the tree looks like afterwards."""

import math

IDENTITY = ((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0), (0.0, 0.0, 1.0, 0.0), (0.0, 0.0, 0.0, 1.0))


def influences(attributes, vertex, joint_count):
    """(joint, weight) of the sets JOINTS_n and WEIGHTS_n; the first joint where no weight says anything."""
    found, first, n = [], 0, 0
    while f"JOINTS_{n}" in attributes and f"WEIGHTS_{n}" in attributes:
        joints = attributes[f"JOINTS_{n}"][vertex]
        first = int(joints[0]) if n == 0 else first
        found += [(int(j), float(w)) for j, w in zip(joints, attributes[f"WEIGHTS_{n}"][vertex])
                  if 0.0 < w < math.inf and j < joint_count]
        n += 1
    return found or [(first if first < joint_count else 0, 1.0)]


def blend(weighted, matrices):
    total, rows = 0.0, [[0.0] * 4 for _ in range(3)]
    for _, weight in weighted:
        total += weight
    for joint, weight in weighted:
        share = weight / total
        for r in range(3):
            for c in range(4):
                rows[r][c] += share * matrices[joint][r][c]
    return rows


def cofactors(m):
    """Rows of the inverse transpose of the 3 x 3 part, times |determinant|; and whether that is a mirror."""
    x, y, z = ([m[r][c] for r in range(3)] for c in range(3))

    def cross(a, b):
        return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    columns = cross(y, z), cross(z, x), cross(x, y)
    mirrors = sum(p * q for p, q in zip(x, columns[0])) < 0.0
    sign = -1.0 if mirrors else 1.0
    return [[sign * columns[c][r] for c in range(3)] for r in range(3)], mirrors


def pose(attributes, triangles, matrices):
    """(attributes, triangles) of a primitive with its vertices where its joints put them."""
    out, mirrored = dict(attributes), []
    positions, normals = [], []
    for v, (x, y, z) in enumerate(attributes["POSITION"]):
        m = blend(influences(attributes, v, len(matrices)), matrices)
        positions.append(tuple(m[r][0] * x + m[r][1] * y + m[r][2] * z + m[r][3] for r in range(3)))
        turn, mirrors = cofactors(m)
        mirrored.append(mirrors)
        if "NORMAL" in attributes:
            n = [sum(turn[r][c] * attributes["NORMAL"][v][c] for c in range(3)) for r in range(3)]
            length = math.sqrt(sum(c * c for c in n))
            normals.append(tuple(c / length for c in n) if length > 0.0 else (0.0, 0.0, 0.0))
    out["POSITION"] = positions
    if normals:
        out["NORMAL"] = normals
    return out, [(a, c, b) if mirrored[a] and mirrored[b] and mirrored[c] else (a, b, c) for a, b, c in triangles]


def agree(a, b, low, high):
    """Whether two matrices put every point of a box into one place, within a millionth of the numbers in hand."""
    far = size = 0.0
    for r in range(3):
        least = most = a[r][3] - b[r][3]
        reach = abs(a[r][3])
        for c in range(3):
            d = a[r][c] - b[r][c]
            least += min(d * low[c], d * high[c])
            most += max(d * low[c], d * high[c])
            reach += abs(a[r][c]) * max(abs(low[c]), abs(high[c]))
        far, size = max(far, abs(least), abs(most)), max(size, reach)
    return far <= 1e-6 * size


def common_matrix(parts, matrices):
    """The matrix that stands for those of all joints in use, or None. `parts`: (attributes, triangles) of the mesh."""
    used, points = set(), []
    for attributes, triangles in parts:
        for v in {v for t in triangles for v in t}:
            used |= {joint for joint, _ in influences(attributes, v, len(matrices))}
            points.append(attributes["POSITION"][v])
    if not used:
        return IDENTITY
    low, high = ([f(p[k] for p in points) for k in range(3)] for f in (min, max))
    for candidate in (IDENTITY, matrices[min(used)]):
        if all(agree(matrices[j], candidate, low, high) for j in used):
            return candidate
    return None


class Skins:
    """`settle` rewrites the tree of a gltf.Gltf and returns which meshes are posed: {mesh: (source mesh, matrices)}."""

    def __init__(self, gltf, local_matrix, multiply):
        self.gltf, self.root, self.multiply = gltf, gltf.root, multiply
        self.nodes = self.root.get("nodes", [])
        self.world, self.tree_root, self.hidden = {}, {}, {}
        children = {c for node in self.nodes for c in node.get("children", [])}
        todo = [(n, n, IDENTITY, False) for n in range(len(self.nodes)) if n not in children]
        while todo:
            n, root, parent, hidden = todo.pop()
            node = self.nodes[n]
            self.world[n] = multiply(parent, local_matrix(node))
            self.tree_root[n] = root
            self.hidden[n] = hidden or not node.get("extensions", {}).get("KHR_node_visibility", {}).get("visible", True)
            todo += [(c, root, self.world[n], self.hidden[n]) for c in node.get("children", [])]

    def matrices(self, skin):
        inverse = None
        if "inverseBindMatrices" in skin:
            inverse = self.gltf.accessor(skin["inverseBindMatrices"])
        out = []
        for k, joint in enumerate(skin["joints"]):
            bind = IDENTITY
            if inverse is not None:
                bind = tuple(tuple(inverse[k][4 * c + r] for c in range(4)) for r in range(3)) + (IDENTITY[3],)
            out.append(self.multiply(self.world[joint], bind))
        return out

    def settle(self):
        skins, ways = self.root.get("skins", []), {}
        drawn = [n for n, node in enumerate(self.nodes) if "mesh" in node and "skin" in node]
        for n in drawn:
            pair = self.nodes[n]["mesh"], self.nodes[n]["skin"]
            if pair in ways:
                continue
            parts = [(attributes, triangles) for attributes, triangles, _ in self.gltf.primitives(pair[0])]
            matrices = self.matrices(skins[pair[1]])
            if matrices and any("JOINTS_0" in a and "WEIGHTS_0" in a for a, _ in parts):
                ways[pair] = common_matrix(parts, matrices), matrices
            else:
                ways[pair] = None
        kept = set()
        for node in self.nodes:
            if "mesh" in node:
                way = ways.get((node["mesh"], node.get("skin")))
                if way is None or way[0] is not None:
                    kept.add(node["mesh"])
        posed, place = {}, {}
        poses = sorted(pair for pair, way in ways.items() if way is not None and way[0] is None)
        last = {mesh: skin for mesh, skin in poses if mesh not in kept}
        for mesh, skin in poses:
            where = mesh
            if last.get(mesh) != skin:
                where = len(self.root["meshes"])
                self.root["meshes"].append(dict(self.root["meshes"][mesh]))
            place[mesh, skin] = where
            posed[where] = mesh, ways[mesh, skin][1]
        for n in drawn:
            pair = self.nodes[n]["mesh"], self.nodes[n]["skin"]
            if ways[pair] is not None:
                self.move(n, place.get(pair, pair[0]), ways[pair][0] or IDENTITY)
        return posed

    def move(self, n, mesh, matrix):
        old = self.nodes[n]
        new = {key: old[key] for key in ("name", "extras") if key in old}
        new["mesh"] = mesh
        if matrix != IDENTITY:
            new["matrix"] = [matrix[r][c] for c in range(4) for r in range(4)]
        if self.hidden[n]:
            new["extensions"] = {"KHR_node_visibility": {"visible": False}}
        for key in ("mesh", "skin", "weights"):
            old.pop(key, None)
        self.nodes.append(new)
        for scene in self.root.get("scenes", []):
            if self.tree_root[n] in scene.get("nodes", []):
                scene["nodes"].append(len(self.nodes) - 1)
